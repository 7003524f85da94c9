"""Weights as plain arrays by name, in a file without code, and those that are shipped."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from tandem.learn.graph.network import Weights

SHIPPED = "weights.npz"
"""The file of this room that holds the weights which `learned` takes."""


def packed(weights: Weights) -> dict[str, Any]:
    """`{"a": {"b": array}}` as `{"a/b": array}`."""
    found: dict[str, Any] = {}
    for name, part in weights.items():
        if isinstance(part, dict):
            found |= {f"{name}/{below}": array for below, array in packed(part).items()}
        else:
            found[name] = part
    return found


def unpacked(leaves: dict[str, Any]) -> Weights:
    """The inverse of `packed`."""
    found: Weights = {}
    for name, array in leaves.items():
        at = found
        *path, last = name.split("/")
        for part in path:
            at = at.setdefault(part, {})
        at[last] = array
    return found


def write_weights(path: Path, weights: Weights) -> None:
    """One file with the weights."""
    leaves: dict[str, Any] = {name: np.asarray(one) for name, one in packed(weights).items()}
    with path.open("wb") as file:
        np.savez(file, **leaves)


@cache
def shipped() -> Weights:
    """The weights that come with Tandem."""
    with (
        files("tandem.learn.graph").joinpath(SHIPPED).open("rb") as file,
        np.load(file, allow_pickle=False) as arrays,
    ):
        return unpacked({name: arrays[name] for name in arrays.files})
