"""Labels as arrays, and batches of them: cells padded to a common size, the choices of all
decisions behind each other. There are few shapes, for each one is compiled.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tandem.learn.graph.candidates import ABOUT, FEATURES
from tandem.learn.graph.labels import Arrays, Label, Looks, label
from tandem.learn.graph.network import Weights
from tandem.learn.graph.outlook import Outlook

DECISIONS = 8
"""Decisions of a cell in a batch."""
SIZES = ((16, 5, 80), (32, 5, 160), (64, 5, 320), (64, 10, 700))
"""Tasks, operators and steps that cells are padded to: no larger ones are trained on."""
CHOICES = (8, 11, 13, 18)
"""Of cells of each size, choices of a decision in the mean for which a batch has room: what does
not fit is left out.
"""


@dataclass(frozen=True)
class Seen:
    """A labelled cell as the network sees it; `at` are the ends of its decisions among its choices,
    `size` is its index in `SIZES`.
    """

    label: Label
    cell: Arrays
    at: np.ndarray[Any, Any]
    size: int

    @classmethod
    def of(cls, label: Label, outlook: Outlook) -> Seen:
        """The label with the relations of its cell."""
        steps = outlook.steps
        needed = (*outlook.pairs.shape[:2], len(steps.task))
        size = next(at for at, room in enumerate(SIZES) if all(map(int.__le__, needed, room)))
        tasks, operators, rows = SIZES[size]
        lengths = {
            "tasks": (tasks,),
            "operators": (operators,),
            "pairs": (tasks, operators),
            "before": (tasks, tasks),
            "step task": (rows,),
            "step share": (rows, operators),
            "step fixed": (rows,),
        }
        parts = (
            outlook.tasks,
            outlook.operators,
            outlook.pairs,
            outlook.before,
            steps.task.astype(np.int32),
            outlook.share.astype(np.float32),
            steps.fixed,
        )
        cell: Arrays = {}
        for (name, shape), part in zip(lengths.items(), parts, strict=True):
            dtype = np.float16 if part.dtype == np.float32 else part.dtype
            cell[name] = np.zeros((*shape, *part.shape[len(shape) :]), dtype)
            cell[name][tuple(map(slice, part.shape))] = part
        return cls(label, cell, np.cumsum([0, *label.sizes]), size)


def labelled(weights: Weights | None, looks: Looks, number: int, most_tasks: int) -> Seen | None:
    """The labelled cell of this number; None where nothing is to be learned. See `label`."""
    told = label(weights, number, most_tasks, looks)
    return None if told is None else Seen.of(*told)


def batch(pool: Sequence[Sequence[Seen]], rng: np.random.Generator, cells: int) -> Arrays:
    """So many cells of one size, drawn evenly, and some decisions of each.

    Args:
      pool: for each of `SIZES` the cells of that size.

    Returns:
      of the cells `tasks`, `operators`, `pairs`, `before`, `step task`, `step share`, `step fixed`,
      padded, and `unplaced` `[cells, DECISIONS, N]`; of the choices `seen` `[R, FEATURES]`,
      `about` `[R, O, ABOUT]`, `cell`, `turn`, `row`, `decision` `[R]`, and `loss` `[R, ...]`, what
      the labels say of each; rows of padding belong to the decision behind the last.
    """
    counts = np.array([len(one) for one in pool])
    size = int(rng.choice(len(pool), p=counts / counts.sum()))
    mine = pool[size]
    drawn = [mine[at] for at in rng.integers(len(mine), size=cells)]
    rows = cells * DECISIONS * CHOICES[size]
    tasks, operators, _ = SIZES[size]
    found: Arrays = {
        "seen": np.zeros((rows, FEATURES), np.float32),
        "about": np.zeros((rows, operators, ABOUT), np.float32),
        "unplaced": np.zeros((cells, DECISIONS, tasks), np.float32),
        "cell": np.zeros(rows, np.int32),
        "turn": np.zeros(rows, np.int32),
        "row": np.zeros(rows, np.int32),
        "loss": np.zeros((rows, *drawn[0].label.losses.shape[1:]), np.float32),
        "decision": np.full(rows, cells * DECISIONS, np.int32),
    }
    begin = count = 0
    picks = [rng.integers(len(one.label.sizes), size=DECISIONS) for one in drawn]
    # turn by turn, so that what does not fit is not that of the last cells
    for turn in range(DECISIONS):
        for place, one in enumerate(drawn):
            at = picks[place][turn]
            span = slice(one.at[at], one.at[at + 1])
            end = begin + int(span.stop - span.start)
            if end > rows:
                break
            found["seen"][begin:end] = one.label.seen[span]
            found["row"][begin:end] = one.label.rows[span]
            found["loss"][begin:end] = one.label.losses[span]
            about = one.label.about[span]
            found["about"][begin:end, : about.shape[1]] = about
            unplaced = one.label.unplaced[at]
            found["unplaced"][place, turn, : len(unplaced)] = unplaced
            found["cell"][begin:end] = place
            found["turn"][begin:end] = turn
            found["decision"][begin:end] = count
            begin, count = end, count + 1
    for name in drawn[0].cell:
        found[name] = np.stack([one.cell[name] for one in drawn])
        if found[name].dtype == np.float16:
            found[name] = found[name].astype(np.float32)
    return found
