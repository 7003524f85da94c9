"""Trained actors that decide in NumPy, on a PC without JAX."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.storing import store
from tandem.errors import CellError, Fault, UsageError
from tandem.learn.networks import Network, forward, masked_log_softmax, sample

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Policy:
    """The actors of one training.

    Attributes:
      agents: their names, in the order of rows.
      actor: the network; its arrays have a leading axis of agents, unless `shared`.
      activation: between its layers.
      masked: it was trained with illegal actions ruled out, so it must be told which are legal.
      shared: one network for all, which sees a one-hot of whose turn it is.
      notes: where it comes from: cell, digest, recipe, seed, pace, what it sees.
    """

    agents: tuple[str, ...]
    actor: Network
    activation: str
    masked: bool
    shared: bool
    notes: Mapping[str, Any]

    @property
    def observation_size(self) -> int:
        """Numbers that each agent must be given."""
        return int(self.actor["0"]["weight"].shape[-2]) - (len(self.agents) if self.shared else 0)

    def logits(self, observation: Any, agent: str | None = None) -> Array:
        """`[A, K]` from `[A, D]`, or `[K]` from one agent's `[D]`.

        Raises UsageError for an agent that it does not know or an observation of another size.
        """
        seen = np.asarray(observation, np.float32)
        rows = range(len(self.agents)) if agent is None else [self._row(agent)]
        wanted = (len(self.agents), self.observation_size) if agent is None else (self.observation_size,)
        if seen.shape != wanted:
            raise UsageError(f"observation of shape {seen.shape}: this policy wants {wanted}, agents {', '.join(self.agents)}.")
        outputs = [forward(np, self._network(row), self._input(seen[row] if agent is None else seen, row), self.activation) for row in rows]
        return np.stack(outputs) if agent is None else outputs[0]

    def predict(
        self,
        observation: Any,
        *,
        action_masks: Any = None,
        deterministic: bool = True,
        agent: str | None = None,
        generator: np.random.Generator | None = None,
    ) -> tuple[Any, None]:
        """What the agents do: `[A]` actions for `[A, D]` observations; one number for one `agent`'s `[D]`. Second is always None, as SB3 has it.

        Args:
          action_masks: `[A, K]` or `[K]`, true where the action is legal. Needed by a policy that was trained with masks.
          deterministic: the most probable action; else one drawn with `generator` (a fresh one when absent).

        Raises:
          UsageError: a size does not fit, the masks are missing, or a mask allows nothing.
        """
        logits = self.logits(observation, agent)
        if action_masks is None and self.masked:
            raise UsageError("action_masks: this policy was trained with illegal actions ruled out; say which are legal.")
        legal = np.ones(logits.shape, bool) if action_masks is None else np.asarray(action_masks).astype(bool)
        if legal.shape != logits.shape or not legal.any(-1).all():
            raise UsageError(f"action_masks of shape {legal.shape}: must be {logits.shape}, with at least one legal action each.")
        if deterministic:
            action = np.where(legal, logits, -np.inf).argmax(-1)
        else:
            draws = (generator or np.random.default_rng()).random(logits.shape[:-1])
            action = sample(np, masked_log_softmax(np, logits, legal), draws)
        return (int(action) if agent is not None else action), None

    def save(self, path: str | Path) -> Path:
        """One safetensors file; returns where."""
        from safetensors.numpy import save

        about = {
            "format": "tandem policy 1",
            "agents": list(self.agents),
            "activation": self.activation,
            "masked": self.masked,
            "shared": self.shared,
            "notes": dict(self.notes),
        }
        arrays = {f"{layer}/{part}": np.ascontiguousarray(array) for layer, parts in self.actor.items() for part, array in parts.items()}
        store(path, save(arrays, metadata={"tandem": json.dumps(about)}))
        return Path(path)

    @classmethod
    def load(cls, path: str | Path) -> Policy:
        """What `save` wrote.

        Raises:
          CellError: the file cannot be read, or is no policy.
        """
        from safetensors import SafetensorError, safe_open

        try:
            with safe_open(str(path), "numpy") as file:
                about = json.loads((file.metadata() or {})["tandem"])
                arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 (not a dictionary)
            if about["format"] != "tandem policy 1":
                raise ValueError(f"its format is {about['format']!r}")
        except (OSError, ValueError, KeyError, SafetensorError) as error:
            raise CellError([Fault(f"is no policy that can be read ({type(error).__name__}: {error}).", (), str(path))]) from error
        actor: Network = {}
        for name, array in arrays.items():
            layer, part = name.split("/")
            actor.setdefault(layer, {})[part] = array
        return cls(tuple(about["agents"]), actor, about["activation"], about["masked"], about["shared"], about["notes"])

    def _row(self, agent: str) -> int:
        if agent not in self.agents:
            raise UsageError(f"agent {agent!r}: this policy knows {', '.join(self.agents)}.")
        return self.agents.index(agent)

    def _network(self, row: int) -> Network:
        return self.actor if self.shared else {layer: {part: array[row] for part, array in parts.items()} for layer, parts in self.actor.items()}

    def _input(self, seen: Array, row: int) -> Array:
        return np.concatenate([seen, np.eye(len(self.agents), dtype=np.float32)[row]]) if self.shared else seen
