"""One shift under way, with what the standard faces need of it: masks, observations, happenings,
pictures. In NumPy; needs no JAX.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tandem.cell.model import Cell
from tandem.envs.cells import as_cell
from tandem.envs.observations import MOST, observe
from tandem.envs.rewards import Happening, reward_of
from tandem.errors import UsageError
from tandem.schedule.model import Schedule
from tandem.world import state as world
from tandem.world.arrays import Arrays, Names, namespace
from tandem.world.episode import Shift, begin, decide, is_over, run_on
from tandem.world.people import Person, led
from tandem.world.people import crew as crew_of
from tandem.world.population import crowd
from tandem.world.randomness import OFF, Chance, Draw, scenario

RENDER_MODES = ("ansi", "rgb_array")


@dataclass(frozen=True)
class Options:
    """What a face of the event world can be told.

    Attributes:
      person: who the humans are, in words: "compliant", "random:0.5", "pace:2+forgetful:0.1",
        "population:FILE" (`docs/people.md`).
      part: of a population file, "held_out" or "train".
      chance: what may happen besides.
      stress_factor: seconds that a unit of stress is worth in the reward.
      reward: what is paid instead: a function of a `rewards.Happening`, a table of
        `rewards.NUMBERS`, or the name of a function (`tandem.rewards`, `package.module:function`).
      strict: an illegal action raises instead of counting as waiting.
      limit: seconds after which an unfinished episode is cut off; twenty times all work done one
        after the other when absent.
      per_second: ticks in a second; fine enough when absent.
      render_mode: None, "ansi" or "rgb_array".
    """

    person: str = "compliant"
    part: str = "held_out"
    chance: Chance = field(default=OFF)
    stress_factor: float = 0.0
    reward: Any = None
    strict: bool = False
    limit: float | None = None
    per_second: int | None = None
    render_mode: str | None = None

    def __post_init__(self) -> None:
        for key, known in (("part", ("train", "held_out")), ("render_mode", (None, *RENDER_MODES))):
            if (value := getattr(self, key)) not in known:
                meant = "".join(
                    f" Did you mean {near!r}?"
                    for near in get_close_matches(str(value), [x for x in known if x], 1)
                )
                raise UsageError(
                    f"{key}={value!r} is unknown.{meant} Choose from"
                    f" {', '.join(repr(x) for x in known)}."
                )
        if self.limit is not None and not self.limit > 0:
            raise UsageError(f"limit={self.limit!r}: give seconds above 0.")
        reward_of(self.reward, self.stress_factor)


class EventGame:
    """A shift from its reset to its end. `free` leaves every choice to who plays: people then only
    have their pace, their fatigue and their slips.
    """

    def __init__(
        self, cell: Cell | str | os.PathLike[str], options: Options, *, free: bool = False
    ):
        self.cell, self.options, self.free = as_cell(cell), options, free
        self.pay = reward_of(options.reward, options.stress_factor)
        self.names = Names.of(self.cell, per_second=options.per_second)
        self.people = crowd(options.person, self.names, self.names.arrays(), part=options.part)
        self.arrays = self.names.arrays(
            undo=options.chance.undo if self.people.makes_mistakes else None
        )
        self.draw = Draw.of(self.names, self.arrays, options.chance)
        longest = [max(mode.time for mode in self.cell.modes(task)) for task in self.cell.tasks]
        self._masked: Shift | None = None
        self._masks: dict[int, NDArray[np.int8]] = {}
        self.limit = self.names.ticks(20 * sum(longest) if options.limit is None else options.limit)
        self.reset(np.random.default_rng(0))

    def reset(self, rng: np.random.Generator) -> None:
        """Everything to do again; chance and people are drawn from `rng`, all at once."""
        person = Person(*(value[0] for value in self.people.draw(rng, 1)))
        if self.free:
            person = led(person)
        self.crew = crew_of(self.arrays, person)
        self.scenario = scenario(self.draw, self.arrays, rng.random(self.draw.numbers, np.float32))
        self.shift: Shift = begin(self.arrays, self.crew)
        self.rows: list[tuple[int, int, int]] = []
        self.to_a_turn()

    def decide(self, way: int) -> None:
        """Whose turn it is is asked to begin the way, or to wait (-1). Time stands still. Assumes
        that it is somebody's turn.
        """
        before, self.shift = (
            self.shift,
            decide(self.arrays, self.scenario, self.crew, self.shift, np.int32(way)),
        )
        after = self.shift.state
        for task in np.flatnonzero((after.start_at != before.state.start_at) & (after.way >= 0)):
            self.rows.append(
                (int(after.way[task]), int(after.start_at[task]), int(after.end_at[task]))
            )

    def to_a_turn(self) -> None:
        """Time runs on until it is somebody's turn, the limit has come, or all is over."""
        while self.shift.turn < 0 and not self.over and self.clock < self.limit:
            self.shift = run_on(self.arrays, self.scenario, self.shift)

    def pass_a_second(self) -> None:
        """Nobody began anything and nothing is to come: a second passes, and all are asked
        again.
        """
        state = world.advance(
            self.arrays, self.shift.state, np.int32(self.clock + self.names.per_second)
        )
        mask = world.legal(self.arrays, state)
        self.shift = self.shift._replace(state=state, mask=mask, turn=world.turn(self.arrays, mask))

    @property
    def clock(self) -> int:
        """Ticks since the start."""
        return int(self.shift.state.clock)

    @property
    def done(self) -> bool:
        """All is done."""
        return bool(world.is_done(self.shift.state))

    @property
    def over(self) -> bool:
        """All is done, or nothing can be done any more."""
        return bool(is_over(self.arrays, self.shift))

    @property
    def truncated(self) -> bool:
        """The limit came before the end, or limits on stress left no way to go on."""
        return not self.done and (self.over or self.clock >= self.limit)

    @property
    def turn(self) -> int:
        """Whose turn it is, -1 for nobody's."""
        return int(self.shift.turn)

    def mask(self, operator: int) -> NDArray[np.int8]:
        """`[W + 1]`, 1 = the operator may choose it; 0 waits, i begins way i - 1. Who has nothing
        to choose waits.
        """
        shift, arrays = self.shift, self.arrays
        if self._masked is not shift:
            self._masked, self._masks = shift, {}
        if operator not in self._masks:
            self._masks[operator] = mask_of(arrays, shift.state, shift.mask, operator)
        return self._masks[operator].copy()

    def observe(self, operator: int) -> NDArray[np.float32]:
        """`[D]`, see `observations.observe`."""
        return np.asarray(
            observe(self.arrays, self.shift.state, self.shift.mask, np.int32(operator))
        )

    def since(self, before: Shift, illegal: bool = False) -> Happening:
        """What has passed since then; `illegal`: an illegal action was named."""
        now, then = self.shift.state, before.state
        started: dict[str, str] = {}
        finished: dict[str, str] = {}
        up, was_up = world.mounted(now), world.mounted(then)
        for task, name in enumerate(self.names.tasks):
            if now.start_at[task] != then.start_at[task] and now.way[task] >= 0:
                started.update(
                    dict.fromkeys(self.names.ways[int(now.way[task])][1].operators, name)
                )
            way = int(now.way[task] if now.way[task] >= 0 else then.way[task])
            if (up[task] and not was_up[task]) or (now.way[task] < 0 <= then.way[task]):
                finished.update(dict.fromkeys(self.names.ways[way][1].operators, name))
        stress = self.stress_at(now) - self.stress_at(then)
        seconds = self.names.seconds(int(now.clock - then.clock))
        idle = sum(self._idle(who, seconds) for who in self.names.operators)
        return Happening(seconds, stress, started, finished, idle, self.done, illegal)

    def stress_at(self, state: world.State) -> float:
        """The cell's measure of stress of what has begun."""
        return self.names.stress(int(world.stress(self.arrays, state)))

    def reward(self, happening: Happening) -> float:
        """What the options pay for it."""
        return self.pay(happening)

    def info(
        self, happening: Happening | None, operator: str | None, illegal: bool
    ) -> dict[str, Any]:
        """`info` of the faces, without the mask; `operator` None speaks of all."""
        state, now = self.shift.state, self.names.seconds(self.clock)
        stress, rows = self.stress_at(state), [end for _, _, end in self.rows if end <= self.clock]
        names = list(self.names.operators) if operator is None else [operator]
        started = {who: happening.started.get(who, "") if happening else "" for who in names}
        finished = {who: happening.finished.get(who, "") if happening else "" for who in names}
        idle = sum(self._idle(who, happening.seconds) for who in names) if happening else 0.0
        return {
            "time": now,
            "makespan": self.names.seconds(max(rows, default=0)),
            "stress": stress,
            "stress_rate": 60.0 * stress / now if now else 0.0,
            "task_started": started if operator is None else started[operator],
            "task_finished": finished if operator is None else finished[operator],
            "idle": idle,
            "illegal": illegal,
            "is_success": self.done,
        }

    def schedule(self) -> Schedule:
        """All work so far, what went wrong and was taken apart included; what is in hand ends
        now.
        """
        rows = [
            (way, start, min(end, self.clock))
            for way, start, end in self.rows
            if start < self.clock
        ]
        return Schedule(tuple(self.names.assignment(*row) for row in rows))

    def render(self) -> str | NDArray[np.uint8] | None:
        """The schedule so far as text or picture, as the render mode says."""
        from tandem.envs import pictures

        now = self.names.seconds(self.clock)
        if self.options.render_mode == "ansi":
            return pictures.text_gantt(self.cell, self.schedule(), now)
        if self.options.render_mode == "rgb_array":
            return pictures.rgb_gantt(
                self.cell, self.schedule(), now, self.stress_at(self.shift.state)
            )
        return None

    def complaint(self, operator: int, action: int) -> str:
        """What a strict game says of an illegal action."""
        legal = ", ".join(
            f"{move} ({self._named(move)})"
            for move in map(int, np.flatnonzero(self.mask(operator)))
        )
        who, named = self.names.operators[operator], self._named(action)
        return (
            f"illegal at {self.names.seconds(self.clock):g} s: {who!r} was to {named}; legal are"
            f" {legal}. Take an action from action_masks()."
        )

    def _named(self, action: int) -> str:
        if action == 0:
            return "wait"
        task, mode = self.names.ways[action - 1]
        return (
            f"do {task!r} with {' and '.join(mode.operators)}"
            if len(mode.operators) > 1
            else f"do {task!r} as {mode.operators[0]}"
        )

    def _idle(self, who: str, seconds: float) -> float:
        """Of the last so many seconds those in which the operator had no work."""
        then, worked = self.clock - self.names.ticks(seconds), 0
        for way, start, end in self.rows:
            if who in self.names.ways[way][1].operators:
                worked += max(0, min(end, self.clock) - max(start, then))
        return seconds - self.names.seconds(worked)


def mask_of(arrays: Arrays, state: world.State, mask: Any, operator: Any) -> NDArray[np.int8]:
    """`[W + 1]`, 1 = the operator (`[]` int) may choose it of what may begin (`mask` `[W]` bool); 0
    waits, i begins way i - 1. Who has nothing to choose waits.
    """
    xp = namespace(mask)
    mine = world.legal_of(arrays, mask, operator)
    waits = ~mine.any() | world.may_wait(arrays, state, mask, operator)
    found: NDArray[np.int8] = xp.concatenate([xp.reshape(waits, (1,)), mine]).astype(xp.int8)
    return found


def ways_of(arrays: Arrays) -> NDArray[np.float32]:
    """`[3, W]`, what a padded observation tells of a cell's ways: their times and the longest chain
    from their task on, in units of the mean duration of a way, and their stress by the largest.
    """
    unit, ticks = arrays.way_ticks.mean(), np.asarray(arrays.way_ticks)
    load = np.asarray(arrays.way_load).sum(axis=1)
    chain = np.asarray(arrays.tail)[np.asarray(arrays.way_task)]
    parts = [ticks / unit, chain / unit, load / max(1, load.max())]
    return np.minimum(np.stack(parts), MOST).astype(np.float32)


def agents_of(names: Names) -> dict[str, int]:
    """`robot_0`, ..., `machine_0`, ..., `human_0`, ... -> the operator's number."""
    cell = names.cell
    return {
        f"{kind}_{index}": names.operators.index(who)
        for kind, group in (
            ("robot", cell.robots),
            ("machine", cell.machines),
            ("human", cell.humans),
        )
        for index, who in enumerate(group)
    }
