"""What the agents see: the thesis's observation, and one that a network finds easier."""

from __future__ import annotations

from tandem.lab.kinat2023.world import HUMAN, ROBOT, Array, State, Station, namespace


def observe(station: Station, state: State) -> Array:
    """`[2, 2 + 3 T + T T]` float32, the thesis's observation as it is; both agents see the same.

    In this order: task numbers that robot and human are doing; the robot's times, the human's
    times; the ergonomic values; the open dependencies, row by row (row i = what task i still
    needs).

    Source: Kinat (2023), chapter 5. The order of the parts is ours (a network does not care).
    """
    xp = namespace(state.time)
    parts = [
        state.doing,
        state.time[ROBOT],
        state.time[HUMAN],
        station.stress,
        _open_needs(station, state),
    ]
    flat = xp.concatenate([xp.ravel(part).astype(xp.float32) for part in parts])
    return xp.stack([flat, flat])


def observe_scaled(station: Station, state: State) -> Array:
    """`[2, 2 + 3 T + T T]` float32: `observe` with every part divided by the largest value it can
    take, so that all lie in 0..1.
    """
    xp = namespace(state.time)
    tasks, longest, hardest = (
        state.ended.shape[0],
        xp.max(station.time),
        _not_zero(xp.max(station.stress)),
    )
    parts = [
        state.doing / tasks,
        state.time[ROBOT] / longest,
        state.time[HUMAN] / longest,
        station.stress / hardest,
        _open_needs(station, state),
    ]
    flat = xp.concatenate([xp.ravel(part).astype(xp.float32) for part in parts])
    return xp.stack([flat, flat])


LONGEST_TIME_S, MOST_STRESS = 3600, 100
"""The bounds that the thesis declares for its channels of times and of stress."""


def observe_bounded(station: Station, state: State) -> Array:
    """`[2, 2 + 3 T + T T]` float32: `observe` with times divided by 3600, stress by 100 and task
    numbers by the number of tasks: the bounds that the thesis declares, whatever the cell.
    """
    xp = namespace(state.time)
    parts = [
        state.doing / state.ended.shape[0],
        state.time[ROBOT] / LONGEST_TIME_S,
        state.time[HUMAN] / LONGEST_TIME_S,
        station.stress / MOST_STRESS,
        _open_needs(station, state),
    ]
    flat = xp.concatenate([xp.ravel(part).astype(xp.float32) for part in parts])
    return xp.stack([flat, flat])


def observe_normalised(station: Station, state: State) -> Array:
    """`[2, 6 T + 4 + T T]` float32 in 0..1, each agent sees itself first: our own recipe's
    observation.

    In this order: 1 for the human, 0 for the robot; own task and the other's as one-hot of T + 1;
    own times and the other's, divided by the longest; stress of each task, divided by the largest;
    ended tasks; the human's stress so far, divided by the sum over all tasks; open dependencies,
    row by row.
    """
    xp = namespace(state.time)
    doing = xp.arange(state.ended.shape[0] + 1)[None, :] == state.doing[:, None]
    time = state.time / xp.max(station.time)
    shared = [
        station.stress / _not_zero(xp.max(station.stress)),
        state.ended,
        state.stress / _not_zero(xp.sum(station.stress)),
        _open_needs(station, state),
    ]

    def seen_by(agent: int, other: int) -> Array:
        own = [xp.asarray(agent), doing[agent], doing[other], time[agent], time[other]]
        return xp.concatenate([xp.ravel(part).astype(xp.float32) for part in own + shared])

    return xp.stack([seen_by(ROBOT, HUMAN), seen_by(HUMAN, ROBOT)])


def _open_needs(station: Station, state: State) -> Array:
    return station.needs & ~state.ended[None, :]


def _not_zero(value: Array) -> Array:
    """1 instead of 0, so that a cell without stress divides by something."""
    return value + (value == 0)
