"""Tabular Q-learning on a finite process: Watkins (1989); Watkins and Dayan (1992), Machine
Learning 8.

    Q(s, a) <- Q(s, a) + rate(n) (cost + gamma min over b of Q(s', b) - Q(s, a))

with n the visits of the pair (s, a). The table holds costs to go, so the best action has the least
value; a goal's value is 0. `train` learns along episodes, as the method is published. `sweep`
updates every pair once a round, each with a sampled outcome of its own (Kearns and Singh 1999, NIPS
11, "parallel sampling"): the way to precision.

Pure: the same key gives the same table. `jit` it whole, `vmap` it over keys and processes. Axes:
`S` states, `A` actions, `K` outcomes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from tandem.errors import UsageError
from tandem.lab.antonelli2021.markov import Process

GOLDEN = 0.6180339887498949
"""Multiples of the golden ratio's fraction fill [0, 1) more evenly than any other (Knuth, volume 3,
section 6.4).
"""


@dataclass(frozen=True)
class Config:
    """How to learn.

    Attributes:
      steps: updates in all (`train`), or rounds in which every pair is updated (`sweep`).
      rate: how much of a new sample enters; a share of what the schedule says.
      horizon: None keeps the rate constant. A number h lets it fall with the visits, (1 + h) / (n +
        h): h = 0 averages all samples alike, a larger h forgets the first ones, whose costs to go
        were guesses, faster (Even-Dar and Mansour 2003, JMLR 5, say why h = 0 is slow).
      epsilon, epsilon_end: the share of random actions at the beginning and at the end, a straight
        line between.
      gamma: discount.
      bonus: paid for reaching a goal.
      initial: the table begins with independent numbers between 0 and this; nothing else says what
        is done where nothing was learned.
      limit: operations after which an episode is ended; the value of what lies beyond is kept.
      exploring_starts: episodes begin in any state with the same chance; else in state 0.
      stratified: a pair's outcomes come in an even order, each as often as its chance says, instead
        of independently.
      reports: points of the curve.
    """

    steps: int = 100_000
    rate: float = 1.0
    horizon: float | None = None
    epsilon: float = 0.2
    epsilon_end: float = 0.2
    gamma: float = 1.0
    bonus: float = 0.0
    initial: float = 0.0
    limit: int = 200
    exploring_starts: bool = False
    stratified: bool = False
    reports: int = 50

    def __post_init__(self) -> None:
        wrong = [
            *(
                [f"steps is {self.steps}, less than reports, {self.reports}"]
                if not 1 <= self.reports <= self.steps
                else []
            ),
            *[
                f"{name} is {value:g}, outside 0 to 1"
                for name, value in self._shares()
                if not 0 <= value <= 1
            ],
            *(
                [f"horizon is {self.horizon:g}, below 0"]
                if self.horizon is not None and self.horizon < 0
                else []
            ),
            *([f"limit is {self.limit}, below 1"] if self.limit < 1 else []),
        ]
        if wrong:
            raise UsageError(f"settings of Q-learning: {'; '.join(wrong)}.")

    def _shares(self) -> list[tuple[str, float]]:
        return [(name, getattr(self, name)) for name in ("rate", "epsilon", "epsilon_end", "gamma")]


class Learned(NamedTuple):
    """A table and how it came about.

    table: `[S, A]` float32, cost to go; infinite for actions that are not legal. visits: `[S, A]`
    int32. curve: `[reports, S]` float32, the value of every state as training went on.
    episode_cost: `[reports]` float32, mean cost of the episodes that ended since the last report
    (`nan` when none did, or for `sweep`).
    """

    table: jax.Array
    visits: jax.Array
    curve: jax.Array
    episode_cost: jax.Array


class _Walk(NamedTuple):
    """One episode under way. `cost`: so far; `ended`, `ended_cost`: of the episodes since the last
    report.
    """

    table: jax.Array
    visits: jax.Array
    state: jax.Array
    age: jax.Array
    cost: jax.Array
    ended: jax.Array
    ended_cost: jax.Array


def train(key: jax.Array, process: Process, config: Config) -> Learned:
    """Learns along episodes, epsilon-greedy, one update a step.

    `config.steps` is rounded up to a multiple of `config.reports`.
    """
    process = jax.tree.map(_single, process)
    states = process.goal.shape[0]
    table_key, shift_key, start_key, walk_key = jax.random.split(key, 4)
    shift = jax.random.uniform(shift_key, process.legal.shape)
    beginnings = jnp.nonzero(~process.goal, size=states, fill_value=0)[0]
    count = jnp.sum(~process.goal)
    each = -(-config.steps // config.reports)

    def restart(draw: jax.Array) -> jax.Array:
        anywhere = beginnings[_place(draw, count)]
        return anywhere if config.exploring_starts else jnp.zeros_like(anywhere)

    def step(walk: _Walk, draw: tuple[jax.Array, jax.Array]) -> tuple[_Walk, None]:
        (explores, which, outcome, start), epsilon = draw
        legal = process.legal[walk.state]
        values = jnp.where(legal, walk.table[walk.state], jnp.inf)
        action = jnp.where(explores < epsilon, _nth(legal, which), jnp.argmin(values))
        at = (walk.state, action)
        visits = walk.visits[at] + 1
        drawn = _even(shift[at], visits) if config.stratified else outcome
        k = _outcome(process.chance[at], drawn)
        after, cost = process.after[at][k], process.cost[at][k]
        goal = process.goal[after]
        cost = cost - config.bonus * goal
        target = cost + config.gamma * _least(walk.table[after], process.legal[after], goal)
        better = walk.table[at] + _rate(config, visits) * (target - walk.table[at])
        ends = goal | (walk.age + 1 >= config.limit)
        so_far = walk.cost + cost
        return (
            _Walk(
                table=walk.table.at[at].set(better),
                visits=walk.visits.at[at].set(visits),
                state=jnp.where(ends, restart(start), after),
                age=jnp.where(ends, 0, walk.age + 1),
                cost=jnp.where(ends, 0.0, so_far),
                ended=walk.ended + ends,
                ended_cost=walk.ended_cost + jnp.where(ends, so_far, 0.0),
            ),
            None,
        )

    def report(walk: _Walk, number: jax.Array) -> tuple[_Walk, tuple[jax.Array, jax.Array]]:
        draws = jax.random.uniform(jax.random.fold_in(walk_key, number), (each, 4))
        epsilons = config.epsilon + (config.epsilon_end - config.epsilon) * (
            number * each + jnp.arange(each)
        ) / (each * config.reports)
        walk, _ = jax.lax.scan(step, walk, (draws, epsilons))
        seen = walk.ended_cost / walk.ended  # 0 / 0: no episode ended
        return walk._replace(
            ended=jnp.zeros_like(walk.ended), ended_cost=jnp.zeros_like(walk.ended_cost)
        ), (_values(process, walk.table), seen)

    zero = jnp.zeros(())
    begun = _Walk(
        config.initial * jax.random.uniform(table_key, process.legal.shape),
        jnp.zeros(process.legal.shape, jnp.int32),
        restart(jax.random.uniform(start_key)), jnp.zeros((), jnp.int32), zero, jnp.zeros((),
        jnp.int32), zero,
    )  # fmt: skip
    walk, (curve, episode_cost) = jax.lax.scan(report, begun, jnp.arange(config.reports))
    return Learned(jnp.where(process.legal, walk.table, jnp.inf), walk.visits, curve, episode_cost)


def sweep(key: jax.Array, process: Process, config: Config) -> Learned:
    """Learns in rounds: each legal pair draws one outcome and is updated with it, all against the
    same old table.

    There are no episodes: `epsilon`, `limit`, `initial` and `exploring_starts` say nothing here.
    Under `jax.enable_x64` it learns in double precision, which the last digits need: a late sample
    enters with a weight near the precision of a single number.
    """
    process = jax.tree.map(jnp.asarray, process)
    shift_key, draw_key = jax.random.split(key)
    shift = jax.random.uniform(shift_key, process.legal.shape, process.cost.dtype)
    reach = jnp.cumsum(process.chance, axis=2)
    each = -(-config.steps // config.reports)

    def one(table: jax.Array, number: jax.Array) -> tuple[jax.Array, None]:
        drawn = (
            _even(shift, number + 1)
            if config.stratified
            else jax.random.uniform(jax.random.fold_in(draw_key, number), shift.shape, shift.dtype)
        )
        k = jnp.minimum(jnp.sum(drawn[:, :, None] >= reach, axis=2), reach.shape[2] - 1)[:, :, None]
        after, cost = (
            jnp.take_along_axis(process.after, k, 2)[:, :, 0],
            jnp.take_along_axis(process.cost, k, 2)[:, :, 0],
        )
        cost = cost - config.bonus * process.goal[after]
        target = cost + config.gamma * _values(process, table)[after]
        return table + _rate(config, number + 1) * (target - table), None

    def report(table: jax.Array, number: jax.Array) -> tuple[jax.Array, jax.Array]:
        table, _ = jax.lax.scan(one, table, number * each + jnp.arange(each))
        return table, _values(process, table)

    table, curve = jax.lax.scan(
        report, jnp.zeros(process.legal.shape, process.cost.dtype), jnp.arange(config.reports)
    )
    visits = jnp.where(process.legal, each * config.reports, 0)
    return Learned(
        jnp.where(process.legal, table, jnp.inf), visits, curve, jnp.full(config.reports, jnp.nan)
    )


class Episodes(NamedTuple):
    """What a policy did, one row an episode: `[N]` cost, steps, and whether a goal was reached."""

    cost: jax.Array
    steps: jax.Array
    reached: jax.Array


def play(
    key: jax.Array, process: Process, policy: jax.Array, start: jax.Array, *, limit: int
) -> Episodes:
    """Follows a policy (`[S]` int) from each of the states `start` (`[N]` int), independently, for
    at most `limit` steps.
    """
    process = jax.tree.map(_single, process)

    def step(
        running: tuple[jax.Array, jax.Array, jax.Array], number: jax.Array
    ) -> tuple[tuple[jax.Array, jax.Array, jax.Array], None]:
        state, cost, steps = running
        at = (state, policy[state])
        k = _outcome(
            process.chance[at],
            jax.random.uniform(jax.random.fold_in(key, number), state.shape)[:, None],
        )
        over = process.goal[state]
        paid = jnp.take_along_axis(process.cost[at], k[:, None], 1)[:, 0]
        after = jnp.take_along_axis(process.after[at], k[:, None], 1)[:, 0]
        return (
            jnp.where(over, state, after),
            cost + jnp.where(over, 0.0, paid),
            steps + ~over,
        ), None

    begun = (start, jnp.zeros(start.shape), jnp.zeros(start.shape, jnp.int32))
    (state, cost, steps), _ = jax.lax.scan(step, begun, jnp.arange(limit))
    return Episodes(cost, steps, process.goal[state])


def greedy(table: jax.Array) -> jax.Array:
    """`[S]` int, the action of least cost to go; the first of several. In a goal, where none is
    legal, 0.
    """
    return jnp.argmin(table, axis=1)


# --- Compiled once for each config and shape ---

train_seeds = partial(jax.jit, static_argnames="config")(jax.vmap(train, in_axes=(0, None, None)))
"""`train`, compiled, over a leading axis of keys."""
sweep_seeds = partial(jax.jit, static_argnames="config")(jax.vmap(sweep, in_axes=(0, None, None)))
"""`sweep`, compiled, over a leading axis of keys."""


def _single(array: Any) -> jax.Array:
    made = jnp.asarray(array)
    return made.astype(jnp.float32) if jnp.issubdtype(made.dtype, jnp.floating) else made


def _rate(config: Config, visits: jax.Array) -> jax.Array | float:
    return (
        config.rate
        if config.horizon is None
        else config.rate * (1 + config.horizon) / (visits + config.horizon)
    )


def _even(shift: jax.Array, visits: jax.Array) -> jax.Array:
    """The draw of a pair's so-manieth visit, evenly spread over all visits.

    In whole numbers, modulo 2^32: a product of floats would lose the fraction's digits when there
    are many visits.
    """
    turn = visits.astype(jnp.uint32) * jnp.uint32(round(GOLDEN * 2**32))
    drawn = shift + turn.astype(shift.dtype) * 2.0**-32
    return drawn - jnp.floor(drawn)


def _outcome(chance: jax.Array, drawn: jax.Array) -> jax.Array:
    """The outcome that a draw from [0, 1) means: `chance` `[..., K]`, `drawn` `[]` or with a last
    axis of 1.
    """
    return jnp.minimum(jnp.sum(drawn >= jnp.cumsum(chance, axis=-1), axis=-1), chance.shape[-1] - 1)


def _least(row: jax.Array, legal: jax.Array, goal: jax.Array) -> jax.Array:
    return jnp.where(goal, 0.0, jnp.min(jnp.where(legal, row, jnp.inf), axis=-1))


def _values(process: Process, table: jax.Array) -> jax.Array:
    """`[S]`, the least cost to go; 0 at a goal."""
    return _least(table, process.legal, process.goal)


def _place(draw: jax.Array, count: jax.Array) -> jax.Array:
    return jnp.minimum((draw * count).astype(jnp.int32), count - 1)


def _nth(legal: jax.Array, draw: jax.Array) -> jax.Array:
    """A legal action, each with the same chance."""
    order = jnp.cumsum(legal)
    return jnp.argmax(order > _place(draw, order[-1]))
