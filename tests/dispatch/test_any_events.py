"""Whatever comes in, in whatever order: nothing impossible is believed, and the journal leads to
the same place again.
"""

from __future__ import annotations

import json
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dispatch.cells import in_time
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.dispatch.journal import Journal
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.shift.replay import replay
from tandem.dispatch.situation.events import KINDS
from tandem.dispatch.situation.legal import legal
from tandem.dispatch.situation.model import Situation


@st.composite
def reports(draw: st.DrawFn, cell: Cell) -> list[str]:
    """Lines that use the cell's own words, in any order; some come twice, some fit."""
    lines, at = [], 0.0
    for _ in range(draw(st.integers(1, 25))):
        at = max(0.0, at + draw(st.sampled_from((-1, 0, 0, 0.5, 1, 2, 5))))
        row: dict[str, Any] = {
            "event": draw(st.sampled_from([*KINDS, "started", "done", "started", "done"])),
            "at": at,
        }
        task = draw(st.sampled_from(list(cell.tasks)))
        row |= {} if KINDS[row["event"]].task == "no" else {"task": task}
        if KINDS[row["event"]].operators in ("one", "some"):
            way = draw(st.sampled_from(cell.modes(task))).operators
            row |= (
                {"operator": way[0]}
                if KINDS[row["event"]].operators == "one" or len(way) == 1
                else {"operators": list(way)}
            )
        row |= {"id": str(draw(st.integers(0, 30)))} if draw(st.booleans()) else {}
        lines += [json.dumps(row)] * draw(st.sampled_from((1, 1, 1, 2)))
    return lines


@settings(max_examples=25)
@given(st.data(), cells(max_tasks=5))
def test_no_report_makes_the_impossible_true(data: st.DataObject, cell: Cell) -> None:
    with Journal() as journal:
        shift = Shift.open(cell, journal, Settings(), decider=in_time())
        for text in data.draw(reports(cell)):
            before = shift.situation
            answer, *_ = shift.take(text)
            assert answer["accepted"] or (answer["reasons"] and shift.situation == before)
            _is_possible(shift.situation)
        again = Shift.open(cell, journal, Settings(), decider=in_time())
        assert (again.situation, again.number, again.decision) == (
            shift.situation,
            shift.number,
            shift.decision,
        )
        assert replay(cell, journal, decider=in_time()).differences == ()


def _is_possible(situation: Situation) -> None:
    busy = [who for at in situation.running.values() for who in at.operators]
    assert len(busy) == len(set(busy)), "nobody is at two tasks at once"
    assert not situation.done.keys() & situation.running.keys()
    assert not situation.done.keys() & situation.wrong.keys()
    assert all(work.worked >= 0 and work.end <= situation.now for work in situation.past)
    assert all(
        first in situation.done
        for task in situation.done
        for first in situation.cell.tasks[task].after
    )
    assert all(set(operators) <= set(situation.idle) for _, operators in legal(situation))
    gone = situation.absent | situation.failed
    assert all(
        (at.rests_since is not None) == bool(gone.intersection(at.operators))
        for at in situation.running.values()
    )
