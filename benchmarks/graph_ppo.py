"""The policy for any cell by trial and error instead of labels, for `graph_training.py --ablations`
alone: proximal policy optimisation (Schulman et al. 2017, "Proximal Policy Optimization
Algorithms", eq. 7, with an entropy bonus as in eq. 9).

An episode is a whole schedule of a training cell, drawn from the policy with its logits as they
are. It is paid once, at the end: minus its cost in mean task times. There is no critic. What a
schedule is held against is the mean of several of the same cell and weight of stress, and what it
gained is counted in their standard deviation, the same for each of its decisions. Each batch of
schedules is of cells that were never drawn before: no labels have to be looked up, so there is no
reason to see one twice.

A run is kept in a folder and goes on there, to the bit.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np

from tandem.files.atomic import store
from tandem.learn.graph.candidates import Making, sight
from tandem.learn.graph.labels import Decided, cost, drawn_exchange, layout_of, told
from tandem.learn.graph.making import Maker
from tandem.learn.graph.network import Weights
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.pool import DECISIONS, SIZES, Seen, batch
from tandem.learn.graph.training import (
    APART,
    Leaves,
    adam,
    keep_state,
    kept_run,
    kept_state,
    likely,
    per_decision,
    stepping,
    untrained,
)
from tandem.learn.graph.training_cells import training_cell
from tandem.learn.graph.weights import unpacked

KEPT_EVERY = 10
"""Batches; a run that is stopped goes on from the last that was kept."""


@dataclass(frozen=True)
class Config:
    """How the policy is trained.

    Attributes:
      batches: how often schedules are drawn, each time of `cells` cells of up to `small` tasks and
        `cells_large` of up to `most_tasks`, as many `schedules` of each.
      epochs: so often each decision is learned from in the mean before new ones are drawn; steps
        of the optimiser take `batch` schedules and eight decisions of each.
      clip: how far the chance of what was done may move, as a share, before there is nothing more
        to gain.
      entropy: what a unit of it (in nats) is worth beside the gain.
      rate: of Adam; it falls to a fiftieth.
    """

    seed: int = 0
    batches: int = 40
    cells: int = 16
    cells_large: int = 8
    small: int = 14
    most_tasks: int = 24
    schedules: int = 8
    epochs: int = 4
    clip: float = 0.2
    entropy: float = 0.01
    batch: int = 24
    rate: float = 1e-3


def train(
    config: Config, folder: Path, on_kept: Callable[[int], None] = lambda done: None
) -> Weights:
    """The weights after the last batch, in NumPy. `folder` keeps the run; where it holds one of the
    same configuration, that goes on. `on_kept` is told how many batches are done whenever it was
    kept.

    Raises UsageError when it holds another one.
    """
    folder.mkdir(parents=True, exist_ok=True)
    kept = kept_run(folder, config)
    if kept is None:
        done, leaves = 0, untrained(config.seed)
        state = adam().init(leaves)
    else:
        done = kept["batches"]
        leaves, state = kept_state(folder / f"state-{done}.npz")
    while done < config.batches:
        leaves, state = _after(config, done, leaves, state)
        done += 1
        if done % KEPT_EVERY == 0 or done == config.batches:
            keep_state(folder / f"state-{done}.npz", leaves, state)
            store(folder / "run.json", json.dumps({"config": asdict(config), "batches": done}))
            on_kept(done)
    return unpacked(leaves)


def _after(config: Config, done: int, leaves: Leaves, state: Any) -> tuple[Leaves, Any]:
    """Weights and state of the optimiser after one batch more."""
    rng = np.random.default_rng((13, config.seed, done))
    pool = drawn(config, done, unpacked(leaves), rng)
    decisions = sum(len(one.label.sizes) for of_size in pool for one in of_size)
    steps = -(-config.epochs * decisions // (config.batch * DECISIONS))
    # falls as the other trainings do, but batch by batch
    share = 0.02 + 0.98 * (1 + np.cos(np.pi * done / config.batches)) / 2
    step = _step(config.batch, config.clip, config.entropy)
    for _ in range(steps):
        part = batch(pool, rng, config.batch)
        leaves, state, _ = step(leaves, state, part, np.float32(config.rate * share))
    return {name: np.asarray(one) for name, one in leaves.items()}, state


def drawn(
    config: Config, done: int, weights: Weights, rng: np.random.Generator
) -> list[list[Seen]]:
    """Schedules of new cells, for each of `SIZES` those of cells of that size."""
    sizes = [config.small] * config.cells + [config.most_tasks] * config.cells_large
    begin = config.seed * APART + done * len(sizes)
    pool: list[list[Seen]] = [[] for _ in SIZES]
    for number, most_tasks in enumerate(sizes, begin):
        for one in schedules_of(weights, number, most_tasks, config.schedules, rng):
            pool[one.size].append(one)
    return pool


def schedules_of(
    weights: Weights, number: int, most_tasks: int, count: int, rng: np.random.Generator
) -> list[Seen]:
    """So many schedules of the training cell of this number; none where no decision has two
    choices.

    The labels' `losses` are `[M, 2]`: what a choice that was made gained, 0 for all others, and the
    logarithm of the chance that each choice had.
    """
    layout = layout_of(training_cell(number, most_tasks))
    outlook = Outlook.of(layout, drawn_exchange(number, layout))
    maker, found = Maker.of(weights, outlook), []
    for _ in range(count):
        found.append(_schedule(maker, rng))
    costs = np.array([paid for _, paid in found])
    gains = (costs.mean() - costs) / (costs.std() or 1.0)
    seen = list[Seen]()
    for (decisions, _), gain in zip(found, gains, strict=True):
        if not decisions:
            continue
        for one, taken in decisions:
            one.losses[taken, 0] = gain
        label = told(number, most_tasks, outlook.exchange, [one for one, _ in decisions])
        # the cell's own arrays are made once
        ends = np.cumsum([0, *label.sizes])
        seen.append(replace(seen[0], label=label, at=ends) if seen else Seen.of(label, outlook))
    return seen


def _schedule(maker: Maker, rng: np.random.Generator) -> tuple[list[tuple[Decided, int]], float]:
    """The decisions of a schedule that had two choices or more, with which one was made, and what
    the schedule costs in mean task times. Their `losses` are `[K, 2]`: 0, and the logarithm of the
    chance of each choice. Assumes a cell without limits.
    """
    making, decisions = Making.of(maker.outlook), list[tuple[Decided, int]]()
    while making.left:
        choices, at = making.choices(), 0
        if len(choices.rows) > 1:
            # rounded as labels are, so that what is learned from is what was decided on
            seen = sight(making, choices)
            seen = seen._replace(features=_rounded(seen.features), about=_rounded(seen.about))
            logits = maker.judged(making, seen, choices)
            shifted = logits - logits.max()
            at = int((shifted + rng.gumbel(size=len(shifted))).argmax())
            chances = shifted - np.log(np.exp(shifted).sum())
            losses = np.stack([np.zeros(len(chances)), chances], -1)
            decisions.append((Decided(seen, choices.rows, losses, making.unplaced > 0), at))
        making.put(int(choices.rows[at]), int(choices.starts[at]))
    return decisions, cost(making.state, maker.outlook.exchange) / maker.outlook.scale


def _rounded(array: np.ndarray) -> np.ndarray:
    return array.astype(np.float16).astype(np.float32)


@cache
def _step(schedules: int, clip: float, entropy: float) -> Any:
    count = schedules * DECISIONS
    return stepping(partial(clipped, count=count, clip=clip, entropy=entropy))


def clipped(leaves: Leaves, part: Leaves, count: int, clip: float, entropy: float) -> Any:
    """Minus the clipped surrogate objective and the entropy bonus, per decision."""
    gain, before = part["loss"][:, 0], part["loss"][:, 1]
    now = likely(leaves, part, count)
    ratio = jnp.exp(now - before)
    # all but the choice that was made gained 0
    objective = jnp.minimum(ratio * gain, jnp.clip(ratio, 1 - clip, 1 + clip) * gain)
    spread = -jnp.exp(now) * now
    return -per_decision(objective + entropy * spread, part["decision"], count)
