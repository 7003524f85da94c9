"""Decisions repeat: the same situation is decided alike in a shift, in its replay, in a process
that was killed and began again, and whatever was asked before.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

import pytest
from tests.dispatch.cells import GEARBOX
from tests.dispatch.stations import ROOT, THESIS
from tests.dispatch.test_decisions_agree import agrees

import tandem
from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Basis, Chosen, Decision, Options, Policy
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.journal import Journal, JournalError
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.shift.deadline import InTime
from tandem.dispatch.shift.live import RULE, Settings, Shift
from tandem.dispatch.shift.replay import replay
from tandem.dispatch.shift.simulated import SimulatedFloor
from tandem.dispatch.situation.model import Situation
from tandem.files.generators import layered
from tandem.files.load import load
from tandem.world.randomness import Chance

ALTERNATOR = load(ROOT / "examples" / "alternator.yaml")
CELLS = {
    "thesis": THESIS,
    "gearbox": GEARBOX,
    "alternator": ALTERNATOR,
    "two humans": layered(12, 2, 1, seed=4),
    "wide": layered(24, 1, 2, seed=2),
}
ODD = "random:0.3+pace:0.7..1.8+refusing:0.05"
ROUGH = Chance(spread="lognormal", cv=0.25, failure_s=60, repair_s=6, absence_s=90, away_s=8)
DECIDERS = ("auto", "replan", "replan-robust", "fixed", "longest-tail")


@dataclass
class Noting:
    """A decider that notes what it was asked and what it said."""

    policy: Policy
    said: list[tuple[Situation, Decision]] = field(default_factory=list)

    @property
    def name(self) -> str:
        """As the decider's."""
        return self.policy.name

    def decide(self, situation: Situation) -> Decision:
        """As the decider."""
        decision = self.policy.decide(situation)
        self.said.append((situation, decision))
        return decision


def events(shift: Shift, floor: SimulatedFloor) -> Iterator[str]:
    while (event := floor.next(shift.situation, shift.decision["look_again"])) is not None:
        yield json.dumps(event.to_dict())


def chosen(cell: Cell) -> Chosen:
    """The recommended plan of a cell."""
    best = tandem.plan(cell, time_limit=10, workers=1).knee
    return Chosen(best.schedule, Basis.of(best, proven=True))


@pytest.mark.parametrize(
    ("name", "cell"),
    [
        *(("replan-robust", cell) for cell in CELLS),
        ("auto", "two humans"),
        ("replan", "alternator"),
        ("replan", "two humans"),
        ("fixed", "gearbox"),
    ],
)
def test_a_decision_follows_from_the_situation_alone(name: str, cell: str) -> None:
    """A decider that has never been asked, and is asked in another order, decides the same."""
    check_repetition(name, CELLS[cell])


def check_repetition(name: str, cell: Cell) -> None:
    """Raises AssertionError where a fresh decider decides otherwise than one in a shift."""
    options = Options(budget_ms=20.0, steps_per_ms=20.0)
    settings = Settings(name, Objective(1.0, 0.2), options)
    noting = Noting(policy(name, cell, settings.objective, options))
    rule = policy(RULE, cell, settings.objective, options)
    with Journal() as journal:
        shift = Shift.open(cell, journal, settings, decider=InTime(noting, rule, 60_000.0))
        for line in events(shift, SimulatedFloor(cell, ODD, ROUGH, 1)):
            for document in shift.take(line)[1:]:
                agrees(shift, document)
    assert len(noting.said) > 5
    fresh = policy(name, cell, settings.objective, options)
    for situation, decision in reversed(noting.said):
        assert fresh.decide(situation) == decision


@pytest.mark.parametrize("follows", [False, True], ids=["free", "by a plan"])
@pytest.mark.parametrize("name", DECIDERS)
def test_a_shift_that_was_cut_off_again_and_again_is_replayed_identically(
    name: str, follows: bool, tmp_path: Path
) -> None:
    """Each process takes three events, then is gone; the next goes on with a decider of its own."""
    cell = THESIS
    plan = chosen(cell) if follows else None
    if follows and name in ("replan", "longest-tail"):
        pytest.skip("heeds no plan")
    settings = Settings(name, Objective(1.0, 0.5), Options(plan=plan, change_penalty=1.0))
    path = tmp_path / "shift.db"
    for _ in range(40):
        with Journal(path) as journal:
            shift = Shift.open(cell, journal, settings)
            floor = SimulatedFloor(cell, ODD, ROUGH, 5)
            if shift.is_resumed:
                floor.catch_up(Situation.of(cell), journal.entries())
            taken = [shift.take(line) for line in islice(events(shift, floor), 3)]
            agrees(shift, shift.decision)
        if len(taken) < 3:
            break
    assert shift.situation.is_over
    assert shift.number > 12
    with Journal(path, read_only=True) as journal:
        found = replay(cell, journal)
    assert found.differences == ()
    assert found.decisions == shift.number + 1


def test_whom_the_guard_cut_is_replayed_as_that(tmp_path: Path) -> None:
    """A decider that is too slow in every second decision: the rule's answers are told again."""

    @dataclass
    class Halting:
        policy: Policy
        asked: int = 0
        name: str = "halting"

        def decide(self, situation: Situation) -> Decision:
            self.asked += 1
            if self.asked % 2:
                gone.wait(0.3)
            return self.policy.decide(situation)

    gone = threading.Event()
    settings = Settings("replan-robust")
    made = settings.decider(GEARBOX)
    halting = InTime(Halting(made.policy), made.rule, 100.0)
    with Journal(tmp_path / "late.db") as journal:
        shift = Shift.open(GEARBOX, journal, settings, decider=halting)
        floor = SimulatedFloor(GEARBOX, "pace:1.5", seed=2)
        for line in events(shift, floor):
            shift.take(line)
            gone.wait(0.25)  # the late one ends
        instead = [entry.decision["instead"] for entry in journal.entries() if entry.decision]
        assert {"", "late"} <= set(instead)
        assert replay(GEARBOX, journal).differences == ()


def test_what_a_millisecond_buys_stands_in_the_journal_and_decides_alike(tmp_path: Path) -> None:
    """A machine that counted on few steps and one that counts on many: the shift keeps its own."""
    cell = CELLS["wide"]
    shifts = {}
    for steps in (1.0, 100.0):
        settings = Settings("replan-robust", options=Options(steps_per_ms=steps))
        path = tmp_path / f"{steps}.db"
        made = settings.decider(cell)
        with Journal(path) as journal:
            patient = InTime(made.policy, made.rule, 60_000.0)
            shift = Shift.open(cell, journal, settings, decider=patient)
            for line in islice(events(shift, SimulatedFloor(cell, ODD, ROUGH, 0)), 6):
                shift.take(line)
            shifts[steps] = [entry.decision["why"] for entry in journal.entries() if entry.decision]
        with Journal(path, read_only=True) as journal:
            assert replay(cell, journal).differences == ()
    assert shifts[1.0] != shifts[100.0], "work matters, or this would show nothing"


@pytest.mark.parametrize("name", ["auto", "fixed"])
def test_another_process_replays_the_same(name: str, tmp_path: Path) -> None:
    """Sets and dictionaries of names are in another order there."""
    cell, path = tmp_path / "cell.json", tmp_path / "shift.db"
    cell.write_text(json.dumps(CELLS["two humans"].to_dict()), encoding="utf-8")
    options = ["--policy", name, "--simulate", ODD, "--cv", "0.2", "--failures", "50"]
    for seed, more in (("1", options), ("2", ["--replay"])):
        done = subprocess.run(
            [sys.executable, "-m", "tandem", "dispatch", str(cell), "--journal", str(path), *more],
            env=os.environ | {"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.endswith("decisions: the same.\n"), done.stdout


def test_a_plan_that_was_made_before_the_shift_is_not_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`fixed` plans once; the journal keeps the schedule, though planning anew found another."""
    path = tmp_path / "fixed.db"
    with Journal(path) as journal:
        first = Shift.open(GEARBOX, journal, Settings("fixed"))
        digest = first.hello()["plan"]

    def other(*_: object, **__: object) -> None:
        raise AssertionError("planned again")

    monkeypatch.setattr("tandem.dispatch.deciders.fixed.plan", other)
    with Journal(path) as journal:
        assert Shift.open(GEARBOX, journal, Settings("fixed")).hello()["plan"] == digest
        assert replay(GEARBOX, journal).differences == ()


def test_a_plan_in_a_journal_that_breaks_the_cell_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "fixed.db"
    with Journal(path) as journal:
        Shift.open(GEARBOX, journal, Settings("fixed"))
        settings = json.loads(
            journal.connection.execute("SELECT value FROM shift WHERE key = 'settings'").fetchone()[
                0
            ]
        )
        settings["options"]["plan"]["assignments"][0]["start"] += 1
        journal.connection.execute(
            "UPDATE shift SET value = ? WHERE key = 'settings'", (json.dumps(settings),)
        )
    with Journal(path) as journal, pytest.raises(JournalError, match=r"settings, plan: .*'base'"):
        Shift.open(GEARBOX, journal, Settings("fixed"))


def test_settings_with_a_plan_survive_the_journal() -> None:
    settings = Settings("auto", options=replace(Options(), plan=chosen(GEARBOX)))
    again = Settings.from_dict(json.loads(json.dumps(settings.to_dict())))
    assert again == settings
