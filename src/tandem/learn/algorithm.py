"""The contract between the trainer and the algorithms: what is ordered, and what an algorithm must
offer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.files.messages import shown
from tandem.learn.results import Reached
from tandem.world.arrays import Array, Arrays
from tandem.world.state import State

Learners = Any
"""All that a training needs to go on: a tree of arrays whose leading axis are the seeds; a
checkpoint holds it whole.
"""

Row = dict[str, Any]


class AnyRecipe(Protocol):
    """A recipe of any algorithm: frozen data that says which one, and that can be written down."""

    @property
    def what(self) -> str:
        """What it is, in a line."""

    @property
    def algorithm(self) -> str:
        """A name in `tandem.learn.training.algorithms.ALGORITHMS`."""

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""


@dataclass(frozen=True)
class TrainingOrder:
    """What is to be trained.

    Attributes:
      recipe: and `name`, what it is called.
      seeds: one training each, side by side.
      stress_factor: how much a unit of stress counts in the rewards.
      front_limit: seconds that the planner has for the exact front, against which everything is
        held.
    """

    cell: Cell
    recipe: AnyRecipe
    name: str = "tandem"
    seeds: tuple[int, ...] = (0,)
    stress_factor: float = 0.0
    front_limit: float = 30.0

    def __post_init__(self) -> None:
        if not self.seeds or len(set(self.seeds)) < len(self.seeds):
            raise UsageError(
                f"seeds {', '.join(map(str, self.seeds)) or 'empty'}: give one or more, each once."
            )
        if not all(0 <= seed < 2**32 for seed in self.seeds):
            raise UsageError(
                f"seeds {shown(self.seeds[0])} ...: each is a whole number from 0 to {2**32 - 1}."
            )
        if not (np.isfinite(self.stress_factor) and self.stress_factor >= 0):
            raise UsageError(f"stress factor {self.stress_factor}: must be a number, 0 or more.")
        if not (np.isfinite(self.front_limit) and self.front_limit > 0):
            raise UsageError(
                f"front limit {self.front_limit}: must be a number of seconds above 0."
            )

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "cell": self.cell.to_dict(),
            "recipe": self.name,
            "algorithm": self.recipe.algorithm,
            "settings": self.recipe.to_dict(),
            "seeds": list(self.seeds),
            "stress_factor": self.stress_factor,
            "front_limit": self.front_limit,
        }


class Algorithm(Protocol):
    """One algorithm on one order, all its seeds side by side. It keeps nothing that changes: what
    does is in `Learners`.
    """

    def __init__(self, order: TrainingOrder) -> None:
        """Raises CellError when it cannot hold the order's cell."""

    @staticmethod
    def players(
        path: Path, cell: Cell, order: TrainingOrder, *, seed: int, episodes: int
    ) -> dict[str, list[Reached]]:
        """How the policy in a file plays a cell: player -> episodes; "greedy" (of each agent the
        action it thinks best) is one of them.

        Raises CellError when the file is no policy of this algorithm, UsageError when it does not
        fit the cell.
        """

    @staticmethod
    def costs(cell: Cell, order: TrainingOrder) -> dict[str, Any]:
        """What time and stress cost on that cell, as `results.cost` takes it."""

    @property
    def paid(self) -> dict[str, Any]:
        """What time and stress cost, as `results.cost` takes it: `step`, `per_second`,
        `stress_factor`.
        """

    def begin(self) -> Learners:
        """Learners that know nothing yet."""

    def advance(self, learners: Learners) -> tuple[Learners, Any]:
        """One interval more, and a report on it; its `finite` (`[S]` or `[S, ...]` bool) says
        whether every number still is.
        """

    def share(self, learners: Learners) -> float:
        """How much of the budget the slowest seed has behind it; 1 when all have ended."""

    def rows(self, learners: Learners, report: Any) -> Sequence[Row]:
        """Each seed's figures after an interval: `steps`, `episodes`, `greedy_makespan`,
        `greedy_stress`, `greedy_illegal` and the algorithm's own.

        Makespan and stress are None when the assembly was not finished.
        """

    def play(self, learners: Learners) -> Sequence[Row]:
        """Each seed's result: `steps`, and how what was learned plays: `greedy`, `best_of_n` (with
        `n`) and the algorithm's own.

        Each is `{"makespan": seconds or None, "stress": ..., "illegal": ...}`.
        """

    def save_policy(self, learners: Learners, index: int, path: Path) -> None:
        """Writes the policy of the seed at that index."""


class Pairs(Protocol):
    """What an algorithm has besides whose robots can play with the humans of another policy in a
    world of its own. Those of `tandem.learn.training.algorithms.DECIDERS` need none: they are put
    together in the event world.
    """

    @staticmethod
    def pair(
        robot: Path,
        human: Path,
        cell: Cell,
        order: TrainingOrder,
        *,
        seed: int,
        episodes: int,
        draws: bool,
    ) -> list[Reached]:
        """Episodes on the cell of the robots of one file beside the humans of another: one in which
        all do what they think best, or so many with drawn actions.

        Raises CellError for a file that is no policy of the algorithm, UsageError for two that
        cannot play together.
        """


Worth = Callable[[Arrays, State, Array, Array], Array]
"""`[W + 1]` float32, how much is to be said for each way, the last one being to wait; minus
infinity for what is not legal. Of the cell, how it stands, `[W]` bool what may begin now, `[]` int
whose turn it is.
"""


@dataclass(frozen=True)
class Learnt:
    """What was learned, as it decides on one cell: in NumPy, where there is no JAX.

    Attributes:
      worth: of each choice. The best is taken.
      believes: e to the power of a worth is in proportion to how sure it is of that choice. Else a
        worth is minus a cost, and says nothing of that kind.
    """

    worth: Worth
    believes: bool = True


Reader = Callable[[Path, Cell], Learnt]
"""The policy in a file, as it decides on the cell: what an algorithm whose policies can be
dispatched adds to `tandem.learn.training.algorithms.DECIDERS`. It loads no JAX.

Raises CellError when the file is no policy of the algorithm, UsageError when it does not fit the
cell.
"""
