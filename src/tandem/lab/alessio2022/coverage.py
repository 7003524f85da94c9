"""The same squares with another task: robot and human cover every free square. The rewards of
MathWorks' area coverage, in turns.

Source: the MathWorks example "Train Multiple Agents for Area Coverage", from which Alessio et al.
(2022) seem to have taken grid, channels and moves: +2 for a new square, -0.5 for one that was
covered before, -1 for not moving, -1 for an impossible move, +100 when all is covered. There three
agents move at once; here two take turns, as in the rest of the grid (ASSUMPTION). Nothing closes,
and terminal states are free squares.

Pure functions over an array namespace; axes as in `world.py`.
"""

from __future__ import annotations

from typing import NamedTuple

from tandem.lab.alessio2022.world import WAIT, Array, Grid, leads_to, namespace


class Rewards(NamedTuple):
    """What an agent is paid for a move of its own; `full` each agent, with the move that covers the
    last square.
    """

    new: Array = 2.0
    old: Array = -0.5
    still: Array = -1.0
    illegal: Array = -1.0
    full: Array = 100.0


class State(NamedTuple):
    """A coverage under way: `position` `[2]` int32, `turn` and `clock` `[]` int32, `covered` `[S]`
    bool.
    """

    position: Array
    turn: Array
    clock: Array
    covered: Array


def reset(grid: Grid) -> State:
    """Both agents on their first squares, which count as covered."""
    xp = namespace(grid.kind)
    covered = xp.any(xp.arange(grid.kind.shape[0])[None, :] == grid.start[:, None], axis=0)
    return State(grid.start, grid.first, xp.zeros((), xp.int32), covered)


def legal(grid: Grid, state: State) -> Array:
    """`[2, 5]` bool. Who is not on turn can only wait; the other's square cannot be entered."""
    xp = namespace(grid.kind)
    there = grid.neighbour[state.position]
    on_turn = (xp.arange(2) == state.turn)[:, None]
    return (xp.arange(5) == WAIT)[None, :] | (
        (there >= 0) & (there != state.position[::-1, None]) & on_turn
    )


def step(
    grid: Grid, rewards: Rewards, state: State, action: Array
) -> tuple[State, Array, Array, Array]:
    """The agent on turn moves. An impossible move costs `illegal` and, as nothing moves, `still`.

    Returns:
      the next state; reward `[2]` float32; over `[]` bool, all is covered or the clock ran out;
      illegal `[2]` int32.
    """
    xp = namespace(grid.kind)
    mine = xp.arange(2) == state.turn
    is_action, there = leads_to(grid, state.position, action)
    possible = is_action & ((action == WAIT) | ((there >= 0) & (there != state.position[::-1])))
    moves = mine & possible & (action != WAIT)
    position = xp.where(moves, there, state.position).astype(xp.int32)
    new = moves & ~state.covered[position]
    covered = state.covered | xp.any(
        xp.arange(grid.kind.shape[0])[None, :] == position[:, None], axis=0
    )
    after = State(
        position, (1 - state.turn).astype(xp.int32), (state.clock + 1).astype(xp.int32), covered
    )
    broken = (mine & ~possible) | ~is_action
    paid = (
        rewards.new * new
        + rewards.old * (moves & ~new)
        + rewards.still * (mine & ~moves)
        + rewards.illegal * broken
    )
    full = is_covered(grid, after)
    return (
        after,
        (paid + rewards.full * full).astype(xp.float32),
        full | (after.clock >= grid.limit),
        broken.astype(xp.int32),
    )


def is_covered(grid: Grid, state: State) -> Array:
    """`[]` bool: no free square is left."""
    return namespace(grid.kind).all(state.covered | grid.obstacle)


def share(grid: Grid, state: State) -> Array:
    """`[]` float: the part of the free squares that is covered."""
    xp = namespace(grid.kind)
    return xp.sum(state.covered & ~grid.obstacle) / xp.sum(~grid.obstacle)


def observe(grid: Grid, state: State) -> Array:
    """`[2, 4 S]` float32: obstacles, the own square, the other's square, covered squares."""
    xp = namespace(grid.kind)
    stands = (xp.arange(grid.kind.shape[0])[None, :] == state.position[:, None]) * 1.0
    seen = [
        xp.concatenate([grid.obstacle * 1.0, stands[own], stands[1 - own], state.covered * 1.0])
        for own in range(2)
    ]
    return xp.stack(seen).astype(xp.float32)
