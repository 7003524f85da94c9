"""What is exact about a cell of two agents: the front of makespan and difficulty, and the optimum
of what is left after a change.

The planner minimises the stress of humans. In a variant of the cell in which every operator counts
as a human, and in which the stress of a way on each who takes part is its difficulty for them, that
is the difficulty of all.
"""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.files.validate import cell_of
from tandem.lab.zhang2022.change import Happened
from tandem.lab.zhang2022.setting import difficulty_of, tool_of
from tandem.plan.methods import plan
from tandem.plan.result import Front, Status
from tandem.world.arrays import Names
from tandem.world.state import State as Assembly


def as_stress(cell: Cell) -> Cell:
    """The variant whose stress is the cell's difficulty; `tandem.plan` of it gives the front of
    makespan and difficulty.
    """
    data = cell.to_dict()
    for name in cell.operators:
        data["operators"][name] = {
            key: value
            for key, value in data["operators"][name].items()
            if key not in ("stress_limit", "limits")
        } | {"kind": "human"}
    for name, task in data["tasks"].items():
        alone = {
            mode.operators[0]: difficulty_of(cell, name, mode)[mode.operators[0]]
            for mode in cell.modes(name)
            if len(mode.operators) == 1
        }
        task["stress"] = alone
        for joint in task.get("together", ()):
            mode = next(
                mode
                for mode in cell.modes(name)
                if set(mode.operators) == set(joint["operators"]) and mode.time == joint["time"]
            )
            joint["stress"] = dict(difficulty_of(cell, name, mode))
    data.pop("stress_of_set", None)
    return cell_of(data)


def exact_front(cell: Cell, *, time_limit: float = 120.0) -> Front:
    """Every compromise between makespan and difficulty (there called stress), with proof when it is
    complete.
    """
    return plan(
        as_stress(cell), time_limit=time_limit, seed=0, workers=1, settle=False, confirm=False
    )


def matching(
    points: list[tuple[float, float]], time: float, difficulty: float
) -> tuple[float, float]:
    """The front's point of the least cost `time` x makespan + `difficulty` x difficulty; the
    quickest of equals.
    """
    return min(points, key=lambda point: (time * point[0] + difficulty * point[1], point[0]))


def best_of_rest(
    cell: Cell,
    names: Names,
    assembly: Assembly,
    happened: Happened,
    time: float,
    difficulty: float,
    *,
    time_limit: float = 30.0,
) -> float | None:
    """The least cost of all that is still to come: seconds until the end, and the difficulty of
    what has not begun.

    None when it could not be proven within the limit, seconds.
    """
    left, before = rest(cell, names, assembly, happened)
    if left is None:
        return 0.0
    best = plan(
        as_stress(left),
        minimize="weighted",
        weights=(time, difficulty),
        time_limit=time_limit,
        seed=0,
        workers=1,
        settle=False,
        confirm=False,
    )[0]
    if best.status != Status.OPTIMAL:
        return None
    return time * (best.makespan - before) + difficulty * best.stress


def rest(
    cell: Cell, names: Names, assembly: Assembly, happened: Happened
) -> tuple[Cell | None, float]:
    """What is left to do, as a cell of its own; None when nothing is. And how many of its seconds
    have passed already.

    Its clock begins a little before now, by the longest changeover: who has been idle may have
    taken up a tool meanwhile. Nobody works in that time. What is in hand is a task that can only go
    on as it does. Difficulty stands for all but that.
    """
    clock, ways = int(assembly.clock), names.ways
    swaps = [seconds for tool in cell.tools.values() for seconds in tool.changeover.values()]
    lead = names.ticks(max(swaps, default=0.0))
    origin = clock - lead
    way, end = np.asarray(assembly.way), np.asarray(assembly.end_at)
    done = {
        task for index, task in enumerate(names.tasks) if way[index] >= 0 and end[index] <= clock
    }
    running = {
        task: int(way[index])
        for index, task in enumerate(names.tasks)
        if way[index] >= 0 and task not in done
    }
    if len(done) == len(names.tasks):
        return None, 0.0
    back = {
        tool: int(tick)
        for tool, tick in zip(names.tools, np.asarray(happened.back_at), strict=False)
    }
    data = cell.to_dict()
    data["tasks"] = {}
    for index, name in enumerate(names.tasks):
        if name in running:
            data["tasks"][name] = _in_hand(
                cell,
                name,
                ways[running[name]][1].operators,
                names.seconds(lead),
                names.seconds(int(end[index]) - clock),
            )
        elif name not in done:
            ready = max(
                clock,
                names.ticks(cell.tasks[name].release),
                back.get(tool_of(cell, name) or "", 0),
            )
            data["tasks"][name] = _open(
                cell, names, name, np.asarray(assembly.refused), done, names.seconds(ready - origin)
            )
    begun = {
        name: ways[int(way[index])][1].operators
        for index, name in enumerate(names.tasks)
        if way[index] >= 0
    }
    data["same_operator"] = [pair for pair in cell.same_operator if not set(pair) & set(begun)]
    for one, other in [*cell.same_operator, *(pair[::-1] for pair in cell.same_operator)]:
        if one in begun and other in data["tasks"] and other not in running:
            _only(data["tasks"][other], begun[one])
    for index, (name, operator) in enumerate(cell.operators.items()):
        tool, busy = (
            int(np.asarray(assembly.in_hand)[index]),
            min(int(np.asarray(assembly.free_at)[index]), clock),
        )
        rests = [
            (max(0, names.ticks(a) - origin), names.ticks(b) - origin)
            for a, b, _ in operator.times_off
        ] + [(0, busy - origin)]
        data["operators"][name] = {
            "kind": operator.kind,
            "breaks": [[names.seconds(a), names.seconds(b)] for a, b in _merged(rests)],
        }
        if tool >= 0:
            data["operators"][name]["tool"] = names.tools[tool]
    return cell_of(data), names.seconds(lead)


def _open(
    cell: Cell, names: Names, name: str, refused: Any, done: set[str], release: float
) -> dict[str, Any]:
    task = cell.tasks[name]
    kept = [
        mode
        for number, (other, mode) in enumerate(names.ways)
        if other == name and not refused[number]
    ]
    difficulty = {
        who: amount
        for mode in cell.modes(name)
        for who, amount in difficulty_of(cell, name, mode).items()
    }
    data: dict[str, Any] = {
        "time": {mode.operators[0]: mode.time for mode in kept if len(mode.operators) == 1},
        "together": [
            {"operators": list(mode.operators), "time": mode.time}
            for mode in kept
            if len(mode.operators) > 1
        ],
        "after": [first for first in task.after if first not in done],
        "difficulty": difficulty,
        "release": release,
    }
    return data | {
        key: value
        for key, value in (("tool", tool_of(cell, name)), ("zone", task.zone))
        if value is not None
    }


def _in_hand(
    cell: Cell, name: str, operators: tuple[str, ...], begin: float, left: float
) -> dict[str, Any]:
    """A task that goes on from `begin` for `left` seconds with those who do it; its difficulty has
    been paid.
    """
    task = cell.tasks[name]
    how: dict[str, Any] = (
        {"together": [{"operators": list(operators), "time": left}]}
        if len(operators) > 1
        else {"time": {operators[0]: left}}
    )
    places = {
        key: value
        for key, value in (("tool", tool_of(cell, name)), ("zone", task.zone))
        if value is not None
    }
    return {
        **how,
        "release": begin,
        "deadline": float(Decimal(repr(begin)) + Decimal(repr(left))),
        **places,
    }


def _only(task: dict[str, Any], operators: tuple[str, ...]) -> None:
    task["time"] = {who: seconds for who, seconds in task["time"].items() if (who,) == operators}
    task["together"] = [
        joint for joint in task["together"] if set(joint["operators"]) == set(operators)
    ]


def _merged(intervals: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Intervals of positive length, overlapping and touching ones made one."""
    merged: list[tuple[int, int]] = []
    for a, b in sorted(interval for interval in intervals if interval[1] > interval[0]):
        if merged and a <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(b, merged[-1][1]))
        else:
            merged.append((a, b))
    return merged
