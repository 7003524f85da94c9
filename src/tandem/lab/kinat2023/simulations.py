"""Two trained agents on the thesis's station, each from a file of its own; of several simulations
the shortest; and what was seen, done and paid in every step.

Source: Kinat (2023), appendix: the agents of two files are simulated a number of times, drawing
their actions, and the shortest simulation is the schedule.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.files.atomic import store
from tandem.lab.kinat2023.episode import Episode, Experience, play, seconds
from tandem.lab.kinat2023.players import chooser, played, policy_of_the_station
from tandem.lab.kinat2023.recipe import StationRecipe
from tandem.lab.kinat2023.rewards import reward_set
from tandem.lab.kinat2023.station import whole_ticks
from tandem.lab.kinat2023.world import HUMAN, ROBOT
from tandem.learn.algorithm import TrainingOrder
from tandem.learn.policy import Policy
from tandem.learn.results import Reached

MUST_AGREE = ("pace", "sees")
"""What two files must say alike of how their agents play."""


def agents_of(robot: Path, human: Path, cell: Cell) -> Policy:
    """The robot of one file beside the human of another, as one policy for the cell.

    Raises:
      CellError: a file is no policy of the thesis's station, or does not fit the cell.
      UsageError: the two play in different ways, or have networks of different shapes.
    """
    first, second = (policy_of_the_station(path, cell) for path in (robot, human))
    differs = [
        f"{name} {first.notes[name]!r} and {second.notes[name]!r}"
        for name in MUST_AGREE
        if first.notes[name] != second.notes[name]
    ]
    differs += [
        f"{name} {getattr(first, name)!r} and {getattr(second, name)!r}"
        for name in ("activation", "masked", "shared")
        if getattr(first, name) != getattr(second, name)
    ]
    shapes = [
        [part["weight"].shape[-2:] for part in policy.actor.values()] for policy in (first, second)
    ]
    if shapes[0] != shapes[1]:
        differs.append(f"networks of {len(shapes[0])} and {len(shapes[1])} layers, or other widths")
    if differs:
        raise UsageError(
            f"{robot} and {human} cannot play together: they have {'; '.join(differs)}. Take agents"
            " that were trained by one recipe."
        )
    first, second = first.unshared(), second.unshared()
    actor = {
        layer: {
            part: np.stack([array[ROBOT], second.actor[layer][part][HUMAN]])
            for part, array in parts.items()
        }
        for layer, parts in first.actor.items()
    }
    return Policy(
        first.agents, actor, first.activation, first.masked, first.shared, dict(first.notes)
    )


def pair(
    robot: Path,
    human: Path,
    cell: Cell,
    order: TrainingOrder,
    *,
    seed: int,
    episodes: int,
    draws: bool,
) -> list[Reached]:
    """See `tandem.learn.algorithm.Pairs`."""
    assert isinstance(order.recipe, StationRecipe)
    policy, pace = agents_of(robot, human, cell), order.recipe.pace
    rewards = reward_set(order.recipe.rewards, stress_factor=order.stress_factor)
    generator = np.random.default_rng(seed) if draws else None
    choose = chooser(policy, pace, generator)
    # who draws nothing plays the same episode again and again
    return played(cell, rewards, choose, episodes if draws else 1, pace)


def simulations(
    cell: Cell, policy: Policy, number: int, *, seed: int = 0
) -> Iterator[tuple[Episode, list[Experience]]]:
    """So many plays with actions drawn from the agents, each with its experience, step by step.

    The rewards are those that the policy says it was trained for, without a penalty for idling.
    """
    scale, draws = whole_ticks(cell), np.random.default_rng(seed)
    rewards = reward_set(policy.notes["rewards"], stress_factor=policy.notes["stress_factor"])
    pace = policy.notes["pace"]
    for _ in range(number):
        seen: list[Experience] = []
        choose = chooser(policy, pace, draws)
        episode = play(
            cell,
            rewards,
            choose,
            by=pace,
            per_second=scale,
            limit=1400 * scale,
            watch=seen.append,
        )
        yield episode, seen


def shortest(episodes: Sequence[Episode]) -> int | None:
    """Which of them ended first, of equals the one of less stress; None when none came to its
    end.
    """
    ended = [(one.ticks, one.stress, place) for place, one in enumerate(episodes) if one.done]
    return min(ended)[-1] if ended else None


def write_log(file: Path, cell: Cell, logs: Sequence[Sequence[Experience]]) -> None:
    """A CSV with a row a step: what both agents saw of themselves, named, were paid, and broke."""
    scale, text = whole_ticks(cell), io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(COLUMNS)
    for number, log in enumerate(logs, 1):
        for step, one in enumerate(log, 1):
            rows.writerow([number, step, *_row(one, scale)])
    store(file, text.getvalue())


COLUMNS = [
    "simulation",
    "step",
    "clock_s",
    "doing_robot",
    "doing_human",
    "left_robot",
    "left_human",
    "action_robot",
    "action_human",
    "reward_robot",
    "reward_human",
    "illegal_robot",
    "illegal_human",
    "done",
]
"""Of the log. `doing`: number of the task in hand, 0 = none; `left`: ticks left of each task."""


def _row(one: Experience, scale: int) -> list[Any]:
    return [
        f"{seconds(int(one.before.clock), scale):g}",
        *map(int, one.before.doing),
        *(" ".join(map(str, np.asarray(left).tolist())) for left in one.before.time),
        *map(int, one.action),
        *(f"{float(paid):g}" for paid in one.reward),
        *map(int, one.illegal),
        int(one.done),
    ]
