"""What of an old plan can no longer be changed: the tasks that are done, that have started, and
that somebody wants to keep; and the moment before which nothing else begins.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, Decimal
from functools import cached_property
from typing import Literal, NamedTuple

from tandem.cell.model import Cell
from tandem.cell.names import Known, clean
from tandem.cell.precedence import between
from tandem.cell.written import number
from tandem.errors import InfeasibleError, UsageError
from tandem.plan.instance import Instance
from tandem.schedule.checker import faults
from tandem.schedule.measures import Ready, exact, made_ready
from tandem.schedule.model import Assignment, Schedule

FINEST = 6
"""Decimals of a second to which starts of an old plan are kept."""


class Old(NamedTuple):
    """A task in the old plan: `team`, the operators' indices, None when one of them is gone from
    the cell; `start` in ticks.
    """

    team: tuple[int, ...] | None
    start: int


class Fixed(NamedTuple):
    """A task that does not move: `way` and `start` in ticks, and why."""

    way: int
    start: int
    why: Literal["done", "started", "kept"]


@dataclass(frozen=True)
class Standing:
    """How things stand for an old plan in the cell as it is now.

    Attributes:
      stated: the cell in ticks that are fine enough for the old plan's starts and for `now`.
      old: task index -> its place in the old plan, for the tasks that both hold.
      fixed: task index -> what does not move.
      now: ticks; whatever is not fixed begins then or later, unless `may_stay`.
      may_stay: nobody said what time it is: a task that the old plan had begin before `now` may
        begin there still, in the same way.
    """

    cell: Cell
    before: Schedule
    stated: Instance
    old: dict[int, Old]
    fixed: dict[int, Fixed]
    now: int
    may_stay: bool

    @cached_property
    def instance(self) -> Instance:
        """The cell with what is fixed in one way and one place, and all else begun in time."""
        stated = self.stated
        ways, release, deadline = list(stated.ways), list(stated.release), list(stated.deadline)
        for task in range(len(stated.tasks)):
            if task in self.fixed:
                way = stated.ways[task][self.fixed[task].way]
                end = self.fixed[task].start + way.ticks
                ways[task], release[task] = (way,), max(release[task], self.fixed[task].start)
                deadline[task] = end if deadline[task] is None else min(deadline[task] or 0, end)
            else:
                stays = self.old[task].start if self.may_stay and task in self.old else self.now
                release[task] = max(release[task], min(self.now, stays))
        return replace(stated, ways=tuple(ways), release=tuple(release), deadline=tuple(deadline))

    def freed(self, tasks: Collection[int]) -> Standing:
        """The same without keeping these tasks."""
        rest = {task: fixed for task, fixed in self.fixed.items() if task not in tasks}
        return replace(self, fixed=rest)

    def words(self, task: int) -> str:
        """What is fixed, to stand in a sentence."""
        way, start, why = self.fixed[task]
        who = " + ".join(self.stated.operators[o] for o in self.stated.ways[task][way].operators)
        at = number(self.stated.seconds(start))
        return f"task {self.stated.tasks[task]} ({why}: {who} from {at} s)"

    @cached_property
    def under_way(self) -> frozenset[tuple[int, int]]:
        """Operator and task of each walk or changeover that the old plan began before `now`: it
        need not be begun again.
        """
        rows = tuple(a for a in self.before if a.task in self.stated.tasks)
        return frozenset(
            (operator, task) for _, operator, task in self._begun_early(Schedule(rows))
        )

    def _begun_early(self, schedule: Schedule) -> Iterator[tuple[Ready, int, int]]:
        """What is begun before `now` to be ready for a task, with its operator and its task."""
        for operator, who in enumerate(self.stated.operators):
            rows = schedule.of(who)
            for a, ready in zip(rows, made_ready(self.cell, who, rows), strict=True):
                begin = exact(a.start) - exact(ready.seconds)
                if ready.seconds and begin * self.stated.per_second < self.now:
                    yield ready, operator, self.stated.tasks.index(a.task)

    def may_be_prepared_early(self, operator: int, task: int) -> bool:
        """Whether the operator may get ready for the task before `now`: the task has begun, or the
        walk or the changeover had.
        """
        begun = task in self.fixed and self.fixed[task].start < self.now
        return begun or (operator, task) in self.under_way

    def promises(self, schedule: Schedule) -> Iterator[str]:
        """Sentences about what a schedule does not leave as it has to be. The checker knows the
        cell alone, so this is asked beside it.
        """
        moment = number(self.stated.seconds(self.now))
        for ready, operator, task in self._begun_early(schedule):
            if not self.may_be_prepared_early(operator, task):
                does = "sets out" if ready.walk else "changes tools"
                who, what = self.stated.operators[operator], self.stated.tasks[task]
                yield f"{who} {does} for task {what!r} before {moment} s."
        rows = {a.task: a for a in schedule}
        was = {a.task: a for a in self.before}
        for index, name in enumerate(self.stated.tasks):
            if name not in rows:
                continue
            stays = name in was and _place(rows[name]) == _place(was[name])
            if index in self.fixed and not stays:
                yield f"task {name!r} does not stay where it is {self.fixed[index].why}."
            early = exact(rows[name].start) * self.stated.per_second < self.now
            if index not in self.fixed and early and not (self.may_stay and stays):
                yield f"task {name!r} begins before {moment} s."


def stand(
    cell: Cell,
    before: Schedule,
    *,
    done: Iterable[str] = (),
    at: float | None = None,
    keep: Iterable[str] = (),
) -> Standing:
    """How things stand. `least_change.replan` says what the arguments mean.

    Raises:
      UsageError: with everything that is wrong in the call.
      InfeasibleError: what is fixed cannot stay so in this cell, and why.
    """
    done, keep = ([clean(str(name)) for name in dict.fromkeys(names)] for names in (done, keep))
    was = {a.task: a for a in before}
    if not any(name in cell.tasks for name in was):
        raise UsageError(
            f"the plan is one of another cell: none of its tasks ({_few(was)}) is among those of"
            f" {cell.name or 'the cell'} ({_few(cell.tasks)}). Give a plan that was made for it."
        )
    if wrong := list(_wrong(cell, was, done, at, keep)):
        raise UsageError("\n".join(wrong))
    begun = {name for name, a in was.items() if at is not None and a.start < at}
    why: dict[str, Literal["done", "started", "kept"]] = dict.fromkeys(keep, "kept")
    why |= {name: "started" for name in begun if name in cell.tasks}
    why |= dict.fromkeys(done, "done")
    stated = _fine_enough(Instance.of(cell), [*(a.start for a in before), at or 0.0])
    old = {index: _old(stated, was[name]) for index, name in enumerate(stated.tasks) if name in was}
    ends = [was[name].end for name in done]
    now = max(ends, default=0.0) if at is None else at
    fixed, gone = {}, []
    for index, name in enumerate(stated.tasks):
        if name in why:
            way = _way(stated, index, old[index].team, was[name])
            if way is None:
                gone.append(_no_longer(was[name], why[name]))
            else:
                fixed[index] = Fixed(way, old[index].start, why[name])
    standing = Standing(cell, before, stated, old, fixed, _ticks(stated, now), at is None)
    if clashes := [*gone, *_not_begun(standing), *_clashes(standing)]:
        raise InfeasibleError(
            "what is done, started or kept cannot stay as it is, by the times of the cell.",
            [*clashes, _way_out(standing)],
        )
    return standing


def _wrong(
    cell: Cell,
    was: dict[str, Assignment],
    done: list[str],
    at: float | None,
    keep: list[str],
) -> Iterator[str]:
    """Everything that is wrong with what is to stay."""
    for option, names in (("--done", done), ("--keep", keep)):
        for name in names:
            if name in was and name in cell.tasks:
                continue
            if name in was:
                yield f"{option} {name}: the task is gone from the cell. Leave it out."
            elif name in cell.tasks:
                yield (
                    f"{option} {name}: the task is new; the old plan does not say who does it and"
                    " when. Leave it out."
                )
            else:
                known = Known([task for task in cell.tasks if task in was])
                yield f"{option} {name}: the plan has no such task. {known.hint(name)}"
    if at is not None and not (math.isfinite(at) and at >= 0):
        yield f"--at {number(at)}: must be a number of seconds, 0 or more."
        at = None
    yield from _undone(cell, was, done, at)
    end = max((a.end for a in was.values()), default=0.0)
    if at is not None and at >= end and not set(cell.tasks) - set(was):
        yield (
            f"--at {number(at)}: the old plan ends at {number(end)} s, so that nothing is left to"
            " be changed."
        )


def _undone(
    cell: Cell, was: dict[str, Assignment], done: list[str], at: float | None
) -> Iterator[str]:
    """What is said to be done and cannot be."""
    over = {*done, *(a.task for a in was.values() if at is not None and a.end <= at)}
    for name in done:
        if name not in was or name not in cell.tasks:
            continue
        if at is not None and was[name].start >= at:
            yield (
                f"--done {name}: by the old plan it begins at {number(was[name].start)} s, which"
                f" is not before --at {number(at)}."
            )
        missing = [first for first in cell.tasks[name].predecessors if first not in over]
        if new := [first for first in missing if first not in was]:
            yield (
                f"--done {name}: {', '.join(new)} must be done before it and is new in the cell,"
                " so that it cannot be done. Leave it out."
            )
        elif missing:
            yield (
                f"--done {name}: {', '.join(missing)} must be done before it. Name"
                f" {'it' if len(missing) == 1 else 'them'} too: --done"
                f" {','.join([*missing, *(task for task in done if task in was)])}."
            )


def _not_begun(standing: Standing) -> Iterator[str]:
    """Tasks that have begun although something that comes before them has not."""
    names = standing.stated.tasks
    begun = {task for task, fixed in standing.fixed.items() if fixed.why != "kept"}
    for task in begun:
        for first in standing.stated.before[task]:
            if first not in begun:
                what = "is new in the cell" if first not in standing.old else "has not begun"
                yield (
                    f"task {names[task]} has {_has(standing.fixed[task].why)}, but task"
                    f" {names[first]}, which must be done before it, {what}."
                )
        for lag in standing.stated.lags_into[task]:
            if lag.from_start and lag.before not in begun:
                yield (
                    f"task {names[task]} has {_has(standing.fixed[task].why)}, but task"
                    f" {names[lag.before]}, from whose start it waits, has not begun."
                )


def _clashes(standing: Standing) -> list[str]:
    """What the checker says of the fixed tasks alone, by the times as they are now."""
    cell, stated = standing.cell, standing.stated
    names = {stated.tasks[task] for task in standing.fixed}
    if not names:
        return []
    tasks = {
        name: task.model_copy(
            update={
                "after": tuple(x for x in task.after if x in names),
                "wait": tuple(wait for wait in task.wait if wait.after in names),
            }
        )
        for name, task in cell.tasks.items()
        if name in names
    }
    pairs = tuple(pair for pair in cell.same_operator if names.issuperset(pair))
    # what lies between two of them decides which tool is in hand, and where somebody stands
    tools = {name: tool.model_copy(update={"changeover": {}}) for name, tool in cell.tools.items()}
    # a hold says something only where all its tasks are fixed
    operators = {
        who: operator.model_copy(
            update={
                "holds": tuple(pair for pair in operator.holds if between(cell, *pair) <= names)
            }
        )
        for who, operator in cell.operators.items()
    }
    alone = cell.replace(
        operators=operators,
        tasks=tasks,
        same_operator=pairs,
        stress_of_set=None,
        tools=tools,
        walk={},
    )
    rows = (
        _placed(stated, task, fixed.way, fixed.start)
        for task, fixed in sorted(standing.fixed.items())
    )
    return faults(alone, Schedule(tuple(rows)))


def _way_out(standing: Standing) -> str:
    """What the user can do when the fixed tasks clash."""
    kept = any(fixed.why == "kept" for fixed in standing.fixed.values())
    if kept or not standing.fixed:
        return "Leave out of --keep what need not stay."
    return "Give in the cell the times that what is done or has started really takes."


def _placed(stated: Instance, task: int, way: int, start: int) -> Assignment:
    """The task in this way from this tick on, in names and seconds."""
    chosen = stated.ways[task][way]
    return Assignment(
        stated.seconds(start),
        stated.seconds(start + chosen.ticks),
        stated.tasks[task],
        tuple(stated.operators[operator] for operator in chosen.operators),
    )


def _way(stated: Instance, task: int, team: tuple[int, ...] | None, was: Assignment) -> int | None:
    """How these operators do the task now: in the time of the old plan if they still can, else as
    quickly as they can; None when they cannot.
    """
    ticks = (exact(was.end) - exact(was.start)) * stated.per_second
    ways = [w for w, way in enumerate(stated.ways[task]) if way.operators == team]
    return min(
        ways,
        key=lambda w: (
            stated.ways[task][w].ticks != ticks,
            stated.ways[task][w].ticks,
            stated.ways[task][w].stress,
        ),
        default=None,
    )


def _no_longer(was: Assignment, why: str) -> str:
    who = " + ".join(was.operators)
    return (
        f"task {was.task} {'is' if why == 'kept' else 'has been' if why == 'done' else 'has'}"
        f" {why} with {who}, but the cell gives no time for {who} any more."
    )


def _has(why: str) -> str:
    return "been done" if why == "done" else "started"


def _old(stated: Instance, was: Assignment) -> Old:
    index = {name: place for place, name in enumerate(stated.operators)}
    known = all(name in index for name in was.operators)
    team = tuple(sorted(index[name] for name in was.operators)) if known else None
    return Old(team, _ticks(stated, was.start))


def _ticks(stated: Instance, seconds: float) -> int:
    """Ticks, up to the next whole one."""
    return int((exact(seconds) * stated.per_second).to_integral_value(ROUND_CEILING))


def _fine_enough(instance: Instance, moments: Iterable[float]) -> Instance:
    """The instance in ticks that hold every one of these moments, seconds."""
    finest = 0
    for moment in moments:
        exponent = exact(moment).normalize().as_tuple().exponent
        finest = max(finest, min(FINEST, -int(exponent)))
    scale = Decimal(10) ** finest / instance.per_second
    return instance.scaled(int(scale)) if scale > 1 else instance


def _place(a: Assignment) -> tuple[float, frozenset[str]]:
    return a.start, frozenset(a.operators)


def _few(names: Iterable[str]) -> str:
    listed = list(names)
    return ", ".join([*listed[:5], *(["..."] if len(listed) > 5 else [])])
