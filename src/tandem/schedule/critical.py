"""Why a schedule takes as long as it does: its critical path, and how far each task could slip."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Literal, NamedTuple

from tandem.cell.model import Cell
from tandem.cell.written import number
from tandem.schedule.measures import Ready, exact, made_ready
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.parts import parts_handed_over
from tandem.schedule.queues import Kind, places_of, taken_by

Reason = Literal[
    "start",
    "release",
    "break",
    "setup",
    "predecessor",
    "wait",
    "operator",
    "walk",
    "changeover",
    "preparation",
    "tool",
    "zone",
    "hold",
    "follower",
    "choice",
]


@dataclass(frozen=True)
class Link:
    """One task on the critical path, and what it waited for.

    Attributes:
      assignment: the task.
      reason: why it starts exactly when it does: at the "start" of the assembly (there may be a
        walk or a changeover first), at its "release", when a "break" or the "setup" of `by` ends,
        when its "predecessor" `by` ends, when its "wait" after task `by` is over, when the
        "operator" `by` is free, when that operator's "walk" or "changeover" is done, or both of
        them ("preparation"), when a unit of the "tool" or a place in the "zone" `by` is given back,
        when the machine `by` is free to "hold" a part, or free of the one that it held, so late
        that its "follower" `by` still starts within its wait after it; or by "choice": it could
        have started earlier.
      by: name of the predecessor, follower, operator, tool, zone or machine; empty otherwise.
      waited_for: the task before it on the path, which ended then (or some time before, where a
        wait lies between them); None at the path's beginning.
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
            "wait": f"when its wait after {self.waited_for} is over",
            "follower": f"no sooner, so that {self.by} follows in time",
            "operator": f"when {self.by} is free from {self.waited_for}",
            "walk": f"when {self.by} has walked there after {self.waited_for}",
            "changeover": f"when {self.by} has changed tools after {self.waited_for}",
            "preparation": f"when {self.by} has walked there and changed tools after"
            f" {self.waited_for}",
            "tool": f"when {self.waited_for} gives back tool {self.by}",
            "zone": f"when {self.waited_for} leaves zone {self.by}",
            "hold": f"when {self.by} is free after {self.waited_for}",
            "choice": "later than it could",
        }
        return f"{self.assignment.task} at {number(self.assignment.start)} s, {wait[self.reason]}"


def critical_path(cell: Cell, schedule: Schedule) -> tuple[Link, ...]:
    """A chain of tasks from the start, a release or a break to the makespan, each starting exactly
    when what it waited for ended, or a wait after that was over.

    Of several chains, one that reaches back to the start rather than to a task that could have
    started earlier. Assumes a sound schedule; empty for an empty one. In a schedule with gaps that
    nothing explains the chain begins with a "choice".
    """
    if not len(schedule):
        return ()
    plan = _Plan.of(cell, schedule)
    best: dict[str, Link] = {}
    grounded: dict[str, bool] = {}
    for a in _by_start(cell, schedule):
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
    zone. Tasks that follow may slip along; breaks stay free of work, walks and changeovers; a task
    that must start within a time after another one does. Assumes a sound schedule.
    """
    plan = _Plan.of(cell, schedule)
    makespan = max((exact(a.end) for a in schedule), default=Decimal(0))
    # per task and task before it: the latest end where that other one slips along
    latest: dict[str, dict[str, Decimal]] = {}
    free: dict[str, float] = {}
    for a in reversed(_by_start(cell, schedule)):
        deadline = cell.tasks[a.task].deadline
        limits = [makespan, *([] if deadline is None else [exact(deadline)])]
        time = exact(a.end) - exact(a.start)
        for after, gap in plan.followers[a.task]:
            row = plan.of_task[after]
            end = latest[after].get(a.task, latest[after][""])
            limits.append(end - (exact(row.end) - exact(row.start)) - gap)
        caps = plan.caps(a)
        latest[a.task] = {
            but: plan.latest_end(
                a, min([*limits, *(cap for first, cap in caps.items() if first != but)]), time
            )
            for but in ("", *caps)
        }
        free[a.task] = float(latest[a.task][""] - exact(a.end))
    return {a.task: free[a.task] for a in schedule}


def _by_start(cell: Cell, schedule: Schedule) -> list[Assignment]:
    """The assignments by start; of those that start together, one comes behind what it waits
    for.
    """
    begin = {a.task: a.start for a in schedule}

    def depth(task: str) -> int:
        firsts = [w.after for w in cell.tasks[task].wait if begin.get(w.after) == begin[task]]
        return 1 + max(map(depth, firsts)) if firsts else 0

    return sorted(schedule, key=lambda a: (a.start, depth(a.task), a))


_PREFERENCE: tuple[Reason, ...] = (
    "start",
    "predecessor",
    "wait",
    "operator",
    "walk",
    "changeover",
    "preparation",
    "release",
    "break",
    "setup",
    "tool",
    "zone",
    "follower",
    "hold",
    "choice",
)


class _Turn(NamedTuple):
    """One operator's part in a task: what the operator did before, and what it does directly before
    it to be ready.
    """

    operator: str
    previous: Assignment | None
    ready: Ready

    @property
    def time(self) -> Decimal:
        """Seconds for getting ready."""
        return exact(self.ready.seconds)

    @property
    def reason(self) -> Reason:
        """What lies between the task before and this one."""
        if self.ready.walk and self.ready.change:
            return "preparation"
        if self.ready.walk:
            return "walk"
        return "changeover" if self.ready.change else "operator"


@dataclass(frozen=True)
class _Plan:
    """A sound schedule with what follows what.

    Attributes:
      turns: task -> each operator's part in it.
      followers: task -> (task that cannot start before it has ended, seconds that must lie
        between; less than 0 where the wait counts from its start).
      bound: task -> (task that must start within a wait after it, from its start or end, the most).
      handed: task -> (reason, tool, zone or machine, task that used the same unit of it directly
        before, seconds that must lie between).
    """

    cell: Cell
    of_task: Mapping[str, Assignment]
    turns: Mapping[str, list[_Turn]]
    followers: Mapping[str, list[tuple[str, Decimal]]]
    handed: Mapping[str, list[tuple[Reason, str, str, Decimal]]]
    bound: Mapping[str, list[tuple[str, bool, Decimal]]]

    @classmethod
    def of(cls, cell: Cell, schedule: Schedule) -> _Plan:
        of_task = {a.task: a for a in schedule}
        turns: dict[str, list[_Turn]] = {name: [] for name in of_task}
        followers: dict[str, list[tuple[str, Decimal]]] = {name: [] for name in of_task}
        handed: dict[str, list[tuple[Reason, str, str, Decimal]]] = {name: [] for name in of_task}
        bound: dict[str, list[tuple[str, bool, Decimal]]] = {name: [] for name in of_task}
        for name in cell.operators:
            rows = schedule.of(name)
            previous = None
            for a, ready in zip(rows, made_ready(cell, name, rows), strict=True):
                turns[a.task].append(_Turn(name, previous, ready))
                if previous is not None:
                    followers[previous.task].append((a.task, exact(ready.seconds)))
                previous = a
        for name in of_task:
            for before in cell.tasks[name].predecessors:
                followers[before].append((name, Decimal(0)))
            for wait in cell.tasks[name].wait:
                is_start, first = wait.between == "start-start", of_task[wait.after]
                time = exact(first.end) - exact(first.start) if is_start else Decimal(0)
                followers[wait.after].append((name, exact(wait.at_least) - time))
                if wait.at_most is not None:
                    bound[wait.after].append((name, is_start, exact(wait.at_most)))
        for reason, place, before, after in dict.fromkeys(
            [*_hand_overs(cell, schedule), *_others_out(cell, schedule)]
        ):
            handed[after].append((reason, place, before, Decimal(0)))
            followers[before].append((after, Decimal(0)))
        for machine, before, after in parts_handed_over(cell, schedule):
            mine = (turn.time for turn in turns[after] if turn.operator == machine)
            gap = next(mine, Decimal(0))
            handed[after].append(("hold", machine, before, gap))
            followers[before].append((after, gap))
        return cls(cell, of_task, turns, followers, handed, bound)

    def caps(self, a: Assignment) -> dict[str, Decimal]:
        """Task before it -> the latest end, for a wait that must not grow longer."""
        time = exact(a.end) - exact(a.start)
        caps: dict[str, Decimal] = {}
        for wait in self.cell.tasks[a.task].wait:
            if wait.at_most is not None:
                first = self.of_task[wait.after]
                moment = exact(first.start if wait.between == "start-start" else first.end)
                cap = moment + exact(wait.at_most) + time
                caps[wait.after] = min(cap, caps.get(wait.after, cap))
        return caps

    def links(self, a: Assignment) -> Iterator[Link]:
        """Every reason for which the task cannot start a moment earlier; that another one must
        follow it in time where there is no other.
        """
        found = [*self._waits(a), *self._links(a)]
        yield from found
        if found:
            return
        for after, from_start, most in self.bound[a.task]:
            moment = exact(a.start if from_start else a.end)
            if exact(self.of_task[after].start) == moment + most:
                yield Link(a, "follower", after)

    def _waits(self, a: Assignment) -> Iterator[Link]:
        """The waits after other tasks that are over just when the task starts."""
        for wait in self.cell.tasks[a.task].wait:
            first, is_start = self.of_task[wait.after], wait.between == "start-start"
            moment = exact(first.start if is_start else first.end)
            over = exact(a.start) == moment + exact(wait.at_least)
            if over and (wait.at_least or is_start):
                yield Link(a, "wait", wait.after, wait.after)

    def _links(self, a: Assignment) -> Iterator[Link]:
        start = exact(a.start)
        for name in self.cell.tasks[a.task].predecessors:
            if exact(self.of_task[name].end) == start:
                yield Link(a, "predecessor", name, name)
        if start == 0:
            yield Link(a, "start")
        elif start == exact(self.cell.tasks[a.task].release):
            yield Link(a, "release")
        for turn in self.turns[a.task]:
            begin = start - turn.time
            if turn.previous is not None and exact(turn.previous.end) == begin:
                yield Link(a, turn.reason, turn.operator, turn.previous.task)
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
        """The latest end up to the limit at which neither the task nor what is needed before it
        runs into a break.
        """
        blocks = [
            (exact(off.start), exact(off.end), turn.time)
            for turn in self.turns[a.task]
            for off in self.cell.operators[turn.operator].times_off
        ]
        end, moved = limit, True
        while moved:
            moved = False
            for off, back, before in blocks:
                if off < end and end - time - before < back:
                    end, moved = off, True
        return max(end, exact(a.end))


def _hand_overs(cell: Cell, schedule: Schedule) -> Iterator[tuple[Reason, str, str, str]]:
    """(reason, tool or zone, task that used a unit of it, task that uses the unit next).

    Units are given out in order of start. Of those that are free, operators keep the one that they
    had last; else it is the one free the longest.
    """
    users: dict[tuple[Kind, str], list[tuple[Assignment, int]]] = {}
    for a in schedule:
        for kind, name, count in taken_by(cell, a):
            users.setdefault((kind, name), []).append((a, count))
    for (kind, name), rows in users.items():
        units: list[Assignment | None] = [None] * places_of(cell, kind, name)
        for a, count in rows:
            units.sort(key=lambda last: _claim(last, a))
            for unit in range(min(count, len(units))):
                before = units[unit]
                if before is not None:
                    yield kind, name, before.task, a.task
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
