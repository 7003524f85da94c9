"""Of all schedules that are equally quick and equally gentle, the one that comes first: exactly, by
dynamic programming, where the cell is small.

What "first" means is said by `tandem.plan.canonical`, which asks CP-SAT; here no solver is asked.
Partial schedules grow along the clock as they do in exhaustive search, and `chronological.py` says
why nothing is lost. Two more things are kept here:

- Nodes are compared only where every person has the same stress so far, because the spread of
  stress is no number of which less is always better.
- A node is dropped for another one of its key only when that one has no larger number and a sum of
  starts, then starts, then ways that are no later in the order of the rule. Whatever completes both
  at the same times then leaves them in this order.
"""

from __future__ import annotations

from operator import gt
from typing import NamedTuple

from tandem.plan.chronological import Branching, Key, Node
from tandem.plan.dynamic_programming import Limits
from tandem.plan.list_scheduling import Layout
from tandem.plan.starts import Starts


class _Ranked(NamedTuple):
    """A node and its place in the order: the sum of its starts, then its starts and its ways, both
    by task in the cell's order.
    """

    numbers: tuple[int, ...]
    place: tuple[int, tuple[int, ...], tuple[int, ...]]
    node: Node


def first_of_equals(layout: Layout, most_ticks: int, most_units: int) -> Starts:
    """The first schedule by the rule among those that end by `most_ticks` and have at most
    `most_units` of stress. Assumes that no schedule has less of one and no more of the other.
    """
    return _Search(layout, most_ticks, most_units).run()


class _Search:
    def __init__(self, layout: Layout, most_ticks: int, most_units: int) -> None:
        self.layout, self.instance = layout, layout.instance
        self.most_ticks, self.most_units = most_ticks, most_units
        self.limits = Limits(layout, most_ticks)
        self.moves = Branching(layout, self.limits.latest_end)
        humans = [o for o, human in enumerate(self.instance.human) if human]
        spreads = len(humans) > 1 and self.instance.stress_of_set is None
        self.people = humans if spreads else []
        self.by_operators = [
            sorted(row, key=lambda step: (step.operators, step.ticks)) for row in layout.steps
        ]

    def run(self) -> Starts:
        tasks = len(self.moves.tasks)
        level = [_Ranked((), (0, (-1,) * tasks, (-1,) * tasks), self.moves.root())]
        for _ in range(tasks):
            kept: dict[Key, list[_Ranked]] = {}
            for parent in level:
                for child in self.moves.children(parent.node, self.most_ticks):
                    if self._is_within(child):
                        self._keep(kept, self._ranked(parent, child))
            level = [ranked for row in kept.values() for ranked in row]
            self.moves.forget()
            self.limits.forget()
        best = min(level, key=lambda ranked: (self._spread(ranked.node), ranked.place))
        return tuple(self.moves.starts(best.node))

    def _is_within(self, node: Node) -> bool:
        ticks, units = self.limits.of(node)
        return ticks <= self.most_ticks and units <= self.most_units

    def _ranked(self, parent: _Ranked, child: Node) -> _Ranked:
        assert child.step is not None
        task, step, start = child.step
        total, starts, ways = parent.place
        starts = (*starts[:task], start, *starts[task + 1 :])
        place = self.by_operators[task].index(step)
        ways = (*ways[:task], place, *ways[task + 1 :])
        return _Ranked(self.moves.numbers(child), (total + start, starts, ways), child)

    def _keep(self, kept: dict[Key, list[_Ranked]], new: _Ranked) -> None:
        """Takes the node in unless another one of its key comes before it in everything."""
        key = (*self.moves.key(new.node), tuple(self._loads(new.node)))
        row = kept.setdefault(key, [])
        if not any(_comes_first(other, new) for other in row):
            row[:] = [other for other in row if not _comes_first(new, other)]
            row.append(new)

    def _loads(self, node: Node) -> list[int]:
        """Stress of each of the people so far."""
        loads = dict.fromkeys(self.people, 0)
        here: Node | None = node
        while here is not None and here.step is not None:
            _, step, _ = here.step
            for operator, load in zip(step.operators, step.load, strict=True):
                if operator in loads:
                    loads[operator] += load
            here = here.before
        return list(loads.values())

    def _spread(self, node: Node) -> int:
        loads = self._loads(node)
        return max(loads) - min(loads) if loads else 0


def _comes_first(one: _Ranked, other: _Ranked) -> bool:
    return one.place <= other.place and not any(map(gt, one.numbers, other.numbers))
