"""Cell, chance, people and a decider together: one step, and whole episodes, in JAX for many at
once or in NumPy for one.

Somebody's turn it is, or time runs on. Whose turn it is hears what the decider wants it to do: a
way, or -1 for waiting. A robot does it; a person answers as it likes (`people.choose`). What a
person begins may go wrong, and takes as long as chance, pace, habit and fatigue have it. The
decider sees none of that before it shows: it must read running work through `expected_ends`, not
through `State.end_at`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tandem.schedule.model import Assignment
from tandem.world import people as crew
from tandem.world import state as world
from tandem.world.arrays import NEVER, Array, Arrays, Names, namespace
from tandem.world.people import Person
from tandem.world.randomness import (
    Draw,
    Scenario,
    away_until,
    next_absence,
    real_ticks,
    scenario,
    with_rests,
)
from tandem.world.state import State

if TYPE_CHECKING:
    import jax


class Shift(NamedTuple):
    """An episode under way.

    state: the assembly.
    mask: `[W]` bool, what is legal now. turn: `[]` int32, whose turn it is, -1 when time has to run
    on. fatigue: `[O]` float32, of each when its last work ended (or ends). begun: `[O]` int32,
    tasks that each has begun. asked: `[O]` int32, decisions that each has made. suggested: `[O]`
    int32, the task that each was asked to do and has not begun; -1 for none. changes: `[]` int32,
    how often somebody was asked for another task although the one before was still open. illegal:
    `[]` int32, suggestions that were not legal; they count as waiting. decisions, events: `[]`
    int32, turns taken, and times that time ran on.
    """

    state: State
    mask: Array
    turn: Array
    fatigue: Array
    begun: Array
    asked: Array
    suggested: Array
    changes: Array
    illegal: Array
    decisions: Array
    events: Array


Decider = Callable[[Arrays, Shift], Array]
"""`[]` int, the way that whose turn it is should begin, or -1 to wait. Its answer counts for
nothing while `turn` is -1.
"""


def begin(arrays: Arrays, people: Person) -> Shift:
    """The episode before its first decision; `people` is a crew: one person per operator."""
    xp = namespace(people.pace)
    operators, zero = arrays.human.shape[0], xp.zeros((), xp.int32)
    state = world.reset(arrays)
    mask = world.legal(arrays, state)
    nobody = xp.zeros(operators, xp.int32)
    fatigue = xp.asarray(people.fatigue, dtype=xp.float32)
    return Shift(
        state,
        mask,
        world.turn(arrays, mask),
        fatigue,
        nobody,
        nobody,
        nobody - 1,
        zero,
        zero,
        zero,
        zero,
    )


def step(arrays: Arrays, scenario: Scenario, people: Person, shift: Shift, way: Array) -> Shift:
    """Whose turn it is decides, having been asked to begin `way` (`[]` int, -1 to wait); or time
    runs on when it is nobody's.
    """
    xp = namespace(shift.mask)
    if xp is np:
        return (
            decide(arrays, scenario, people, shift, way)
            if shift.turn >= 0
            else run_on(arrays, scenario, shift)
        )
    mine, later = _decided(arrays, scenario, people, shift, way), _later(arrays, scenario, shift)
    ours = shift.turn >= 0
    return _refresh_mask(
        arrays,
        Shift(*(_chosen(xp, ours, one, other) for one, other in zip(mine, later, strict=True))),
    )


def decide(arrays: Arrays, scenario: Scenario, people: Person, shift: Shift, way: Array) -> Shift:
    """Whose turn it is decides. Assumes that it is somebody's."""
    return _refresh_mask(arrays, _decided(arrays, scenario, people, shift, way))


def run_on(arrays: Arrays, scenario: Scenario, shift: Shift) -> Shift:
    """Time runs on to the next event."""
    return _refresh_mask(arrays, _later(arrays, scenario, shift))


def is_over(arrays: Arrays, shift: Shift) -> Array:
    """`[]` bool, all is done, or nothing can be done any more."""
    nothing_left = world.is_stuck(arrays, shift.state, shift.mask) & ~shift.state.refused.any()
    return world.is_done(shift.state) | ((shift.turn < 0) & nothing_left)


def expected_ends(arrays: Arrays, state: State) -> Array:
    """`[T]` int32, when work that is done ended, and when work in hand should end by the stated
    times (the clock, when that has passed); NEVER for what is open.
    """
    xp = namespace(state.way)
    in_use = xp.arange(arrays.way_ticks.shape[0], dtype=xp.int32)[:, None] == state.way[None, :]
    stated = xp.where(in_use, arrays.way_ticks[:, None], 0).sum(axis=0, dtype=xp.int32)
    if arrays.undo.shape[0]:
        stated = xp.where(
            state.undoing,
            xp.where(in_use, arrays.undo[:, None], 0).sum(axis=0, dtype=xp.int32),
            stated,
        )
    running = (state.way >= 0) & ~world.mounted(state)
    start = xp.where(running, state.start_at, 0)
    return xp.where(running, xp.maximum(start + stated, state.clock), state.end_at)


def _refresh_mask(arrays: Arrays, shift: Shift) -> Shift:
    mask = world.legal(arrays, shift.state)
    return shift._replace(mask=mask, turn=world.turn(arrays, mask))


def _chosen(xp: Any, which: Array, one: Any, other: Any) -> Any:
    if isinstance(one, State):
        return State(*(xp.where(which, a, b) for a, b in zip(one, other, strict=True)))
    return xp.where(which, one, other)


def _later(arrays: Arrays, scenario: Scenario, shift: Shift) -> Shift:
    """Time has run on. Where nothing was to come, because of refusals, those who refused are asked
    again.
    """
    xp, state = namespace(shift.mask), shift.state
    insists = (world.next_event(arrays, state) == NEVER) & ~state.waits.any()
    if scenario.away_from.shape[0]:
        moved = world.advance(arrays, state, next_absence(scenario, state.clock))
        moved = moved._replace(away_until=away_until(scenario, moved.clock))
    else:
        moved = world.advance(arrays, state)
    return shift._replace(
        state=moved._replace(refused=state.refused & ~insists),
        events=(shift.events + 1).astype(xp.int32),
    )


def _decided(arrays: Arrays, scenario: Scenario, people: Person, shift: Shift, way: Array) -> Shift:
    xp, state, who = namespace(shift.mask), shift.state, shift.turn
    mine = world.legal_of(arrays, shift.mask, who)
    me = xp.arange(arrays.human.shape[0]) == who
    operators, decisions, _ = scenario.mood.shape
    # moods are drawn per decision of an operator and not per step, so that two deciders meet the
    # same mood at the same decision (common random numbers)
    asked_before = xp.where(me, shift.asked, 0).sum(dtype=xp.int32)
    mood = scenario.mood.reshape(operators * decisions, 3)[
        xp.maximum(who, 0) * decisions + asked_before % decisions
    ]
    # who is asked may do something else, wait or refuse: from here on the answer counts, not `way`
    can_wait = world.may_wait(arrays, state, shift.mask, who)
    answer = crew.choose(arrays, state, crew.of(people, who), who, mine, way, can_wait, mood)
    # what is begun need not be what was meant, nor take the stated time
    begins, noticed, missed = _slipped(xp, arrays, scenario, people, shift, answer.way)
    team = (arrays.way_uses & _is(xp, arrays, begins)[:, None]).any(axis=0)
    ticks, fatigue = _work(xp, arrays, scenario, people, shift, begins, team)
    after = world.assign(arrays, state, begins, ticks, noticed)
    after = (
        after._replace(tries=(after.tries + missed).astype(xp.int32))
        if arrays.undo.shape[0]
        else after
    )
    # who refuses is asked again, for the turn has not passed; who waits is not
    after = world.wait(after, xp.where((begins < 0) & ~answer.refuses, who, -1))
    # a suggestion that is not legal is counted below, but is none that could be refused
    wanted = (_is(xp, arrays, way)[:, None] & arrays.of_task & mine[:, None]).any(axis=0)
    refused = (
        (arrays.of_task & wanted[None, :]).any(axis=1)
        & (arrays.way_uses & me[None, :]).any(axis=1)
        & answer.refuses
    )
    # a change of plan is one that a person notices: another task than was announced to it, while
    # that one is still open
    before = xp.where(me, shift.suggested, 0).sum(dtype=xp.int32) + xp.where(me.any(), 0, -1)
    task = xp.where(wanted.any(), wanted.argmax(), -1).astype(xp.int32)
    still_open = ((xp.arange(arrays.needs.shape[0]) == before) & (state.way < 0)).any()
    changed = (task >= 0) & (task != before) & still_open & (me & arrays.human).any()
    return shift._replace(
        state=after._replace(refused=after.refused | refused),
        fatigue=xp.where(team, fatigue, shift.fatigue).astype(xp.float32),
        begun=shift.begun + team,
        asked=shift.asked + me,
        suggested=xp.where(
            me, xp.where((begins < 0) & ~answer.refuses, task, -1), shift.suggested
        ).astype(xp.int32),
        changes=(shift.changes + changed).astype(xp.int32),
        illegal=(shift.illegal + ((way >= 0) & ~wanted.any())).astype(xp.int32),
        decisions=(shift.decisions + 1).astype(xp.int32),
    )


def _is(xp: Any, arrays: Arrays, way: Array) -> Array:
    """`[W]` bool, True at the way."""
    return xp.arange(arrays.way_ticks.shape[0], dtype=xp.int32) == way


def _slipped(
    xp: Any, arrays: Arrays, scenario: Scenario, people: Person, shift: Shift, way: Array
) -> tuple[Array, Array | None, Array]:
    """What really begins; when it is noticed that it was wrong (NEVER: it is right); and `[M]`
    bool, the task that was meant if another is begun.
    """
    if not arrays.undo.shape[0]:
        return way, None, shift.state.undoing
    state, chosen = shift.state, _is(xp, arrays, way)
    task = (arrays.of_task & chosen[:, None]).any(axis=0)
    team = (arrays.way_uses & chosen[:, None]).any(axis=0)
    attempt = task[:, None] & (xp.arange(scenario.slip.shape[1])[None, :] == state.tries[:, None])
    comes_off = (task & world.mounted(state)).any()

    def drawn(numbers: Array) -> Array:
        return xp.where(attempt, numbers, 0).sum()

    # a team is as careless as the one who forgets most; taking apart cannot go wrong
    careless = xp.where(team, people.forgets, 0.0).max()
    wrong = attempt.any() & (drawn(scenario.slip) < careless) & ~comes_off
    premature = world.out_of_order(arrays, state) & world.legal_of(
        arrays, arrays.way_size == 1, shift.turn
    )
    # the number picks one of the premature tasks evenly, without a draw for each of them
    other = (premature.cumsum() > drawn(scenario.order) * premature.sum()).argmax()
    strays = (
        wrong
        & (drawn(scenario.order) < 1)
        & premature.any()
        & ((xp.arange(arrays.human.shape[0]) == shift.turn) & arrays.human).any()
    )
    return (
        xp.where(strays, other, way).astype(xp.int32),
        xp.where(wrong, drawn(scenario.notice), NEVER).astype(xp.int32),
        task & strays,
    )


def _work(
    xp: Any,
    arrays: Arrays,
    scenario: Scenario,
    people: Person,
    shift: Shift,
    way: Array,
    team: Array,
) -> tuple[Array, Array]:
    """How long the way really takes, and `[O]` how tired each would be after it. The slowest of a
    team sets the pace (ASSUMPTION).
    """
    state, chosen = shift.state, _is(xp, arrays, way)
    start = xp.where(chosen, world.starts(arrays, state), 0).sum(dtype=xp.int32)
    stated = xp.where(chosen, world.nominal(arrays, state), 0).sum(dtype=xp.int32)
    fresh = crew.rested(people, shift.fatigue, xp.maximum(start - state.free_at, 0))
    slowest = xp.where(team, crew.time_factor(people, fresh, shift.begun), 0.0).max()
    tries = (
        xp.where((arrays.of_task & chosen[:, None]).any(axis=0), state.tries, 0).sum(dtype=xp.int32)
        if arrays.undo.shape[0]
        else 0
    )
    drawn = real_ticks(scenario, arrays, way, tries, stated)
    # added to the whole number, so that the stated time stays what it is
    more = drawn * slowest - stated
    ticks = with_rests(
        scenario, start, xp.maximum(1, stated + xp.rint(more).astype(xp.int32)), team
    )
    return ticks, crew.tired(people, fresh, chosen, ticks)


class Played(NamedTuple):
    """An episode that has ended. All as in `Shift` and `State`, and: makespan, stress: `[]` int32,
    ticks and units; done: `[]` bool, all was done.
    """

    makespan: Array
    stress: Array
    done: Array
    shift: Shift


def play(
    arrays: Arrays, scenario: Scenario, people: Person, decide: Decider, limit: int = 10_000
) -> Played:
    """A whole episode in JAX; ends after `limit` steps at the latest. `jit` it, `vmap` it over
    scenarios, people and cells.
    """
    import jax

    def goes_on(shift: Shift) -> Array:
        return ~is_over(arrays, shift) & (shift.decisions + shift.events < limit)

    shift = jax.lax.while_loop(
        goes_on,
        lambda shift: step(arrays, scenario, people, shift, decide(arrays, shift)),
        begin(arrays, people),
    )
    return _played(arrays, shift)


def play_many(
    key: jax.Array, draw: Draw, arrays: Arrays, people: Person, decide: Decider
) -> Played:
    """Episodes in JAX, one for each person of `people` (leading axis `E`, which everything returned
    has, too).

    The e-th episode of a key has the same chance whoever decides. `draw` and `decide` are static:
    the same ones compile once.
    """
    return _compiled(draw, decide)(key, arrays, people)


@lru_cache(maxsize=64)
def _compiled(draw: Draw, decide: Decider) -> Callable[[jax.Array, Arrays, Person], Played]:
    import jax

    def many(key: jax.Array, arrays: Arrays, people: Person) -> Played:
        def one(uniform: jax.Array, person: Person) -> Played:
            return play(arrays, scenario(draw, arrays, uniform), crew.crew(arrays, person), decide)

        return jax.vmap(one)(jax.random.uniform(key, (people.pace.shape[0], draw.numbers)), people)

    return jax.jit(many)


@dataclass(frozen=True)
class Episode:
    """One episode in words.

    Attributes:
      makespan, stress: seconds, and the cell's own measure.
      done: all was done; else nothing could be done any more.
      work: everything that was begun, in order; a task that went wrong is in it several times.
      undone: the disassemblies among them.
      decisions, events, changes: see `Shift`.
    """

    makespan: float
    stress: float
    done: bool
    work: tuple[Assignment, ...]
    undone: tuple[Assignment, ...]
    decisions: int
    events: int
    changes: int


def play_one(
    names: Names,
    arrays: Arrays,
    scenario: Scenario,
    people: Person,
    decide: Decider,
    limit: int = 10_000,
) -> Episode:
    """A whole episode in NumPy, under a decider in Python; the same functions as `play`. Ends after
    `limit` steps at the latest.
    """
    shift, work, undone = begin(arrays, people), list[Assignment](), list[Assignment]()
    for _ in range(limit):
        if is_over(arrays, shift):
            break
        before, shift = (
            shift,
            step(
                arrays,
                scenario,
                people,
                shift,
                decide(arrays, shift) if shift.turn >= 0 else np.int32(-1),
            ),
        )
        # an assignment shows as a new start, whatever else the step brought
        for task in np.flatnonzero(
            (shift.state.start_at != before.state.start_at) & (shift.state.way >= 0)
        ):
            row = names.assignment(
                int(shift.state.way[task]),
                int(shift.state.start_at[task]),
                int(shift.state.end_at[task]),
            )
            work.append(row)
            if shift.state.undoing.any() and shift.state.undoing[task]:
                undone.append(row)
    played = _played(arrays, shift)
    return Episode(
        makespan=names.seconds(int(played.makespan)),
        stress=names.stress(int(played.stress)),
        done=bool(played.done),
        work=tuple(work),
        undone=tuple(undone),
        decisions=int(shift.decisions),
        events=int(shift.events),
        changes=int(shift.changes),
    )


def _played(arrays: Arrays, shift: Shift) -> Played:
    return Played(
        world.makespan(shift.state),
        world.stress(arrays, shift.state),
        world.is_done(shift.state),
        shift,
    )
