"""What the policy learns from: cells with the best schedule known of each, and these as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.learn.graph.candidates import FEATURES, MOST, features
from tandem.learn.graph.making import Maker, retold
from tandem.learn.graph.network import Weights
from tandem.learn.graph.outlook import OPERATOR, PAIR, TASK, Outlook
from tandem.learn.graph.training_cells import training_cell
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, PartialSchedule
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.plan.rules import SWEEP, exchange_of

MOST_TASKS, MOST_OPERATORS, MOST_STEPS = 40, 5, 256
"""The sizes that arrays are padded to: no larger cell is trained on."""
WITHOUT_STRESS = 0.4
"""The share of cells in which time alone counts."""

Arrays = dict[str, np.ndarray[Any, Any]]


@dataclass(frozen=True)
class Label:
    """The best schedule that is known of a training cell.

    Attributes:
      number: of the cell, see `training_cell`; `most_tasks` as it was drawn.
      exchange: ticks that a unit of stress is worth.
      starts: per task `(way, start in ticks)`.
    """

    number: int
    most_tasks: int
    exchange: float
    starts: tuple[tuple[int, int], ...]

    def outlook(self) -> Outlook:
        """The cell as the network sees it."""
        return Outlook.of(layout_of(training_cell(self.number, self.most_tasks)), self.exchange)


def layout_of(cell: Cell) -> Layout:
    """The cell as list scheduling wants it."""
    return Layout.of(Instance.of(cell))


def drawn_exchange(number: int, layout: Layout) -> float:
    """Ticks that a unit of stress is worth in the training cell of this number."""
    rng = np.random.default_rng((7, number))
    if rng.random() < WITHOUT_STRESS:
        return 0.0
    return float(rng.choice(SWEEP[1:-2])) * exchange_of(layout)


def exact_label(number: int, most_tasks: int, work: float) -> Label | None:
    """The schedule that the exact method finds by so much work, the canonical one: of many optimal
    schedules always the one of the same kind, with early starts. None where it finds none.
    """
    cell = training_cell(number, most_tasks)
    layout = layout_of(cell)
    exchange = drawn_exchange(number, layout)
    instance = layout.instance
    question = Question(
        minimize="weighted",
        weights=(1.0, exchange * instance.per_stress / instance.per_second),
    )
    try:
        (found, *_) = plan(cell, question, work=work, workers=1, confirm=False, seed=0)
    except (InfeasibleError, NothingFoundError):
        return None
    return Label(number, most_tasks, exchange, tuple(instance.starts(found.schedule)))


def own_label(weights: Weights, number: int, most_tasks: int, samples: int) -> Label | None:
    """The best of the schedules that the policy makes itself, one greedy and the others drawn."""
    layout = layout_of(training_cell(number, most_tasks))
    exchange = drawn_exchange(number, layout)
    maker = Maker.of(weights, Outlook.of(layout, exchange))
    rng = np.random.default_rng((11, number))
    made = [maker.build(None if not sample else rng) for sample in range(samples)]
    sound = [state for state in made if state is not None]
    if not sound:
        return None
    # of equals the one with early starts, as the exact ones have them
    best = min(sound, key=lambda state: (cost(state, exchange), sum(state.start)))
    return Label(number, most_tasks, exchange, tuple(best.starts()))


def cost(state: PartialSchedule, exchange: float) -> float:
    """Ticks: the makespan, and what the stress is worth."""
    return state.makespan + exchange * state.stress


def arrays(label: Label) -> Arrays:
    """The decisions that lead to the label's schedule, padded; `target` is 1 for each choice that
    may come next, and everywhere 0 in decisions that leave no choice.
    """
    outlook = label.outlook()
    count, operators = outlook.pairs.shape[:2]
    steps = len(outlook.steps.task)
    found: Arrays = {
        "tasks": np.zeros((MOST_TASKS, TASK), np.float32),
        "operators": np.zeros((MOST_OPERATORS, OPERATOR), np.float32),
        "pairs": np.zeros((MOST_TASKS, MOST_OPERATORS, PAIR), np.float32),
        "before": np.zeros((MOST_TASKS, MOST_TASKS), np.float32),
        "step task": np.zeros(MOST_STEPS, np.int32),
        "step share": np.zeros((MOST_STEPS, MOST_OPERATORS), np.float32),
        "seen": np.zeros((MOST_TASKS, MOST, FEATURES), np.float16),
        "row": np.zeros((MOST_TASKS, MOST), np.int32),
        "legal": np.zeros((MOST_TASKS, MOST), bool),
        "target": np.zeros((MOST_TASKS, MOST), bool),
    }
    found["tasks"][:count] = outlook.tasks
    found["operators"][:operators] = outlook.operators
    found["pairs"][:count, :operators] = outlook.pairs
    found["before"][:count, :count] = outlook.before
    found["step task"][:steps] = outlook.steps.task
    found["step share"][:steps, :operators] = outlook.steps.share
    for at, (making, choices, which) in enumerate(retold(outlook, label.starts)):
        if len(choices) < 2:
            continue
        found["seen"][at, : len(choices)] = features(making, choices)
        found["row"][at, : len(choices)] = [choice.row for choice in choices]
        found["legal"][at, : len(choices)] = True
        found["target"][at, which] = True
    return found


def stacked(labels: Sequence[Label]) -> Arrays:
    """The arrays of all labels, label by label."""
    each = [arrays(label) for label in labels]
    return {key: np.stack([one[key] for one in each]) for key in each[0]}
