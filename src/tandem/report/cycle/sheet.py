"""What one operator does in one steady cycle, step by step, and again in every cycle: at which
place in the cycle, on which of the products in the station, and everything that must be true
before.

As on the sheet of a single plan, a step names every condition, not only the one that binds; it
holds on a day that goes otherwise than planned.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from tandem.cell.model import Cell
from tandem.draw.lanes import product_mark
from tandem.draw.style import looks, task_label
from tandem.plan.cycle.result import CycleResult
from tandem.report.instructions import (
    Condition,
    columns,
    later,
    means,
    must_be_over,
    waiting,
    waits_of,
    with_last,
)
from tandem.report.language import Words
from tandem.report.tables import named
from tandem.schedule.critical import links
from tandem.schedule.cycle import PeriodicSchedule, copied, copy_of
from tandem.schedule.measures import exact
from tandem.schedule.parts import parts_handed_over
from tandem.schedule.queues import Queue, queues
from tandem.schedule.steady import Round, Turn, rounds


@dataclass(frozen=True)
class CycleStep:
    """One row of a sheet: a task, or a walk or a changeover before it.

    Attributes:
      number: counted from 1, in the order of the cycle.
      at: where in the cycle it begins, seconds.
      until: where it ends, in words: it may be in the next cycle.
      task: its name; empty for a walk and a changeover.
      does: the task's label, empty when it has none; or where the operator walks or what it changes
        to.
      product: on which of the products in the station, in words; empty without a
        task.
      means: the part, the place, the tool, the zone and who takes part too, each a short sentence.
      begin: everything that must be true before; moments in seconds since the cycle began.
      then: who can begin what when it is done, each a short sentence.
    """

    number: int
    at: float
    until: str
    task: str
    does: str
    product: str
    begin: tuple[Condition, ...]
    then: tuple[str, ...] = ()
    means: tuple[str, ...] = ()

    @property
    def what(self) -> str:
        """What to do in one word, where no task has a label."""
        return self.task or self.does


COLUMNS = ("number", "at", "until", "task", "does", "what", "product", "means", "begin", "then")
"""What a sheet shows of a step, in the order of its columns."""


@dataclass(frozen=True)
class Wait:
    """What a task waits for that others do.

    Attributes:
      task: that must be done before; `product`: of which product, 0 for the same, -1 for the one
        launched a cycle before, 1 for the one a cycle later.
      freed: (kind, name) of the tools, zones and machines that it holds until then.
    """

    task: str
    product: int
    freed: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Room:
    """A tool or a zone for several, where all but a few must be done before a task begins.

    Attributes:
      queue: how many places there are, and how many may be unfinished.
      before: (operator, task, product as in a `Wait`).
      moment: when that is so, seconds since the launch of the task's own product.
    """

    queue: Queue
    before: tuple[tuple[str, str, int], ...]
    moment: float


class Waiting:
    """What every task of a sound periodic schedule waits for, in the steady state.

    The order of the products in the station is that of several products on one clock, of which one
    in the middle is read: it has as many before and behind it as can be there at once.

    Attributes:
      waits: task -> what others do before; `rooms`: task -> places of which some must be free;
        `followers`: task -> tasks because of which it does not start sooner.
    """

    def __init__(self, cell: Cell, periodic: PeriodicSchedule) -> None:
        self.cell = cell
        self.who = {a.task: a.operators for a in periodic}
        middle = periodic.in_process + 2
        count = middle + periodic.in_process
        place = {
            copy_of(task, product): (task, product - middle)
            for task in cell.tasks
            for product in range(1, count + 1)
        }
        several, products = copied(cell, count), periodic.products(count)
        found = queues(several, products)
        parts = tuple(parts_handed_over(several, products))
        is_bound = any(w.at_most is not None for task in cell.tasks.values() for w in task.wait)
        held = links(several, products) if is_bound else {}
        launch = (middle - 1) * exact(periodic.cycle_time)
        self.waits: dict[str, tuple[Wait, ...]] = {}
        self.rooms: dict[str, tuple[Room, ...]] = {}
        self.followers = {
            task: [
                place[link.by][0]
                for link in held.get(copy_of(task, middle), ())
                if link.reason == "follower"
            ]
            for task in cell.tasks
        }
        for task in cell.tasks:
            queued = found[copy_of(task, middle)]
            freed: dict[tuple[str, int], list[tuple[str, str]]] = {
                (first, 0): [] for first in must_be_over(cell, task)
            }
            for queue in queued:
                for _, other in queue.before if not queue.spare else ():
                    told = freed.setdefault(place[other], [])
                    told += (
                        [(queue.kind, queue.name)] if (queue.kind, queue.name) not in told else []
                    )
            for machine, ended, after in parts:
                if after == copy_of(task, middle):
                    freed.setdefault(place[ended], []).append(("machine", machine))
            self.waits[task] = tuple(
                Wait(first, product, tuple(why)) for (first, product), why in freed.items()
            )
            self.rooms[task] = tuple(
                Room(
                    queue,
                    tuple((who, *place[other]) for who, other in queue.before),
                    float(exact(queue.moment) - launch),
                )
                for queue in queued
                if queue.spare
            )

    def of_others(self, task: str, operator: str) -> Iterator[Wait]:
        """What the operator has to hear of before the task: all that it does not do itself, since
        its own steps are done in their order.
        """
        return (wait for wait in self.waits[task] if operator not in self.who[wait.task])


def sheet_columns(found: Sequence[CycleStep]) -> tuple[str, ...]:
    """What a sheet of these steps shows."""
    return columns(found, COLUMNS)


def cycle_steps(result: CycleResult, t: Words) -> dict[str, tuple[CycleStep, ...]]:
    """Every human's steps of one steady cycle, by where in it they begin."""
    sheets = _Sheets(result.cell, result.periodic, t)
    return {name: sheets.of(name) for name in result.cell.humans}


def sheet_rules(result: CycleResult, operator: str, t: Words) -> tuple[str, ...]:
    """How to read the operator's sheet, and what to do before the first cycle; sentences that stand
    above the steps.
    """
    own = result.cell.operators[operator]
    ready = [t("cycle.sheet.setup", seconds=t.seconds(own.setup))] if own.setup else []
    return (t("cycle.sheet.rule"), *([t("cycle.sheet.breaks")] if own.breaks else []), *ready)


def sheet_title(result: CycleResult, operator: str, t: Words) -> str:
    """What stands above the operator's sheet."""
    who = looks(result.cell)[operator].label
    return t("cycle.sheet.title", who=who, cycle_time=t.seconds(result.cycle_time))


def sheet_origin(result: CycleResult, operator: str, title: str, t: Words) -> str:
    """Whose sheet it is, of which cell and of which pattern: what stands on every page of it.

    Args:
      title: what the report calls the pattern.
    """
    return t(
        "cycle.sheet.of",
        who=looks(result.cell)[operator].label,
        cell=result.cell.name or t("unnamed"),
        plan=title,
        digest=result.periodic.digest,
    )


def product_told(lap: int, t: Words) -> str:
    """On which product a step of the cycle is, in words: by when it was launched."""
    mark = product_mark(-lap)
    return t("cycle.age.0", mark=mark) if lap == 0 else t.count("cycle.age", lap, mark=mark)


def until_told(at: float, seconds: float, length: float, t: Words) -> str:
    """Where in the cycle, or in the next, something ends that begins there and takes so long."""
    end = exact(at) + exact(seconds)
    if end <= exact(length):
        return t.number(float(end))
    return t("cycle.sheet.next", seconds=t.number(float(end - exact(length))))


class _Sheets:
    """The sheets of a pattern."""

    def __init__(self, cell: Cell, periodic: PeriodicSchedule, t: Words):
        self.cell, self.periodic, self.t = cell, periodic, t
        self.rows = {a.task: a for a in periodic}
        self.rounds = rounds(cell, periodic)
        self.waiting = Waiting(cell, periodic)

    def of(self, operator: str) -> tuple[CycleStep, ...]:
        own = self.rounds[operator]
        found = [step for place in range(len(own.turns)) for step in self._steps(operator, place)]
        found.sort(key=lambda step: step.at)
        return tuple(replace(step, number=number) for number, step in enumerate(found, 1))

    def _steps(self, operator: str, place: int) -> Iterator[CycleStep]:
        turn, length = self.rounds[operator].turns[place], self.periodic.cycle_time
        task = turn.assignment.task
        label = task_label(self.cell, task)
        begin = [*self._conditions(operator, place)]
        yield from self._preparation(turn, begin[0])
        yield CycleStep(
            number=0,
            at=turn.begin,
            until=until_told(turn.begin, turn.seconds, length, self.t),
            task=task,
            does="" if label == task else label,
            product=product_told(turn.lap, self.t),
            begin=with_last(begin, self.t),
            then=tuple(self._then(operator, task)),
            means=means(self.cell, turn.assignment, operator, self.t),
        )

    def _preparation(self, turn: Turn, previous: Condition) -> Iterator[CycleStep]:
        """The walk and the changeover before a task: neither needs anybody else."""
        walk, origin, there, change, tool = turn.ready
        told = {
            "steps.walk": (walk, {"origin": origin, "place": there}),
            "steps.take_up": (change, {"tool": tool}),
        }
        start = exact(turn.begin) - exact(turn.ready.seconds)
        for key, (seconds, values) in told.items():
            if seconds:
                at, length = self.periodic.position(float(start)), self.periodic.cycle_time
                until = until_told(at, seconds, length, self.t)
                says = self.t(key, **values, seconds=self.t.seconds(seconds))
                yield CycleStep(0, at, until, "", says, "", with_last([previous], self.t))
            start += exact(seconds)

    def _conditions(self, operator: str, place: int) -> Iterator[Condition]:
        """All that must be true before a task begins: one's own part first, then the others'."""
        own = self.rounds[operator]
        turn = own.turns[place]
        task, launch = turn.assignment.task, -turn.lap * exact(own.length)
        yield Condition("previous", self.t("steps.wait.previous"), _free(own, place))
        if not self.cell.tasks[task].predecessors and not waits_of(self.cell, task):
            yield Condition("launch", self.t("steps.wait.launch"), float(launch))
        for lag in waits_of(self.cell, task):
            who, first = self._names(lag.after), self._task(lag.after, 0)
            found = waiting(lag, self.rows[lag.after], who, first, self.t)
            yield replace(found, moment=float(exact(found.moment) + launch))
        for wait in self.waiting.of_others(task, operator):
            end = exact(self.rows[wait.task].end) + wait.product * exact(own.length) + launch
            yield self._done(wait, float(end))
        for room in self.waiting.rooms[task]:
            yield self._room(room, float(exact(room.moment) + launch))
        if followers := self.waiting.followers[task]:
            tasks = ", ".join(named(self.cell, name) for name in followers)
            says = self.t("steps.wait.hold", start=self.t.seconds(turn.begin), tasks=tasks)
            yield Condition("hold", says, turn.begin)
        for who in turn.assignment.operators:
            if who != operator:
                ready = _free(self.rounds[who], _place_of(self.rounds[who], turn))
                yield Condition("partner", self.t("steps.wait.partner", who=self._name(who)), ready)

    def _done(self, wait: Wait, moment: float) -> Condition:
        kind = "freed" if wait.freed else "done"
        freed = ", ".join(self._freed("wait", *what) for what in wait.freed)
        says = self.t(
            f"steps.wait.{kind}",
            who=self._names(wait.task),
            task=self._task(wait.task, wait.product),
            freed=freed,
        )
        return Condition(kind, says, moment)

    def _room(self, room: Room, moment: float) -> Condition:
        queue = room.queue
        kind = f"{queue.kind}.room"
        those = "; ".join(
            self.t("cycle.task", task=self._with(self._name(who), task), of=self._of(product))
            for who, task, product in room.before
        )
        says = self.t(
            f"steps.wait.{kind}",
            name=queue.name,
            places=queue.places,
            spare=queue.spare,
            those=those,
        )
        return Condition(kind, says, moment)

    def _then(self, operator: str, done: str) -> Iterator[str]:
        """Who among the others waits for a step, by where in the pattern they come; also one's own
        tasks that must wait some time after it.
        """
        for a in self.periodic:
            for lag in waits_of(self.cell, a.task):
                if lag.after == done:
                    task = self._task(a.task, 0)
                    then = self.t("steps.with", who=self._names(a.task), task=task)
                    yield later(lag, then, self.t)
        for a in self.periodic:
            if operator in a.operators:
                continue
            for wait in self.waiting.waits[a.task]:
                if wait.task != done:
                    continue
                who = self._names(a.task)
                said = self.t("steps.with", who=who, task=self._task(a.task, -wait.product))
                freed = [self._freed("then", *what) for what in wait.freed]
                yield (
                    self.t("steps.then.freed", then=said, freed=", ".join(freed)) if freed else said
                )

    def _freed(self, side: str, kind: str, name: str) -> str:
        """The tool, the zone or the machine that a task leaves free."""
        shown = self._name(name) if kind == "machine" else name
        return self.t(f"steps.{side}.{kind}", name=shown)

    def _task(self, task: str, product: int) -> str:
        return self.t("cycle.task", task=named(self.cell, task), of=self._of(product))

    def _of(self, product: int) -> str:
        """Of which product, seen from the one of the step."""
        if product == 0:
            return self.t("cycle.of.same")
        return self.t.count("cycle.of.before" if product < 0 else "cycle.of.after", abs(product))

    def _with(self, who: str, task: str) -> str:
        return self.t("steps.with", who=who, task=named(self.cell, task))

    def _names(self, task: str) -> str:
        return " + ".join(self._name(who) for who in self.rows[task].operators)

    def _name(self, operator: str) -> str:
        return looks(self.cell)[operator].label


def _free(own: Round, place: int) -> float:
    """When what comes before a turn is over, and the walk and the changeover can be done;
    seconds since the cycle of the turn began. The round before ends where this one begins.
    """
    turn, before = own.turns[place], own.turns[place - 1]
    around = 0 if place else 1
    end = exact(before.begin) + exact(before.seconds) - around * exact(own.length)
    return float(end + exact(turn.ready.seconds))


def _place_of(own: Round, turn: Turn) -> int:
    """Index of the same task in a partner's round."""
    return next(
        place
        for place, other in enumerate(own.turns)
        if other.assignment.task == turn.assignment.task
    )
