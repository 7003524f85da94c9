"""Robot and human at work, decision by decision, on top of the event world (`world/state.py`):
choices, cost, fatigue, noise, a change.

At one moment the human names a choice first and the robot sees it (`narrow`). A joint operation
begins when both name it; the robot can name one only after the human has. Who waits, waits until
the next event. Between two decisions time runs on by itself; a way that is begun takes up its tool
first. Nothing here draws a random number: chance comes in through `reset`.

Source: Zhang et al. (2022), RCIM 73, 102227, as far as it is public: a bill-of-materials vector as
state, cooperation (each its own operation) and collaboration (one operation by both), tools with
handling time, a reward from time and a difficulty per operation and operator, human fatigue. The
numbers and the order of naming are ASSUMPTIONS.

Pure functions over an array namespace. Axes as in `setting.py`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from tandem.lab.zhang2022.change import Change, Happened, happen, nothing_yet
from tandem.lab.zhang2022.setting import HUMAN, RECOVERY, ROBOT, Duo, Setting
from tandem.world import state as events
from tandem.world.arrays import NEVER, Array, Arrays, namespace
from tandem.world.state import State as Assembly


class State(NamedTuple):
    """Work under way.

    assembly: the event world's state.
    fatigue: `[]` float32 in 0..1, the human's.
    pace: `[T]` float32, the human's real time for the task as a share of the nominal one.
    change: what will happen and when. happened: what has.
    """

    assembly: Assembly
    fatigue: Array
    pace: Array
    change: Change
    happened: Happened


class Paid(NamedTuple):
    """What a step cost. seconds: `[]`. difficulty: `[2]`, of what each agent has begun. fatigue:
    `[]`, seconds at full fatigue.
    """

    seconds: Array
    difficulty: Array
    fatigue: Array


def reset(duo: Duo, pace: Array, change: Change) -> State:
    """Before anything has begun; `pace` and `change` as in `State`."""
    xp = namespace(duo.row)
    return State(events.reset(duo.arrays), xp.zeros((), xp.float32), pace, change, nothing_yet(duo))


def choices(duo: Duo, state: State) -> Array:
    """`[2, K]` bool, True where the agent may choose it before the other has chosen. Column 0 is
    waiting.

    The robot's row holds what some choice of the human leaves it; `narrow` says what is left of it
    by that choice.
    """
    xp, arrays = namespace(duo.row), now(duo, state)
    ways = events.legal(arrays, state.assembly)
    mine = xp.any(duo.pick & ways[None, None, :], axis=2)
    alone = xp.any(ways & ~duo.joint & arrays.way_uses[:, duo.row[ROBOT]])
    some = xp.any(ways)
    goes_on = (_next(duo, state) < NEVER) | ~some
    # The human may leave the beginning to the robot, but not when nothing would then ever begin.
    waits = xp.stack([xp.ones((), bool), goes_on | alone])
    return xp.concatenate([waits[:, None], mine[:, 1:]], axis=1)


def narrow(duo: Duo, state: State, legal: Array, human: Array) -> Array:
    """`[K]` bool: the robot's row of `legal = choices(duo, state)` once the human has chosen
    `human` (`[]` int).
    """
    xp = namespace(duo.row)
    named = xp.any(duo.pick[HUMAN] & (xp.arange(duo.pick.shape[1]) == human)[:, None], axis=0)
    together = xp.any(named & duo.joint)
    fits = ~xp.any(duo.clash & named[None, :], axis=1) & ~duo.joint
    own = xp.any(duo.pick[ROBOT] & xp.where(together, named, fits)[None, :], axis=1) & legal[ROBOT]
    goes_on = (_next(duo, state) < NEVER) | xp.any(named)
    waits = ~together & (goes_on | ~xp.any(own[1:]))
    return xp.concatenate([waits[None], own[1:]])


def step(duo: Duo, setting: Setting, state: State, action: Array) -> tuple[State, Paid]:
    """Both begin what they chose, and time runs on until somebody can choose again or all is done.

    Args:
      action: `[2]` int, choices of robot and human that `choices` and `narrow` allow.
    """
    xp = namespace(duo.row)
    numbers = xp.arange(duo.pick.shape[1])
    named = [
        xp.any(duo.pick[agent] & (numbers == action[agent])[:, None], axis=0)
        for agent in (ROBOT, HUMAN)
    ]
    difficulty = xp.sum(xp.where((named[ROBOT] | named[HUMAN])[:, None], duo.difficulty, 0), axis=0)
    alone = named[ROBOT] & ~duo.joint
    for way in (named[HUMAN], alone):
        state = _begin(duo, setting, state, way)
    seconds = tired = xp.zeros((), xp.float32)
    state, seconds, tired = _run(duo, setting, state, xp.ones((), bool))
    # the end of one task may let nobody begin: then the other's end, a missing tool's return
    for _ in range(2):
        stuck = ~xp.any(events.legal(now(duo, state), state.assembly)) & ~is_done(state)
        state, more, weary = _run(duo, setting, state, stuck)
        seconds, tired = seconds + more, tired + weary
    return state, Paid(seconds, difficulty, tired)


def is_done(state: State) -> Array:
    """`[]` bool, every task has been done."""
    return events.is_done(state.assembly)


def cost(setting: Setting, paid: Paid) -> Array:
    """`[2]`, what robot and human pay: half of the time and of the fatigue each, and the difficulty
    of what they have begun.
    """
    shared = (setting.time * paid.seconds + setting.fatigue * paid.fatigue) / 2
    return shared + setting.difficulty * paid.difficulty


def observe(duo: Duo, state: State) -> Array:
    """`[D]` float32 in 0..1, the bill of materials and what else there is to know; both agents see
    the same.

    In this order: tasks done; tasks in hand; what is left of those by their nominal times; per
    agent, what is left until it is free; per agent, the tool in hand (first column: none yet); ways
    that were lost; tools, how long they will still be missing; the human's fatigue. Times are
    divided by the longest way's.
    """
    xp, arrays, assembly = namespace(duo.row), duo.arrays, state.assembly
    clock, longest = assembly.clock, xp.max(arrays.way_ticks)
    up = events.mounted(assembly)
    running = (assembly.way >= 0) & ~up
    in_use = xp.arange(arrays.way_ticks.shape[0])[:, None] == assembly.way[None, :]
    nominal = xp.sum(xp.where(in_use, arrays.way_ticks[:, None], 0), axis=0)
    # An end that is still to come is not known: the nominal one is, and who is late is nearly done.
    left = xp.where(
        running, xp.maximum(xp.where(running, assembly.start_at, 0) + nominal - clock, 0), 0
    )
    uses = xp.any((in_use & running[None, :])[:, :, None] & arrays.way_uses[:, None, :], axis=0)
    until_free = xp.max(xp.where(uses, left[:, None], 0), axis=0)[duo.row]
    tools = xp.arange(-1, arrays.tool_places.shape[0])
    hand = assembly.in_hand[duo.row][:, None] == tools[None, :]
    missing = xp.maximum(state.happened.back_at - clock, 0)
    parts = [
        up,
        running,
        left / longest,
        until_free / longest,
        hand,
        assembly.refused,
        missing / longest,
        state.fatigue,
    ]
    return xp.concatenate([xp.ravel(part).astype(xp.float32) for part in parts])


def observation_size(duo: Duo) -> int:
    """`D`."""
    tasks, tools, ways = (
        duo.arrays.release.shape[-1],
        duo.arrays.tool_places.shape[-1],
        duo.arrays.way_ticks.shape[-1],
    )
    return 3 * tasks + 2 + 2 * (tools + 1) + ways + tools + 1


def now(duo: Duo, state: State) -> Arrays:
    """The cell's arrays as things stand: tasks whose tool is missing are released when it is
    back.
    """
    xp, arrays = namespace(duo.row), duo.arrays
    if not arrays.tool_places.shape[0]:
        return arrays
    back = xp.max(xp.where(duo.of_tool, state.happened.back_at[None, :], 0), axis=1)
    return arrays._replace(release=xp.maximum(arrays.release, back))


def _next(duo: Duo, state: State) -> Array:
    return events.next_event(now(duo, state), state.assembly)


def _begin(duo: Duo, setting: Setting, state: State, way: Array) -> State:
    """The way (`[W]` bool, at most one) begins; the human's real time for it counts."""
    xp, arrays = namespace(duo.row), now(duo, state)
    human = xp.any(way & arrays.way_uses[:, duo.row[HUMAN]])
    nominal = xp.sum(xp.where(way, arrays.way_ticks, 0))
    pace = xp.sum(xp.where(xp.any(arrays.of_task & way[:, None], axis=0), state.pace, 0)) * (
        1 + setting.slows * state.fatigue
    )
    ticks = xp.where(human, xp.maximum(xp.rint(nominal * pace), 1), nominal).astype(xp.int32)
    number = xp.where(xp.any(way), xp.argmax(way), -1).astype(xp.int32)
    return state._replace(assembly=events.assign(arrays, state.assembly, number, ticks))


def _run(duo: Duo, setting: Setting, state: State, goes: Array) -> tuple[State, Array, Array]:
    """Time runs to the next event or to the change, where `goes`; and how long that took, seconds,
    and seconds at full fatigue.
    """
    xp, before = namespace(duo.row), state.assembly
    moved = events.advance(
        now(duo, state),
        before,
        xp.where(state.change.at > before.clock, state.change.at, NEVER).astype(xp.int32),
    )
    moved = moved._replace(
        **{
            name: xp.where(goes, getattr(moved, name), getattr(before, name))
            for name in ("clock", "waits")
        }
    )
    seconds = ((moved.clock - before.clock) * duo.tick).astype(xp.float32)
    in_hand = (before.way[None, :] == xp.arange(duo.tiring.shape[0])[:, None]) & (
        before.end_at > before.clock
    )[None, :]
    rate = xp.sum(xp.where(xp.any(in_hand, axis=1), duo.tiring, 0)) * setting.tires
    fatigue = tired(state.fatigue, rate, setting.rests * RECOVERY / 60, seconds)
    weary = seconds * (state.fatigue + fatigue) / 2
    due = goes & (state.change.at == moved.clock) & (moved.clock > before.clock)
    changed, happened = happen(
        duo, moved, state.change, xp.rint(setting.search / duo.tick).astype(xp.int32)
    )
    pick = lambda new, old: type(old)(*[xp.where(due, a, b) for a, b in zip(new, old, strict=True)])  # noqa: E731
    return (
        state._replace(
            assembly=pick(changed, moved), happened=pick(happened, state.happened), fatigue=fatigue
        ),
        seconds,
        weary,
    )


def tired(fatigue: Array, rate: Array, recovery: Array, seconds: Array) -> Array:
    """Fatigue after so many seconds of work at `rate` per second (0: of rest, at `recovery` per
    second).

        work: F + (1 - F) (1 - exp(-rate t)),     rest: F exp(-recovery t)

    Source: the form that Xue et al. publish with their code; Zhang et al.'s own function is not
    public.
    """
    xp = namespace(fatigue)
    worked = fatigue + (1 - fatigue) * (1 - xp.exp(-rate * seconds))
    return xp.where(rate > 0, worked, fatigue * xp.exp(-recovery * seconds)).astype(xp.float32)


def chance(numbers: dict[str, Any], duo: Duo, setting: Setting) -> tuple[Array, Change]:
    """`pace` and `change` of an episode from plain random numbers: `normal` `[T]`, `uniform` `[4]`
    in [0, 1).

    The human's times are log-normal with mean 1 and `setting.spread` as coefficient of variation.
    """
    normal, uniform = numbers["normal"], numbers["uniform"]
    xp = namespace(normal)
    variance = xp.log1p(setting.spread**2)
    pace = xp.exp(xp.sqrt(variance) * normal - variance / 2).astype(xp.float32)
    share = setting.early + (setting.late - setting.early) * uniform[1]
    at = xp.maximum(xp.rint(share * duo.work / duo.tick), 1).astype(xp.int32)
    return pace, Change(
        xp.where(uniform[0] < setting.change, at, NEVER).astype(xp.int32), uniform[2], uniform[3]
    )
