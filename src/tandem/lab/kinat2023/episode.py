"""One assembly played through, in NumPy: what was done, what it paid, and the schedule it made."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any, NamedTuple

import numpy as np

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.lab.kinat2023.decisions import decide_step
from tandem.lab.kinat2023.station import station
from tandem.lab.kinat2023.world import Info, Rewards, State, Station, reset, step
from tandem.schedule.model import Assignment, Schedule

STEPS_OF_THE_THESIS = 1400
"""The most ticks in an episode of the thesis."""


@dataclass
class Record:
    """Writes down who began and ended what; `cell` and `per_second` give names and seconds."""

    cell: Cell
    per_second: int = 1
    begun: dict[int, tuple[int, str]] = field(default_factory=dict)
    rows: list[Assignment] = field(default_factory=list)

    def note(self, before: State, info: Info) -> None:
        """Takes up what happened in the step that began in state `before`."""
        agents = (self.cell.robots[0], self.cell.humans[0])
        for agent, name in enumerate(agents):
            if task := int(info.started[agent]):
                self.begun[task] = (int(before.clock), name)
            if task := int(info.finished[agent]):
                self._add(task, int(info.finished_at[agent]))

    def so_far(self, clock: int) -> Schedule:
        """The schedule up to now; tasks under way end now."""
        ended = {row.task for row in self.rows}
        names = list(self.cell.tasks)
        open_rows = [self._row(task, clock) for task in self.begun if names[task - 1] not in ended]
        return Schedule(tuple(self.rows + open_rows))

    @property
    def schedule(self) -> Schedule:
        """The tasks that have ended."""
        return Schedule(tuple(self.rows))

    def _add(self, task: int, clock: int) -> None:
        self.rows.append(self._row(task, clock))

    def _row(self, task: int, clock: int) -> Assignment:
        start, who = self.begun[task]
        return Assignment(
            seconds(start, self.per_second),
            seconds(clock, self.per_second),
            list(self.cell.tasks)[task - 1],
            (who,),
        )


@dataclass(frozen=True)
class Episode:
    """What one play of the station was.

    Attributes:
      actions: per step, what robot and human named.
      returns: sum of the rewards of robot and human.
      done: all tasks were done before the limit.
      ticks: how long it took.
      stress: ergonomic stress on the human.
      illegal: actions that broke a rule.
      schedule: the tasks that ended, in names and seconds. An illegal action made while busy
        stretches the task in hand.
    """

    actions: tuple[tuple[int, int], ...]
    returns: tuple[float, float]
    done: bool
    ticks: int
    stress: float
    illegal: int
    schedule: Schedule


class Experience(NamedTuple):
    """One step: the state in which both named something, what they named, what they were paid and
    how many rules they broke, `[2]` each, the state after it, and whether it was the last.
    """

    before: State
    action: Any
    reward: Any
    illegal: Any
    after: State
    done: bool


def play(
    cell: Cell,
    rewards: Rewards,
    choose: Callable[[Station, State], Any],
    *,
    by: str = "decisions",
    per_second: int = 1,
    limit: int = STEPS_OF_THE_THESIS,
    watch: Callable[[Experience], Any] | None = None,
) -> Episode:
    """Plays the station until all is done or `limit` ticks have passed.

    Args:
      choose: station and state (NumPy) to the two agents' actions.
      by: "decisions" (`decisions.decide_step`) or "ticks" (`world.step`).
      watch: is told every step.

    Raises:
      CellError: the thesis's encoding cannot hold the cell.
      UsageError: `by` is neither of the two.
    """
    if by not in STEPS:
        raise UsageError(f"by={by!r}: the station is played by {' or by '.join(STEPS)}.")
    data, record = station(cell, per_second=per_second), Record(cell, per_second)
    state, done, actions, returns, illegal = reset(data), False, [], np.zeros(2), 0
    while not done and int(state.clock) < limit:
        action = np.asarray(choose(data, state), np.int32)
        before = state
        state, reward, done, info = STEPS[by](data, rewards, state, action)
        record.note(before, info)
        if watch:
            watch(Experience(before, action, reward, info.illegal, state, bool(done)))
        actions.append((int(action[0]), int(action[1])))
        returns += reward
        illegal += int(np.count_nonzero(info.illegal))
    return Episode(
        actions=tuple(actions),
        returns=(float(returns[0]), float(returns[1])),
        done=bool(done),
        ticks=int(state.clock),
        stress=float(state.stress),
        illegal=illegal,
        schedule=record.schedule,
    )


STEPS: dict[str, Callable[..., tuple[State, Any, Any, Info]]] = {
    "decisions": decide_step,
    "ticks": step,
}


def actions_of(cell: Cell, schedule: Schedule, *, per_second: int = 1) -> list[tuple[int, int]]:
    """Per tick, what robot and human must name so that the station does exactly this schedule.

    Raises UsageError when a start is no whole tick or the schedule has operators that the station
    has not.
    """
    numbers, agents = (
        {name: i + 1 for i, name in enumerate(cell.tasks)},
        (cell.robots[0], cell.humans[0]),
    )
    ticks = max((_whole(row.end, per_second) for row in schedule), default=0)
    actions = [[0, 0] for _ in range(ticks)]
    for row in schedule:
        if len(row.operators) != 1 or row.operators[0] not in agents:
            raise UsageError(
                f"task {row.task!r} is done by {' and '.join(row.operators)}; the thesis's station"
                f" has {agents[0]} and {agents[1]}, one a task."
            )
        actions[_whole(row.start, per_second)][agents.index(row.operators[0])] = numbers[row.task]
    return [(robot, human) for robot, human in actions]


def follow(actions: Sequence[tuple[int, int]]) -> Callable[[Station, State], tuple[int, int]]:
    """A `choose` for `play(..., by="ticks")` that names `actions[tick]` and, behind their end,
    nothing.
    """
    return lambda _, state: actions[int(state.clock)] if int(state.clock) < len(actions) else (0, 0)


def seconds(ticks: int, per_second: int) -> float:
    """Ticks in seconds, as the nearest float to the exact decimal."""
    return float(Decimal(ticks) / per_second)


def _whole(moment: float, per_second: int) -> int:
    ticks = Decimal(repr(float(moment))) * per_second
    if ticks % 1:
        raise UsageError(
            f"{moment:g} s is {ticks.normalize():f} ticks, no whole number. Give the station more"
            " ticks per second."
        )
    return int(ticks)
