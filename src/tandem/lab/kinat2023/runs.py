"""Trainings on the thesis's cell, one record a run: the thesis's own recipe in its variants, and
ours.

A record is plain data (see `record`). Records of long runs are kept one file each, written when the
run has ended, so that a batch that was stopped goes on where it was.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.kinat2023.recipe import (
    APPENDIX,
    STATION,
    THESIS,
    TOOLBOX,
    StationRecipe,
    varied,
)
from tandem.lab.records import kept_record

FACTORS = (0, 1, 5)
PUBLISHED = {0: (23, 17), 1: (23, 7), 5: (24, 3)}
"""Ergonomic factor -> (makespan, stress) in table 6-1."""

VARIANTS: dict[str, StationRecipe] = {
    "thesis": THESIS,
    "thesis, normalised advantages": varied(THESIS, normalise_advantages=True),
    "thesis, scaled observations": varied(THESIS, sees="scaled"),
    "thesis, rewards of table 5-2": varied(THESIS, rewards="table_5_2"),
    "thesis, toolbox defaults": TOOLBOX,
}
"""The thesis's recipe as it is written, and with one thing otherwise each: its text and code leave
them open.
"""

FURTHER: dict[str, StationRecipe] = {
    "thesis, two stages of the appendix": APPENDIX,
    "thesis, bounds 3600 and 100": varied(THESIS, sees="bounded"),
}
"""Variants that run when they are asked for by name; the stored result has no row of them."""

OURS = "tandem"
LIMIT = 1400
UPDATES = 100
"""Of one call: so many are compiled into one loop."""
SAMPLED = 100
MOST_STEPS = 400_000
"""A run of the thesis's recipe is ended there and counted as it stands: agents that stall play 1400
steps an episode.
"""


def run_all(
    folder: Path, variants: Sequence[str], seeds: Iterable[int], factors: Sequence[int] = FACTORS
) -> Iterator[Path]:
    """Every run of the thesis's recipe that has no record in `folder` yet, seed by seed; yields
    each record's file.
    """
    for seed in seeds:
        for variant in variants:
            for factor in factors:
                file = (
                    folder / f"{variant.replace(', ', '_').replace(' ', '-')}_{factor}_{seed}.json"
                )
                kept_record(file, partial(run_thesis, variant, factor, seed))
                yield file


def run_thesis(
    variant: str,
    factor: float,
    seed: int,
    recipe: StationRecipe | None = None,
    most_steps: int = MOST_STEPS,
) -> dict[str, Any]:
    """The record of one training with the thesis's recipe (or `recipe`, by the name `variant`)."""
    import jax
    import numpy as np

    from tandem.lab.kinat2023.learn_env import StationWorld
    from tandem.learn.ppo import ppo

    recipe = recipe or (VARIANTS | FURTHER)[variant]
    world = StationWorld.of(thesis_cell(), recipe, stress_factor=factor)
    began = time.process_time()
    train_key, play_key = jax.random.split(jax.random.key(seed))
    updates = min(UPDATES, math.ceil(most_steps / recipe.config.horizon))
    learner, reports = _start(train_key, world, recipe.config), []
    while int(learner.stage) < len(recipe.config.stages) and int(learner.steps) < most_steps:
        learner, report = _advance(learner, world, recipe.config, updates)
        reports.append(jax.device_get(report))
    history = jax.tree.map(lambda *leaves: np.concatenate(leaves), *reports)
    cpu_s = time.process_time() - began
    assert isinstance(learner, ppo.Learner)
    return record(variant, factor, seed, recipe, learner, history, play_key, world, cpu_s)


def run_ours(
    seeds: Sequence[int], factors: Sequence[float] = FACTORS, recipe: StationRecipe = STATION
) -> list[dict[str, Any]]:
    """The records of our recipe for every factor and seed, all trained side by side (one
    `vmap`).
    """
    import jax
    import jax.numpy as jnp

    from tandem.lab.kinat2023.learn_env import StationWorld
    from tandem.learn.ppo import ppo

    cell, config = thesis_cell(), recipe.config
    began = time.process_time()
    wanted = [(factor, seed) for factor in factors for seed in seeds]
    worlds = [StationWorld.of(cell, recipe, stress_factor=factor) for factor, _ in wanted]
    together = jax.tree.map(lambda *leaves: jnp.stack(leaves), *worlds)
    keys = [jax.random.split(jax.random.key(seed)) for _, seed in wanted]
    updates = sum(
        math.ceil((stage.steps or 0) / (config.environments * config.horizon))
        for stage in config.stages
    )
    train = jax.jit(jax.vmap(partial(ppo.train, config=config, updates=updates)))
    learners, histories = jax.block_until_ready(
        train(jnp.stack([pair[0] for pair in keys]), together)
    )
    cpu_s = (time.process_time() - began) / len(wanted)
    records = []
    for index, (factor, seed) in enumerate(wanted):
        learner, history = jax.tree.map(
            lambda leaf, index=index: leaf[index], (learners, histories)
        )
        records.append(
            record(
                OURS,
                factor,
                seed,
                recipe,
                learner,
                jax.device_get(history),
                keys[index][1],
                worlds[index],
                cpu_s,
            )
        )
    return records


def record(
    variant: str,
    factor: float,
    seed: int,
    recipe: StationRecipe,
    learner: Any,
    history: Any,
    play_key: Any,
    world: Any,
    cpu_s: float,
) -> dict[str, Any]:
    """What a run was, in plain data.

    `greedy`: makespan and stress (None when it did not end within 1400 steps), rules broken,
    returns, the joint actions. `sampled`: of 100 episodes the share that ended, the mean makespan
    and stress of those, and how often each pair came. `best_of_n`: the pair of the sampled episode
    with the largest sum of returns. `curve`: per 30 episodes the mean return of robot and human,
    and the critics' value of the first state at their end. `every_episode`: where the agents learn
    after each, see `_every_episode`; else None.
    """
    import numpy as np

    plain, drawn = _play(learner, play_key, world, recipe.config)
    length = int(plain.length[0])
    done = np.asarray(drawn.done)
    pairs = list(
        zip(
            np.asarray(drawn.state.clock).tolist(),
            np.asarray(drawn.state.stress).tolist(),
            strict=True,
        )
    )
    returns = np.asarray(drawn.returns).sum(1)
    best = int(np.argmax(np.where(done, returns, -np.inf)))
    return {
        "variant": variant,
        "factor": factor,
        "seed": seed,
        "steps": int(learner.steps),
        "episodes": int(learner.episodes),
        "ended_early": int(learner.stage) < len(recipe.config.stages),
        "cpu_s": round(cpu_s, 2),
        "greedy": {
            "makespan": int(plain.state.clock[0]) if plain.done[0] else None,
            "stress": float(plain.state.stress[0]) if plain.done[0] else None,
            "illegal": int(np.sum(plain.illegal)),
            "returns": np.asarray(plain.returns[0]).tolist(),
            "actions": np.asarray(plain.actions[:length, 0]).tolist() if plain.done[0] else [],
        },
        "sampled": {
            "episodes": len(pairs),
            "done": float(done.mean()),
            "makespan": float(np.mean([p[0] for p, d in zip(pairs, done, strict=True) if d]))
            if done.any()
            else None,
            "stress": float(np.mean([p[1] for p, d in zip(pairs, done, strict=True) if d]))
            if done.any()
            else None,
            "pairs": _counted(p for p, d in zip(pairs, done, strict=True) if d),
        },
        "best_of_n": {"makespan": int(pairs[best][0]), "stress": pairs[best][1]}
        if done.any()
        else None,
        "curve": _curve(history),
        "every_episode": _every_episode(history) if recipe.config.stop_at_end else None,
    }


def _counted(pairs: Iterable[tuple[int, float]]) -> list[list[float]]:
    """`[[makespan, stress, how often], ...]`, the most frequent first."""
    counts: dict[tuple[int, float], int] = {}
    for pair in pairs:
        counts[pair] = counts.get(pair, 0) + 1
    return [[*pair, number] for pair, number in sorted(counts.items(), key=lambda item: -item[1])]


def _curve(history: Any, window: int = 30) -> Mapping[str, list[Any]]:
    import numpy as np

    ended = np.asarray(history.episodes)
    total = np.cumsum(ended)
    curve: dict[str, list[Any]] = {"episodes": [], "steps": [], "returns": [], "first_value": []}
    since, weighted, count = 0, np.zeros(history.returns.shape[1]), 0.0
    for index in range(len(ended)):
        weighted, count = weighted + history.returns[index] * ended[index], count + ended[index]
        if count and total[index] - since >= window:
            curve["episodes"].append(int(total[index]))
            curve["steps"].append(int(history.steps[index]))
            curve["returns"].append(np.round(weighted / count, 1).tolist())
            curve["first_value"].append(
                np.round(np.asarray(history.first_value[index]), 1).tolist()
            )
            since, weighted, count = int(total[index]), weighted * 0, 0.0
    return curve


def _every_episode(history: Any) -> dict[str, list[Any]]:
    """Per episode what robot and human were paid (`returns`) and what their critics thought the
    first state worth before it (`first_value`; of the first episode, after it), in whole numbers.
    """
    import numpy as np

    ended = np.flatnonzero(np.asarray(history.episodes))
    before = np.maximum(ended - 1, 0)
    return {
        "returns": np.rint(np.asarray(history.returns)[ended]).astype(int).tolist(),
        "first_value": np.rint(np.asarray(history.first_value)[before]).astype(int).tolist(),
    }


# --- Compiled once, for every factor and seed ---


def _start(key: Any, world: Any, config: Any) -> Any:
    import jax

    from tandem.learn.ppo import ppo

    return jax.jit(ppo.start, static_argnames="config")(key, world, config)


def _advance(learner: Any, world: Any, config: Any, updates: int) -> Any:
    import jax

    from tandem.learn.ppo import ppo

    return jax.jit(ppo.advance, static_argnames=("config", "updates"))(
        learner, world, config, updates
    )


def _play(learner: Any, key: Any, world: Any, config: Any) -> Any:
    import jax

    from tandem.learn.ppo import play

    plain = jax.jit(play.greedy, static_argnames=("config", "limit"))(
        learner.parameters, world, config, LIMIT
    )
    drawn = jax.jit(play.sampled, static_argnames=("config", "limit", "episodes"))(
        key, learner.parameters, world, config, LIMIT, SAMPLED
    )
    return jax.device_get((plain, drawn))
