"""In a shift nobody is asked to exceed a limit of theirs; where that leaves nothing, the shift says
so, and a person who does it all the same is believed and told of.
"""

from __future__ import annotations

import pytest
from tests import limited
from tests.dispatch.test_situation import done, reached, started

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.shift.documents import stuck
from tandem.dispatch.situation.events import read_event
from tandem.dispatch.situation.legal import hindrances, legal
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.objections import objections, remarks

ANNA, BEN, COBOT = ("anna",), ("ben",), ("cobot",)


def test_what_a_limit_forbids_is_not_legal_and_says_why() -> None:
    start = reached(cell=limited.cell(peak_reba=8))
    assert legal(start) == [("base", BEN), ("base", COBOT), ("close", COBOT)]
    (way,) = [way for way in start.facts.ways["close"] if way.operators == ANNA]
    assert list(hindrances(start, "close", way)) == [
        "'anna' would have 11 of peak:reba, the limit is 8"
    ]


def test_what_was_done_counts() -> None:
    worked = (started(0, "base", "anna"), done(4, "base"))
    later = reached(*worked, cell=limited.cell(dose_lifft=0.25))
    assert ("cover", ANNA) not in legal(later)
    (way,) = [way for way in later.facts.ways["cover"] if way.operators == ANNA]
    assert list(hindrances(later, "cover", way)) == [
        "'anna' would come to 0.3 of dose:lifft with what is left, the limit is 0.25"
    ]


@pytest.mark.parametrize("name", ["replan", "replan-robust", "expected", "longest-tail"])
def test_no_decider_asks_for_more(name: str) -> None:
    cell = limited.cell(peak_reba=8)
    decider = policy(name, cell, SECONDS, Options())
    decision = decider.decide(Situation.of(cell))
    assert decision.starts
    assert ("anna",) not in {team for task, team in decision.starts if task != "cover"}


def only_anna_covers() -> Cell:
    data = limited.data(dose_lifft=0.25)
    data["tasks"]["cover"]["time"] = {"anna": 2}
    return limited.cell_of(data)


def test_a_person_who_exceeds_it_is_believed_and_what_is_left_is_said_to_be_stuck() -> None:
    """She began base though she was not asked; then nobody may cover, and the shift says why."""
    cell = only_anna_covers()
    start = reached(cell=cell)
    event = read_event(started(0, "base", "anna"), cell)
    assert objections(start, event) == []
    assert remarks(start, event) == [
        "'anna' would come to 0.3 of dose:lifft with what is left, the limit is 0.25."
    ]
    worked = (started(0, "base", "anna"), started(0, "close", "cobot"), done(4, "close"))
    end = reached(*worked, done(4, "base"), cell=cell)
    assert legal(end) == []
    assert any("'anna' would come to 0.3 of dose:lifft" in told for told in stuck(end))
