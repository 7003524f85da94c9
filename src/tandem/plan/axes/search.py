"""Fronts over any measures: makespan and one, two or more others, complete and proven.

First points are looked for with many random schedules at once (`compromises.py`). Then it is asked
for anything that none of them is as good as, until there is nothing: each known point is a corner,
of which a schedule must be less in the makespan or in a measure (Sylva and Crema 2004, European
Journal of Operational Research 158:46-55). That is asked in slices of the makespan, from the least
on: when a slice has nothing left, its points are proven. With one or two measures the allocations
that may improve on what is known are listed instead (`allocations.py`), where they are not too
many, and each that no bound rules out is asked for a quicker schedule by itself.

All that the model asks of a measure is decided by who does what, in whole numbers: `Counted`. What
depends on the makespan besides, a dose of a shift or a mean over time, is that number over the
makespan, so that the same schedules are its compromises; of fatigue it is the envelope, which rest
can only lower. What is told of a schedule is its exact value (`schedule.exposure`).
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from random import Random
from time import monotonic
from typing import Any, TypeVar

import numpy as np
from ortools.sat.python import cp_model

from tandem.cell.burdens import named
from tandem.cell.measures import Measure
from tandem.cell.model import Cell, plain
from tandem.errors import CellError, InfeasibleError, NothingFoundError, UsageError
from tandem.plan.axes.allocations import Allocations, Between
from tandem.plan.axes.arrays import Arrays, Ints
from tandem.plan.axes.compromises import Compromises
from tandem.plan.axes.counted import Budget, Counted
from tandem.plan.cpsat import SOLVER, Decisions, formulate
from tandem.plan.door import Admitted, Door, RefusedScheduleWarning
from tandem.plan.infeasible import EACH_S, Conflict, Gain, core_of, lift
from tandem.plan.infeasible import Limit as Liftable
from tandem.plan.infeasible import limits as cell_limits
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.question import Question
from tandem.plan.result import SCHEMA_VERSION
from tandem.plan.rules import SPECS, build
from tandem.plan.starts import append, appended
from tandem.schedule.exposure import SHIFT_S, Limit, limit_of, value
from tandem.schedule.measures import makespan, stress
from tandem.schedule.model import Schedule

MAKESPAN = "makespan"
N = TypeVar("N", int, float)
ROUNDS_A_TASK, AGAIN, IDLE = 15, 20, 40
"""Rounds of random schedules, at first for each task and then whenever one was missed; and how many
that find nothing are enough.
"""
MOST_TASKS, MOST_LISTED = 100, 30
"""Of more tasks random schedules, and listing allocations, take too long to be worth it."""
TURNS, AT_ONCE, MOST_ASKED = 4, 4_000, 50_000
"""Orders in which each listed allocation is played, how many are played together, and how many are
asked by themselves.
"""
LEVELS, FEW = 6, 2_000
"""Makespans of known points that the first slice holds; below so many conflicts of its proof, the
next slice holds twice as many, else half.
"""


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
    found: (ticks, units of each measure) -> schedule, of those that no other one found is as good
      as; `proven` are the points of the front.
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
        self.upper = self.instance.horizon
        self.drawn: Compromises | None = None
        self.asked: set[tuple[int, ...]] = set()

    def run(self) -> None:
        """Until nothing is left or time is up. Ctrl-C ends it too, and what was found stays."""
        try:
            self._look()
        except KeyboardInterrupt:
            self.interrupted = True
            if self.drawn is not None:
                self._admit()

    def _look(self) -> None:
        """By the list of allocations where that is short, else slice by slice of the makespan."""
        if self.layout.impossible():
            self.complete = True
            return
        self._by_rule()
        tasks = len(self.instance.tasks)
        if tasks <= MOST_TASKS and Arrays.fit(self.layout, self.counted):
            arrays = Arrays(self.layout, self.counted, self.budgets)
            self.drawn = Compromises(arrays, self.seed)
            self.drawn.begin(one.starts for one in self.found.values())
            self._draw(ROUNDS_A_TASK * max(1, tasks - 8))
            if tasks <= MOST_LISTED and len(self.counted) <= 2 and self._by_allocations(arrays):
                self.proven, self.complete = set(self.found), True
                return
        if self.interrupted:
            return
        least, levels = 0, LEVELS
        while not self.door.refused:
            times = sorted({point[0] for point in self.found if point[0] >= least})
            most = times[levels - 1] if levels < len(times) else self.upper
            conflicts = self._close(least, most)
            if conflicts is None:
                return
            self.proven |= {point for point in self.found if point[0] <= most}
            if most == self.upper:
                self.complete = True
                return
            least, levels = most + 1, levels * 2 if conflicts < FEW else max(1, levels // 2)

    def _by_allocations(self, arrays: Arrays) -> bool:
        """Lists the allocations that may still improve on what is known, plays them in many orders,
        which finds more, and asks the few that are left. Whether the front is complete then.
        """
        search = Allocations(arrays, self._is_late)
        ways = search.open(list(self.found)) if self.found else None
        if ways is None:
            return False
        between = Between(arrays, ways)
        bound = between.by_chains()
        for turn in range(TURNS):
            if turn == 1:
                # dearer, so only of those that the first order has left
                between = Between(arrays, ways)
                bound = np.maximum(bound, between.by_operators())
            keep = search.still_open(ways, bound, list(self.found))
            ways, bound, tails = ways[keep], bound[keep], between.tails[keep]
            between.tails = tails
            if not len(ways) or self._is_late():
                break
            self._play(ways, tails, turn)
        keep = search.still_open(ways, bound, list(self.found))
        return self._ask_each(search, ways[keep], bound[keep])

    def _ask_each(self, search: Allocations, ways: Ints, bound: Ints) -> bool:
        """Asks each of the allocations for a schedule quicker than what is known to be as good in
        the measures; whether none has one in the end. What is found leaves fewer to be asked.
        """
        if len(ways) > MOST_ASKED:
            return False
        # what costs least may rule out most
        order = np.argsort(search.arrays.units(ways).sum(1), kind="stable")
        ways, bound = ways[order], bound[order]
        while len(ways):
            units = search.arrays.units(ways[:1])[0].tolist()
            as_good = [point[0] for point in self.found if _as_good(point[1:], tuple(units))]
            plan = formulate(self.instance, min(as_good, default=self.upper + 1) - 1)
            for way, chosen in zip(ways[0].tolist(), plan.chosen, strict=True):
                plan.model.add(chosen[way] == 1)
            status, solver = self._solve(plan)
            if status == cp_model.INFEASIBLE:
                ways, bound = ways[1:], bound[1:]
                continue
            if not _has_schedule(status) or self._take(plan, solver) is None:
                return False
            keep = search.still_open(ways, bound, list(self.found))
            ways, bound = ways[keep], bound[keep]
        return not self.door.refused

    def _play(self, ways: Ints, tails: Ints, turn: int) -> None:
        """Appends the tasks of each allocation with what has most behind it first; but for the
        first turn more or less so.
        """
        assert self.drawn is not None
        blur = self.drawn.rng.random(ways.shape) * (0.2 * turn * tails.mean())
        for first in range(0, len(ways), AT_ONCE):
            some = slice(first, first + AT_ONCE)
            self.drawn.judge(ways[some], blur[some] - tails[some])
        self._admit()

    def _is_late(self) -> bool:
        return self.until is not None and monotonic() > self.until

    def _close(self, least: int, most: int) -> int | None:
        """Looks for schedules of `least` to `most` ticks that nothing known is as good as, until
        there are none; the conflicts of that proof, None when time is up.
        """
        while not self.door.refused:
            plan, _ = self._model(most, least)
            status, solver = self._solve(plan)
            if status == cp_model.INFEASIBLE:
                return solver.num_conflicts
            if not _has_schedule(status) or (one := self._take(plan, solver)) is None:
                return None
            if one not in self.found.values():
                self.door.refuse(["it is no better than one that was known."])
                return None
            if self.drawn is not None:
                # where one was missed there may be more
                self.drawn.know([one.starts])
                self._draw(AGAIN)
        return None

    def _draw(self, rounds: int) -> None:
        """So many rounds of random schedules, fewer when nothing comes of it for long."""
        assert self.drawn is not None
        idle = 0
        for _ in range(rounds):
            if idle == IDLE or self._is_late():
                break
            idle = 0 if self.drawn.round() else idle + 1
        self._admit()

    def _admit(self) -> None:
        """Works out what was drawn, and knows what the checker accepts."""
        assert self.drawn is not None
        kept = self.drawn.kept
        for place, worth in enumerate(kept.worth.tolist()):
            if tuple(worth) in self.asked:
                continue
            self.asked.add(tuple(worth))
            order = [int(task) for task in np.argsort(kept.keys[place], kind="stable")]
            starts = append(self.layout, order, kept.ways[place].tolist())
            if starts is not None and (one := self.door.admit(starts)) is not None:
                self._know(one)

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

    def _model(self, upper: int, least: int) -> tuple[Decisions, list[cp_model.IntVar]]:
        """The cell with what is known cut off: schedules of `least` to `upper` ticks that no proven
        point is as good as.
        """
        plan = formulate(self.instance, upper)
        plan.model.add(plan.makespan >= least)
        variables = [counted.variable(plan) for counted in self.counted]
        for budget in self.budgets:
            budget.keep(plan)
        self._cut_off(plan, [plan.makespan, *variables], upper, least)
        return plan, variables

    def _cut_off(
        self, plan: Decisions, axes: Sequence[cp_model.IntVar], upper: int, least: int
    ) -> None:
        """Of each known point a schedule must be less in something. What takes no longer than
        `least` is not beaten in the makespan.
        """
        less: dict[tuple[int, int], cp_model.IntVar] = {}

        def is_less(axis: int, units: int) -> cp_model.IntVar:
            if (axis, units) not in less:
                literal = less[axis, units] = plan.model.new_bool_var("")
                plan.model.add(axes[axis] <= units - 1).only_enforce_if(literal)
            return less[axis, units]

        quick = _least_of({point[1:] for point in self.found if point[0] <= least})
        for corner in quick:
            plan.model.add_bool_or([is_less(axis, units) for axis, units in enumerate(corner, 1)])
        for point in self.found:
            if least < point[0] <= upper:
                plan.model.add_bool_or([is_less(axis, units) for axis, units in enumerate(point)])

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

    def _take(self, plan: Decisions, solver: cp_model.CpSolver) -> Admitted | None:
        admitted = self.door.vouched(appended(self.layout, plan.read(solver.value)))
        if admitted is not None:
            self._know(admitted)
        return admitted

    def _know(self, admitted: Admitted) -> None:
        """Keeps the schedule, unless one that is known is as good in everything."""
        units = (counted.units(self.instance, admitted.starts) for counted in self.counted)
        point = (admitted.makespan, *units)
        if any(_as_good(other, point) for other in self.found):
            return
        beaten = [other for other in self.found if _as_good(point, other)]
        self.found[point] = admitted  # first, so that Ctrl-C in between loses nothing
        for other in beaten:
            del self.found[other]

    def points(self, shift_s: float) -> tuple[Point, ...]:
        """What no other one beats, with exact values, sorted by makespan and the others."""
        rows = []
        for point in sorted(self.found):
            schedule = self.found[point].schedule
            exact = (
                value(self.cell, schedule, counted.measure, cycles=self.cycles, shift_s=shift_s)
                for counted in self.counted
            )
            rows.append(Point((makespan(schedule), *exact), schedule, point in self.proven))
        # what was rounded, or is an envelope, may be less than another where its value is not
        beaten = {row.values for row in rows} - set(_least_of({row.values for row in rows}))
        return tuple(row for row in rows if row.values not in beaten)


def _as_good(point: tuple[int, ...], other: tuple[int, ...]) -> bool:
    return all(a <= b for a, b in zip(point, other, strict=True))


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
