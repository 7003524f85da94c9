"""Where a shift stands, as far as it has been seen: what deciders look at. Frozen, plain Python; knows no JAX and no solver.

`legal(situation)` says what may begin; `after.py` moves a situation on. The rules are those of the world (`tandem.world.state`) in other words:
a test holds both together. Times are seconds since the shift's start. Who was idle has used that time to take up the tool of the next task; what is
left of a changeover belongs to the work that follows it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from tandem.cell.model import Cell, Mode
from tandem.dispatch.facts import Facts

Outcome = Literal["done", "taken apart", "broken off"]

TAKING_APART = 1.0
"""ASSUMPTION: taking apart takes so many times as long as doing, with the same operators, tool and zone. `Situation.taking_apart` sets it."""


@dataclass(frozen=True)
class Running:
    """A task under way.

    Attributes:
      operators: who does it, in the cell's order.
      start: when they began, with what was left of a changeover, s.
      expected_end: by the stated times, s; later when the work has rested. It may have passed: people are slower than stated.
      undoing: it is being taken apart, not done.
      rests_since: since when nobody works on it, an operator being absent or failed; None while it goes on.
      rested: seconds that it has rested before.
    """

    operators: tuple[str, ...]
    start: float
    expected_end: float
    undoing: bool = False
    rests_since: float | None = None
    rested: float = 0.0

    @property
    def stated(self) -> float:
        """Seconds that it takes as stated, with what was left of a changeover."""
        return self.expected_end - self.start - self.rested


@dataclass(frozen=True)
class Work:
    """Work that ended: the as-run record, from which each operator's pace is told.

    Attributes:
      start, end: s; between them it `rested` for so many seconds.
      stated: seconds that it should have taken, with what was left of a changeover.
      outcome: the task was done, was taken apart, or was broken off with nothing to show.
    """

    task: str
    operators: tuple[str, ...]
    start: float
    end: float
    stated: float
    rested: float
    outcome: Outcome

    @property
    def worked(self) -> float:
        """Seconds of work, rests left out."""
        return self.end - self.start - self.rested


@dataclass(frozen=True)
class Order:
    """What robots were told to begin and have not begun yet, as far as is known.

    Attributes:
      operators: who is to do it; humans of a joint task are asked at the same time.
      number: of the decision that gave the order first.
    """

    operators: tuple[str, ...]
    number: int


@dataclass(frozen=True)
class Situation:
    """What has been seen of a shift: one assembly in one cell.

    Attributes:
      now: s since the start.
      done: task -> the work that did it; what turned out wrong or was taken apart is no longer in it.
      running: task -> who is at it since when.
      past: all work that ended, in the order in which it ended.
      absent: humans who are away. `failed`: robots that are down.
      refused: (operator, task) -> until when (s) that operator will not do the task; None: for the whole shift.
      orders: task -> the order of the last decision that no start has followed yet. The next decision replaces it: an order binds nobody.
      announced: human -> the task that the last decision asked for.
      wrong: tasks that are mounted wrongly, or on top of something wrong, with the work that did so: they must be taken apart, then done again.
      in_hand: operator -> the tool in hand; who is missing takes up the first one at no cost.
      since: operator -> since when they could have taken up another tool: the end of the last work or absence; 0 for who is missing.
      taking_apart: see `TAKING_APART`.
      known: `facts` when they have been worked out; handed on from situation to situation.
    """

    cell: Cell
    now: float = 0.0
    done: Mapping[str, Work] = field(default_factory=dict)
    running: Mapping[str, Running] = field(default_factory=dict)
    past: tuple[Work, ...] = ()
    absent: frozenset[str] = frozenset()
    failed: frozenset[str] = frozenset()
    refused: Mapping[tuple[str, str], float | None] = field(default_factory=dict)
    orders: Mapping[str, Order] = field(default_factory=dict)
    announced: Mapping[str, str] = field(default_factory=dict)
    wrong: Mapping[str, Work] = field(default_factory=dict)
    in_hand: Mapping[str, str] = field(default_factory=dict)
    since: Mapping[str, float] = field(default_factory=dict)
    taking_apart: float = TAKING_APART
    known: Facts | None = field(default=None, repr=False, compare=False)

    @classmethod
    def of(cls, cell: Cell, *, taking_apart: float = TAKING_APART) -> Situation:
        """The start of a shift: nothing done, everybody there."""
        hands = {who: operator.tool for who, operator in cell.operators.items() if operator.tool}
        return cls(cell, in_hand=hands, taking_apart=taking_apart, known=Facts.of(cell))

    @cached_property
    def facts(self) -> Facts:
        """What follows from the cell."""
        return self.known or Facts.of(self.cell)

    @property
    def open(self) -> tuple[str, ...]:
        """Tasks that nobody is at and that are not in place, in the cell's order; those that are wrong are among them."""
        return tuple(task for task in self.cell.tasks if task not in self.running and task not in self.done)

    @property
    def is_over(self) -> bool:
        """Everything is done."""
        return len(self.done) == len(self.cell.tasks)

    @property
    def idle(self) -> tuple[str, ...]:
        """Operators who are there and at nothing, in the cell's order."""
        busy = {who for at in self.running.values() for who in at.operators}
        return tuple(who for who in self.cell.operators if who not in busy and who not in self.absent and who not in self.failed)

    @property
    def makespan(self) -> float:
        """When the last task that is done now ended, s; 0 before any."""
        return max((work.end for work in self.done.values()), default=0.0)

    @property
    def load(self) -> dict[str, float]:
        """Human -> stress so far, running work included; every doing and taking apart counts, work that was broken off does not."""
        load = dict.fromkeys(self.cell.humans, 0.0)
        work = [(one.task, one.operators) for one in self.past if one.outcome != "broken off"]
        for task, operators in [*work, *((task, at.operators) for task, at in self.running.items())]:
            for human, stress in mode(self.cell, task, operators).stress.items():
                load[human] += stress
        return load

    @property
    def stress(self) -> float:
        """Of all humans together, as a sum over their work (also where the cell has `stress_of_set`)."""
        return sum(self.load.values())

    def is_refused(self, operator: str, task: str) -> bool:
        """Whether the operator will not do the task now."""
        if (operator, task) not in self.refused:
            return False
        until = self.refused[operator, task]
        return until is None or self.now < until

    def to_dict(self) -> dict[str, Any]:
        """As plain values, the cell left out; equal situations of a cell give equal values."""
        return {
            "now": self.now,
            "done": {task: _plain(work) for task, work in sorted(self.done.items())},
            "running": {task: _plain(at) for task, at in sorted(self.running.items())},
            "orders": {task: _plain(order) for task, order in sorted(self.orders.items())},
            "past": [_plain(work) for work in self.past],
            "absent": sorted(self.absent),
            "failed": sorted(self.failed),
            "refused": [[who, task, until] for (who, task), until in sorted(self.refused.items())],
            "announced": dict(sorted(self.announced.items())),
            "wrong": {task: _plain(work) for task, work in sorted(self.wrong.items())},
            "in_hand": dict(sorted(self.in_hand.items())),
            "since": dict(sorted(self.since.items())),
        }


def mode(cell: Cell, task: str, operators: Iterable[str]) -> Mode:
    """The way in which these operators do the task: of several the quickest, of these the one of least stress.

    Raises KeyError when they have none.
    """
    who = frozenset(operators)
    ways = [way for way in cell.modes(task) if who == frozenset(way.operators)]
    if not ways:
        raise KeyError((task, tuple(operators)))
    return min(ways, key=lambda way: (way.time, sum(way.stress.values())))


def start_of_work(situation: Situation, task: str, operators: Iterable[str]) -> float:
    """When the task itself would start, were it begun now, s: now, or when the last of them has taken up its tool."""
    return exact(max([situation.now, *(since + swap for since, swap in _swaps(situation, task, operators).values())]))


def seconds(situation: Situation, task: str, operators: tuple[str, ...]) -> float:
    """How long it would keep them from now on as stated, what is left of a changeover included: to do it, or to take it apart when it is wrong."""
    return exact(start_of_work(situation, task, operators) - situation.now + _stated(situation, task, mode(situation.cell, task, operators)))


def legal(situation: Situation) -> list[tuple[str, tuple[str, ...]]]:
    """What may begin now, as (task, operators), in the cell's order. For a task in `situation.wrong` it means taking it apart.

    Predecessors have ended (or, to take a task apart, nothing stands on it any more), its release has come, all operators are there and at nothing,
    tool and zone have room, no break falls into changeover or stated time, and refusals, stress limits (as far as the least stress of what is left
    tells), `same_operator` and `stress_of_set` are kept. Deadlines rule out nothing: late is better than never.
    """
    idle = frozenset(situation.idle)
    found: dict[tuple[str, tuple[str, ...]], None] = {}
    for task in situation.open:
        if is_ready(situation, task):
            for way in situation.facts.ways[task]:
                if idle.issuperset(way.operators) and not any(hindrances(situation, task, way)):
                    found[task, way.operators] = None
    return list(found)


def is_ready(situation: Situation, task: str) -> bool:
    """What must come before has come: what the task stands on is in place, and nothing above it is in hand or wrong (begun before its turn).

    Where the task is wrong: all that stands on it is off.
    """
    above = situation.facts.above[task]
    if any(name in above for place in (situation.running, situation.wrong) for name in place):
        return False
    if task in situation.wrong:
        return not any(name in above for name in situation.done)
    return all(first in situation.done for first in situation.cell.tasks[task].after)


def hindrances(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    """What else stands against the task being begun now in this way, in sentences; none when nothing does."""
    for rule in (_release, _refusals, _breaks, _room, _stress_limits, _teams, _listed_sets):
        yield from rule(situation, task, way)


def next_change(situation: Situation) -> float | None:
    """When the clock alone may make something legal, s: a release, the end of a break, the end of a refusal. None when it never will."""
    cell = situation.cell
    times = [cell.tasks[task].release for task in situation.open]
    times += [back for operator in cell.operators.values() for _, back in operator.breaks]
    times += [until for until in situation.refused.values() if until is not None]
    return min((time for time in times if time > situation.now), default=None)


def exact(seconds: float) -> float:
    """Without the dust that adding floats leaves: cells and events have at most six decimals."""
    return round(seconds, 6)


def _stated(situation: Situation, task: str, way: Mode) -> float:
    return way.time * situation.taking_apart if task in situation.wrong else way.time


def _swaps(situation: Situation, task: str, operators: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Operator -> since when they can have been taking up the task's tool, and how long that takes (s); only who holds another one."""
    tool = situation.cell.tasks[task].tool
    if tool is None or tool not in situation.cell.tools:
        return {}
    swaps = {}
    for who in operators:
        if situation.in_hand.get(who, tool) != tool:
            over = [back for _, back in situation.cell.operators[who].breaks if back <= situation.now]
            swaps[who] = (max([situation.since.get(who, 0.0), *over]), situation.cell.tools[tool].changeover.get(who, 0.0))
    return swaps


def _release(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    release = situation.cell.tasks[task].release
    if situation.now < release:
        yield f"task {task!r} is released at {release:g} s"


def _refusals(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    for who in way.operators:
        if situation.is_refused(who, task):
            until = situation.refused[who, task]
            yield f"{who!r} does not want task {task!r}" + ("" if until is None else f" before {until:g} s")


def _breaks(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    if not any(situation.cell.operators[who].breaks for who in way.operators):
        return
    start, swaps = start_of_work(situation, task, way.operators), _swaps(situation, task, way.operators)
    end = exact(start + _stated(situation, task, way))
    for who in way.operators:
        begin = exact(start - swaps.get(who, (0.0, 0.0))[1])
        for off, back in situation.cell.operators[who].breaks:
            if off < end and begin < back:
                yield f"{who!r} has a break from {off:g} s to {back:g} s"


def _room(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    cell = situation.cell
    wanted = cell.tasks[task]
    tables: tuple[tuple[str, str | None, Mapping[str, Any]], ...] = (("tool", wanted.tool, cell.tools), ("zone", wanted.zone, cell.zones))
    for kind, name, table in tables:
        if name is not None:
            places = table[name].capacity if name in table else 1
            taken = sum(len(at.operators) for other, at in situation.running.items() if getattr(cell.tasks[other], kind) == name)
            if taken + len(way.operators) > places:
                yield f"{kind} {name!r} is taken" if taken else f"{kind} {name!r} has room for {places} only"


def _stress_limits(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    limits = {who: limit for who in way.operators if (limit := situation.cell.operators[who].stress_limit) is not None}
    if not limits or task in situation.wrong:
        return  # what has to come off does so, and what mistakes bring on top does not count
    stands = {name: at.operators for place in (situation.wrong, situation.done, situation.running) for name, at in place.items()}
    loads = [mode(situation.cell, name, operators).stress for name, operators in stands.items()]
    left = [other for other in situation.open if other != task and other not in situation.wrong]
    for who, limit in limits.items():
        ahead = sum(situation.facts.must[other].get(who, 0.0) for other in left)
        total = exact(sum(load.get(who, 0.0) for load in loads) + way.stress.get(who, 0.0) + ahead)
        if total > limit:
            yield f"{who!r} would come to {total:g} of stress with what is left, the limit is {limit:g}"


def _teams(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    for other in situation.facts.team[task]:
        at = situation.running.get(other) or situation.done.get(other) or situation.wrong.get(other)
        if at is not None and set(at.operators) != set(way.operators):
            yield f"{' and '.join(at.operators)} must do task {task!r}, having done task {other!r}"


def _listed_sets(situation: Situation, task: str, way: Mode) -> Iterator[str]:
    if situation.facts.sets is None:
        return
    begun = {name: at.operators for place in (situation.wrong, situation.done, situation.running) for name, at in place.items()}
    humans = set(situation.cell.humans)
    by_humans = {name for name, group in begun.items() if humans.intersection(group)}
    possible = [tasks for tasks in situation.facts.sets if not (tasks ^ by_humans) & begun.keys()]
    if not any((task in tasks) == bool(humans.intersection(way.operators)) for tasks in possible):
        yield f"`stress_of_set` lists no set in which {' and '.join(way.operators)} do task {task!r} after what was done"


def _plain(record: Running | Work | Order) -> dict[str, Any]:
    return {key: list(value) if isinstance(value, tuple) else value for key, value in vars(record).items()}
