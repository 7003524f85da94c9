"""The chessboard game of Yu, Huang and Chang (2020): state in, state out.

Source: IEEE Access 2020, arXiv 2007.04140; what the text leaves open, as their code plays it.
`docs/yu.md` has the rules in words.

Pure functions over an array namespace: NumPy arrays in, NumPy arrays out; under `jax.jit` and
`jax.vmap` the same lines are traced. They describe one board; `vmap` adds the batch, of states and
of boards. No function here draws a random number.

Axes: `h` rows from the bottom up, `w` columns, 2 agents (0 the robot, 1 the human). Everything
about a piece stands in the cell of the first position in which its first column lies, so that
nothing is ever looked up by number: where a piece lies now is `levels`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

Array = Any
"""A NumPy or JAX array, or a tracer of one."""

ROBOT, HUMAN = 0, 1

BY_ROBOT, BY_HUMAN, NO_START, CLEARED = 0, 1, -1, -2
"""Codes of the tensor's layer 1 beside those of `Who`."""


class Layout(NamedTuple):
    """A board before its first move; made by `layout(board)`.

    time: `[h, w]` int32, seconds of the piece whose first column this is; 0 in all other cells.
    who: `[h, w]` int32, 2 robot, 3 either, 4 human, as in `Who`; 0 where no piece starts.
    width: `[h, w]` int32, how many columns the piece covers; 0 where none starts.
    tail: `[h, w]` int32, seconds of the longest chain of pieces that begins with this one; 0 where
    none starts. joined: `[h, w, w]` bool, whether two cells of a row belong to the same piece; a
    cell of none is not even joined to itself.
    """

    time: Array
    who: Array
    width: Array
    tail: Array
    joined: Array


class State(NamedTuple):
    """A game under way.

    on: `[h, w]` bool, whether what was in this cell is still on the board; False = cleared, or
    never a piece. doing: `[2, h, w]` bool, the piece that each agent is executing, at its start.
    left: `[2]` int32, seconds until the agent is free. clock: `[]` int32, seconds since the start.
    redone: `[h, w]` int32, how often the human has had to leave the piece undone; see `Fate`.
    repairing: `[]` bool, whether what the robot does is repairing its failure.
    """

    on: Array
    doing: Array
    left: Array
    clock: Array
    redone: Array
    repairing: Array


class Fate(NamedTuple):
    """What will go wrong on this board, whoever decides what; see `chance.py`. Nothing of it can be
    observed before it happens.

    repair: `[h, w]` int32, seconds that the robot needs on top when its work on the piece fails,
    which shows at its end; 0 = it works. mistakes: `[h, w]` int32, how many times in a row the
    human does the piece wrong: it stays where it is and has to be done again, by
      whoever can.
    """

    repair: Array
    mistakes: Array


def reset(layout: Layout) -> State:
    """The board before the first move."""
    xp = namespace(layout.time)
    rows, columns = layout.time.shape
    return State(
        on=xp.any(layout.joined, axis=2),
        doing=xp.zeros((2, rows, columns), bool),
        left=xp.zeros(2, xp.int32),
        clock=xp.zeros((), xp.int32),
        redone=xp.zeros((rows, columns), xp.int32),
        repairing=xp.zeros((), bool),
    )


def levels(layout: Layout, state: State) -> Array:
    """`[h, w]` int32: the rows in which the cells of the pieces lie when all have fallen, 1 is the
    bottom row; 0 = cleared.

    A piece falls a row when its whole span below is empty, again and again. Taken from the bottom
    up, each piece comes to rest at once: on the highest of the piles in its columns.
    """
    xp = namespace(state.on)
    pile, found = xp.zeros(state.on.shape[1], xp.int32), []
    for row in range(state.on.shape[0]):
        rest = xp.max(xp.where(layout.joined[row], pile[None, :], 0), axis=1)
        found.append(xp.where(state.on[row], rest + 1, 0))
        pile = xp.where(state.on[row], rest + 1, pile)
    return xp.stack(found).astype(xp.int32)


def bottom(layout: Layout, state: State) -> Array:
    """`[h, w]` bool, `levels == 1` without falling row by row: a piece comes to lie in the bottom
    row when nothing at all is below its span.
    """
    xp = namespace(state.on)
    rows = xp.arange(state.on.shape[0])
    lowest = xp.min(xp.where(state.on, rows[:, None], rows.shape[0]), axis=0)
    return state.on & ~xp.any(layout.joined & (lowest[None] < rows[:, None])[:, None, :], axis=2)


def eligible(layout: Layout, state: State) -> Array:
    """`[2, h, w]` bool, the starts of pieces in the bottom row that the agent can do and that
    nobody does, if the agent is free.
    """
    xp = namespace(state.on)
    can = xp.stack([(layout.who == 2) | (layout.who == 3), (layout.who == 3) | (layout.who == 4)])
    waiting = bottom(layout, state) & ~xp.any(state.doing, axis=0)
    return can & waiting[None] & (state.left == 0)[:, None, None]


def to_play(layout: Layout, state: State) -> Array:
    """`[]` int32, who chooses now: the human when there is something for it, else the robot (also
    when the game is over).
    """
    xp = namespace(state.on)
    return xp.any(eligible(layout, state)[HUMAN]).astype(xp.int32)


def legal(layout: Layout, state: State) -> Array:
    """`[w]` bool, the columns in which a piece starts that the agent `to_play` may take. No move is
    waiting; none is left when it is over.
    """
    xp = namespace(state.on)
    both = xp.any(eligible(layout, state), axis=1)
    return xp.where(xp.any(both[HUMAN]), both[HUMAN], both[ROBOT])


def is_over(state: State) -> Array:
    """`[]` bool, True when nothing is left on the board."""
    return ~namespace(state.on).any(state.on)


def step(layout: Layout, state: State, action: Array, fate: Fate | None = None) -> State:
    """The agent `to_play` takes the piece that starts in column `action` (`[]` int, from 0); then
    time runs until somebody has to choose.

    If the other agent is free and has something to take, no time passes. Otherwise it runs to the
    next completion, and on if nobody has anything to take then. What ends at the same time ends
    together. A column in which nothing legal starts begins nothing, and when nobody is at work
    nothing changes: so a game that is over stays as it is.
    """
    state = begin(layout, state, action)
    # Two ends free both agents, and with fate the robot's may come in two parts: then somebody has
    # to choose, or it is over.
    for _ in range(2 if fate is None else 3):
        state = _run_on(layout, state, fate)
    return state


def begin(layout: Layout, state: State, action: Array) -> State:
    """The agent `to_play` takes the piece that starts in column `action`; no time passes."""
    xp = namespace(state.on)
    agent = xp.arange(2) == to_play(layout, state)
    here = xp.arange(layout.time.shape[1]) == action
    taken = eligible(layout, state) & agent[:, None, None] & here[None, None, :]
    return state._replace(
        doing=state.doing | taken,
        left=state.left + xp.sum(taken * layout.time[None], axis=(1, 2)).astype(xp.int32),
    )


def observe(layout: Layout, state: State) -> Array:
    """`[h, w, 3]` float32, the authors' tensor, bottom row first.

    Layer 0: seconds left of the piece that starts here. Layer 1: 2 robot only, 3 either, 4 human
    only, 0 the robot is executing it, 1 the human is, -1 no piece starts here, -2 cleared. Layer 2:
    its width in columns. Layers 0 and 2 are 0 where no piece starts.
    """
    xp = namespace(state.on)
    starts = layout.who > 0
    left = xp.sum(xp.where(state.doing, state.left[:, None, None], 0), axis=0)
    time = xp.where(xp.any(state.doing, axis=0), left, layout.time)
    code = xp.where(
        state.doing[ROBOT],
        BY_ROBOT,
        xp.where(state.doing[HUMAN], BY_HUMAN, xp.where(starts, layout.who, NO_START)),
    )
    # one number a piece, so that one pass over the rows lets all three fall
    packed = (time * 2**9 + layout.width) * 2**3 + code - CLEARED
    seen = _fallen(packed, levels(layout, state))
    return xp.stack([seen // 2**12, seen % 2**3 + CLEARED, seen // 2**3 % 2**9], axis=-1).astype(
        xp.float32
    )


def _fallen(cells: Array, levels: Array) -> Array:
    """`[h, w]`, every cell moved down its column to its level, 1 is the bottom row; 0 where nothing
    lies, and what has level 0 is gone.
    """
    xp = namespace(cells)
    rows, columns = (
        xp.where(levels > 0, levels - 1, cells.shape[0]),
        xp.arange(cells.shape[1])[None],
    )
    ground = xp.zeros((cells.shape[0] + 1, cells.shape[1]), cells.dtype)
    if hasattr(ground, "at"):
        return ground.at[rows, columns].set(cells)[:-1]
    ground[rows, columns] = cells
    return ground[:-1]


def namespace(array: Array) -> Any:
    """The module (`numpy`, `jax.numpy`) that the array belongs to."""
    return array.__array_namespace__()


def _run_on(layout: Layout, state: State, fate: Fate | None) -> State:
    """Time runs to the next completion; not at all when somebody has to choose or nobody is at
    work.
    """
    xp = namespace(state.on)
    busy = state.left > 0
    first = xp.where(busy[ROBOT] & busy[HUMAN], xp.min(state.left), xp.max(state.left))
    passed = xp.where(xp.any(eligible(layout, state)), 0, first).astype(xp.int32)
    state = state._replace(left=state.left - passed * busy, clock=state.clock + passed)
    ended = busy & (state.left == 0)
    if fate is None:
        return _clear(layout, state, state.doing & ended[:, None, None], ended)
    more = xp.sum(state.doing[ROBOT] * fate.repair).astype(xp.int32)
    fails = ended[ROBOT] & (more > 0) & ~state.repairing
    slips = ended[HUMAN] & state.doing[HUMAN] & (state.redone < fate.mistakes)
    ended = ended & xp.stack([~fails, xp.ones((), bool)])
    done = state.doing & ended[:, None, None] & ~xp.stack([xp.zeros_like(slips), slips])
    state = state._replace(
        left=state.left + xp.stack([xp.where(fails, more, 0), xp.zeros_like(more)]),
        redone=state.redone + slips,
        repairing=fails | (state.repairing & ~ended[ROBOT]),
    )
    return _clear(layout, state, done, ended)


def _clear(layout: Layout, state: State, done: Array, ended: Array) -> State:
    """Pieces that are `done` (`[2, h, w]` bool, at their starts) leave the board, and who has
    `ended` (`[2]`) is free.
    """
    xp = namespace(state.on)
    gone = xp.any(layout.joined & xp.any(done, axis=0)[:, :, None], axis=1)
    return state._replace(on=state.on & ~gone, doing=state.doing & ~ended[:, None, None])
