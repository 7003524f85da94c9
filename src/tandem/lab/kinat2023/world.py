"""The thesis's station in ticks of one second: state in, state out.

Source: Kinat (2023), chapter 5 and appendix E. The order inside a tick, and every quirk of it, is
kept to the letter; each quirk has a test of its own in `tests/lab/kinat2023/test_thesis_quirks.py`
and a line in `docs/environments.md`.

Pure functions over an array namespace: NumPy arrays in, NumPy arrays out; under `jax.jit` and
`jax.vmap` the same lines are traced. They describe one station; `vmap` adds the batch. No function
here draws a random number.

Axes: 2 agents, row 0 the robot and row 1 the human; `T` tasks, numbered 1..T in actions and in
`doing`, where 0 is "none".
"""

from __future__ import annotations

from typing import Any, NamedTuple

Array = Any
"""A NumPy or JAX array, or a tracer of one."""

ROBOT, HUMAN = 0, 1


class Station(NamedTuple):
    """One cell as the thesis encodes it; made by `station(cell)`.

    time: `[2, T]` int32, ticks that the agent needs for the task; 0 where it cannot do it.
    stress: `[T]` float32, the ergonomic value e of the task.
    needs: `[T, T]` bool, `needs[i, j]`: task i cannot start before task j has ended.
    """

    time: Array
    stress: Array
    needs: Array


class Rewards(NamedTuple):
    """What an agent is paid in a tick, by reason; see `rewards.py` for the thesis's two sets.

    step: every tick, each agent.
    task_done: the agent whose task ends.
    illegal: once for each rule that the named task breaks; they add up. One number, or three: for
      naming a task while busy, one with an open dependency, one whose own time is 0.
    idle: a free agent that names no task.
    all_done: each agent, in the tick that ends the last task.
    stress_factor: the ergonomic factor f; starting task i pays the robot +e_i f and the human -e_i
    f.
    """

    step: Array
    task_done: Array
    illegal: Array
    idle: Array
    all_done: Array
    stress_factor: Array


class State(NamedTuple):
    """An assembly under way.

    time: `[2, T]` int32, ticks left; 0 = cannot, taken by the other, or ended. From the reset on a
    task that has not begun
      shows one tick less than it takes: the tick in which it is assigned pays for the missing one.
    doing: `[2]` int32, number of the task in hand, 0 = free.
    ended: `[T]` bool, the tasks whose column of the dependency matrix has been cleared.
    clock: `[]` int32, ticks since the start.
    stress: `[]` float32, ergonomic stress of what the human has begun.
    """

    time: Array
    doing: Array
    ended: Array
    clock: Array
    stress: Array


class Info(NamedTuple):
    """What happened in a tick or between two decisions.

    started: `[2]` int32, number of the task that the agent began, else 0.
    finished: `[2]` int32, number of the task that the agent ended, else 0.
    finished_at: `[2]` int32, the clock when it ended, else 0.
    illegal: `[2]` int32, rules that the agent's action broke, 0 to 3 in a tick.
    idle: `[2]` int32, ticks in which the agent was free and named no task.
    ticks: `[]` int32, how much time passed.
    """

    started: Array
    finished: Array
    finished_at: Array
    illegal: Array
    idle: Array
    ticks: Array


def reset(station: Station, doing: Array | None = None) -> State:
    """The assembly before its first tick. One tick is taken off every time that is not 0, as the
    thesis does.

    Args:
      doing: `[2]` int, numbers of tasks that robot and human have in hand already, 0 = none. They
        begin now, as if they had been named in a tick before the first, so each ends a tick sooner
        than it takes; their stress counts, and the other agent's time for them is 0. Assumes that
        each can do its task and that they are not the same.
    """
    xp = namespace(station.time)
    tasks = station.time.shape[1]
    empty = State(
        time=station.time - (station.time > 0),
        doing=xp.zeros(2, xp.int32),
        ended=xp.zeros(tasks, bool),
        clock=xp.zeros((), xp.int32),
        stress=xp.zeros((), xp.float32),
    )
    if doing is None:
        return empty
    named = xp.asarray(doing, dtype=xp.int32)
    return _begin(station, empty, _one_hot(xp, named, tasks), named)[0]


def legal(station: Station, state: State) -> Array:
    """`[2, T + 1]` bool, True where the action breaks no rule. Column 0, naming no task, is always
    legal.
    """
    xp = namespace(state.time)
    ready = ~_blocked(station, state)
    free = state.doing == 0
    tasks = (state.time > 0) & ready[None, :] & free[:, None]
    return xp.concatenate([xp.ones((2, 1), bool), tasks], axis=1)


def step(
    station: Station, rewards: Rewards, state: State, action: Array
) -> tuple[State, Array, Array, Info]:
    """One tick.

    1. Each agent's action is judged against the state before the tick. Naming a task while busy,
      one with an open dependency,
       one whose own time is 0: each broken rule costs `illegal`, and they add up. An agent that
       broke one names no task in this tick and its running task stands still; the other agent's
       does not. A free agent that names none pays `idle`.
    2. The running tasks of lawful agents come one tick closer to their end. One that reaches 0
      frees its agent and is cleared
       from the dependency matrix.
    3. When both still name the same task, the robot's action becomes 0, at no cost.
    4. Named tasks begin: the other agent's time for the task becomes 0 and the stress is paid.
    5. The assembly is done when all times are 0.

    Args:
      action: `[2]` int, 0 or a task's number, robot and human.

    Returns:
      the next state; reward `[2]` float32; done `[]` bool; `Info`.
    """
    xp = namespace(state.time)
    chosen = _one_hot(xp, action, state.ended.shape[0])
    busy, names = state.doing != 0, action != 0
    rules = (
        (busy & names).astype(xp.int32),
        xp.any(chosen & _blocked(station, state)[None, :], axis=1),
        names & ~xp.any(chosen & (state.time > 0), axis=1),
    )
    broken = rules[0] + rules[1] + rules[2]
    lawful = broken == 0
    idle = (~busy & ~names).astype(xp.int32)
    moved, finished = run(state, lawful.astype(xp.int32), xp.ones((), xp.int32))
    starts = chosen & lawful[:, None]
    starts = xp.stack([starts[ROBOT] & ~starts[HUMAN], starts[HUMAN]])
    after, paid = _begin(station, moved, starts, action)
    done = is_done(after)
    reward = (
        rewards.step
        + _fined(rewards.illegal, rules, broken)
        + rewards.idle * idle
        + rewards.task_done * (finished != 0)
        + rewards.all_done * done
        + rewards.stress_factor * paid
    )
    info = Info(
        started=xp.where(xp.any(starts, axis=1), action, 0).astype(xp.int32),
        finished=finished,
        finished_at=xp.where(finished != 0, after.clock, 0),
        illegal=broken,
        idle=idle,
        ticks=xp.ones((), xp.int32),
    )
    return after, reward.astype(xp.float32), done, info


def _fined(illegal: Array, rules: tuple[Array, Array, Array], broken: Array) -> Array:
    """`[2]`, what the broken rules cost: each alike, or each its own."""
    if isinstance(illegal, tuple):
        return illegal[0] * rules[0] + illegal[1] * rules[1] + illegal[2] * rules[2]
    return illegal * broken


def is_done(state: State) -> Array:
    """`[]` bool, True when the sum of all times is 0."""
    return ~namespace(state.time).any(state.time > 0)


def namespace(array: Array) -> Any:
    """The module (`numpy`, `jax.numpy`) that the array belongs to."""
    return array.__array_namespace__()


def _one_hot(xp: Any, numbers: Array, tasks: int) -> Array:
    """`[2, T]` bool from `[2]` task numbers."""
    return xp.arange(1, tasks + 1, dtype=numbers.dtype)[None, :] == numbers[:, None]


def _blocked(station: Station, state: State) -> Array:
    """`[T]` bool, True while something that the task needs has not ended."""
    return namespace(state.time).any(station.needs & ~state.ended[None, :], axis=1)


def run(state: State, ticks: Array, passed: Array) -> tuple[State, Array]:
    """Running tasks come `ticks` (`[2]`, at most what is left) closer to their end; the clock moves
    by `passed`.

    Returns the state and `[2]` int32, the numbers of the tasks that ended.
    """
    xp = namespace(state.time)
    running = _one_hot(xp, state.doing, state.ended.shape[0])
    time = state.time - running * ticks[:, None]
    ends = running & (time == 0)
    finished = xp.where(xp.any(ends, axis=1), state.doing, 0)
    moved = state._replace(
        time=time,
        doing=state.doing - finished,
        ended=state.ended | xp.any(ends, axis=0),
        clock=state.clock + passed,
    )
    return moved, finished


def _begin(station: Station, state: State, starts: Array, action: Array) -> tuple[State, Array]:
    """Agents begin the tasks of `starts` (`[2, T]` bool, at most one a row and a column).

    Returns the state and `[2]` float32: +e to the robot, -e to the human."""
    xp = namespace(state.time)
    loads = xp.sum(starts * station.stress[None, :], axis=1)
    begun = state._replace(
        time=xp.where(starts[::-1], 0, state.time),
        doing=xp.where(xp.any(starts, axis=1), action, state.doing).astype(xp.int32),
        stress=state.stress + loads[HUMAN],
    )
    return begun, xp.stack([loads[ROBOT], -loads[HUMAN]])
