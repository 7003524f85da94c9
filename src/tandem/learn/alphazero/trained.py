"""A network that has learned, as one safetensors file: its weights, and what is needed to ask it again. No code in it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.storing import store
from tandem.errors import CellError, Fault
from tandem.learn.alphazero.network import Judge, Parameters, Scorer
from tandem.learn.alphazero.yu_network import YuNetworks
from tandem.learn.dqn.network import ValueNetworks

FORMAT = "tandem network 1"

NETWORKS: dict[str, type[Judge]] = {"scorer": Scorer, "yu": YuNetworks, "values": ValueNetworks}
"""What a file says of its network's form -> that form. One more is a line here."""


@dataclass(frozen=True)
class Trained:
    """A network and its weights.

    Attributes:
      judge: the network's form.
      parameters: NumPy arrays.
      notes: where it comes from.
    """

    judge: Judge
    parameters: Parameters
    notes: Mapping[str, Any] = field(default_factory=dict)

    def save(self, path: str | Path) -> Path:
        """One file; returns where."""
        from safetensors.numpy import save

        kind = next(name for name, form in NETWORKS.items() if type(self.judge) is form)
        about = {"format": FORMAT, "network": kind, "sizes": asdict(self.judge), "notes": dict(self.notes)}  # type: ignore[call-overload]
        store(path, save(_named(self.parameters), metadata={"tandem": json.dumps(about)}))
        return Path(path)

    @classmethod
    def load(cls, path: str | Path) -> Trained:
        """What `save` wrote.

        Raises:
          CellError: the file cannot be read, or holds no such network.
        """
        from safetensors import SafetensorError, safe_open

        try:
            with safe_open(str(path), "numpy") as file:
                about = json.loads((file.metadata() or {})["tandem"])
                arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 (not a dictionary)
            if about["format"] != FORMAT:
                raise ValueError(f"its format is {about['format']!r}")
            sizes = {name: tuple(value) if isinstance(value, list) else value for name, value in about["sizes"].items()}
            judge = NETWORKS[about["network"]](**sizes)
        except (OSError, ValueError, KeyError, TypeError, SafetensorError) as error:
            raise CellError([Fault(f"is no network that can be read ({type(error).__name__}: {error}).", (), str(path))]) from error
        return cls(judge, _nested(arrays), about["notes"])


def _named(tree: Any, place: str = "") -> dict[str, np.ndarray[Any, Any]]:
    """Every array of nested dictionaries under the names that lead to it."""
    if not isinstance(tree, dict):
        return {place: np.ascontiguousarray(tree)}
    return {name: array for key, part in tree.items() for name, array in _named(part, f"{place}/{key}" if place else key).items()}


def _nested(arrays: Mapping[str, Any]) -> dict[str, Any]:
    tree: dict[str, Any] = {}
    for name, array in arrays.items():
        *parents, last = name.split("/")
        part = tree
        for parent in parents:
            part = part.setdefault(parent, {})
        part[last] = array
    return tree
