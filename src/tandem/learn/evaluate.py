"""Trained policies played in NumPy, beside the exact front, the best dispatch rule and a random player. No JAX is loaded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.model import Cell, plain
from tandem.envs.thesis.decisions import after_human, choices
from tandem.envs.thesis.episode import Episode, play
from tandem.envs.thesis.rewards import reward_set
from tandem.envs.thesis.station import whole_ticks
from tandem.envs.thesis.world import HUMAN, ROBOT, Rewards, State, Station
from tandem.envs.thesis.world import legal as legal_now
from tandem.errors import NothingFoundError, UsageError
from tandem.learn.gaps import relative_gap
from tandem.learn.policy import Policy
from tandem.learn.recipes import OBSERVATIONS
from tandem.learn.runs import RunFolder
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
      cell: another cell than the run's own; it needs as many tasks.
      seed: which policy; the run's first when absent. It also seeds the draws.
      episodes: of the sampled and the random player.
      front_limit: seconds for the exact front.

    Raises:
      CellError: the folder holds no run, or the station cannot hold the cell.
      UsageError: no such seed, or the policy does not fit the cell.
    """
    run = RunFolder(Path(folder))
    asked = run.asked()
    if seed is None:
        seed = run.seeds[0] if run.seeds else asked["seeds"][0]
    if seed not in run.seeds:
        raise UsageError(f"{folder}: has no policy of seed {seed}; there are {', '.join(map(str, run.seeds)) or 'none yet'}.")
    return judge(Policy.load(run.policy(seed)), cell or Cell.model_validate(asked["cell"]), seed=seed, episodes=episodes, front_limit=front_limit)


def judge(policy: Policy, cell: Cell, *, seed: int = 0, episodes: int = 100, front_limit: float = 30.0) -> Evaluation:
    """`evaluate` for a policy in hand."""
    notes = policy.notes
    rewards = reward_set(notes["rewards"], stress_factor=notes["stress_factor"])
    front = _front(cell, front_limit)
    table = _Table(cell, rewards, notes["pace"], front)
    draws = np.random.default_rng(seed)
    greedy = table.play(chooser(policy, notes["pace"]), 1)
    sampled = table.play(chooser(policy, notes["pace"], draws), episodes)
    by_chance = table.play(random_chooser(draws), episodes, pace="decisions")
    finished = [episode for episode in sampled if episode.done]
    best = [max(finished, key=lambda episode: sum(episode.returns))] if finished else sampled[:1]
    lines = [
        table.line("greedy", greedy),
        table.line("sampled", sampled),
        table.line(f"best of {episodes}", best),
        table.best_rule(),
        table.line("random", by_chance),
    ]
    return Evaluation(cell, front, tuple(line for line in lines if line), notes["stress_factor"], seed)


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


@dataclass(frozen=True)
class _Table:
    cell: Cell
    rewards: Rewards
    pace: str
    front: Front | None

    def play(self, choose: Choose, episodes: int, pace: str | None = None) -> list[Episode]:
        scale = whole_ticks(self.cell)
        return [play(self.cell, self.rewards, choose, by=pace or self.pace, per_second=scale, limit=1400 * scale) for _ in range(episodes)]

    def line(self, player: str, episodes: Sequence[Episode]) -> Line:
        scale = whole_ticks(self.cell)
        ended = [episode for episode in episodes if episode.done]
        makespan, makespan_ci = _mean([episode.ticks / scale for episode in ended])
        stress, stress_ci = _mean([episode.stress for episode in ended])
        wrong = faults(self.cell, episodes[0].schedule) if len(episodes) == 1 else []
        return Line(
            player,
            len(episodes),
            len(ended) / len(episodes),
            makespan,
            stress,
            makespan_ci,
            stress_ci,
            float(np.mean([episode.illegal for episode in episodes])),
            self._gap(makespan, stress),
            episodes[0].schedule if len(episodes) == 1 and ended and not wrong else None,
            tuple(wrong),
        )

    def best_rule(self) -> Line | None:
        """The dispatch rule whose best schedule costs least under these rewards; the random rules are no rules."""
        found = []
        for name in RULES:
            if name in ("random", "best-of-n"):
                continue
            try:
                for result in plan(self.cell, method=name, seed=0):
                    found.append((self._gap(result.makespan, result.stress), result.makespan, result.stress, name, result.schedule))
            except NothingFoundError:
                continue
        if not found:
            return None
        gap, makespan, stress, name, schedule = min(found, key=lambda item: (item[0] if item[0] is not None else item[1], item[3]))
        return Line(f"rule {name}", 1, 1.0, plain(makespan), plain(stress), None, None, 0.0, gap, schedule)

    def _gap(self, makespan: float | None, stress: float | None) -> float | None:
        paid = {"step": float(self.rewards.step), "per_second": whole_ticks(self.cell), "stress_factor": float(self.rewards.stress_factor)}
        return relative_gap(self.front, makespan, stress, **paid)


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
