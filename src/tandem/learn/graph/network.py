"""The network: nodes and relations of a cell in, a number for each choice out. Pure functions over
an array namespace: trained under JAX, and the same lines decide in NumPy.

Tasks and operators tell each other what they are in `ROUNDS` rounds of messages, means over those
who have to do with each other, so that the order in which they stand changes nothing (permutation
equivariant). This is done once a cell. Each decision then takes one small perceptron over its
choices: what can be seen of a choice now, what its task and its operators were found to be, and how
all operators would stand then, with what is left to them.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

from tandem.learn.graph.candidates import ABOUT, FEATURES
from tandem.learn.graph.outlook import FIXED, OPERATOR, PAIR, TASK
from tandem.learn.networks import forward, init

Array = Any
Weights = dict[str, Any]

WIDTH, HIDDEN, ROUNDS, CROWD = 32, 160, 2, 32


def fresh(draw: Callable[[tuple[int, ...]], Array]) -> Weights:
    """Weights of a policy that prefers nothing yet. `draw` as `networks.init` takes it."""
    found: Weights = {
        "task": init(draw, (TASK, WIDTH)),
        "operator": init(draw, (OPERATOR, WIDTH)),
        "step": init(draw, (2 * WIDTH + FIXED, HIDDEN)),
        "choice": init(draw, (FEATURES, HIDDEN, HIDDEN, 1), last=0.1),
        "ahead": init(draw, (2 * WIDTH + PAIR, 2 * WIDTH, CROWD)),
        "operators": init(draw, (ABOUT + WIDTH, CROWD, HIDDEN)),
    }
    # the first layer's bias is that of the step
    del found["choice"]["0"]["bias"], found["operators"]["1"]["bias"]
    for turn in range(ROUNDS):
        found[f"to operators {turn}"] = init(draw, (2 * WIDTH + PAIR, 2 * WIDTH, WIDTH))
        found[f"to tasks {turn}"] = init(draw, (4 * WIDTH + PAIR, 2 * WIDTH, WIDTH))
    return found


def nodes(
    xp: ModuleType, weights: Weights, tasks: Array, operators: Array, pairs: Array, before: Array
) -> tuple[Array, Array]:
    """`[N, WIDTH]` and `[O, WIDTH]`: what each task and each operator is among the others.

    Rows of tasks that are only padding have no pairs and wait for nothing; they change nothing of
    the others.
    """
    able = pairs[..., 2:3]
    task = forward(xp, weights["task"], tasks, "relu")
    operator = forward(xp, weights["operator"], operators, "relu")
    firsts = before / xp.maximum(before.sum(1, keepdims=True), 1)
    lasts = before.T / xp.maximum(before.sum(0)[:, None], 1)
    for turn in range(ROUNDS):
        told = _of_pairs(xp, weights[f"to operators {turn}"], task, operator, pairs) * able
        operator = operator + told.sum(0) / xp.maximum(able.sum(0), 1)
        mine = (operator[None] * able).sum(1) / xp.maximum(able.sum(1), 1)
        pair = (pairs * able).sum(1) / xp.maximum(able.sum(1), 1)
        heard = xp.concatenate([task, firsts @ task, lasts @ task, mine, pair], -1)
        task = task + forward(xp, weights[f"to tasks {turn}"], heard, "relu")
    return task, operator


def _of_pairs(
    xp: ModuleType, network: Weights, task: Array, operator: Array, pairs: Array
) -> Array:
    """`[N, O, ...]`: a perceptron over task, operator and pair; in its first layer the tasks' and
    the operators' shares are worked out before they meet.
    """
    first, second = network["0"], network["1"]
    of_task, of_operator, of_pair = xp.split(first["weight"], (WIDTH, 2 * WIDTH))
    own = task @ of_task + first["bias"][None]
    flow = own[:, None] + (operator @ of_operator)[None] + pairs @ of_pair
    return xp.maximum(flow, 0) @ second["weight"] + second["bias"][None, None]


def lasting(xp: ModuleType, weights: Weights, task: Array, group: Array, fixed: Array) -> Array:
    """`[..., HIDDEN]`: what of a step never changes adds to the first layer of each decision.

    Args:
      task, group: `[..., WIDTH]`, what the step's task is, and the mean of what its operators are.
      fixed: `[..., FIXED]`, what can be seen of the step itself.
    """
    return forward(xp, weights["step"], xp.concatenate([task, group, fixed], -1), "relu")


def ahead(
    xp: ModuleType, weights: Weights, task: Array, operator: Array, pairs: Array
) -> tuple[Array, Array, Array]:
    """What of the operators never changes.

    Returns:
      `[N, O, CROWD]`, what each task is to each operator as long as it is not placed; `[O, CROWD]`,
      what each operator is by itself; `[O]`, by what share each counts: those who can do nothing
      are padding.
    """
    found = _of_pairs(xp, weights["ahead"], task, operator, pairs) * pairs[..., 2:3]
    first = weights["operators"]["0"]
    able = pairs[..., 2].max(0)
    return found, operator @ first["weight"][ABOUT:] + first["bias"][None], able / able.sum()


def crowd(xp: ModuleType, weights: Weights, own: Array, about: Array, share: Array) -> Array:
    """`[K, HIDDEN]`: what the operators add to the first layer, as they stand once a choice is
    placed.

    Args:
      own: `[K or 1, O, CROWD]`, what each operator is by itself, and the mean of what the tasks not
        placed are to it.
      about: `[K, O, ABOUT]`. share: `[K or 1, O]`.
    """
    first, second = (weights["operators"][str(at)]["weight"] for at in range(2))
    flow = xp.maximum(about @ first[:ABOUT] + own, 0)
    return (share[:, None] @ flow)[:, 0] @ second


def scores(xp: ModuleType, weights: Weights, seen: Array, lasting: Array) -> Array:
    """`[K]` logits of the choices.

    Args:
      seen: `[K, FEATURES]`, what can be seen of the choices now.
      lasting: `[K, HIDDEN]`, of their steps.
    """
    first, second, last = (weights["choice"][str(at)] for at in range(3))
    flow = xp.maximum(seen @ first["weight"] + lasting, 0)
    flow = xp.maximum(flow @ second["weight"] + second["bias"][None], 0)
    return flow @ last["weight"][:, 0] + last["bias"]
