"""Training the policy for any cell by imitation: first of decisions on nearly optimal ways, then,
round by round, of what is exactly or nearly best in the states that the policy itself comes to
(Ross, Gordon and Bagnell 2011, "A Reduction of Imitation Learning and Structured
Prediction to No-Regret Online Learning"). The targets are all choices, each by how much it loses;
what the policy loses in the mean counts too (Sun et al. 2017, "Deeply AggreVaTeD: Differentiable
Imitation Learning for Sequential Prediction").

A run is kept in a folder after each round and goes on there, to the bit: every cell and every draw
follows from a number.
"""

from __future__ import annotations

import json
import multiprocessing
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from functools import cache, partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax

from tandem.errors import UsageError
from tandem.files.atomic import store
from tandem.learn.graph.candidates import ABOUT
from tandem.learn.graph.labels import Label, Looks, read, written
from tandem.learn.graph.network import Weights, ahead, crowd, fresh, lasting, nodes, scores
from tandem.learn.graph.pool import DECISIONS, SIZES, Seen, batch, labelled
from tandem.learn.graph.weights import packed, unpacked

Leaves = dict[str, Any]
APART = 1_000_000
"""So many numbers lie between the cells of one seed and those of the next."""


@dataclass(frozen=True)
class Config:
    """How the policy is trained.

    Attributes:
      first, first_large: cells of up to `small` and of up to `most_tasks` tasks that are labelled
        before the first round, on nearly optimal ways; `first_steps` of the optimiser follow.
      rounds: each draws `drawn` and `drawn_large` new cells, labels what the policy does there, and
        takes `steps` steps over all labels.
      looks: how well labels are looked up.
      sharp: mean task times; a choice that loses so much counts 1/e of one that loses nothing. A
        negative number lets one of the best alone be right.
      regret: what a mean task time that the policy loses, drawn as it is, counts beside the
        cross-entropy in nats.
      batch: cells a step; `rate` of Adam, half of it from the first round on; it falls to a
        fiftieth each time.
      blind: numbers of features of a choice that the network does not see.
      crowd: whether it sees how the operators stand once a choice is placed, and what is left to
        them.
    """

    seed: int = 0
    first: int = 3000
    first_large: int = 1500
    small: int = 14
    most_tasks: int = 60
    first_steps: int = 1500
    rounds: int = 1
    drawn: int = 13000
    drawn_large: int = 4500
    steps: int = 15000
    looks: Looks = field(default_factory=Looks)
    sharp: float = 0.04
    regret: float = 5.0
    batch: int = 24
    rate: float = 4e-3
    blind: tuple[int, ...] = ()
    crowd: bool = True


@dataclass(frozen=True)
class Told:
    """What is known after a round (0: before the policy labels)."""

    round: int
    loss: float
    labels: int


def train(
    config: Config, folder: Path, on_round: Callable[[Told], None], workers: int = 1
) -> Weights:
    """The weights after the last round, in NumPy. `folder` keeps the run; where it holds one of the
    same configuration, that goes on. Labels are looked up by so many processes, which changes
    nothing of them.

    Raises UsageError when it holds another one.
    """
    folder.mkdir(parents=True, exist_ok=True)
    run = _Run.resumed(config, folder, workers)
    if run is None:
        run = _Run.begun(config, folder, workers)
        on_round(run.told())
    while run.round < config.rounds:
        run.go_on()
        on_round(run.told())
    return unpacked(run.weights)


Each = Callable[[Callable[[int, int], Seen | None], Iterable[int], Iterable[int]], Iterator[Any]]
"""`map` over numbers and sizes of cells."""


@contextmanager
def labelling(workers: int) -> Iterator[Each]:
    """`map` in this process, or in so many of their own."""
    if workers == 1:
        yield map
        return
    with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
        yield partial(pool.map, chunksize=4)


@dataclass
class _Run:
    config: Config
    folder: Path
    workers: int
    weights: Leaves
    adam: Any
    pool: list[list[Seen]]
    round: int = 0
    loss: float = float("nan")

    @classmethod
    def begun(cls, config: Config, folder: Path, workers: int) -> _Run:
        """A run that has imitated decisions on nearly optimal ways."""
        weights = untrained(config.seed)
        # a weight that starts at 0 under an input of 0 stays there
        weights["choice/0/weight"][list(config.blind)] = 0.0
        if not config.crowd:
            weights["operators/0/weight"][:ABOUT] = 0.0
            weights["ahead/1/weight"][:] = 0.0
        run = cls(config, folder, workers, weights, adam().init(weights), _empty())
        known = unpacked(run.weights) if config.looks.own else None
        run.add(known, 0, config.first, config.first_large)
        run.learn(config.first_steps)
        run.keep()
        return run

    @classmethod
    def resumed(cls, config: Config, folder: Path, workers: int) -> _Run | None:
        """The run in the folder; None where there is none."""
        kept = kept_run(folder, config)
        if kept is None:
            return None
        weights, state = kept_state(folder / f"state-{kept['round']}.npz")
        run = cls(config, folder, workers, weights, state, _empty(), kept["round"], kept["loss"])
        for at in range(kept["round"] + 1):
            for one in read(_loaded(folder / f"labels-{at}.npz")):
                run.take(Seen.of(one, one.outlook()))
        return run

    def go_on(self) -> None:
        """One round: the policy's own states, then steps over all labels."""
        config, weights = self.config, unpacked(self.weights)
        begin = config.first + config.first_large
        begin += self.round * (config.drawn + config.drawn_large)
        self.round += 1
        self.add(weights, begin, config.drawn, config.drawn_large)
        self.learn(config.steps)
        self.keep()

    def add(self, weights: Weights | None, begin: int, small: int, large: int) -> None:
        """Labels so many cells from number `begin` on, and writes that down."""
        config, found = self.config, list[Label]()
        begin += config.seed * APART
        sizes = [config.small] * small + [config.most_tasks] * large
        look = partial(labelled, weights, config.looks)
        with labelling(self.workers) as each:
            for one in each(look, range(begin, begin + len(sizes)), sizes):
                if one is not None:
                    found.append(one.label)
                    self.take(one)
        _write(self.folder / f"labels-{self.round}.npz", written(found))

    def take(self, seen: Seen) -> None:
        """Puts the labelled cell into the pool."""
        self.pool[seen.size].append(seen)

    def learn(self, steps: int) -> None:
        """So many steps of the optimiser over the labels in hand."""
        config, losses = self.config, []
        rng = np.random.default_rng((config.seed, self.round))
        step = _step(config.batch, config.sharp, config.regret)
        rate = config.rate / (2 if self.round else 1)
        falls = optax.cosine_decay_schedule(rate, max(steps, 1), alpha=0.02)
        for at in range(steps):
            drawn = batch(self.pool, rng, config.batch)
            drawn["seen"][:, list(config.blind)] = 0.0
            if not config.crowd:
                drawn["about"][:] = drawn["unplaced"][:] = 0.0
            self.weights, self.adam, loss = step(self.weights, self.adam, drawn, falls(at))
            losses.append(float(loss))
        self.loss = float(np.mean(losses[-200:]))
        self.weights = {name: np.asarray(part) for name, part in self.weights.items()}

    def keep(self) -> None:
        """Writes the run into its folder."""
        keep_state(self.folder / f"state-{self.round}.npz", self.weights, self.adam)
        document = {"config": asdict(self.config), "round": self.round, "loss": self.loss}
        store(self.folder / "run.json", json.dumps(document))

    def told(self) -> Told:
        """Where the run stands."""
        return Told(self.round, self.loss, sum(map(len, self.pool)))


def _empty() -> list[list[Seen]]:
    return [[] for _ in SIZES]


def untrained(seed: int) -> Leaves:
    """The weights that a training with this seed begins with; they prefer nothing."""
    rng = np.random.default_rng(seed)
    return packed(fresh(lambda shape: rng.uniform(-1, 1, shape).astype(np.float32)))


def kept_run(folder: Path, config: Any) -> dict[str, Any] | None:
    """What `run.json` says of the run in the folder; None where there is none.

    Args:
      config: a dataclass, what was asked.

    Raises UsageError when the folder holds a run of another configuration.
    """
    if not (folder / "run.json").exists():
        return None
    kept: dict[str, Any] = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    if kept["config"] != json.loads(json.dumps(asdict(config))):
        raise UsageError(f"{folder}: holds a run of another configuration; name another folder.")
    return kept


def keep_state(path: Path, weights: Leaves, state: Any) -> None:
    """One file with the weights and the optimiser's state."""
    arrays = {f"w/{name}": part for name, part in weights.items()}
    arrays |= {f"a/{at}": np.asarray(part) for at, part in enumerate(jax.tree.leaves(state))}
    _write(path, arrays)


def kept_state(path: Path) -> tuple[Leaves, Any]:
    """The inverse of `keep_state`."""
    arrays = _loaded(path)
    weights = {name[2:]: arrays[name] for name in arrays if name.startswith("w/")}
    leaves, shape = jax.tree.flatten(adam().init(weights))
    return weights, jax.tree.unflatten(shape, [arrays[f"a/{at}"] for at in range(len(leaves))])


def _write(path: Path, arrays: dict[str, Any]) -> None:
    whole = path.with_suffix(".tmp.npz")
    np.savez(whole, **arrays)
    whole.replace(path)


def _loaded(path: Path) -> dict[str, Any]:
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def adam() -> optax.GradientTransformation:
    """The optimiser, but for its rate."""
    return optax.chain(optax.clip_by_global_norm(1.0), optax.scale_by_adam())


@cache
def _step(cells: int, sharp: float, regret: float) -> Any:
    return stepping(partial(_loss, count=cells * DECISIONS, sharp=sharp, regret=regret))


def stepping(loss_of: Callable[[Leaves, Leaves], Any]) -> Any:
    """A step of the optimiser, compiled: `(weights, state, drawn, rate)` to the next weights and
    state, and the loss of these weights on what was drawn (see `batch`).
    """
    optimiser = adam()

    @jax.jit
    def step(weights: Leaves, state: Any, drawn: Leaves, rate: float) -> Any:
        loss, gradient = jax.value_and_grad(loss_of)(weights, drawn)
        change, state = optimiser.update(gradient, state, weights)
        moved = {name: part - rate * change[name] for name, part in weights.items()}
        return moved, state, loss

    return step


def _loss(leaves: Leaves, drawn: Leaves, count: int, sharp: float, regret: float) -> Any:
    """Cross-entropy of the choices with what they should be drawn with, and what is lost by those
    that are drawn, in the mean: a policy too small to tell all choices apart learns that of two
    that it confuses the one that may cost more is to be left; per decision.
    """
    targets = wanted(drawn["loss"], drawn["decision"], count, sharp)
    chances = likely(leaves, drawn, count)
    lost = regret * drawn["loss"] * jnp.exp(chances)
    return per_decision(lost - targets * chances, drawn["decision"], count)


def likely(leaves: Leaves, drawn: Leaves, count: int) -> Any:
    """`[R]`: the logarithm of the chance that each choice has among those of its decision.

    Args:
      drawn: see `batch`, of `count` decisions at most.
    """
    weights = unpacked(leaves)

    def of_cell(cell: Leaves) -> Any:
        task, operator = nodes(
            jnp, weights, cell["tasks"], cell["operators"], cell["pairs"], cell["before"]
        )
        of_pairs, own, share = ahead(jnp, weights, task, operator, cell["pairs"])
        count = jnp.maximum(cell["unplaced"].sum(-1), 1)[:, None, None]
        own = own[None] + jnp.einsum("dn,noc->doc", cell["unplaced"], of_pairs) / count
        return task, cell["step share"] @ operator, own, share

    names = ("tasks", "operators", "pairs", "before", "step share", "unplaced")
    task, group, stand, share = jax.vmap(of_cell)({name: drawn[name] for name in names})
    # of the steps only those that are choices here
    at = drawn["cell"], drawn["row"]
    own = task[drawn["cell"], drawn["step task"][at]]
    steps = lasting(jnp, weights, own, group[at], drawn["step fixed"][at])
    stand = stand[drawn["cell"], drawn["turn"]]
    steps += crowd(jnp, weights, stand, drawn["about"], share[drawn["cell"]])
    logits = scores(jnp, weights, drawn["seen"], steps)
    return _log_softmax(logits, drawn["decision"], count)


def per_decision(values: Any, decision: Any, count: int) -> Any:
    """The sum of `[R]` values over all choices, padding left out, divided by the decisions."""
    real = decision < count
    decisions = jnp.max(jnp.where(real, decision, 0)) + 1
    return jnp.where(real, values, 0.0).sum() / decisions


def wanted(losses: Any, decision: Any, count: int, sharp: float) -> Any:
    """What each choice should be drawn with."""
    if sharp > 0:
        return jnp.exp(_log_softmax(-losses / sharp, decision, count))
    # the first of the best
    numbers = jnp.arange(len(losses))
    least = jax.ops.segment_min(losses, decision, count + 1, indices_are_sorted=True)
    numbers = jnp.where(losses <= least[decision], numbers, len(losses))
    first = jax.ops.segment_min(numbers, decision, count + 1, indices_are_sorted=True)
    return (numbers == first[decision]).astype(losses.dtype)


def _log_softmax(values: Any, decision: Any, count: int) -> Any:
    """Over the choices of each decision; padding is one more."""
    most = jax.ops.segment_max(values, decision, count + 1, indices_are_sorted=True)
    shifted = values - jax.lax.stop_gradient(most)[decision]
    sums = jax.ops.segment_sum(jnp.exp(shifted), decision, count + 1, indices_are_sorted=True)
    return shifted - jnp.log(sums)[decision]
