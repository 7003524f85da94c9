"""A cell in whole numbers, as solvers want it: names become indices, seconds become ticks, exactly.

Only solvers read this form. The checker and the measures never do: they judge from the cell itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property

from tandem.cell.model import Cell
from tandem.schedule.model import Assignment, Schedule


@dataclass(frozen=True)
class Way:
    """One mode of one task. `operators` are indices, `ticks` the duration, `load` the stress per
    operator (0 for robots).
    """

    operators: tuple[int, ...]
    ticks: int
    load: tuple[int, ...]

    @cached_property
    def stress(self) -> int:
        return sum(self.load)


@dataclass(frozen=True)
class Instance:
    """The cell's numbers; tasks, operators, tools and zones are indices in the cell's order.

    Attributes:
      per_second: ticks in a second, a power of ten that makes every time of the cell whole.
      per_stress: units of stress in 1, likewise.
      ways: per task, every mode of it, in the order of `cell.modes`.
      before, behind: per task, its direct predecessors and successors.
      order: tasks so that predecessors come first.
      release, deadline: ticks per task; a task without a deadline has None.
      tool, zone: per task, an index or None. `tools` and `zones` are their names.
      tool_places, zone_places: capacity per tool and zone.
      changeover: `[tool][operator]` ticks.
      in_hand: per operator, the tool at the start or None.
      breaks: per operator, `(from, to)` ticks, sorted, disjoint.
      stress_limit: per operator, units or None.
      same_operator: pairs of tasks.
      stress_of_set: set of tasks done by humans -> units; None when stress adds up.
    """

    cell: Cell
    per_second: int
    per_stress: int
    operators: tuple[str, ...]
    tasks: tuple[str, ...]
    tools: tuple[str, ...]
    zones: tuple[str, ...]
    human: tuple[bool, ...]
    ways: tuple[tuple[Way, ...], ...]
    before: tuple[tuple[int, ...], ...]
    behind: tuple[tuple[int, ...], ...]
    order: tuple[int, ...]
    release: tuple[int, ...]
    deadline: tuple[int | None, ...]
    tool: tuple[int | None, ...]
    zone: tuple[int | None, ...]
    tool_places: tuple[int, ...]
    zone_places: tuple[int, ...]
    changeover: tuple[tuple[int, ...], ...]
    in_hand: tuple[int | None, ...]
    breaks: tuple[tuple[tuple[int, int], ...], ...]
    stress_limit: tuple[int | None, ...]
    same_operator: tuple[tuple[int, int], ...]
    stress_of_set: dict[frozenset[int], int] | None

    @classmethod
    def of(cls, cell: Cell) -> Instance:
        """The cell's instance: nothing is rounded."""
        per_second, per_stress = _scale(_times_in(cell)), _scale(_stresses_in(cell))
        operators, tasks = tuple(cell.operators), tuple(cell.tasks)
        o = {name: i for i, name in enumerate(operators)}
        t = {name: i for i, name in enumerate(tasks)}
        tools = tuple(
            dict.fromkeys(
                [
                    *(x.tool for x in cell.tasks.values() if x.tool),
                    *cell.tools,
                    *(x.tool for x in cell.operators.values() if x.tool),
                ]
            )
        )
        zones = tuple(
            dict.fromkeys([*(x.zone for x in cell.tasks.values() if x.zone), *cell.zones])
        )

        def ticks(seconds: float) -> int:
            return _whole(seconds, per_second)

        def units(stress: float) -> int:
            return _whole(stress, per_stress)

        ways = tuple(
            tuple(
                Way(
                    tuple(o[name] for name in mode.operators),
                    ticks(mode.time),
                    tuple(units(mode.stress.get(name, 0.0)) for name in mode.operators),
                )
                for mode in cell.modes(name)
            )
            for name in tasks
        )
        before = tuple(
            tuple(dict.fromkeys(t[a] for a in task.after)) for task in cell.tasks.values()
        )
        behind: list[list[int]] = [[] for _ in tasks]
        for task, firsts in enumerate(before):
            for first in firsts:
                behind[first].append(task)
        return cls(
            cell=cell,
            per_second=per_second,
            per_stress=per_stress,
            operators=operators,
            tasks=tasks,
            tools=tools,
            zones=zones,
            human=tuple(x.kind == "human" for x in cell.operators.values()),
            ways=ways,
            before=before,
            behind=tuple(map(tuple, behind)),
            order=_topological(before, behind),
            release=tuple(ticks(x.release) for x in cell.tasks.values()),
            deadline=tuple(
                None if x.deadline is None else ticks(x.deadline) for x in cell.tasks.values()
            ),
            tool=tuple(
                None if x.tool is None else tools.index(x.tool) for x in cell.tasks.values()
            ),
            zone=tuple(
                None if x.zone is None else zones.index(x.zone) for x in cell.tasks.values()
            ),
            tool_places=tuple(cell.tools[x].capacity if x in cell.tools else 1 for x in tools),
            zone_places=tuple(cell.zones[x].capacity if x in cell.zones else 1 for x in zones),
            changeover=tuple(
                tuple(
                    ticks(cell.tools[x].changeover.get(who, 0.0)) if x in cell.tools else 0
                    for who in operators
                )
                for x in tools
            ),
            in_hand=tuple(
                None if x.tool is None else tools.index(x.tool) for x in cell.operators.values()
            ),
            breaks=tuple(
                tuple(sorted((ticks(a), ticks(b)) for a, b in x.breaks))
                for x in cell.operators.values()
            ),
            stress_limit=tuple(
                None if x.stress_limit is None else units(x.stress_limit)
                for x in cell.operators.values()
            ),
            same_operator=tuple((t[a], t[b]) for a, b in cell.same_operator),
            stress_of_set=None
            if cell.stress_of_set is None
            else {
                frozenset(t[name] for name in key.split(",") if name): units(value)
                for key, value in cell.stress_of_set.items()
            },
        )

    @cached_property
    def horizon(self) -> int:
        """Ticks by which everything can end, if it can end at all: all tasks one after the other,
        behind every release and break.
        """
        work = sum(max(way.ticks for way in ways) for ways in self.ways)
        swaps = max((max(row) for row in self.changeover), default=0) * len(self.tasks)
        waits = max(self.release, default=0) + sum(
            end for breaks in self.breaks for _, end in breaks
        )
        return work + swaps + waits

    @cached_property
    def tail(self) -> tuple[int, ...]:
        """Per task, ticks on the longest chain that starts with it, every task in its quickest
        mode.
        """
        tail = [0] * len(self.tasks)
        for task in reversed(self.order):
            tail[task] = min(way.ticks for way in self.ways[task]) + max(
                (tail[after] for after in self.behind[task]), default=0
            )
        return tuple(tail)

    @cached_property
    def head(self) -> tuple[int, ...]:
        """Per task, ticks before which it cannot start because of releases and predecessors in
        their quickest modes.
        """
        head = [0] * len(self.tasks)
        for task in self.order:
            head[task] = max(
                [
                    self.release[task],
                    *(
                        head[first] + min(way.ticks for way in self.ways[first])
                        for first in self.before[task]
                    ),
                ]
            )
        return tuple(head)

    def seconds(self, ticks: int) -> float:
        """Ticks in seconds: the nearest float, which prints as the exact decimal."""
        return float(Decimal(ticks) / self.per_second)

    def stress(self, units: int) -> float:
        """Units in the cell's own measure of stress."""
        return float(Decimal(units) / self.per_stress)

    def schedule(self, starts: Iterable[tuple[int, int]]) -> Schedule:
        """Per task, in order, `(way, start in ticks)` -> the schedule in names and seconds."""
        rows = []
        for task, (way, start) in enumerate(starts):
            chosen = self.ways[task][way]
            rows.append(
                Assignment(
                    self.seconds(start),
                    self.seconds(start + chosen.ticks),
                    self.tasks[task],
                    tuple(self.operators[i] for i in chosen.operators),
                )
            )
        return Schedule(tuple(rows))

    def starts(self, schedule: Schedule) -> tuple[tuple[int, int], ...]:
        """Per task `(way, start in ticks)` of a sound schedule; starts between two ticks are cut
        down to the earlier one.
        """
        by_task = {a.task: a for a in schedule}
        starts = []
        for task, ways in enumerate(self.ways):
            row = by_task[self.tasks[task]]
            start, end = (
                int(Decimal(repr(moment)) * self.per_second) for moment in (row.start, row.end)
            )
            team = tuple(sorted(self.operators.index(name) for name in row.operators))
            starts.append(
                (
                    next(
                        w
                        for w, way in enumerate(ways)
                        if way.operators == team and way.ticks == end - start
                    ),
                    start,
                )
            )
        return tuple(starts)


def _topological(before: tuple[tuple[int, ...], ...], behind: list[list[int]]) -> tuple[int, ...]:
    waiting = [len(firsts) for firsts in before]
    ready = [task for task, count in enumerate(waiting) if count == 0]
    for task in ready:
        for after in behind[task]:
            waiting[after] -= 1
            if waiting[after] == 0:
                ready.append(after)
    return tuple(ready)


def _whole(number: float, scale: int) -> int:
    """The decimal that the number prints as, times the scale that makes it whole."""
    return int(number) * scale if float(number).is_integer() else int(Decimal(repr(number)) * scale)


def _scale(numbers: Iterable[float]) -> int:
    """The smallest power of ten that makes every number whole."""
    exponents = (
        Decimal(repr(number)).normalize().as_tuple().exponent
        for number in numbers
        if not float(number).is_integer()
    )
    scale: int = 10 ** max(
        (-int(exponent) for exponent in exponents if int(exponent) < 0), default=0
    )
    return scale


def _times_in(cell: Cell) -> Iterable[float]:
    for task in cell.tasks.values():
        yield from task.time.values()
        yield from (joint.time for joint in task.together)
        yield task.release
        if task.deadline is not None:
            yield task.deadline
    for tool in cell.tools.values():
        yield from tool.changeover.values()
    for operator in cell.operators.values():
        for pair in operator.breaks:
            yield from pair


def _stresses_in(cell: Cell) -> Iterable[float]:
    for name in cell.tasks:
        for mode in cell.modes(name):
            yield from mode.stress.values()
    yield from (
        operator.stress_limit
        for operator in cell.operators.values()
        if operator.stress_limit is not None
    )
    yield from (cell.stress_of_set or {}).values()
