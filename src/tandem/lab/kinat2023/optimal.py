"""What is optimal under the rewards: exact dynamic programming over the joint process of the
thesis's station, tick by tick.

Plain Python on whole numbers, written apart from `world.py`: a judge of learners, not their world.
Every joint action counts, illegal ones too: all illegal actions of an agent have the same effect,
so the best paid of them stands for all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from itertools import product
from typing import NamedTuple

from tandem.cell.model import Cell
from tandem.errors import NothingFoundError, UsageError
from tandem.lab.kinat2023.episode import seconds
from tandem.lab.kinat2023.station import station
from tandem.lab.kinat2023.world import HUMAN, ROBOT, Rewards


class Way(NamedTuple):
    """How a return-optimal policy can end: makespan in seconds, stress, and the fewest illegal
    actions it needs for that.
    """

    makespan: float
    stress: float
    illegal: int


@dataclass(frozen=True)
class Optimum:
    """The best there is under these rewards, when both agents work for the sum of their returns.

    Attributes:
      value: the largest sum of the two agents' returns (discount 1).
      ways: every (makespan, stress) that a policy of this value can reach, sorted.
      actions: per way, joint actions (robot, human) that do it, one a tick.
      states: how many states of the joint process were valued.
    """

    value: float
    ways: tuple[Way, ...]
    actions: Mapping[Way, tuple[tuple[int, int], ...]]
    states: int

    @property
    def pairs(self) -> list[tuple[float, float]]:
        """(makespan, stress) of every return-optimal policy."""
        return [(way.makespan, way.stress) for way in self.ways]


def return_optimal(
    cell: Cell, rewards: Rewards, *, per_second: int = 1, limit: int = 1_000_000
) -> Optimum:
    """The return-optimal joint policies of the cell in the thesis's tick world.

    Raises:
      CellError: the thesis's encoding cannot hold the cell.
      UsageError: the rewards pay for doing nothing, so that no return is the largest.
      NothingFoundError: the joint process has more than `limit` states (they grow with the times
        and exponentially with the tasks).
    """
    process = _Process(cell, rewards, per_second)
    order = _reachable(process, limit)
    best: dict[_State, int] = {process.done: 0}
    ends: dict[_State, dict[tuple[int, int], int]] = {process.done: {(0, 0): 0}}
    for state in order:
        best[state], ends[state] = _value(process, state, best, ends)
    start, found = process.start, {}
    for (ticks, stress), illegal in sorted(ends[process.start].items()):
        way = Way(seconds(ticks, per_second), float(Decimal(stress) / process.per_stress), illegal)
        found[way] = tuple(_walk(process, start, ticks, stress, illegal, best, ends))
    return Optimum(float(Decimal(best[start]) / process.scale), tuple(found), found, len(order))


FINES = ("busy", "dependent", "unavailable")
"""What the three parts of `Rewards.illegal` are for."""


class _State(NamedTuple):
    """Tasks that ended, as bits; what robot and human do (-1 = free) and the ticks left of it."""

    ended: int
    doing: tuple[int, int]
    left: tuple[int, int]


class _Option(NamedTuple):
    """What one agent can do in a tick: the number it names, the task it begins (-1 = none), whether
    that is illegal, its pay.
    """

    number: int
    begins: int
    illegal: bool
    paid: int


class _Move(NamedTuple):
    """A joint action: numbers, state after it, team pay, stress begun, illegal actions."""

    action: tuple[int, int]
    after: _State
    paid: int
    stress: int
    illegal: int


class _Process:
    """The joint process in whole numbers: pay times `scale`, stress times `per_stress`."""

    def __init__(self, cell: Cell, rewards: Rewards, per_second: int):
        data = station(cell, per_second=per_second)
        self.time: list[list[int]] = data.time.tolist()
        self.tasks = range(len(self.time[ROBOT]))
        self.needs = [sum(1 << j for j in self.tasks if data.needs[i, j]) for i in self.tasks]
        stress = [Decimal(str(e)) for e in data.stress]
        illegal = rewards.illegal if isinstance(rewards.illegal, tuple) else (rewards.illegal,) * 3
        paid = rewards._asdict() | dict(zip(FINES, illegal, strict=True)) | {"illegal": 0.0}
        pay = {name: Decimal(repr(float(value))) for name, value in paid.items()}
        self.per_stress = _scale(stress)
        self.stress = [int(e * self.per_stress) for e in stress]
        self.scale = _scale([*pay.values(), *(e * pay["stress_factor"] for e in stress)])
        self.pay = {
            name: int(value * self.scale) for name, value in pay.items() if name != "stress_factor"
        }
        self.load = [int(e * pay["stress_factor"] * self.scale) for e in stress]
        self.all = (1 << len(self.tasks)) - 1
        self.start = _State(0, (-1, -1), (0, 0))
        self.done = _State(self.all, (-1, -1), (0, 0))

    def moves(self, state: _State) -> Iterator[_Move]:
        """Every joint action with a different effect or pay."""
        for robot, human in product(self.options(state, ROBOT), self.options(state, HUMAN)):
            yield self.move(state, robot, human)

    def options(self, state: _State, agent: int) -> list[_Option]:
        doing = state.doing[agent]
        # naming the own task breaks one rule, and no illegal action of a busy agent breaks fewer
        if doing >= 0:
            return [
                _Option(0, -1, False, 0),
                *self.illegal([(True, *self.broken(state, agent, i), i) for i in self.tasks]),
            ]
        broken = [(False, *self.broken(state, agent, i), i) for i in self.tasks]
        sign = 1 if agent == ROBOT else -1
        legal = [
            _Option(i + 1, i, False, sign * self.load[i]) for *rules, i in broken if not any(rules)
        ]
        return [
            _Option(0, -1, False, self.pay["idle"]),
            *legal,
            *self.illegal([one for one in broken if any(one[:-1])]),
        ]

    def broken(self, state: _State, agent: int, task: int) -> tuple[bool, bool]:
        """Which rules naming the task breaks for an agent, whether it is busy or not: an open
        dependency, no time of its own.
        """
        gone = (
            state.ended >> task & 1 or state.doing[1 - agent] == task or not self.time[agent][task]
        )
        return bool(self.needs[task] & ~state.ended), bool(gone)

    def illegal(self, broken: list[tuple[bool, bool, bool, int]]) -> list[_Option]:
        """The best paid of these illegal actions, each (three rules, whether broken; task)."""
        fines = [self.pay[name] for name in FINES]
        options = [
            _Option(
                i + 1,
                -1,
                True,
                sum(fine for fine, is_broken in zip(fines, rules, strict=True) if is_broken),
            )
            for *rules, i in broken
        ]
        return [max(options, key=lambda option: option.paid)] if options else []

    def move(self, state: _State, robot: _Option, human: _Option) -> _Move:
        ended, doing, left, paid, stress = (
            state.ended,
            list(state.doing),
            list(state.left),
            2 * self.pay["step"],
            0,
        )
        if robot.begins == human.begins >= 0:  # the robot yields, at no cost
            robot = robot._replace(begins=-1, paid=0)
        for agent, option in enumerate((robot, human)):
            paid += option.paid
            if doing[agent] >= 0 and not option.illegal:
                left[agent] -= 1
                if left[agent] == 0:
                    ended |= 1 << doing[agent]
                    doing[agent] = -1
                    paid += self.pay["task_done"]
            if option.begins >= 0:
                doing[agent], left[agent] = option.begins, self.time[agent][option.begins] - 1
                stress += self.stress[option.begins] if agent == HUMAN else 0
        after = _State(ended, (doing[ROBOT], doing[HUMAN]), (left[ROBOT], left[HUMAN]))
        if after == self.done:
            paid += 2 * self.pay["all_done"]
        return _Move(
            (robot.number, human.number), after, paid, stress, robot.illegal + human.illegal
        )

    def work(self, state: _State) -> int:
        """What is left to do: each move but one that changes nothing makes it smaller."""
        begun = state.ended | sum(1 << task for task in state.doing if task >= 0)
        return sum(
            max(self.time[ROBOT][i], self.time[HUMAN][i]) for i in self.tasks if not begun >> i & 1
        ) + sum(state.left)


def _reachable(process: _Process, limit: int) -> list[_State]:
    """Every state but the last one, those with less left to do first."""
    seen, open_states = {process.start}, [process.start]
    while open_states:
        state = open_states.pop()
        if state == process.done:
            continue
        for move in process.moves(state):
            if move.after not in seen:
                seen.add(move.after)
                open_states.append(move.after)
        if len(seen) > limit:
            raise NothingFoundError(
                f"the joint process has more than {limit:,} states; raise the limit or take a"
                " smaller cell."
            )
    return sorted(seen - {process.done}, key=process.work)


def _value(
    process: _Process,
    state: _State,
    best: Mapping[_State, int],
    ends: Mapping[_State, Mapping[tuple[int, int], int]],
) -> tuple[int, dict[tuple[int, int], int]]:
    """The state's largest team return, and (ticks, stress) -> fewest illegal actions of every way
    to reach it.
    """
    moves = []
    for move in process.moves(state):
        if move.after != state:
            moves.append((move.paid + best[move.after], move))
        elif move.paid >= 0:
            raise UsageError(
                "these rewards pay for doing nothing: waiting forever would be worth the most. Make"
                " `step` more negative."
            )
    value = max(worth for worth, _ in moves)
    ways: dict[tuple[int, int], int] = {}
    for worth, move in moves:
        if worth == value:
            for (ticks, stress), illegal in ends[move.after].items():
                way = (ticks + 1, stress + move.stress)
                ways[way] = min(ways.get(way, illegal + move.illegal), illegal + move.illegal)
    return value, ways


def _walk(
    process: _Process,
    state: _State,
    ticks: int,
    stress: int,
    illegal: int,
    best: Mapping[_State, int],
    ends: Mapping[_State, Mapping[tuple[int, int], int]],
) -> Iterator[tuple[int, int]]:
    """Joint actions from the state to the end, of largest return, in so many ticks, with this
    stress and so many illegal actions. Of those that do as well the one after which more agents
    work: waiting costs nothing here, and a schedule that waits for no reason shows nobody anything.
    """
    while state != process.done:
        fitting = [
            move
            for move in process.moves(state)
            if move.after != state
            and move.paid + best[move.after] == best[state]
            and ends[move.after].get((ticks - 1, stress - move.stress)) == illegal - move.illegal
        ]
        move = max(fitting, key=lambda one: sum(task >= 0 for task in one.after.doing))
        yield move.action
        state, ticks, stress, illegal = (
            move.after,
            ticks - 1,
            stress - move.stress,
            illegal - move.illegal,
        )


def _scale(numbers: list[Decimal]) -> int:
    """The smallest power of ten that makes every number whole."""
    digits = max(-int(number.normalize().as_tuple().exponent) for number in numbers)
    return int(10 ** max(digits, 0))
