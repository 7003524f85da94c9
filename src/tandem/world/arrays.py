"""A cell as arrays, in whole numbers: what the world's functions read, in NumPy; `jax.jit` and
`jax.vmap` take it as it is.

Axes: `T` tasks and `O` operators in the cell's order; `W` ways, every way of doing every task, in
the order of the tasks and then of `cell.modes(task)`; `U` tools, `Z` zones, `B` breaks per
operator, `S` listed sets, `L` waits, `A` limits of people. What a cell does not say has an axis of
length 0, and what it would cost is not computed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np

from tandem.cell.model import Cell
from tandem.cell.parts import Mode
from tandem.errors import CellError, Fault, UsageError
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.schedule.model import Assignment, Schedule

Array = Any
"""A NumPy or JAX array, or a tracer of one."""

NEVER = 2**31 - 1
"""A tick that does not come."""

FINE = 1000
"""Ticks in a second that are sought, so that drawn durations need little rounding."""

ROOM = 16
"""So many times the longest nominal schedule must fit below `NEVER`: people may be slow, and things
be done anew.
"""


class Arrays(NamedTuple):
    """One cell. Times in ticks, stress in units; `Names` leads back to names, seconds and the
    cell's own stress.

    way_task: `[W]` int32, the task that the way does; `of_task`: `[W, T]` bool, the same as one row
    of one True each. way_uses: `[W, O]` bool, who takes part; `way_size`: `[W]` int32, how many
    they are. way_ticks: `[W]` int32, the nominal duration. way_load: `[W, O]` int32, the stress
    that it puts on each. way_open: `[W]` bool, False where no schedule can hold it: more operators
    than the tool or the zone has places, or a way that a partner in
      `same_operator` lacks.
    spread: `[W]` float32, coefficient of variation of the duration that the cell states; 0 when it
    states none. needs: `[T, T]` bool, `needs[i, j]`: task i comes after task j. release, deadline:
    `[T]` int32; a task without a deadline has NEVER. tail: `[T]` int32, the longest chain of tasks
    that starts with the task, each in its quickest way. human: `[O]` bool. rank: `[O]` int32, who
    decides first at one moment: the humans, then the robots, in the cell's order. way_tool: `[W,
    O]` int32, the tool that the operator needs in hand, -1 for none; `[0, O]` when tools play no
    part. swap: `[W, O]` int32, how long the operator takes to take that tool up when it holds
    another one; `[0, O]` when tools play no part. takes: `[W, U]` int32, how many of the tool the
    way needs. of_zone: `[T, Z]` bool, the zone that the task needs. tool_places, zone_places:
    `[U]`, `[Z]` int32, how many operators have room.
    holds: `[H, 2]` int32, the first and the last task of each time in which a machine holds a part;
    `[0, 2]` when none does. hold_of: `[H, O]` bool, the machine. hold_bars: `[H, W]` bool, the ways
    that may not begin meanwhile. hold_rivals: `[H, H]` bool, those that one machine cannot have at
    once. hold_ahead: `[H, T]` bool, the tasks that must have begun before.
    apart: `[W, W]` bool, True where a zone keeps the operators of two ways apart; `[0, 0]` when
    none keeps any.
    in_hand: `[O]` int32, the tool in hand at the start, -1 while the first one costs nothing.
    stands: `[O]` int32, the place where it stands at the start, -1 while the way to the first one
    costs nothing. place: `[T]` int32, where the task is done, -1 for anywhere; `[0]` when nobody
    needs time to walk. walk: `[O, P, P]` int32, how long the operator takes from the first to the
    second of `P` places; `[O, 0, 0]` when nobody needs time to walk.
    break_from, break_to: `[O, B]` int32, sorted; NEVER where an operator has fewer. limit: `[A]`
    int32, of each limit of a person what all that they do may take of it; `[0]` when nobody has
    one. due: `[W, A]` int32, what the way takes; owes: `[W, A]` bool, the person takes part. must:
    `[T, A]` int32, the least that the task takes in any of its ways. same: `[T, T]`
    bool, True where two different tasks must be done by the same operators; `[0, 0]` when there are
    none. sets, set_stress: `[S, T]` bool and `[S]` int32: the cell's `stress_of_set`. undo: `[W]`
    int32, how long the disassembly takes of what was mounted wrongly; `[0]` when nobody makes
    mistakes. lag_task, lag_before: `[L, T]` bool, the task that waits, and the one whose end, or
    start where `lag_from_start` `[L]` bool, it waits from; one True each. lag_least, lag_most:
    `[L]` int32, how long at least and at most; NEVER for no most. above: `[T, T]` bool,
    `above[i, j]`: task i comes after task j, directly or not; `[0, 0]` when nobody makes mistakes.
    """

    way_task: Array
    of_task: Array
    way_uses: Array
    way_size: Array
    way_ticks: Array
    way_load: Array
    way_open: Array
    spread: Array
    needs: Array
    release: Array
    deadline: Array
    tail: Array
    human: Array
    rank: Array
    way_tool: Array
    swap: Array
    takes: Array
    tool_places: Array
    of_zone: Array
    zone_places: Array
    apart: Array
    holds: Array
    hold_of: Array
    hold_bars: Array
    hold_rivals: Array
    hold_ahead: Array
    in_hand: Array
    stands: Array
    place: Array
    walk: Array
    break_from: Array
    break_to: Array
    limit: Array
    due: Array
    owes: Array
    must: Array
    same: Array
    sets: Array
    set_stress: Array
    undo: Array
    lag_task: Array
    lag_before: Array
    lag_from_start: Array
    lag_least: Array
    lag_most: Array
    above: Array


def arrays(cell: Cell, *, per_second: int | None = None, undo: float | None = None) -> Arrays:
    """The cell as arrays.

    Args:
      per_second: ticks in a second; a multiple of what makes every time of the cell whole. 1000 or
        so when absent.
      undo: what the disassembly of a task takes, as a share of the task's own time; None when
        nobody makes mistakes.

    Raises:
      CellError: times or stresses are too large to be counted in whole numbers of 32 bits.
      UsageError: `per_second` does not fit the cell, or `undo` is no share above 0.
    """
    return Names.of(cell, per_second=per_second).arrays(undo=undo)


@dataclass(frozen=True)
class Names:
    """What leads from arrays back to a cell's words.

    Attributes:
      cell: the cell.
      per_second: ticks in a second.
      per_stress: units in a stress of 1.
    """

    cell: Cell
    per_second: int
    per_stress: int

    @classmethod
    def of(cls, cell: Cell, *, per_second: int | None = None) -> Self:
        """The cell's names; raises as `arrays` does."""
        instance = Instance.of(cell)
        if per_second is None:
            per_second = instance.per_second
            while per_second < FINE and ROOM * 10 * per_second * _horizon(instance) < NEVER:
                per_second *= 10
        elif isinstance(per_second, bool) or per_second < 1 or per_second % instance.per_second:
            raise UsageError(
                f"per_second is {per_second!r}: the times of this cell are whole in ticks of"
                f" 1/{instance.per_second} s; give a multiple of that."
            )
        _must_fit(instance, per_second)
        return cls(cell, per_second, instance.per_stress)

    @cached_property
    def instance(self) -> Instance:
        """The cell in whole numbers, in these ticks."""
        stated = Instance.of(self.cell)
        return stated.scaled(self.per_second // stated.per_second)

    @property
    def tools(self) -> tuple[str, ...]:
        """The tools' names, as `in_hand` counts them."""
        return self.cell.tool_names

    @property
    def places(self) -> tuple[str, ...]:
        """The places' names, as `stands` counts them."""
        return self.cell.place_names

    @cached_property
    def tasks(self) -> tuple[str, ...]:
        """The tasks' names."""
        return tuple(self.cell.tasks)

    @cached_property
    def operators(self) -> tuple[str, ...]:
        """The operators' names."""
        return tuple(self.cell.operators)

    @cached_property
    def ways(self) -> tuple[tuple[str, Mode], ...]:
        """Per way, its task and its mode."""
        return tuple((task, mode) for task in self.cell.tasks for mode in self.cell.modes(task))

    def way(self, task: str, operators: Sequence[str]) -> int:
        """The number of the way in which these operators do the task; -1 when there is none. The
        quickest, should there be several.
        """
        who = set(operators)
        found = [
            (mode.time, way)
            for way, (name, mode) in enumerate(self.ways)
            if name == task and set(mode.operators) == who
        ]
        return min(found, default=(0.0, -1))[1]

    def ticks(self, seconds: float) -> int:
        """Seconds in ticks, to the nearest."""
        return round(Decimal(repr(float(seconds))) * self.per_second)

    def seconds(self, ticks: int) -> float:
        """Ticks in seconds: the nearest float, which prints as the exact decimal."""
        return float(Decimal(int(ticks)) / self.per_second)

    def stress(self, units: int) -> float:
        """Units in the cell's own measure of stress."""
        return float(Decimal(int(units)) / self.per_stress)

    def assignment(self, way: int, start: int, end: int) -> Assignment:
        """Work in that way, from tick to tick."""
        task, mode = self.ways[way]
        return Assignment(self.seconds(start), self.seconds(end), task, mode.operators)

    def schedule(self, way: Array, start_at: Array, end_at: Array) -> Schedule:
        """`[T]` each, as a state holds them -> the tasks that have begun, in names and seconds."""
        rows = zip(
            np.asarray(way).tolist(),
            np.asarray(start_at).tolist(),
            np.asarray(end_at).tolist(),
            strict=True,
        )
        return Schedule(tuple(self.assignment(*row) for row in rows if row[0] >= 0))

    def arrays(self, *, undo: float | None = None) -> Arrays:
        """See `arrays`."""
        if undo is not None and not 0 < undo <= 100:
            raise UsageError(
                f"undo is {undo!r}: give the share of a task's time that its disassembly takes,"
                " more than 0, at most 100."
            )
        layout = Layout.of(self.instance)
        return Arrays(
            **{
                key: _in_32_bits(part) for make in PARTS for key, part in make(self, layout).items()
            },
            **_undoing(self, layout, undo),
        )


def namespace(array: Array) -> Any:
    """The module (`numpy`, `jax.numpy`) that the array belongs to."""
    return array.__array_namespace__()


def _ways(names: Names, layout: Layout) -> dict[str, Any]:
    instance, modes = layout.instance, names.ways
    flat = [
        (task, number, way)
        for task, row in enumerate(instance.ways)
        for number, way in enumerate(row)
    ]
    task = np.array([task for task, _, _ in flat])
    uses = np.zeros((len(flat), len(instance.operators)), bool)
    load = np.zeros(uses.shape, np.int64)
    for row, (_, _, way) in enumerate(flat):
        uses[row, list(way.operators)] = True
        load[row, list(way.operators)] = way.load
    # where no set of human tasks is listed, no schedule is allowed, so no way is open
    nothing_is_listed = instance.stress_of_set is not None and not instance.stress_of_set
    opened = [
        set[int]() if nothing_is_listed else {step.way for step in steps} for steps in layout.steps
    ]
    return {
        "way_task": task,
        "of_task": np.arange(len(instance.tasks))[None, :] == task[:, None],
        "way_uses": uses,
        "way_size": uses.sum(axis=1),
        "way_ticks": np.array([way.ticks for _, _, way in flat]),
        "way_load": load,
        "way_open": np.array([number in opened[mine] for mine, number, _ in flat]),
        "spread": np.array([_spread(names.cell, name, mode) for name, mode in modes], np.float32),
    }


def _tasks(names: Names, layout: Layout) -> dict[str, Any]:
    instance = layout.instance
    needs = np.zeros((len(instance.tasks), len(instance.tasks)), bool)
    for task, firsts in enumerate(instance.before):
        needs[task, list(firsts)] = True
    return {
        "needs": needs,
        "release": np.array(instance.release),
        "deadline": np.array([NEVER if ticks is None else ticks for ticks in instance.deadline]),
        "tail": np.array(layout.tail),
    }


def _operators(names: Names, layout: Layout) -> dict[str, Any]:
    instance = layout.instance
    order = sorted(
        range(len(instance.operators)),
        key=lambda operator: (not instance.human[operator], operator),
    )
    rest = np.full((len(instance.operators), max(map(len, instance.breaks)), 2), NEVER, np.int64)
    for row, breaks in zip(rest, instance.breaks, strict=True):
        row[: len(breaks)] = np.array(breaks, np.int64).reshape(-1, 2)
    due = np.zeros((sum(map(len, instance.ways)), len(instance.allowances)), np.int64)
    owes = np.zeros(due.shape, bool)
    for place, way in enumerate(way for ways in instance.ways for way in ways):
        for number, units in way.dues:
            due[place, number], owes[place, number] = units, True
    return {
        "human": np.array(instance.human),
        "rank": np.argsort(order),
        "in_hand": np.array([-1 if tool is None else tool for tool in instance.in_hand]),
        "stands": np.array([-1 if place is None else place for place in instance.stands]),
        "break_from": rest[..., 0],
        "break_to": rest[..., 1],
        "limit": np.array([allowance.most for allowance in instance.allowances], np.int64),
        "due": due,
        "owes": owes,
        "must": np.array(layout.must, np.int64).reshape(len(instance.tasks), -1),
    }


def _places(names: Names, layout: Layout) -> dict[str, Any]:
    instance, everybody = layout.instance, len(layout.instance.operators)
    zone = np.array(instance.timed_zone)
    # arrays of length 0 switch a rule off: what the cell does not have costs no time
    tools = len(instance.tools) if instance.has_tools else 0
    zones = len(instance.zones) if (zone >= 0).any() else 0
    flat = [way for row in instance.ways for way in row] if tools else []
    # per way, so that no step has to look up whose tool it is
    hands = np.full((len(flat), everybody), -1, np.int64)
    swap, takes = np.zeros_like(hands), np.zeros((len(flat), tools), np.int64)
    for number, way in enumerate(flat):
        for operator, mine in zip(way.operators, way.tools, strict=True):
            if mine is not None:
                hands[number, operator] = mine
                swap[number, operator] = instance.changeover[mine][operator]
                takes[number, mine] += 1
    return {
        "way_tool": hands,
        "swap": swap,
        "takes": takes,
        "tool_places": np.array(
            [places or everybody for places in instance.tool_room[:tools]], np.int64
        ),
        "of_zone": np.arange(zones)[None, :] == zone[:, None],
        "zone_places": np.array(
            [places or everybody for places in instance.zone_room[:zones]], np.int64
        ),
        "apart": _apart(instance),
    }


def _apart(instance: Instance) -> Array:
    """`[W, W]` bool, the ways that a zone keeps apart; `[0, 0]` when none keeps any."""
    if not instance.has_apart:
        return np.zeros((0, 0), bool)
    there = [
        (instance.zone[task], instance.sides(task, way))
        for task, row in enumerate(instance.ways)
        for way in row
    ]
    return np.array(
        [
            [
                zone == place and bool(mine) and bool(theirs) and mine != theirs
                for place, theirs in there
            ]
            for zone, mine in there
        ],
        bool,
    )


def _holds(names: Names, layout: Layout) -> dict[str, Any]:
    instance = layout.instance
    tasks, holds = range(len(instance.tasks)), range(len(instance.holds))
    flat = [(task, way) for task, row in enumerate(instance.ways) for way in row]

    def table(of_hold: Sequence[int], count: int) -> Array:
        rows = [[number >> one & 1 for one in range(count)] for number in of_hold]
        return np.array(rows, bool).reshape(len(holds), count)

    barred, rivals = table(instance.barred, len(tasks)), table(instance.rivals, len(holds))
    bars = np.zeros((len(holds), len(flat)), bool)
    for hold in holds:
        firsts = [instance.holds[other][1] for other in holds if rivals[hold, other]]
        for number, (task, way) in enumerate(flat):
            does = instance.holds[hold][0] in way.operators and barred[hold, task]
            bars[hold, number] = does or task in firsts
    return {
        "holds": np.array([hold[1:] for hold in instance.holds], np.int64).reshape(-1, 2),
        "hold_of": table(
            [1 << operator for operator, _, _ in instance.holds], len(instance.operators)
        ),
        "hold_bars": bars,
        "hold_rivals": rivals,
        "hold_ahead": table(instance.ahead_of_hold, len(tasks)),
    }


def _sets(names: Names, layout: Layout) -> dict[str, Any]:
    instance, count = layout.instance, len(names.tasks)
    team = np.array(layout.instance.team)
    teams = (team[:, None] == team[None, :]) & (team >= 0)[:, None] & ~np.eye(count, dtype=bool)
    listed = instance.stress_of_set or {}
    table = {
        tasks: units
        for tasks, units in listed.items()
        if not layout.with_humans_at(tasks).impossible()
    } or listed
    return {
        "same": teams if teams.any() else np.zeros((0, 0), bool),
        "sets": (
            np.array([[task in tasks for task in range(count)] for tasks in table], bool).reshape(
                len(table), count
            )
        ),
        "set_stress": np.array(list(table.values()), np.int64),
    }


def _lags(names: Names, layout: Layout) -> dict[str, Any]:
    lags, tasks = layout.instance.lags, np.arange(len(layout.instance.tasks))
    return {
        "lag_task": tasks[None, :] == np.array([lag.task for lag in lags], np.int64)[:, None],
        "lag_before": tasks[None, :] == np.array([lag.before for lag in lags], np.int64)[:, None],
        "lag_from_start": np.array([lag.from_start for lag in lags], bool),
        "lag_least": np.array([lag.least for lag in lags], np.int64),
        "lag_most": np.array([NEVER if lag.most is None else lag.most for lag in lags], np.int64),
    }


def _walks(names: Names, layout: Layout) -> dict[str, Any]:
    instance = layout.instance
    if not any(instance.walks):
        return {
            "place": np.zeros(0, np.int64),
            "walk": np.zeros((len(instance.operators), 0, 0), np.int64),
        }
    return {
        "place": np.array([-1 if place is None else place for place in instance.place]),
        "walk": np.array(instance.walk, np.int64),
    }


PARTS = (_ways, _tasks, _operators, _places, _walks, _holds, _sets, _lags)


def _undoing(names: Names, layout: Layout, undo: float | None) -> dict[str, Any]:
    if undo is None:
        return {"undo": np.zeros(0, np.int32), "above": np.zeros((0, 0), bool)}
    above = np.zeros((len(names.tasks), len(names.tasks)), bool)
    for task in layout.instance.order:
        for first in layout.instance.before[task]:
            above[task] |= above[first]
            above[task, first] = True
    ticks = [max(1, round(mode.time * undo * names.per_second)) for _, mode in names.ways]
    return {"undo": np.array(ticks, np.int32), "above": above}


def _spread(cell: Cell, task: str, mode: Mode) -> float:
    """The largest that the cell states for anyone who takes part."""
    stated = cell.tasks[task].spread
    return (
        stated if isinstance(stated, float) else max(stated.get(who, 0.0) for who in mode.operators)
    )


def _in_32_bits(part: Array) -> Array:
    return part.astype(np.int32) if np.issubdtype(part.dtype, np.integer) else part


def _horizon(instance: Instance) -> float:
    """Seconds by which everything has ended at the latest, with what has a deadline."""
    latest = max([0, *(deadline for deadline in instance.deadline if deadline is not None)])
    latest = max([latest, *(most for _, most in instance.most_lags)])
    return max(instance.horizon, latest) / instance.per_second


def _must_fit(instance: Instance, per_second: int) -> None:
    faults = []
    if ROOM * per_second * _horizon(instance) >= NEVER:
        faults.append(
            Fault(
                f"all work one after the other takes {_horizon(instance):.6g} s, and the times are"
                f" counted in ticks of 1/{per_second} s: more ticks than the simulation can count."
                " Round the times to a coarser step, or cut the cell.",
                ("tasks",),
            )
        )
    if sum(max(way.stress for way in row) for row in instance.ways) >= NEVER // ROOM:
        faults.append(
            Fault(
                "the stresses have too wide a range for the simulation to count. Round them to a"
                " coarser step.",
                ("tasks",),
            )
        )
    if faults:
        raise CellError(faults)
