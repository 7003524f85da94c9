"""Walking, and tools by operator, on the floor: what is left of a way belongs to the work that
follows, deciders keep to it, and what is broken holds up only who needs it.
"""

from __future__ import annotations

from typing import Any

import pytest
from tests.dispatch.stations import ROOT
from tests.dispatch.test_floor import driven

import tandem
from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import Models, awaited
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.journal import Journal
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.shift.simulated import SimulatedFloor
from tandem.dispatch.situation.events import Event
from tandem.dispatch.situation.legal import legal, seconds
from tandem.dispatch.situation.model import Situation, mode
from tandem.dispatch.situation.transitions import after
from tandem.errors import CellError
from tandem.files.validate import cell_of
from tandem.plan.methods import plan
from tandem.schedule.checker import faults
from tandem.schedule.model import Assignment, Schedule
from tandem.world.randomness import OFF

PUMP = tandem.load(ROOT / "examples" / "pump.yaml")


def station(**more: Any) -> Cell:
    data = {
        "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
        "tasks": {
            "a": {"time": {"anna": 2}, "place": "bench"},
            "b": {"time": {"anna": 3, "cobot": 4}, "place": "press", "tool": {"anna": "ram"}},
        },
        "walk": {"anna": {"bench-press": 3}},
    }
    return cell_of({**data, **more})


def at(situation: Situation, moment: float, kind: str, **what: Any) -> Situation:
    return after(situation, Event(kind, moment, **what))


def test_what_is_left_of_a_way_belongs_to_the_work() -> None:
    now = at(Situation.of(station()), 0, "started", task="a", operators=("anna",))
    now = at(now, 2, "done", task="a")
    assert now.stands == {"anna": "bench"}
    assert seconds(now, "b", ("anna",)) == 3 + 3
    later = at(now, 4, "tick")
    assert seconds(later, "b", ("anna",)) == 1 + 3
    assert seconds(later, "b", ("cobot",)) == 4
    begun = at(later, 4, "started", task="b", operators=("anna",))
    assert begun.running["b"].expected_end == 8
    assert begun.stands == {"anna": "press"}
    assert begun.to_dict()["stands"] == {"anna": "press"}


def test_where_nobody_stands_anywhere_a_situation_says_nothing_of_it() -> None:
    plain = station(tasks={"a": {"time": {"anna": 2}}}, walk={})
    assert "stands" not in Situation.of(plain).to_dict()


def test_a_broken_tool_holds_up_those_who_need_it() -> None:
    now = at(Situation.of(station()), 0, "broken", tool="ram")
    assert ("b", ("cobot",)) in legal(now)
    assert ("b", ("anna",)) not in legal(now)
    assert awaited(now) == {}
    moves = Models(station()).of(now, 1.0)
    ways = [moves.named(way) for row in moves.ways for way in row]
    assert ("b", ("cobot",)) in ways
    assert ("b", ("anna",)) not in ways
    alone = station(tasks={"b": {"time": {"anna": 3}, "tool": {"anna": "ram"}}}, walk={})
    now = at(Situation.of(alone), 0, "broken", tool="ram")
    assert awaited(now) == {"b": 60.0}


def whole_shift(cell: Cell, name: str, people: str, seed: int) -> Schedule:
    """What was done, by its stated times: a shift counts ways and changeovers in."""
    settings = Settings(name, options=Options(budget_ms=2_000))
    shift = Shift.open(cell, Journal(), settings)
    said = driven(shift, SimulatedFloor(cell, people, OFF, seed))
    assert all(document["accepted"] for document in said if document["type"] == "answer")
    assert shift.situation.is_over
    rows = []
    for task, work in shift.situation.done.items():
        time = mode(cell, task, work.operators).time
        rows.append(Assignment(round(work.end - time, 6), work.end, task, work.operators))
    return Schedule(tuple(rows))


@pytest.mark.parametrize("name", ["fixed", "replan", "earliest-completion", "longest-tail"])
@pytest.mark.parametrize("people", ["compliant", "random:0.5"])
def test_deciders_steer_a_cell_with_ways_and_own_tools(name: str, people: str) -> None:
    schedule = whole_shift(PUMP, name, people, 1)
    assert faults(PUMP, schedule) == []
    assert 109 <= max(a.end for a in schedule) <= 200


def test_the_fixed_plan_takes_what_was_planned() -> None:
    [best] = plan(PUMP, minimize="makespan", workers=1)
    assert max(a.end for a in whole_shift(PUMP, "fixed", "compliant", 1)) == best.makespan


def test_the_forecast_knows_the_ways() -> None:
    """Of a plan that is carried out at stated times it tells the end."""
    shift = Shift.open(PUMP, Journal(), Settings("fixed"))
    [best] = plan(PUMP, minimize="makespan", workers=1)
    assert shift.decision["forecast"]["plan"] == pytest.approx(best.makespan, abs=0.5)


def test_exact_values_refuse_ways_in_a_sentence() -> None:
    with pytest.raises(CellError, match="exact values cannot hold ways to walk between places"):
        policy("expected", station(), SECONDS, Options())
