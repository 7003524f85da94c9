"""Flexible job shops in the form of FJSPLIB (Brandimarte 1993 and everyone since): machines become
robots, jobs chains of tasks.

First line: jobs, machines and sometimes a mean number of machines per operation, which says nothing
new. Then a line a job: the number of operations, and for each of them how many machines can do it,
followed by machine and time of each. Machines are counted from 1 in some collections and from 0 in
others; whichever fits is meant.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

from tandem.cell.model import Cell
from tandem.files.formats.lines import (
    Row,
    Translated,
    broken,
    few_enough,
    rows,
    seconds,
    title,
    whole,
)
from tandem.files.formats.written import (
    Written,
    all_times,
    alone,
    first_machine,
    jobs,
    names_lost,
    not_said,
    refuse,
    whole_numbers,
)
from tandem.files.positions import Path


def looks_like(text: str) -> bool:
    """Whether the first lines are those of a flexible job shop: a header of two or three numbers,
    then a first operation that adds up.
    """
    first = [row.words for row in islice(rows(text[:100_000]), 2)]
    if (
        len(first) < 2
        or len(first[0]) not in (2, 3)
        or not all(_numeric(word) for words in first for word in words)
    ):
        return False
    header, job = first
    return (
        header[0].isdigit()
        and header[1].isdigit()
        and len(job) >= 4
        and len(job) >= 1 + 3 * int(float(job[0]))
    )


def read(text: str, source: str) -> Translated:
    """The job shop as a cell: task `2.3` is the third operation of the second job.

    Raises:
      CellError: the file is not of this form; with the line where it ceases to be.
    """
    lines = rows(text)
    machines, shop = jobs_of(lines, source)
    first = counted_from(
        source, lines[0].line, machines, [(row.line, ways) for row, job in shop for ways in job]
    )
    tasks: dict[str, Any] = {}
    places: dict[Path, int] = {}
    for number, (row, job) in enumerate(shop, 1):
        for step, ways in enumerate(job, 1):
            key = f"{number}.{step}"
            tasks[key] = {
                "time": {robot(machine): time for machine, time in ways},
                "part": str(number),
                "after": [f"{number}.{step - 1}"] if step > 1 else [],
            }
            places["tasks", key] = row.line
    return Translated(
        source,
        {"name": title(source), "operators": robots(first, machines), "tasks": tasks},
        places,
    )


def jobs_of(
    lines: list[Row], source: str
) -> tuple[int, list[tuple[Row, list[list[tuple[int, float]]]]]]:
    """The number of machines, and each job's line with the machines and times of its operations.

    Raises:
      CellError: the file is not of this form; with the line where it ceases to be.
    """
    if not lines:
        raise broken(
            source, 1, "the first line states the numbers of jobs and machines; this file is empty."
        )
    head = lines[0]
    if len(head.words) < 2:
        raise broken(
            source, head.line, "the first line states the numbers of jobs and of machines."
        )
    stated, machines = (
        whole(source, head.line, word, what)
        for word, what in zip(
            head.words, ("the number of jobs", "the number of machines"), strict=False
        )
    )
    few_enough(source, head.line, machines, 1)
    if len(lines) - 1 != stated:
        raise broken(
            source,
            head.line,
            f"the first line states {stated} jobs, but {len(lines) - 1} lines follow. There is one"
            " line for each job.",
        )
    shop = [(row, list(_operations(source, row))) for row in lines[1:]]
    return machines, shop


def _operations(source: str, row: Row) -> Iterator[list[tuple[int, float]]]:
    count = whole(source, row.line, row.words[0], "the number of operations")
    place = 1
    for step in range(1, count + 1):
        ways, place = operation(source, row, place, f"operation {step}")
        yield ways
    if place != len(row.words):
        raise broken(
            source,
            row.line,
            f"the line states {count} operations, but {len(row.words) - place} more numbers follow"
            " them.",
        )


def operation(source: str, row: Row, place: int, what: str) -> tuple[list[tuple[int, float]], int]:
    """Machine and time of each way of doing one operation, and the place in the line behind it.

    Raises:
      CellError: the line ends too early, or something in it is no number.
    """
    if place >= len(row.words):
        raise broken(source, row.line, f"the line ends before {what}.")
    count = whole(source, row.line, row.words[place], f"the number of machines of {what}")
    words = row.words[place + 1 : place + 1 + 2 * count]
    if len(words) < 2 * count or count == 0:
        problem = (
            "no machine can do it"
            if count == 0
            else f"{count} machines need {2 * count} numbers, but {len(words)} follow"
        )
        raise broken(source, row.line, f"{what}: {problem}.")
    ways: dict[int, float] = {}
    for machine, time in zip(words[::2], words[1::2], strict=True):
        number = whole(source, row.line, machine, f"a machine of {what}")
        if number in ways:
            raise broken(source, row.line, f"{what}: machine {number} is stated twice.")
        ways[number] = seconds(source, row.line, time, f"the time of {what} on machine {number}")
    return list(ways.items()), place + 1 + 2 * count


def counted_from(
    source: str, line: int, machines: int, operations: list[tuple[int, list[tuple[int, float]]]]
) -> int:
    """0 when a machine of that number occurs, else 1.

    Args:
      line: where the number of machines is stated.
      operations: line, and machine and time of each way.

    Raises:
      CellError: a machine has a number that is too large.
    """
    first = 0 if any(machine == 0 for _, ways in operations for machine, _ in ways) else 1
    for where, ways in operations:
        for machine, _ in ways:
            if machine >= machines + first:
                raise broken(
                    source,
                    where,
                    f"there is no machine {machine}: line {line} states {machines}, counted from"
                    f" {first} here.",
                )
    return first


def robot(machine: int) -> str:
    """The operator's name: a machine keeps its number."""
    return f"machine_{machine}"


def robots(first: int, machines: int) -> dict[str, Any]:
    """The machines as operators."""
    return {robot(machine): {"kind": "robot"} for machine in range(first, machines + first)}


def _numeric(word: str) -> bool:
    return word.replace(".", "", 1).isdigit()


def write(cell: Cell) -> Written:
    """The cell as a flexible job shop: a job for each row of tasks, in the cell's order.

    Raises:
      CellError: the cell says more than that, or its precedence is no rows; with every reason.
    """
    rows_of_tasks, faults = jobs(cell, "fjs")
    refuse(cell, "fjs", task=("time", "after"), further=faults)
    unit, first = whole_numbers(all_times(cell)), first_machine(cell)
    ways = alone(cell, unit)
    operations = sum(len(found) for found in ways.values())
    lines = [f"{len(rows_of_tasks)} {len(cell.operators)} {operations / len(ways):.6g}"]
    lines += [
        " ".join([str(len(job)), *(written_operation(ways[task], first) for task in job)])
        for job in rows_of_tasks
    ]
    notes = (*not_said(cell, unit), *names_lost(cell, first))
    return Written("\n".join(lines) + "\n", notes)


def written_operation(ways: list[tuple[int, int]], first: int) -> str:
    """How many machines can do it, then machine and time of each."""
    pairs = (f"{place + first} {time}" for place, time in ways)
    return " ".join([str(len(ways)), *pairs])
