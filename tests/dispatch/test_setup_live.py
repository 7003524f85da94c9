"""Operators get ready when a shift begins: deciders wait for it, and it is over once and for
all.
"""

from __future__ import annotations

import pytest
from tests.dispatch.cells import line
from tests.dispatch.test_situation import done, reached, started

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.situation.legal import hindrances, legal, next_change
from tandem.dispatch.situation.model import Situation
from tandem.files.validate import cell_of

ANNA, COBOT = ("anna",), ("cobot",)


def bench() -> Cell:
    """Anna is ready at 6 s, for a break cuts her first piece of time; the cobot at 2 s."""
    return cell_of({
        "operators": {"anna": {"kind": "human", "setup": 3, "breaks": [[1, 3]]},
        "cobot": {"kind": "robot", "setup": 2}},
        "tasks": {"base": {"time": {"anna": 4, "cobot": 5}}, "cover": {"time": {"anna": 1}}},
    })  # fmt: skip


def test_nothing_is_legal_before_somebody_is_ready_and_the_clock_says_when() -> None:
    start = reached(cell=bench())
    assert legal(start) == []
    assert next_change(start) == 2
    (way,) = [way for way in start.facts.ways["base"] if way.operators == ANNA]
    assert list(hindrances(start, "base", way)) == ["'anna' is set up only at 6 s"]
    ticked = reached(line("tick", 2), cell=bench())
    assert legal(ticked) == [("base", COBOT)]
    assert next_change(ticked) == 6


def test_who_was_away_or_has_worked_need_not_get_ready_again() -> None:
    away = (line("absent", 1, operator="anna"), line("back", 8, operator="anna"))
    assert legal(reached(*away, cell=bench())) == [("base", ANNA), ("base", COBOT), ("cover", ANNA)]
    worked = (started(6, "cover", "anna"), done(7, "cover"))
    assert legal(reached(*worked, cell=bench())) == [("base", ANNA), ("base", COBOT)]


@pytest.mark.parametrize("name", ["replan", "replan-robust", "expected", "fixed", "longest-tail"])
def test_a_decider_asks_nobody_who_is_not_ready(name: str) -> None:
    decider = policy(name, bench(), SECONDS, Options())
    assert decider.decide(Situation.of(bench())).starts == ()
    ready = reached(line("tick", 2), cell=bench())
    assert {who for _, team in decider.decide(ready).starts for who in team} <= {"cobot"}
