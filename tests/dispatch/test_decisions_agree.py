"""What a decision says agrees with what it does: over any events, of all deciders."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dispatch.cells import Plain, in_time
from tests.dispatch.cells import line as event
from tests.dispatch.happenings import happenings
from tests.dispatch.stations import THESIS
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import POLICIES, policy
from tandem.dispatch.journal import Journal
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.shift.deadline import InTime
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.situation.model import Situation
from tandem.errors import CellError, InfeasibleError, UsageError
from tandem.files.validate import cell_of

Document = dict[str, Any]
DECIDERS = list(POLICIES)
OBJECTIVES = (Objective(), Objective(1.0, 0.5), Objective(0.0, 1.0))


def begins_in_words(shift: Shift, decision: Document) -> str:
    """What begins by `starts`, `asks` and `take_apart`, said as `why` must say it; in the order of
    the cell.
    """
    rows = {
        (row["task"], tuple(row["operators"])): None
        for row in [*decision["asks"], *decision["starts"]]
    }
    said = []
    for task, operators in rows:
        who, several = " and ".join(operators), len(operators) > 1
        apart = task in shift.situation.wrong
        if any(shift.cell.operators[one].kind == "human" for one in operators):
            said.append(
                f"{who} {'are' if several else 'is'} asked"
                f" {f'to take {task} apart' if apart else f'for {task}'}"
            )
        elif apart:
            said.append(f"{who} {'take' if several else 'takes'} {task} apart")
        else:
            said.append(f"{who} {'do' if several else 'does'} {task}")
    return ", ".join(sorted(said)) or "nothing begins now"


def agrees(shift: Shift, decision: Document) -> None:
    """Raises AssertionError where a decision contradicts itself or the shift."""
    if decision["over"]:
        assert (decision["starts"], decision["asks"], decision["announced"]) == ([], [], {})
        return
    told, _, _ = decision["why"].partition(":")
    assert ", ".join(sorted(told.split(", "))) == begins_in_words(shift, decision), decision
    rows = {
        (row["task"], tuple(row["operators"])) for row in [*decision["starts"], *decision["asks"]]
    }
    tasks = [task for task, _ in rows]
    busy = [who for _, operators in rows for who in operators]
    assert len(tasks) == len(set(tasks)), "a task is given to one group"
    assert len(busy) == len(set(busy)), "nobody is told two things"
    assert set(busy) <= set(shift.situation.idle), "who is told something is there and free"
    for task, operators in rows:
        assert task in shift.situation.open
        assert not any(shift.situation.is_refused(who, task) for who in operators), (
            "what is refused is not asked for"
        )
        humans = [who for who in operators if shift.cell.operators[who].kind == "human"]
        assert all(decision["announced"].get(who) == task for who in humans), (
            "who is asked is announced the same"
        )
        assert bool(humans) == any(
            (row["task"], tuple(row["operators"])) == (task, operators) for row in decision["asks"]
        )
    for row in decision["revoked"]:
        assert (row["task"], tuple(row["operators"])) not in rows, "what is revoked does not begin"
    for who, task in decision["announced"].items():
        assert task in shift.situation.open, "nobody is asked for what is done or under way"
        assert who in busy or who not in shift.situation.idle, "who is free is asked now or waits"
        group = next((operators for other, operators in rows if other == task), (who,))
        assert who in group, "a task that begins now is announced to nobody else"
    assert set(decision["take_apart"]) <= set(shift.situation.wrong)


def decided(
    cell: Cell, name: str, objective: Objective, lines: Iterable[str]
) -> Iterable[tuple[Shift, Document]]:
    """Each decision of a shift over these lines, as it is made. Nobody is late: the decider has all
    the time it takes.
    """
    settings = Settings(name, objective, Options(budget_ms=60.0))
    made = settings.decider(cell)
    with Journal() as journal:
        shift = Shift.open(
            cell, journal, settings, decider=InTime(made.policy, made.rule, 60_000.0)
        )
        yield shift, shift.decision
        for line in lines:
            yield from (
                (shift, document) for document in shift.take(line) if document["type"] == "decision"
            )


@settings(max_examples=60)
@given(st.data(), cells(max_tasks=6), st.sampled_from(DECIDERS), st.sampled_from(OBJECTIVES))
def test_what_a_decision_says_is_what_it_does(
    data: st.DataObject, cell: Cell, name: str, objective: Objective
) -> None:
    lines = data.draw(happenings(cell))
    try:
        for shift, decision in decided(cell, name, objective, lines):
            agrees(shift, decision)
            assert (decision["instead"], decision.get("fault")) == ("", None), decision
    except (CellError, UsageError, InfeasibleError):
        return  # a cell that this decider does not take


@settings(max_examples=20)
@given(st.data(), cells(max_tasks=6))
def test_what_the_last_resort_says_is_what_it_does(data: st.DataObject, cell: Cell) -> None:
    """Nobody else could answer; here also where stress comes from a table of sets, which no decider
    takes.
    """
    with Journal() as journal:
        shift = Shift.open(cell, journal, Settings(), decider=in_time(Plain("plain")))
        agrees(shift, shift.decision)
        for line in data.draw(happenings(cell)):
            for document in shift.take(line)[1:]:
                agrees(shift, document)


REFUSED = [
    event("started", 0, task="1", operator="robot"),
    event("started", 0, task="2", operator="human"),
    event("done", 8, task="2"),
    event("done", 9, task="1"),
    event("refused", 9, task="4", operator="robot"),
]
"""The robot alone can do task 4 of the thesis's cell, and will not."""
AWAY = [
    event("absent", 0, operator="human"),
    event("failed", 1, operator="robot"),
    event("back", 2, operator="human"),
]
MOUNTED_WRONGLY = [
    *REFUSED[:4],
    event("wrong", 9, task="1"),
    event("refused", 9, task="1", operator="robot"),
]
NOT_UNTIL = [
    *REFUSED[:4],
    event("refused", 9, task="4", operator="robot", until=20),
    event("tick", 20),
]


@pytest.mark.parametrize(
    "lines",
    [REFUSED, AWAY, MOUNTED_WRONGLY, NOT_UNTIL],
    ids=["refused", "away", "wrong", "not before"],
)
@pytest.mark.parametrize("name", DECIDERS)
def test_nobody_is_said_to_do_what_is_not_allowed(name: str, lines: list[str]) -> None:
    """Once: `starts: []`, task 4 revoked, and "robot does 4: by the rule"."""
    for shift, decision in decided(THESIS, name, Objective(), lines):
        agrees(shift, decision)


def test_a_group_is_asked_in_the_plural_and_one_in_the_singular() -> None:
    operators = {
        "Werker 1": {"kind": "human"},
        "Werker 2": {"kind": "human"},
        "Cobot": {"kind": "robot"},
    }
    tasks = {
        "halves": {"time": {}, "together": [{"operators": ["Werker 1", "Werker 2"], "time": 3}]},
        "test": {"time": {"Cobot": 4}},
    }
    cell = cell_of({"name": "Both", "operators": operators, "tasks": tasks})
    decision = policy("longest-tail", cell).decide(Situation.of(cell))
    assert (
        decision.why == "Werker 1 and Werker 2 are asked for halves, Cobot does test: by the rule"
        " 'longest-tail'."
    )
    gone = replace(Situation.of(cell), absent=frozenset({"Werker 2"}))
    assert (
        policy("longest-tail", cell).decide(gone).why
        == "Cobot does test: by the rule 'longest-tail'."
    )
