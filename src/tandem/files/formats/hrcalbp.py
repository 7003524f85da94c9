"""Lines on which a person, a robot or both together do a task (Weckenborg et al., Business Research
13, 2020, 93-132; instances of Sikora and Weckenborg, IJPR 2022): a table with commas.

Two lines of the line itself (names and values: stations, robots, tasks), then a heading, then a
task a line: its number, the time of a person, of a robot, of both together (-1: not possible), its
predecessors. Each station has one person; robots are placed at stations, one at most at each.

A cell has no stations: all persons and all robots may do every task, alone or in pairs. Whatever
the line can do in a cycle time, this cell can do too, so its least cycle time is a lower bound of
the line's.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping
from typing import Any

from tandem.errors import Fault
from tandem.files.formats.lines import Row, Translated, broken, few_enough, seconds, title, whole
from tandem.files.positions import Path

HEADING = re.compile(
    r"^\s*task id\s*,\s*human time\s*,\s*robot time\s*,\s*collaboration time\b", re.I | re.M
)
STATIONS, ROBOTS, TASKS = "number of stations", "number of robots", "number of tasks"


def looks_like(text: str) -> bool:
    """Whether it has the heading of the table of tasks."""
    return HEADING.search(text[:100_000]) is not None


def read(text: str, source: str) -> Translated:
    """The line's tasks, persons and robots as one cell, with a note of the stations that it lacks.

    Raises:
      CellError: the file is not of this form; with the line where it ceases to be.
    """
    table = [
        Row(number, [word.strip() for word in words])
        for number, words in enumerate(csv.reader(io.StringIO(text)), 1)
        if any(word.strip() for word in words)
    ]
    heading = next(
        (place for place, row in enumerate(table) if row.words[0].lower() == "task id"), None
    )
    if heading is None or heading < 2:
        raise broken(
            source,
            table[0].line if table else 1,
            "the names and the values of the line come first, then the heading `Task id,Human"
            " time,Robot time,Collaboration time,Predecessors`, then a task a line.",
        )
    stated = dict(zip((name.lower() for name in table[0].words), table[1].words, strict=False))
    where = table[1].line
    persons, robots, count = (
        _count(stated, name, source, where) for name in (STATIONS, ROBOTS, TASKS)
    )
    lines = table[heading + 1 :]
    if len(lines) != count:
        raise broken(source, where, f"{count} tasks are stated here, but {len(lines)} follow.")
    few_enough(source, where, persons + robots, count)
    few_enough(source, where, 0, persons * robots * count)
    tasks: dict[str, Any] = {}
    places: dict[Path, int] = {}
    for row in lines:
        name = row.words[0]
        if name in tasks:
            raise broken(source, row.line, f"task {name!r} is stated twice.")
        tasks[name] = _task(row, source, persons, robots)
        places["tasks", name] = row.line
    people = {f"human_{number}": {"kind": "human"} for number in range(1, persons + 1)}
    machines = {f"robot_{number}": {"kind": "robot"} for number in range(1, robots + 1)}
    return Translated(
        source,
        {"name": title(source), "operators": people | machines, "tasks": tasks},
        places,
        notes=[_no_stations(persons, source, where)],
    )


def _count(stated: Mapping[str, str], name: str, source: str, line: int) -> int:
    if name not in stated:
        raise broken(source, max(1, line - 1), f"the column {name!r} of the line is missing.")
    return whole(source, line, stated[name], f"the {name}")


def _no_stations(stations: int, source: str, line: int) -> Fault:
    return Fault(
        f"the {stations} stations are not read: a cell has none, so that everyone works at the same"
        " product. The least cycle time of this cell is a lower bound of the line's.",
        (),
        f"{source}:{line}",
    )


def _task(row: Row, source: str, persons: int, robots: int) -> dict[str, Any]:
    if len(row.words) < 4:
        raise broken(
            source,
            row.line,
            "a task is its number, the times of a human, of a robot and of both, and its"
            f" predecessors, but this line has {len(row.words)} values.",
        )
    name, *times = row.words[:4]
    human, robot, both = (
        seconds(source, row.line, word, f"the {what} of task {name}")
        for word, what in zip(times, ("human time", "robot time", "joint time"), strict=True)
    )
    people = [f"human_{number}" for number in range(1, persons + 1)] if human != -1 else []
    machines = [f"robot_{number}" for number in range(1, robots + 1)] if robot != -1 else []
    return {
        "time": dict.fromkeys(people, human) | dict.fromkeys(machines, robot),
        "together": [
            {"operators": [f"human_{person}", f"robot_{machine}"], "time": both}
            for person in range(1, persons + 1)
            for machine in range(1, robots + 1)
            if both != -1
        ],
        "after": [word for words in row.words[4:] for word in words.replace(",", " ").split()],
    }
