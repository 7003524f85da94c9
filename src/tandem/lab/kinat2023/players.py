"""Trained agents that play on the thesis's station, in NumPy: no JAX is loaded for them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, get_args

import numpy as np
from pydantic import ConfigDict, Field

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.lab.kinat2023.decisions import after_human, choices
from tandem.lab.kinat2023.episode import Episode, play
from tandem.lab.kinat2023.recipe import OBSERVATIONS, Pace, StationRecipe
from tandem.lab.kinat2023.rewards import REWARDS, reward_set
from tandem.lab.kinat2023.station import station, whole_ticks
from tandem.lab.kinat2023.world import HUMAN, ROBOT, Rewards, State, Station, reset
from tandem.lab.kinat2023.world import legal as legal_now
from tandem.learn.algorithm import TrainingOrder
from tandem.learn.forms import Form, key_of, parsed, unreadable
from tandem.learn.policy import Policy
from tandem.learn.results import Reached

Choose = Callable[[Station, State], Any]


def costs(cell: Cell, order: TrainingOrder) -> dict[str, Any]:
    """What time and stress cost on the cell under the order's rewards, for `results.cost`."""
    assert isinstance(order.recipe, StationRecipe)
    rewards = reward_set(order.recipe.rewards, stress_factor=order.stress_factor)
    return {
        "step": float(rewards.step),
        "per_second": whole_ticks(cell),
        "stress_factor": float(rewards.stress_factor),
    }


def players(
    path: Path, cell: Cell, order: TrainingOrder, *, seed: int, episodes: int
) -> dict[str, list[Reached]]:
    """How the agents play the cell: the actions they think best, drawn ones, and the best of those.

    Raises:
      CellError: the station cannot hold the cell, or the file is no policy, or none of the run's
        own cell.
      UsageError: the cell has another number of tasks.
    """
    policy, notes = (
        policy_of_the_station(path, order.cell if cell == order.cell else None),
        order.recipe,
    )
    assert isinstance(notes, StationRecipe)
    rewards = reward_set(notes.rewards, stress_factor=order.stress_factor)
    draws = np.random.default_rng(seed)
    greedy = played(cell, rewards, chooser(policy, notes.pace), 1, notes.pace)
    sampled = played(cell, rewards, chooser(policy, notes.pace, draws), episodes, notes.pace)
    finished = [episode for episode in sampled if episode.done]
    best = [min(finished, key=lambda episode: episode.cost)] if finished else sampled[:1]
    return {"greedy": greedy, "sampled": sampled, f"best of {episodes}": best}


class _Played(Form):
    """What a policy must say of itself to be played on the thesis's station."""

    model_config = ConfigDict(frozen=True, strict=True, extra="allow", allow_inf_nan=False)

    pace: Annotated[str, key_of(get_args(Pace))]
    sees: Annotated[str, key_of(OBSERVATIONS)]
    rewards: Annotated[str, key_of(REWARDS)]
    stress_factor: float = Field(ge=0)


def policy_of_the_station(path: Path, cell: Cell | None) -> Policy:
    """The policy in a run's file; it is held against the run's own cell when that is given.

    Raises CellError when it is none, does not say how it is played, or is another size than the
    cell's.
    """
    policy = Policy.load(path)
    parsed(
        path, json.dumps(dict(policy.notes)), _Played, "is no policy of the thesis's station: notes"
    )
    if len(policy.agents) != len((ROBOT, HUMAN)):
        raise unreadable(
            path,
            [
                f"is no policy of the thesis's station: it has {len(policy.agents)} agents instead"
                " of 2."
            ],
        )
    if cell is not None:
        size = OBSERVATIONS[policy.notes["sees"]](
            laid := station(cell, per_second=whole_ticks(cell)), reset(laid)
        ).shape[1]
        if (policy.observation_size, policy.actions) != (size, len(cell.tasks) + 1):
            raise unreadable(
                path,
                [
                    f"does not fit the run's cell: it sees {policy.observation_size} numbers and"
                    f" chooses among {policy.actions} actions; {len(cell.tasks)} tasks have {size}"
                    f" to show and {len(cell.tasks) + 1} actions."
                ],
            )
    return policy


def chooser(policy: Policy, pace: str, generator: np.random.Generator | None = None) -> Choose:
    """The policy as `play` wants it: most probable actions, or drawn ones with a generator. By
    decisions the human names first.

    Raises UsageError when called for a station of another number of tasks than the policy was
    trained on.
    """
    observe = OBSERVATIONS[policy.notes["sees"]]
    sure = generator is None

    def choose(laid: Station, state: State) -> Any:
        seen = observe(laid, state)
        if seen.shape[1] != policy.observation_size:
            raise UsageError(
                f"the policy sees {policy.observation_size} numbers, this cell has {seen.shape[1]}"
                f" to show: it has {state.ended.shape[0]} tasks, and the policy was trained on"
                f" {policy.notes.get('cell') or 'a cell'} with another number."
            )
        if not policy.masked:
            return policy.predict(seen, deterministic=sure, generator=generator)[0]
        masks = np.array(choices(laid, state) if pace == "decisions" else legal_now(laid, state))
        human, _ = policy.predict(
            seen[HUMAN],
            action_masks=masks[HUMAN],
            deterministic=sure,
            agent=policy.agents[HUMAN],
            generator=generator,
        )
        if pace == "decisions":
            masks[ROBOT] = after_human(state, masks, np.asarray(human))
        robot, _ = policy.predict(
            seen[ROBOT],
            action_masks=masks[ROBOT],
            deterministic=sure,
            agent=policy.agents[ROBOT],
            generator=generator,
        )
        return np.array([robot, human])

    return choose


def played(cell: Cell, rewards: Rewards, choose: Choose, episodes: int, pace: str) -> list[Reached]:
    """Episodes on the thesis's station."""
    scale = whole_ticks(cell)
    found = [
        play(cell, rewards, choose, by=pace, per_second=scale, limit=1400 * scale)
        for _ in range(episodes)
    ]
    return [_reached(episode, scale) for episode in found]


def _reached(episode: Episode, per_second: int) -> Reached:
    makespan, stress = (
        (episode.ticks / per_second, episode.stress) if episode.done else (None, None)
    )
    return Reached(
        makespan, stress, episode.illegal, -float(sum(episode.returns)), episode.schedule
    )
