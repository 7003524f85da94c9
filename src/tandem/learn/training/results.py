"""What trainings say: the gap of what was played to the exact optimum, and the result document."""

from __future__ import annotations

from typing import Any

from tandem.cell.model import plain
from tandem.learn.results import relative_gap
from tandem.learn.training.state import Training


def gap(training: Training, makespan: float | None, stress: float | None) -> float | None:
    """`relative_gap` under what the training's agents are paid."""
    return relative_gap(training.front, makespan, stress, **training.algorithm.paid)


def result(training: Training, *, interrupted: bool = False) -> dict[str, Any]:
    """The document of `tandem train --json`.

    `seeds[]` has what the algorithm's `play` says: `greedy` (of each agent the action it thinks
    best), `best_of_n` (the best of n plays), and what an algorithm adds. Makespan and stress are
    None where the assembly was not finished. `gap` is that of `relative_gap`.
    """
    order, front = training.order, training.front
    spent = round(training.spent() / len(order.seeds), 3)
    return {
        "schema_version": 1,
        "run": str(training.folder.path),
        "cell": order.cell.name,
        "cell_digest": order.cell.digest,
        "recipe": order.name,
        "stress_factor": plain(order.stress_factor),
        "interrupted": interrupted,
        "exact_front": []
        if front is None
        else [[plain(value) for value in point] for point in front.points],
        "exact_front_complete": front is not None and front.complete,
        "seeds": [
            {
                "seed": seed,
                "steps": row["steps"],
                "cpu_s": spent,
                **{name: _judged(training, part) for name, part in row.items() if name != "steps"},
            }
            for seed, row in zip(
                order.seeds, training.algorithm.play(training.learners), strict=True
            )
        ],
    }


def _judged(training: Training, played: Any) -> Any:
    """What was played with its gap; anything else as it is."""
    return (
        {**played, "gap": gap(training, played["makespan"], played["stress"])}
        if isinstance(played, dict)
        else played
    )
