"""Fronts over any measures: makespan and one, two or more others, complete and proven.

Points come in order of their makespan (epsilon-constraint): the least makespan of a schedule that
no known point is as good as and, at that makespan, the least of the second measure, then of the
third. Each is a point of the front at once. Since no later point is quicker, it must be less than
each known one in one of the other measures: with one other measure that is a limit, with two the
corner of a staircase (Sylva and Crema 2004, European Journal of Operational Research 158:46-55,
with the makespan taken out of the disjunction). When nothing is left that is, the front is
complete.

All that the model asks of a measure is decided by who does what, in whole numbers: `Counted`. What
depends on the makespan besides, a dose of a shift or a mean over time, is that number over the
makespan, so that the same schedules are its compromises; of fatigue it is the envelope, which rest
can only lower. What is told of a schedule is its exact value (`schedule.exposure`).
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from importlib.metadata import version
from random import Random
from time import monotonic
from typing import Any, TypeVar

from ortools.sat.python import cp_model

from tandem.cell.burdens import costs, named
from tandem.cell.measures import Measure
from tandem.cell.model import Cell, plain
from tandem.errors import CellError, InfeasibleError, NothingFoundError, UsageError
from tandem.plan.cpsat import SOLVER, Decisions, formulate
from tandem.plan.door import Admitted, Door, RefusedScheduleWarning
from tandem.plan.infeasible import EACH_S, Conflict, Gain, core_of, lift
from tandem.plan.infeasible import Limit as Liftable
from tandem.plan.infeasible import limits as cell_limits
from tandem.plan.instance import Instance, scale_of, up
from tandem.plan.list_scheduling import Layout
from tandem.plan.question import Question
from tandem.plan.result import SCHEMA_VERSION
from tandem.plan.rules import SPECS, build
from tandem.plan.starts import Starts, appended, measures
from tandem.schedule.exposure import SHIFT_S, Limit, limit_of, value
from tandem.schedule.measures import makespan, stress
from tandem.schedule.model import Schedule

MAKESPAN = "makespan"
N = TypeVar("N", int, float)
LARGEST = 1 << 40
"""Whole numbers of a measure stay below; where decimals do not allow that they are rounded up."""
MOST_FACTOR = 1 << 55
"""Above, two measures are minimized one after the other instead of in one sum."""


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


@dataclass(frozen=True)
class Point:
    """A schedule of the front: what it is worth on each axis, and whether that is proven."""

    values: tuple[float, ...]
    schedule: Schedule
    proven: bool


@dataclass(frozen=True)
class AxesFront:
    """The compromises between the makespan and other measures, sorted by makespan and then by the
    others.

    Attributes:
      axes: the makespan and the names of the measures, as the values of a point follow.
      complete: every point, and the absence of others, is proven.
      rounded: names of measures that were counted in rounded units while searching.
    """

    cell: Cell
    axes: tuple[str, ...]
    points: tuple[Point, ...]
    complete: bool
    seed: int
    wall_s: float
    shift_s: float
    cycles: float | None = None
    limits: tuple[str, ...] = ()
    interrupted: bool = False
    rounded: tuple[str, ...] = ()
    source: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """The result document; every point has a value for each of the `objectives`, and the
        cell's own `stress`.
        """
        own = named("stress", self.cell)
        return {
            "schema_version": SCHEMA_VERSION,
            "cell": self.cell.name,
            "cell_digest": self.cell.digest,
            "objectives": list(self.axes),
            "complete": self.complete,
            "method": "axes",
            "solver": SOLVER,
            "tandem": version("tandem"),
            "seed": self.seed,
            "wall_s": round(self.wall_s, 4),
            "interrupted": self.interrupted,
            "shift_s": plain(self.shift_s),
            "cycles_per_shift": plain(self.cycles),
            "limits": list(self.limits),
            "rounded": list(self.rounded),
            "front": [
                {
                    "stress": plain(value(self.cell, point.schedule, own)),
                    **dict(zip(self.axes, map(plain, point.values), strict=True)),
                    "status": "optimal" if point.proven else "feasible",
                    "digest": point.schedule.digest,
                    "assignments": point.schedule.to_list(),
                }
                for point in self.points
            ],
            "source": self.source,
            "cell_document": self.cell.to_dict(),
        }


def axes_named(names: Sequence[str], cell: Cell) -> tuple[Measure, ...]:
    """The measures behind the makespan. Raises UsageError for names that are none, come twice, or
    do not begin with the makespan.
    """
    if not names or names[0].strip() != MAKESPAN or len(names) < 2:
        raise UsageError(
            f"axes {','.join(names)}: write makespan first and then one or more measures, such as"
            " makespan,stress or makespan,dose:shoulder_tool,worst:stress."
        )
    found = tuple(named(name, cell) for name in names[1:])
    twice = {measure.name for measure in found if found.count(measure) > 1}
    if twice:
        raise UsageError(f"axes {','.join(names)}: {', '.join(sorted(twice))} stands there twice.")
    return found


def plan_axes(
    cell: Cell,
    axes: Sequence[str],
    *,
    time_limit: float | None = 60.0,
    seed: int = 0,
    workers: int | None = None,
    shift_s: float = SHIFT_S,
    cycles: float | None = None,
    limits: Sequence[str] = (),
) -> AxesFront:
    """The complete front over makespan and the measures named behind it, with a schedule for each
    point; within the time limit, as far as that goes.

    Args:
      axes: `makespan`, then names of measures (`schedule.exposure`).
      time_limit: seconds; None to go on until everything is proven.
      workers: threads of each proof; one when None, so that schedules repeat.
      shift_s: seconds of a shift, for doses.
      cycles: products of a shift; the cell's own, or as many as fit, when None.
      limits: `MEASURE=MOST` for everybody or `MEASURE@PERSON=MOST`. No schedule exceeds one.

    Raises:
      UsageError: axes that are none.
      InfeasibleError: it is proven that no schedule keeps the cell's limits and these; its
        `reasons` and `conflict` name a minimal set that cannot be kept together.
      NothingFoundError: none was found within the limit.
    """
    began = monotonic()
    until = None if time_limit is None else began + time_limit
    cycles = cell.cycles_per_shift if cycles is None else cycles
    kept = tuple(limit_of(text, cell, cycles) for text in limits)
    search = _Search(cell, axes_named(axes, cell), kept, cycles, until, seed, workers or 1)
    search.run()
    asked = " and ".join(["the cell's own limits", *(limit.words for limit in kept)])
    if not search.found:
        if search.complete and not search.door.refused:
            raise _infeasible(f"no schedule keeps {asked}; this is proven.", cell, kept, cycles)
        raise NothingFoundError(
            f"no schedule that keeps {asked} was found within the time limit; it is open whether"
            " there is one."
        )
    if search.door.refused:
        warnings.warn(search.door.apology(), RefusedScheduleWarning, stacklevel=2)
    return AxesFront(
        cell,
        (MAKESPAN, *(counted.measure.name for counted in search.counted)),
        search.points(shift_s),
        search.complete and not search.door.refused,
        seed,
        monotonic() - began,
        shift_s,
        cycles,
        tuple(limit.words for limit in kept),
        search.interrupted,
        tuple(counted.measure.name for counted in search.counted if not counted.exact),
    )


def conflict_of_limits(
    cell: Cell, kept: Sequence[Limit], cycles: float | None, *, seconds: float = 30.0
) -> Conflict | None:
    """Which of these limits and the cell's own cannot be kept together, and what lifting each would
    give; None when lifting all would not help. Assumes that no schedule keeps them all.
    """
    until = monotonic() + seconds
    given = {Liftable(f"the limit {x.words}", ("limit", x.words)): x for x in kept}
    nothing = Question()

    def without(lifted: Sequence[Liftable]) -> _Search:
        variant, _ = lift(cell, nothing, [limit for limit in lifted if limit not in given])
        left = [limit for one, limit in given.items() if one not in lifted]
        ends = monotonic() + EACH_S
        return _Search(variant, axes_named([MAKESPAN, "stress"], variant), left, cycles, ends, 0, 1)

    def possible(lifted: Sequence[Liftable]) -> bool | None:
        try:
            return without(lifted).is_possible()
        except CellError:
            return None

    def gain(limit: Liftable) -> Gain:
        try:
            best = without([limit]).quickest()
        except CellError:
            best = None
        if best is None:
            return Gain(limit, None, None)
        return Gain(limit, makespan(best.schedule), stress(cell, best.schedule))

    core = core_of([*given, *cell_limits(cell, nothing)], possible, until)
    return Conflict(core, (), tuple(map(gain, core.items))) if core.items else None


def _infeasible(
    message: str, cell: Cell, kept: Sequence[Limit], cycles: float | None
) -> InfeasibleError:
    found = conflict_of_limits(cell, kept, cycles)
    if found is None:
        return InfeasibleError(message)
    return InfeasibleError(message, found.sentences(), found.to_dict())


class _Search:
    """Attributes:
    found: (ticks, units of each measure) -> schedule; `proven` are the points of the front.
    """

    def __init__(
        self,
        cell: Cell,
        measures: Sequence[Measure],
        limits: Sequence[Limit],
        cycles: float | None,
        until: float | None,
        seed: int,
        workers: int,
    ) -> None:
        self.cell, self.until, self.seed, self.workers = cell, until, seed, workers
        self.instance = Instance.of(cell)
        self.layout = Layout.of(self.instance)
        self.counted = [Counted.of(self.instance, measure) for measure in measures]
        self.cycles = cycles
        self.budgets = [Budget.of(self.instance, limit) for limit in limits]
        self.door = Door(
            cell,
            self.instance,
            Question(),
            lambda schedule: [fault for limit in limits for fault in limit.faults(cell, schedule)],
        )
        self.found: dict[tuple[int, ...], Admitted] = {}
        self.proven: set[tuple[int, ...]] = set()
        self.complete = self.interrupted = False
        self.last: Starts | None = None
        self.upper = self.instance.horizon

    def run(self) -> None:
        """Point by point, until nothing is left or time is up."""
        if self.layout.impossible():
            self.complete = True
            return
        self._by_rule()
        least = 0
        while not self.door.refused:
            ticks = self._quickest(least)
            if ticks is None:
                return
            point = self._best_at(ticks)
            if point is None:
                return
            self.proven.add(point)
            least = ticks

    def is_possible(self) -> bool | None:
        """Whether there is a schedule; None when time is up. The first one is enough."""
        if self.layout.impossible():
            return False
        self._by_rule()
        if not self.found:
            plan, _ = self._model(self.upper, 0)
            status, solver = self._solve(plan)
            if status == cp_model.INFEASIBLE:
                return False
            if _has_schedule(status):
                self._take(plan, solver)
        return True if self.found and not self.door.refused else None

    def quickest(self) -> Admitted | None:
        """The schedule of least makespan that is found in time, None when there is none."""
        if self.layout.impossible():
            return None
        self._by_rule()
        self._quickest(0)
        return min(self.found.values(), key=lambda one: one.makespan, default=None)

    def _by_rule(self) -> None:
        """A first schedule, so that something is there however short the time."""
        if self.instance.stress_of_set is None:
            state = build(self.layout, SPECS["longest-tail"], Random(self.seed))
            if state is not None and (first := self.door.admit(state.starts())) is not None:
                self._know(first)

    def _quickest(self, least: int) -> int | None:
        """The least makespan of what is not matched yet; None when there is none, or time is up."""
        plan, _ = self._model(self.upper, least)
        plan.model.minimize(plan.makespan)
        status, solver = self._solve(plan)
        if status == cp_model.INFEASIBLE:
            self.complete = True
            return None
        if status in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            self._take(plan, solver)
        return round(solver.objective_value) if status == cp_model.OPTIMAL else None

    def _best_at(self, ticks: int) -> tuple[int, ...] | None:
        """Of the schedules of this makespan that are not matched yet the one that is least in the
        first measure, then in the next; None when time is up.
        """
        limits: list[int] = []
        while True:
            plan, variables = self._model(ticks, ticks)
            for variable, limit in zip(variables, limits, strict=False):
                plan.model.add(variable <= limit)
            objective, together = self._in_turn(variables, len(limits))
            plan.model.minimize(objective)
            status, solver = self._solve(plan)
            point = self._take(plan, solver) if _has_schedule(status) else None
            if status != cp_model.OPTIMAL or point is None:
                return None
            limits = list(point[1 : 1 + len(limits) + together])
            if len(limits) == len(variables):
                return point

    def _in_turn(self, variables: Sequence[cp_model.IntVar], known: int) -> tuple[Any, int]:
        """What is minimized next when so many measures are known, and how many that settles: as
        many as fit into one sum in which the earlier counts more than all of the later.
        """
        objective: Any = variables[known]
        together, factor = 1, self.counted[known].most + 1
        for place in range(known + 1, len(variables)):
            factor *= self.counted[place].most + 1
            if factor > MOST_FACTOR:
                break
            objective = objective * (self.counted[place].most + 1) + variables[place]
            together += 1
        return objective, together

    def _model(self, upper: int, least: int) -> tuple[Decisions, list[cp_model.IntVar]]:
        """The cell with what is known cut off: schedules of `least` to `upper` ticks that no proven
        point is as good as.
        """
        plan = formulate(self.instance, upper)
        plan.model.add(plan.makespan >= least)
        variables = [counted.variable(plan) for counted in self.counted]
        for budget in self.budgets:
            budget.keep(plan)
        corners = _least_of({point[1:] for point in self.proven})
        for corner in corners:
            if len(corner) == 1:
                plan.model.add(variables[0] <= corner[0] - 1)
                continue
            less = [plan.model.new_bool_var("") for _ in corner]
            for literal, variable, units in zip(less, variables, corner, strict=True):
                plan.model.add(variable <= units - 1).only_enforce_if(literal)
            plan.model.add_bool_or(less)
        if self.last is not None:
            plan.hint(self.last)
        return plan, variables

    def _solve(self, plan: Decisions) -> tuple[Any, cp_model.CpSolver]:
        solver = cp_model.CpSolver()
        solver.parameters.num_workers = self.workers
        solver.parameters.random_seed = self.seed % (1 << 31)
        solver.parameters.symmetry_level = 0
        # of 20 tasks, half the work of each proof
        solver.parameters.linearization_level = 0
        solver.parameters.cp_model_probing_level = 0
        left = None if self.until is None else self.until - monotonic()
        if left is not None:
            solver.parameters.max_time_in_seconds = max(0.01, left)
        status = solver.solve(plan.model)
        stopped = status in (cp_model.UNKNOWN, cp_model.FEASIBLE)  # type: ignore[comparison-overlap]
        # Ctrl-C ends a solve before its time
        self.interrupted = stopped and (self.until is None or monotonic() < self.until - 0.1)
        return status, solver

    def _take(self, plan: Decisions, solver: cp_model.CpSolver) -> tuple[int, ...] | None:
        admitted = self.door.vouched(appended(self.layout, plan.read(solver.value)))
        return None if admitted is None else self._know(admitted)

    def _know(self, admitted: Admitted) -> tuple[int, ...]:
        self.last = admitted.starts
        units = (counted.units(self.instance, admitted.starts) for counted in self.counted)
        point = (admitted.makespan, *units)
        self.found.setdefault(point, admitted)
        return point

    def points(self, shift_s: float) -> tuple[Point, ...]:
        """What no other one beats, with exact values, sorted by makespan and the others."""
        kept = sorted(_least_of(set(self.found)))
        rows = []
        for point in kept:
            schedule = self.found[point].schedule
            exact = (
                value(self.cell, schedule, counted.measure, cycles=self.cycles, shift_s=shift_s)
                for counted in self.counted
            )
            rows.append(Point((makespan(schedule), *exact), schedule, point in self.proven))
        # what was rounded, or is an envelope, may be less than another where its value is not
        beaten = {row.values for row in rows} - set(_least_of({row.values for row in rows}))
        return tuple(row for row in rows if row.values not in beaten)


def _has_schedule(status: Any) -> bool:
    return status in (cp_model.OPTIMAL, cp_model.FEASIBLE)


def _least_of(points: set[tuple[N, ...]]) -> list[tuple[N, ...]]:
    """Those that no other one is as good as in everything."""
    return [
        point
        for point in points
        if not any(
            other != point and all(a <= b for a, b in zip(other, point, strict=True))
            for other in points
        )
    ]
