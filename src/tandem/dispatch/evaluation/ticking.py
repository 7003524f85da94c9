"""One tick of many episodes: whose turn it is decides, or time runs on. Compiled for many episodes,
by hand in NumPy for a few.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple, TypeVar

import numpy as np

from tandem.world import episode
from tandem.world import state as world
from tandem.world.arrays import NEVER, Arrays, namespace
from tandem.world.episode import Shift
from tandem.world.people import Person, crew
from tandem.world.randomness import Scenario, away_until, next_absence

T = TypeVar("T", bound=tuple[Any, ...])


class Ticking(NamedTuple):
    """Functions over a leading axis of `E` episodes.

    begin: `(arrays, people)`; tick: `(arrays, scenarios, people, shifts, ways, until)`. Each gives
      the shifts, `[E]` whether they are over, and `[E, M]` which tasks must come off. `until`:
      ticks at which time stops though nothing happens.
    end: `(arrays, shifts)` -> `[E]` makespan in ticks, stress in units, and whether all was done.
    """

    begin: Callable[..., Any]
    tick: Callable[..., Any]
    end: Callable[..., Any]


@lru_cache(maxsize=1)
def compiled() -> Ticking:
    """In JAX: seconds to compile for each size, then thousands of episodes at once."""
    import jax
    import jax.numpy as jnp

    def tick(
        arrays: Arrays, scenario: Scenario, person: Person, shift: Shift, way: Any, until: Any
    ) -> tuple[Shift, Any, Any]:
        mine = episode.decide(arrays, scenario, crew(arrays, person), shift, way)
        ours = shift.turn >= 0
        return told(
            arrays,
            jax.tree.map(
                lambda one, other: jnp.where(ours, one, other),
                mine,
                later(arrays, scenario, shift, until),
            ),
        )

    each = jax.vmap(tick, in_axes=(None, 0, 0, 0, 0, 0))
    return Ticking(
        jax.jit(jax.vmap(begun, in_axes=(None, 0))),
        jax.jit(each),
        jax.jit(jax.vmap(ended, in_axes=(None, 0))),
    )


def by_hand() -> Ticking:
    """In NumPy, one episode after the other: a millisecond or two for each."""

    def begin(arrays: Arrays, people: Person) -> Any:
        return _stacked([begun(arrays, row(people, number)) for number in range(len(people.pace))])

    def tick(
        arrays: Arrays, scenarios: Scenario, people: Person, shifts: Shift, ways: Any, until: Any
    ) -> Any:
        found = []
        for number in range(len(ways)):
            shift, scenario = row(shifts, number), row(scenarios, number)
            if episode.is_over(arrays, shift):
                found.append(told(arrays, shift))
            elif shift.turn >= 0:
                found.append(
                    told(
                        arrays,
                        episode.decide(
                            arrays, scenario, crew(arrays, row(people, number)), shift, ways[number]
                        ),
                    )
                )
            else:
                found.append(told(arrays, later(arrays, scenario, shift, until[number])))
        return _stacked(found)

    def end(arrays: Arrays, shifts: Shift) -> Any:
        return _stacked([ended(arrays, row(shifts, number)) for number in range(len(shifts.turn))])

    return Ticking(begin, tick, end)


def begun(arrays: Arrays, person: Person) -> tuple[Shift, Any, Any]:
    """One episode before its first decision."""
    return told(arrays, episode.begin(arrays, crew(arrays, person)))


def later(arrays: Arrays, scenario: Scenario, shift: Shift, until: Any) -> Shift:
    """Time runs on to the next event, or to the moment at which the decider wants to look again;
    one that has passed is none.
    """
    xp, clock = namespace(shift.mask), shift.state.clock
    until = xp.where(until > clock, until, NEVER)
    state = world.advance(
        arrays,
        shift.state,
        xp.minimum(until, next_absence(scenario, clock)) if scenario.away_from.shape[0] else until,
    )
    if scenario.away_from.shape[0]:
        state = state._replace(away_until=away_until(scenario, state.clock))
    mask = world.legal(arrays, state)
    return shift._replace(
        state=state, mask=mask, turn=world.turn(arrays, mask), events=shift.events + 1
    )


def told(arrays: Arrays, shift: Shift) -> tuple[Shift, Any, Any]:
    """The shift, whether it is over, and which tasks must come off."""
    off = (
        world.to_undo(arrays, shift.state)
        if arrays.undo.shape[0]
        else namespace(shift.mask).zeros(0, bool)
    )
    return shift, episode.is_over(arrays, shift), off


def ended(arrays: Arrays, shift: Shift) -> tuple[Any, Any, Any]:
    """Makespan in ticks, stress in units, whether all was done."""
    return (
        world.makespan(shift.state),
        world.stress(arrays, shift.state),
        world.is_done(shift.state),
    )


def row(tree: T, number: int) -> T:
    """One row of a named tuple of arrays."""
    return _mapped(lambda part: part[number], tree)


def rows(tree: T, count: int, first: int = 0) -> T:
    """So many rows from that one on."""
    return _mapped(lambda part: part[first : first + count], tree)


def _mapped(what: Callable[[Any], Any], tree: Any) -> Any:
    if isinstance(tree, tuple):
        parts = [_mapped(what, part) for part in tree]
        return type(tree)(*parts) if hasattr(tree, "_fields") else tuple(parts)
    return what(np.asarray(tree))


def _stacked(trees: list[Any]) -> Any:
    first = trees[0]
    if isinstance(first, tuple):
        parts = [_stacked(list(part)) for part in zip(*trees, strict=True)]
        return type(first)(*parts) if hasattr(first, "_fields") else tuple(parts)
    return np.stack([np.asarray(tree) for tree in trees])
