"""Trainings of the two agents of Zhang et al. (2022), and what their greedy policies do: alone,
beside a noisy human, after a change.

A record is plain data, one per training; see `run`. All trainings of a recipe run side by side.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from importlib import resources
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell
from tandem.files.load import load
from tandem.lab.zhang2022.ddpg_config import Config
from tandem.lab.zhang2022.setting import Setting, duo, setting
from tandem.lab.zhang2022.yardstick import best_of_rest, matching

if TYPE_CHECKING:
    from tandem.lab.zhang2022.learn_env import Played

Record = dict[str, Any]
Tell = Callable[[str], None]

DESCRIBED = Config()
"""ASSUMPTION throughout: the paper's numbers are not public. DDPG as Lillicrap et al. (2016) run it
(rates, discount, Ornstein-Uhlenbeck noise), two actors and a shared critic as Zhang et al. describe
them, three candidates an actor for the choice by Q-value.
"""

OURS = replace(
    DESCRIBED,
    ahead=4,
    discount=1.0,
    actors_learn="expected",
    candidates=5,
    actor_rate=1e-3,
    entropy=0.01,
    double=True,
    last_rate=0.1,
    noise_in_targets=True,
)
"""The same two actors and shared critic. Returns over four steps, no discount, actors that learn
from the critic's value of each candidate, five candidates, targets that do not choose for
themselves (double), rates that fall; where there is noise, it is in the critic's targets too.
"""

NOISE = 0.3
"""Spread of the noise on the human's scores, which lie in -1..1. ASSUMPTION."""

FACTORS = (1.0, 4.0)
"""What a unit of difficulty costs, in seconds. Each asks for another point of the front."""

STRAYS, SPREAD = 0.2, 0.3
"""The noisy human at play: one decision in five is not the one shown, and times vary by 30 %.
ASSUMPTION.
"""


CHANCES = 1000
"""Seed of the chances that all policies meet when they are judged; none of the trainings has it."""


@dataclass(frozen=True)
class Arm:
    """A way of training.

    Attributes:
      recipe: "as described" or "ours".
      noise: noise on the human's actor in training.
      changes: probability of a change in a training episode.
      factors: it is trained once for each.
    """

    recipe: str
    noise: bool
    changes: float = 0.0
    factors: tuple[float, ...] = FACTORS[:1]

    @property
    def name(self) -> str:
        """In words."""
        return f"{self.recipe}, {'with' if self.noise else 'without'} noise" + (
            ", with changes" if self.changes else ""
        )

    @property
    def config(self) -> Config:
        """Of the training, but for the noise."""
        return DESCRIBED if self.recipe == "as described" else OURS


ARMS = (
    Arm("as described", False),
    Arm("as described", True),
    Arm("ours", False, factors=FACTORS),
    Arm("ours", True),
    Arm("ours", False, 0.5),
)


@dataclass(frozen=True)
class Size:
    """How much of everything.

    Attributes:
      seeds: trainings an arm and factor. steps: of a training. noisy: episodes beside a noisy
        human, a training. changed: episodes with a change, a training. sampled: of those, how many
        are held against the re-planned optimum.
    """

    seeds: int = 10
    steps: int = 40_000
    noisy: int = 100
    changed: int = 100
    sampled: int = 10


QUICK = Size(seeds=1, steps=1600, noisy=20, changed=20, sampled=2)


def alternator() -> Cell:
    """The alternator-like cell: an ASSUMPTION, made for this."""
    with resources.as_file(resources.files("tandem.lab.zhang2022") / "alternator.yaml") as file:
        return load(file)


def run(
    cell: Cell, arms: Sequence[Arm], size: Size, front: Sequence[tuple[float, float]], tell: Tell
) -> list[Record]:
    """The records of these arms, all of one recipe; they are trained side by side.

    `greedy`: makespan, difficulty, fatigue at the end, cost, `gap` of the cost to the matching
    point's, `beyond`, the least share by which both makespan and difficulty lie above some point of
    the front, and what was done. `noisy`: mean makespan, difficulty and cost, and deviations,
    beside a human who strays. `changed`: of the episodes with a change those that were finished,
    how often each kind came, and `losses`, for a sample of them how much more the rest cost than
    the re-planned optimum of it, as a share. `curve`: mean cost of training episodes.
    """
    wanted = [
        (arm, factor, seed) for arm in arms for factor in arm.factors for seed in range(size.seeds)
    ]
    config = replace(arms[0].config, steps=size.steps)
    networks, reports, cpu_s = train(cell, config, wanted)
    tell(f"{arms[0].recipe}: {len(wanted)} trainings, {cpu_s:.1f} CPU s each")
    judged = judge(cell, networks, config, [factor for _, factor, _ in wanted], size)
    rows: list[Record] = []
    for index, (arm, factor, seed) in enumerate(wanted):
        about = {
            "arm": arm.name,
            "recipe": arm.recipe,
            "noise": arm.noise,
            "changes": arm.changes,
            "factor": factor,
            "seed": seed,
        }
        found = measures(cell, _part(judged, index), factor, size, front)
        rows.append(
            {
                **about,
                "steps": size.steps,
                "cpu_s": round(cpu_s, 2),
                **found,
                "curve": _curve(_part(reports, index), config),
            }
        )
        tell(f"{arm.name}, factor {factor:g}, seed {seed}: gap {rows[-1]['greedy']['gap']:.2%}")
    return rows


def train(
    cell: Cell, config: Config, wanted: Sequence[tuple[Arm, float, int]]
) -> tuple[Any, Any, float]:
    """Networks and reports (leading axis: arm, factor, seed as wanted), and CPU seconds a training,
    compiling included.
    """
    import jax
    import jax.numpy as jnp

    from tandem.lab.zhang2022 import ddpg
    from tandem.lab.zhang2022.learn_env import DuoWorld

    began = time.process_time()
    data = DuoWorld.of(cell, setting()).duo
    settings = _stacked(
        [setting(difficulty=factor, change=arm.changes) for arm, factor, _ in wanted]
    )
    keys = jnp.stack([jax.random.key(seed) for _, _, seed in wanted])
    noise = jnp.array([NOISE * arm.noise for arm, _, _ in wanted])
    one = lambda key, setting, noise: ddpg.train(key, DuoWorld(data, setting), config, noise)  # noqa: E731
    learners, reports = jax.block_until_ready(jax.jit(jax.vmap(one))(keys, settings, noise))
    return learners.networks, jax.device_get(reports), (time.process_time() - began) / len(wanted)


def judge(
    cell: Cell, networks: Any, config: Config, factors: Sequence[float], size: Size, calm: int = 1
) -> Played:
    """How each of the networks plays, a row a network: `calm` plain episodes, then those beside a
    noisy human, then those with a change.

    All meet the same chances. With `networks` None a random player, a row a factor.
    """
    import jax
    import jax.numpy as jnp

    from tandem.lab.zhang2022.learn_env import DuoWorld, play

    data = DuoWorld.of(cell, setting()).duo
    kinds = [
        ({}, 0.0, calm),
        ({"spread": SPREAD}, STRAYS, size.noisy),
        ({"change": 1.0}, 0.0, size.changed),
    ]
    deviates = jnp.concatenate([jnp.full(episodes, strays) for _, strays, episodes in kinds])
    rows = [
        _stacked(
            [
                setting(difficulty=factor, **numbers)
                for numbers, _, episodes in kinds
                for _ in range(episodes)
            ]
        )
        for factor in factors
    ]

    def one(networks: Any, settings: Setting) -> Any:
        return play(
            jax.random.key(CHANCES),
            networks,
            data,
            settings,
            deviates,
            config.candidates,
            config.activation,
            4 * len(cell.tasks),
        )

    return jax.device_get(
        jax.jit(lambda networks, settings: jax.lax.map(lambda it: one(*it), (networks, settings)))(
            networks, _stacked(rows)
        )
    )


def split(played: Played, size: Size, calm: int = 1) -> tuple[Played, Played, Played]:
    """A network's episodes: the plain ones, those beside a noisy human, those with a change."""
    import jax

    def between(a: int, b: int) -> Played:
        cut: Played = jax.tree.map(
            lambda leaf: leaf[a:b], played._replace(action=None, shown=None, clock=None)
        )
        return cut._replace(
            **{name: getattr(played, name)[:, a:b] for name in ("action", "shown", "clock")}
        )

    return (
        between(0, calm),
        between(calm, calm + size.noisy),
        between(calm + size.noisy, calm + size.noisy + size.changed),
    )


def measures(
    cell: Cell, played: Played, factor: float, size: Size, front: Sequence[tuple[float, float]]
) -> dict[str, Any]:
    """`greedy`, `noisy` and `changed` of a record; see `run`."""
    best = matching(list(front), 1.0, factor)
    optimum = best[0] + factor * best[1]
    plain, noisy, changed = split(played, size)
    makespan, difficulty = (
        round(float(plain.paid.seconds[0]), 3),
        float(plain.paid.difficulty[0].sum()),
    )
    found = noisy.paid.seconds + factor * noisy.paid.difficulty.sum(-1)
    return {
        "greedy": {
            "finished": bool(plain.done[0]),
            "makespan": makespan,
            "difficulty": difficulty,
            "fatigue": round(float(plain.state.fatigue[0]), 4),
            "cost": round(makespan + factor * difficulty, 3),
            "gap": round((makespan + factor * difficulty) / optimum - 1, 6),
            "beyond": round(
                min(max(makespan / t, difficulty / d if d else 1.0) for t, d in front) - 1, 6
            ),
            "action": plain.action[: int(plain.steps[0]), 0].tolist(),
        },
        "noisy": {
            "episodes": len(found),
            "finished": float(noisy.done.mean()),
            "makespan": round(float(noisy.paid.seconds.mean()), 3),
            "difficulty": round(float(noisy.paid.difficulty.sum(-1).mean()), 3),
            "cost": round(float(found.mean()), 3),
            "deviations": round(float(noisy.deviations.mean()), 3),
        },
        "changed": {
            "episodes": len(changed.done),
            "finished": int(changed.done.sum()),
            "kinds": [int((changed.state.happened.kind == kind).sum()) for kind in range(4)],
            "cost": round(
                float((changed.paid.seconds + factor * changed.paid.difficulty.sum(-1)).mean()), 3
            ),
            "losses": losses(cell, changed, factor, size.sampled),
            "example": example(changed),
        },
    }


def example(changed: Played) -> dict[str, Any]:
    """The first episode in which something happened (the first at all, if nothing ever did): what
    was done, and the change in plain numbers.
    """
    index = int((changed.state.happened.kind > 0).argmax())
    change = [float(leaf[index]) for leaf in changed.state.change]
    return {
        "action": changed.action[: int(changed.steps[index]), index].tolist(),
        "change": [int(change[0]), *change[1:]],
    }


def random_player(cell: Cell, factors: Sequence[float], size: Size) -> list[dict[str, float]]:
    """Means of a player that takes any legal pair, a row a factor: alone, beside the noisy human,
    and after a change.
    """
    found, rows = judge(cell, None, OURS, factors, size, calm=size.changed), []
    for index, factor in enumerate(factors):
        plain, noisy, changed = split(_part(found, index), size, calm=size.changed)
        costs = {
            name: one.paid.seconds + factor * one.paid.difficulty.sum(-1)
            for name, one in (("plain", plain), ("noisy", noisy), ("changed", changed))
        }
        rows.append(
            {
                "makespan": round(float(plain.paid.seconds.mean()), 3),
                "difficulty": round(float(plain.paid.difficulty.sum(-1).mean()), 3),
                "cost": round(float(costs["plain"].mean()), 3),
                "noisy_cost": round(float(costs["noisy"].mean()), 3),
                "changed_cost": round(float(costs["changed"].mean()), 3),
                "changed_finished": int(changed.done.sum()),
                "changed_episodes": len(changed.done),
            }
        )
    return rows


def losses(cell: Cell, changed: Played, factor: float, number: int) -> list[float]:
    """Of the first so many episodes in which something changed: what the rest cost above the
    re-planned optimum of it, as a share.

    Rests whose optimum was not proven in time are left out.
    """
    names, found = duo(cell)[1], []
    for index in [index for index, kind in enumerate(changed.state.happened.kind) if kind > 0][
        :number
    ]:
        state, before, paid = _part((changed.changed, changed.before, changed.paid), index)
        optimum = best_of_rest(cell, names, state.assembly, state.happened, 1.0, factor)
        rest = float(paid.seconds - before.seconds) + factor * float(
            paid.difficulty.sum() - before.difficulty.sum()
        )
        if optimum:
            found.append(round(rest / optimum - 1, 5))
    return found


def _part(tree: Any, index: int) -> Any:
    import jax

    return jax.tree.map(lambda leaf: leaf[index], tree)


def _stacked(settings: Sequence[Setting]) -> Setting:
    import jax
    import jax.numpy as jnp

    return jax.tree.map(lambda *leaves: jnp.stack(leaves), *settings)


def _curve(reports: Any, config: Config, points: int = 24) -> dict[str, list[float]]:
    """`steps` and the mean `cost` of the episodes that ended until then, since the point before."""
    import numpy as np

    edges = np.linspace(0, config.rounds, min(points, config.rounds) + 1).astype(int)
    curve: dict[str, list[float]] = {"steps": [], "cost": []}
    for a, b in pairwise(edges):
        ended = float(np.sum(reports.episodes[a:b]))
        if ended:
            curve["steps"].append(int(b) * config.environments)
            curve["cost"].append(round(-10.0 * float(np.sum(reports.returns[a:b])) / ended, 2))
    return curve
