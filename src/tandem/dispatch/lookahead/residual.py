"""The rest of an assembly as an instance of its own, and CP-SAT on it: started tasks stay where
they are, the others are planned anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from ortools.sat.python import cp_model

from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.plan.cpsat import formulate
from tandem.plan.instance import Instance, Way
from tandem.plan.list_scheduling import Layout, append_in_order
from tandem.plan.starts import Starts, list_schedule, measures

SCALE = 1 << 20
"""Weights become whole numbers in units of the larger one divided by this."""
SHORTEST_S = 0.002
"""CP-SAT finds nothing in less."""


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


def rest(moves: Moves, position: Position, *, with_running: bool = True) -> Rest | None:
    """What is left; None when nothing is.

    Without what runs, operators who are at something have a break instead, and what waits for it a
    release; its tool and zone are forgotten.
    """
    full, runs = (
        moves.instance,
        {moves.task[way]: (way, left) for way, left in position.running if way < 2 * moves.count},
    )
    away = {
        moves.who[way].bit_length() - 1: left
        for way, left in position.running
        if way >= 2 * moves.count
    }
    tasks = tuple(
        t for t in range(len(full.tasks)) if not position.done >> t & 1 or position.wrong >> t & 1
    )
    ends: dict[int, int] = {}
    if not with_running:
        ends = {t: left for t, (_, left) in runs.items()}
        away |= {
            o: left
            for way, left in position.running
            for o in range(len(moves.prices))
            if moves.who[way] >> o & 1
        }
        tasks = tuple(t for t in tasks if t not in runs or position.wrong >> t & 1)
    if not tasks:
        return None
    place = {t: number for number, t in enumerate(tasks)}
    rows: list[tuple[Way, ...]] = []
    numbers: list[tuple[int, ...]] = []
    for t in tasks:
        if t in runs and not position.wrong >> t & 1:
            way, left = runs[t]
            rows.append((_way(moves, way, left, with_load=False),))
            numbers.append((-1,))
            continue
        team = dict(position.teams).get(moves.team[t]) if moves.team[t] >= 0 else None
        mine = [way for way in moves.ways[t] if team is None or moves.who[way] == team] or list(
            moves.ways[t]
        )
        extra = [_apart(moves, position, runs.get(t), way) for way in mine]
        rows.append(
            tuple(
                _way(moves, way, moves.ticks[way] + more)
                for way, more in zip(mine, extra, strict=True)
            )
        )
        numbers.append(tuple(mine))
    fixed = [t in runs and not position.wrong >> t & 1 for t in tasks]
    now = position.clock
    return Rest(
        replace(
            full,
            per_second=moves.per_second,
            tasks=tuple(full.tasks[t] for t in tasks),
            ways=tuple(rows),
            before=tuple(
                tuple(place[f] for f in full.before[t] if f in place) if not at else ()
                for t, at in zip(tasks, fixed, strict=True)
            ),
            behind=tuple(
                tuple(place[a] for a in full.behind[t] if a in place and not fixed[place[a]])
                for t in tasks
            ),
            order=tuple(place[t] for t in full.order if t in place),
            release=tuple(
                0
                if at
                else max(
                    [0, moves.release[t] - now, *(ends.get(first, 0) for first in full.before[t])]
                )
                for t, at in zip(tasks, fixed, strict=True)
            ),
            deadline=tuple(runs[t][1] if at else None for t, at in zip(tasks, fixed, strict=True)),
            tool=tuple(full.tool[t] for t in tasks),
            zone=tuple(full.zone[t] for t in tasks),
            changeover=moves.changeover,
            in_hand=tuple(None if tool < 0 else tool for tool in position.hand)
            if position.hand
            else full.in_hand,
            breaks=tuple(_breaks(row, now, away.get(o, 0)) for o, row in enumerate(moves.breaks)),
            stress_limit=tuple(
                None
                if limit is None
                else max(0, limit - (position.load[o] if position.load else 0))
                for o, limit in enumerate(moves.limits)
            ),
            same_operator=tuple(
                (place[a], place[b]) for a, b in full.same_operator if a in place and b in place
            ),
        ),
        tasks,
        tuple(numbers),
    )


def solve(
    left: Rest, weights: tuple[float, float], *, seconds: float, seed: int = 0
) -> Plan | None:
    """The plan of least `weights[0] * ticks + weights[1] * units` that CP-SAT finds, one thread;
    None when it finds none.

    Of equally good ones it is whichever comes first.

    Args:
      seconds: for all of it, building the model included; which goes on to its end, but no search
        begins behind it then.
    """
    until = perf_counter() + seconds
    instance = left.instance
    layout = Layout.of(instance)
    quick = list_schedule(layout, [0] * len(instance.tasks))
    upper = instance.horizon if quick is None else max(measures(instance, quick)[0], 1)
    decisions = formulate(instance, max(upper, instance.horizon if weights[1] else upper))
    top = max(weights)
    time, stress = (round(weight / top * SCALE) for weight in weights)
    decisions.model.minimize(time * decisions.makespan + stress * decisions.stress)
    if quick is not None:
        decisions.hint(quick)
    if until - perf_counter() < SHORTEST_S:
        return None
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = seed
    solver.parameters.max_time_in_seconds = until - perf_counter()
    solver.parameters.cp_model_probing_level = 0
    status = solver.status_name(solver.solve(decisions.model))
    if status not in ("OPTIMAL", "FEASIBLE"):
        return None
    found = decisions.read(solver.value)
    bound = solver.best_objective_bound / SCALE
    return _plan(left, layout, found, bound * top, status == "OPTIMAL")


def build(moves: Moves) -> None:
    """Puts the model of the whole cell together, as every plan begins, and searches nothing: to
    learn how long that takes.
    """
    left = rest(moves, moves.root())
    if left is not None:
        solve(left, (1.0, 0.0), seconds=0.0)


def _plan(left: Rest, layout: Layout, found: Starts, bound: float, proven: bool) -> Plan:
    """The plan with every task as early as its order allows."""
    order = sorted(range(len(found)), key=lambda t: (found[t][1], layout.instance.order.index(t)))
    steps = [
        next((step for step in layout.steps[t] if step.way == way), layout.steps[t][0])
        for t, (way, _) in enumerate(found)
    ]
    state = append_in_order(layout, order, steps)
    starts = state.starts()
    begins = [
        (start, left.ways[t][way]) for t, (way, start) in enumerate(starts) if left.ways[t][0] >= 0
    ]
    units = sum(left.instance.ways[t][way].stress for t, (way, _) in enumerate(starts))
    return Plan(tuple(sorted(begins)), state.makespan, units, bound, proven)


def _way(moves: Moves, way: int, ticks: int, *, with_load: bool = True) -> Way:
    operators = tuple(o for o in range(len(moves.prices)) if moves.who[way] >> o & 1)
    load = dict(moves.loads[way]) if with_load else {}
    return Way(operators, ticks, tuple(load.get(o, 0) for o in operators))


def _apart(moves: Moves, position: Position, running: tuple[int, int] | None, way: int) -> int:
    """Ticks of taking apart that a task needs before it can be done again; reckoned to whoever does
    it again.
    """
    if running is not None:
        return running[1]
    task = moves.task[way]
    return moves.ticks[moves.count + way] if position.wrong >> task & 1 else 0


def _breaks(row: Sequence[tuple[int, int]], now: int, away: int) -> tuple[tuple[int, int], ...]:
    """Those still to come, seen from now, and an absence."""
    ahead = [(max(0, off - now), back - now) for off, back in row if back > now]
    return tuple(sorted([*ahead, *([(0, away)] if away else [])]))
