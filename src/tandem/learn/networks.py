"""Networks as pure functions over an array namespace: trained under JAX, and the same lines decide
in NumPy.

A network is a nested dictionary of arrays, `{"0": {"weight": [in, out], "bias": [out]}, "1": ...}`,
layer by layer; a policy holds several. Nothing in it executes code, so it can be kept in a
safetensors file and read by anyone.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

import numpy

Array = Any
Perceptron = dict[str, dict[str, Array]]

ACTIVATIONS: tuple[str, ...] = ("relu", "tanh")


def init(
    draw: Callable[[tuple[int, ...]], Array],
    sizes: Sequence[int],
    last: float = 1.0,
    channels: Sequence[int] = (),
) -> Any:
    """A network with `sizes[0]` inputs, `sizes[-1]` outputs and the hidden layers between; biases
    0.

    Weights are uniform within +-sqrt(6 / (in + out)) (Glorot and Bengio 2010, equation 16); those
    of the last layer times `last`: a small number makes a first policy that prefers nothing.

    Args:
      draw: shape -> an array of that shape, uniform in [-1, 1), of the wanted namespace and type.
      channels: how many of the inputs belong to each channel. Every channel then has a first layer
        of its own, of `sizes[1]` units, and the second layer sees them all; needs a hidden layer.
    """

    def layer(inputs: int, outputs: int, times: float) -> dict[str, Array]:
        weight = draw((inputs, outputs)) * (math.sqrt(6 / (inputs + outputs)) * times)
        return {"weight": weight, "bias": weight[0] * 0}

    layers: dict[str, Any] = {}
    for index, (inputs, outputs) in enumerate(itertools.pairwise(sizes)):
        times = last if index == len(sizes) - 2 else 1.0
        if channels and not index:
            layers["0"] = {str(at): layer(own, outputs, times) for at, own in enumerate(channels)}
        else:
            wide = inputs * (len(channels) if index == 1 and channels else 1)
            layers[str(index)] = layer(wide, outputs, times)
    return layers


def joined(network: Any) -> Perceptron:
    """The same network with one first layer, in NumPy: the channels' weights as blocks, 0 between
    them.
    """
    if "weight" in network["0"]:
        return dict(network)
    parts = [network["0"][str(index)] for index in range(len(network["0"]))]
    units = parts[0]["weight"].shape[-1]
    blocks = []
    for index, part in enumerate(parts):
        sides = [(0, 0)] * (part["weight"].ndim - 1)
        wide = (index * units, (len(parts) - index - 1) * units)
        blocks.append(numpy.pad(part["weight"], [*sides, wide]))
    first = {
        "weight": numpy.concatenate(blocks, -2),
        "bias": numpy.concatenate([part["bias"] for part in parts], -1),
    }
    return {**network, "0": first}


def mapped(function: Callable[[Array], Array], network: Any) -> Any:
    """The same nested dictionaries, each array replaced by what the function makes of it."""
    if not isinstance(network, dict):
        return function(network)
    return {name: mapped(function, part) for name, part in network.items()}


def forward(xp: ModuleType, network: Perceptron, inputs: Array, activation: str) -> Array:
    """`[..., out]` from `inputs` `[..., in]`; the activation (`ACTIVATIONS`) stands between the
    layers, not after the last.

    Args:
      xp: the namespace of the arrays, `numpy` or `jax.numpy`.
    """
    flow = inputs
    for index in range(len(network)):
        layer = network[str(index)]
        if index:
            flow = xp.tanh(flow) if activation == "tanh" else xp.maximum(flow, 0)
        flow = _dense(layer, flow) if "weight" in layer else _by_channel(xp, layer, flow)
    return flow


def _dense(layer: Any, inputs: Array) -> Array:
    flow = inputs @ layer["weight"]
    return flow + layer["bias"].reshape((1,) * (flow.ndim - 1) + (-1,))


def _by_channel(xp: ModuleType, layers: Any, inputs: Array) -> Array:
    """`[..., channels x units]`: each channel through the layer of its own, side by side."""
    begin, outputs = 0, []
    for index in range(len(layers)):
        end = begin + layers[str(index)]["weight"].shape[-2]
        outputs.append(_dense(layers[str(index)], inputs[..., begin:end]))
        begin = end
    return xp.concatenate(outputs, -1)


def masked_log_softmax(xp: ModuleType, logits: Array, legal: Array) -> Array:
    """`[..., K]` log-probabilities over the legal actions; a very low number (about -1e9), never
    infinity, for the others.

    With infinity an illegal action's 0 x -inf would turn the entropy and every gradient into nan.
    """
    allowed = xp.where(legal, logits, xp.asarray(ILLEGAL, logits.dtype))
    shifted = allowed - allowed.max(-1, keepdims=True)
    return shifted - xp.log(xp.exp(shifted).sum(-1, keepdims=True))


ILLEGAL = -1e9


def sample(xp: ModuleType, log_probability: Array, uniform: Array) -> Array:
    """`[...]` the action drawn from `log_probability` `[..., K]` with one number `uniform` `[...]`
    in [0, 1) each.

    Inverse of the cumulative distribution: one random number a decision instead of one an action.
    An action of probability 0 is never drawn: it adds nothing to the running sum, and the draw is
    scaled by the sum that was really reached.
    """
    reached = xp.cumsum(xp.exp(log_probability), -1)
    return (reached <= uniform[..., None] * reached[..., -1:]).sum(-1)
