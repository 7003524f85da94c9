"""Who plays the chessboard without having learned anything: columns from the left, at random, and
dispatch rules.

A player takes the layout, the state and `w` numbers that are uniform on [0, 1), and gives a legal
column; only the random player looks at the numbers. All of them go through `jax.jit` and
`jax.vmap`.
"""

from __future__ import annotations

from collections.abc import Callable

from tandem.lab.yu2020.world import Array, Layout, State, bottom, legal, namespace

Player = Callable[[Layout, State, Array], Array]
"""Layout, state, `[w]` uniform numbers -> `[]` int, a column."""

WORST = -(2**30)


def leftmost(layout: Layout, state: State, _: Array) -> Array:
    """The first legal column."""
    return namespace(state.on).argmax(legal(layout, state))


def rightmost(layout: Layout, state: State, _: Array) -> Array:
    """The last legal column."""
    mask = legal(layout, state)
    return mask.shape[0] - 1 - namespace(state.on).argmax(mask[::-1])


def at_random(layout: Layout, state: State, numbers: Array) -> Array:
    """Any legal column, each as likely as the others."""
    xp = namespace(state.on)
    return xp.argmax(xp.where(legal(layout, state), numbers, -1.0))


def shortest(layout: Layout, state: State, _: Array) -> Array:
    """The piece that takes least time; of equals the one that began lowest on the board, then the
    leftmost.
    """
    return _best(layout, state, -layout.time)


def longest(layout: Layout, state: State, _: Array) -> Array:
    """The piece that takes most time; of equals the one that began lowest, then the leftmost."""
    return _best(layout, state, layout.time)


def longest_tail(layout: Layout, state: State, _: Array) -> Array:
    """The piece with the longest chain on top of it, its own time included; of equals the one that
    began lowest, then the leftmost.
    """
    return _best(layout, state, layout.tail)


PLAYERS: dict[str, Player] = {
    "leftmost": leftmost,
    "rightmost": rightmost,
    "random": at_random,
    "spt": shortest,
    "lpt": longest,
    "longest-tail": longest_tail,
}
"""Name -> player. A new one is a line here."""


def _best(layout: Layout, state: State, score: Array) -> Array:
    """The legal column whose piece in the bottom row has the highest score (`[h, w]`, whole
    numbers).
    """
    xp = namespace(state.on)
    rows = score.shape[0]
    open_starts = bottom(layout, state) & (layout.who > 0) & ~xp.any(state.doing, axis=0)
    ranked = score * rows - xp.arange(rows)[:, None]  # the row breaks ties
    by_column = xp.max(xp.where(open_starts, ranked, WORST), axis=0)
    return xp.argmax(xp.where(legal(layout, state), by_column, WORST - 1))
