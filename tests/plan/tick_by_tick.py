"""A second opinion on schedules: the cell is watched in small steps of time, and each moment must
be in order.

Slow, and unlike the checker in every way, so that the two can judge each other.
"""

from __future__ import annotations

from collections import Counter
from decimal import Decimal
from math import gcd

from tandem.cell.model import Cell
from tandem.cell.parts import Operator
from tandem.schedule.model import Assignment, Schedule


def is_sound(cell: Cell, schedule: Schedule) -> bool:
    """Whether the schedule keeps every rule. Times in the cell and the schedule must be multiples
    of 1 ms.
    """
    rows = list(schedule)
    if sorted(a.task for a in rows) != sorted(cell.tasks) or any(
        set(a.operators) - set(cell.operators) for a in rows
    ):
        return False
    return all(rule(cell, rows) for rule in RULES)


def _ms(seconds: float) -> int:
    return int(Decimal(repr(float(seconds))) * 1000)


def _numbers_fit(cell: Cell, rows: list[Assignment]) -> bool:
    end = {a.task: a.end for a in rows}
    begin = {a.task: a.start for a in rows}
    for a in rows:
        task = cell.tasks[a.task]
        times = {(frozenset((name,)), _ms(time)) for name, time in task.time.items()}
        times |= {(frozenset(joint.operators), _ms(joint.time)) for joint in task.together}
        if (frozenset(a.operators), _ms(a.end) - _ms(a.start)) not in times or len(
            set(a.operators)
        ) < len(a.operators):
            return False
        if (
            a.start < 0
            or a.start < task.release
            or (task.deadline is not None and a.end > task.deadline)
        ):
            return False
        if any(end[first] > a.start for first in task.after):
            return False
        for wait in task.wait:
            since = begin[wait.after] if wait.between == "start-start" else end[wait.after]
            past = _ms(a.start) - _ms(since)
            if past < _ms(wait.at_least):
                return False
            if wait.at_most is not None and past > _ms(wait.at_most):
                return False
    who = {a.task: frozenset(a.operators) for a in rows}
    return all(who[one] == who[other] for one, other in cell.same_operator)


def _stress_fits(cell: Cell, rows: list[Assignment]) -> bool:
    sums: Counter[str] = Counter()
    touched = []
    for name, task in cell.tasks.items():
        who = next(a.operators for a in rows if a.task == name)
        humans = [human for human in who if cell.operators[human].kind == "human"]
        joint = (
            next((joint for joint in task.together if set(joint.operators) == set(who)), None)
            if len(who) > 1
            else None
        )
        stress = task.stress if joint is None or joint.stress is None else joint.stress
        for human in humans:
            sums[human] += round(
                1000 * (stress if isinstance(stress, float) else stress.get(human, 0))
            )
        touched += [name] if humans else []
    listed = cell.stress_of_set is None or ",".join(touched) in cell.stress_of_set
    return listed and all(
        o.stress_limit is None or sums[name] <= round(1000 * o.stress_limit)
        for name, o in cell.operators.items()
    )


def _ready(operator: Operator, step: int) -> int:
    """When the operator has been set up: the first moment behind so long a time without a break."""
    long, begin = _ms(operator.setup), 0
    while any(_ms(start) < begin + long and begin < _ms(end) for start, end in operator.breaks):
        begin += step
    return begin + long if long else 0


def _tool(cell: Cell, a: Assignment, name: str) -> str | None:
    """What the operator needs in hand for it, done by these."""
    stated = cell.tasks[a.task].tool
    for joint in cell.tasks[a.task].together:
        if (
            joint.tool is not None
            and len(a.operators) > 1
            and set(joint.operators) == set(a.operators)
        ):
            stated = joint.tool
    return stated if stated is None or isinstance(stated, str) else stated.get(name)


def _kept_apart(cell: Cell, rows: list[Assignment]) -> bool:
    """Whether at no moment at which a task starts kinds that its zone keeps apart are there."""
    for a in rows:
        name = cell.tasks[a.task].zone
        there = {
            cell.operators[who].kind
            for other in rows
            if cell.tasks[other.task].zone == name and other.start <= a.start < other.end
            for who in other.operators
        }
        if name in cell.zones and len(there & set(cell.zones[name].apart)) > 1:
            return False
    return True


def _parts_are_held(cell: Cell, rows: list[Assignment]) -> bool:
    """Whether each machine, while it holds a part, is busy with nothing that is not on the way from
    the first to the last task of the hold, and holds no other part unless one is on the way of the
    other.
    """
    start, end = {a.task: _ms(a.start) for a in rows}, {a.task: _ms(a.end) for a in rows}
    for name, operator in cell.operators.items():
        spans = [
            (start[first], end[last], {first, last}, _on_the_way(cell, first, last))
            for first, last in operator.holds
        ]
        for place, (begin, over, ends, inside) in enumerate(spans):
            for a, busy in _busy(cell, rows, name):
                if a.task not in inside and busy < over and begin < _ms(a.end):
                    return False
            for its_begin, its_over, its_ends, its_inside in spans[:place]:
                nested = ends <= its_inside or its_ends <= inside
                if not nested and begin < its_over and its_begin < over:
                    return False
    return True


def _on_the_way(cell: Cell, first: str, last: str) -> set[str]:
    """Tasks on a path of predecessors from the last task to the first."""
    if first == last:
        return {last}
    task = cell.tasks[last]
    ended = {*task.after, *(wait.after for wait in task.wait if wait.between == "end-start")}
    paths = [_on_the_way(cell, first, before) for before in ended]
    found = set().union(*(path for path in paths if path))
    return found | {last} if found else set()


def _busy(cell: Cell, rows: list[Assignment], name: str) -> list[tuple[Assignment, int]]:
    """Each task of the operator in order, and when its walk there and its changeover begin, ms."""
    found, hand, at = [], cell.operators[name].tool, cell.operators[name].place
    for a in sorted((a for a in rows if name in a.operators), key=lambda a: a.start):
        tool, place, before = _tool(cell, a, name), cell.tasks[a.task].place, 0
        if tool is not None and hand is not None and tool != hand and tool in cell.tools:
            before = _ms(cell.tools[tool].changeover.get(name, 0))
        if place is not None:
            before += _ms(cell.walking.get(name, {}).get((at, place), 0) if at else 0)
            at = place
        found.append((a, _ms(a.start) - before))
        hand = hand if tool is None else tool
    return found


def _moments_fit(cell: Cell, rows: list[Assignment]) -> bool:
    """Everyone does one thing at a time: a task, a walk, a changeover or a break; and no tool or
    zone is over its capacity.
    """
    times = [_ms(time) for a in rows for time in (a.start, a.end)]
    times += [_ms(time) for o in cell.operators.values() for pause in o.breaks for time in pause]
    times += [_ms(o.setup) for o in cell.operators.values()]
    times += [_ms(time) for tool in cell.tools.values() for time in tool.changeover.values()]
    times += [_ms(time) for table in cell.walking.values() for time in table.values()]
    step = gcd(*times) or 1000
    doing: Counter[tuple[str, int]] = Counter()
    used: Counter[tuple[str, str, int]] = Counter()

    def occupy(operator: str, start: int, end: int) -> None:
        doing.update((operator, moment) for moment in range(start, end, step))

    for name, operator in cell.operators.items():
        for start, end in operator.breaks:
            occupy(name, _ms(start), _ms(end))
        for moment in range(0, _ready(operator, step), step):
            if not doing[name, moment]:
                occupy(name, moment, moment + step)
        for a, begin in _busy(cell, rows, name):
            if begin < 0:
                return False
            occupy(name, begin, _ms(a.end))
            tool = _tool(cell, a, name)
            for kind, place in (("tool", tool), ("zone", cell.tasks[a.task].zone)):
                if place is not None:
                    used.update(
                        (kind, place, moment) for moment in range(_ms(a.start), _ms(a.end), step)
                    )
    places = {("tool", name): tool.capacity for name, tool in cell.tools.items()}
    places |= {("zone", name): zone.capacity for name, zone in cell.zones.items()}
    return all(count == 1 for count in doing.values()) and all(
        count <= places.get((kind, name), 1) for (kind, name, _), count in used.items()
    )


RULES = (_numbers_fit, _stress_fits, _kept_apart, _parts_are_held, _moments_fit)
