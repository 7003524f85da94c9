"""A machine in a shift: it is told to begin as a robot is, and is down and repaired like one."""

from __future__ import annotations

import pytest
from tests.cell.test_machines import press
from tests.dispatch.cells import line
from tests.dispatch.test_situation import done, reached, started
from tests.plan.test_holds import crossed
from tests.plan.test_judges import fixture, two_parts

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.situation.events import Event, read_event
from tandem.dispatch.situation.legal import hindrances, legal
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.objections import objections
from tandem.dispatch.situation.transitions import after
from tandem.files.validate import cell_of
from tandem.schedule.checker import faults
from tandem.schedule.model import Assignment, Schedule


def cell() -> Cell:
    return cell_of(press())


PRESS = ("press",)
LOADED = (started(0, "load", "anna", "press"), done(4, "load"))


@pytest.mark.parametrize("name", ["replan", "expected", "fixed", "longest-tail"])
def test_a_decider_tells_the_machine_to_run_and_asks_people_to_load(name: str) -> None:
    decider = policy(name, cell(), SECONDS, Options())
    assert decider.decide(reached(cell=cell())).starts == (("load", ("anna", "press")),)
    told = decider.decide(reached(*LOADED, cell=cell()))
    assert told.starts == (("run", ("press",)),)


def test_a_machine_can_fail_and_is_repaired_but_is_never_absent() -> None:
    down = reached(*LOADED, line("failed", 5, operator="press"), cell=cell())
    assert down.failed == {"press"}
    up = reached(
        *LOADED,
        line("failed", 5, operator="press"),
        line("repaired", 7, operator="press"),
        cell=cell(),
    )
    assert up.failed == frozenset()


@pytest.mark.parametrize(
    ("event", "says"),
    [
        (Event("absent", 1, operators=PRESS), "'press' is a machine; report a machine as failed."),
        (Event("back", 1, operators=PRESS), "'press' is a machine; report a machine as repaired."),
        (
            Event("person", 1, operators=PRESS, person="Pia"),
            "'press' is a machine; a person stands at a human's place.",
        ),
    ],
)
def test_what_is_said_of_people_is_objected_to_of_a_machine(event: Event, says: str) -> None:
    assert list(objections(reached(cell=cell()), event)) == [says]


def against(situation: Situation, task: str) -> list[str]:
    """What stands against the task, but for its predecessors and who is busy."""
    (way,) = situation.facts.ways[task]
    return list(hindrances(situation, task, way))


def test_what_a_machine_holds_stands_against_the_rest_in_words() -> None:
    held = reached(started(0, "in 1", "anna"), done(4, "in 1"), cell=two_parts())
    assert legal(held) == [("run 1", PRESS)]
    says = ["'press' holds the part of task 'in 1' until task 'out 1' is done"]
    assert against(held, "stamp") == against(held, "in 2") == says
    busy = reached(started(0, "stamp", "press"), cell=two_parts())
    assert against(busy, "in 1") == ["'press' is to hold the part and is at task 'stamp'"]
    assert against(reached(cell=crossed()), "load") == [
        "'press' is to hold the part until task 'unload' is done, and must do task 'heat' before"
    ]


@pytest.mark.parametrize(
    "name", ["replan", "replan-robust", "expected", "fixed", "longest-tail", "balanced"]
)
def test_a_shift_by_any_decider_takes_one_part_out_before_the_next_goes_in(name: str) -> None:
    for cell in (two_parts(), fixture(), crossed()):
        decider = policy(name, cell, SECONDS, Options())
        here = Situation.of(cell)
        running: dict[str, float] = {}
        while not here.is_over:
            chosen = decider.decide(here)
            for task, who in (*chosen.asks, *chosen.starts):
                if (task, who) in legal(here):
                    begun = read_event(started(here.now, task, *who), cell)
                    here = after(here, begun)
                    (mode,) = [m for m in cell.modes(task) if m.operators == who]
                    running[task] = here.now + mode.time
            assert running, "nothing goes on"
            task, end = min(running.items(), key=lambda item: item[1])
            del running[task]
            here = after(here, read_event(done(end, task), cell))
        rows = (Assignment(w.start, w.end, w.task, w.operators) for w in here.past)
        assert faults(cell, Schedule(tuple(rows))) == []
