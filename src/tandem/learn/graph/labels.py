"""What the policy learns from: decisions in training cells, with what each choice loses.

Where a dozen tasks or so are left, the losses of all choices are exact (`optimum`), in states that
the policy itself comes to. Of a cell with more tasks there is also a good schedule, whose choices
lose nothing; of the others nothing is known.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from random import Random
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.learn.graph.candidates import Choices, Making, features
from tandem.learn.graph.making import Maker, retold
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

WITHOUT_STRESS = 0.4
"""The share of cells in which time alone counts."""
MOST_LOSS, UNKNOWN = 1.0, 0.15
"""Mean task times: larger losses are not told apart; what a choice is taken to lose of which only
is known that a good schedule does without it.
"""
ASTRAY = 0.3
"""How often a choice is drawn from all whose loss is told, instead of from the best ones, or from
the policy's.
"""
NODES = 50_000
"""Of a search for exact losses."""

Arrays = dict[str, np.ndarray[Any, Any]]


@dataclass(frozen=True)
class Label:
    """Decisions in one training cell.

    Attributes:
      number, most_tasks: of the cell, see `training_cell`. exchange: ticks that a unit of stress is
        worth.
      sizes: `[D]`, how many choices each decision has; their sum is `M`.
      seen: `[M, FEATURES]` float16. rows: `[M]`, steps. losses: `[M]` in mean task times.
    """

    number: int
    most_tasks: int
    exchange: float
    sizes: np.ndarray[Any, Any]
    seen: np.ndarray[Any, Any]
    rows: np.ndarray[Any, Any]
    losses: np.ndarray[Any, Any]

    def outlook(self) -> Outlook:
        """The cell as the network sees it."""
        return Outlook.of(layout_of(training_cell(self.number, self.most_tasks)), self.exchange)


Decided = tuple[np.ndarray[Any, Any], np.ndarray[Any, Any], np.ndarray[Any, Any]]
"""What was seen of the choices of a decision, their rows, and what they lose."""


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
    weights: Weights | None, number: int, most_tasks: int, exact: int, passed: int
) -> tuple[Label, Outlook] | None:
    """Decisions of the training cell of this number, and the cell as the network sees it: those
    that the policy comes to, or without `weights` those near optimal ones, where at most `exact`
    tasks are left; and in larger cells those of the schedule that a local search finds which passes
    so many tasks by. None where no decision has two choices.
    """
    layout = layout_of(training_cell(number, most_tasks))
    exchange = drawn_exchange(number, layout)
    outlook, rng = Outlook.of(layout, exchange), np.random.default_rng((11, number))
    if layout.impossible() or not Search.can(outlook):
        return None
    maker = None if weights is None else Maker.of(weights, outlook)
    found = list(visited(outlook, maker, exact, rng))
    if len(layout.steps) > exact:
        found += list(shown(outlook, searched(layout, exchange, passed, number)))
    if not found:
        return None
    seen, rows, losses = zip(*found, strict=True)
    told = Label(
        number,
        most_tasks,
        exchange,
        np.array([len(row) for row in rows], np.int32),
        np.concatenate(seen).astype(np.float16),
        np.concatenate(rows).astype(np.int32),
        np.concatenate(losses).astype(np.float32),
    )
    return told, outlook


def visited(
    outlook: Outlook, maker: Maker | None, exact: int, rng: np.random.Generator
) -> Iterator[Decided]:
    """The decisions on the way through the cell of which exact losses are known."""
    search, making = Search(outlook), Making.of(outlook)
    while making.left:
        choices = making.choices()
        losses = None
        if len(choices.rows) > 1 and making.left <= exact:
            most = MOST_LOSS * outlook.scale
            losses = search.losses(making, choices.rows, choices.starts, most, NODES)
        if losses is not None:
            told = np.minimum(losses / outlook.scale, MOST_LOSS)
            yield features(making, choices), choices.rows, told
        at = _taken(making, choices, losses, maker, rng)
        making.put(int(choices.rows[at]), int(choices.starts[at]))


def _taken(
    making: Making,
    choices: Choices,
    losses: np.ndarray[Any, Any] | None,
    maker: Maker | None,
    rng: np.random.Generator,
) -> int:
    """Which of the choices is taken on the way."""
    astray = rng.random() < ASTRAY
    if losses is not None and (astray or maker is None):
        fine = np.flatnonzero(losses <= (making.outlook.scale * MOST_LOSS if astray else 0.0))
        return int(rng.choice(fine))
    if maker is None:
        # too many tasks are left to know better: what ends first
        return int((choices.starts + making.outlook.steps.ticks[choices.rows]).argmin())
    return maker.chosen(making, choices, rng, 1.0)


def shown(outlook: Outlook, starts: Sequence[tuple[int, int]]) -> Iterator[Decided]:
    """The decisions that lead to a schedule."""
    for making, choices, which in retold(outlook, starts):
        if len(choices.rows) < 2:
            continue
        losses = np.full(len(choices.rows), UNKNOWN)
        losses[which] = 0.0
        yield features(making, choices), choices.rows, losses


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


FINE = 1000
"""Whole parts of a tick that the insertion search counts costs in."""


def cost(state: PartialSchedule, exchange: float) -> float:
    """Ticks: the makespan, and what the stress is worth."""
    return state.makespan + exchange * state.stress


def written(labels: Sequence[Label]) -> Arrays:
    """The labels as a few arrays, one behind the other."""
    whole = ("sizes", "seen", "rows", "losses")
    found: Arrays = {name: np.concatenate([getattr(one, name) for one in labels]) for name in whole}
    for field in fields(Label):
        if field.name not in whole:
            found[field.name] = np.array([getattr(one, field.name) for one in labels])
    found["decisions"] = np.array([len(one.sizes) for one in labels])
    return found


def read(arrays: Arrays) -> list[Label]:
    """The inverse of `written`."""
    found, decision, choice = list[Label](), 0, 0
    for at, count in enumerate(arrays["decisions"]):
        sizes = arrays["sizes"][decision : decision + count]
        end = choice + int(sizes.sum())
        found.append(
            Label(
                int(arrays["number"][at]),
                int(arrays["most_tasks"][at]),
                float(arrays["exchange"][at]),
                sizes,
                *(arrays[name][choice:end] for name in ("seen", "rows", "losses")),
            )
        )
        decision, choice = decision + int(count), end
    return found
