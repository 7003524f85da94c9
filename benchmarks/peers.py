"""The peers that Tandem is held against, given the same cell, the same cores and the same seconds:
a plain CP-SAT model, PyJobShop, and discrete-optimization of Airbus.

All minimize the makespan, within a limit on stress where one is given. They model what the
benchmark cells need: precedence, eligibility, own times, joint tasks, `same_operator`, stress that
adds up.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING

from ortools.sat.python import cp_model

from tandem.cell.model import Cell
from tandem.plan.instance import Instance
from tandem.plan.method import Progress
from tandem.plan.methods import plan
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule

if TYPE_CHECKING:
    from discrete_optimization.rcpsp.problem import RcpspProblem


@dataclass(frozen=True)
class Run:
    """What a solver had: `makespan` in seconds (None: nothing), a bound, whether it was proven,
    wall time, (second, makespan) along the way, and the schedule where a peer gives it.
    """

    makespan: float | None
    bound: float | None
    proven: bool
    wall_s: float
    course: tuple[tuple[float, float], ...] = ()
    schedule: Schedule | None = None

    def after(self, seconds: float) -> float | None:
        """The makespan that it had after so many seconds."""
        return min((value for moment, value in self.course if moment <= seconds), default=None)


def tandem_exact(cell: Cell, seconds: float, workers: int, seed: int = 0) -> Run:
    """Tandem's `exact` method asked for the least makespan."""
    course: list[tuple[float, float]] = []

    def note(progress: Progress) -> None:
        course.append((progress.wall_s, min(result.makespan for result in progress.found)))

    front = plan(
        cell, minimize="makespan", time_limit=seconds, workers=workers, seed=seed, on_solution=note
    )
    best = front[0]
    return Run(
        best.makespan,
        best.bound.makespan,
        best.bound.makespan >= best.makespan,
        front.wall_s,
        (*course, (front.wall_s, best.makespan)),
    )


class _Course(cp_model.CpSolverSolutionCallback):
    def __init__(self, began: float, per_second: int) -> None:
        super().__init__()
        self.began, self.per_second, self.course = began, per_second, []

    def on_solution_callback(self) -> None:
        self.course.append((time.monotonic() - self.began, self.objective_value / self.per_second))


def plain_cpsat(
    cell: Cell, seconds: float, workers: int, seed: int = 0, most: int | None = None
) -> Run:
    """The model of the textbook: an optional interval per alternative, no overlap per operator,
    precedence, and nothing else but the limit of `most` units of stress.
    """
    began = time.monotonic()
    instance = Instance.of(cell)
    model = cp_model.CpModel()
    horizon = instance.horizon
    starts, ends, chosen, lanes = [], [], [], [[] for _ in instance.operators]
    for ways in instance.ways:
        start, end = model.new_int_var(0, horizon, ""), model.new_int_var(0, horizon, "")
        literals = []
        for way in ways:
            literal = model.new_bool_var("")
            interval = model.new_optional_interval_var(start, way.ticks, end, literal, "")
            literals.append(literal)
            for operator in way.operators:
                lanes[operator].append(interval)
        model.add_exactly_one(literals)
        starts.append(start)
        ends.append(end)
        chosen.append(literals)
    for lane in lanes:
        model.add_no_overlap(lane)
    for task, firsts in enumerate(instance.before):
        for first in firsts:
            model.add(starts[task] >= ends[first])
    for one, two in instance.same_operator:
        for group in {way.operators for task in (one, two) for way in instance.ways[task]}:
            sides = [
                sum(
                    x
                    for x, way in zip(chosen[task], instance.ways[task], strict=True)
                    if way.operators == group
                )
                for task in (one, two)
            ]
            model.add(sides[0] == sides[1])
    if most is not None:
        model.add(
            sum(
                way.stress * literal
                for ways, literals in zip(instance.ways, chosen, strict=True)
                for way, literal in zip(ways, literals, strict=True)
            )
            <= most
        )
    makespan = model.new_int_var(0, horizon, "")
    model.add_max_equality(makespan, ends)
    model.minimize(makespan)
    solver = cp_model.CpSolver()
    solver.parameters.max_time_in_seconds = max(0.1, seconds - (time.monotonic() - began))
    solver.parameters.num_workers = workers
    solver.parameters.random_seed = seed
    watch = _Course(began, instance.per_second)
    status = solver.solve(model, watch)
    found = status in (cp_model.OPTIMAL, cp_model.FEASIBLE)
    value = solver.objective_value / instance.per_second if found else None
    schedule = None
    if found:
        ways = [next(w for w, x in enumerate(literals) if solver.value(x)) for literals in chosen]
        schedule = instance.schedule(
            (way, solver.value(start)) for way, start in zip(ways, starts, strict=True)
        )
        _must_be_sound(cell, schedule, "cp-sat")
    return Run(
        value,
        solver.best_objective_bound / instance.per_second,
        status == cp_model.OPTIMAL,
        time.monotonic() - began,
        tuple(watch.course),
        schedule,
    )


def pyjobshop(
    cell: Cell, seconds: float, workers: int, seed: int = 0, most: int | None = None
) -> Run:
    """PyJobShop on the same OR-Tools; stress within `most` units is a resource that is used up. It
    tells nothing along the way, so `course` holds its end alone.
    """
    from pyjobshop import Model

    began = time.monotonic()
    instance = Instance.of(cell)
    model = Model()
    machines = [model.add_machine() for _ in instance.operators]
    tasks = [model.add_task() for _ in instance.tasks]
    used_up = [] if most is None else [model.add_consumable(most)]
    for task, ways in zip(tasks, instance.ways, strict=True):
        for way in ways:
            team = [machines[operator] for operator in way.operators]
            demands = [*[0] * len(team), *[way.stress] * len(used_up)]
            model.add_mode(task, [*team, *used_up], way.ticks, demands)
    for task, firsts in enumerate(instance.before):
        for first in firsts:
            model.add_end_before_start(tasks[first], tasks[task])
    for one, two in instance.same_operator:
        model.add_identical_resources(tasks[one], tasks[two])
    left = max(0.1, seconds - (time.monotonic() - began))
    result = model.solve(time_limit=left, display=False, num_workers=workers, random_seed=seed)
    wall = time.monotonic() - began
    if not result.best.tasks:
        return Run(None, None, False, wall)
    value = max(task.end for task in result.best.tasks) / instance.per_second
    people = len(machines)
    rows = [
        (tuple(sorted(r for r in task.resources if r < people)), task.end - task.start, task.start)
        for task in result.best.tasks
    ]
    ways = [
        next(
            w
            for w, way in enumerate(instance.ways[index])
            if way.operators == team and way.ticks == ticks
        )
        for index, (team, ticks, _) in enumerate(rows)
    ]
    schedule = instance.schedule(
        (way, start) for way, (_, _, start) in zip(ways, rows, strict=True)
    )
    _must_be_sound(cell, schedule, "pyjobshop")
    return Run(
        value,
        result.lower_bound / instance.per_second,
        result.status.value == "Optimal",
        wall,
        ((wall, value),),
        schedule,
    )


def airbus(cell: Cell, seconds: float, workers: int, seed: int = 0, most: int | None = None) -> Run:
    """discrete-optimization of Airbus, on the same OR-Tools: the cell as a multi-mode project with
    one unit of each operator, solved by the CP-SAT model that it makes of such projects itself;
    stress within `most` units is a resource that is used up.
    """
    from discrete_optimization.generic_tools.callbacks.callback import Callback
    from discrete_optimization.generic_tools.cp_tools import ParametersCp
    from discrete_optimization.generic_tools.do_solver import StatusSolver
    from discrete_optimization.rcpsp.solvers.cpsat_auto import CpSatAutoRcpspSolver

    class Watch(Callback):
        def on_step_end(self, step: int, res: object, solver: CpSatAutoRcpspSolver) -> None:
            value = solver.get_current_best_internal_objective_value() / instance.per_second
            course.append((time.monotonic() - began, value))

    began = time.monotonic()
    instance = Instance.of(cell)
    course: list[tuple[float, float]] = []
    solver = CpSatAutoRcpspSolver(_as_project(instance, most))
    solver.init_model()
    storage = solver.solve(
        callbacks=[Watch()],
        time_limit=max(0.1, seconds - (time.monotonic() - began)),
        parameters_cp=ParametersCp(True, multiprocess=workers > 1, nb_process=workers),
        ortools_cpsat_solver_kwargs={"random_seed": seed},
    )
    wall = time.monotonic() - began
    if not storage:
        return Run(None, None, False, wall)
    found = storage[-1][0]
    count = len(instance.tasks)
    schedule = instance.schedule(
        (found.get_mode(task) - 1, found.get_start_time(task)) for task in range(count)
    )
    _must_be_sound(cell, schedule, "discrete-optimization")
    return Run(
        found.get_end_time(count + 1) / instance.per_second,
        solver.get_current_best_internal_objective_bound() / instance.per_second,
        solver.status_solver is StatusSolver.OPTIMAL,
        wall,
        tuple(course),
        schedule,
    )


def _as_project(instance: Instance, most: int | None) -> RcpspProblem:
    """Tasks 0..n-1 with a mode for each way, numbered from 1, then a source n and a sink n + 1.
    Tasks that want the same operator are to have modes of the same score, which is their team.
    """
    from discrete_optimization.rcpsp.problem import RcpspProblem
    from discrete_optimization.rcpsp.special_constraints import (
        PairModeConstraint,
        SpecialConstraintsDescription,
    )

    count = len(instance.tasks)
    source, sink = count, count + 1
    people = range(len(instance.operators))
    used_up = {} if most is None else {"stress": most}
    nothing = {"duration": 0, **dict.fromkeys((*people, *used_up), 0)}
    modes = {source: {1: nothing}, sink: {1: nothing}}
    after: dict[int, list[int]] = {source: list(range(count)), sink: []}
    for task, ways in enumerate(instance.ways):
        after[task] = [sink]
        modes[task] = {
            number: {
                **nothing,
                "duration": way.ticks,
                **dict.fromkeys(way.operators, 1),
                **dict.fromkeys(used_up, way.stress),
            }
            for number, way in enumerate(ways, 1)
        }
    for task, firsts in enumerate(instance.before):
        for first in firsts:
            after[first].append(task)
    together = None
    if instance.same_operator:
        teams: dict[tuple[int, ...], int] = {}
        scores = {
            (task, number): teams.setdefault(way.operators, len(teams))
            for task in {task for pair in instance.same_operator for task in pair}
            for number, way in enumerate(instance.ways[task], 1)
        }
        pairs = set(instance.same_operator)
        together = SpecialConstraintsDescription(
            pair_mode_constraint=PairModeConstraint(same_score_mode=pairs, score_mode=scores)
        )
    return RcpspProblem(
        special_constraints=together,
        resources={**dict.fromkeys(people, 1), **used_up},
        non_renewable_resources=list(used_up),
        mode_details=modes,
        successors=after,
        horizon=instance.horizon,
        source_task=source,
        sink_task=sink,
    )


def _must_be_sound(cell: Cell, schedule: Schedule, solver: str) -> None:
    """A peer's schedule is judged as ours are, so that nobody is credited with what cannot be
    done.
    """
    if wrong := faults(cell, schedule):
        raise AssertionError(f"{solver}: " + "; ".join(wrong))


PEERS = {
    "tandem": tandem_exact,
    "cp-sat": plain_cpsat,
    "pyjobshop": pyjobshop,
    "airbus": airbus,
}
"""Name -> solver. A further peer is a function and a line here."""
PACKAGES = {"pyjobshop": "pyjobshop", "airbus": "discrete-optimization"}
"""Peer -> the package that it is, beside OR-Tools."""


def versions(names: Iterable[str]) -> str:
    """What these solvers are, for the head of a table."""
    packages = ["ortools", *(PACKAGES[name] for name in names if name in PACKAGES)]
    return ", ".join(f"{package} {version(package)}" for package in packages)
