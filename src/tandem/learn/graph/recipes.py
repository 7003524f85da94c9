"""The recipe that tunes the policy for any cell to one's own."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

from pydantic import Field

from tandem.learn.settings import Count, Positive, checked

MOST_SCHEDULES = 10_000
"""That are drawn in a round of a cell."""


@checked
@dataclass(frozen=True)
class GraphRecipe:
    """How the shipped weights are tuned to a cell, or to several.

    Attributes:
      rounds: each draws schedules of each cell, keeps the best that was ever seen, and learns it.
      samples: schedules of a cell and weight of stress in a round; so many are played with what was
        learned, too.
      steps: of the optimiser in a round, one cell after the other.
      rate: of Adam; it falls to a tenth.
      weights: of stress beside the one that is asked for, in the cell's own mean time per mean
        stress; for cells with stress.
      beside: further cells to tune to, as plain values; None for no others.
      what: it is, in a line; no setting.
    """

    rounds: Count = 12
    samples: Annotated[int, Field(ge=2, le=MOST_SCHEDULES)] = 64
    steps: Count = 60
    rate: Positive = 3e-4
    weights: Annotated[tuple[Positive, ...], Field(min_length=1)] = (0.3, 1.5)
    beside: Annotated[tuple[dict[str, Any], ...], Field(min_length=1)] | None = None
    what: str = field(default="", compare=False, kw_only=True)

    algorithm: ClassVar[str] = "graph"

    def to_dict(self) -> dict[str, Any]:
        return {
            "rounds": self.rounds,
            "samples": self.samples,
            "steps": self.steps,
            "rate": self.rate,
            "weights": list(self.weights),
            "beside": None if self.beside is None else list(self.beside),
        }


GRAPH = GraphRecipe(
    what="the network for all cells, tuned to this one or to a folder of cells: it learns the best"
    " schedules that it or the planner finds",
)
"""Ours: self-labelling from the shipped weights on."""
