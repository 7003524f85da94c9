"""What is known about a cell's front while it is searched: the schedules that none beats, and the
facts that bound all others.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf
from typing import NamedTuple

from tandem.cell.model import Cell
from tandem.plan.bounds import chain_bound, least_stress, one_operator_bound
from tandem.plan.door import Admitted
from tandem.plan.goal import Goal
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.provers import Prover, Step, rising
from tandem.plan.result import Bound, Result, Status

Point = tuple[int, int]
"""Makespan in ticks, stress in units."""


class Gap(NamedTuple):
    """What lies open between two neighbouring points of a front, or beyond its ends.

    Attributes:
      cap: units; a new point in the gap has at most this stress, one less than the quicker
        neighbour.
      end: ticks; and it ends before the gentler neighbour. Infinite beyond the gentle end, unless a
        limit is asked.
      low: units; the stress of the gentler neighbour, or the least there is.
    """

    cap: float
    end: float
    low: int


LEAST_OPEN = 1e-6
"""The open area of a front of which only something beyond its frame is open."""


class Fact(NamedTuple):
    """Every schedule (within the question's limits) of at most this stress takes at least this
    makespan; and who proved it.
    """

    stress: float
    makespan: float
    by: Prover


class Archive:
    """Schedules that the checker has accepted, and facts.

    All bounds and proofs of a front follow from facts: a point is optimal when they leave no room
    on either side of it.
    """

    def __init__(self, cell: Cell, layout: Layout, limits: Goal) -> None:
        self.cell, self.layout, self.limits = cell, layout, limits
        self.found: dict[Point, Admitted] = {}
        self.least_stress = least_stress(layout) or 0
        self.frame: tuple[int, int, int, int] | None = None
        self.facts: list[Fact] = [
            Fact(inf, chain_bound(layout), Prover.CHAIN),
            Fact(inf, one_operator_bound(layout), Prover.LOAD),
            Fact(self.least_stress - 1, inf, Prover.LEAST_STRESS),
        ]

    @property
    def instance(self) -> Instance:
        return self.layout.instance

    def offer(self, schedule: Admitted) -> bool:
        """Keeps the schedule unless something kept is at least as good; says whether it did."""
        point = schedule.point
        if any(m <= point[0] and s <= point[1] for m, s in self.found):
            return False
        self.found = {
            (m, s): kept for (m, s), kept in self.found.items() if m < point[0] or s < point[1]
        }
        self.found[point] = schedule
        return True

    def learn(self, stress: float, makespan: float, by: Prover) -> None:
        """Adds a fact, unless one that is known says as much; drops those of the same prover that
        say less.
        """
        if self.least_makespan(stress) < makespan:
            self.facts = [
                fact
                for fact in self.facts
                if fact.by != by or fact.stress > stress or fact.makespan > makespan
            ]
            self.facts.append(Fact(stress, makespan, by))

    def best(self, goal: Goal) -> Admitted | None:
        """The kept schedule of least value for the goal."""
        fitting = [point for point in self.found if goal.allows(*point)]
        return self.found[min(fitting, key=lambda point: goal.value(*point))] if fitting else None

    def least_makespan(self, stress: float) -> float:
        """Ticks; infinite when no schedule has at most this stress."""
        return max(fact.makespan for fact in self.facts if fact.stress >= stress)

    def prover_of(self, stress: float) -> Prover:
        """Who proved that least makespan."""
        covering = (fact for fact in self.facts if fact.stress >= stress)
        return max(covering, key=lambda fact: (fact.makespan, -fact.by.rank)).by

    def least_stress_within(self, makespan: float) -> float:
        """Units that every schedule of at most this makespan has at least; infinite when there is
        none.
        """
        return max(
            fact.stress + 1
            for fact in self.facts
            if fact.makespan > makespan or fact.makespan == inf
        )

    @property
    def points(self) -> list[Point]:
        """What is kept, by makespan."""
        return sorted(self.found)

    @property
    def gaps(self) -> list[Gap]:
        """Where another point may still be, from the quick end of the front to the gentle one."""
        cap, latest = self.limits.max_stress, self.limits.max_makespan
        caps = [inf if cap is None else cap, *(stress - 1 for _, stress in self.points)]
        ends = [*(makespan for makespan, _ in self.points), inf if latest is None else latest + 1]
        lows = [*(stress for _, stress in self.points), self.least_stress]
        return [
            Gap(*gap)
            for gap in zip(caps, ends, lows, strict=True)
            if self.least_makespan(gap[0]) < gap[1]
        ]

    @property
    def bound_points(self) -> list[Point]:
        """Each schedule within the limits is at least as great in both as one of these; by
        makespan.

        Between the makespans of two facts the first one's stress is too little.
        """
        known: list[Fact] = []
        for fact in sorted(self.facts, key=lambda fact: (-fact.makespan, -fact.stress)):
            if not known or fact.stress > known[-1].stress:  # else another one says more
                known.append(fact)
        corners = ((one.makespan, other.stress + 1) for other, one in pairwise(known))
        found = [(int(m), int(s)) for m, s in corners if self.limits.allows(int(m), int(s))]
        return found[::-1]

    def open_area(self) -> float:
        """The share of the front's area that is open: neither reached by what is kept nor ruled out
        by the facts. 0 when the front is complete, above it before.

        The area is a frame that is set when this is asked for the first time, by what is known
        then: from the least of both objectives to just beyond the latest and the hardest schedule.
        What lies beyond is not counted, so the share can only shrink.
        """
        if self.complete:
            return 0.0
        bounds, points = self.bound_points, self.points
        if not points or not bounds:
            return 1.0
        if self.frame is None:
            self.frame = (bounds[0][0], bounds[-1][1], points[-1][0] + 1, points[0][1] + 1)
        left, low, right, high = self.frame
        whole = (right - left) * (high - low)
        reached = dominated_area(points, right, high)
        return max(LEAST_OPEN, (dominated_area(bounds, right, high) - reached) / whole)

    @property
    def complete(self) -> bool:
        """Every kept point is optimal and no other exists."""
        return bool(self.found) and not self.gaps

    def results(self) -> tuple[Result, ...]:
        """The kept schedules with their bounds as they stand."""
        return tuple(self.result(point) for point in self.points)

    def steps(self, point: Point) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
        """What each prover says of the point's makespan and of its stress, in ticks and units."""
        makespan, stress = point
        times = (Step(min(f.makespan, makespan), f.by) for f in self.facts if f.stress >= stress)
        loads = (Step(min(f.stress + 1, stress), f.by) for f in self.facts if f.makespan > makespan)
        return rising(times), rising(loads)

    def result(self, point: Point, proven: Prover | bool | None = None) -> Result:
        """One kept schedule; `proven`, or by whom, overrides what follows from the facts."""
        instance = self.instance
        makespan = min(self.least_makespan(point[1]), point[0])
        stress = min(self.least_stress_within(point[0]), point[1])
        optimal = (makespan, stress) == point if proven is None else proven
        times, loads = self.steps(point)
        if optimal:
            makespan, stress = point
            by = proven if isinstance(proven, Prover) else Prover.CP_SAT
            times = rising([*times, Step(makespan, by)])
            loads = rising([*loads, Step(stress, by)])
        bound = Bound(
            instance.seconds(int(makespan)),
            instance.stress(int(stress)),
            tuple(Step(instance.seconds(int(value)), by) for value, by in times),
            tuple(Step(instance.stress(int(value)), by) for value, by in loads),
        )
        return Result(
            self.cell,
            self.found[point].schedule,
            Status.OPTIMAL if optimal else Status.FEASIBLE,
            bound,
        )


def dominated_area(points: Sequence[Point], right: int, high: int) -> int:
    """The area that the points dominate, up to `right` ticks and `high` units (the hypervolume;
    Zitzler and Thiele 1999, IEEE Transactions on Evolutionary Computation 3(4), 257-271). Points
    are sorted by makespan, each with less stress than the one before.
    """
    area, roof = 0, high
    for makespan, stress in points:
        if makespan < right and stress < roof:
            area += (right - makespan) * (roof - stress)
            roof = stress
    return area
