"""Flexible job shops whose operations form any acyclic graph (Birgin et al., Optimization Letters
8, 2014, 1417-1431).

First line: operations, arcs, machines; the mini set has a line `0 0` before it. Then a line an arc,
`u v`: u goes before v, counted from 0; a third column names the job that both belong to. Then a
line an operation: how many machines can do it, followed by machine and time of each.
"""

from __future__ import annotations

from itertools import islice
from typing import Any

from tandem.cell.model import Cell
from tandem.files.formats.fjs import counted_from, operation, robot, robots, written_operation
from tandem.files.formats.lines import Translated, broken, few_enough, rows, title, whole
from tandem.files.formats.written import (
    Written,
    all_times,
    alone,
    first_machine,
    names_lost,
    not_said,
    refuse,
    whole_numbers,
)
from tandem.files.positions import Path


def looks_like(text: str) -> bool:
    """Whether a header of three whole numbers is followed by an arc, or by as many lines as it
    states.
    """
    first = [row.words for row in islice(rows(text[:100_000]), 3)]
    if first[:1] == [["0", "0"]]:
        first = first[1:]
    if not first or len(first[0]) != 3 or not all(word.isdigit() for word in first[0]):
        return False
    operations, arcs, _ = map(int, first[0])
    if arcs:
        return (
            len(first) > 1
            and len(first[1]) in (2, 3)
            and all(word.isdigit() for word in first[1][:2])
        )
    return len(rows(text)) - 1 == operations and all(
        len(words) == 1 + 2 * int(words[0]) for words in first[1:2] if words[0].isdigit()
    )


def read(text: str, source: str) -> Translated:
    """The graph as a cell: task `0` is the first operation.

    Raises:
      CellError: the file is not of this form; with the line where it ceases to be.
    """
    lines = rows(text)
    if lines and lines[0].words == ["0", "0"]:
        lines = lines[1:]
    if not lines or len(lines[0].words) != 3:
        raise broken(
            source,
            lines[0].line if lines else 1,
            "a line with the numbers of operations, arcs and machines comes first.",
        )
    head = lines[0]
    count, arcs, machines = (
        whole(source, head.line, word, what)
        for word, what in zip(head.words, ("operations", "arcs", "machines"), strict=True)
    )
    few_enough(source, head.line, machines, 1)
    if len(lines) - 1 != arcs + count:
        raise broken(
            source,
            head.line,
            f"{arcs} arcs and {count} operations need {arcs + count} lines, but {len(lines) - 1}"
            " follow.",
        )
    after: dict[int, list[str]] = {number: [] for number in range(count)}
    jobs: dict[int, set[str]] = {number: set() for number in range(count)}
    places: dict[Path, int] = {}
    labelled = len(lines) > 1 and len(lines[1].words) == 3
    for row in lines[1 : arcs + 1]:
        if len(row.words) != 2 + labelled:
            needed = "two numbers and the name of a job" if labelled else "two numbers"
            raise broken(
                source, row.line, f"an arc is {needed}, but this line has {len(row.words)} words."
            )
        u, v = (whole(source, row.line, word, "an arc's end") for word in row.words[:2])
        if max(u, v) >= count:
            raise broken(
                source,
                row.line,
                f"there is no operation {max(u, v)}: line {head.line} states {count}, counted"
                " from 0.",
            )
        places["tasks", str(v), "after", len(after[v])] = row.line
        after[v].append(str(u))
        for end in (u, v):
            jobs[end].update(row.words[2:])
    ways = []
    for number, row in enumerate(lines[arcs + 1 :]):
        found, end = operation(source, row, 0, f"operation {number}")
        if end != len(row.words):
            raise broken(
                source,
                row.line,
                f"operation {number} states {len(found)} machines, but {len(row.words) - end} more"
                " numbers follow them.",
            )
        places["tasks", str(number)] = row.line
        ways.append((row.line, found))
    first = counted_from(source, head.line, machines, ways)
    tasks: dict[str, Any] = {
        str(n): {
            "time": {robot(machine): time for machine, time in found},
            "part": _only(jobs[n]),
            "after": after[n],
        }
        for n, (_, found) in enumerate(ways)
    }
    return Translated(
        source,
        {"name": title(source), "operators": robots(first, machines), "tasks": tasks},
        places,
    )


def _only(jobs: set[str]) -> str | None:
    """The job of an operation; None when its arcs name none, or several."""
    return next(iter(jobs)) if len(jobs) == 1 else None


def write(cell: Cell) -> Written:
    """The cell as a graph of operations, counted from 0 in the cell's order.

    Raises:
      CellError: the cell says more than that; with every reason.
    """
    refuse(cell, "fjs-dag", task=("time", "after"))
    unit, first = whole_numbers(all_times(cell)), first_machine(cell)
    place = {name: number for number, name in enumerate(cell.tasks)}
    arcs = [
        f"{place[earlier]} {place[name]}"
        for name, task in cell.tasks.items()
        for earlier in task.predecessors
    ]
    lines = [f"{len(place)} {len(arcs)} {len(cell.operators)}", *arcs]
    lines += [written_operation(ways, first) for ways in alone(cell, unit).values()]
    notes = (*not_said(cell, unit), *names_lost(cell, first))
    return Written("\n".join(lines) + "\n", notes)
