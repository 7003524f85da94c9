"""The search of Yu, Huang and Chang (2020), as their code was read (not copied), many games side by
side.

One agent searches over its own moves; between them the other one plays what its own network likes
best. The least cost that was found under a move is what the move counts for (min-backup), and the
next one to look at minimises

    Q(s, a) - c P(s, a) sqrt(sum_b N(s, b)) / (1 + N(s, a))

Their quirk: on the way up a step's time is added after its edge has been updated, so Q(s, a) leaves
out the time of a itself. `quirk` switches it off.

ASSUMPTION: each move is looked at once before any is looked at again (`unvisited` says otherwise);
of equal moves the leftmost is taken. Neither is told in the paper.

Simulations are of different length: the other one may have to play several moves before I am asked
again. So the games do not wait for each other: at a tick each of them makes one move of its own
simulation, asks a network once, and where its simulation has arrived begins the next.

Axes: `B` games, `K` moves, `S` simulations, `D` own moves that are looked ahead; a tree has `S + 1`
nodes, the root is 0.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from tandem.lab.yu2020.config import YuSearch
from tandem.learn.alphazero.network import IMPOSSIBLE, Network, Parameters, Prediction, predict
from tandem.learn.alphazero.search import Found
from tandem.learn.alphazero.selfplay import SEARCHES
from tandem.learn.env import Game, State

Array = Any


class Tree(NamedTuple):
    """state: of each node, leading axis `S + 1`. value: `[S + 1]`, the network's, of each node.
    legal, prior, visits, cost: `[S + 1, K]`, P, N and Q. child: `[S + 1, K]` int32, 0 where there
    is none. time: `[S + 1, K]`, cost of the move and of what the other did until the next own turn.
    """

    state: State
    value: Array
    legal: Array
    prior: Array
    visits: Array
    cost: Array
    child: Array
    time: Array


class Path(NamedTuple):
    """My moves from the root on. nodes, moves: `[D]` int32. on: `[D]` bool, False beyond its end.
    last: `[]` int32, the index of the last move.
    """

    nodes: Array
    moves: Array
    on: Array
    last: Array


class Walk(NamedTuple):
    """The simulation that is under way. path: as far as the tree was known. state: where it stands.
    move: `[]` int32, what is played next. time: `[]`, cost since my last move. done: `[]` int32,
    simulations that have arrived. arrived: `[]` bool, this one has; the next can begin.
    """

    path: Path
    state: State
    move: Array
    time: Array
    done: Array
    arrived: Array


def yu_search(
    key: Array,
    network: Network,
    parameters: Parameters,
    games: Game,
    states: State,
    config: YuSearch,
) -> Found:
    """Looks ahead from `states` `[B]` of `games` `[B]`, each for the agent whose turn it is.

    `Found.to_come` is the least Q of the root, and `Found.policy` follows the visits. In a game
    that is over any move is named, and means nothing.
    """
    trees, walks = jax.vmap(lambda game, state: _begun(network, parameters, game, state, config))(
        games, states
    )
    movers = jax.vmap(lambda game, state: game.to_play(state))(games, states)

    def tick(carry: tuple[Tree, Walk]) -> tuple[Tree, Walk]:
        one = lambda tree, walk, me, game: _tick(tree, walk, me, network, parameters, game, config)  # noqa: E731
        return jax.vmap(one)(*carry, movers, games)

    trees, _ = jax.lax.while_loop(
        lambda carry: jnp.any(carry[1].done < config.simulations), tick, (trees, walks)
    )
    return jax.vmap(lambda key, visits, cost: _found(key, visits, cost, config))(
        jax.random.split(key, games.unit.shape[0]), trees.visits[:, 0], trees.cost[:, 0]
    )


def backed_up(
    cost: Array, visits: Array, times: Array, leaf: Array, *, quirk: bool = True
) -> Array:
    """`[D]` the new Q of the `D` edges of a path from the root, whose moves took `times` `[D]` and
    which ended in a value of `leaf` `[]`.

    Args:
      cost, visits: `[D]`, Q and N of the edges before.
    """
    to_come = leaf + jnp.cumsum(times[::-1])[::-1]
    found = to_come - times if quirk else to_come
    return jnp.where(visits == 0, found, jnp.minimum(cost, found))


def _found(key: Array, visits: Array, cost: Array, config: YuSearch) -> Found:
    """What `visits` and `cost` of the root, `[K]`, say."""
    if config.temperature:
        weight = jnp.where(
            visits > 0, jnp.exp(jnp.log(jnp.maximum(visits, 1)) / config.temperature), 0.0
        )
        move = jax.random.categorical(
            key, jnp.where(visits > 0, jnp.log(jnp.maximum(weight, 1e-30)), -jnp.inf)
        )
    else:
        weight = visits
        move = jnp.argmax(visits)
    least = jnp.min(jnp.where(visits > 0, cost, jnp.inf))
    return Found(
        move.astype(jnp.int32),
        weight / jnp.maximum(jnp.sum(weight), 1e-30),
        jnp.where(jnp.isfinite(least), least, 0.0),
    )


def _begun(
    network: Network, parameters: Parameters, game: Game, state: State, config: YuSearch
) -> tuple[Tree, Walk]:
    """The tree that is only a root, before the first simulation. In a game that is over none is
    made.
    """
    nodes = config.simulations + 1
    states = jax.tree.map(lambda leaf: jnp.zeros((nodes, *leaf.shape), leaf.dtype), state)
    edges, numbers = jnp.zeros((nodes, game.moves)), jnp.zeros((nodes, game.moves), jnp.int32)
    tree = Tree(states, jnp.zeros(nodes), edges > 0, edges, edges, edges, numbers, edges)
    tree = _with(tree, 0, state, game.legal(state), predict(network, parameters, game, state))
    zero, nothing = jnp.zeros((), jnp.int32), jnp.zeros(config.depth, jnp.int32)
    path = Path(nothing, nothing, nothing > 0, zero)
    return tree, Walk(
        path,
        state,
        zero,
        jnp.zeros(()),
        jnp.where(game.is_over(state), config.simulations, zero),
        jnp.ones((), bool),
    )


def _with(tree: Tree, node: Any, state: State, legal: Array, seen: Prediction) -> Tree:
    """The tree with the state as that node; a node beyond the last one changes nothing."""
    # a softmax over all columns, then the mask, as the authors have it
    prior = jax.nn.softmax(seen.logits) * legal
    put = lambda all_, one: all_.at[node].set(one, mode="drop")  # noqa: E731
    return tree._replace(
        state=jax.tree.map(put, tree.state, state),
        value=put(tree.value, seen.to_come),
        legal=put(tree.legal, legal),
        prior=put(tree.prior, prior),
    )


def _tick(
    tree: Tree,
    walk: Walk,
    me: Array,
    network: Network,
    parameters: Parameters,
    game: Game,
    config: YuSearch,
) -> tuple[Tree, Walk]:
    """One move of a simulation: mine where it leaves the tree, or one of the other's until I am
    asked again; then it has arrived.
    """
    walk = _next(tree, walk, config)
    edge = walk.path.nodes[walk.path.last], walk.path.moves[walk.path.last]
    # the path ended inside the tree: at its greatest depth, or with the game
    known = tree.child[edge]
    after, cost = game.step(walk.state, walk.move)
    time, legal, seen = (
        walk.time + cost / game.unit,
        game.legal(after),
        predict(network, parameters, game, after),
    )
    working = walk.done < config.simulations
    new = working & (known == 0) & (game.is_over(after) | (game.to_play(after) == me))
    beyond = tree.value.shape[0]  # what is written there falls off the end
    tree = _with(tree, jnp.where(new, walk.done + 1, beyond), after, legal, seen)
    row = jnp.where(new, edge[0], beyond)
    tree = tree._replace(
        child=tree.child.at[row, edge[1]].set(walk.done + 1, mode="drop"),
        time=tree.time.at[row, edge[1]].set(time, mode="drop"),
    )
    arrived = new | (working & (known > 0))
    tree = _climbed(
        tree, walk.path, jnp.where(known > 0, tree.value[known], seen.to_come), arrived, config
    )
    best = jnp.argmax(jnp.where(legal, seen.logits, IMPOSSIBLE)).astype(jnp.int32)
    return tree, Walk(walk.path, after, best, time, walk.done + arrived, arrived)


def _next(tree: Tree, walk: Walk, config: YuSearch) -> Walk:
    """The walk itself while it is under way, else the next one: down by the formula as far as the
    tree is known.
    """
    node, on = jnp.zeros((), jnp.int32), jnp.any(tree.legal[0])
    steps = []
    for _ in range(config.depth):
        move = _chosen(tree, node, config)
        steps.append((node, move, on))
        following = tree.child[node, move]
        on = on & (following > 0) & jnp.any(tree.legal[following])
        node = jnp.where(on, following, node)
    nodes, moves, valid = (jnp.stack(part) for part in zip(*steps, strict=True))
    path = Path(
        nodes, moves.astype(jnp.int32), valid, jnp.maximum(jnp.sum(valid, dtype=jnp.int32) - 1, 0)
    )
    begun = jax.tree.map(lambda leaf: leaf[path.nodes[path.last]], tree.state)
    fresh = walk._replace(path=path, state=begun, move=path.moves[path.last], time=jnp.zeros(()))
    return jax.tree.map(lambda old, new: jnp.where(walk.arrived, new, old), walk, fresh)


def _chosen(tree: Tree, node: Array, config: YuSearch) -> Array:
    visits = tree.visits[node]
    explored = config.exploration * tree.prior[node] * jnp.sqrt(jnp.sum(visits)) / (1 + visits)
    score = tree.cost[node] - explored
    if config.unvisited == "first":
        score = jnp.where(visits == 0, -FAR, score)
    return jnp.argmin(jnp.where(tree.legal[node], score, FAR))


FAR = 1e30
"""Beyond every cost."""


def _climbed(tree: Tree, path: Path, leaf: Array, arrived: Array, config: YuSearch) -> Tree:
    """The tree after the edges of the path have heard of the value `leaf` at its end, should the
    simulation have `arrived`.
    """
    edges = path.nodes, path.moves
    times = jnp.where(path.on, tree.time[edges], 0.0)
    found = backed_up(tree.cost[edges], tree.visits[edges], times, leaf, quirk=config.quirk)
    rows = jnp.where(path.on & arrived, path.nodes, tree.value.shape[0])
    return tree._replace(
        cost=tree.cost.at[rows, path.moves].set(found, mode="drop"),
        visits=tree.visits.at[rows, path.moves].add(1.0, mode="drop"),
    )


SEARCHES[YuSearch] = yu_search
