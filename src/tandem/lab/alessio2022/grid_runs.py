"""Trainings on the grid of Alessio et al. (2022), all seeds side by side, and what each robot is
worth against every kind of human.

A robot is judged by those it was not trained against: a random human, one that pursues a terminal
state, one that learned to spoil this very robot (its best response, trained against the frozen
robot), and the worst human there can be (exact, for the robot's greedy play).
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from tandem.lab.alessio2022 import exact, robots
from tandem.lab.alessio2022.adversarial import SHARE
from tandem.lab.alessio2022.layout import HUMAN_START, WRONG, Layout, random_layout
from tandem.learn.networks import Perceptron, forward
from tandem.learn.ppo.config import Config, Stage

Sees = Literal["published", "marked"]

MOST_MOVES = 2
"""Moves a square: no game on a grid whose paths close is longer."""


@dataclass(frozen=True)
class Training:
    """How the robot is trained.

    Attributes:
      beside: the human of the training: "random" moves, "pursuing" a terminal state drawn for each
        episode, or an "adversary" that learns.
      share: of the human's reward that is taken from the robot's.
      human: what the adversary is paid: "own" for reaching a wrong terminal state, or "hostile",
        minus the robot's reward.
      order: an adversary learns "together" with the robot, or "in turns".
      sees: what the agents observe. lawful: impossible moves cannot be chosen; else they are
        punished, as published.
    """

    beside: Literal["random", "pursuing", "adversary"]
    share: float = SHARE
    human: Literal["own", "hostile"] = "own"
    order: Literal["together", "in turns"] = "together"
    sees: Sees = "marked"
    lawful: bool = True


TRAININGS: dict[str, Training] = {
    "plain: random human": Training("random"),
    "plain: human with a random goal": Training("pursuing"),
    "adversarial, share 0 %": Training("adversary", share=0.0),
    "adversarial, share 10 %": Training("adversary"),
    "adversarial, share 100 %": Training("adversary", share=1.0),
    "adversarial, hostile human": Training("adversary", share=0.0, human="hostile"),
    "as described, plain: random human": Training("random", sees="published", lawful=False),
    "as described, adversarial, share 10 %": Training("adversary", sees="published", lawful=False),
}
"""Name -> training; `alessio2022.GRIDS` says which are run.

"As described" sees the published channels and punishes impossible moves; the rest is our recipe."""

PLAIN, ADVERSARIAL = "plain: random human", "adversarial, share 10 %"
DESCRIBED = ("as described, plain: random human", "as described, adversarial, share 10 %")


def config(updates: int) -> Config:
    """PPO for the grid: so many updates of 64 games x 32 moves; the last third with a low
    entropy.
    """
    early = max(2 * updates // 3, 1) * 2048
    stages = (
        Stage(steps=early, entropy=0.1, learning_rate=2e-3),
        Stage(steps=max(updates * 2048 - early, 2048), entropy=0.01, learning_rate=1e-3),
    )
    return Config(stages=stages, environments=64, horizon=32, minibatch=512, epochs=4)


def run(
    name: str, drawn: Layout, seeds: Sequence[int], *, updates: int, episodes: int = 200
) -> list[dict[str, Any]]:
    """One record a seed of `TRAININGS[name]` on that grid.

    A record: training, seed, `success` (share of `episodes` games, actions drawn) against "random",
    "random goal", "wrong goal" and the learned "adversary"; `greedy`, see `judged`; `cpu_s`, of
    robot and adversary.
    """
    import jax

    from tandem.lab.alessio2022 import training as compiled
    from tandem.lab.alessio2022.learn_env import GridWorld

    training, settings, began = TRAININGS[name], config(updates), time.process_time()
    world = GridWorld.of(drawn, sees=training.sees, lawful=training.lawful)
    train_keys, response_keys, *judge_keys = compiled.keys(seeds, 2 + len(compiled.HUMANS))
    others = compiled.others(drawn)
    actors = _train(train_keys, world, others, training, settings, updates)
    spoilers = compiled.best_response(response_keys, world, others, actors, settings, updates)
    limit = MOST_MOVES * len(drawn.text)
    rates = np.asarray(
        compiled.success(
            jax.numpy.stack(judge_keys), world, actors, others, spoilers, settings, limit, episodes
        )
    )
    cpu_s = (time.process_time() - began) / len(seeds)
    plain, records = jax.device_get(actors), []
    for index, seed in enumerate(seeds):
        actor = jax.tree.map(lambda leaf, index=index: np.asarray(leaf[index]), plain)
        records.append(
            {
                "training": name,
                "seed": seed,
                "success": {
                    human: round(float(rates[number, index]), 4)
                    for number, human in enumerate(compiled.HUMANS)
                },
                "greedy": judged(drawn, greedy_robot(drawn, actor, training, settings.activation)),
                "cpu_s": round(cpu_s, 2),
            }
        )
    return records


def judged(drawn: Layout, robot: exact.Decide) -> dict[str, Any]:
    """A robot that is sure of its moves, against three humans.

    `nominal`: moves of both until success against one that waits; `worst`: at the worst, exactly;
    None where it fails. `pursued`: the squares of the game against one that goes straight for the
    wrong terminal state nearest to it, and `barred`, whether the right one was reached in that.
    """
    start = drawn.squares(HUMAN_START)[0]
    nearest = min(
        drawn.squares(WRONG), key=lambda place: drawn.distances(place)[start] % len(drawn.text)
    )
    idle, reached = robots.game(drawn, robot, robots.waits)
    pursued, barred = robots.game(drawn, robot, robots.towards(drawn, nearest))
    worst = exact.worst_case(drawn, robot)
    return {
        "nominal": len(idle) - 1 if reached else None,
        "worst": worst.moves,
        "pursued": [list(pair) for pair in pursued],
        "barred": barred,
    }


def greedy_robot(
    drawn: Layout, actor: Perceptron, training: Training, activation: str
) -> exact.Decide:
    """The trained robot, always taking its most probable action, as the exact search follows it."""
    logits = lambda seen: forward(np, actor, seen, activation)  # noqa: E731
    return robots.greedy(drawn, logits, sees=training.sees, lawful=training.lawful)


def formulations(number: int, *, size: int = 5, first_seed: int = 0) -> dict[str, dict[str, int]]:
    """Why paths close here: on so many random grids, how often blocking pays, with closing paths
    and without.

    `winnable`: the best robot succeeds whatever the human does. `quickest_fails`: of these, the
    robot that goes its quickest way does not. The same grids serve both.
    """
    from tandem.lab.alessio2022 import tables, world

    counts = {
        way: {"drawn": number, "winnable": 0, "quickest_fails": 0}
        for way in ("closing paths", "open paths")
    }
    for seed in range(first_seed, first_seed + number):
        drawn = random_layout(seed, size=size, obstacles=0.25)
        closing, quick = exact.minimax(drawn), robots.quickest(drawn)
        if closing.success:
            counts["closing paths"]["winnable"] += 1
            counts["closing paths"]["quickest_fails"] += not exact.worst_case(drawn, quick).success
        opened = world.grid(drawn, closing=False, limit=12 * size)
        if tables.minimax(opened).success:
            counts["open paths"]["winnable"] += 1
            counts["open paths"]["quickest_fails"] += (
                tables.value(
                    opened, tables.following(tables.quickest(opened)), tables.worst
                ).success
                < 1
            )
    return counts


def cover(drawn: Layout, seeds: Sequence[int], *, updates: int) -> list[dict[str, Any]]:
    """The second variant: robot and human learn together to cover the grid, paid as MathWorks pays.
    A record a seed.

    `covered`: share of the free squares, mean of 32 games; `all_covered`: share of the games that
    cover all; `moves`, of both; `least`, below which nobody can cover them all: a new square with
    each move.
    """
    import jax

    from tandem.lab.alessio2022 import coverage
    from tandem.lab.alessio2022 import training as compiled
    from tandem.lab.alessio2022.learn_env import CoverageWorld
    from tandem.learn.ppo import play

    limit = 4 * len(drawn.text)
    world, settings = CoverageWorld.of(drawn, limit=limit), replace(config(updates), discount=0.99)
    train_keys, play_keys = compiled.keys(seeds, 2)
    robot, human = compiled.together(train_keys, world, settings, updates)
    actors = jax.tree.map(lambda *leaves: jax.numpy.stack(leaves, 1), robot, human)
    sampled = lambda key, actor: play.sampled(key, {"actor": actor}, world, settings, limit, 32)  # noqa: E731
    games = jax.jit(jax.vmap(sampled))(play_keys, actors)
    shares = np.asarray(
        jax.vmap(jax.vmap(lambda state: coverage.share(world.grid, state)))(games.state)
    )
    return [
        {
            "seed": seed,
            "covered": round(float(shares[index].mean()), 4),
            "all_covered": round(float((shares[index] >= 1).mean()), 4),
            "moves": round(float(games.length[index].mean()), 2),
            "least": len(drawn.text) - drawn.text.count("#") - 2,
        }
        for index, seed in enumerate(seeds)
    ]


def _train(
    keys: Any, world: Any, others: Any, training: Training, settings: Config, updates: int
) -> Any:
    """The robot's actor of each seed, leading axis the seeds."""
    from tandem.lab.alessio2022 import adversarial
    from tandem.lab.alessio2022 import training as compiled

    paid = (
        adversarial.hostile(world)
        if training.human == "hostile"
        else adversarial.reduced(world, training.share)
    )
    if training.beside == "adversary" and training.order == "together":
        return compiled.together(keys, paid, settings, updates)[0]
    if training.beside == "adversary":
        return compiled.in_turns(keys, paid, settings, updates, updates)[0]
    human = "random" if training.beside == "random" else "random goal"
    return compiled.against(
        keys, paid, others, compiled.nobody(keys, world, settings), human, settings, updates
    )
