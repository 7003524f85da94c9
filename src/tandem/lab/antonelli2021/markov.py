"""Finite decision processes in arrays: whoever decides pays a cost at each step until a goal is
reached; and what is optimal in them.

Plain NumPy in double precision: a judge of those who learn, not their world.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np

from tandem.errors import NothingFoundError

Array = Any
"""A NumPy or JAX array."""
Node = TypeVar("Node", bound=Hashable)


class Process(NamedTuple):
    """`S` states, `A` actions, each with up to `K` outcomes. A tuple of arrays, so that it can be
    mapped over.

    after: `[S, A, K]` int32, the state that the outcome leads to.
    chance: `[S, A, K]` float64, of the outcome; the chances of a legal action sum to 1.
    cost: `[S, A, K]` float64, more than 0 for each legal action.
    legal: `[S, A]` bool, True = allowed. Every state but the goals has a legal action.
    goal: `[S]` bool, where it ends. A goal costs nothing more.
    """

    after: Array
    chance: Array
    cost: Array
    legal: Array
    goal: Array


class Outcome(NamedTuple):
    """One thing that can come of an action."""

    after: Any
    chance: float
    cost: float


class Values(NamedTuple):
    """What is optimal.

    values: `[S]` float64, the least expected cost until a goal.
    policy: `[S]` int, an action of least expected cost; 0 at a goal.
    error: a proven bound: every value is right within this share of it.
    """

    values: Array
    policy: Array
    error: float


def explore(
    start: Node,
    options: Callable[[Node], Mapping[int, Sequence[Outcome]]],
    is_goal: Callable[[Node], bool],
    *,
    actions: int,
    limit: int,
) -> tuple[Process, list[Node]]:
    """The process of all that can be reached from `start`, and its nodes: state `i` of the process
    is node `i`, the start is 0.

    Outcomes of chance 0 are followed too, so that processes that differ in their chances alone
    number their states alike.

    Args:
      options: legal action (0 to `actions` - 1) -> its outcomes; not asked at a goal.

    Raises:
      NothingFoundError: more than `limit` states can be reached.
    """
    numbers, nodes, rows = {start: 0}, [start], []
    for node in nodes:  # grows while it is walked
        row = {} if is_goal(node) else options(node)
        rows.append(row)
        for outcome in (outcome for outcomes in row.values() for outcome in outcomes):
            if outcome.after not in numbers:
                numbers[outcome.after] = len(nodes)
                nodes.append(outcome.after)
        if len(nodes) > limit:
            raise NothingFoundError(
                f"more than {limit:,} states can be reached; a table of them would be too large."
            )
    shape = (
        len(nodes),
        actions,
        max([1, *(len(outcomes) for row in rows for outcomes in row.values())]),
    )
    process = Process(
        after=np.zeros(shape, np.int32),
        chance=np.zeros(shape),
        cost=np.zeros(shape),
        legal=np.zeros(shape[:2], bool),
        goal=np.array([is_goal(node) for node in nodes]),
    )
    for state, row in enumerate(rows):
        for action, outcomes in row.items():
            process.legal[state, action] = True
            for index, outcome in enumerate(outcomes):
                at = (state, action, index)
                process.after[at], process.chance[at], process.cost[at] = (
                    numbers[outcome.after],
                    outcome.chance,
                    outcome.cost,
                )
    return process, nodes


def value_iteration(process: Process, *, error: float = 1e-9, most_sweeps: int = 200_000) -> Values:
    """The least expected cost from every state, by value iteration (Bellman 1957) from 0 upwards.

        v(s) <- min over a of the expected cost + v(after)

    It stops with a proof. Let c be the least cost of a step and r the largest change in the last
    sweep. A sweep that lowers no value by more than r means v >= (1 - r/c) v*, one that raises none
    by more than r means v <= (1 + r/c) v*: an extra cost of at most r a step is at most the share
    r/c of that step's own cost.

    Args:
      error: the share of a value that may be wrong, r/c.

    Raises:
      NothingFoundError: no goal can be reached from some state, or the values have not settled
        after `most_sweeps`.
    """
    possible = process.legal[:, :, None] & (process.chance > 0)
    if not np.all(
        _backward(
            process.goal.copy(),
            process.after.reshape(len(process.goal), -1),
            possible.reshape(len(process.goal), -1),
        )
    ):
        raise NothingFoundError(
            "from some state no goal can be reached, whatever is done; its cost has no end."
        )
    pairs = _Pairs.of(process)
    values = np.zeros(len(process.goal))
    floor = float(pairs.expected.min()) if len(pairs.expected) else 1.0
    change = 0.0
    for _ in range(most_sweeps):
        better = pairs.least(values)
        change = float(np.max(np.abs(better - values), initial=0.0))
        values = better
        if change <= error * floor:
            return Values(values, pairs.best(values), change / floor)
    raise NothingFoundError(
        f"the values had not settled after {most_sweeps:,} sweeps (they still change by"
        f" {change:.3g})."
    )


def policy_values(process: Process, policy: Array) -> Array:
    """`[S]` float64, the expected cost until a goal under the policy (`[S]` int); infinite where it
    may miss the goals for ever.

    Solved as one system of linear equations, so that a policy that gets there only after a very
    long time is valued rightly too.
    """
    states = np.arange(len(process.goal))
    after, chance, cost = (
        field[states, policy] for field in (process.after, process.chance, process.cost)
    )
    sure = sure_states(process, policy)
    rows = np.flatnonzero(sure & ~process.goal)
    places = np.full(len(states), -1)
    places[rows] = np.arange(len(rows))
    system = np.eye(len(rows))
    for k in range(after.shape[1]):
        to = places[after[rows, k]]
        inside = to >= 0
        np.subtract.at(system, (np.flatnonzero(inside), to[inside]), chance[rows[inside], k])
    values = np.where(sure, 0.0, np.inf)
    values[rows] = np.linalg.solve(system, np.sum(chance[rows] * cost[rows], axis=1))
    return values


def sure_states(process: Process, policy: Array) -> Array:
    """`[S]` bool, True where the policy reaches a goal with probability 1.

    That is so when no state from which all goals are out of reach can be come to.
    """
    states = np.arange(len(process.goal))
    after = process.after[states, policy]
    possible = (process.chance[states, policy] > 0) & ~process.goal[:, None]
    can = _backward(process.goal.copy(), after, possible)
    return ~_backward(~can, after, possible)


def reaching_states(process: Process, policy: Array | None = None) -> Array:
    """`[S]` bool, True where a goal is reached when every action does what its first outcome says,
    by graph search.

    Args:
      policy: `[S]` int; when absent, any legal action may be taken, and the answer is whether there
        is a way at all.
    """
    if policy is None:
        return _backward(process.goal.copy(), process.after[:, :, 0], process.legal)
    after = process.after[np.arange(len(process.goal)), policy, :1]
    return _backward(process.goal.copy(), after, ~process.goal[:, None])


def _backward(reached: Array, after: Array, possible: Array) -> Array:
    """All states from which one of `reached` can be come to along possible steps: `after`,
    `possible` `[S, K]`.
    """
    while True:
        further = reached | np.any(reached[after] & possible, axis=1)
        if np.array_equal(further, reached):
            return reached
        reached = further


class _Pairs(NamedTuple):
    """The legal pairs of state and action alone, state by state: `N` of them.

    open: the states that are no goals; first: where the pairs of each of them begin; action,
    expected: `[N]`, the action and its
      expected cost; after, chance: `[N, K]`.
    """

    open: Array
    first: Array
    action: Array
    after: Array
    chance: Array
    expected: Array

    @classmethod
    def of(cls, process: Process) -> _Pairs:
        state, action = np.nonzero(process.legal & ~process.goal[:, None])
        is_open, first = np.unique(state, return_index=True)
        chance = process.chance[state, action]
        expected = np.sum(chance * process.cost[state, action], axis=1)
        return cls(is_open, first, action, process.after[state, action], chance, expected)

    def worth(self, values: Array) -> Array:
        return self.expected + np.sum(self.chance * values[self.after], axis=1)

    def least(self, values: Array) -> Array:
        after = np.zeros_like(values)
        if len(self.open):
            after[self.open] = np.minimum.reduceat(self.worth(values), self.first)
        return after

    def best(self, values: Array) -> Array:
        policy, worth = np.zeros(len(values), np.int64), self.worth(values)
        ends = [*self.first[1:], len(worth)]
        for state, begin, end in zip(self.open, self.first, ends, strict=True):
            policy[state] = self.action[begin + int(np.argmin(worth[begin:end]))]
        return policy
