"""Trained actors that decide in NumPy, on a PC without JAX."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field

from tandem.errors import UsageError
from tandem.learn.forms import Form, key_of, parsed, unreadable
from tandem.learn.networks import ACTIVATIONS, Perceptron, forward, masked_log_softmax, sample
from tandem.learn.tensors import read_tensors, write_tensors

Array = np.ndarray[Any, Any]


class Notes(Form):
    """Where a policy comes from, as far as it says so; whoever needs more than a default asks for
    it.
    """

    model_config = ConfigDict(frozen=True, strict=True, extra="allow", allow_inf_nan=False)

    cell: str = ""
    digest: str = ""
    kind: str = ""
    recipe: str = "tandem"
    seed: int = Field(default=0, ge=0)
    stress_factor: float = Field(default=0.0, ge=0)
    pace: str = ""
    sees: str = ""
    rewards: str = ""
    people: str = ""
    waiting: bool = True


class _About(Form):
    """The document beside a policy's arrays."""

    format: Literal["tandem policy 1"]
    agents: tuple[str, ...] = Field(min_length=1)
    activation: Annotated[str, key_of(ACTIVATIONS)]
    masked: bool
    shared: bool
    notes: dict[str, Any]


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
    actor: Perceptron
    activation: str
    masked: bool
    shared: bool
    notes: Mapping[str, Any]

    @property
    def observation_size(self) -> int:
        """Numbers that each agent must be given."""
        return int(self.actor["0"]["weight"].shape[-2]) - (len(self.agents) if self.shared else 0)

    @property
    def actions(self) -> int:
        """Actions that each agent has, `K`."""
        return int(self.actor[str(len(self.actor) - 1)]["weight"].shape[-1])

    def logits(self, observation: Any, agent: str | None = None) -> Array:
        """`[A, K]` from `[A, D]`, or `[K]` from one agent's `[D]`.

        Raises UsageError for an agent that it does not know or an observation of another size.
        """
        seen = np.asarray(observation, np.float32)
        rows = range(len(self.agents)) if agent is None else [self._row(agent)]
        wanted = (
            (len(self.agents), self.observation_size) if agent is None else (self.observation_size,)
        )
        if seen.shape != wanted:
            raise UsageError(
                f"observation of shape {seen.shape}: this policy wants {wanted}, agents"
                f" {', '.join(self.agents)}."
            )
        outputs = [
            forward(
                np,
                self._network(row),
                self._input(seen[row] if agent is None else seen, row),
                self.activation,
            )
            for row in rows
        ]
        return np.stack(outputs) if agent is None else outputs[0]

    def unshared(self) -> Policy:
        """The same policy with a network for each agent: what the shared one learns of whose turn
        it is becomes each one's bias.
        """
        if not self.shared:
            return self
        number = len(self.agents)
        actor = {
            layer: {part: np.stack([array] * number) for part, array in parts.items()}
            for layer, parts in self.actor.items()
        }
        weight = self.actor["0"]["weight"]
        actor["0"] = {
            "weight": actor["0"]["weight"][:, :-number],
            "bias": actor["0"]["bias"] + weight[-number:],
        }
        return replace(self, actor=actor, shared=False)

    def predict(
        self,
        observation: Any,
        *,
        action_masks: Any = None,
        deterministic: bool = True,
        agent: str | None = None,
        generator: np.random.Generator | None = None,
    ) -> tuple[Any, None]:
        """What the agents do: `[A]` actions for `[A, D]` observations; one number for one `agent`'s
        `[D]`. Second is always None, as SB3 has it.

        Args:
          action_masks: `[A, K]` or `[K]`, true where the action is legal. Needed by a policy that
            was trained with masks.
          deterministic: the most probable action; else one drawn with `generator` (a fresh one when
            absent).

        Raises:
          UsageError: a size does not fit, the masks are missing, or a mask allows nothing.
        """
        logits = self.logits(observation, agent)
        if action_masks is None and self.masked:
            raise UsageError(
                "action_masks: this policy was trained with illegal actions ruled out; say which"
                " are legal."
            )
        legal = (
            np.ones(logits.shape, bool)
            if action_masks is None
            else np.asarray(action_masks).astype(bool)
        )
        if legal.shape != logits.shape or not legal.any(-1).all():
            raise UsageError(
                f"action_masks of shape {legal.shape}: must be {logits.shape}, with at least one"
                " legal action each."
            )
        if deterministic:
            action = np.where(legal, logits, -np.inf).argmax(-1)
        else:
            draws = (generator or np.random.default_rng()).random(logits.shape[:-1])
            action = sample(np, masked_log_softmax(np, logits, legal), draws)
        return (int(action) if agent is not None else action), None

    def save(self, path: str | Path) -> Path:
        """One safetensors file; returns where."""
        about = {
            "format": "tandem policy 1",
            "agents": list(self.agents),
            "activation": self.activation,
            "masked": self.masked,
            "shared": self.shared,
            "notes": dict(self.notes),
        }
        arrays = {
            f"{layer}/{part}": array
            for layer, parts in self.actor.items()
            for part, array in parts.items()
        }
        write_tensors(path, arrays, about)
        return Path(path)

    @classmethod
    def load(cls, path: str | Path) -> Policy:
        """What `save` wrote.

        Raises:
          CellError: the file cannot be read, is no policy, or holds no network; with everything
            that is wrong.
        """
        arrays, about = read_tensors(path, _About, "policy")
        notes = parsed(
            Path(path), json.dumps(about.notes), Notes, "is no policy: notes"
        ).model_dump(exclude_unset=True)
        if faults := list(_faults(arrays, len(about.agents), about.shared)):
            raise unreadable(path, [f"is no policy: {fault}" for fault in faults])
        actor: Perceptron = {}
        for name, array in arrays.items():
            layer, part = name.split("/")
            actor.setdefault(layer, {})[part] = array
        return cls(about.agents, actor, about.activation, about.masked, about.shared, notes)

    def _row(self, agent: str) -> int:
        if agent not in self.agents:
            raise UsageError(f"agent {agent!r}: this policy knows {', '.join(self.agents)}.")
        return self.agents.index(agent)

    def _network(self, row: int) -> Perceptron:
        return (
            self.actor
            if self.shared
            else {
                layer: {part: array[row] for part, array in parts.items()}
                for layer, parts in self.actor.items()
            }
        )

    def _input(self, seen: Array, row: int) -> Array:
        return (
            np.concatenate([seen, np.eye(len(self.agents), dtype=np.float32)[row]])
            if self.shared
            else seen
        )


def _faults(arrays: Mapping[str, Array], agents: int, shared: bool) -> Iterator[str]:
    """What keeps arrays from being the layers of an actor, one behind the other, with a leading
    axis of agents unless they share it.
    """
    layers = len(arrays) // 2
    wanted = {f"{layer}/{part}" for layer in range(layers) for part in ("weight", "bias")}
    if not layers or set(arrays) != wanted:
        yield (
            f"its arrays are {', '.join(sorted(arrays)[:6]) or 'none'}; a network has weight and"
            " bias of layers 0, 1, ... and nothing else."
        )
        return
    lead = () if shared else (agents,)
    for name, array in arrays.items():
        if array.dtype != np.float32:
            yield f"{name} holds {array.dtype} instead of float32."
        elif not np.isfinite(array).all():
            yield f"{name} holds numbers that are not finite."
    inputs = None
    for layer in range(layers):
        weight, bias = arrays[f"{layer}/weight"].shape, arrays[f"{layer}/bias"].shape
        fits = len(weight) == len(lead) + 2 and weight[: len(lead)] == lead and min(weight) > 0
        if not fits or inputs not in (None, weight[-2]):
            before = f" behind a layer of {inputs}" if inputs else ""
            yield (
                f"{layer}/weight has the shape {list(weight)}, which is no layer of {agents}"
                f" agents{' that share it' * shared}{before}."
            )
            return
        if bias != (*lead, weight[-1]):
            yield f"{layer}/bias has the shape {list(bias)} instead of {[*lead, weight[-1]]}."
        inputs = weight[-1]
    if shared and arrays["0/weight"].shape[-2] <= agents:
        yield f"0/weight sees nothing but whose turn it is among {agents} agents."
