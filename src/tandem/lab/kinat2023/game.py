"""One station under way, with what the standard faces need of it: masks, observations, happenings,
pictures.

The PettingZoo and the Gymnasium face are thin; what they share stands here. It plays in NumPy by
the rules of `world.py`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.lab.kinat2023.decisions import choices, decide_step, deciding
from tandem.lab.kinat2023.episode import STEPS_OF_THE_THESIS, Record, seconds
from tandem.lab.kinat2023.observations import observe, observe_normalised, observe_scaled
from tandem.lab.kinat2023.rewards import reward_set
from tandem.lab.kinat2023.station import station
from tandem.lab.kinat2023.world import Array, Info, Rewards, State, Station, legal, reset, step
from tandem.schedule.model import Schedule

AGENTS = ("robot_0", "human_0")
RENDER_MODES = ("ansi", "rgb_array")
OBSERVATIONS: dict[str, Callable[[Station, State], Array]] = {
    "thesis": observe,
    "scaled": observe_scaled,
    "normalised": observe_normalised,
}
STEPS: dict[
    str, tuple[Callable[[Station, State], Array], Callable[..., tuple[State, Array, Array, Info]]]
] = {
    "ticks": (legal, step),
    "decisions": (choices, decide_step),
}
"""How time moves -> the mask of an action, and what one does."""


@dataclass(frozen=True)
class Options:
    """What a face of the thesis's station can be told.

    Attributes:
      rewards: a set of `REWARDS` by name, or rewards of one's own.
      stress_factor: the ergonomic factor f; counts for sets by name.
      stage: 1 punishes idling as the thesis's first stage does; counts for sets by name.
      by: "ticks", every second an action; or "decisions", time runs on until someone decides.
      observation: "thesis", as the thesis has it; "scaled", the same in 0..1; "normalised", our own
        recipe's.
      strict: an illegal action raises instead of costing what the rewards say.
      limit: ticks after which an unfinished episode is cut off.
      per_second: ticks in a second.
      render_mode: None, "ansi" or "rgb_array".
    """

    rewards: str | Rewards = "appendix"
    stress_factor: float = 0.0
    stage: int = 2
    by: str = "ticks"
    observation: str = "thesis"
    strict: bool = False
    limit: int = STEPS_OF_THE_THESIS
    per_second: int = 1
    render_mode: str | None = None

    def __post_init__(self) -> None:
        for key, known in (
            ("by", STEPS),
            ("observation", OBSERVATIONS),
            ("render_mode", (None, *RENDER_MODES)),
        ):
            if (value := getattr(self, key)) not in known:
                meant = "".join(
                    f" Did you mean {near!r}?"
                    for near in get_close_matches(str(value), [x for x in known if x], 1)
                )
                raise UsageError(
                    f"{key}={value!r} is unknown.{meant} Choose from"
                    f" {', '.join(repr(x) for x in known)}."
                )
        if self.limit < 1:
            raise UsageError(f"limit={self.limit!r}: give at least one tick.")


class Game:
    """The station from its reset to its end."""

    def __init__(self, cell: Cell | str | os.PathLike[str], options: Options):
        self.cell, self.options = as_cell(cell), options
        self.station = station(self.cell, per_second=options.per_second)
        paid = options.rewards
        self.rewards = (
            paid
            if isinstance(paid, Rewards)
            else reward_set(paid, stress_factor=options.stress_factor, stage=options.stage)
        )
        self.tasks = self.station.stress.shape[0]
        self.legal, self._step = STEPS[options.by]
        self.reset()

    def reset(self) -> None:
        """Everything to do again."""
        self.state, self.record = reset(self.station), Record(self.cell, self.options.per_second)
        self.done, self._masks = False, self._judge()

    def step(
        self, action: tuple[int, int], broken: tuple[bool, bool]
    ) -> tuple[NDArray[np.float32], list[dict[str, Any]]]:
        """Moves on; returns both rewards and both agents' happenings. `broken` says whose action
        the mask had forbidden.

        Raises UsageError when an action is illegal and the game is strict.
        """
        if self.options.strict and any(broken):
            raise UsageError(self._complaint(action, broken))
        before = self.state
        self.state, reward, done, info = self._step(
            self.station, self.rewards, before, np.asarray(action, np.int32)
        )
        self.done, self._masks = bool(done), self._judge()
        self.record.note(before, info)
        return reward, [self.happenings(agent, info, broken[agent]) for agent in range(2)]

    @property
    def truncated(self) -> bool:
        """The limit came before the end."""
        return not self.done and int(self.state.clock) >= self.options.limit

    def masks(self) -> NDArray[np.int8]:
        """`[2, T + 1]`, 1 = legal; a copy."""
        return self._masks.copy()

    def observe(self) -> NDArray[np.float32]:
        """`[2, D]`."""
        return np.asarray(
            OBSERVATIONS[self.options.observation](self.station, self.state), np.float32
        )

    def highest(self) -> NDArray[np.float32]:
        """`[D]`, the largest value that each number of an observation can take; the smallest is
        0.
        """
        data = self.station
        if self.options.observation != "thesis":
            return np.ones(self.observe().shape[1], np.float32)
        parts = [
            np.full(2, self.tasks),
            np.maximum(data.time.ravel(), 1),
            np.maximum(data.stress, 1),
            np.ones(self.tasks**2),
        ]
        return np.concatenate(parts).astype(np.float32)

    def deciding(self) -> NDArray[np.bool_]:
        """`[2]`, who is free and has a legal task."""
        return np.asarray(deciding(self.station, self.state))

    def happenings(
        self, agent: int, info: Info | None = None, broken: bool = False
    ) -> dict[str, Any]:
        """`info` of the faces, without the mask. Times in seconds; `stress_rate` per minute;
        `makespan` when the last task so far ended.
        """
        names, now, rows = (
            list(self.cell.tasks),
            seconds(int(self.state.clock), self.options.per_second),
            self.record.rows,
        )
        stress = float(self.state.stress)
        return {
            "time": now,
            "makespan": max((row.end for row in rows), default=0.0),
            "stress": stress,
            "stress_rate": 60.0 * stress / now if now else 0.0,
            "task_started": (
                names[info.started[agent] - 1] if info is not None and info.started[agent] else ""
            ),
            "task_finished": (
                names[info.finished[agent] - 1] if info is not None and info.finished[agent] else ""
            ),
            "idle": (
                seconds(int(info.idle[agent]), self.options.per_second) if info is not None else 0.0
            ),
            "illegal": bool(broken),
            "is_success": self.done,
        }

    def schedule(self) -> Schedule:
        """What was done so far; tasks under way end now."""
        return self.record.so_far(int(self.state.clock))

    def render(self) -> str | NDArray[np.uint8] | None:
        """The schedule so far as text or picture, as the render mode says."""
        from tandem.envs import pictures

        now = seconds(int(self.state.clock), self.options.per_second)
        if self.options.render_mode == "ansi":
            return pictures.text_gantt(self.cell, self.schedule(), now)
        if self.options.render_mode == "rgb_array":
            return pictures.rgb_gantt(self.cell, self.schedule(), now, float(self.state.stress))
        return None

    def _judge(self) -> NDArray[np.int8]:
        return np.asarray(self.legal(self.station, self.state), np.int8)

    def _complaint(self, action: tuple[int, int], broken: tuple[bool, bool]) -> str:
        names = ["wait", *self.cell.tasks]
        said = [
            f"{AGENTS[agent]} named {action[agent]} ({names[action[agent]]}); "
            f"legal are {', '.join(str(number) for number in np.flatnonzero(self.masks()[agent]))}"
            for agent in range(2)
            if broken[agent]
        ]
        return (
            f"illegal at {seconds(int(self.state.clock), self.options.per_second):g} s:"
            f" {'; '.join(said)}. Take an action from action_masks()."
        )


def of_reset(game: Game, options: Mapping[str, Any] | None) -> Game:
    """The game on the cell that `reset(options={"cell": ...})` names, else the same.

    Raises UsageError when it does not have the spaces of the game so far.
    """
    if options is None or options.get("cell") is None:
        return game
    other = Game(options["cell"], game.options)
    if other.tasks != game.tasks or (other.highest() > game.highest()).any():
        raise UsageError(
            f"cell {other.cell.name!r}: has {other.tasks} tasks, the environment's has"
            f" {game.tasks}, and its observations must stay within the environment's. Make an"
            " environment of its own for it."
        )
    return other


def as_cell(cell: Cell | str | os.PathLike[str]) -> Cell:
    """The cell itself, or the one in that file. Raises CellError as `tandem.load` does."""
    if isinstance(cell, Cell):
        return cell
    from tandem.files.load import load

    return load(cell)


def thesis_cell() -> Cell:
    """The exemplary assembly of Kinat (2023), chapter 6."""
    from tandem.files.load import load

    with resources.as_file(resources.files("tandem.lab.kinat2023") / "thesis.yaml") as file:
        return load(file)
