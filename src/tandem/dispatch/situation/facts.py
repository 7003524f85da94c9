"""What follows from a cell and is asked at every moment of a shift: worked out once. Names and
seconds, as in the cell.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from decimal import Decimal

from tandem.cell.model import Cell
from tandem.cell.parts import Mode
from tandem.cell.precedence import between
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.schedule.exposure import Limit, all_limits


@dataclass(frozen=True)
class Facts:
    """Facts of a cell.

    Attributes:
      ways: task -> the modes that a schedule can hold: no more operators than the tool and the zone
        have places, and none that a partner in `same_operator` lacks.
      behind: task -> its direct successors, in the cell's order.
      above: task -> all its successors, direct or not.
      team: task -> the other tasks that the same operators must do.
      holds: of each machine that holds parts, `(machine, first, last, tasks within)`.
      before: task -> all that must have ended, or begun, before it starts, directly or not.
      limits: what people may have at most, their `stress_limit` among them.
      dues: per limit, task -> `(the least that it takes however it is done, operators -> what it
        takes when they do it)`.
      sets: the listed sets of tasks done by humans that can come about; None where stress adds up.
    """

    ways: Mapping[str, tuple[Mode, ...]]
    behind: Mapping[str, tuple[str, ...]]
    above: Mapping[str, frozenset[str]]
    team: Mapping[str, tuple[str, ...]]
    limits: tuple[Limit, ...]
    dues: tuple[Mapping[str, tuple[Decimal, Mapping[frozenset[str], Decimal]]], ...]
    holds: tuple[tuple[str, str, str, frozenset[str]], ...]
    before: Mapping[str, frozenset[str]]
    sets: tuple[frozenset[str], ...] | None

    @classmethod
    def of(cls, cell: Cell) -> Facts:
        """The facts of the cell."""
        layout = Layout.of(Instance.of(cell))
        names, instance = layout.instance.tasks, layout.instance
        limits = tuple(limit for _, limit in all_limits(cell))
        ways = {
            task: tuple(cell.modes(task)[step.way] for step in steps)
            for task, steps in zip(names, layout.steps, strict=True)
        }
        return cls(
            ways=ways,
            behind={
                task: tuple(names[after] for after in row)
                for task, row in zip(names, instance.behind, strict=True)
            },
            above=_above(instance),
            team={
                task: tuple(
                    other
                    for other, number in zip(names, layout.instance.team, strict=True)
                    if number == mine >= 0 and other != task
                )
                for task, mine in zip(names, layout.instance.team, strict=True)
            },
            limits=limits,
            dues=tuple(
                {task: _dues(cell, limit, task, ways[task]) for task in ways} for limit in limits
            ),
            holds=tuple(
                (who, *pair, between(cell, *pair))
                for who, operator in cell.operators.items()
                for pair in operator.holds
            ),
            before=_before(instance),
            sets=_sets(layout),
        )


def _dues(
    cell: Cell, limit: Limit, task: str, ways: Iterable[Mode]
) -> tuple[Decimal, Mapping[frozenset[str], Decimal]]:
    who = limit.who or ""
    least = min(
        (limit.due(cell, task, way).get(who, Decimal(0)) for way in ways), default=Decimal(0)
    )
    # of several ways of one group the quickest counts, as `mode` takes it
    every = sorted(cell.modes(task), key=lambda way: (-way.time, -sum(way.stress.values())))
    return least, {
        frozenset(way.operators): limit.due(cell, task, way).get(who, Decimal(0)) for way in every
    }


def _above(instance: Instance) -> dict[str, frozenset[str]]:
    above: dict[str, frozenset[str]] = {}
    for task in reversed(instance.order):
        direct = [instance.tasks[after] for after in instance.behind[task]]
        above[instance.tasks[task]] = frozenset(direct).union(*(above[name] for name in direct))
    return above


def _before(instance: Instance) -> dict[str, frozenset[str]]:
    before: dict[str, frozenset[str]] = {}
    waits = instance.begun_first
    for task in instance.order:
        firsts = [first for first in range(len(instance.tasks)) if waits[task] >> first & 1]
        direct = [instance.tasks[first] for first in firsts]
        before[instance.tasks[task]] = frozenset(direct).union(*(before[name] for name in direct))
    return before


def _sets(layout: Layout) -> tuple[frozenset[str], ...] | None:
    table = layout.instance.stress_of_set
    if table is None:
        return None
    feasible = [tasks for tasks in table if not layout.with_humans_at(tasks).impossible()]
    return tuple(
        frozenset(layout.instance.tasks[task] for task in tasks) for tasks in feasible or table
    )
