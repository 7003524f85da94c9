"""Where a shift stands, as far as it has been seen: what deciders look at. Frozen, plain Python;
knows no JAX and no solver.

`legal.py` says what may begin; `after.py` moves a situation on. The rules are those of the world
(`tandem.world.state`) in other words: a test holds both together. Times are seconds since the
shift's start. Who was idle has used that time to take up the tool of the next task; what is left of
a changeover belongs to the work that follows it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from tandem.cell.model import Cell
from tandem.cell.parts import Mode
from tandem.dispatch.situation.facts import Facts

Outcome = Literal["done", "taken apart", "broken off"]

TAKING_APART = 1.0
"""ASSUMPTION: taking apart takes so many times as long as doing, with the same operators, tool and
zone. `Situation.taking_apart` sets it.
"""


@dataclass(frozen=True)
class Running:
    """A task under way.

    Attributes:
      operators: who does it, in the cell's order.
      start: when they began, with what was left of a changeover, s.
      expected_end: by the stated times, s; later when the work has rested. It may have passed:
        people are slower than stated.
      undoing: it is being taken apart, not done.
      rests_since: since when nobody works on it, an operator being absent or failed; None while it
        goes on.
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
      done: task -> the work that did it; what turned out wrong or was taken apart is no longer in
        it.
      running: task -> who is at it since when.
      past: all work that ended, in the order in which it ended.
      absent: humans who are away. `failed`: robots that are down.
      refused: (operator, task) -> until when (s) that operator will not do the task; None: for the
        whole shift.
      orders: task -> the order of the last decision that no start has followed yet. The next
        decision replaces it: an order binds nobody.
      announced: human -> the task that the last decision asked for.
      wrong: tasks that are mounted wrongly, or on top of something wrong, with the work that did
        so: they must be taken apart, then done again.
      in_hand: operator -> the tool in hand; who is missing takes up the first one at no cost.
      since: operator -> since when they could have taken up another tool: the end of the last work
        or absence; 0 for who is missing.
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
        """Tasks that nobody is at and that are not in place, in the cell's order; those that are
        wrong are among them.
        """
        return tuple(
            task for task in self.cell.tasks if task not in self.running and task not in self.done
        )

    @property
    def is_over(self) -> bool:
        """Everything is done."""
        return len(self.done) == len(self.cell.tasks)

    @property
    def idle(self) -> tuple[str, ...]:
        """Operators who are there and at nothing, in the cell's order."""
        busy = {who for at in self.running.values() for who in at.operators}
        return tuple(
            who
            for who in self.cell.operators
            if who not in busy and who not in self.absent and who not in self.failed
        )

    @property
    def makespan(self) -> float:
        """When the last task that is done now ended, s; 0 before any."""
        return max((work.end for work in self.done.values()), default=0.0)

    @property
    def load(self) -> dict[str, float]:
        """Human -> stress so far, running work included; every doing and taking apart counts, work
        that was broken off does not.
        """
        load = dict.fromkeys(self.cell.humans, 0.0)
        work = [(one.task, one.operators) for one in self.past if one.outcome != "broken off"]
        for task, operators in [
            *work,
            *((task, at.operators) for task, at in self.running.items()),
        ]:
            for human, stress in mode(self.cell, task, operators).stress.items():
                load[human] += stress
        return load

    @property
    def stress(self) -> float:
        """Of all humans together, as a sum over their work (also where the cell has
        `stress_of_set`).
        """
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
    """The way in which these operators do the task: of several the quickest, of these the one of
    least stress.

    Raises KeyError when they have none.
    """
    who = frozenset(operators)
    ways = [way for way in cell.modes(task) if who == frozenset(way.operators)]
    if not ways:
        raise KeyError((task, tuple(operators)))
    return min(ways, key=lambda way: (way.time, sum(way.stress.values())))


def exact(seconds: float) -> float:
    """Without the dust that adding floats leaves: cells and events have at most six decimals."""
    return round(seconds, 6)


def _plain(record: Running | Work | Order) -> dict[str, Any]:
    return {
        key: list(value) if isinstance(value, tuple) else value
        for key, value in vars(record).items()
    }
