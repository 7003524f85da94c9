"""The rest of an assembly as an instance of its own, and CP-SAT on it: started tasks stay where
they are, the others are planned anew.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from random import Random
from typing import Any

from ortools.sat.python import cp_model

from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.plan.cpsat import formulate
from tandem.plan.instance import Instance, Lag, Way
from tandem.plan.list_scheduling import Layout, PartialSchedule, Step, append_in_order
from tandem.plan.rules import SPECS, build
from tandem.plan.starts import Starts, in_time

SCALE = 1 << 20
"""Weights become whole numbers in units of the larger one divided by this."""


@dataclass(frozen=True)
class Rest:
    """What is left of an assembly, its clock at 0 now.

    Attributes:
      instance: its tasks, those that are being done included, each of these with one way that
        starts at 0.
      tasks: per task of the instance, the task of the cell. `ways`: per task and way, the way as
        `Moves` numbers it; -1 for what runs.
    """

    instance: Instance
    tasks: tuple[int, ...]
    ways: tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Plan:
    """A plan of the rest, in ticks from now.

    Attributes:
      begins: (start, way as `Moves` numbers it) of what is still to begin, in order of start.
      ticks: when all of it has ended. `units`: the stress of what is still to begin.
      bound: cost that no plan falls below, in the weights it was asked with; `proven` when the plan
        meets it.
    """

    begins: tuple[tuple[int, int], ...]
    ticks: int
    units: int
    bound: float
    proven: bool


def rest(
    moves: Moves,
    position: Position,
    *,
    with_running: bool = True,
    due: Mapping[int, int] | None = None,
) -> Rest | None:
    """What is left; None when nothing is.

    Without what runs, operators who are at something have a break instead, and what waits for it a
    release; its tool and zone are forgotten.

    Args:
      due: task of the cell -> ticks from now by which it should start, for what it waits after.
        With it, what waits may last at most is kept, so that there may be no plan of the rest; when
        None, none of that is: for all else, late is better than never.
    """
    left = _Left.of(moves, position, with_running)
    if not left.tasks:
        return None
    full, rows = moves.instance, [left.open_ways(task) for task in left.tasks]
    instance = full.restricted(
        left.tasks,
        [[way for way, _ in row] for row in rows],
        [left.release(task) for task in left.tasks],
        before=[() if task in left.fixed else full.before[task] for task in left.tasks],
        # What runs ends when it ends; for all else, late is better than never.
        deadline=tuple(left.latest_end(task, due or {}) for task in left.tasks),
        lags=left.lags(with_most=due is not None),
        **left.stances(),
        breaks=left.breaks(),
        allowances=full.allowances_left(position.taken),
        **left.holds(),
    )
    return Rest(instance, left.tasks, tuple(tuple(number for _, number in row) for row in rows))


@dataclass(frozen=True)
class _Left:
    """What is left of an assembly at a position, task by task and operator by operator.

    Attributes:
      tasks: those that are to be planned.
      running: task -> (way, ticks left) of all that is being done or taken apart.
      fixed: the same of tasks to be planned that go on as they are.
      ends: ticks of tasks that run and are not planned; what comes after them waits so long.
      away: operator -> ticks in which they cannot be planned.
    """

    moves: Moves
    position: Position
    tasks: tuple[int, ...]
    running: Mapping[int, tuple[int, int]]
    fixed: Mapping[int, tuple[int, int]]
    ends: Mapping[int, int]
    away: Mapping[int, int]

    @classmethod
    def of(cls, moves: Moves, position: Position, with_running: bool) -> _Left:
        """Reads the position."""
        done, wrong = position.done, position.wrong
        at_work = [(way, ticks) for way, ticks in position.running if way < 2 * moves.count]
        running = {moves.task[way]: (way, ticks) for way, ticks in at_work}
        unfinished = [t for t in range(len(moves.ways)) if not done >> t & 1 or wrong >> t & 1]
        if with_running:
            away = [(way, ticks) for way, ticks in position.running if way >= 2 * moves.count]
            tasks, ends = unfinished, {}
            fixed = {t: at for t, at in running.items() if not wrong >> t & 1}
        else:
            away = list(position.running)
            tasks = [t for t in unfinished if t not in running or wrong >> t & 1]
            ends = {t: ticks for t, (_, ticks) in running.items()}
            fixed = {}
        operators = range(len(moves.instance.operators))
        off = {o: ticks for way, ticks in away for o in operators if moves.who[way] >> o & 1}
        for task, ticks in ends.items():  # what is being taken out still blocks its machine
            for hold in moves.instance.held_until[task]:
                machine = moves.instance.holds[hold][0]
                off[machine] = max(off.get(machine, 0), ticks)
        return cls(moves, position, tuple(tasks), running, fixed, ends, off)

    def open_ways(self, task: int) -> list[tuple[Way, int]]:
        """How the task can be done, and the way as `Moves` numbers it; -1 for what goes on."""
        moves = self.moves
        if task in self.fixed:
            way, ticks = self.fixed[task]
            mode = moves.modes[way]
            return [(replace(mode, ticks=ticks, load=(0,) * len(mode.operators), dues=()), -1)]
        open_ = moves.ways[task]
        # A team that has begun goes on; where that leaves nothing, anybody is better than nobody.
        team = dict(self.position.teams).get(moves.instance.team[task])
        if team is not None:
            open_ = tuple(way for way in open_ if moves.who[way] == team) or open_
        return [(self._with_taking_apart(task, way), way) for way in open_]

    def _with_taking_apart(self, task: int, way: int) -> Way:
        """The way as it is done; what is wrong comes off first, by whoever does it again."""
        mode, apart = self.moves.modes[way], 0
        if task in self.running:
            apart = self.running[task][1]
        elif self.position.wrong >> task & 1:
            apart = self.moves.ticks[self.moves.count + way]
        return replace(mode, ticks=mode.ticks + apart)

    def release(self, task: int) -> int:
        """Ticks from now before which the task cannot start, because of what is not planned."""
        if task in self.fixed:
            return 0
        instance = self.moves.instance
        ends = [self.ends.get(first, 0) for first in instance.before[task]]
        if instance.has_lags:
            ends += [
                self.ends[lag.before] + lag.least
                for lag in instance.lags_into[task]
                if lag.before in self.ends and not lag.from_start
            ]
            waits = self.position.waits
            ends += [left for number, left in waits if instance.lags[number].task == task]
        return max(0, instance.release[task] - self.position.clock, *ends)

    def holds(self) -> dict[str, Any]:
        """The parts that machines hold, or are still to hold. Two that one machine holds at once,
        which only mistakes can bring about, are forgotten.
        """
        instance = self.moves.instance
        begun = self.position.done | sum(1 << task for task in self.running)
        held = instance.still_held(self.tasks, begun)
        open_ = [operator for operator, first, _ in held["holds"] if first < 0]
        kept = [
            pair
            for pair in zip(held["holds"], held["within"], strict=True)
            if pair[0][1] >= 0 or open_.count(pair[0][0]) == 1
        ]
        return {"holds": tuple(h for h, _ in kept), "within": tuple(w for _, w in kept)}

    def latest_end(self, task: int, due: Mapping[int, int]) -> int | None:
        """Ticks from now by which the task must have ended; None where it need not. What is due is
        so to start, so that a slow way of doing it leaves more time.
        """
        if task in self.fixed:
            return self.fixed[task][1]
        if due.get(task, -1) < 0:
            return None
        return due[task] + max(way.ticks for way, _ in self.open_ways(task))

    def lags(self, *, with_most: bool) -> tuple[Lag, ...]:
        """The waits between tasks that are to be planned; of what goes on the end alone is still to
        come.
        """
        index = {task: place for place, task in enumerate(self.tasks)}
        return tuple(
            Lag(
                index[lag.before],
                index[lag.task],
                lag.from_start,
                lag.least,
                lag.most if with_most else None,
            )
            for lag in self.moves.instance.lags
            if lag.before in index
            and lag.task in index
            and lag.task not in self.fixed
            and not (lag.from_start and lag.before in self.fixed)
        )

    def stances(self) -> dict[str, Any]:
        """The tool that each operator holds now, and where it stands."""
        instance = self.moves.instance
        read = [instance.read(stance) for stance in self.position.stance or instance.stances]
        return {
            "in_hand": tuple(tool for tool, _ in read),
            "stands": tuple(place for _, place in read),
        }

    def breaks(self) -> tuple[tuple[tuple[int, int], ...], ...]:
        """The breaks that are still to come, seen from now, and absences."""
        now = self.position.clock
        rows = []
        for operator, breaks in enumerate(self.moves.instance.breaks):
            ahead = [(max(0, off - now), back - now) for off, back in breaks if back > now]
            away = [(0, self.away[operator])] if operator in self.away else []
            rows.append(tuple(sorted([*ahead, *away])))
        return tuple(rows)


def sketch(
    moves: Moves,
    position: Position,
    weights: tuple[float, float],
    *,
    samples: int,
    seed: int = 0,
    due: Mapping[int, int] | None = None,
) -> Plan | None:
    """The best of a few list schedules of what is left: one by each rule of `FIRST`, then drawn
    ones. None when nothing is left, or limits leave none of them.

    Args:
      weights: per tick and per unit of stress, what is made small.
      samples: so many schedules are made.
      due: as in `rest`; a schedule may miss it.
    """
    plans = sketches(moves, position, weights, samples=samples, seed=seed, due=due)
    return min(plans, key=lambda one: weights[0] * one.ticks + weights[1] * one.units, default=None)


def sketches(
    moves: Moves,
    position: Position,
    weights: tuple[float, float],
    *,
    samples: int,
    seed: int = 0,
    due: Mapping[int, int] | None = None,
) -> list[Plan]:
    """All of those list schedules, as they were made; arguments as of `sketch`."""
    left = rest(moves, position, with_running=False, due=due)
    if left is None:
        return []
    layout, random = Layout.of(left.instance), Random(seed)
    easy = weights[1] / weights[0] if weights[0] else STRESS_ALONE
    # prices of the whole cell are as good a guide to what is left of it
    prices = [
        len(moves.prices.of_operator) * price / moves.prices.total
        for price in moves.prices.of_operator
    ]
    going, found = [ticks for _, ticks in position.running], list[Plan]()
    for number in range(samples):
        drawn = number >= len(FIRST)
        state = build(
            layout,
            SPECS[DRAWN[number % len(DRAWN)] if drawn else FIRST[number]],
            random,
            stress=easy,
            temperature=SHAKEN if drawn else 0.0,
            prices=prices,
        )
        if state is not None:
            found.append(as_plan(left, state, max([state.makespan, *going]), 0.0, False))
    return found


FIRST = ("longest-tail", "balanced", "earliest-completion", "heft")
"""The rules whose schedules a sketch begins with, as they are."""
DRAWN = ("balanced", "longest-tail")
"""Those whose priorities are then shaken."""
SHAKEN = 0.3
"""How far: the standard deviation of the logarithm of the factor on each priority."""
STRESS_ALONE = 1e6
"""What a unit of stress weighs against a tick where time weighs nothing."""


def solve(
    left: Rest,
    weights: tuple[float, float],
    *,
    work_s: float,
    hint: Plan | None = None,
    seed: int = 0,
) -> Plan | None:
    """The plan of least `weights[0] * ticks + weights[1] * units` that CP-SAT finds, one thread;
    the hint when it finds none. The same again for the same arguments.

    Of equally good ones it is whichever comes first.

    Args:
      work_s: CP-SAT's deterministic seconds; one takes about three on a core.
      hint: a plan of the same rest, from which the search begins.
    """
    instance = left.instance
    layout = Layout.of(instance)
    quick = None if hint is None else appended(left, layout, hint)
    upper = instance.horizon if quick is None else max(quick.makespan, 1)
    decisions = formulate(instance, max(upper, instance.horizon if weights[1] else upper))
    top = max(weights)
    time, stress = (round(weight / top * SCALE) for weight in weights)
    decisions.model.minimize(time * decisions.makespan + stress * decisions.stress)
    if quick is not None:
        decisions.hint(tuple(quick.starts()))
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = seed
    solver.parameters.max_deterministic_time = work_s
    solver.parameters.cp_model_probing_level = 0
    solver.parameters.cp_model_presolve = work_s > PRESOLVED_S
    status = solver.status_name(solver.solve(decisions.model))
    if status not in ("OPTIMAL", "FEASIBLE"):
        return hint
    found = decisions.read(solver.value)
    bound = solver.best_objective_bound / SCALE
    return _plan(left, layout, found, bound * top, status == "OPTIMAL")


def keeps(left: Rest, plan: Plan) -> bool:
    """Whether the plan keeps the deadlines and waits of the rest."""
    return appended(left, Layout.of(left.instance), plan) is not None


def resumed(left: Rest, plan: Plan) -> Plan | None:
    """What is left of an earlier plan of the same cell: the same ways in the same order, each as
    early as it can begin now, whatever people did meanwhile. None where the plan does not say how
    all of the rest is done, or limits do not let it be.
    """
    planned = {way for _, way in plan.begins}
    if not all(row == (-1,) or planned.intersection(row) for row in left.ways):
        return None
    state = appended(left, Layout.of(left.instance), plan)
    return None if state is None else as_plan(left, state, state.makespan, 0.0, False)


def appended(left: Rest, layout: Layout, plan: Plan) -> PartialSchedule | None:
    """The plan's tasks in its order, what goes on first of all; None where the rest's limits or
    deadlines do not let it be.
    """
    place = {way: (t, w) for t, row in enumerate(left.ways) for w, way in enumerate(row)}
    order = [place[way] for _, way in plan.begins if way in place]
    planned = {t for t, _ in order}
    order = [*((t, 0) for t in range(len(left.ways)) if t not in planned), *order]
    steps: list[Step | None] = [None] * len(left.ways)
    for t, way in order:
        steps[t] = next((step for step in layout.steps[t] if step.way == way), None)
    if any(step is None for step in steps):
        return None
    state = append_in_order(layout, [t for t, _ in order], [one for one in steps if one])
    if state is None or not in_time(left.instance, tuple(state.starts())):
        return None
    return state


PRESOLVED_S = 0.05
"""Presolving, which is hardly counted as work, is left out of less."""


def _plan(left: Rest, layout: Layout, found: Starts, bound: float, proven: bool) -> Plan | None:
    """The plan with every task as early as its order allows; None where the parts that machines
    hold do not let it be.
    """
    order = sorted(range(len(found)), key=lambda t: (found[t][1], layout.instance.order.index(t)))
    steps = [
        next((step for step in layout.steps[t] if step.way == way), layout.steps[t][0])
        for t, (way, _) in enumerate(found)
    ]
    state = append_in_order(layout, order, steps)
    if state is None:
        return None
    return as_plan(left, state, state.makespan, bound, proven)


def as_plan(left: Rest, state: PartialSchedule, ticks: int, bound: float, proven: bool) -> Plan:
    """A list schedule of the rest as a plan of so many ticks."""
    starts = state.starts()
    begins = [
        (start, left.ways[t][way]) for t, (way, start) in enumerate(starts) if left.ways[t][0] >= 0
    ]
    units = sum(left.instance.ways[t][way].stress for t, (way, _) in enumerate(starts))
    return Plan(tuple(sorted(begins)), ticks, units, bound, proven)
