"""What one operator does, step by step: everything that must be true before a step begins, and who
can begin then.

A sheet holds on paper too, where nobody is on the planned second: a step names every condition, not
only the one that binds in the plan. Walks, changeovers and setting up are steps of their own. The
same steps, from here, stand in the page, in the workbook and in Markdown, for people and robots.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from tandem.cell.model import Cell
from tandem.cell.parts import Wait, Zone
from tandem.draw.style import looks, task_label
from tandem.plan.result import Result
from tandem.report.language import Words
from tandem.report.tables import named
from tandem.report.waits import kind_of
from tandem.schedule.critical import links
from tandem.schedule.measures import exact, made_ready
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.parts import parts_handed_over
from tandem.schedule.queues import KINDS, places_of, queues


@dataclass(frozen=True)
class Condition:
    """One thing that must be true before a step begins.

    Attributes:
      kind: "previous", "own", "both" (the step before, predecessors on this sheet, both of them),
        "break" (the operator's own), "release", "lag.end" and "lag.start" (a wait after the end or
        the start of a task), "hold" (another task must follow this one within a time, and cannot
        sooner), "done" (a predecessor that others do), "freed" (a
        task of others that holds the tool or the zone until then), "tool.room", "zone.room" (of
        several places, enough are free), "launch" (of a station that repeats: the product is
        there), "partner"; or "start": there is nothing to wait for.
      says: the sentence.
      moment: when it becomes true in the plan, seconds.
      last: of all conditions of the step, this one is expected to become true last.
    """

    kind: str
    says: str
    moment: float
    last: bool = False


@dataclass(frozen=True)
class Step:
    """One row of a sheet: a task, a walk or a changeover before it, or setting up.

    Attributes:
      number: counted from 1.
      task: its name; empty for a walk, a changeover and for setting up.
      does: the task's label, empty when it has none; or where the operator walks, what it changes
        to or sets up.
      means: the part, the place, the tool, the zone and who takes part too, each a short sentence;
        of a tool and a zone also how many there are, or have room.
      begin: everything that must be true before.
      then: who can begin what when it is done, each a short sentence: all tasks that come after
        it, and whoever waits for its tool or its place.
      start, end: seconds since the start of the assembly, as planned.
      deadline: the latest end in seconds; None when there is none.
    """

    number: int
    task: str
    does: str
    start: float
    end: float
    begin: tuple[Condition, ...]
    then: tuple[str, ...] = ()
    means: tuple[str, ...] = ()
    deadline: float | None = None

    @property
    def what(self) -> str:
        """What to do in one word, where no task has a label."""
        return self.task or self.does


class Row(Protocol):
    """What every row of an instruction sheet has, of one plan or of a cycle."""

    @property
    def task(self) -> str: ...

    @property
    def does(self) -> str: ...

    @property
    def begin(self) -> tuple[Condition, ...]: ...


COLUMNS = (
    *("number", "task", "does", "what", "means"),
    *("begin", "then", "start", "end", "deadline"),
)
"""What a sheet shows of a step, in the order of its columns."""


def instructed(cell: Cell) -> tuple[str, ...]:
    """The operators who get a sheet, in the cell's order: a machine reads none."""
    return tuple(name for name in cell.operators if name not in cell.machines)


def steps(cell: Cell, schedule: Schedule, operator: str, t: Words) -> tuple[Step, ...]:
    """The operator's steps in order. Assumes a sound schedule."""
    sheet = _Sheet(cell, schedule, operator, t)
    return tuple(replace(step, number=n) for n, step in enumerate(sheet.steps(), 1))


def columns(found: Sequence[Row], order: Sequence[str] = COLUMNS) -> tuple[str, ...]:
    """What a sheet of these steps shows: that which one of them has, in this order. Names and
    labels of tasks stand in columns of their own; without labels there is one column.
    """
    labelled = any(step.task and step.does for step in found)
    left_out = {"what"} if labelled else {"task", "does"}
    return tuple(
        key
        for key in order
        if key not in left_out
        and (key == "then" or any(getattr(step, key) not in ("", (), None) for step in found))
    )


def rules(cell: Cell, operator: str, t: Words) -> tuple[str, ...]:
    """How to read the operator's sheet, and when the operator has a break; sentences that stand
    above the steps.
    """
    off = [_span(start, end, t) for start, end in cell.operators[operator].breaks]
    kind = cell.operators[operator].kind
    return (
        *([] if operator in cell.machines else [t(f"steps.rule.{kind}")]),
        *([t("steps.breaks", breaks=", ".join(off))] if off else []),
    )


def origin(result: Result, operator: str, title: str, t: Words) -> str:
    """Whose sheet it is, of which cell and of which plan: what stands on every page of it.

    Args:
      title: what the report calls the plan.
    """
    return t(
        "steps.of",
        who=looks(result.cell)[operator].label,
        cell=result.cell.name or t("unnamed"),
        plan=title,
        digest=result.schedule.digest,
    )


class _Sheet:
    """One operator's part in a sound schedule."""

    def __init__(self, cell: Cell, schedule: Schedule, operator: str, t: Words):
        self.cell, self.schedule, self.operator, self.t = cell, schedule, operator, t
        self.rows = {a.task: a for a in schedule}
        self.queues = queues(cell, schedule)
        self.own = _Own(cell, schedule, operator)
        waits = [wait for task in cell.tasks.values() for wait in task.wait]
        is_bound = any(wait.at_most is not None for wait in waits)
        self.held = links(cell, schedule) if is_bound else dict.fromkeys(self.rows, ())
        self.parts = tuple(parts_handed_over(cell, schedule))

    def steps(self) -> Iterator[Step]:
        if self.own.tasks and (span := self.cell.operators[self.operator].setting_up) is not None:
            setup = self.t.seconds(self.cell.operators[self.operator].setup)
            does = self.t("steps.setup", seconds=setup)
            yield Step(0, "", does, *span, with_last([*self._breaks(0.0, span[0])], self.t))
        for place, a in enumerate(self.own.tasks):
            begun = bool(place or self.own.ready)
            yield from self._preparation(place, a, begun)
            yield self._task(place, a, begun or bool(self.own.before[place].seconds))

    def _preparation(self, place: int, a: Assignment, begun: bool) -> Iterator[Step]:
        """Walking to the task and taking up a tool: neither needs anybody else."""
        walk, origin, there, change, tool = self.own.before[place]
        ended, there_at = self.own.ended(place), float(exact(a.start) - exact(change))
        start = float(exact(there_at) - exact(walk))
        found = [self._when("previous", ended)] if begun else []
        begin = with_last([*found, *self._breaks(ended, start)], self.t)
        if walk:
            seconds = self.t.seconds(walk)
            does = self.t("steps.walk", origin=origin, place=there, seconds=seconds)
            yield Step(0, "", does, start, there_at, begin)
            begin = with_last([self._when("previous", there_at)], self.t)
        if change:
            does = self.t("steps.take_up", tool=tool, seconds=self.t.seconds(change))
            yield Step(0, "", does, there_at, a.start, begin)

    def _task(self, place: int, a: Assignment, begun: bool) -> Step:
        task = self.cell.tasks[a.task]
        label = task_label(self.cell, a.task)
        return Step(
            number=0,
            task=a.task,
            does="" if label == a.task else label,
            start=a.start,
            end=a.end,
            begin=with_last([*self._conditions(place, a, begun)], self.t),
            then=tuple(self._then(a)),
            means=means(self.cell, a, self.operator, self.t),
            deadline=task.deadline,
        )

    def _conditions(self, place: int, a: Assignment, begun: bool) -> Iterator[Condition]:
        """All that must be true before a task begins: one's own part first, then the others'."""
        before = [name for name in must_be_over(self.cell, a.task) if self._is_own(name)]
        yield from self._own_part(place, before, begun)
        if not self.own.before[place].seconds:
            yield from self._breaks(self.own.ended(place), a.start)
        if release := self.cell.tasks[a.task].release:
            yield self._when("release", release, release=self.t.seconds(release))
        for wait in waits_of(self.cell, a.task):
            yield self._wait(wait)
        yield from self._others(a)
        yield from self._rooms(a)
        yield from self._held_back(a)
        for who in self._partners(a):
            ready = _Own(self.cell, self.schedule, who).able(a)
            yield self._when("partner", ready, who=self._label(who))

    def _wait(self, wait: Wait) -> Condition:
        first = self.rows[wait.after]
        who, task = self._names(wait.after), named(self.cell, wait.after)
        return waiting(wait, first, who, task, self.t)

    def _held_back(self, a: Assignment) -> Iterator[Condition]:
        """The task waits for nothing but that another one can follow it in time."""
        followers = [link.by for link in self.held[a.task] if link.reason == "follower"]
        if followers:
            yield self._when(
                "hold",
                a.start,
                start=self.t.seconds(a.start),
                tasks=", ".join(named(self.cell, name) for name in followers),
            )

    def _own_part(self, place: int, before: list[str], begun: bool) -> Iterator[Condition]:
        """The step before, and the predecessors on this sheet."""
        tasks = ", ".join(before)
        if self.own.before[place].seconds:
            kind = "both" if before else "previous"
            yield self._when(kind, self.own.able(self.own.tasks[place]), tasks=tasks)
        elif place and self.own.tasks[place - 1].task in before:
            yield self._when("own", self.own.ended(place), tasks=tasks)
        elif begun:
            yield self._when("both" if before else "previous", self.own.ended(place), tasks=tasks)

    def _others(self, a: Assignment) -> Iterator[Condition]:
        """Each task of others that must be done before, with the tool, the zone and the machine
        that it leaves free.
        """
        after = [name for name in must_be_over(self.cell, a.task) if not self._is_own(name)]
        tasks: dict[str, list[str]] = {name: [] for name in after}
        for queue in self.queues[a.task]:
            for _, task in queue.before if not queue.spare else ():
                if not self._is_own(task):
                    said = self.t(f"steps.wait.{queue.kind}", name=queue.name)
                    tasks[task] = list(dict.fromkeys([*tasks.get(task, []), said]))
        for machine, task, after_it in self.parts:
            if after_it == a.task and not self._is_own(task):
                said = self.t("steps.wait.machine", name=self._label(machine))
                tasks[task] = list(dict.fromkeys([*tasks.get(task, []), said]))
        for task, freed in tasks.items():
            yield self._when(
                "freed" if freed else "done",
                self.rows[task].end,
                who=self._names(task),
                task=named(self.cell, task),
                freed=", ".join(freed),
            )

    def _rooms(self, a: Assignment) -> Iterator[Condition]:
        """Tools and zones for several, where all but a few must be done."""
        for queue in self.queues[a.task]:
            if queue.spare:
                those = (self._with(self._label(who), task) for who, task in queue.before)
                yield self._when(
                    f"{queue.kind}.room",
                    queue.moment,
                    name=queue.name,
                    places=queue.places,
                    spare=queue.spare,
                    those="; ".join(those),
                )

    def _breaks(self, free: float, start: float) -> Iterator[Condition]:
        """The operator's own breaks between the last step and this one."""
        for off, back in self.cell.operators[self.operator].breaks:
            if free <= off and back <= start:
                yield self._when("break", back, span=_span(off, back, self.t))

    def _when(self, kind: str, moment: float, **values: object) -> Condition:
        return Condition(kind, self.t(f"steps.wait.{kind}", **values), moment)

    def _then(self, a: Assignment) -> Iterator[str]:
        """All that can begin when the task is done, in the order of the plan."""
        own = [row.task for row in self.own.tasks if a.task in must_be_over(self.cell, row.task)]
        if own:
            yield self.t("steps.then.own", tasks=", ".join(own))
        for row in self.schedule:
            for wait in waits_of(self.cell, row.task):
                if wait.after == a.task:
                    yield later(wait, self._with(self._names(row.task), row.task), self.t)
        for row in self.schedule:
            if self.operator in row.operators:
                continue
            freed = [
                self.t(f"steps.then.{queue.kind}", name=queue.name)
                for queue in self.queues[row.task]
                if any(task == a.task for _, task in queue.before)
            ]
            freed += [
                self.t("steps.then.machine", name=self._label(machine))
                for machine, task, after_it in self.parts
                if (task, after_it) == (a.task, row.task)
            ]
            said = self._with(self._names(row.task), row.task)
            if freed:
                yield self.t("steps.then.freed", then=said, freed=", ".join(freed))
            elif a.task in must_be_over(self.cell, row.task):
                yield said

    def _with(self, who: str, task: str) -> str:
        return self.t("steps.with", who=who, task=named(self.cell, task))

    def _partners(self, a: Assignment) -> tuple[str, ...]:
        return tuple(who for who in a.operators if who != self.operator)

    def _is_own(self, task: str) -> bool:
        return self.operator in self.rows[task].operators

    def _names(self, task: str) -> str:
        return " + ".join(self._label(who) for who in self.rows[task].operators)

    def _label(self, operator: str) -> str:
        return looks(self.cell)[operator].label


class _Own:
    """What an operator does before each of its tasks, by itself.

    Attributes:
      tasks: in order; `before`: the walk and the changeover before each.
      ready: when it is set up, seconds; 0 when it need not be.
    """

    def __init__(self, cell: Cell, schedule: Schedule, operator: str):
        self.tasks = schedule.of(operator)
        self.breaks = cell.operators[operator].breaks
        self.before = made_ready(cell, operator, self.tasks)
        self.ready = (cell.operators[operator].setting_up or (0.0, 0.0))[1]

    def ended(self, place: int) -> float:
        """When the task before this one, or setting up, has ended."""
        return self.tasks[place - 1].end if place else self.ready

    def able(self, a: Assignment) -> float:
        """When the operator itself is ready for its task: what came before has ended, the breaks
        until then are over, and walk and changeover are done as soon as they can be.
        """
        place = self.tasks.index(a)
        begin = float(exact(a.start) - exact(self.before[place].seconds))
        free = self.ended(place)
        free = max([free, *(back for off, back in self.breaks if free <= off and back <= begin)])
        return float(exact(free) + exact(self.before[place].seconds))


RANK = (
    *("previous", "both", "own", "break", "release", "launch", "partner"),
    *("zone.room", "tool.room", "freed", "done", "lag.start", "lag.end", "hold"),
)
"""Of several conditions that become true at the same moment, the one whose kind stands last here
is the one to look out for: others are less sure than one's own hands.
"""


def must_be_over(cell: Cell, task: str) -> list[str]:
    """Tasks that must have ended before this one, but for those of which a wait says so."""
    waited = {w.after for w in waits_of(cell, task) if w.between == "end-start"}
    return [name for name in cell.tasks[task].predecessors if name not in waited]


def waits_of(cell: Cell, task: str) -> list[Wait]:
    """The task's waits that say more than that another task must have ended."""
    return [
        wait
        for wait in cell.tasks[task].wait
        if wait.at_least or wait.at_most is not None or wait.between == "start-start"
    ]


def waiting(wait: Wait, first: Assignment, who: str, task: str, t: Words) -> Condition:
    """That a wait after the task `first` is over; who does that one, and what it is called."""
    is_start = wait.between == "start-start"
    moment = exact(first.start if is_start else first.end) + exact(wait.at_least)
    both = wait.at_most is not None and bool(wait.at_least) and wait.at_least != wait.at_most
    kind = "lag.start" if is_start else "lag.end"
    says = t(
        f"steps.wait.{kind}",
        who=who,
        task=task,
        span=t(f"steps.span.{kind_of(wait)}", **_ends(wait, t)),
        until=t("steps.wait.until", **_ends(wait, t)) if both else "",
    )
    return Condition(kind, says, float(moment))


def later(wait: Wait, then: str, t: Words) -> str:
    """Who can begin the task that waits (`then`), and when."""
    key = "steps.then.begun" if wait.between == "start-start" else "steps.then.wait"
    return t(key, then=then, span=t(f"steps.later.{kind_of(wait)}", **_ends(wait, t)))


def _ends(wait: Wait, t: Words) -> dict[str, str]:
    most = "" if wait.at_most is None else t.seconds(wait.at_most)
    return {"least": t.seconds(wait.at_least), "most": most}


def means(cell: Cell, a: Assignment, operator: str, t: Words) -> tuple[str, ...]:
    """With what, where and with whom the operator does a task, each a short sentence."""
    return tuple(_means(cell, a, operator, t))


def _means(cell: Cell, a: Assignment, operator: str, t: Words) -> Iterator[str]:
    task, shown = cell.tasks[a.task], looks(cell)
    if task.part:
        yield t("steps.means.part", part=task.part)
    if task.place:
        yield t("steps.means.place", place=task.place)
    for kind in KINDS:
        name = cell.takes(kind, a.task, a.operators).get(operator)
        if name is not None:
            places = places_of(cell, kind, name)
            many = "one" if places == 1 else "other"
            yield t(f"steps.means.{kind}.{many}", name=name, n=places)
    if apart := cell.zones.get(task.zone or "", Zone()).apart:
        yield t("steps.means.apart", name=task.zone, kinds=", ".join(map(t, apart)))
    for machine, does in cell.operators.items():
        for first, last in does.holds:
            if first == a.task:
                yield t("steps.means.hold", name=shown[machine].label, task=named(cell, last))
    for who in a.operators:
        if who != operator:
            yield t("steps.means.partner", who=shown[who].label)


def with_last(found: list[Condition], t: Words) -> tuple[Condition, ...]:
    """The conditions with the last one marked, or the sentence that there are none."""
    if not found:
        return (Condition("start", t("steps.wait.start"), 0.0),)
    last = max(found, key=lambda condition: (condition.moment, RANK.index(condition.kind)))
    return tuple(replace(condition, last=condition is last) for condition in found)


def _span(start: float, end: float, t: Words) -> str:
    return t("steps.span", start=t.number(start), end=t.number(end))
