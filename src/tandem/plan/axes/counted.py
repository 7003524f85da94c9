"""Measures and limits in whole numbers: what each way of each task adds for each operator, for a
model and for schedules.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal

from ortools.sat.python import cp_model

from tandem.cell.burdens import costs
from tandem.cell.measures import Measure
from tandem.plan.cpsat import Decisions
from tandem.plan.instance import Instance, scale_of, up
from tandem.plan.starts import Starts, measures
from tandem.schedule.exposure import Limit

LARGEST = 1 << 40
"""Whole numbers of a measure stay below; where decimals do not allow that they are rounded up."""


@dataclass(frozen=True)
class Counted:
    """A measure in whole numbers: what each way of each task adds for each operator.

    Attributes:
      cost: `[task][way]` -> pairs of operator and units. None for the cell's own measure of stress,
        which the instance counts.
      most: units that it cannot exceed.
      exact: nothing was rounded.
    """

    measure: Measure
    cost: tuple[tuple[tuple[tuple[int, int], ...], ...], ...] | None
    most: int
    exact: bool = True

    @classmethod
    def of(cls, instance: Instance, measure: Measure) -> Counted:
        """The measure of the instance's cell."""
        if measure.what == "sum" and not measure.of_worst:
            table = (instance.stress_of_set or {}).values()
            most = sum(max(way.stress for way in ways) for ways in instance.ways)
            return cls(measure, None, max([most, *table]))
        rows = _costs(instance, measure)
        highest = sum(
            max((sum(c for _, c in way) for way in row), default=Decimal(0)) for row in rows
        )
        scale, is_exact = scale_of(
            [c for row in rows for way in row for _, c in way], highest, LARGEST
        )
        whole = tuple(
            tuple(tuple((o, up(c * scale)) for o, c in way if c) for way in row) for row in rows
        )
        most = sum(max((sum(c for _, c in way) for way in row), default=0) for row in whole)
        return cls(measure, whole, most, is_exact)

    def by_set(self, instance: Instance) -> bool:
        """What tasks add to it depends on the other tasks."""
        return self.cost is None and instance.stress_of_set is not None

    def units_of(self, instance: Instance, task: int, way: int) -> Iterable[tuple[int, int]]:
        """Operator and units that the task adds in this way. Assumes that it is not by sets."""
        if self.cost is not None:
            return self.cost[task][way]
        chosen = instance.ways[task][way]
        return zip(chosen.operators, chosen.load, strict=True)

    def units(self, instance: Instance, starts: Starts) -> int:
        """What a schedule comes to."""
        if self.cost is None:
            return measures(instance, starts)[1]
        chosen = [self.cost[task][way] for task, (way, _) in enumerate(starts)]
        if self.measure.what == "peak":
            return max((c for row in chosen for _, c in row), default=0)
        sums = dict.fromkeys(range(len(instance.operators)), 0)
        for row in chosen:
            for operator, c in row:
                sums[operator] += c
        return max(sums.values()) if self.measure.of_highest else sum(sums.values())

    def variable(self, plan: Decisions) -> cp_model.IntVar:
        """The measure in the model: what it comes to or, where it is the highest of several
        numbers, a number that is at least each of them.
        """
        if self.cost is None:
            return plan.stress
        found = plan.model.new_int_var(0, self.most, self.measure.name)
        terms = [
            (operator, c, x)
            for row, chosen in zip(self.cost, plan.chosen, strict=True)
            for way, x in zip(row, chosen, strict=True)
            for operator, c in way
        ]
        if self.measure.what == "peak":
            for _, c, x in terms:
                plan.model.add(found >= c * x)
        elif self.measure.of_highest:
            for person in {operator for operator, _, _ in terms}:
                plan.model.add(found >= sum(c * x for who, c, x in terms if who == person))
        else:
            plan.model.add(found == sum(c * x for _, c, x in terms))
        return found


@dataclass(frozen=True)
class Budget:
    """A limit in whole numbers, as the model keeps it: costs rounded up and the most rounded down
    where decimals ask for that, so that it is never exceeded.

    Attributes:
      cost: as that of `Counted`. `people` are those whom it holds for.
      is_peak: the most of one task, instead of the most of all together.
    """

    cost: tuple[tuple[tuple[tuple[int, int], ...], ...], ...]
    most: int
    people: tuple[int, ...]
    is_peak: bool

    @classmethod
    def of(cls, instance: Instance, limit: Limit) -> Budget:
        """The limit for the instance's cell."""
        rows, most = _costs(instance, limit.measure), limit.per_cycle
        numbers = [c for row in rows for way in row for _, c in way]
        highest = sum(max((c for way in row for _, c in way), default=Decimal(0)) for row in rows)
        scale, _ = scale_of([*numbers, most] if most <= highest else numbers, highest, LARGEST)
        people = tuple(
            place
            for place, name in enumerate(instance.operators)
            if instance.human[place] and limit.who in (None, name)
        )
        return cls(
            tuple(tuple(tuple((o, up(c * scale)) for o, c in way) for way in row) for row in rows),
            int(min(most, highest + 1) * scale),
            people,
            limit.measure.what == "peak",
        )

    def keep(self, plan: Decisions) -> None:
        """Adds it to the model."""
        terms = [
            (operator, c, x)
            for row, chosen in zip(self.cost, plan.chosen, strict=True)
            for way, x in zip(row, chosen, strict=True)
            for operator, c in way
            if operator in self.people
        ]
        if self.is_peak:
            for _, c, x in terms:
                if c > self.most:
                    plan.model.add(x == 0)
            return
        for person in self.people:
            plan.model.add(sum(c * x for who, c, x in terms if who == person) <= self.most)


def _costs(instance: Instance, measure: Measure) -> list[list[list[tuple[int, Decimal]]]]:
    number = {name: place for place, name in enumerate(instance.operators)}
    return [
        [
            [(number[who], c) for who, c in costs(instance.cell, measure, task, mode).items()]
            for mode in instance.cell.modes(task)
        ]
        for task in instance.tasks
    ]
