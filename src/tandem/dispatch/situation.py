"""Where a shift stands, as far as it has been seen: what deciders look at. Frozen, plain Python; knows no JAX and no solver.

`after(situation, event)` moves it on, `legal(situation)` says what may begin. Times are seconds since the shift's start. Whoever begins
a task takes up its tool first (the changeover), so that a task's own work begins `changeover` seconds after its start.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from tandem.cell.model import Cell, Mode

Outcome = Literal["done", "taken apart", "broken off"]

TAKING_APART = 1.0
"""ASSUMPTION: taking apart takes so many times as long as doing, with the same operators, tool and zone. `Situation.taking_apart` sets it."""


@dataclass(frozen=True)
class Running:
    """A task under way.

    Attributes:
      operators: who does it, in the cell's order.
      start: when they began, the changeover included, s.
      expected_end: by the stated times, s; later when the work has rested. It may have passed: people are slower than stated.
      undoing: it is being taken apart, not done.
      confirmed: the floor has said that it began; False while it is only an order to a robot.
      rests_since: since when nobody works on it, an operator being absent or failed; None while it goes on.
      rested: seconds that it has rested before.
    """

    operators: tuple[str, ...]
    start: float
    expected_end: float
    undoing: bool = False
    confirmed: bool = True
    rests_since: float | None = None
    rested: float = 0.0

    @property
    def stated(self) -> float:
        """Seconds that it takes as stated, changeover included."""
        return self.expected_end - self.start - self.rested


@dataclass(frozen=True)
class Work:
    """Work that ended: the as-run record, from which each operator's pace is told.

    Attributes:
      start, end: s; between them it `rested` for so many seconds.
      stated: seconds that it should have taken, changeover included.
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
class Situation:
    """What has been seen of a shift: one assembly in one cell.

    Attributes:
      now: s since the start.
      done: task -> the work that did it; what turned out wrong or was taken apart is no longer in it.
      running: task -> who is at it since when; orders to robots that the floor has not confirmed are in it too.
      past: all work that ended, in the order in which it ended.
      absent: humans who are away. `failed`: robots that are down.
      refused: (operator, task) -> until when (s) that operator will not do the task; None: for the whole shift.
      announced: human -> the task that the last decision asked for.
      wrong: tasks that are mounted wrongly, or on top of something wrong, with the work that did so: they must be taken apart, then done again.
      in_hand: operator -> the tool in hand; who is missing takes up the first one at no cost.
      taking_apart: see `TAKING_APART`.
    """

    cell: Cell
    now: float = 0.0
    done: Mapping[str, Work] = field(default_factory=dict)
    running: Mapping[str, Running] = field(default_factory=dict)
    past: tuple[Work, ...] = ()
    absent: frozenset[str] = frozenset()
    failed: frozenset[str] = frozenset()
    refused: Mapping[tuple[str, str], float | None] = field(default_factory=dict)
    announced: Mapping[str, str] = field(default_factory=dict)
    wrong: Mapping[str, Work] = field(default_factory=dict)
    in_hand: Mapping[str, str] = field(default_factory=dict)
    taking_apart: float = TAKING_APART

    @classmethod
    def of(cls, cell: Cell, *, taking_apart: float = TAKING_APART) -> Situation:
        """The start of a shift: nothing done, everybody there."""
        return cls(cell, in_hand={who: operator.tool for who, operator in cell.operators.items() if operator.tool}, taking_apart=taking_apart)

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
            "past": [_plain(work) for work in self.past],
            "absent": sorted(self.absent),
            "failed": sorted(self.failed),
            "refused": [[who, task, until] for (who, task), until in sorted(self.refused.items())],
            "announced": dict(sorted(self.announced.items())),
            "wrong": {task: _plain(work) for task, work in sorted(self.wrong.items())},
            "in_hand": dict(sorted(self.in_hand.items())),
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


def changeover(situation: Situation, task: str, operators: Iterable[str]) -> float:
    """Seconds until all of them hold the tool that the task needs."""
    tool = situation.cell.tasks[task].tool
    if tool is None or tool not in situation.cell.tools:
        return 0.0
    times = situation.cell.tools[tool].changeover
    return max((times.get(who, 0.0) for who in operators if situation.in_hand.get(who, tool) != tool), default=0.0)


def seconds(situation: Situation, task: str, operators: tuple[str, ...]) -> float:
    """How long it would take them from now on as stated, changeover included: to do the task, or to take it apart when it is wrong."""
    time = mode(situation.cell, task, operators).time
    return changeover(situation, task, operators) + (time * situation.taking_apart if task in situation.wrong else time)


def legal(situation: Situation) -> list[tuple[str, tuple[str, ...]]]:
    """What may begin now, as (task, operators), in the cell's order. For a task in `situation.wrong` it means taking it apart.

    Predecessors have ended (or, to take a task apart, nothing stands on it any more), all operators are there and at nothing, the release has
    come, the tool and the place in the zone are free when the changeover is over, no break falls into the stated time, and stress limits,
    `same_operator`, `stress_of_set` and refusals are kept. Deadlines are not looked at: late is better than never.
    """
    idle = frozenset(situation.idle)
    found: dict[tuple[str, tuple[str, ...]], None] = {}
    for task in situation.open:
        if is_ready(situation, task):
            for way in situation.cell.modes(task):
                if idle.issuperset(way.operators) and not any(hindrances(situation, task, way.operators)):
                    found[task, way.operators] = None
    return list(found)


def is_ready(situation: Situation, task: str) -> bool:
    """What must come before has come: what the task stands on is in place; or, where the task is wrong, all that stands on it is off."""
    if task in situation.wrong:
        return not any(after in place for after in behind(situation.cell, task) for place in (situation.done, situation.wrong, situation.running))
    return all(first in situation.done for first in situation.cell.tasks[task].after)


def hindrances(situation: Situation, task: str, operators: tuple[str, ...]) -> Iterator[str]:
    """What else stands against these operators beginning the task now, in sentences; none when nothing does. Assumes that they have a mode for it."""
    cell, now = situation.cell, situation.now
    facts = cell.tasks[task]
    begin = now + changeover(situation, task, operators)
    end = now + seconds(situation, task, operators)
    if begin < facts.release:
        yield f"task {task!r} is released at {facts.release:g} s"
    for who in operators:
        if situation.is_refused(who, task):
            until = situation.refused[who, task]
            yield f"{who!r} does not want task {task!r}" + ("" if until is None else f" before {until:g} s")
        for off, back in cell.operators[who].breaks:
            if off < end and now < back:
                yield f"{who!r} has a break from {off:g} s to {back:g} s"
    if facts.tool is not None and not _has_places(situation, "tool", facts.tool, begin, len(operators)):
        yield f"tool {facts.tool!r} is in use"
    if facts.zone is not None and not _has_places(situation, "zone", facts.zone, begin, len(operators)):
        yield f"zone {facts.zone!r} is taken"
    yield from _limits(situation, task, operators)


def next_change(situation: Situation) -> float | None:
    """When the clock alone may make something legal, s: a release, the end of a break, the end of a refusal. None when it never will."""
    cell = situation.cell
    times = [cell.tasks[task].release for task in situation.open]
    times += [back for operator in cell.operators.values() for _, back in operator.breaks]
    times += [until for until in situation.refused.values() if until is not None]
    return min((time for time in times if time > situation.now), default=None)


def _has_places(situation: Situation, kind: Literal["tool", "zone"], name: str, begin: float, needed: int) -> bool:
    """Whether so many places are free from `begin` on. What is overdue now holds its places still."""
    cell = situation.cell
    table: Mapping[str, Any] = cell.tools if kind == "tool" else cell.zones
    places: int = table[name].capacity if name in table else 1
    for task, at in situation.running.items():
        ends = at.rests_since is None and situation.now < at.expected_end <= begin
        if getattr(cell.tasks[task], kind) == name and not ends:
            places -= len(at.operators)
    return needed <= places


def _limits(situation: Situation, task: str, operators: tuple[str, ...]) -> Iterator[str]:
    cell = situation.cell
    load = situation.load if any(operator.stress_limit is not None for operator in cell.operators.values()) else {}
    for human, stress in mode(cell, task, operators).stress.items():
        limit = cell.operators[human].stress_limit
        if limit is not None and load[human] + stress > limit + 1e-9:
            yield f"{human!r} would collect {load[human] + stress:g} of stress, the limit is {limit:g}"
    settled = {other: work.operators for other, work in situation.done.items()}
    settled |= {other: at.operators for other, at in situation.running.items() if not at.undoing}
    if task in situation.wrong:
        return
    for pair in cell.same_operator:
        if task in pair:
            other = pair[0] if pair[1] == task else pair[1]
            if other in settled and set(settled[other]) != set(operators):
                yield f"{' and '.join(settled[other])} must do task {task!r}, because they did task {other!r}"
            elif other not in settled and not any(set(way.operators) == set(operators) for way in cell.modes(other)):
                yield f"whoever does task {task!r} must do task {other!r}, which {' and '.join(operators)} cannot do"
    if cell.stress_of_set is not None:
        chosen = {**settled, task: operators}
        human = {name for name, group in chosen.items() if any(who in cell.humans for who in group)}
        listed = [set(filter(None, names.split(","))) for names in cell.stress_of_set]
        if not any(human <= tasks and not (chosen.keys() - human) & tasks for tasks in listed):
            yield f"`stress_of_set` lists no set in which {' and '.join(operators)} do task {task!r} after what is done"


def behind(cell: Cell, task: str) -> tuple[str, ...]:
    """The direct successors of the task, in the cell's order."""
    return tuple(name for name, facts in cell.tasks.items() if task in facts.after)


def _plain(record: Running | Work) -> dict[str, Any]:
    return {key: list(value) if isinstance(value, tuple) else value for key, value in vars(record).items()}
