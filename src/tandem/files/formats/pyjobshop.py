"""Instances of PyJobShop as JSON (`ProblemData.from_json`, version 0.0.9).

Operators become machines; each way of doing a task a mode that needs its operators. A tool or a
zone becomes a renewable resource of which a mode needs a unit for each operator, a limit of stress
a consumable one. Precedence and waits become bounds between starts and ends, releases and deadlines
bounds of a task, times off breaks of a machine. The objective is the makespan.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from typing import Any

from tandem.cell.model import Cell
from tandem.cell.parts import Mode, Wait
from tandem.errors import Fault
from tandem.files.formats.written import (
    Whole,
    Written,
    all_times,
    not_said,
    refuse,
    whole_numbers,
)

FORM = "pyjobshop"
OPERATOR = ("breaks", "setup", "stress_limit", "tool")
TASK = ("time", "together", "after", "wait", "tool", "zone", "release", "deadline")


def write(cell: Cell) -> Written:
    """The cell as an instance with the same schedules.

    Raises:
      CellError: the cell says more than that; with every reason.
    """
    refuse(_without_pairs(cell), FORM, operator=OPERATOR, task=TASK, further=_changeovers(cell))
    unit = whole_numbers(_seconds(cell))
    load = whole_numbers(_stresses(cell))
    resources, place = _resources(cell, unit, load)
    modes = _chosen_modes(cell)
    number = {name: count for count, name in enumerate(cell.tasks)}
    data: dict[str, Any] = {
        "jobs": [],
        "resources": resources,
        "tasks": [_task(cell, name, unit) for name in cell.tasks],
        "modes": [_mode(cell, number[name], name, mode, place, unit, load) for name, mode in modes],
        "constraints": {
            "end_before_start": [
                {"task1": number[first], "task2": number[name], "delay": 0}
                for name, task in cell.tasks.items()
                for first in task.after
            ],
            "start_before_start": [],
            "start_before_end": [],
            "mode_dependencies": list(_same_operators(cell, modes)),
        },
        "objective": {"weight_makespan": 1},
    }
    for name, task in cell.tasks.items():
        for wait in task.wait:
            for kind, bound in _bounds(wait, number[name], number[wait.after], unit):
                data["constraints"][kind].append(bound)
    return Written(
        json.dumps(data, ensure_ascii=False, indent=1) + "\n", tuple(not_said(cell, unit))
    )


def _without_pairs(cell: Cell) -> Cell:
    """Pairs of `same_operator` are said with modes that depend on each other."""
    return cell.replace(same_operator=()) if cell.same_operator else cell


def _changeovers(cell: Cell) -> Iterator[Fault]:
    for name, tool in cell.tools.items():
        if any(tool.changeover.values()) and name in set(_tools_used(cell)):
            yield Fault(
                f"{FORM} has no changeover of a tool that is kept in hand. Take it out for this"
                " purpose, or write the cell as yaml or json.",
                ("tools", name, "changeover"),
            )


def _tools_used(cell: Cell) -> Iterator[str]:
    for task in cell.tasks.values():
        yield from (tool for _, tool in task.tools_named())


def _seconds(cell: Cell) -> Iterator[float]:
    yield from all_times(cell)
    for operator in cell.operators.values():
        for off in operator.times_off:
            yield from (off.start, off.end)
    for task in cell.tasks.values():
        yield task.release
        yield from (task.deadline,) if task.deadline is not None else ()
        for wait in task.wait:
            yield wait.at_least
            yield from (wait.at_most,) if wait.at_most is not None else ()


def _stresses(cell: Cell) -> Iterator[float]:
    for operator in cell.operators.values():
        yield operator.stress_limit or 0.0
    for name in cell.tasks:
        for mode in cell.modes(name):
            yield from mode.stress.values()


def _resources(
    cell: Cell, unit: Whole, load: Whole
) -> tuple[list[dict[str, Any]], dict[tuple[str, str], int]]:
    """The resources, and (kind, name) -> the place of each in the list."""
    found: list[tuple[tuple[str, str], dict[str, Any]]] = []
    for name, operator in cell.operators.items():
        breaks = [[unit(off.start), unit(off.end)] for off in operator.times_off]
        found.append((("operator", name), {"type": "machine", "breaks": breaks, "name": name}))
    for name in cell.tool_names:
        if name in set(_tools_used(cell)):
            room = cell.tools[name].capacity if name in cell.tools else 1
            found.append((("tool", name), _renewable(name, room)))
    for zone in dict.fromkeys(task.zone for task in cell.tasks.values()):
        if zone is not None:
            room = cell.zones[zone].capacity if zone in cell.zones else 1
            found.append((("zone", zone), _renewable(zone, room)))
    for name, operator in cell.operators.items():
        if operator.stress_limit is not None:
            store = {"type": "consumable", "capacity": load(operator.stress_limit)}
            found.append((("limit", name), store | {"name": f"stress of {name}"}))
    place = {key: count for count, (key, _) in enumerate(found)}
    return [resource for _, resource in found], place


def _renewable(name: str, capacity: int) -> dict[str, Any]:
    return {"type": "renewable", "capacity": capacity, "name": name}


def _task(cell: Cell, name: str, unit: Whole) -> dict[str, Any]:
    task = cell.tasks[name]
    entry: dict[str, Any] = {"name": name}
    if task.release:
        entry["earliest_start"] = unit(task.release)
    if task.deadline is not None:
        entry["latest_end"] = unit(task.deadline)
    return entry


def _mode(
    cell: Cell,
    number: int,
    name: str,
    mode: Mode,
    place: dict[tuple[str, str], int],
    unit: Whole,
    load: Whole,
) -> dict[str, Any]:
    needs: Counter[tuple[str, str]] = Counter()
    for tool in mode.tools.values():
        needs["tool", tool] += 1
    for zone in cell.takes("zone", name, mode.operators).values():
        needs["zone", zone] += 1
    for human, stress in mode.stress.items():
        if ("limit", human) in place and stress:
            needs["limit", human] += load(stress)
    machines = [place["operator", who] for who in mode.operators]
    return {
        "task": number,
        "resources": [*machines, *(place[key] for key in needs)],
        "duration": unit(mode.time),
        "demands": [*(0 for _ in machines), *needs.values()],
    }


def _bounds(wait: Wait, this: int, first: int, unit: Whole) -> Iterator[tuple[str, dict[str, int]]]:
    """From the end (or the start) of the first task to the start of this one pass `at_least`
    seconds, and no more than `at_most`.
    """
    ends = wait.between == "end-start"
    kind = "end_before_start" if ends else "start_before_start"
    yield kind, {"task1": first, "task2": this, "delay": unit(wait.at_least)}
    if wait.at_most is not None:
        back = "start_before_end" if ends else "start_before_start"
        yield back, {"task1": this, "task2": first, "delay": -unit(wait.at_most)}


def _chosen_modes(cell: Cell) -> list[tuple[str, Mode]]:
    """Task and way of each mode that may be chosen: a way in which the other task of a
    `same_operator` pair cannot be done is left out, again and again.
    """
    modes = {name: list(cell.modes(name)) for name in cell.tasks}
    while True:
        before = sum(map(len, modes.values()))
        for pair in cell.same_operator:
            for one, two in (pair, pair[::-1]):
                groups = {mode.operators for mode in modes[two]}
                modes[one] = [mode for mode in modes[one] if mode.operators in groups]
        if sum(map(len, modes.values())) == before:
            return [(name, mode) for name, ways in modes.items() for mode in ways]


def _same_operators(cell: Cell, modes: list[tuple[str, Mode]]) -> Iterator[dict[str, Any]]:
    """For each mode of one task of a pair, the modes of the other by the same operators."""
    for one, two in cell.same_operator:
        for number, (name, mode) in enumerate(modes):
            if name == one:
                partners = [
                    count
                    for count, (other, its) in enumerate(modes)
                    if other == two and its.operators == mode.operators
                ]
                yield {"mode1": number, "modes2": partners}
