"""Weights that were tuned to a cell, as one policy file; those that come with Tandem where there is
none.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np

from tandem.errors import UsageError
from tandem.learn.forms import Form, parsed, unreadable
from tandem.learn.graph.network import Weights
from tandem.learn.graph.weights import packed, shipped, unpacked
from tandem.learn.policy import Notes
from tandem.learn.tensors import misfits, read_tensors, write_tensors

KIND = "graph"
"""What the notes of such a file call it."""


class _About(Form):
    """The document beside the arrays."""

    format: Literal["tandem network 1"]
    network: str
    sizes: dict[str, Any]
    notes: dict[str, Any]


def save(path: Path, weights: Weights, notes: Mapping[str, Any]) -> None:
    """One file with the weights, and where they come from."""
    arrays = {name: np.asarray(part) for name, part in packed(weights).items()}
    about = {"format": "tandem network 1", "network": KIND, "sizes": {}, "notes": dict(notes)}
    write_tensors(path, arrays, about)


def notes_of(path: str | Path) -> Notes:
    """Where the weights in the file come from, as far as it says so. Raises CellError when the file
    cannot be read, or says what cannot be.
    """
    _, about = read_tensors(path, _About, "network")
    return parsed(Path(path), json.dumps(about.notes), Notes, "is no network: notes")


def weights_of(path: str | Path | None) -> Weights:
    """The weights in the file; the shipped ones for None.

    Raises:
      CellError: the file cannot be read, or holds none of this network.
      UsageError: it is a policy of another algorithm.
    """
    if path is None:
        return shipped()
    arrays, about = read_tensors(path, _About, "network")
    if about.network != KIND:
        raise UsageError(
            f"{path}: is a network of the kind {about.network!r}, and not the one for all cells."
            " Tune that to your cell with: tandem train CELL --recipe graph"
        )
    if said := misfits(arrays, packed(shipped())):
        what = f"is no network for all cells of this version: it {said}"
        raise unreadable(path, [f"{what} Tune anew with: tandem train CELL --recipe graph"])
    return unpacked(arrays)
