"""A machine in a shift: it is told to begin as a robot is, and is down and repaired like one."""

from __future__ import annotations

import pytest
from tests.cell.test_machines import press
from tests.dispatch.cells import line
from tests.dispatch.test_situation import done, reached, started

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.situation.events import Event
from tandem.dispatch.situation.objections import objections
from tandem.files.validate import cell_of


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
