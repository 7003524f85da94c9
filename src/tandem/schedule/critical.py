"""Why a schedule takes as long as it does: its critical path, and how far each task could slip."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Literal, NamedTuple

from tandem.cell.model import Cell
from tandem.cell.written import number
from tandem.schedule.measures import changeover_times, exact
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.parts import parts_handed_over

Reason = Literal[
    "start",
    "release",
    "break",
    "setup",
    "predecessor",
    "operator",
    "changeover",
    "tool",
    "zone",
    "hold",
    "choice",
]


@dataclass(frozen=True)
class Link:
    """One task on the critical path, and what it waited for.

    Attributes:
      assignment: the task.
      reason: why it starts exactly when it does: at the "start" of the assembly (there may be a
        changeover first), at its "release", when a "break" or the "setup" of `by` ends, when its
        "predecessor" `by` ends, when the "operator" `by` is free, when that operator's "changeover"
        is done, when a unit of the "tool" or a place in the "zone" `by` is given back, when the
        machine `by` is free to "hold" a part, or free of the one that it held; or by "choice": it
        could have started earlier.
      by: name of the predecessor, operator, tool, zone or machine; empty otherwise.
      waited_for: the task before it on the path, which ended then; None at the path's beginning.
    """

    assignment: Assignment
    reason: Reason
    by: str = ""
    waited_for: str | None = None

    def __str__(self) -> str:
        wait = {
            "start": "from the start",
            "release": "at its release",
            "break": f"after a break of {self.by}",
            "setup": f"when {self.by} is set up",
            "predecessor": f"when {self.waited_for} has ended",
            "operator": f"when {self.by} is free from {self.waited_for}",
            "changeover": f"when {self.by} has changed tools after {self.waited_for}",
            "tool": f"when {self.waited_for} gives back tool {self.by}",
            "zone": f"when {self.waited_for} leaves zone {self.by}",
            "hold": f"when {self.by} is free after {self.waited_for}",
            "choice": "later than it could",
        }
        return f"{self.assignment.task} at {number(self.assignment.start)} s, {wait[self.reason]}"


def critical_path(cell: Cell, schedule: Schedule) -> tuple[Link, ...]:
    """A chain of tasks from the start, a release or a break to the makespan, each starting exactly
    when what it waited for ended.

    Of several chains, one that reaches back to the start rather than to a task that could have
    started earlier. Assumes a sound schedule; empty for an empty one. In a schedule with gaps that
    nothing explains the chain begins with a "choice".
    """
    if not len(schedule):
        return ()
    plan = _Plan.of(cell, schedule)
    best: dict[str, Link] = {}
    grounded: dict[str, bool] = {}
    for a in schedule:
        links = sorted(
            plan.links(a),
            key=lambda link: (
                not grounded.get(link.waited_for or "", True),
                _PREFERENCE.index(link.reason),
            ),
        )
        best[a.task] = links[0] if links else Link(a, "choice")
        grounded[a.task] = bool(links) and (
            links[0].waited_for is None or grounded[links[0].waited_for]
        )
    makespan = max(a.end for a in schedule)
    path = [
        best[
            min(
                (a for a in schedule if a.end == makespan), key=lambda a: (not grounded[a.task], a)
            ).task
        ]
    ]
    while (before := path[-1].waited_for) is not None:
        path.append(best[before])
    return tuple(reversed(path))


def links(cell: Cell, schedule: Schedule) -> dict[str, tuple[Link, ...]]:
    """Task -> every reason for which it cannot start a moment earlier, none when it could. Assumes
    a sound schedule.
    """
    plan = _Plan.of(cell, schedule)
    return {a.task: tuple(plan.links(a)) for a in schedule}


def slack(cell: Cell, schedule: Schedule) -> dict[str, float]:
    """Task -> seconds by which its end can slip without a later makespan or a missed deadline.

    Allocation and order are kept: on every operator, and on every unit of a tool and place in a
    zone. Tasks that follow may slip along; breaks stay free of work and changeovers. Assumes a
    sound schedule.
    """
    plan = _Plan.of(cell, schedule)
    makespan = max((exact(a.end) for a in schedule), default=Decimal(0))
    latest: dict[str, Decimal] = {}
    for a in reversed(schedule.assignments):
        deadline = cell.tasks[a.task].deadline
        limits = [makespan, *([] if deadline is None else [exact(deadline)])]
        time = exact(a.end) - exact(a.start)
        for after, gap in plan.followers[a.task]:
            row = plan.of_task[after]
            limits.append(latest[after] - (exact(row.end) - exact(row.start)) - gap)
        latest[a.task] = plan.latest_end(a, min(limits), time)
    return {a.task: float(latest[a.task] - exact(a.end)) for a in schedule}


_PREFERENCE: tuple[Reason, ...] = (
    "start",
    "predecessor",
    "operator",
    "changeover",
    "release",
    "break",
    "setup",
    "tool",
    "zone",
    "hold",
    "choice",
)


class _Turn(NamedTuple):
    """One operator's part in a task: what the operator did before, and the changeover (seconds)
    directly before it.
    """

    operator: str
    previous: Assignment | None
    change: Decimal


@dataclass(frozen=True)
class _Plan:
    """A sound schedule with what follows what.

    Attributes:
      turns: task -> each operator's part in it.
      followers: task -> (task that cannot start before it has ended, seconds that must lie
        between).
      handed: task -> (reason, tool, zone or machine, task that used the same unit of it directly
        before, seconds that must lie between).
    """

    cell: Cell
    of_task: Mapping[str, Assignment]
    turns: Mapping[str, list[_Turn]]
    followers: Mapping[str, list[tuple[str, Decimal]]]
    handed: Mapping[str, list[tuple[Reason, str, str, Decimal]]]

    @classmethod
    def of(cls, cell: Cell, schedule: Schedule) -> _Plan:
        of_task = {a.task: a for a in schedule}
        turns: dict[str, list[_Turn]] = {name: [] for name in of_task}
        followers: dict[str, list[tuple[str, Decimal]]] = {name: [] for name in of_task}
        handed: dict[str, list[tuple[Reason, str, str, Decimal]]] = {name: [] for name in of_task}
        for name in cell.operators:
            rows = schedule.of(name)
            previous = None
            for a, seconds in zip(
                rows, changeover_times(cell, name, [a.task for a in rows]), strict=True
            ):
                turns[a.task].append(_Turn(name, previous, exact(seconds)))
                if previous is not None:
                    followers[previous.task].append((a.task, exact(seconds)))
                previous = a
        for name in of_task:
            for before in cell.tasks[name].after:
                followers[before].append((name, Decimal(0)))
        for reason, place, before, after in dict.fromkeys(
            [*_hand_overs(cell, schedule), *_others_out(cell, schedule)]
        ):
            handed[after].append((reason, place, before, Decimal(0)))
            followers[before].append((after, Decimal(0)))
        for machine, before, after in parts_handed_over(cell, schedule):
            gap = next((turn.change for turn in turns[after] if turn.operator == machine), None)
            handed[after].append(("hold", machine, before, gap or Decimal(0)))
            followers[before].append((after, gap or Decimal(0)))
        return cls(cell, of_task, turns, followers, handed)

    def links(self, a: Assignment) -> Iterator[Link]:
        """Every reason for which the task cannot start a moment earlier."""
        start = exact(a.start)
        for name in self.cell.tasks[a.task].after:
            if exact(self.of_task[name].end) == start:
                yield Link(a, "predecessor", name, name)
        if start == 0:
            yield Link(a, "start")
        elif start == exact(self.cell.tasks[a.task].release):
            yield Link(a, "release")
        for turn in self.turns[a.task]:
            begin = start - turn.change
            if turn.previous is not None and exact(turn.previous.end) == begin:
                yield Link(
                    a,
                    "changeover" if turn.change else "operator",
                    turn.operator,
                    turn.previous.task,
                )
            elif begin == 0:
                yield Link(a, "start")
            else:
                ended = (
                    off
                    for off in self.cell.operators[turn.operator].times_off
                    if exact(off.end) == begin
                )
                yield from (Link(a, off.what, turn.operator) for off in ended)
        for reason, place, before, gap in self.handed[a.task]:
            if exact(self.of_task[before].end) + gap == start:
                yield Link(a, reason, place, before)

    def latest_end(self, a: Assignment, limit: Decimal, time: Decimal) -> Decimal:
        """The latest end up to the limit at which neither the task nor its changeovers run into a
        break.
        """
        blocks = [
            (exact(off.start), exact(off.end), turn.change)
            for turn in self.turns[a.task]
            for off in self.cell.operators[turn.operator].times_off
        ]
        end, moved = limit, True
        while moved:
            moved = False
            for off, back, change in blocks:
                if off < end and end - time - change < back:
                    end, moved = off, True
        return max(end, exact(a.end))


def _hand_overs(cell: Cell, schedule: Schedule) -> Iterator[tuple[Reason, str, str, str]]:
    """(reason, tool or zone, task that used a unit of it, task that uses the unit next).

    Units are given out in order of start. Of those that are free, operators keep the one that they
    had last; else it is the one free the longest.
    """
    kinds: tuple[tuple[Reason, Mapping[str, object]], ...] = (
        ("tool", cell.tools),
        ("zone", cell.zones),
    )
    for reason, places in kinds:
        users: dict[str, list[Assignment]] = {}
        for a in schedule:
            name = getattr(cell.tasks[a.task], reason)
            if name is not None:
                users.setdefault(name, []).append(a)
        for name, rows in users.items():
            units: list[Assignment | None] = [None] * int(getattr(places.get(name), "capacity", 1))
            for a in rows:
                units.sort(key=lambda last: _claim(last, a))
                for unit in range(min(len(a.operators), len(units))):
                    before = units[unit]
                    if before is not None:
                        yield reason, name, before.task, a.task
                    units[unit] = a


def _others_out(cell: Cell, schedule: Schedule) -> Iterator[tuple[Reason, str, str, str]]:
    """The same of zones that keep kinds of operators apart: whoever comes waits for all of other
    kinds that were there before.
    """
    rows = [(a, cell.tasks[a.task].zone) for a in schedule]
    for place, (a, zone) in enumerate(rows):
        apart = cell.zones[zone].apart if zone is not None and zone in cell.zones else ()
        kinds = {cell.operators[who].kind for who in a.operators}.intersection(apart)
        for before, its in rows[:place] if kinds else ():
            theirs = {cell.operators[who].kind for who in before.operators}.intersection(apart)
            if its == zone and theirs - kinds:
                yield "zone", zone or "", before.task, a.task


def _claim(last: Assignment | None, a: Assignment) -> tuple[bool, bool, Decimal]:
    """Sorts units for a task by who used them last: free ones first, of these the own, of these the
    one free the longest.
    """
    if last is None:
        return False, True, Decimal(-1)
    return (
        exact(last.end) > exact(a.start),
        not set(last.operators) & set(a.operators),
        exact(last.end),
    )
