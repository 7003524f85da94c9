"""Where a shift stands after what the floor reports, and what cannot have happened. Taken one after
the other, as on a floor.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from tests.dispatch.cells import GEARBOX, line

from tandem.cell.model import Cell
from tandem.dispatch.shift.documents import Told, stuck
from tandem.dispatch.situation.events import Event, read_event
from tandem.dispatch.situation.legal import legal, next_change
from tandem.dispatch.situation.model import Order, Situation
from tandem.dispatch.situation.objections import objections, remarks
from tandem.dispatch.situation.transitions import after, ordered, revoked
from tandem.files.validate import cell_of

COBOT, ANNA, BOTH = ("cobot",), ("anna",), ("cobot", "anna")


def reached(*events: str, cell: Cell = GEARBOX) -> Situation:
    """Where these lines lead from the start of a shift; each must be allowed."""
    situation = Situation.of(cell)
    for text in events:
        event = read_event(text, cell)
        assert objections(situation, event) == []
        situation = after(situation, event)
    return situation


def started(at: float, task: str, *operators: str) -> str:
    return line("started", at, task=task, operators=list(operators))


def done(at: float, task: str) -> str:
    return line("done", at, task=task)


BASE_DONE = (started(0, "base", "cobot"), done(4, "base"))
ALL_BUT_COVER = (
    *BASE_DONE,
    started(4, "shaft", "anna"),
    started(4, "gear", "cobot"),
    done(7, "gear"),
    done(9, "shaft"),
)


def test_a_shift_from_start_to_end() -> None:
    assert legal(reached()) == [("base", COBOT), ("base", ANNA)]
    assert legal(reached(*BASE_DONE)) == [("shaft", ANNA), ("gear", COBOT)]
    assert legal(reached(*ALL_BUT_COVER)) == [("cover", ANNA), ("cover", BOTH)]
    over = reached(*ALL_BUT_COVER, started(9, "cover", "cobot", "anna"), done(11.5, "cover"))
    assert over.is_over
    assert (over.makespan, over.stress, legal(over)) == (11.5, 2.0, [])
    assert [work.outcome for work in over.past] == ["done"] * 4


def test_work_rests_while_the_robot_is_down_and_goes_on_when_it_is_repaired() -> None:
    down = reached(started(0, "base", "cobot"), line("failed", 1, operator="cobot"))
    assert legal(down) == []
    assert objections(down, Event("done", 2, "base")) == [
        "'cobot' was reported as failed; report it as repaired first."
    ]
    up = after(down, Event("repaired", 6, operators=COBOT))
    assert up.running["base"].expected_end == 9
    work = after(up, Event("done", 9.5, "base")).done["base"]
    assert (work.rested, work.worked, work.stated) == (5, 4.5, 4)


def test_a_robot_that_was_unplugged_may_hand_its_task_to_a_human() -> None:
    situation = reached(
        started(0, "base", "cobot"),
        line("failed", 1, operator="cobot"),
        line("failed", 2, task="base"),
    )
    assert legal(situation) == [("base", ANNA)]
    assert situation.past[0].outcome == "broken off"
    assert situation.load == {"anna": 0.0}


def test_a_human_who_leaves_takes_no_task_with_them() -> None:
    gone = reached(*BASE_DONE, started(4, "shaft", "anna"), line("absent", 5, operator="anna"))
    assert gone.running["shaft"].rests_since == 5
    assert gone.idle == COBOT
    assert after(gone, Event("back", 65, operators=ANNA)).running["shaft"].expected_end == 69


def test_what_is_mounted_wrongly_comes_off_from_the_top_and_is_done_again() -> None:
    wrong = reached(*ALL_BUT_COVER, line("wrong", 9, task="base"))
    assert set(wrong.wrong) == {"base", "shaft", "gear"}
    assert legal(wrong) == [("shaft", ANNA), ("gear", COBOT)]
    off = reached(
        *ALL_BUT_COVER, line("wrong", 9, task="base"), started(9, "shaft", "anna"), started(9,
        "gear", "cobot"),
        line("undone", 12, task="gear"), line("undone", 14, task="shaft"), started(14, "base",
        "anna"), line("undone", 20, task="base"),
    )  # fmt: skip
    assert (off.done, off.wrong) == ({}, {})
    assert legal(off) == [("base", COBOT), ("base", ANNA)]
    assert off.load == {"anna": 1 + 1 + 3}, "taking apart strains as mounting does"


def test_what_ends_on_top_of_something_wrong_is_wrong() -> None:
    situation = reached(
        *BASE_DONE, started(4, "shaft", "anna"), line("wrong", 5, task="base"), done(9, "shaft")
    )
    assert set(situation.wrong) == {"base", "shaft"}
    assert legal(situation) == [("shaft", ANNA)]


def test_a_human_may_be_too_early_and_what_they_did_comes_off() -> None:
    event = Event("started", 0, "shaft", ANNA)
    assert objections(reached(), event) == []
    assert "comes after 'base', which is not done" in remarks(reached(), event)[0]
    early = reached(started(0, "shaft", "anna"))
    assert legal(early) == [], "nothing goes below what is in hand"
    assert legal(after(early, Event("done", 5, "shaft"))) == [("shaft", ANNA)]
    assert "comes after 'base'" in objections(reached(), Event("started", 0, "gear", COBOT))[0], (
        "a robot is stopped"
    )


def test_a_mistake_that_is_noticed_at_once_is_wrong_at_once() -> None:
    assert set(reached(started(0, "base", "cobot"), line("wrong", 2, task="base")).wrong) == {
        "base"
    }


def test_a_task_taken_apart_on_the_spot_is_open_again() -> None:
    assert legal(reached(*BASE_DONE, line("undone", 5, task="base"))) == [
        ("base", COBOT),
        ("base", ANNA),
    ]


def test_a_refusal_holds_until_its_time_or_until_they_do_it_after_all() -> None:
    refused = reached(*BASE_DONE, line("refused", 4, task="shaft", operator="anna", until=30))
    assert legal(refused) == [("gear", COBOT)]
    assert next_change(refused) == 30
    assert ("shaft", ANNA) in legal(replace(refused, now=30.0))
    assert after(refused, Event("started", 5, "shaft", ANNA)).refused == {}
    for_good = reached(
        *BASE_DONE,
        line("refused", 4, task="shaft", operator="anna"),
        started(4, "gear", "cobot"),
        done(7, "gear"),
    )
    assert stuck(for_good) == ["task 'shaft' by anna: 'anna' does not want task 'shaft'."]


def test_an_order_binds_nobody_and_keeps_its_number_while_it_is_repeated() -> None:
    first = ordered(reached(), Told((("base", COBOT),), {"anna": "shaft"}), 0)
    assert (first.orders, first.announced) == ({"base": Order(COBOT, 0)}, {"anna": "shaft"})
    assert ("base", ANNA) in legal(first)
    again = ordered(first, Told((("base", COBOT),), {}), 5)
    assert again.orders["base"].number == 0
    taken = after(first, Event("started", 0, "base", ANNA))
    assert revoked(taken, ordered(taken, Told((), {}), 1)) == {}, (
        "what somebody else has begun is no order any more"
    )
    assert revoked(first, ordered(first, Told((), {}), 1)) == {"base": Order(COBOT, 0)}


def test_a_joint_task_is_ordered_from_the_robot_and_asked_of_the_human() -> None:
    told = ordered(reached(*ALL_BUT_COVER), Told((("cover", BOTH),), {}), 7)
    assert (told.orders, told.announced) == ({"cover": Order(BOTH, 7)}, {"anna": "cover"})


CONTRADICTIONS: list[tuple[tuple[str, ...], Event, str]] = [
    ((), Event("done", 1, "base"), "has not been reported as started"),
    (BASE_DONE, Event("done", 5, "base"), "is done already"),
    (BASE_DONE, Event("tick", 3), "time does not run backwards"),
    (BASE_DONE, Event("started", 5, "base", COBOT),
    "is done since 4 s. If it is mounted wrongly, report it as wrong first"),
    (BASE_DONE, Event("started", 5, "gear", ANNA), "anna cannot do task 'gear'; cobot can"),
    (BASE_DONE[:1], Event("started", 1, "base", COBOT), "is under way since 0 s, by cobot"),
    (BASE_DONE[:1], Event("started", 1, "gear", COBOT), "'cobot' is still at task 'base'"),
    (BASE_DONE[:1], Event("done", 1, "base", ANNA), "is being done by cobot, not by anna"),
    (BASE_DONE[:1], Event("refused", 1, "base", COBOT), "report it as failed to give it up"),
    (BASE_DONE[:1], Event("undone", 1, "base"),
    "is being done; report it as failed when nothing is mounted, else as wrong"),
    (BASE_DONE, Event("refused", 5, "base", ANNA), "is done already"),
    (BASE_DONE, Event("refused", 5, "gear", ANNA), "cannot do task 'gear' anyway"),
    (BASE_DONE, Event("failed", 5, "base"), "is done; report it as wrong"),
    ((), Event("failed", 5, "base"), "is not under way"),
    ((), Event("failed", 5, operators=ANNA), "'anna' is a human; report a human as absent"),
    ((), Event("absent", 5, operators=COBOT), "'cobot' is a robot; report a robot as failed"),
    ((), Event("repaired", 5, operators=COBOT), "was not reported as failed"),
    ((), Event("back", 5, operators=COBOT), "'cobot' is a robot; report a robot as repaired"),
    ((line("absent", 1, operator="anna"),), Event("absent", 5, operators=ANNA),
    "was reported as absent already"),
    ((line("absent", 1, operator="anna"),), Event("started", 5, "base", ANNA),
    "report them as back first"),
    ((line("failed", 1, operator="cobot"),), Event("failed", 5, operators=COBOT),
    "was reported as failed already"),
    ((), Event("wrong", 5, "base"), "is not done"),
    ((), Event("undone", 5, "base"), "is not done"),
    ((*BASE_DONE, line("wrong", 4, task="base")), Event("wrong", 5, "base"),
    "was reported as wrong already"),
    (ALL_BUT_COVER, Event("undone", 9, "base"),
    "'shaft' and 'gear' stand on task 'base'; report that as undone first"),
    ((*ALL_BUT_COVER, line("wrong", 9, task="base")), Event("started", 9, "base", COBOT),
    "cannot be taken apart before 'shaft' and 'gear'"),
    ((*BASE_DONE, line("wrong", 4, task="base"), started(4, "base", "cobot")), Event("done", 8,
    "base"), "being taken apart; report that as undone"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("before", "event", "says"),
    CONTRADICTIONS,
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_what_contradicts_the_shift_is_objected_to(
    before: tuple[str, ...], event: Event, says: str
) -> None:
    assert says in "\n".join(objections(reached(*before), event))


def test_tasks_of_a_pair_stay_with_those_who_began() -> None:
    cell = cell_of({
        "operators": {"a": {"kind": "human"}, "b": {"kind": "human"}, "c": {"kind": "robot"}},
        "tasks": {"x": {"time": {"a": 1, "b": 1, "c": 1}}, "y": {"time": {"a": 1, "b": 1}}},
        "same_operator": [["x", "y"]],
    })  # fmt: skip
    assert ("x", ("c",)) not in legal(Situation.of(cell))
    assert legal(reached(started(0, "x", "b"), cell=cell)) == []
    assert legal(reached(started(0, "x", "b"), done(1, "x"), cell=cell)) == [("y", ("b",))]


def test_what_is_odd_is_taken_with_a_remark() -> None:
    tasks: dict[str, Any] = {
        "x": {"time": {"a": 5}, "zone": "jig"},
        "y": {"time": {"b": 5}, "zone": "jig"},
    }
    cell = cell_of(
        {
            "operators": {"a": {"kind": "human", "breaks": [[4, 6]]}, "b": {"kind": "robot"}},
            "tasks": tasks,
        }
    )
    assert remarks(Situation.of(cell), Event("started", 0, "x", ("a",))) == [
        "'a' has a break from 4 s to 6 s."
    ]
    assert (
        remarks(reached(started(0, "y", "b"), cell=cell), Event("started", 0, "x", ("a",)))[-1]
        == "zone 'jig' is taken."
    )
