"""An assembly under way, event by event: what is legal, how work begins, how time runs on. One
cell; `vmap` adds the batch.

Pure functions over an array namespace: NumPy arrays in, NumPy arrays out; under `jax.jit` and
`jax.vmap` the same lines are traced. None draws a random number: what chance brings
(`randomness.py`) comes in as arguments. Every rule is the checker's (`schedule/checker.py`) to the
letter, so that a sound schedule replays to exactly its makespan and legal play makes sound
schedules:

- A way may begin when the tasks before it have ended, its waits after other tasks have lasted as
  long as they must at least, its release has come, all its operators are free, its tools and its
  zone have room, nobody is in the zone whom it keeps apart from them, and no machine of theirs
  holds a part to which the task does not belong.
- Whoever stands at another place must walk there, and whoever holds another tool must take up the
  right one, first. An operator who was idle has used that time for it: the task starts at the later
  of the clock and, for each operator, the end of its last work or break plus the way and the
  changeover.
- No break may lie between the beginning of a walk or a changeover and the nominal end of the task.
- Limits of people, `same_operator` and `stress_of_set` rule out what would break them now or, as
  far as the least of the tasks that are left tells, later. Deadlines, and what a wait may last
  at most, rule out nothing; `late` reports them.

At one moment the humans decide first, then the robots (`turn`); each sees what has begun before it.
Who lets a turn pass waits until the next event.

Axes as in `arrays.py`: `T` tasks, `W` ways, `O` operators. `L` waits, `M` is `T` when somebody may
make mistakes, else 0.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from tandem.world.arrays import NEVER, Array, Arrays, namespace


class State(NamedTuple):
    """An assembly under way. Ticks; NEVER for what has not come and is not due.

    clock: `[]` int32.
    way: `[T]` int32, the way in which the task is or was done, -1 while it is open.
    start_at, end_at: `[T]` int32, of the work in hand or done; walks and changeovers come before
    `start_at`.
    The deciders must not look at an `end_at` that
      is still to come: it is what really will be.
    free_at: `[O]` int32, the operator works until then.
    away_until: `[O]` int32, it is not there until then: broken down, or called away.
    waits: `[O]` bool, it has let its turn pass until the next event.
    in_hand: `[O]` int32, the tool in hand; -1 while the first one costs nothing.
    stands: `[O]` int32, the place where it stands; -1 while the way to the first one costs nothing.
    load: `[O]` int32, units of stress of what it has begun.
    refused: `[W]` bool, somebody who takes part will not do it.
    bad_at: `[M]` int32, when it is noticed that the task was done wrongly; NEVER while it is right.
    undoing: `[M]` bool, the work in hand is the task's disassembly.
    tries: `[M]` int32, how often the task was undone, or another one begun in its place by mistake.
    """

    clock: Array
    way: Array
    start_at: Array
    end_at: Array
    free_at: Array
    away_until: Array
    waits: Array
    in_hand: Array
    stands: Array
    load: Array
    refused: Array
    bad_at: Array
    undoing: Array
    tries: Array


def reset(arrays: Arrays) -> State:
    """The assembly before anything has begun, at clock 0."""
    xp = namespace(arrays.way_ticks)
    tasks, operators = arrays.release.shape[0], arrays.human.shape[0]
    mistakes = arrays.above.shape[0]
    return State(
        clock=xp.zeros((), xp.int32),
        way=xp.full(tasks, -1, xp.int32),
        start_at=xp.full(tasks, NEVER, xp.int32),
        end_at=xp.full(tasks, NEVER, xp.int32),
        free_at=xp.zeros(operators, xp.int32),
        away_until=xp.zeros(operators, xp.int32),
        waits=xp.zeros(operators, bool),
        in_hand=arrays.in_hand,
        stands=arrays.stands,
        load=xp.zeros(operators, xp.int32),
        refused=xp.zeros(arrays.way_ticks.shape[0], bool),
        bad_at=xp.full(mistakes, NEVER, xp.int32),
        undoing=xp.zeros(mistakes, bool),
        tries=xp.zeros(mistakes, xp.int32),
    )


def mounted(state: State) -> Array:
    """`[T]` bool, the task has been done, rightly or not, and stands so."""
    return (state.way >= 0) & (state.end_at <= state.clock)


def to_undo(arrays: Arrays, state: State) -> Array:
    """`[M]` bool, the task is mounted and has to come off again: it was done wrongly and that is
    known, or it stands on such a one.
    """
    up = mounted(state)
    bad = up & (state.bad_at <= state.clock)
    return bad | (up & (arrays.above & bad[None, :]).any(axis=1))


def legal(arrays: Arrays, state: State) -> Array:
    """`[W]` bool, True where the way may begin now. Of a task that has to come off, its ways mean
    its disassembly.
    """
    return _fitting(arrays, state, _ready(namespace(state.way), arrays, state))


def out_of_order(arrays: Arrays, state: State) -> Array:
    """`[W]` bool, True where someone could begin the way by mistake: all is as `legal` wants it,
    but a task before it is missing.
    """
    premature = (
        (state.way < 0)
        & (arrays.release <= state.clock)
        & (arrays.needs & ~mounted(state)[None, :]).any(axis=1)
    )
    return _fitting(arrays, state, premature)


def legal_of(arrays: Arrays, mask: Array, operator: Array) -> Array:
    """`[W]` bool, of the legal ways `mask` those in which the operator (`[]` int) takes part."""
    xp = namespace(mask)
    return mask & (arrays.way_uses & (xp.arange(arrays.human.shape[0]) == operator)[None, :]).any(
        axis=1
    )


def turn(arrays: Arrays, mask: Array) -> Array:
    """`[]` int32, whose turn it is: of those who take part in a legal way of `mask` the first to
    decide; -1 when time has to run on.
    """
    xp = namespace(mask)
    able = (arrays.way_uses & mask[:, None]).any(axis=0)
    rank = xp.where(able, arrays.rank, NEVER)
    return xp.where(able.any(), xp.argmin(rank), -1).astype(xp.int32)


def may_wait(arrays: Arrays, state: State, mask: Array, operator: Array) -> Array:
    """`[]` bool, the operator may let its turn pass: something is still to happen, or another one
    can begin something without it.
    """
    return (next_event(arrays, state) < NEVER) | (mask & ~legal_of(arrays, mask, operator)).any()


def starts(arrays: Arrays, state: State) -> Array:
    """`[W]` int32, the tick at which each way would start if it were begun now: the clock, or later
    when somebody must walk there or take up a tool first.
    """
    xp = namespace(state.way)
    before = _preparations(xp, arrays, state)
    if before is None:
        return xp.broadcast_to(state.clock, arrays.way_ticks.shape)
    since = xp.where(arrays.way_uses, _since(xp, arrays, state)[None, :] + before, 0)
    return xp.maximum(state.clock, since.max(axis=1))


def nominal(arrays: Arrays, state: State) -> Array:
    """`[W]` int32, ticks that each way would nominally take: its own duration, or that of the
    disassembly.
    """
    if not arrays.undo.shape[0]:
        return arrays.way_ticks
    xp = namespace(state.way)
    return xp.where(_for_tasks(xp, arrays, mounted(state)), arrays.undo, arrays.way_ticks)


def assign(
    arrays: Arrays,
    state: State,
    way: Array,
    ticks: Array | None = None,
    noticed: Array | None = None,
) -> State:
    """The way begins now, after what walks and changeovers need. Assumes
    `legal(arrays, state)[way]`; a `way` of -1 changes nothing.

    Args:
      way: `[]` int.
      ticks: `[]` int, how long it really takes; the nominal duration when absent.
      noticed: `[]` int, when it is done wrongly: ticks from its end until that is noticed; NEVER or
        None when it is done right.
    """
    xp = namespace(state.way)
    chosen = xp.arange(arrays.way_ticks.shape[0], dtype=xp.int32) == way
    task = (arrays.of_task & chosen[:, None]).any(axis=0)
    who = (arrays.way_uses & chosen[:, None]).any(axis=0)
    # idle time before counts for walk and changeover, so the start may already lie at the clock
    start = _at(xp, starts(arrays, state), chosen)
    end = start + (_at(xp, nominal(arrays, state), chosen) if ticks is None else ticks)
    after = state._replace(
        way=xp.where(task, way, state.way).astype(xp.int32),
        start_at=xp.where(task, start, state.start_at).astype(xp.int32),
        end_at=xp.where(task, end, state.end_at).astype(xp.int32),
        free_at=xp.where(who, end, state.free_at).astype(xp.int32),
        load=state.load + xp.where(chosen[:, None], arrays.way_load, 0).sum(axis=0, dtype=xp.int32),
    )
    # without tools these arrays have length 0, and nothing is to be written
    if arrays.swap.shape[0]:
        tool = xp.where(chosen[:, None], arrays.way_tool + 1, 0).sum(axis=0, dtype=xp.int32) - 1
        after = after._replace(in_hand=xp.where(tool >= 0, tool, state.in_hand))
    if arrays.place.shape[0]:
        place = _at(xp, arrays.place + 1, task) - 1
        after = after._replace(stands=xp.where(who & (place >= 0), place, state.stands))
    # beginning a task that is mounted takes it apart; whether it was wrong then stays as it is
    if arrays.undo.shape[0]:
        comes_off = task & mounted(state)
        bad_at = (
            NEVER if noticed is None else xp.where(noticed >= NEVER - end, NEVER, end + noticed)
        )
        after = after._replace(
            undoing=state.undoing | comes_off,
            bad_at=xp.where(task & ~comes_off, bad_at, state.bad_at).astype(xp.int32),
        )
    return after


def wait(state: State, operator: Array) -> State:
    """The operator (`[]` int; -1 for nobody) lets its turn pass until the next event."""
    xp = namespace(state.way)
    return state._replace(waits=state.waits | (xp.arange(state.waits.shape[0]) == operator))


def refuse(arrays: Arrays, state: State, operator: Array, task: Array) -> State:
    """The operator (`[]` int) will not take part in the task (`[]` int) any more."""
    xp = namespace(state.way)
    mine = (arrays.way_uses & (xp.arange(arrays.human.shape[0]) == operator)[None, :]).any(axis=1)
    return state._replace(refused=state.refused | (mine & (arrays.way_task == task)))


def next_event(arrays: Arrays, state: State) -> Array:
    """`[]` int32, the next tick at which something happens by itself: work ends, a task is
    released, a wait has lasted long enough, a break ends, somebody comes back, a mistake is
    noticed. NEVER when nothing does.
    """
    xp = namespace(state.way)
    moments = [
        state.end_at,
        xp.where(state.way < 0, arrays.release, NEVER),
        state.away_until,
        arrays.break_to.reshape(-1),
    ]
    if arrays.undo.shape[0]:
        moments.append(state.bad_at)
    if arrays.lag_least.shape[0]:
        waiting = (arrays.lag_task & (state.way < 0)[None, :]).any(axis=1)
        moments.append(xp.where(waiting, _waits_over(xp, arrays, state), NEVER))
    ahead = xp.concatenate(moments)
    return xp.where(ahead > state.clock, ahead, NEVER).min().astype(xp.int32)


def advance(arrays: Arrays, state: State, until: Array | None = None) -> State:
    """Time runs to the next event, or to `until` (`[]` int) should that come sooner; nothing moves
    when there is neither. Everybody is asked again.

    A disassembly that has ended leaves its task open. When all stands, what was done wrongly is
    noticed at the latest.
    """
    xp = namespace(state.way)
    event = next_event(arrays, state)
    event = event if until is None else xp.minimum(event, until)
    clock = xp.where(event == NEVER, state.clock, event).astype(xp.int32)
    moved = state._replace(clock=clock, waits=xp.zeros_like(state.waits))
    return _settled(xp, moved) if arrays.undo.shape[0] else moved


def is_done(state: State) -> Array:
    """`[]` bool, every task has been done, and rightly."""
    stands = mounted(state)
    return (
        stands & (state.bad_at == NEVER) & ~state.undoing if state.bad_at.shape[0] else stands
    ).all()


def is_stuck(arrays: Arrays, state: State, mask: Array) -> Array:
    """`[]` bool, no way is legal (`mask` `[W]`), nothing will happen, and not all is done: limits
    were spent so that none is left to go on.
    """
    return ~mask.any() & ~state.waits.any() & (next_event(arrays, state) == NEVER) & ~is_done(state)


def makespan(state: State) -> Array:
    """`[]` int32, the latest end of what has begun; 0 before that."""
    xp = namespace(state.way)
    return xp.where(state.way >= 0, state.end_at, 0).max()


def stress(arrays: Arrays, state: State) -> Array:
    """`[]` int32, units of stress of what has begun; by `stress_of_set`, the least of the listed
    sets that are still possible.
    """
    xp = namespace(state.way)
    if not arrays.sets.shape[0]:
        return state.load.sum(dtype=xp.int32)
    return xp.where(_possible_sets(xp, arrays, state), arrays.set_stress, NEVER).min()


def late(arrays: Arrays, state: State) -> Array:
    """`[T]` int32, ticks by which the task ends after its deadline, or starts after the most that
    it should have waited for another one, whichever is more; 0 while it has not begun.
    """
    xp = namespace(state.way)
    late = xp.maximum(xp.where(state.way >= 0, state.end_at, 0) - arrays.deadline, 0)
    if not arrays.lag_most.shape[0]:
        return late
    since = _waited_from(xp, arrays, state)
    start = xp.where(arrays.lag_task & (state.way >= 0)[None, :], state.start_at[None, :], 0)
    past = xp.where(since == NEVER, 0, start.max(axis=1) - since)
    over = xp.maximum(xp.where(arrays.lag_most == NEVER, 0, past - arrays.lag_most), 0)
    return xp.maximum(late, xp.where(arrays.lag_task, over[:, None], 0).max(axis=0))


def _waited_from(xp: Any, arrays: Arrays, state: State) -> Array:
    """`[L]` int32, the tick from which each wait counts; NEVER while it has not come."""
    begun = state.way >= 0
    if arrays.undo.shape[0]:
        begun = begun & ~state.undoing
    ended = begun & (state.end_at <= state.clock)
    start = xp.where(arrays.lag_before & begun[None, :], state.start_at[None, :], NEVER)
    end = xp.where(arrays.lag_before & ended[None, :], state.end_at[None, :], NEVER)
    return xp.where(arrays.lag_from_start, start.min(axis=1), end.min(axis=1))


def _waits_over(xp: Any, arrays: Arrays, state: State) -> Array:
    """`[L]` int32, the tick at which each wait has lasted as long as it must; NEVER while what it
    counts from has not come.
    """
    since = _waited_from(xp, arrays, state)
    return xp.where(since == NEVER, NEVER, xp.where(since == NEVER, 0, since) + arrays.lag_least)


def _fitting(arrays: Arrays, state: State, tasks: Array) -> Array:
    """`[W]` bool, of the ways of these tasks (`[T]` bool) those that break no rule but those about
    other tasks.
    """
    xp = namespace(state.way)
    fitting = arrays.way_open & ~state.refused & _for_tasks(xp, arrays, tasks)
    free = (state.free_at <= state.clock) & (state.away_until <= state.clock) & ~state.waits
    fitting = fitting & ~(arrays.way_uses & ~free[None, :]).any(axis=1)
    for rule in (
        _has_room,
        _is_kept_apart,
        _is_held_by_no_machine,
        _is_clear_of_breaks,
        _keeps_limits,
        _stays_with_its_team,
        _leaves_a_listed_set,
    ):
        found = rule(xp, arrays, state)
        fitting = fitting if found is None else fitting & found
    return fitting


def _ready(xp: Any, arrays: Arrays, state: State) -> Array:
    """`[T]` bool, work on the task may begin as far as other tasks and its release are concerned.

    What has to come off does so from the top; and nothing is begun below a task that is in hand or
    has to come off.
    """
    up = mounted(state)
    is_open = (state.way < 0) & (arrays.release <= state.clock)
    if arrays.lag_least.shape[0]:
        waits = _waits_over(xp, arrays, state) > state.clock
        is_open = is_open & ~(arrays.lag_task & waits[:, None]).any(axis=0)
    if not arrays.undo.shape[0]:
        return is_open & ~(arrays.needs & ~up[None, :]).any(axis=1)
    down, begun = to_undo(arrays, state), state.way >= 0
    in_the_way = (down | (begun & ~up))[:, None] | (begun[:, None] & down[None, :])
    return ((is_open & ~(arrays.needs & ~(up & ~down)[None, :]).any(axis=1)) | down) & ~(
        arrays.above & in_the_way
    ).any(axis=0)


def _for_tasks(xp: Any, arrays: Arrays, tasks: Array) -> Array:
    """`[W]` bool, the ways of these tasks (`[T]` bool)."""
    return (arrays.of_task & tasks[None, :]).any(axis=1)


def _at(xp: Any, numbers: Array, chosen: Array) -> Array:
    """`[]`, the number where `chosen` is True; 0 when it is nowhere."""
    return xp.where(chosen, numbers, 0).sum(dtype=xp.int32)


def _since(xp: Any, arrays: Arrays, state: State) -> Array:
    """`[O]` int32, since when the operator could have got ready for its next work: the end of its
    work and of its last break; of a machine also when the part came out that it held.
    """
    over = xp.where(arrays.break_to <= state.clock, arrays.break_to, 0)
    rested = xp.maximum(state.free_at, over.max(axis=1)) if over.shape[1] else state.free_at
    if arrays.holds.shape[0]:
        last = arrays.holds[:, 1]
        out = xp.where(mounted(state)[last], state.end_at[last], 0)
        rested = xp.maximum(rested, xp.where(arrays.hold_of, out[:, None], 0).max(axis=0))
    return xp.maximum(rested, state.away_until)


def _preparations(xp: Any, arrays: Arrays, state: State) -> Array | None:
    """`[W, O]` int32, ticks that the operator needs to be ready for the way: to walk there and to
    take up its tool. None when nobody ever needs any.
    """
    found = None
    if arrays.swap.shape[0]:
        other = (state.in_hand[None, :] >= 0) & (state.in_hand[None, :] != arrays.way_tool)
        found = xp.where(other, arrays.swap, 0)
    if arrays.place.shape[0]:
        # `[O, P]`, from where it stands to each place
        places = xp.arange(arrays.walk.shape[1], dtype=xp.int32)
        here = (state.stands[:, None] == places[None, :])[:, :, None]
        far = xp.where(here, arrays.walk, 0).sum(axis=1, dtype=xp.int32)
        there = (arrays.place[arrays.way_task][:, None] == places[None, :])[:, None, :]
        walk = xp.where(there, far[None, :, :], 0).sum(axis=2, dtype=xp.int32)
        found = walk if found is None else found + walk
    return found


def _has_room(xp: Any, arrays: Arrays, state: State) -> Array | None:
    """The way's operators find room at their tools and in its zone."""
    if not arrays.tool_places.shape[0] and not arrays.zone_places.shape[0]:
        return None
    # `[W, T]`, the way is the one in which the task is being done
    at_work = (
        xp.arange(arrays.way_ticks.shape[0], dtype=xp.int32)[:, None] == state.way[None, :]
    ) & ((state.way >= 0) & ~mounted(state))[None, :]
    fits = xp.ones(arrays.way_ticks.shape, bool)
    if arrays.tool_places.shape[0]:
        busy = at_work.any(axis=1)
        used = xp.where(busy[:, None], arrays.takes, 0).sum(axis=0, dtype=xp.int32)
        left = arrays.tool_places - used
        fits = fits & ((arrays.takes <= left[None, :]) | (arrays.takes == 0)).all(axis=1)
    if arrays.zone_places.shape[0]:
        crowd = xp.where(at_work, arrays.way_size[:, None], 0).sum(axis=0, dtype=xp.int32)
        left = arrays.zone_places - xp.where(arrays.of_zone, crowd[:, None], 0).sum(
            axis=0, dtype=xp.int32
        )
        room = xp.where(arrays.of_zone, left[None, :], NEVER).min(axis=1)
        fits = fits & (
            arrays.way_size <= xp.where(arrays.of_task, room[None, :], NEVER).min(axis=1)
        )
    return fits


def _is_kept_apart(xp: Any, arrays: Arrays, state: State) -> Array | None:
    """Nobody is in the way's zone whom it keeps apart from the way's operators."""
    if not arrays.apart.shape[0]:
        return None
    running = (state.way >= 0) & ~mounted(state)
    in_hand = xp.arange(arrays.way_ticks.shape[0], dtype=xp.int32)[:, None] == state.way[None, :]
    return ~(arrays.apart & (in_hand & running[None, :]).any(axis=1)[None, :]).any(axis=1)


def _is_held_by_no_machine(xp: Any, arrays: Arrays, state: State) -> Array | None:
    """No machine that holds a part would do something that does not lie within the hold, or take up
    another part; and one that is to take up a part is free, and need do nothing else before.

    What only mistakes can bring about bars nothing: two holds of a machine that are open at once,
    and one that is open while a task that should lie before it is missing or has to come off.
    """
    if not arrays.holds.shape[0]:
        return None
    first, last = arrays.holds[:, 0], arrays.holds[:, 1]
    begun, up = state.way >= 0, mounted(state)
    over, missing = up, ~begun
    if arrays.undo.shape[0]:
        over, missing = up | state.undoing, ~begun | to_undo(arrays, state) | state.undoing
    is_open = begun[first] & ~over[last] & ~(arrays.hold_ahead & missing[None, :]).any(axis=1)
    opened = begun[first] & ~over[last]
    active = is_open & ~(arrays.hold_rivals & opened[None, :]).any(axis=1)
    barred = (active[:, None] & arrays.hold_bars).any(axis=0)
    at_work = (arrays.hold_of & (state.free_at > state.clock)[None, :]).any(axis=1)
    unready = (
        at_work
        | (arrays.hold_ahead & ~begun[None, :]).any(axis=1)
        | (arrays.hold_rivals & (first[:, None] == first[None, :])).any(axis=1)
    )
    # beginning a task that is mounted takes it apart: then no part is taken up
    opens = (arrays.way_task[None, :] == first[:, None]) & ~begun[arrays.way_task][None, :]
    return ~(barred | (opens & unready[:, None]).any(axis=0))


def _is_clear_of_breaks(xp: Any, arrays: Arrays, state: State) -> Array | None:
    """No break of an operator lies between the beginning of its walk or changeover and the nominal
    end.
    """
    if not arrays.break_from.shape[1]:
        return None
    start = starts(arrays, state)
    end = start + nominal(arrays, state)
    before = _preparations(xp, arrays, state)
    begin = start[:, None] - (0 if before is None else before)
    inside = (arrays.break_from[None, :, :] < end[:, None, None]) & (
        arrays.break_to[None, :, :] > xp.broadcast_to(begin[..., None], (*begin.shape, 1))
    )
    return ~(inside.any(axis=2) & arrays.way_uses).any(axis=1)


def _keeps_limits(xp: Any, arrays: Arrays, state: State) -> Array | None:
    """Nobody passes a limit of theirs, with the least that the tasks which are left will take of
    it. What mistakes bring on top does not count.
    """
    if not arrays.limit.shape[0]:
        return None
    stands = (
        xp.arange(arrays.way_ticks.shape[0], dtype=xp.int32)[:, None] == state.way[None, :]
    ).any(axis=1)
    taken = xp.where(stands[:, None], arrays.due, 0).sum(axis=0, dtype=xp.int32)
    ahead = xp.where((state.way < 0)[:, None], arrays.must, 0).sum(axis=0, dtype=xp.int32)
    own = xp.where(arrays.of_task[:, :, None], arrays.must[None, :, :], 0).sum(
        axis=1, dtype=xp.int32
    )
    within = (taken + ahead)[None, :] - own + arrays.due <= arrays.limit[None, :]
    kept = ~(arrays.owes & ~within).any(axis=1)
    return kept | _for_tasks(xp, arrays, mounted(state)) if arrays.undo.shape[0] else kept


def _stays_with_its_team(xp: Any, arrays: Arrays, state: State) -> Array | None:
    """Tasks that the same operators must do are done by those who have begun with one of them."""
    if not arrays.same.shape[0]:
        return None
    in_use = xp.arange(arrays.way_ticks.shape[0], dtype=xp.int32)[:, None] == state.way[None, :]
    by = (in_use[:, :, None] & arrays.way_uses[:, None, :]).any(axis=0)
    partner = arrays.same & (state.way >= 0)[None, :]
    other = (arrays.way_uses[:, None, :] != by[None, :, :]).any(axis=2)
    mine = (arrays.of_task[:, :, None] & partner[None, :, :]).any(axis=1)
    return ~(mine & other).any(axis=1)


def _possible_sets(xp: Any, arrays: Arrays, state: State) -> Array:
    """`[S]` bool, the listed sets that agree with what humans and robots have begun."""
    in_use = xp.arange(arrays.way_ticks.shape[0], dtype=xp.int32)[:, None] == state.way[None, :]
    by_human = (in_use & (arrays.way_uses & arrays.human[None, :]).any(axis=1)[:, None]).any(axis=0)
    return ~((arrays.sets != by_human[None, :]) & (state.way >= 0)[None, :]).any(axis=1)


def _leaves_a_listed_set(xp: Any, arrays: Arrays, state: State) -> Array | None:
    """Some set that `stress_of_set` lists can still become the set of the humans' tasks."""
    if not arrays.sets.shape[0]:
        return None
    possible = _possible_sets(xp, arrays, state)
    within, without = (
        (arrays.sets & possible[:, None]).any(axis=0),
        (~arrays.sets & possible[:, None]).any(axis=0),
    )
    by_human = (arrays.way_uses & arrays.human[None, :]).any(axis=1)
    return xp.where(by_human, _for_tasks(xp, arrays, within), _for_tasks(xp, arrays, without))


def _settled(xp: Any, state: State) -> State:
    """Disassemblies that have ended leave their tasks open; when all stands, every mistake is
    noticed.
    """
    off = state.undoing & (state.end_at <= state.clock)
    stands = (mounted(state) & ~state.undoing).all()
    bad_at = xp.where(
        stands & (state.bad_at < NEVER), xp.minimum(state.bad_at, state.clock), state.bad_at
    )
    return state._replace(
        way=xp.where(off, -1, state.way),
        start_at=xp.where(off, NEVER, state.start_at),
        end_at=xp.where(off, NEVER, state.end_at),
        bad_at=xp.where(off, NEVER, bad_at),
        undoing=state.undoing & ~off,
        tries=state.tries + off,
    )
