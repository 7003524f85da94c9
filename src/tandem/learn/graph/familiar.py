"""Whether a cell is like those that the policy for any cell learned on, in numbers that a planner
can check; and how sure the policy is of its choices in it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from importlib.resources import files

import numpy as np

from tandem.plan.list_scheduling import Layout
from tandem.plan.result import Beyond, Confidence

SEEN = "seen.json"
"""The file of this room that holds the least and the greatest of each fact in training cells, as
`benchmarks/graph_seen.py` counts them.
"""
Range = tuple[float, float]


def _per_operator(layout: Layout) -> float:
    return len(layout.steps) / len(layout.instance.operators)


def _ways(layout: Layout) -> float:
    return sum(map(len, layout.steps)) / len(layout.steps)


def _slowest(layout: Layout) -> float:
    """How many times the quickest way the slowest one takes, mean over the tasks."""
    most = [max(step.ticks for step in row) for row in layout.steps]
    quick = [max(1, ticks) for ticks in layout.quickest]
    return float(np.mean([slow / ticks for slow, ticks in zip(most, quick, strict=True)]))


def _longest(layout: Layout) -> float:
    """The longest task in mean task times."""
    return max(layout.quickest) / max(float(np.mean(layout.quickest)), 1e-9)


def _chain(layout: Layout) -> float:
    """The longest chain beside an even share of all work."""
    even = sum(layout.quickest) / len(layout.instance.operators)
    return max(layout.tail) / max(even, 1e-9)


FACTS: dict[str, Callable[[Layout], float]] = {
    "tasks": lambda layout: len(layout.steps),
    "operators": lambda layout: len(layout.instance.operators),
    "tasks_per_operator": _per_operator,
    "ways_per_task": _ways,
    "slowest_way": _slowest,
    "longest_task": _longest,
    "chain": _chain,
    "breaks": lambda layout: layout.instance.has_breaks,
    "deadlines": lambda layout: any(one is not None for one in layout.instance.deadline),
    "releases": lambda layout: any(layout.instance.release),
    "waits": lambda layout: layout.instance.has_lags,
    "limits": lambda layout: layout.instance.has_limits,
    "set_up": lambda layout: layout.instance.has_preparations,
    "teams": lambda layout: layout.instance.has_teams,
    "held_parts": lambda layout: layout.instance.has_holds,
}
"""Name -> the number; of what a cell has or has not, 1 or 0."""


def facts(layout: Layout) -> dict[str, float]:
    """The numbers of a cell."""
    return {name: round(float(of(layout)), 3) for name, of in FACTS.items()}


def ranges(layouts: Iterable[Layout]) -> dict[str, Range]:
    """The least and the greatest of each number over the cells."""
    rows = [facts(layout) for layout in layouts]
    return {
        name: (min(row[name] for row in rows), max(row[name] for row in rows)) for name in FACTS
    }


@cache
def seen() -> dict[str, Range]:
    """The ranges over the cells that the shipped weights were trained on."""
    text = files("tandem.learn.graph").joinpath(SEEN).read_text(encoding="utf-8")
    return {name: (least, most) for name, (least, most) in json.loads(text)["ranges"].items()}


def beyond(layout: Layout) -> tuple[Beyond, ...]:
    """What of the cell lies outside of what was seen."""
    known = seen()
    return tuple(
        Beyond(name, value, *known[name])
        for name, value in facts(layout).items()
        if not known[name][0] <= value <= known[name][1]
    )


def confidence(layout: Layout, chances: Sequence[float]) -> Confidence:
    """How sure the policy is of its choices in the cell, and what in it is new to it.

    Args:
      chances: what the network gives its own choices in each greedy schedule (`Drawing.greedy`).
    """
    mean = round(float(np.mean(chances)), 4) if chances else None
    return Confidence(mean, beyond(layout))
