"""Robot and human on a grid with obstacles and terminal states, one move after the other: state in,
state out.

Source: Alessio, Aliev and Antonelli (2022), doi 10.1007/978-3-030-99310-8_3: a grid world in which
the human pursues a wrong or random terminal state, agents take turns, never share a square, and are
punished for idling and for leaving the grid. What is not public is marked ASSUMPTION and is an
option or a field of the data.

Pure functions over an array namespace: NumPy arrays in, NumPy arrays out; the same lines are traced
under `jax.jit` and `jax.vmap`. No function here draws a random number.

What a path does is not public (ASSUMPTION, field `closing`). By default a square that either agent
has been on is closed to both, as a step of the assembly that is done is not done again: so a robot
can bar the human's way and go on, and every game ends, for squares run out and two waits in a row
end it. Otherwise a path is only seen, and the clock ends the game. Either way there are finitely
many states and an exact value (`exact.py`, `tables.py`).

Axes: 2 agents, 0 the robot and 1 the human; `S` squares in reading order; 5 actions: wait, up,
down, left, right.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tandem.lab.alessio2022.layout import HUMAN_START, OBSTACLE, RIGHT, ROBOT_START, WRONG, Layout

Array = Any
"""A NumPy or JAX array, or a tracer of one."""

ROBOT, HUMAN = 0, 1
WAIT, UP, DOWN, LEFT, RIGHTWARDS = range(5)
ACTIONS = ("wait", "up", "down", "left", "right")
NOWHERE, REACHED_RIGHT, REACHED_WRONG = 0, 1, 2


class Grid(NamedTuple):
    """One layout as arrays; made by `grid(layout)`.

    neighbour: `[S, 5]` int32, the square that an action leads to when nobody stands there; -1 where
    the grid ends or an obstacle stands. kind: `[S]` int32, `NOWHERE`, `REACHED_RIGHT` or
    `REACHED_WRONG`. obstacle: `[S]` bool. start: `[2]` int32, squares of robot and human. first:
    `[]` int32, who moves first (ASSUMPTION: the robot). limit: `[]` int32, moves of both together
    after which the episode ends without a terminal state (ASSUMPTION). closing: `[]` bool, squares
    that were visited are closed, and two waits in a row end the game.
    """

    neighbour: Array
    kind: Array
    obstacle: Array
    start: Array
    first: Array
    limit: Array
    closing: Array


class Rewards(NamedTuple):
    """What an agent is paid, by reason. The values are ASSUMPTION.

    right: the robot, when a right terminal state is reached, whoever reaches it.
    wrong: the human, when a wrong one is reached, whoever reaches it.
    step: each agent for each move of its own; `idle` on top when it waits although it could move;
    `illegal` on top when the move is not possible.
    """

    right: Array = 10.0
    wrong: Array = 10.0
    step: Array = -0.1
    idle: Array = -0.2
    illegal: Array = -1.0


class State(NamedTuple):
    """A game under way.

    position: `[2]` int32, squares.
    turn: `[]` int32, whose move it is.
    clock: `[]` int32, moves so far, both agents' together.
    path: `[2, S]` bool, the squares that the agent has been on.
    reached: `[]` int32, kind of the terminal state that was reached, `NOWHERE` before.
    waited: `[]` int32, how many of the last moves, one after the other, were none.
    """

    position: Array
    turn: Array
    clock: Array
    path: Array
    reached: Array
    waited: Array


def grid(
    layout: Layout, *, first: int = ROBOT, limit: int | None = None, closing: bool = True
) -> Grid:
    """The layout as NumPy arrays.

    Args:
      first: who moves first.
      limit: moves of both together; two a square when absent, which no game with closing paths
        reaches.
    """
    kinds = {RIGHT: REACHED_RIGHT, WRONG: REACHED_WRONG}
    return Grid(
        neighbour=np.array(
            [layout.neighbours(place) for place in range(len(layout.text))], np.int32
        ),
        kind=np.array([kinds.get(letter, NOWHERE) for letter in layout.text], np.int32),
        obstacle=np.array([letter == OBSTACLE for letter in layout.text]),
        start=np.array([layout.squares(ROBOT_START)[0], layout.squares(HUMAN_START)[0]], np.int32),
        first=np.array(first, np.int32),
        limit=np.array(limit or 2 * len(layout.text), np.int32),
        closing=np.array(closing),
    )


def reset(grid: Grid) -> State:
    """Both agents on their first squares."""
    xp = namespace(grid.kind)
    squares = xp.arange(grid.kind.shape[0], dtype=xp.int32)
    return State(
        position=grid.start,
        turn=grid.first,
        clock=xp.zeros((), xp.int32),
        path=squares[None, :] == grid.start[:, None],
        reached=xp.zeros((), xp.int32),
        waited=xp.zeros((), xp.int32),
    )


def legal(grid: Grid, state: State) -> Array:
    """`[2, 5]` bool, True where the action is possible. Who is not on turn can only wait; waiting
    is always possible.
    """
    xp = namespace(grid.kind)
    there = grid.neighbour[state.position]
    on_turn = (xp.arange(2) == state.turn)[:, None]
    return (xp.arange(5) == WAIT)[None, :] | ((there >= 0) & ~_closed(grid, state)[there] & on_turn)


def step(
    grid: Grid, rewards: Rewards, state: State, action: Array
) -> tuple[State, Array, Array, Array]:
    """The agent on turn moves; of the other's action only counts whether it is one. What is not
    possible moves nobody.

    A number that is no action is illegal for whoever names it, and costs `illegal`.

    Args:
      action: `[2]` int.

    Returns:
      the next state; reward `[2]` float32; over `[]` bool, a terminal state was reached or the
      clock ran out; illegal `[2]` int32.
    """
    xp = namespace(grid.kind)
    mine = xp.arange(2) == state.turn
    is_action, there = leads_to(grid, state.position, action)
    possible = is_action & ((action == WAIT) | ((there >= 0) & ~_closed(grid, state)[there]))
    moves = mine & possible & (action != WAIT)
    position = xp.where(moves, there, state.position).astype(xp.int32)
    reached = xp.max(xp.where(mine, grid.kind[position], NOWHERE)).astype(xp.int32)
    squares = xp.arange(grid.kind.shape[0], dtype=xp.int32)
    after = State(
        position=position,
        turn=(1 - state.turn).astype(xp.int32),
        clock=(state.clock + 1).astype(xp.int32),
        path=state.path | (squares[None, :] == position[:, None]),
        reached=reached,
        waited=xp.where(xp.any(moves), 0, state.waited + 1).astype(xp.int32),
    )
    broken = (mine & ~possible) | ~is_action
    chosen = (action == WAIT) & _can_move(grid, state)
    paid = mine * (rewards.step + rewards.idle * chosen) + rewards.illegal * broken
    ends = xp.stack(
        [rewards.right * (reached == REACHED_RIGHT), rewards.wrong * (reached == REACHED_WRONG)]
    )
    return after, (paid + ends).astype(xp.float32), is_over(grid, after), broken.astype(xp.int32)


def _can_move(grid: Grid, state: State) -> Array:
    """`[2]` bool, whether an agent could go anywhere were it on turn; who is shut in does not
    idle.
    """
    there = grid.neighbour[state.position]
    return namespace(grid.kind).any((there >= 0) & ~_closed(grid, state)[there], axis=1)


def leads_to(grid: Grid, position: Array, action: Array) -> tuple[Array, Array]:
    """`[2]` bool, whether what each agent names is an action at all; `[2]` int32, the square it
    leads to, -1 for none.
    """
    xp = namespace(grid.kind)
    is_action = (action >= 0) & (action < len(ACTIONS))
    return is_action, xp.where(
        is_action, grid.neighbour[position, xp.where(is_action, action, WAIT)], -1
    )


def is_over(grid: Grid, state: State) -> Array:
    """`[]` bool: a terminal state was reached, nothing moves any more, or the clock ran out."""
    return (
        (state.reached != NOWHERE)
        | (grid.closing & (state.waited >= 2))
        | (state.clock >= grid.limit)
    )


def is_success(state: State) -> Array:
    """`[]` bool: a right terminal state was reached."""
    return state.reached == REACHED_RIGHT


def _closed(grid: Grid, state: State) -> Array:
    """`[S]` bool, squares that nobody can enter: where an agent stands, and, when paths close,
    where one has been.
    """
    xp = namespace(grid.kind)
    stands = xp.arange(grid.kind.shape[0])[None, :] == state.position[:, None]
    return xp.any(stands | (state.path & grid.closing), axis=0)


def namespace(array: Array) -> Any:
    """The module (`numpy`, `jax.numpy`) that the array belongs to."""
    return array.__array_namespace__()
