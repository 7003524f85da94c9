"""Training the policy for any cell by imitation: first of exact decisions in small cells, then,
round by round, of what is exactly or nearly best in the states that the policy itself comes to, in
larger cells too (Ross, Gordon and Bagnell 2011, "A Reduction of Imitation Learning and Structured
Prediction to No-Regret Online Learning"). The targets are all choices, each by how much it loses.

A run is kept in a folder after each round and goes on there, to the bit: every cell and every draw
follows from a number.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
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
from tandem.learn.graph.labels import Label, label, read, written
from tandem.learn.graph.network import Weights, fresh, lasting, nodes, scores
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.pool import DECISIONS, SIZES, Seen, batch
from tandem.learn.graph.weights import packed, unpacked

Leaves = dict[str, Any]


@dataclass(frozen=True)
class Config:
    """How the policy is trained.

    Attributes:
      first: cells of up to `small` tasks that are labelled before the first round; `first_steps` of
        the optimiser follow.
      rounds: each draws `drawn` new cells of up to `small` tasks and `drawn_large` of up to
        `most_tasks`, labels what the policy does there, and takes `steps` steps over all labels.
      exact: losses are exact where at most so many tasks are left.
      passed: tasks that the local search passes by for the schedule of a large cell.
      sharp: mean task times; a choice that loses so much counts 1/e of one that loses nothing.
      batch: cells a step; `rate` of Adam, half of it from the first round on; it falls to a
        fiftieth each time.
    """

    seed: int = 0
    first: int = 800
    small: int = 14
    first_steps: int = 1000
    rounds: int = 5
    drawn: int = 120
    drawn_large: int = 60
    most_tasks: int = 40
    exact: int = 14
    passed: int = 100_000
    steps: int = 500
    sharp: float = 0.05
    batch: int = 24
    rate: float = 4e-3


@dataclass(frozen=True)
class Told:
    """What is known after a round (0: before the policy labels)."""

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
    pool: list[list[Seen]]
    round: int = 0
    loss: float = float("nan")

    @classmethod
    def begun(cls, config: Config, folder: Path) -> _Run:
        """A run that has imitated the exact decisions."""
        rng = np.random.default_rng(config.seed)
        weights = packed(fresh(lambda shape: rng.uniform(-1, 1, shape).astype(np.float32)))
        run = cls(config, folder, weights, _adam().init(weights), _empty())
        run.add(label(None, at, config.small, config.exact, 0) for at in range(config.first))
        run.learn(config.first_steps)
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
        arrays = _loaded(folder / f"state-{kept['round']}.npz")
        weights = {name[2:]: arrays[name] for name in arrays if name.startswith("w/")}
        leaves, shape = jax.tree.flatten(_adam().init(weights))
        adam = jax.tree.unflatten(shape, [arrays[f"a/{at}"] for at in range(len(leaves))])
        run = cls(config, folder, weights, adam, _empty(), kept["round"], kept["loss"])
        for at in range(kept["round"] + 1):
            for one in read(_loaded(folder / f"labels-{at}.npz")):
                run.take(one, one.outlook())
        return run

    def go_on(self) -> None:
        """One round: the policy's own states, then steps over all labels."""
        config, weights = self.config, unpacked(self.weights)
        each = config.drawn + config.drawn_large
        begin = config.first + self.round * each
        self.round += 1
        self.add(
            label(
                weights,
                begin + at,
                config.small if at < config.drawn else config.most_tasks,
                config.exact,
                config.passed,
            )
            for at in range(each)
        )
        self.learn(config.steps)
        self.keep()

    def add(self, labels: Iterable[tuple[Label, Outlook] | None]) -> None:
        """Takes the labels of a round, and writes them down."""
        found = list[Label]()
        for one in labels:
            if one is not None:
                found.append(one[0])
                self.take(*one)
        _write(self.folder / f"labels-{self.round}.npz", written(found))

    def take(self, label: Label, outlook: Outlook) -> None:
        """Puts the label into the pool."""
        seen = Seen.of(label, outlook)
        self.pool[seen.size].append(seen)

    def learn(self, steps: int) -> None:
        """So many steps of the optimiser over the labels in hand."""
        config, losses = self.config, []
        rng = np.random.default_rng((config.seed, self.round))
        step = _step(config)
        rate = config.rate / (2 if self.round else 1)
        falls = optax.cosine_decay_schedule(rate, max(steps, 1), alpha=0.02)
        for at in range(steps):
            drawn = batch(self.pool, rng, config.batch)
            self.weights, self.adam, loss = step(self.weights, self.adam, drawn, falls(at))
            losses.append(float(loss))
        self.loss = float(np.mean(losses[-200:]))
        self.weights = {name: np.asarray(part) for name, part in self.weights.items()}

    def keep(self) -> None:
        """Writes the run into its folder."""
        leaves = jax.tree.leaves(self.adam)
        arrays = {f"w/{name}": part for name, part in self.weights.items()}
        arrays |= {f"a/{at}": np.asarray(part) for at, part in enumerate(leaves)}
        _write(self.folder / f"state-{self.round}.npz", arrays)
        document = {"config": asdict(self.config), "round": self.round, "loss": self.loss}
        store(self.folder / "run.json", json.dumps(document))

    def told(self) -> Told:
        """Where the run stands."""
        return Told(self.round, self.loss, sum(map(len, self.pool)))


def _empty() -> list[list[Seen]]:
    return [[] for _ in SIZES]


def _write(path: Path, arrays: dict[str, Any]) -> None:
    whole = path.with_suffix(".tmp.npz")
    np.savez(whole, **arrays)
    whole.replace(path)


def _loaded(path: Path) -> dict[str, Any]:
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def _adam() -> optax.GradientTransformation:
    return optax.chain(optax.clip_by_global_norm(1.0), optax.scale_by_adam())


@cache
def _step(config: Config) -> Any:
    adam = _adam()
    count = config.batch * DECISIONS

    @jax.jit
    def step(weights: Leaves, state: Any, drawn: Leaves, rate: float) -> Any:
        loss, gradient = jax.value_and_grad(_loss)(weights, drawn, count, config.sharp)
        change, state = adam.update(gradient, state, weights)
        moved = {name: part - rate * change[name] for name, part in weights.items()}
        return moved, state, loss

    return step


def _loss(leaves: Leaves, drawn: Leaves, count: int, sharp: float) -> Any:
    """Cross-entropy of the choices with what they should be drawn with, per decision."""
    weights = unpacked(leaves)

    def of_cell(cell: Leaves) -> Any:
        task, operator = nodes(
            jnp, weights, cell["tasks"], cell["operators"], cell["pairs"], cell["before"]
        )
        group = cell["step share"] @ operator
        return lasting(jnp, weights, task[cell["step task"]], group, cell["step fixed"])

    names = ("tasks", "operators", "pairs", "before", "step task", "step share", "step fixed")
    steps = jax.vmap(of_cell)({name: drawn[name] for name in names})
    logits = scores(jnp, weights, drawn["seen"], steps[drawn["cell"], drawn["row"]])
    wanted = jnp.exp(_log_softmax(-drawn["loss"] / sharp, drawn["decision"], count))
    likely = _log_softmax(logits, drawn["decision"], count)
    real = drawn["decision"] < count
    decisions = jnp.max(jnp.where(real, drawn["decision"], 0)) + 1
    return -jnp.where(real, wanted * likely, 0.0).sum() / decisions


def _log_softmax(values: Any, decision: Any, count: int) -> Any:
    """Over the choices of each decision; padding is one more."""
    most = jax.ops.segment_max(values, decision, count + 1, indices_are_sorted=True)
    shifted = values - jax.lax.stop_gradient(most)[decision]
    sums = jax.ops.segment_sum(jnp.exp(shifted), decision, count + 1, indices_are_sorted=True)
    return shifted - jnp.log(sums)[decision]
