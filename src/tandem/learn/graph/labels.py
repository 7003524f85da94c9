"""What the policy learns from: decisions in training cells, with what each choice loses.

Where few tasks are left the losses of all choices are exact (`optimum`), else as far as a search by
insertion sees that goes on behind each of them (`near_optimum`). The states are those that the
policy itself comes to.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from random import Random
from typing import Any, NamedTuple

import numpy as np

from tandem.cell.model import Cell
from tandem.learn.graph.candidates import ABOUT, Choices, Making, Sight, sight
from tandem.learn.graph.making import Maker, retold
from tandem.learn.graph.near_optimum import FINE, NearSearch
from tandem.learn.graph.network import Weights
from tandem.learn.graph.optimum import Search
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.training_cells import training_cell
from tandem.plan import insertion_moves
from tandem.plan.insertion import Insertion
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, PartialSchedule
from tandem.plan.rules import SPECS, SWEEP, build, exchange_of
from tandem.plan.starts import Starts

WITHOUT_STRESS = 0.5
"""The share of cells in which time alone counts."""
MOST_LOSS, UNKNOWN = 1.0, 1.0
"""Mean task times: larger losses are not told apart; what a choice is taken to lose of which only
is known that a good schedule does without it.
"""
ASTRAY, WARM = 0.15, 0.5
"""How often a choice is drawn from all that lose little enough to be told apart, instead of what
the policy draws, its logits divided by `WARM`.
"""
NODES = 20_000
"""Of a search for exact losses."""


@dataclass(frozen=True)
class Looks:
    """How well labels are looked up.

    Attributes:
      exact: losses are exact where at most so many tasks are left.
      told: so many decisions of a cell are labelled in the mean.
      known: visits for each task of the search for a good schedule of what is left, before the
        choices are looked at.
      each: the same behind each choice.
      own: 0, or nothing is looked up: the best of so many schedules that the policy draws is taken
        to be right, and all that it does without to lose `UNKNOWN`.
    """

    exact: int = 14
    told: int = 12
    known: int = 300
    each: int = 25
    own: int = 0


Arrays = dict[str, np.ndarray[Any, Any]]


@dataclass(frozen=True)
class Label:
    """Decisions in one training cell.

    Attributes:
      number, most_tasks: of the cell, see `training_cell`. exchange: ticks that a unit of stress is
        worth.
      sizes: `[D]`, how many choices each decision has; their sum is `M`.
      seen: `[M, FEATURES]`, about: `[M, O, ABOUT]`, float16, see `Sight`. rows: `[M]`, steps.
        losses: `[M]` in mean task times. unplaced: `[D, N]`, whether a task is not placed.
    """

    number: int
    most_tasks: int
    exchange: float
    sizes: np.ndarray[Any, Any]
    seen: np.ndarray[Any, Any]
    rows: np.ndarray[Any, Any]
    losses: np.ndarray[Any, Any]
    about: np.ndarray[Any, Any]
    unplaced: np.ndarray[Any, Any]

    def outlook(self) -> Outlook:
        """The cell as the network sees it."""
        return Outlook.of(layout_of(training_cell(self.number, self.most_tasks)), self.exchange)


Losses = np.ndarray[Any, Any]


class Decided(NamedTuple):
    """What was seen of the choices of a decision, their rows, what they lose, and which tasks were
    not placed.
    """

    seen: Sight
    rows: np.ndarray[Any, Any]
    losses: Losses
    unplaced: np.ndarray[Any, Any]

    @classmethod
    def of(cls, making: Making, choices: Choices, losses: Losses) -> Decided:
        """The decision that is made next."""
        return cls(sight(making, choices), choices.rows, losses, making.unplaced > 0)


def layout_of(cell: Cell) -> Layout:
    """The cell as list scheduling wants it."""
    return Layout.of(Instance.of(cell))


def drawn_exchange(number: int, layout: Layout) -> float:
    """Ticks that a unit of stress is worth in the training cell of this number."""
    rng = np.random.default_rng((7, number))
    if rng.random() < WITHOUT_STRESS:
        return 0.0
    return float(rng.choice(SWEEP[1:-2])) * exchange_of(layout)


def label(
    weights: Weights | None, number: int, most_tasks: int, looks: Looks
) -> tuple[Label, Outlook] | None:
    """Decisions of the training cell of this number, and the cell as the network sees it: some of
    those that the policy comes to, or without `weights` of those on nearly optimal ways. None where
    no decision has two choices.
    """
    layout = layout_of(training_cell(number, most_tasks))
    exchange = drawn_exchange(number, layout)
    outlook, rng = Outlook.of(layout, exchange), np.random.default_rng((11, number))
    if layout.impossible() or not Search.can(outlook):
        return None
    maker = None if weights is None else Maker.of(weights, outlook)
    if looks.own and maker is not None:
        found = list(shown(outlook, best_own(maker, looks.own, rng)))
    else:
        found = list(visited(outlook, maker, looks, number, rng))
    if not found:
        return None
    return told(number, most_tasks, exchange, found), outlook


def told(number: int, most_tasks: int, exchange: float, found: Sequence[Decided]) -> Label:
    """Decisions in the training cell of this number as a label."""
    return Label(
        number,
        most_tasks,
        exchange,
        np.array([len(one.rows) for one in found], np.int32),
        np.concatenate([one.seen.features for one in found]).astype(np.float16),
        np.concatenate([one.rows for one in found]).astype(np.int32),
        np.concatenate([one.losses for one in found]).astype(np.float32),
        np.concatenate([one.seen.about for one in found]).astype(np.float16),
        np.array([one.unplaced for one in found]),
    )


def visited(
    outlook: Outlook, maker: Maker | None, looks: Looks, number: int, rng: np.random.Generator
) -> Iterator[Decided]:
    """Decisions on the way through the cell, with their losses."""
    layout, making = outlook.layout, Making.of(outlook)
    starts = searched(layout, outlook.exchange, looks.known * len(layout.steps), number)
    near, exact = NearSearch(outlook, starts, number), Search(outlook)
    share = looks.told / len(layout.steps)
    while making.left:
        choices, losses = making.choices(), None
        if len(choices.rows) > 1 and rng.random() < share:
            losses = _losses(making, choices, near, exact, looks)
            told_apart = np.minimum(losses / outlook.scale, MOST_LOSS)
            yield Decided.of(making, choices, told_apart)
        at = _taken(making, choices, losses, near, maker, rng)
        making.put(int(choices.rows[at]), int(choices.starts[at]))


def _losses(
    making: Making, choices: Choices, near: NearSearch, exact: Search, looks: Looks
) -> Losses:
    """Ticks that each choice loses."""
    rows, starts = choices.rows, choices.starts
    if making.left <= looks.exact:
        most = MOST_LOSS * making.outlook.scale
        found = exact.losses(making, rows, starts, most, NODES)
        if found is not None:
            return found
    near.improve(making, looks.known)
    return near.losses(making, rows, starts, looks.each)


def _taken(
    making: Making,
    choices: Choices,
    losses: Losses | None,
    near: NearSearch,
    maker: Maker | None,
    rng: np.random.Generator,
) -> int:
    """Which of the choices is taken on the way."""
    astray = rng.random() < ASTRAY
    if maker is not None and (losses is None or not astray):
        return maker.chosen(making, choices, rng, WARM)
    if losses is None:
        losses = near.losses(making, choices.rows, choices.starts, 0)
    fine = np.flatnonzero(losses <= (making.outlook.scale * MOST_LOSS if astray else 0.0))
    return int(rng.choice(fine))


def best_own(maker: Maker, count: int, rng: np.random.Generator) -> Starts:
    """The best of so many schedules that the policy draws as it was trained. Assumes a cell without
    limits.
    """
    drawn = [maker.build(rng, 1.0) for _ in range(count)]
    states = [state for state in drawn if state is not None]
    best = min(states, key=lambda state: cost(state, maker.outlook.exchange))
    return tuple(best.starts())


def shown(outlook: Outlook, starts: Starts) -> Iterator[Decided]:
    """The decisions that lead to a schedule."""
    for making, choices, which in retold(outlook, starts):
        if len(choices.rows) < 2:
            continue
        losses = np.full(len(choices.rows), UNKNOWN)
        losses[which] = 0.0
        yield Decided.of(making, choices, losses)


def searched(layout: Layout, exchange: float, passed: int, seed: int) -> Starts:
    """The schedule that search by insertion finds, from that of a rule. Assumes a cell without
    limits.
    """
    random = Random(seed)
    state = build(layout, SPECS["balanced"], random, stress=exchange)
    assert state is not None
    search = Insertion(layout, insertion_moves, random)
    search.aim(FINE, round(FINE * exchange), None, None)
    begin = tuple(state.starts())
    search.begin(begin)
    search.go(passed)
    return search.best() or begin


def cost(state: PartialSchedule, exchange: float) -> float:
    """Ticks: the makespan, and what the stress is worth."""
    return state.makespan + exchange * state.stress


def written(labels: Sequence[Label]) -> Arrays:
    """The labels as a few arrays, one behind the other."""
    whole = ("sizes", "seen", "rows", "losses")
    found: Arrays = {name: np.concatenate([getattr(one, name) for one in labels]) for name in whole}
    for name in ("about", "unplaced"):
        found[name] = np.concatenate([getattr(one, name).ravel() for one in labels])
    for name in ("number", "most_tasks", "exchange"):
        found[name] = np.array([getattr(one, name) for one in labels])
    found["decisions"] = np.array([len(one.sizes) for one in labels])
    found["tasks"] = np.array([one.unplaced.shape[1] for one in labels])
    found["operators"] = np.array([one.about.shape[1] for one in labels])
    return found


def read(arrays: Arrays) -> list[Label]:
    """The inverse of `written`."""
    found, decision, choice, about, unplaced = list[Label](), 0, 0, 0, 0
    for at, count in enumerate(arrays["decisions"].tolist()):
        sizes = arrays["sizes"][decision : decision + count]
        span = slice(choice, choice + int(sizes.sum()))
        shape = (span.stop - choice, int(arrays["operators"][at]), ABOUT)
        table = (count, int(arrays["tasks"][at]))
        found.append(
            Label(
                int(arrays["number"][at]),
                int(arrays["most_tasks"][at]),
                float(arrays["exchange"][at]),
                sizes,
                arrays["seen"][span],
                arrays["rows"][span],
                arrays["losses"][span],
                arrays["about"][about : about + math.prod(shape)].reshape(shape),
                arrays["unplaced"][unplaced : unplaced + math.prod(table)].reshape(table),
            )
        )
        about, unplaced = about + math.prod(shape), unplaced + math.prod(table)
        decision, choice = decision + count, span.stop
    return found
