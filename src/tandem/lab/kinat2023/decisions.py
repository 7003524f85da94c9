"""The same station by decisions: between two of them the world runs on by itself. Ours, not the
thesis's.

Someone decides when an agent is free and a task is legal for it. Waiting lasts until the next task
ends. Nothing but time is skipped: the rewards of a decision are those of its ticks, added up, so a
return here is the return of the same actions, padded with waiting, in `world.step`.

When both decide at once the human names first and the robot sees what is left (`after_human`); the
thesis's "the robot yields" then costs no tick. Both waiting while nobody works would never end, so
the masks leave it out: the human may wait when the robot is busy or has a task to begin; the robot
may wait when the human is busy or has just named a task. An agent that has nothing to decide has
exactly one legal action, 0; so no mask is ever all False.
"""

from __future__ import annotations

from tandem.lab.kinat2023.world import (
    HUMAN,
    ROBOT,
    Array,
    Info,
    Rewards,
    State,
    Station,
    is_done,
    legal,
    namespace,
    run,
    step,
)


def deciding(station: Station, state: State) -> Array:
    """`[2]` bool, True where the agent is free and at least one task is legal for it."""
    return namespace(state.time).any(legal(station, state)[:, 1:], axis=1)


def choices(station: Station, state: State) -> Array:
    """`[2, T + 1]` bool, True where the agent may choose the action, before either has chosen.
    Column 0 is waiting.

    The robot's row holds whatever the human will choose; narrow it with `after_human` once that is
    known.
    """
    xp = namespace(state.time)
    tasks = legal(station, state)[:, 1:]
    some = xp.any(tasks, axis=1)
    waits = ~some | (state.doing != 0)[::-1] | some[::-1]
    return xp.concatenate([waits[:, None], tasks], axis=1)


def after_human(state: State, mask: Array, human: Array) -> Array:
    """`[T + 1]` bool: the robot's row of `mask = choices(station, state)` once the human has chosen
    action `human` (`[]` int).
    """
    xp = namespace(state.time)
    numbers = xp.arange(1, mask.shape[1])
    tasks = mask[ROBOT, 1:] & (numbers != human)
    waits = ~xp.any(tasks) | (state.doing[HUMAN] != 0) | (human != 0)
    return xp.concatenate([waits[None], tasks])


def decide_step(
    station: Station, rewards: Rewards, state: State, action: Array
) -> tuple[State, Array, Array, Info]:
    """One decision: the tick in which `action` (`[2]` int) is taken, then ticks of waiting until a
    task has ended and someone decides.

    Any action is accepted; an illegal one is punished as in `world.step` and then waited upon like
    a wait. When nobody works and nothing was begun, only the one tick passes.

    Returns:
      the state at the next decision or at the end; reward `[2]` float32, the sum over the ticks;
      done `[]` bool; `Info` of these ticks (an agent begins at most one task in them and ends at
      most one).
    """
    xp = namespace(state.time)
    state, reward, done, info = step(station, rewards, state, action)
    event = xp.any(info.finished != 0)
    # the tick and two ends: then both agents are free, and somebody decides or all is done
    for _ in range(2):
        state, reward, done, info, event = _wait(station, rewards, state, reward, done, info, event)
    return state, reward, done, info


def _wait(
    station: Station,
    rewards: Rewards,
    state: State,
    reward: Array,
    done: Array,
    info: Info,
    event: Array,
) -> tuple[State, Array, Array, Info, Array]:
    """The ticks until the next task ends, in one stride; none when somebody decides or nobody
    works.
    """
    xp = namespace(state.time)
    busy = state.doing != 0
    here = event & xp.any(deciding(station, state))
    in_hand = xp.arange(1, state.ended.shape[0] + 1)[None, :] == state.doing[:, None]
    left = xp.sum(state.time * in_hand, axis=1)
    until = xp.where(busy[ROBOT] & busy[HUMAN], xp.min(left), xp.max(left))
    ticks = xp.where(done | here, 0, until).astype(xp.int32)
    moved, finished = run(state, ticks * busy, ticks)
    now_done = is_done(moved)
    idle = ticks * ~busy
    paid = (
        rewards.step * ticks
        + rewards.idle * idle
        + rewards.task_done * (finished != 0)
        + rewards.all_done * (now_done & ~done)
    )
    ended = finished != 0
    info = info._replace(
        finished=xp.where(ended, finished, info.finished),
        finished_at=xp.where(ended, moved.clock, info.finished_at),
        idle=info.idle + idle,
        ticks=info.ticks + ticks,
    )
    return moved, (reward + paid).astype(xp.float32), now_done, info, event | xp.any(ended)
