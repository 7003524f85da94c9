"""The search of Yu, Huang and Chang (2020), as their code was read (not copied), many games side by side.

One agent searches over its own moves; between them the other one plays what its own network likes best. The least cost that was found under a
move is what the move counts for (min-backup), and the next one to look at minimises

    Q(s, a) - c P(s, a) sqrt(sum_b N(s, b)) / (1 + N(s, a))

Their quirk: on the way up a step's time is added after its edge has been updated, so Q(s, a) leaves out the time of a itself. `quirk` switches
it off.

ASSUMPTION: a move that was never looked at counts Q = 0, so that with costs of some tens of seconds each one is looked at first; of equal moves the
leftmost is taken. Neither is told in the paper.

Axes: `B` games, `K` moves, `S` simulations; a tree has `S + 1` nodes, the root is 0.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from tandem.learn.alphazero.config import YuSearch
from tandem.learn.alphazero.network import Judge, Parameters, liked, opinion
from tandem.learn.alphazero.search import Found
from tandem.learn.game import Game, State

Array = Any


class Tree(NamedTuple):
    """state: of each node, leading axis `S + 1`. least: `[S + 1]`, the network's value of each node. prior, visits, cost: `[S + 1, K]`, P, N and Q.
    child: `[S + 1, K]` int32, 0 where there is none. time: `[S + 1, K]`, cost of the move and of what the other did until the next own turn."""

    state: State
    value: Array
    legal: Array
    prior: Array
    visits: Array
    cost: Array
    child: Array
    time: Array


def yu_search(key: Array, judge: Judge, parameters: Parameters, games: Game, states: State, config: YuSearch) -> Found:
    """Looks ahead from `states` `[B]` of `games` `[B]`, each for the agent whose turn it is.

    `Found.to_come` is the least Q of the root, and `Found.policy` follows the visits. In a game that is over any move is named, and means nothing.
    """
    one = lambda key, game, state: _one(key, judge, parameters, game, state, config)  # noqa: E731
    return jax.vmap(one)(jax.random.split(key, games.unit.shape[0]), games, states)


def backed_up(cost: Array, visits: Array, times: Array, leaf: Array, *, quirk: bool = True) -> Array:
    """`[D]` the new Q of the `D` edges of a path from the root, whose moves took `times` `[D]` and which ended in a value of `leaf` `[]`.

    Args:
      cost, visits: `[D]`, Q and N of the edges before.
    """
    to_come = leaf + jnp.cumsum(times[::-1])[::-1]
    found = to_come - times if quirk else to_come
    return jnp.where(visits == 0, found, jnp.minimum(cost, found))


def _one(key: Array, judge: Judge, parameters: Parameters, game: Game, state: State, config: YuSearch) -> Found:
    me = game.to_play(state)
    tree = jax.lax.fori_loop(0, config.simulations, lambda number, tree: _simulated(tree, number + 1, me, judge, parameters, game, config), _root(
        judge, parameters, game, state, config))  # fmt: skip
    visits = tree.visits[0]
    if config.temperature:
        weight = jnp.where(visits > 0, jnp.exp(jnp.log(jnp.maximum(visits, 1)) / config.temperature), 0.0)
        move = jax.random.categorical(key, jnp.where(visits > 0, jnp.log(jnp.maximum(weight, 1e-30)), -jnp.inf))
    else:
        weight = visits
        move = jnp.argmax(visits)
    least = jnp.min(jnp.where(visits > 0, tree.cost[0], jnp.inf))
    return Found(move.astype(jnp.int32), weight / jnp.maximum(jnp.sum(weight), 1e-30), jnp.where(jnp.isfinite(least), least, 0.0))


def _root(judge: Judge, parameters: Parameters, game: Game, state: State, config: YuSearch) -> Tree:
    nodes = config.simulations + 1
    states = jax.tree.map(lambda leaf: jnp.zeros((nodes, *leaf.shape), leaf.dtype), state)
    edges = jnp.zeros((nodes, game.moves))
    tree = Tree(states, jnp.zeros(nodes), edges > 0, edges, edges, edges, edges.astype(jnp.int32), edges)
    return _added(tree, 0, state, jnp.ones((), bool), judge, parameters, game)


def _added(tree: Tree, node: Any, state: State, really: Array, judge: Judge, parameters: Parameters, game: Game) -> Tree:
    """The tree with the state as that node, should it `really` be a new one."""
    seen = opinion(judge, parameters, game, state)
    legal = game.legal(state)
    prior = jax.nn.softmax(seen.logits) * legal  # a softmax over all columns, then the mask, as the authors have it
    new = (state, seen.to_come, legal, prior)
    kept = jax.tree.map(
        lambda all_, one: all_.at[node].set(jnp.where(really, one, all_[node])), (tree.state, tree.value, tree.legal, tree.prior), new
    )
    return tree._replace(**dict(zip(("state", "value", "legal", "prior"), kept, strict=True)))


def _simulated(tree: Tree, number: Array, me: Array, judge: Judge, parameters: Parameters, game: Game, config: YuSearch) -> Tree:
    """One simulation: down by the formula, at most one new node, and up again."""
    nodes, moves, on_path = list[Array](), list[Array](), list[Array]()
    node, on = jnp.zeros((), jnp.int32), jnp.any(tree.legal[0])
    for _ in range(config.depth):
        move = _chosen(tree, node, config)
        nodes, moves, on_path = [*nodes, node], [*moves, move], [*on_path, on]
        following = tree.child[node, move]
        on = on & (following > 0) & jnp.any(tree.legal[following])
        node = jnp.where(on, following, node)
    path, taken, valid = jnp.stack(nodes), jnp.stack(moves), jnp.stack(on_path)
    last = jnp.maximum(jnp.sum(valid) - 1, 0)
    parent, move = path[last], taken[last]
    new = (tree.child[parent, move] == 0) & valid[0]
    state, time = _until_my_turn(jax.tree.map(lambda leaf: leaf[parent], tree.state), move, me, judge, parameters, game)
    tree = _added(tree, jnp.where(new, number, 0), state, new, judge, parameters, game)
    child = tree.child.at[parent, move].set(jnp.where(new, number, tree.child[parent, move]))
    tree = tree._replace(child=child, time=tree.time.at[parent, move].set(jnp.where(new, time, tree.time[parent, move])))
    times = jnp.where(valid, tree.time[path, taken], 0.0)
    found = backed_up(tree.cost[path, taken], tree.visits[path, taken], times, tree.value[child[parent, move]], quirk=config.quirk)
    where = jnp.where(valid, path, tree.value.shape[0])  # what is not on the path falls off the end
    return tree._replace(cost=tree.cost.at[where, taken].set(found, mode="drop"), visits=tree.visits.at[where, taken].add(1.0, mode="drop"))


def _chosen(tree: Tree, node: Array, config: YuSearch) -> Array:
    visits = tree.visits[node]
    explored = config.exploration * tree.prior[node] * jnp.sqrt(jnp.sum(visits)) / (1 + visits)
    return jnp.argmin(jnp.where(tree.legal[node], tree.cost[node] - explored, jnp.inf))


def _until_my_turn(state: State, move: Array, me: Array, judge: Judge, parameters: Parameters, game: Game) -> tuple[State, Array]:
    """My move, then what the other's network likes best until I am asked again or all is over; and what it cost."""

    def goes_on(carry: tuple[State, Array]) -> Array:
        return ~game.is_over(carry[0]) & (game.to_play(carry[0]) != me)

    def other(carry: tuple[State, Array]) -> tuple[State, Array]:
        after, cost = game.step(carry[0], liked(judge, parameters, game, carry[0]))
        return after, carry[1] + cost / game.unit

    after, cost = game.step(state, move)
    return jax.lax.while_loop(goes_on, other, (after, cost / game.unit))
