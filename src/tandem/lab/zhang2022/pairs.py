"""Two actors and the critic they share: how a pair of choices comes about.

Each actor scores its own choices. The best few of each are candidates; the critic values every
legal pair of them, and the pair of the highest value is taken. Nothing is drawn here, so the same
inputs give the same pair: deterministic choice by Q-value.

Source: Zhang et al. (2022), RCIM 73, 102227, as far as it is public: two actors, one critic, a
deterministic choice by Q over discrete operations. That few candidates a actor go to the critic is
ours, after Dulac-Arnold et al. (2015), arXiv:1512.07679, section 4.

Pure functions over an array namespace: trained under JAX, and the same lines decide in NumPy. No
leading axes here: `vmap` adds them. Axes: 2 agents, row 0 and row 1, of whom row 1 names first; `D`
observed numbers each, `K` choices each, `C` candidates each, `H` units.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any, NamedTuple

from tandem.learn.networks import ILLEGAL, Perceptron, forward

Array = Any
Networks = dict[str, Perceptron]
"""`actors` (every array with a leading axis of 2) and `critic`."""

FIRST, SECOND = 1, 0
"""Rows of the agent that names first, and of the one that answers."""


class Candidates(NamedTuple):
    """The pairs that the critic is asked about.

    second: `[C, C, K]` float, one-hot: for each candidate of the first agent (axis 0) the
    candidates of the second's answer (axis 1). first: `[C, K]` float, one-hot. legal: `[C, C]`
    bool. Where fewer than `C` choices are legal the rest is not.
    """

    second: Array
    first: Array
    legal: Array


def scores(xp: ModuleType, actors: Perceptron, seen: Array, activation: str) -> Array:
    """`[2, K]` in (-1, 1), what the actors think of their choices; `seen` is `[2, D]`."""
    rows = [
        forward(
            xp,
            {
                layer: {name: part[row] for name, part in parts.items()}
                for layer, parts in actors.items()
            },
            seen[row],
            activation,
        )
        for row in (0, 1)
    ]
    return xp.tanh(xp.stack(rows))


def candidates(xp: ModuleType, score: Array, pairs: Array, number: int) -> Candidates:
    """The best `number` choices of the first agent by its scores, and for each the best answers of
    the second.

    Args:
      score: `[2, K]`.
      pairs: `[K, K]` bool, `pairs[i, j]`: the second agent may do i while the first does j. At
        least one is True.
    """
    first, some = _best(xp, score[FIRST][None], xp.any(pairs, axis=0)[None], number)
    answers = xp.einsum("ij,cj->ci", pairs.astype(score.dtype), first[0]) > 0
    second, legal = _best(xp, xp.broadcast_to(score[SECOND][None], answers.shape), answers, number)
    return Candidates(second, first[0], legal & some[0][:, None])


def best_pair(xp: ModuleType, value: Array, asked: Candidates) -> Array:
    """`[2]` int32, the legal pair of the highest `value` `[C, C]`; the first of equals."""
    index = xp.argmax(xp.where(asked.legal, value, ILLEGAL).reshape(-1))
    number = value.shape[0]
    chosen = (asked.second.reshape(number * number, -1)[index], asked.first[index // number])
    return xp.stack([xp.argmax(one) for one in chosen]).astype(xp.int32)


def value_of(
    xp: ModuleType, critic: Perceptron, seen: Array, second: Array, first: Array, activation: str
) -> Array:
    """`[]`, the critic's value of two choices `[K]` each: one-hot, or probabilities."""
    choice = xp.concatenate([second, first])
    return _rest(
        xp,
        critic,
        _seen(critic, seen) + choice @ _choice_weights(critic, choice.shape[0]),
        activation,
    )


def values_of(
    xp: ModuleType, critic: Perceptron, seen: Array, asked: Candidates, activation: str
) -> Array:
    """`[C, C]`, the critic's value of every candidate pair. What the pairs have in common is worked
    out once.
    """
    number = asked.first.shape[-1]
    weights = _choice_weights(critic, 2 * number)
    common = _seen(critic, seen)[None, None] + (asked.first @ weights[number:])[:, None]
    return _rest(xp, critic, common + asked.second @ weights[:number], activation)


def choose(
    xp: ModuleType,
    networks: Networks,
    seen: Array,
    pairs: Array,
    number: int,
    activation: str,
    noise: Array | None = None,
    strays: Array | None = None,
) -> Array:
    """`[2]` int32, what the two do: the candidates' best pair in the critic's eyes.

    Args:
      seen: `[2, D]`. pairs: `[K, K]` bool, see `candidates`. number: candidates an actor. noise,
        strays: see `asked_with`.
    """
    asked = asked_with(
        xp, scores(xp, networks["actors"], seen, activation), pairs, number, noise, strays
    )
    return best_pair(xp, values_of(xp, networks["critic"], seen, asked, activation), asked)


def asked_with(
    xp: ModuleType,
    score: Array,
    pairs: Array,
    number: int,
    noise: Array | None,
    strays: Array | None,
) -> Candidates:
    """`candidates`, with noise in the first agent's actor.

    Args:
      noise: `[K]`, added to the first agent's scores; None, as `strays`, for none.
      strays: `[]` bool, where True the first agent does what its noisy actor says, not what the
        critic would prefer: it stands for a human who is not steered by a computer. The second
        agent answers as ever.
    """
    if noise is None or strays is None:
        return candidates(xp, score, pairs, number)
    asked = candidates(xp, xp.stack([score[SECOND], score[FIRST] + noise]), pairs, number)
    return asked._replace(legal=asked.legal & ((xp.arange(number) == 0)[:, None] | ~strays))


def _best(xp: ModuleType, score: Array, legal: Array, number: int) -> tuple[Array, Array]:
    """`[..., number, K]` one-hot of the best legal choices in falling order, and `[..., number]`
    bool where there is one.

    By counting who is better: for a few dozen choices that is cheaper than to sort.
    """
    places = xp.arange(score.shape[-1])
    allowed = xp.where(legal, score, ILLEGAL)
    mine, other = allowed[..., :, None], allowed[..., None, :]
    before = (other > mine) | (
        (other == mine)
        & (places[None, :] < places[:, None]).reshape((1,) * (score.ndim - 1) + (len(places),) * 2)
    )
    rank = before.sum(-1)
    chosen = (
        rank[..., None, :] == xp.arange(number).reshape((1,) * (score.ndim - 1) + (-1, 1))
    ) & legal[..., None, :]
    return chosen.astype(score.dtype), xp.any(chosen, axis=-1)


def _seen(critic: Perceptron, seen: Array) -> Array:
    """`[H]`, what the observation brings to the critic's first layer."""
    flat = seen.reshape(-1)
    return flat @ critic["0"]["weight"][: flat.shape[0]] + critic["0"]["bias"]


def _choice_weights(critic: Perceptron, number: int) -> Array:
    return critic["0"]["weight"][-number:]


def _rest(xp: ModuleType, critic: Perceptron, flow: Array, activation: str) -> Array:
    """`[...]` from what reached the critic's first layer, `[..., H]`."""
    flow = xp.tanh(flow) if activation == "tanh" else xp.maximum(flow, 0)
    later = {str(index - 1): critic[str(index)] for index in range(1, len(critic))}
    return forward(xp, later, flow, activation)[..., 0]
