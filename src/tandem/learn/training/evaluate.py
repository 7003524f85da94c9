"""Trained policies played beside the exact front, the best dispatch rule and a random player. PPO's play in NumPy: no JAX is loaded for them."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, get_args

import numpy as np
from pydantic import ConfigDict, Field

from tandem.cell.model import Cell, plain
from tandem.lab.kinat2023.decisions import after_human, choices
from tandem.lab.kinat2023.episode import Episode, play
from tandem.lab.kinat2023.rewards import REWARDS, reward_set
from tandem.lab.kinat2023.station import station, whole_ticks
from tandem.lab.kinat2023.world import HUMAN, ROBOT, Rewards, State, Station, reset
from tandem.lab.kinat2023.world import legal as legal_now
from tandem.errors import NothingFoundError, UsageError
from tandem.learn.forms import Form, key_of, parsed, unreadable
from tandem.learn.results import relative_gap
from tandem.learn.policy import Policy
from tandem.learn.results import Reached
from tandem.lab.kinat2023.recipe import OBSERVATIONS
from tandem.learn.training.recipes import Pace
from tandem.learn.training.runs import RunFolder, asked_cell
from tandem.plan.methods import plan
from tandem.plan.result import Front
from tandem.plan.rules import RULES
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule

Choose = Callable[[Station, State], Any]


@dataclass(frozen=True)
class Line:
    """One player in the table.

    Attributes:
      makespan, stress: seconds and stress; means with `episodes` above 1, None when no episode was finished.
      makespan_ci95, stress_ci95: half widths of the 95 % intervals of the means; None for a single episode.
      illegal: rules broken, mean per episode.
      gap: how far the weighted cost is above the least on the exact front, as a share.
      schedule: of a single finished episode that keeps to the cell; `faults` says why there is none.
    """

    player: str
    episodes: int
    done: float
    makespan: float | None
    stress: float | None
    makespan_ci95: float | None
    stress_ci95: float | None
    illegal: float
    gap: float | None
    schedule: Schedule | None = None
    faults: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        parts = {
            name: getattr(self, name)
            for name in ("player", "episodes", "done", "makespan", "stress", "makespan_ci95", "stress_ci95", "illegal", "gap")
        }
        return {**parts, "assignments": self.schedule.to_list() if self.schedule else None, "faults": list(self.faults)}


@dataclass(frozen=True)
class Evaluation:
    """A run's players on a cell, and the exact front that they are held against (None when the planner found none in time)."""

    cell: Cell
    front: Front | None
    lines: tuple[Line, ...]
    stress_factor: float
    seed: int

    def line(self, player: str) -> Line:
        """The line of that player. Raises KeyError."""
        return {line.player: line for line in self.lines}[player]

    def to_dict(self) -> dict[str, Any]:
        """The document of `tandem evaluate --json`."""
        front = self.front
        return {
            "schema_version": 1,
            "cell": self.cell.name,
            "cell_digest": self.cell.digest,
            "stress_factor": plain(self.stress_factor),
            "seed": self.seed,
            "exact_front": [] if front is None else [[plain(value) for value in point] for point in front.points],
            "exact_front_complete": front is not None and front.complete,
            "players": [line.to_dict() for line in self.lines],
        }


def evaluate(folder: str | Path, cell: Cell | None = None, *, seed: int | None = None, episodes: int = 100, front_limit: float = 30.0) -> Evaluation:
    """Plays one seed of a run: greedy, sampled, best of the sampled; and a random player and the dispatch rules beside it.

    Args:
      cell: another cell than the run's own; for PPO it needs as many tasks.
      seed: which policy; the run's first when absent. It also seeds the draws.
      episodes: of the sampled and the random player.
      front_limit: seconds for the exact front.

    Raises:
      CellError: the folder holds no run, or the algorithm cannot hold the cell.
      UsageError: no such seed, or the policy does not fit the cell.
    """
    run = RunFolder(Path(folder))
    asked = run.asked()
    if seed is None:
        seed = run.seeds[0] if run.seeds else asked.seeds[0]
    if seed not in run.seeds:
        raise UsageError(f"{folder}: has no policy of seed {seed}; there are {', '.join(map(str, run.seeds)) or 'none yet'}.")
    plays_on = cell or asked_cell(run, asked)
    if asked.algorithm != "ppo":
        return _judge_turns(run, plays_on, seed, episodes, front_limit)
    policy = _policy_of_the_station(run.policy(seed), None if cell else plays_on)
    return judge(policy, plays_on, seed=seed, episodes=episodes, front_limit=front_limit)


class _Played(Form):
    """What a policy must say of itself to be played on the thesis's station."""

    model_config = ConfigDict(frozen=True, strict=True, extra="allow", allow_inf_nan=False)

    pace: Annotated[str, key_of(get_args(Pace))]
    sees: Annotated[str, key_of(OBSERVATIONS)]
    rewards: Annotated[str, key_of(REWARDS)]
    stress_factor: float = Field(ge=0)


def _policy_of_the_station(path: Path, cell: Cell | None) -> Policy:
    """The policy in a run's file; it is held against the run's own cell when that is given.

    Raises CellError when it is none, does not say how it is played, or is another size than the cell's.
    """
    policy = Policy.load(path)
    parsed(path, json.dumps(dict(policy.notes)), _Played, "is no policy of the thesis's station: notes")
    if len(policy.agents) != len((ROBOT, HUMAN)):
        raise unreadable(path, [f"is no policy of the thesis's station: it has {len(policy.agents)} agents instead of 2."])
    if cell is not None:
        size = OBSERVATIONS[policy.notes["sees"]](laid := station(cell, per_second=whole_ticks(cell)), reset(laid)).shape[1]
        if (policy.observation_size, policy.actions) != (size, len(cell.tasks) + 1):
            raise unreadable(
                path,
                [
                    f"does not fit the run's cell: it sees {policy.observation_size} numbers and chooses among {policy.actions} actions; "
                    f"{len(cell.tasks)} tasks have {size} to show and {len(cell.tasks) + 1} actions."
                ],
            )
    return policy


def _judge_turns(run: RunFolder, cell: Cell, seed: int, episodes: int, front_limit: float) -> Evaluation:
    """`evaluate` for an algorithm that plays a game of turns: its own players, beside the rules and a random player of the same game."""
    from tandem.learn.training.algorithms import ALGORITHMS
    from tandem.learn.algorithm import Order
    from tandem.learn.rollout import at_random, paid

    order = Order.of(run)
    front, weights = _front(cell, front_limit), paid(order.stress_factor)
    found = dict(import_module(ALGORITHMS[order.recipe.algorithm]).players(run.policy(seed), cell, order, seed=seed, episodes=episodes))
    lines = [_line(cell, front, weights, player, reached) for player, reached in found.items()]
    rule = _best_rule(cell, front, weights)
    by_chance = _line(cell, front, weights, "random", at_random(cell, order, games=episodes, seed=seed))
    return Evaluation(cell, front, tuple(line for line in (*lines, rule, by_chance) if line), order.stress_factor, seed)


def judge(policy: Policy, cell: Cell, *, seed: int = 0, episodes: int = 100, front_limit: float = 30.0) -> Evaluation:
    """`evaluate` for a policy in hand."""
    notes = policy.notes
    rewards = reward_set(notes["rewards"], stress_factor=notes["stress_factor"])
    front = _front(cell, front_limit)
    scale = whole_ticks(cell)
    paid = {"step": float(rewards.step), "per_second": scale, "stress_factor": float(rewards.stress_factor)}
    draws = np.random.default_rng(seed)
    greedy = _episodes(cell, rewards, chooser(policy, notes["pace"]), 1, notes["pace"])
    sampled = _episodes(cell, rewards, chooser(policy, notes["pace"], draws), episodes, notes["pace"])
    by_chance = _episodes(cell, rewards, random_chooser(draws), episodes, "decisions")
    finished = [episode for episode in sampled if episode.done]
    best = [min(finished, key=lambda episode: episode.cost)] if finished else sampled[:1]
    players = {"greedy": greedy, "sampled": sampled, f"best of {episodes}": best}
    lines = [_line(cell, front, paid, player, reached) for player, reached in players.items()]
    lines += [line for line in (_best_rule(cell, front, paid), _line(cell, front, paid, "random", by_chance)) if line]
    return Evaluation(cell, front, tuple(lines), notes["stress_factor"], seed)


def chooser(policy: Policy, pace: str, generator: np.random.Generator | None = None) -> Choose:
    """The policy as `play` wants it: most probable actions, or drawn ones with a generator. By decisions the human names first.

    Raises UsageError when called for a station of another number of tasks than the policy was trained on.
    """
    observe = OBSERVATIONS[policy.notes["sees"]]
    sure = generator is None

    def choose(station: Station, state: State) -> Any:
        seen = observe(station, state)
        if seen.shape[1] != policy.observation_size:
            raise UsageError(
                f"the policy sees {policy.observation_size} numbers, this cell has {seen.shape[1]} to show: it has {state.ended.shape[0]} tasks, "
                f"and the policy was trained on {policy.notes.get('cell') or 'a cell'} with another number."
            )
        if not policy.masked:
            return policy.predict(seen, deterministic=sure, generator=generator)[0]
        masks = np.array(choices(station, state) if pace == "decisions" else legal_now(station, state))
        human, _ = policy.predict(seen[HUMAN], action_masks=masks[HUMAN], deterministic=sure, agent=policy.agents[HUMAN], generator=generator)
        if pace == "decisions":
            masks[ROBOT] = after_human(state, masks, np.asarray(human))
        robot, _ = policy.predict(seen[ROBOT], action_masks=masks[ROBOT], deterministic=sure, agent=policy.agents[ROBOT], generator=generator)
        return np.array([robot, human])

    return choose


def random_chooser(generator: np.random.Generator) -> Choose:
    """Any legal decision, each as likely as the others."""

    def choose(station: Station, state: State) -> Any:
        masks = np.array(choices(station, state))
        human = generator.choice(np.flatnonzero(masks[HUMAN]))
        return np.array([generator.choice(np.flatnonzero(after_human(state, masks, human))), human])

    return choose


def _line(cell: Cell, front: Front | None, paid: dict[str, Any], player: str, episodes: Sequence[Reached]) -> Line:
    ended = [(episode.makespan, episode.stress) for episode in episodes if episode.makespan is not None and episode.stress is not None]
    makespan, makespan_ci = _mean([makespan for makespan, _ in ended])
    stress, stress_ci = _mean([stress for _, stress in ended])
    alone = episodes[0].schedule if len(episodes) == 1 else None
    wrong = faults(cell, alone) if alone else []
    return Line(
        player,
        len(episodes),
        len(ended) / len(episodes),
        makespan,
        stress,
        makespan_ci,
        stress_ci,
        float(np.mean([episode.illegal for episode in episodes])),
        relative_gap(front, makespan, stress, **paid),
        alone if ended and not wrong else None,
        tuple(wrong),
    )


def _best_rule(cell: Cell, front: Front | None, paid: dict[str, Any]) -> Line | None:
    """The dispatch rule whose best schedule costs least under these rewards; the random rules are no rules."""
    found = []
    for name in RULES:
        if name in ("random", "best-of-n"):
            continue
        try:
            for result in plan(cell, method=name, seed=0):
                gap = relative_gap(front, result.makespan, result.stress, **paid)
                found.append((gap, result.makespan, result.stress, name, result.schedule))
        except NothingFoundError:
            continue
    if not found:
        return None
    gap, makespan, stress, name, schedule = min(found, key=lambda item: (item[0] if item[0] is not None else item[1], item[3]))
    return Line(f"rule {name}", 1, 1.0, plain(makespan), plain(stress), None, None, 0.0, gap, schedule)


def _episodes(cell: Cell, rewards: Rewards, choose: Choose, episodes: int, pace: str) -> list[Reached]:
    """Episodes on the thesis's station."""
    scale = whole_ticks(cell)
    found = [play(cell, rewards, choose, by=pace, per_second=scale, limit=1400 * scale) for _ in range(episodes)]
    return [_reached(episode, scale) for episode in found]


def _reached(episode: Episode, per_second: int) -> Reached:
    makespan, stress = (episode.ticks / per_second, episode.stress) if episode.done else (None, None)
    return Reached(makespan, stress, episode.illegal, -float(sum(episode.returns)), episode.schedule)


def _mean(values: Sequence[float]) -> tuple[float | None, float | None]:
    """Mean and half width of its 95 % interval (normal approximation); Nones where there are none or only one."""
    if not values:
        return None, None
    half = 1.96 * float(np.std(values, ddof=1)) / len(values) ** 0.5 if len(values) > 1 else None
    return plain(round(float(np.mean(values)), 4)), None if half is None else round(half, 4)


def _front(cell: Cell, limit: float) -> Front | None:
    try:
        return plan(cell, time_limit=limit, seed=0)
    except NothingFoundError:
        return None
