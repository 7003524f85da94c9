"""What may happen on a floor, for hypothesis: lines that mostly fit where the shift stands, so that
it comes far.
"""

from __future__ import annotations

import json
from dataclasses import replace

from hypothesis import strategies as st

from tandem.cell.model import Cell
from tandem.dispatch.situation.events import Event
from tandem.dispatch.situation.legal import legal
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.objections import objections
from tandem.dispatch.situation.transitions import after


@st.composite
def happenings(draw: st.DrawFn, cell: Cell, most: int = 30) -> list[str]:
    """Lines of events: work that begins and ends, refusals, absences, breakdowns, mistakes; some
    stand twice, some are refused.
    """
    situation, lines = Situation.of(cell), list[str]()
    for number in range(draw(st.integers(0, most))):
        at = round(situation.now + draw(st.sampled_from((0, 0, 0.5, 1, 2, 5))), 3)
        there = replace(situation, now=at)
        kind = draw(st.sampled_from(("begins", "begins", "ends", "ends", "any", "any", "again")))
        if kind == "again" and lines:
            lines.append(draw(st.sampled_from(lines)))
            continue
        begins = [Event("started", at, task, operators) for task, operators in legal(there)]
        ends = [
            Event("undone" if on.undoing else "done", at, task)
            for task, on in there.running.items()
        ]
        fitting = [event for event in _all_events(cell, at) if not objections(situation, event)]
        event = draw(st.sampled_from({"begins": begins, "ends": ends}.get(kind) or fitting))
        if not objections(situation, event):
            situation = after(situation, event)
        lines.append(
            json.dumps({**event.to_dict(), **({"id": f"e{number}"} if draw(st.booleans()) else {})})
        )
    return lines


def _all_events(cell: Cell, at: float) -> list[Event]:
    """One of every kind about everything, whether it can have happened or not."""
    tasks = [
        Event(kind, at, task)
        for task in cell.tasks
        for kind in ("done", "failed", "wrong", "undone")
    ]
    tasks += [
        Event("started", at, task, way.operators) for task in cell.tasks for way in cell.modes(task)
    ]
    tasks += [
        Event("refused", at, task, (who,), until)
        for task in cell.tasks
        for who in cell.operators
        for until in (None, at + 3)
    ]
    people = [
        Event(kind, at, operators=(who,))
        for who in cell.operators
        for kind in ("absent", "back", "failed", "repaired")
    ]
    return [*tasks, *people, Event("tick", at)]
