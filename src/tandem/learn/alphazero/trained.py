"""A network that has learned, as one safetensors file: its weights, and what is needed to ask it
again. No code in it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from tandem.learn.alphazero.network import Network, Parameters
from tandem.learn.forms import Form, SettingsError, unreadable
from tandem.learn.settings import read
from tandem.learn.tensors import misfits, read_tensors, write_tensors

FORMAT = "tandem network 1"


class _About(Form):
    """The document beside a network's arrays."""

    format: Literal["tandem network 1"]
    network: str
    sizes: dict[str, Any]
    notes: dict[str, Any]


@dataclass(frozen=True)
class Trained:
    """A network and its weights.

    Attributes:
      network: its form.
      parameters: NumPy arrays.
      notes: where it comes from.
    """

    network: Network
    parameters: Parameters
    notes: Mapping[str, Any] = field(default_factory=dict)

    def save(self, path: str | Path) -> Path:
        """One file; returns where."""
        about = {
            "format": FORMAT,
            "network": self.network.kind,
            "sizes": asdict(self.network),  # type: ignore[call-overload]
            "notes": dict(self.notes),
        }
        write_tensors(
            path,
            {name: np.asarray(array) for name, array in _named(self.parameters).items()},
            about,
        )
        return Path(path)

    @classmethod
    def load(cls, path: str | Path, *forms: type[Network]) -> Trained:
        """What `save` wrote of a network of one of these forms.

        Raises:
          CellError: the file cannot be read, or holds no such network; with everything that is
            wrong.
        """
        arrays, about = read_tensors(path, _About, "network")
        known = {form.kind: form for form in forms}
        if about.network not in known:
            raise unreadable(
                path,
                [
                    f"is no network: network {about.network!r}: choose"
                    f" {' or '.join(map(repr, known))}."
                ],
            )
        try:
            network = read(known[about.network], about.sizes)
        except SettingsError as error:
            raise unreadable(
                path, [f"is no network: sizes.{fault}" for fault in error.faults]
            ) from None
        if said := misfits(arrays, _named(network.like(arrays))):
            raise unreadable(path, [f"is no network of its sizes: it {said}"])
        return cls(network, _nested(arrays), about.notes)


def _named(tree: Any, place: str = "") -> dict[str, Any]:
    """Every array of nested dictionaries under the names that lead to it."""
    if not isinstance(tree, dict):
        return {place: tree}
    return {
        name: array
        for key, part in tree.items()
        for name, array in _named(part, f"{place}/{key}" if place else key).items()
    }


def _nested(arrays: Mapping[str, Any]) -> dict[str, Any]:
    tree: dict[str, Any] = {}
    for name, array in arrays.items():
        *parents, last = name.split("/")
        part = tree
        for parent in parents:
            part = part.setdefault(parent, {})
        part[last] = array
    return tree
