"""The policy for any cell, live: `learned` where no trained policy is named."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.dispatch.stations import THESIS

import tandem
from tandem.cli.root import run
from tandem.dispatch.deciders.any_cell import MOST_SAMPLES, AnyCell
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.evaluation.batch import EpisodeBatch
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.situation.model import Learnt, Running, Situation
from tandem.files.generators import layered
from tandem.learn.graph.making import Maker
from tandem.world.arrays import Names
from tandem.world.population import crowd
from tandem.world.randomness import Draw

EXAMPLES = sorted(Path("examples").glob("*.yaml"))


def decider(cell: tandem.Cell, objective: Objective | None = None, **options: float) -> AnyCell:
    found = policy("learned", cell, objective or Objective(), Options(**options))  # type: ignore[arg-type]
    assert isinstance(found, AnyCell)
    return found


def played(cell: tandem.Cell, who: AnyCell) -> tuple[float, float]:
    """Seconds and stress beside people who do what they are asked, as quick as stated."""
    names = Names.of(cell)
    they = crowd("compliant", names, names.arrays())
    persons = they.draw(np.random.default_rng(0), 1)
    arrays = names.arrays(undo=None)
    stage = EpisodeBatch.of(names, arrays, Draw.of(names, arrays), persons, 7)
    found = stage.play(who)
    return float(found.makespan[0]), float(found.stress[0])


def test_the_thesis_is_run_at_its_optimum_and_by_its_weights() -> None:
    """Each point of the front by the weight of stress alone."""
    found = [
        played(THESIS, decider(THESIS, Objective(1.0, weight), budget_ms=1000.0))
        for weight in (0.2, 1.0, 50.0)
    ]
    assert found == [(23, 7), (24, 3), (34, 2)]


def test_a_human_known_to_be_slow_is_planned_for_as_slow() -> None:
    """The same situation, but for what earlier work told of the pace."""
    cell = layered(12, 1, 1, seed=4)
    (human,) = cell.humans
    ends = []
    for pace in (1.0, 3.0):
        known = Learnt(precision=1000.0, weighted=1000.0 * math.log(pace), seen=20)
        situation = replace(Situation.of(cell), learnt={human: known})
        ends.append(decider(cell, budget_ms=1000.0).decide(situation).expected_cost)
    quick, slow = ends
    assert quick is not None
    assert slow is not None
    assert slow > quick


def test_the_same_situation_is_decided_alike_by_another_process_s_decider() -> None:
    cell = layered(15, 1, 1, seed=2)
    one, two = (decider(cell, seed=3).decide(Situation.of(cell)) for _ in range(2))
    assert one == two


def test_the_budget_says_how_many_schedules_are_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Counted, not timed: none where it buys none, and then a rule answers."""
    made = list[int]()
    build = Maker.build
    monkeypatch.setattr(
        Maker, "build", lambda self, *random: (made.append(1), build(self, *random))[1]
    )
    cell = layered(20, 1, 1, seed=1)
    counts = []
    for budget in (1.0, 50.0, 200.0, 60_000.0):
        who = decider(cell, budget_ms=budget)  # its plans of before the shift do not count
        made.clear()
        decision = who.decide(Situation.of(cell))
        assert decision.starts
        counts.append(len(made))
    assert counts[0] == 0
    assert counts == sorted(counts)
    assert counts[1] > 1
    assert counts[-1] == MOST_SAMPLES


def test_what_runs_is_waited_for() -> None:
    """Nobody is free: nothing begins, and it says so."""
    start = Situation.of(THESIS)
    running = {
        "1": Running(("robot",), 0.0, 9.0),
        "3": Running(("human",), 0.0, 10.0),
    }
    decision = decider(THESIS).decide(replace(start, now=1.0, running=running))
    assert decision.starts == ()
    assert decision.asks == ()
    assert "nothing can begin" in decision.why


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_is_run_to_its_end(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["dispatch", str(path), "--policy", "learned", "--weights", "1,0"]
    code = run([*asked, "--simulate", "pace:1.5"])
    said = capsys.readouterr()
    if tandem.load(path).stress_of_set:
        assert code == 3
        assert "stress_of_set: live decisions need a stress that adds up" in said.err
    else:
        assert code == 0, said.err
