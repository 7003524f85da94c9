"""What a schedule is worth: makespan, stress, idle time, utilisation, difficulty.

Sums are exact: every number is taken as the decimal that it prints as, and only the result becomes
the nearest float.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import NamedTuple

from tandem.cell.model import Cell
from tandem.cell.parts import Mode
from tandem.cell.written import number
from tandem.errors import UnsoundScheduleError
from tandem.schedule.model import Assignment, Schedule


def makespan(schedule: Schedule) -> float:
    """When the last task ends, seconds; 0 for an empty schedule."""
    return max((a.end for a in schedule), default=0.0)


def stress(cell: Cell, schedule: Schedule) -> float:
    """The cell's measure of stress: the sum over the tasks done by humans, or the value of that set
    in `stress_of_set`.

    Raises:
      UnsoundScheduleError: an assignment is no way of doing its task, or `stress_of_set` does not
        list the set.
    """
    modes = [(a, _mode(cell, a)) for a in schedule]
    if cell.stress_of_set is None:
        return float(
            sum((exact(load) for _, mode in modes for load in mode.stress.values()), Decimal(0))
        )
    done = {a.task for a, mode in modes if mode.stress}
    listed = stress_of_tasks(cell, done)
    if listed is None:
        raise UnsoundScheduleError([unlisted_set(cell, done)])
    return listed


def stress_by_human(cell: Cell, schedule: Schedule) -> dict[str, float]:
    """Per human, the sum of their own stress over their tasks. Raises UnsoundScheduleError as
    `stress` does.
    """
    sums = dict.fromkeys(cell.humans, Decimal(0))
    for a in schedule:
        for human, load in _mode(cell, a).stress.items():
            sums[human] += exact(load)
    return {human: float(total) for human, total in sums.items()}


def peak_stress(cell: Cell, schedule: Schedule) -> float:
    """The largest stress that one task puts on one human; 0 when humans do nothing. Raises
    UnsoundScheduleError as `stress` does.
    """
    return max((load for a in schedule for load in _mode(cell, a).stress.values()), default=0.0)


def difficulty(cell: Cell, schedule: Schedule) -> float:
    """Sum over all tasks of their difficulty for each operator who does them; what the cell does
    not state is 0.
    """
    return float(
        sum(
            (
                exact(cell.tasks[a.task].difficulty.get(who, 0.0))
                for a in schedule
                for who in a.operators
            ),
            Decimal(0),
        )
    )


def working(cell: Cell, schedule: Schedule) -> dict[str, float]:
    """Seconds that each operator spends on tasks."""
    return {name: float(seconds) for name, seconds in _working(cell, schedule).items()}


def utilisation(cell: Cell, schedule: Schedule) -> dict[str, float]:
    """Share of the makespan that each operator spends on tasks; 0 in an empty schedule."""
    total = exact(makespan(schedule))
    return {
        name: float(seconds / total) if total else 0.0
        for name, seconds in _working(cell, schedule).items()
    }


def changing(cell: Cell, schedule: Schedule) -> dict[str, float]:
    """Seconds that each operator spends on getting ready, if it does anything at all, on walking
    and on changeovers.
    """
    return {name: float(seconds) for name, seconds in _changing(cell, schedule).items()}


def idle(cell: Cell, schedule: Schedule) -> dict[str, float]:
    """Seconds until the makespan in which an operator neither works, nor walks, nor changes tools,
    nor has a break.
    """
    total = exact(makespan(schedule))
    busy, swaps = _working(cell, schedule), _changing(cell, schedule)
    off = _resting(cell, schedule)
    return {name: float(total - busy[name] - swaps[name] - off[name]) for name in busy}


def resting(cell: Cell, schedule: Schedule) -> dict[str, float]:
    """Seconds of each operator's breaks until the makespan."""
    return {name: float(seconds) for name, seconds in _resting(cell, schedule).items()}


def _resting(cell: Cell, schedule: Schedule) -> dict[str, Decimal]:
    total = exact(makespan(schedule))
    return {
        name: sum(
            (max(Decimal(0), min(total, exact(end)) - exact(start)) for start, end in op.breaks),
            Decimal(0),
        )
        for name, op in cell.operators.items()
    }


def _changing(cell: Cell, schedule: Schedule) -> dict[str, Decimal]:
    seconds = {
        name: exact(operator.setup) if schedule.of(name) else Decimal(0)
        for name, operator in cell.operators.items()
    }
    for name, _, ready in _all_ready(cell, schedule):
        seconds[name] += exact(ready.seconds)
    return seconds


@dataclass(frozen=True)
class Changeover:
    """An operator takes up a tool directly before a task; `start` and `end` in seconds, `task` is
    what it is needed for.
    """

    operator: str
    tool: str
    task: str
    start: float
    end: float


@dataclass(frozen=True)
class Walk:
    """An operator walks to the place of a task, before the changeover should there be one; `start`
    and `end` in seconds, `task` is what it goes there for.
    """

    operator: str
    origin: str
    place: str
    task: str
    start: float
    end: float


def changeovers(cell: Cell, schedule: Schedule) -> tuple[Changeover, ...]:
    """Every changeover that takes time, in the cell's order of operators and then in time."""
    return tuple(
        Changeover(name, ready.tool, a.task, float(exact(a.start) - exact(ready.change)), a.start)
        for name, a, ready in _all_ready(cell, schedule)
        if ready.change
    )


def walks(cell: Cell, schedule: Schedule) -> tuple[Walk, ...]:
    """Every walk that takes time, in the cell's order of operators and then in time."""
    return tuple(
        Walk(
            name,
            ready.origin,
            ready.place,
            a.task,
            float(exact(a.start) - exact(ready.seconds)),
            float(exact(a.start) - exact(ready.change)),
        )
        for name, a, ready in _all_ready(cell, schedule)
        if ready.walk
    )


def _all_ready(cell: Cell, schedule: Schedule) -> Iterator[tuple[str, Assignment, Ready]]:
    for name in cell.operators:
        rows = schedule.of(name)
        for a, ready in zip(rows, made_ready(cell, name, rows), strict=True):
            yield name, a, ready


class Ready(NamedTuple):
    """What an operator does directly before a task, without a pause: it walks, then it takes up a
    tool.

    Attributes:
      walk: seconds from `origin` to `place`; 0 where it need not walk.
      change: seconds to take up `tool`; 0 where it need not.
    """

    walk: float = 0.0
    origin: str = ""
    place: str = ""
    change: float = 0.0
    tool: str = ""

    @property
    def seconds(self) -> float:
        """Walking and the changeover together."""
        return float(exact(self.walk) + exact(self.change)) if self.walk else self.change


def made_ready(cell: Cell, operator: str, assignments: Iterable[Assignment]) -> list[Ready]:
    """What the operator does before each of these tasks, done in this order."""
    in_hand, at = cell.operators[operator].tool, cell.operators[operator].place
    ways = cell.walking.get(operator, {})
    found = []
    for a in assignments:
        place = cell.tasks[a.task].place if a.task in cell.tasks else None
        tool = cell.tools_for(a.task, a.operators).get(operator) if a.task in cell.tasks else None
        ready = Ready()
        if place is not None:
            if at is not None and (walk := ways.get((at, place))):
                ready = Ready(walk, at, place)
            at = place
        if tool is not None:
            if in_hand not in (None, tool) and tool in cell.tools:
                change = cell.tools[tool].changeover.get(operator, 0.0)
                ready = ready._replace(change=change, tool=tool)
            in_hand = tool
        found.append(ready)
    return found


def mode_of(cell: Cell, assignment: Assignment) -> Mode | None:
    """The mode that these operators and this duration mean; None when the task has no such mode.

    Of modes that differ in stress alone, the one of least stress: an assignment cannot tell them
    apart.
    """
    if assignment.task not in cell.tasks:
        return None
    who, seconds = set(assignment.operators), exact(assignment.end) - exact(assignment.start)
    same = [
        mode
        for mode in cell.modes(assignment.task)
        if who == set(mode.operators) and exact(mode.time) == seconds
    ]
    return min(same, key=lambda mode: sum(map(exact, mode.stress.values())), default=None)


def stress_of_tasks(cell: Cell, tasks: set[str]) -> float | None:
    """The value of this set of tasks in the cell's `stress_of_set`; None when the set is not
    listed.
    """
    table: Mapping[str, float] = cell.stress_of_set or {}
    key = ",".join(name for name in cell.tasks if name in tasks)
    if key in table:
        return table[key]
    return next(
        (value for names, value in table.items() if set(filter(None, names.split(","))) == tasks),
        None,
    )


def unlisted_set(cell: Cell, tasks: set[str]) -> str:
    """The sentence about a set that `stress_of_set` does not list."""
    names = ",".join(name for name in cell.tasks if name in tasks)
    return (
        f"stress_of_set does not list {names!r}, the tasks that humans do here: this set of tasks"
        " is not allowed."
    )


def exact(number: float) -> Decimal:
    """The decimal that the number prints as."""
    return Decimal(repr(float(number)))


def _working(cell: Cell, schedule: Schedule) -> dict[str, Decimal]:
    seconds = dict.fromkeys(cell.operators, Decimal(0))
    for a in schedule:
        for name in a.operators:
            seconds[name] += exact(a.end) - exact(a.start)
    return seconds


def _mode(cell: Cell, assignment: Assignment) -> Mode:
    mode = mode_of(cell, assignment)
    if mode is None:
        raise UnsoundScheduleError(
            [
                f"task {assignment.task!r}: {' and '.join(assignment.operators) or 'nobody'} from"
                f" {number(assignment.start)} s to {number(assignment.end)} s is no way of doing"
                " it; `faults` says what is wrong."
            ]
        )
    return mode
