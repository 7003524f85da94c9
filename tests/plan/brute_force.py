"""Two yardsticks that know nothing of planning: they try times and let the checker say what is sound."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal
from math import gcd

from tandem.cell.model import Cell
from tandem.schedule.checker import RULES, Judged, each_task_is_done_once
from tandem.schedule.measures import exact, makespan, stress
from tandem.schedule.model import Assignment, Schedule

Point = tuple[float, float]


def front_of_all(cell: Cell, horizon: float) -> list[Point]:
    """The front over all schedules on the grid of the cell's times that end by the horizon. Nothing is left out, so two or three tasks are many."""
    return _front(cell, _on_the_grid(cell, list(cell.tasks), (), exact(horizon)))


def front_in_order(cell: Cell) -> list[Point]:
    """The front over all orders and modes, each task at the first moment at or after the last start at which the checker has nothing to say."""
    return _front(cell, _in_order(cell, ()))


def _on_the_grid(cell: Cell, left: list[str], done: tuple[Assignment, ...], horizon: Decimal) -> Iterator[Schedule]:
    if not left:
        yield Schedule(done)
        return
    for mode in cell.modes(left[0]):
        for start in _grid(cell, Decimal(0), horizon - exact(mode.time)):
            a = Assignment(float(start), float(start + exact(mode.time)), left[0], mode.operators)
            if _is_sound_so_far(cell, (*done, a)):
                yield from _on_the_grid(cell, left[1:], (*done, a), horizon)


def _in_order(cell: Cell, done: tuple[Assignment, ...]) -> Iterator[Schedule]:
    placed = {a.task for a in done}
    if len(placed) == len(cell.tasks):
        yield Schedule(done)
        return
    last = max((exact(a.start) for a in done), default=Decimal(0))
    for name, task in cell.tasks.items():
        if name in placed or not placed.issuperset(task.after):
            continue
        for mode in cell.modes(name):
            for start in _grid(cell, last, _horizon(cell)):
                a = Assignment(float(start), float(start + exact(mode.time)), name, mode.operators)
                if _is_sound_so_far(cell, (*done, a)):
                    yield from _in_order(cell, (*done, a))
                    break


def _is_sound_so_far(cell: Cell, done: tuple[Assignment, ...]) -> bool:
    judged = Judged.of(cell, Schedule(done))
    return not any(sentence for rule in RULES if rule is not each_task_is_done_once for sentence in rule(judged))


def _front(cell: Cell, schedules: Iterator[Schedule]) -> list[Point]:
    points = {(makespan(schedule), stress(cell, schedule)) for schedule in schedules}
    return sorted(p for p in points if not any(q != p and q[0] <= p[0] and q[1] <= p[1] for q in points))


def _grid(cell: Cell, low: Decimal, high: Decimal) -> Iterator[Decimal]:
    step = _step(cell)
    moment = (low / step).to_integral_value(rounding="ROUND_CEILING") * step
    while moment <= high:
        yield moment
        moment += step


def _times(cell: Cell) -> Iterator[Decimal]:
    for name, task in cell.tasks.items():
        yield exact(task.release)
        yield from (exact(mode.time) for mode in cell.modes(name))
    for tool in cell.tools.values():
        yield from map(exact, tool.changeover.values())
    for operator in cell.operators.values():
        yield from (exact(time) for pause in operator.breaks for time in pause)


def _step(cell: Cell) -> Decimal:
    thousandths = [int(time * 1000) for time in _times(cell)]
    return Decimal(gcd(*thousandths)) / 1000


def _horizon(cell: Cell) -> Decimal:
    changeovers = [exact(time) for tool in cell.tools.values() for time in tool.changeover.values()]
    return sum(_times(cell), Decimal(0)) + len(cell.tasks) * max(changeovers, default=Decimal(0))
