"""Where a shift stands, as far as it has been seen: what deciders look at. Frozen, plain Python;
knows no JAX and no solver.

`legal.py` says what may begin; `transitions.py` moves a situation on. The rules are those of the
world (`tandem.world.state`) in other words: a test holds both together. A shift is product after
product. Times are seconds since the beginning of the product, as the cell's own releases, deadlines
and breaks are; `Situation.began` leads to the shift's clock, which is what the floor tells and
hears. Who was idle has used that time to walk to the next task and to take up its tool; what is
left of a walk or a changeover belongs to the work that follows it.
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
Stock = Literal["tool", "part", "task"]
"""What can be missing: a tool that is broken, a part, or whatever a task needs."""

TAKING_APART = 1.0
"""ASSUMPTION: taking apart takes so many times as long as doing, with the same operators, tool and
zone. `Situation.taking_apart` sets it.
"""


@dataclass(frozen=True)
class Running:
    """A task under way.

    Attributes:
      operators: who does it, in the cell's order.
      start: when they began, with what was left of a walk or a changeover, s.
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
        """Seconds that it takes as stated, with what was left of a walk or a changeover."""
        return self.expected_end - self.start - self.rested


@dataclass(frozen=True)
class Work:
    """Work that ended: the as-run record, from which each operator's pace is told.

    Attributes:
      start, end: s; between them it `rested` for so many seconds.
      stated: seconds that it should have taken, with what was left of a walk or a changeover.
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
class Product:
    """A product of the shift.

    Attributes:
      number: counting from 1 in the order in which they were ordered, which is the order in which
        they are made.
      order: the order's id, as the floor gave it; None when it gave none.
      variant: the name of its cell, for products that differ; None for the shift's own cell.
    """

    number: int
    order: str | None = None
    variant: str | None = None

    @property
    def words(self) -> str:
        """As messages name it: "product 3 (order 'A-17')"."""
        return f"product {self.number}" + ("" if self.order is None else f" (order {self.order!r})")


@dataclass(frozen=True)
class Learnt:
    """What a person's work has told of their pace, before any prior: the sums of a normal
    posterior in logarithms, the earlier the work the less it weighs; see `pace.py`.

    Attributes:
      precision: sum of the weights / variance.
      weighted: sum of the weights * logarithm of the pace seen / variance.
      seen: pieces of work, each counted as one.
    """

    precision: float = 0.0
    weighted: float = 0.0
    seen: int = 0


NOTHING = Learnt()
"""Nothing was seen of somebody."""


@dataclass(frozen=True)
class Situation:
    """What has been seen of a shift: the product under way, in its cell, and what outlives it.

    A product's beginning (`transitions.begun`) empties what belongs to one product (`done`,
    `running`, `past`, `orders`, `announced`, `wrong`, `since`, and `now` is 0 again) and keeps the
    rest.

    Attributes:
      now: s since the product's beginning.
      done: task -> the work that did it; what turned out wrong or was taken apart is no longer in
        it.
      running: task -> who is at it since when.
      past: all work at this product that ended, in the order in which it ended.
      absent: humans who are away. `failed`: robots that are down.
      refused: (operator, task) -> until when (s) that operator will not do the task; None: for the
        whole shift.
      orders: task -> the order of the last decision that no start has followed yet. The next
        decision replaces it: an order binds nobody.
      announced: human -> the task that the last decision asked for.
      wrong: tasks that are mounted wrongly, or on top of something wrong, with the work that did
        so: they must be taken apart, then done again.
      in_hand: operator -> the tool in hand; who is missing takes up the first one at no cost.
      stands: operator -> the place where they stand; who is missing walks to the first one at no
        cost.
      since: operator -> since when they could have got ready for other work: the end of the last
        work or absence; 0 for who is missing.
      taking_apart: see `TAKING_APART`.
      known: `facts` when they have been worked out; handed on from situation to situation.
      product: the one under way, or the last one when it is done; None before the first.
      began: s of the shift's clock at which it began.
      queued: what was ordered and has not begun, first come first made.
      ended: the shift's end was told; no further product begins.
      stock: what is broken or missing -> since when, s of the shift's clock.
      persons: operator -> who stands at its place, by a name of the floor's; a human who is not in
        it goes by the operator's own name.
      joined: human -> since when (s) that person is there, where it is not since the product's
        beginning.
      learnt: person -> what their work before this product told of their pace, and at this product
        before they left.
      cells: variant -> its cell and its facts, None being the shift's own; empty where there is
        one cell only.
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
    stands: Mapping[str, str] = field(default_factory=dict)
    since: Mapping[str, float] = field(default_factory=dict)
    taking_apart: float = TAKING_APART
    known: Facts | None = field(default=None, repr=False, compare=False)
    product: Product | None = Product(1)
    began: float = 0.0
    queued: tuple[Product, ...] = ()
    ended: bool = False
    stock: Mapping[tuple[Stock, str], float] = field(default_factory=dict)
    persons: Mapping[str, str] = field(default_factory=dict)
    joined: Mapping[str, float] = field(default_factory=dict)
    learnt: Mapping[str, Learnt] = field(default_factory=dict)
    cells: Mapping[str | None, tuple[Cell, Facts]] = field(
        default_factory=dict, repr=False, compare=False
    )

    @classmethod
    def of(
        cls,
        cell: Cell,
        *,
        taking_apart: float = TAKING_APART,
        variants: Mapping[str, Cell] | None = None,
        products: int = 1,
    ) -> Situation:
        """The start of a shift: nothing done, everybody there.

        Args:
          variants: cells of products that differ, by name; with the same operators.
          products: so many of `cell` are ordered at the start; the first one begins. With 0 the
            shift waits for its first order.
        """
        hands = {who: operator.tool for who, operator in cell.operators.items() if operator.tool}
        spots = {who: operator.place for who, operator in cell.operators.items() if operator.place}
        facts = Facts.of(cell)
        cells: dict[str | None, tuple[Cell, Facts]] = {None: (cell, facts)}
        cells |= {name: (other, Facts.of(other)) for name, other in (variants or {}).items()}
        ordered = tuple(Product(number) for number in range(1, products + 1))
        return cls(
            cell,
            in_hand=hands,
            stands=spots,
            taking_apart=taking_apart,
            known=facts,
            product=ordered[0] if ordered else None,
            queued=ordered[1:],
            cells=cells,
        )

    @cached_property
    def facts(self) -> Facts:
        """What follows from the cell."""
        return self.known or Facts.of(self.cell)

    @property
    def open(self) -> tuple[str, ...]:
        """Tasks that nobody is at and that are not in place, in the cell's order; those that are
        wrong are among them.
        """
        if self.product is None:
            return ()
        return tuple(
            task for task in self.cell.tasks if task not in self.running and task not in self.done
        )

    @property
    def is_over(self) -> bool:
        """Everything is done of the product under way; nothing is under way before the first."""
        return self.product is None or len(self.done) == len(self.cell.tasks)

    @property
    def products_done(self) -> int:
        """How many products are done."""
        if self.product is None:
            return 0
        return self.product.number - (0 if self.is_over else 1)

    @property
    def clock(self) -> float:
        """Now, s since the start of the shift."""
        return self.on_clock(self.now)

    def on_clock(self, seconds: float) -> float:
        """Seconds since the product's beginning as seconds since the start of the shift."""
        return exact(self.began + seconds)

    def person(self, human: str) -> str:
        """Who stands at the human's place."""
        return self.persons.get(human, human)

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
            "product": None if self.product is None else vars(self.product),
            "began": self.began,
            "queued": [vars(product) for product in self.queued],
            "ended": self.ended,
            "stock": [[kind, name, since] for (kind, name), since in sorted(self.stock.items())],
            "persons": dict(sorted(self.persons.items())),
            "joined": dict(sorted(self.joined.items())),
            "learnt": {who: vars(known) for who, known in sorted(self.learnt.items())},
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
            # only where the cell has places, so that all others keep their digests
            **({"stands": dict(sorted(self.stands.items()))} if self.stands else {}),
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
