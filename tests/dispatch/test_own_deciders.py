"""Deciders of one's own, and policies that were trained at the standard faces: judged and run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from tests.dispatch.stations import THESIS

import tandem
import tandem.envs
from tandem.cell.model import Cell
from tandem.dispatch.deciders.at_a_face import of_gymnasium, of_pettingzoo
from tandem.dispatch.deciders.own import OwnPolicyError
from tandem.dispatch.deciders.policy import Decision
from tandem.dispatch.deciders.reply import begins
from tandem.dispatch.journal import Journal
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.shift.replay import replay
from tandem.dispatch.shift.simulated import SimulatedFloor
from tandem.dispatch.situation.legal import legal
from tandem.dispatch.situation.model import Situation
from tandem.envs import parallel_env
from tandem.errors import UsageError
from tandem.files.generators import layered
from tandem.world.randomness import Chance

ROOT = Path(__file__).resolve().parents[2]


class First:
    """Whatever may begin first."""

    name = "first"

    def decide(self, situation: Situation) -> Decision:
        return begins(situation, legal(situation), by=self.name, because="it comes first")


def no_maker() -> First:
    """Takes no cell."""
    return First()


class Failing(First):
    name = "failing"

    def decide(self, situation: Situation) -> Decision:
        return super().decide(situation) if situation.now < 3 else 1 / 0  # type: ignore[return-value]


class Mute(First):
    name = "mute"

    def decide(self, situation: Situation) -> Decision:
        return None  # type: ignore[return-value]


class Eager(First):
    """Wants the last task first."""

    name = "eager"

    def decide(self, situation: Situation) -> Decision:
        return Decision((("7", ("robot",)),), {}, (), 0.0, "now", self.name)


def test_objects_names_and_makers_are_judged_side_by_side() -> None:
    def made(cell: Cell, objective: Any, options: Any) -> First:
        return First()

    (document,) = tandem.judge(THESIS, ["fixed", First(), made], "random:0.5", 12)
    fixed, first, maker = document["policies"]
    assert [fixed["policy"], first["policy"], maker["policy"]] == ["fixed", "first", "made"]
    assert first["makespan"] == maker["makespan"]
    assert first["latency_ms"]["p50"] > 0
    assert document["optimum"] <= fixed["makespan"]["mean"]


@pytest.mark.parametrize(
    ("own", "message"),
    [
        (Failing(), r"failing, asked at \d+ s: ZeroDivisionError.*test_own_deciders\.py:\d+"),
        (Mute(), "mute, asked at 0 s: answered None, which is no Decision"),
        (Eager(), "eager wants robot to begin task '7', which is not allowed"),
    ],
)
def test_a_decider_that_fails_is_told_with_its_place(own: Any, message: str) -> None:
    with pytest.raises(OwnPolicyError, match=message):
        tandem.judge(THESIS, [own], episodes=2)


@pytest.mark.parametrize(
    ("policies", "message"),
    [
        ([First(), First()], "policy first: named twice"),
        ([3, "fixd"], r"3, and no policy.*'fixd'.*'fixed'"),
        ([no_maker], "TypeError"),
    ],
)
def test_what_is_no_decider_is_refused(policies: list[Any], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        tandem.judge(THESIS, policies, episodes=2)


def test_a_decider_that_fails_live_leaves_the_floor_to_the_rule() -> None:
    with Journal() as journal:
        shift = lived(THESIS, Failing(), journal)
        entries = [one.decision for one in journal.entries() if one.decision is not None]
        assert shift.situation.is_over
        assert {entry["instead"] for entry in entries} == {"", "failed"}
        again = replay(THESIS, journal, decider=shift.decider)
        assert again.differences == ()


def lived(cell: Cell, own: Any, journal: Journal, people: str = "pace:1.5") -> Shift:
    settings = Settings()
    shift = Shift.open(cell, journal, settings, decider=settings.decider(cell, own=own))
    floor = SimulatedFloor(cell, people, Chance(), 0, {})
    floor.catch_up(shift.settings.beginning(cell, {}), journal.entries())
    while (event := floor.next(shift.situation, shift.decision["look_again"])) is not None:
        shift.take(json.dumps(event.to_dict()))
    return shift


def last_legal(seen: Any) -> int:
    return int(np.flatnonzero(seen["action_mask"])[-1])


def by_what_it_sees(seen: Any) -> int:
    """A legal action that hangs on every number of the observation; waits if it must."""
    legal = np.flatnonzero(seen["action_mask"])
    legal = legal[1:] if len(legal) > 1 and legal[0] == 0 else legal
    return int(legal[int(1000 * float(np.sum(seen["observation"] ** 2))) % len(legal)])


CELLS = [THESIS, layered(8, 2, 2, seed=3)]


@pytest.mark.parametrize("cell", CELLS, ids=["thesis", "layered"])
@pytest.mark.parametrize("act", [last_legal, by_what_it_sees])
def test_a_policy_decides_in_the_judge_as_at_its_gymnasium_face(cell: Cell, act: Any) -> None:
    env = gymnasium.make("tandem/RobotBesideHuman-v0", cell=cell)
    seen, info = env.reset(seed=0)
    ended = cut = False
    while not (ended or cut):
        seen, _, ended, cut, info = env.step(act(seen))
    (document,) = tandem.judge(cell, [of_gymnasium(cell, act)], episodes=2)
    assert ended
    assert document["policies"][0]["makespan"]["mean"] == info["makespan"]
    assert document["policies"][0]["stress"]["mean"] == info["stress"]


@pytest.mark.parametrize("cell", CELLS, ids=["thesis", "layered"])
@pytest.mark.parametrize("act", [last_legal, by_what_it_sees])
def test_agents_decide_in_the_judge_as_at_their_pettingzoo_face(cell: Cell, act: Any) -> None:
    env = parallel_env("events", cell)
    seen, infos = env.reset(seed=0)
    while env.agents:
        seen, *_, infos = env.step({agent: act(seen[agent]) for agent in env.agents})
    own = of_pettingzoo(cell, lambda agent, what: act(what))
    (document,) = tandem.judge(cell, [own], episodes=2)
    assert document["policies"][0]["makespan"]["mean"] == infos["human_0"]["makespan"]


def test_a_policy_of_a_padded_face_decides_on_every_cell_that_fits() -> None:
    env = gymnasium.make("tandem/RobotBesideHuman-v0", cell=CELLS)
    room = env.unwrapped.cells.room  # type: ignore[attr-defined]
    sizes = set()

    def act(seen: Any) -> int:
        sizes.add((seen["observation"].shape, seen["action_mask"].shape))
        assert env.observation_space.contains(seen)
        return by_what_it_sees(seen)

    for cell in CELLS:
        seen, info = env.reset(seed=0, options={"cell": cell})
        ended = False
        while not ended:
            seen, _, ended, _, info = env.step(act(seen))
        (document,) = tandem.judge(cell, [of_gymnasium(cell, act, room=room)], episodes=2)
        assert document["policies"][0]["makespan"]["mean"] == info["makespan"]
    assert len(sizes) == 1
    with pytest.raises(UsageError, match="8 tasks where there is room for"):
        of_gymnasium(CELLS[1], act, room=tandem.envs.cells.Room(7, 99, 2, 2))


def test_an_action_that_is_no_number_is_told() -> None:
    with pytest.raises(UsageError, match="own: named 'wait', no whole number"):
        tandem.judge(THESIS, [of_gymnasium(THESIS, lambda seen: "wait")], episodes=2)


def test_a_journal_runs_no_code_that_is_not_named_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from tandem.cli.root import run

    monkeypatch.syspath_prepend(str(ROOT / "examples" / "extensions"))
    journal, cell = str(tmp_path / "shift.db"), str(ROOT / "examples" / "thesis.yaml")
    named = ["--policy", "own_decider:make"]
    begun = ["dispatch", cell, "--journal", journal]
    assert run([*begun, *named, "--simulate", "compliant", "--json"]) == 0
    assert run([*begun, "--replay"]) == 2
    assert run([*begun, "--events", "/dev/null"]) == 2
    assert "Name it again with --policy own_decider:make" in capsys.readouterr().err
    assert run([*begun, *named, "--replay"]) == 0
    assert "the same" in capsys.readouterr().out
