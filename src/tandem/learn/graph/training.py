"""Training the policy for any cell: first it imitates exact schedules of small cells, then the best
of the schedules that it makes itself in larger ones (self-labelling; Corsini et al. 2024,
"Self-Labeling the Job Shop Scheduling Problem").

A run is kept in a folder after each round and goes on there, to the bit: every cell and every draw
follows from a number.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax

from tandem.errors import UsageError
from tandem.files.atomic import store
from tandem.learn.graph.labels import Arrays, Label, exact_label, own_label, stacked
from tandem.learn.graph.network import Weights, fresh, lasting, nodes, scores
from tandem.learn.graph.weights import packed, unpacked
from tandem.learn.networks import masked_log_softmax

Leaves = dict[str, Any]


@dataclass(frozen=True)
class Config:
    """How the policy is trained.

    Attributes:
      imitated: cells of up to `imitated_tasks` tasks whose exact schedules are imitated first, each
        planned by `work` (CP-SAT's deterministic seconds) at most.
      imitation_steps: of the optimiser, before the first round.
      rounds: of self-labelling; each draws `drawn` new cells of up to `most_tasks` tasks, labels
        them with the best of `samples` schedules, and takes `steps` steps over the last `kept`
        labels.
      batch: labels a step; `rate` of Adam, falling to a tenth.
    """

    seed: int = 0
    imitated: int = 900
    imitated_tasks: int = 18
    work: float = 0.4
    imitation_steps: int = 3000
    rounds: int = 10
    drawn: int = 64
    most_tasks: int = 40
    samples: int = 32
    steps: int = 160
    kept: int = 1200
    batch: int = 16
    rate: float = 2e-3


@dataclass(frozen=True)
class Told:
    """What is known after a round (0: after the imitation)."""

    round: int
    loss: float
    labels: int


def train(config: Config, folder: Path, on_round: Callable[[Told], None]) -> Weights:
    """The weights after the last round, in NumPy. `folder` keeps the run; where it holds one of the
    same configuration, that goes on.

    Raises UsageError when it holds another one.
    """
    folder.mkdir(parents=True, exist_ok=True)
    run = _Run.resumed(config, folder)
    if run is None:
        run = _Run.begun(config, folder)
        on_round(run.told())
    while run.round < config.rounds:
        run.go_on()
        on_round(run.told())
    return unpacked(run.weights)


@dataclass
class _Run:
    config: Config
    folder: Path
    weights: Leaves
    adam: Any
    labels: list[Label]
    pool: Arrays
    round: int = 0
    loss: float = float("nan")

    @classmethod
    def begun(cls, config: Config, folder: Path) -> _Run:
        """A run that has imitated the exact schedules."""
        rng = np.random.default_rng(config.seed)
        weights = packed(fresh(lambda shape: rng.uniform(-1, 1, shape).astype(np.float32)))
        exact = [
            exact_label(number, config.imitated_tasks, config.work)
            for number in range(config.imitated)
        ]
        labels = [label for label in exact if label is not None]
        run = cls(config, folder, weights, _adam(config).init(weights), labels, stacked(labels))
        run.learn(config.imitation_steps)
        run.keep()
        return run

    @classmethod
    def resumed(cls, config: Config, folder: Path) -> _Run | None:
        """The run in the folder; None where there is none."""
        if not (folder / "run.json").exists():
            return None
        kept = json.loads((folder / "run.json").read_text(encoding="utf-8"))
        if kept["config"] != asdict(config):
            raise UsageError(
                f"{folder}: holds a run of another configuration; name another folder."
            )
        labels = [
            Label(
                one["number"], one["most_tasks"], one["exchange"], tuple(map(tuple, one["starts"]))
            )
            for one in kept["labels"]
        ]
        with np.load(folder / "state.npz", allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        weights = {name[2:]: arrays[name] for name in arrays if name.startswith("w/")}
        like = _adam(config).init(weights)
        leaves, shape = jax.tree.flatten(like)
        adam = jax.tree.unflatten(shape, [arrays[f"a/{at}"] for at in range(len(leaves))])
        return cls(
            config, folder, weights, adam, labels, stacked(labels), kept["round"], kept["loss"]
        )

    def go_on(self) -> None:
        """One round: new labels of its own, then steps over the latest."""
        config, first = self.config, self.config.imitated + self.round * self.config.drawn
        weights = unpacked(self.weights)
        own = [
            own_label(weights, number, config.most_tasks, config.samples)
            for number in range(first, first + config.drawn)
        ]
        new = [label for label in own if label is not None]
        added = stacked(new)
        self.labels = [*self.labels, *new][-config.kept :]
        self.pool = {
            key: np.concatenate([part, added[key]])[-config.kept :]
            for key, part in self.pool.items()
        }
        self.round += 1
        self.learn(config.steps)
        self.keep()

    def learn(self, steps: int) -> None:
        """So many steps of the optimiser over the labels in hand."""
        config, losses = self.config, []
        rng = np.random.default_rng((config.seed, self.round))
        step = _step(config)
        for _ in range(steps):
            rows = rng.integers(len(self.labels), size=config.batch)
            batch = {key: part[rows] for key, part in self.pool.items()}
            self.weights, self.adam, loss = step(self.weights, self.adam, batch)
            losses.append(float(loss))
        self.loss = float(np.mean(losses))
        self.weights = {name: np.asarray(part) for name, part in self.weights.items()}

    def keep(self) -> None:
        """Writes the run into its folder."""
        leaves = jax.tree.leaves(self.adam)
        arrays = {f"w/{name}": part for name, part in self.weights.items()}
        arrays |= {f"a/{at}": np.asarray(part) for at, part in enumerate(leaves)}
        np.savez(self.folder / "state.tmp.npz", **arrays)
        (self.folder / "state.tmp.npz").replace(self.folder / "state.npz")
        document = {
            "config": asdict(self.config),
            "round": self.round,
            "loss": self.loss,
            "labels": [asdict(label) for label in self.labels],
        }
        store(self.folder / "run.json", json.dumps(document))

    def told(self) -> Told:
        """Where the run stands."""
        return Told(self.round, self.loss, len(self.labels))


def _adam(config: Config) -> optax.GradientTransformation:
    steps = config.imitation_steps + config.rounds * config.steps
    rate = optax.cosine_decay_schedule(config.rate, max(steps, 1), alpha=0.1)
    return optax.chain(optax.clip_by_global_norm(1.0), optax.adam(rate))


@cache
def _step(config: Config) -> Any:
    adam = _adam(config)

    @jax.jit
    def step(weights: Leaves, state: Any, batch: Leaves) -> Any:
        loss, gradient = jax.value_and_grad(_loss)(weights, batch)
        change, state = adam.update(gradient, state, weights)
        return optax.apply_updates(weights, change), state, loss

    return step


def _loss(leaves: Leaves, batch: Leaves) -> Any:
    """Minus the log-probability of the choices that may come next, per decision with a choice."""
    weights = unpacked(leaves)

    def of_cell(cell: Leaves) -> Any:
        task, operator = nodes(
            jnp, weights, cell["tasks"], cell["operators"], cell["pairs"], cell["before"]
        )
        steps = lasting(jnp, weights, task[cell["step task"]], cell["step share"] @ operator)
        seen = cell["seen"].astype(jnp.float32)
        return scores(jnp, weights, seen, steps[cell["row"]])

    logits = jax.vmap(of_cell)(batch)
    likely = masked_log_softmax(jnp, logits, batch["legal"])
    right = jax.nn.logsumexp(jnp.where(batch["target"], likely, -1e9), axis=-1)
    counts = batch["target"].any(-1)
    return -jnp.where(counts, right, 0.0).sum() / jnp.maximum(counts.sum(), 1)
