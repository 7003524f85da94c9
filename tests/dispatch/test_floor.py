"""A simulated floor drives whole shifts: every event fits, every line is as the schemas say, and a
shift that was cut off is picked up.
"""

from __future__ import annotations

import json
from itertools import islice, pairwise

import jsonschema
import pytest
from tests.dispatch.cells import in_time

from tandem.cell.model import Cell
from tandem.dispatch.journal import Journal
from tandem.dispatch.shift.documents import Document, summary
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.shift.replay import replay
from tandem.dispatch.shift.schema import SHIPPED, decision_schema, event_schema, schema_text
from tandem.dispatch.shift.simulated import SimulatedFloor
from tandem.dispatch.situation.model import Situation
from tandem.errors import UsageError
from tandem.files.load import load
from tandem.files.validate import cell_of
from tandem.world.randomness import Chance

ROUGH = Chance(spread="lognormal", cv=0.3, failure_s=40, repair_s=6, absence_s=60, away_s=5)
PEOPLE = "random:0.3+forgetful:0.2+refusing:0.1+pace:1.5"
THESIS, GEARBOX = load("examples/thesis.yaml"), load("examples/gearbox.yaml")


def driven(shift: Shift, floor: SimulatedFloor, most: int = 1000) -> list[Document]:
    """What the shift says while the floor drives it, at most so many events far."""
    said = [shift.hello(), shift.decision]
    for _ in range(most):
        event = floor.next(shift.situation, shift.decision["look_again"])
        if event is None:
            break
        said += shift.take(json.dumps(event.to_dict()))
    return said


def opened(cell: Cell) -> Shift:
    return Shift.open(cell, Journal(), Settings(), decider=in_time())


@pytest.mark.parametrize("cell", [THESIS, GEARBOX], ids=["thesis", "gearbox"])
@pytest.mark.parametrize("seed", range(4))
def test_whatever_happens_each_event_is_taken_and_the_assembly_is_completed(
    cell: Cell, seed: int
) -> None:
    shift = opened(cell)
    said = driven(shift, SimulatedFloor(cell, PEOPLE, ROUGH, seed))
    assert all(document["accepted"] for document in said if document["type"] == "answer")
    assert shift.situation.is_over
    decisions, events = (
        jsonschema.Draft202012Validator(decision_schema()),
        jsonschema.Draft202012Validator(event_schema()),
    )
    for document in [
        *said,
        summary(shift.situation, shift.journal.entries()),
        shift.take("garbage")[0],
        shift.take('{"event": "tick", "at": 0}')[0],
    ]:
        decisions.validate(document)
    for entry in shift.journal.entries():
        if entry.event is not None:
            events.validate(entry.event)
    assert replay(cell, shift.journal, decider=in_time()).differences == ()


def test_nobody_and_nothing_is_used_twice_at_once() -> None:
    for seed in range(4):
        shift = opened(GEARBOX)
        driven(shift, SimulatedFloor(GEARBOX, PEOPLE, ROUGH, seed))
        past = shift.situation.past
        for who in GEARBOX.operators:
            mine = sorted((work.start, work.end) for work in past if who in work.operators)
            assert all(first[1] <= then[0] for first, then in pairwise(mine))
        for kind in ("tool", "zone"):
            for name, table in ((kind, getattr(GEARBOX, f"{kind}s")),):
                for place in {getattr(task, name) for task in GEARBOX.tasks.values()} - {None}:
                    users = [
                        work for work in past if getattr(GEARBOX.tasks[work.task], name) == place
                    ]
                    for moment in (work.start for work in users):
                        at_once = sum(
                            len(work.operators) for work in users if work.start <= moment < work.end
                        )
                        assert at_once <= (table[place].capacity if place in table else 1)


def test_a_compliant_floor_takes_the_stated_times() -> None:
    shift = opened(THESIS)
    driven(shift, SimulatedFloor(THESIS, "compliant"))
    assert all(work.worked == work.stated for work in shift.situation.past)
    assert [work.outcome for work in shift.situation.past] == ["done"] * 7


def test_the_same_seed_gives_the_same_shift_and_another_one_another() -> None:
    ends = [opened(THESIS) for _ in range(3)]
    for shift, seed in zip(ends, (1, 1, 2), strict=True):
        driven(shift, SimulatedFloor(THESIS, PEOPLE, ROUGH, seed))
    assert ends[0].situation == ends[1].situation != ends[2].situation


def test_a_shift_that_was_cut_off_is_picked_up_by_a_new_floor() -> None:
    whole, cut = opened(GEARBOX), opened(GEARBOX)
    driven(whole, SimulatedFloor(GEARBOX, PEOPLE, ROUGH, 1))
    driven(cut, SimulatedFloor(GEARBOX, PEOPLE, ROUGH, 1), most=17)
    floor = SimulatedFloor(GEARBOX, PEOPLE, ROUGH, 1)
    floor.catch_up(Situation.of(GEARBOX), cut.journal.entries())
    driven(cut, floor)
    assert cut.situation == whole.situation
    assert [entry.event for entry in cut.journal.entries()] == [
        entry.event for entry in whole.journal.entries()
    ]
    with pytest.raises(UsageError, match="is not what happens on this simulated floor"):
        SimulatedFloor(GEARBOX, PEOPLE, ROUGH, 2).catch_up(
            Situation.of(GEARBOX), islice(whole.journal.entries(), 9)
        )


def test_a_floor_looks_again_when_it_is_asked_to() -> None:
    quiet = SimulatedFloor(
        cell_of(
            {
                "operators": {"r": {"kind": "robot"}},
                "tasks": {"x": {"time": {"r": 1}, "release": 10}},
            }
        ),
        "compliant",
    )
    event = quiet.next(Situation.of(quiet.names.cell), 3.25)
    assert event is not None
    assert (event.kind, event.at) == ("tick", 3.25)


@pytest.mark.parametrize("name", SHIPPED)
def test_the_shipped_schema_is_the_current_one(name: str) -> None:
    assert SHIPPED[name].read_text(encoding="utf-8") == schema_text(name)
