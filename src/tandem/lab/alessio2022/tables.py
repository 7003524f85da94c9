"""The exact value of a grid whose paths do not close (`closing=False`): dynamic programming
backwards over the moves that are left.

A state is (robot's square, human's square, whose turn, moves left): S x S x 2 x limit of them, each
valued once. Written on tables, apart from `world.step`: a judge of learners, not their world.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tandem.lab.alessio2022.world import HUMAN, REACHED_RIGHT, REACHED_WRONG, ROBOT, WAIT, Grid

Table = NDArray[Any]
Reply = Callable[[Table, Table], Table]
"""How an agent picks: values `[S, S, 5]` after each of its actions and which are possible -> value
`[S, S]`.
"""


class Value(NamedTuple):
    """The value of a game at its start, and everywhere.

    success: probability of a right terminal state from the start.
    left: `[limit + 1, 2, S, S]` float, the same with so many moves left, by whose turn, the robot's
    and the human's square.
    """

    success: float
    left: Table

    def bound(self, grid: Grid) -> int | None:
        """The fewest moves of both together within which success is certain from the start; None
        when it never is.
        """
        sure = np.flatnonzero(
            self.left[:, int(grid.first), int(grid.start[ROBOT]), int(grid.start[HUMAN])]
            >= 1 - 1e-9
        )
        return int(sure[0]) if len(sure) else None


def best(values: Table, possible: Table) -> Table:
    """The agent picks what is worth most."""
    return np.where(possible, values, -np.inf).max(-1)


def worst(values: Table, possible: Table) -> Table:
    """The agent picks what is worth least."""
    return np.where(possible, values, np.inf).min(-1)


def by_chance(values: Table, possible: Table) -> Table:
    """Every possible action is as likely as the others."""
    return np.where(possible, values, 0.0).sum(-1) / possible.sum(-1)


def following(policy: Table) -> Reply:
    """The agent follows a fixed policy: probabilities `[S, S, 5]` by the robot's and the human's
    square; those of impossible actions wait.
    """

    def reply(values: Table, possible: Table) -> Table:
        lost = np.where(possible, 0.0, policy).sum(-1)
        return (np.where(possible, policy * values, 0.0)).sum(-1) + lost * values[..., WAIT]

    return reply


def minimax(grid: Grid) -> Value:
    """The largest probability of success that a robot can be sure of, whatever the human does: 0 or
    1, for nothing is left to chance.
    """
    return value(grid, best, worst)


def value(grid: Grid, robot: Reply, human: Reply) -> Value:
    """The probability of success when robot and human pick as these say: `value(grid,
    following(policy), worst)` is a policy's worst case.
    """
    squares, limit = grid.kind.shape[0], int(grid.limit)
    left = np.zeros((limit + 1, 2, squares, squares))
    tables = [_moves(grid, agent) for agent in (ROBOT, HUMAN)]
    for moves in range(1, limit + 1):
        for agent, reply in ((ROBOT, robot), (HUMAN, human)):
            (robots, humans), possible, ended = tables[agent]
            after = left[moves - 1, 1 - agent, robots, humans]
            after = np.where(
                ended == REACHED_RIGHT, 1.0, np.where(ended == REACHED_WRONG, 0.0, after)
            )
            left[moves, agent] = reply(after, possible)
    return Value(
        float(left[limit, int(grid.first), int(grid.start[ROBOT]), int(grid.start[HUMAN])]), left
    )


def _moves(grid: Grid, agent: int) -> tuple[tuple[Table, Table], Table, Table]:
    """For every pair of squares and action of that agent `[S, S, 5]`: both squares afterwards,
    whether it is possible, the terminal state reached.
    """
    squares = grid.kind.shape[0]
    robot, human = np.arange(squares)[:, None, None], np.arange(squares)[None, :, None]
    neighbour = np.asarray(grid.neighbour)
    there = np.broadcast_to(
        neighbour[:, None, :] if agent == ROBOT else neighbour[None, :, :], (squares, squares, 5)
    )
    other = human if agent == ROBOT else robot
    possible = ((there >= 0) & (there != other)) | (np.arange(5) == WAIT)
    stays = robot if agent == ROBOT else human
    there = np.where(possible & (there >= 0), there, stays)
    pair = (
        (there, np.broadcast_to(human, there.shape))
        if agent == ROBOT
        else (np.broadcast_to(robot, there.shape), there)
    )
    return pair, possible, np.asarray(grid.kind)[there]


def quickest(grid: Grid) -> Table:
    """`[S, S, 5]` a robot that goes the shortest way to a right terminal state around where the
    human stands now; the first action of equals.
    """
    squares = grid.kind.shape[0]
    neighbour, kind = np.asarray(grid.neighbour), np.asarray(grid.kind)
    policy = np.zeros((squares, squares, 5))
    for human in range(squares):
        enters = (neighbour >= 0) & (neighbour != human) & (kind[neighbour] != REACHED_WRONG)
        enters[:, WAIT] = False
        far = np.where(kind == REACHED_RIGHT, 0, squares)
        for _ in range(squares):
            near = np.where(enters, far[neighbour], squares).min(-1)
            far = np.where(kind == REACHED_RIGHT, 0, np.minimum(far, near + 1))
        leads = enters & (far[neighbour] < far[:, None])
        policy[np.arange(squares), human, np.where(leads.any(-1), leads.argmax(-1), WAIT)] = 1.0
    return policy
