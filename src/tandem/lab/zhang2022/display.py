"""What the human is shown: what to do now, what comes next; from a list of choices, as data and as
lines for a terminal.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.lab.zhang2022.change import Change, Happened, Kind
from tandem.lab.zhang2022.setting import HUMAN, ROBOT, Duo, duo, setting, tool_of
from tandem.lab.zhang2022.world import State, is_done, now, reset, step
from tandem.schedule.model import Assignment, Schedule
from tandem.world import state as events
from tandem.world.arrays import NEVER, Names

CALM = Change(np.int32(NEVER), np.float32(0), np.float32(0))
"""Nothing unforeseen happens."""


@dataclass(frozen=True)
class Episode:
    """One assembly as it was done.

    Attributes:
      schedule: what was begun; a part that was redone stands in it twice.
      happened: what nobody foresaw, in words; empty when nothing happened. at: when, seconds.
    """

    schedule: Schedule
    happened: str
    at: float | None


def episode(cell: Cell, actions: Sequence[Sequence[int]], change: Change = CALM) -> Episode:
    """The assembly that these choices of robot and human make, at nominal times.

    Raises CellError for a cell that two agents cannot express.
    """
    data, names = duo(cell)
    numbers, rows = setting(), []
    state = reset(data, np.ones(len(cell.tasks), np.float32), change)
    for action in actions:
        if is_done(state):
            break
        rows += _begun(data, names, state, action)
        state, _ = step(data, numbers, state, np.asarray(action, np.int32))
    what = words(cell, names, data, state.happened)
    return Episode(Schedule(tuple(rows)), what, names.seconds(int(change.at)) if what else None)


def _begun(data: Duo, names: Names, state: State, action: Sequence[int]) -> list[Assignment]:
    picked = {
        int(np.argmax(data.pick[agent, action[agent]])) for agent in (ROBOT, HUMAN) if action[agent]
    }
    starts = events.starts(now(data, state), state.assembly)
    return [
        names.assignment(way, int(starts[way]), int(starts[way] + data.arrays.way_ticks[way]))
        for way in picked
    ]


def words(cell: Cell, names: Names, data: Duo, happened: Happened) -> str:
    """What happened, in a sentence; empty when nothing did."""
    which = int(happened.which)
    if happened.kind == Kind.ABILITY_LOST:
        tasks = [
            task for (task, _), lost in zip(names.ways, data.ability[which], strict=True) if lost
        ]
        tool = tool_of(cell, tasks[0])
        return f"{cell.robots[0]} can no longer {f'use the {tool}' if tool else f'do {tasks[0]!r}'}"
    if happened.kind == Kind.PART_REDONE:
        return f"{names.tasks[which]!r} has to be done again"
    if happened.kind == Kind.TOOL_MISSING:
        return (
            f"the {names.tools[which]} is missing until"
            f" {names.seconds(int(happened.back_at[which])):g} s"
        )
    return ""


def shown(cell: Cell, schedule: Schedule, *, since: float = 0.0) -> list[dict[str, Any]]:
    """What the display says, each time that it changes: moment, and per operator what is on `now`
    and what comes `next`.

    An operation is `{"task", "with", "tool", "start", "end"}`, `with` the others who take part;
    None when there is none. Seconds.
    """
    moments = sorted(
        {row.start for row in schedule if row.start >= since}
        | {row.end for row in schedule if row.end > since}
        | {since}
    )
    return [
        {"at": moment, **{name: _of(cell, schedule, name, moment) for name in cell.operators}}
        for moment in moments[:-1] or moments
    ]


def _of(cell: Cell, schedule: Schedule, name: str, moment: float) -> dict[str, Any]:
    own = schedule.of(name)
    on = next((row for row in own if row.start <= moment < row.end), None)
    following = next((row for row in own if row.start > moment), None)
    return {
        "now": on and _operation(cell, name, on),
        "next": following and _operation(cell, name, following),
    }


def _operation(cell: Cell, name: str, row: Assignment) -> dict[str, Any]:
    others = [other for other in row.operators if other != name]
    return {
        "task": row.task,
        "with": others,
        "tool": tool_of(cell, row.task),
        "start": row.start,
        "end": row.end,
    }


def lines(cell: Cell, rows: Sequence[Mapping[str, Any]], operator: str | None = None) -> list[str]:
    """The display as a person reads it, a line a change; of the human, or of another `operator`."""
    name = operator or cell.humans[0]
    texts, before = [], None
    for row in rows:
        told = (row[name]["now"], row[name]["next"])
        if told != before:
            texts.append(
                f"{row['at']:7g} s  now: {_say(told[0], 'until', 'end') or 'wait'}; next:"
                f" {_say(told[1], 'at', 'start') or 'nothing more'}"
            )
        before = told
    return texts


def _say(operation: Mapping[str, Any] | None, word: str, when: str) -> str:
    if operation is None:
        return ""
    tool = f", {operation['tool']}" if operation["tool"] else ""
    partner = f" with {' and '.join(operation['with'])}" if operation["with"] else ""
    return f"{operation['task']}{partner}{tool} ({word} {operation[when]:g} s)"
