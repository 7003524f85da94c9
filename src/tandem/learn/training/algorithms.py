"""What the trainer asks of an algorithm, and the table of algorithms. One more is a module with a `Trainee`, and a line here."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from tandem.learn.algorithm import Order

Learners = Any
"""All that a training needs to go on: a tree of arrays whose leading axis are the seeds; a checkpoint holds it whole."""

Row = dict[str, Any]


class Algorithm(Protocol):
    """One algorithm on one order, all its seeds side by side. It keeps nothing that changes: what does is in `Learners`."""

    @property
    def paid(self) -> dict[str, Any]:
        """What time and stress cost, as `gaps.cost` takes it: `step`, `per_second`, `stress_factor`."""

    def begin(self) -> Learners:
        """Learners that know nothing yet."""

    def advance(self, learners: Learners) -> tuple[Learners, Any]:
        """One interval more, and a report on it; its `finite` (`[S]` or `[S, ...]` bool) says whether every number still is."""

    def share(self, learners: Learners) -> float:
        """How much of the budget the slowest seed has behind it; 1 when all have ended."""

    def rows(self, learners: Learners, report: Any) -> Sequence[Row]:
        """Each seed's figures after an interval: `steps`, `episodes`, `greedy_makespan`, `greedy_stress`, `greedy_illegal` and the algorithm's own.

        Makespan and stress are None when the assembly was not finished.
        """

    def play(self, learners: Learners) -> Sequence[Row]:
        """Each seed's result: `steps`, and how what was learned plays: `greedy`, `best_of_n` (with `n`) and the algorithm's own.

        Each is `{"makespan": seconds or None, "stress": ..., "illegal": ...}`.
        """

    def save_policy(self, learners: Learners, place: int, path: Path) -> None:
        """Writes the policy of the seed at that place."""


ALGORITHMS = {
    "ppo": "tandem.lab.kinat2023.trainee",
    "alphazero": "tandem.learn.alphazero.trainee",
    "yu": "tandem.lab.yu2020.trainee",
    "dqn": "tandem.learn.dqn.trainee",
    "response": "tandem.learn.ppo.trainee",
}
"""Name -> the module with its `Trainee`, which is made from an order."""


def algorithm(order: Order) -> Algorithm:
    """The order's algorithm. Raises CellError when it cannot hold the cell."""
    made: Algorithm = import_module(ALGORITHMS[order.recipe.algorithm]).Trainee(order)
    return made
