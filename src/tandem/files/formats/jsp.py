"""Classic job shops in the form of the OR-Library and JSPLIB: machines become robots, jobs chains
of tasks.

First line: jobs and machines. Then a line a job: machine and time of each operation in its order,
machines counted from 0 or from 1. Every job visits every machine once in the published sets; a line
may be shorter or longer when the format is stated. In the OR-Library's collection a name, a rule of
plus signs and a remark stand before the first line; they may stay there.
"""

from __future__ import annotations

from typing import Any

from tandem.cell.model import Cell
from tandem.errors import Fault
from tandem.files.formats.fjs import counted_from, robot, robots
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
    """Whether a header of two whole numbers is followed by so many lines of pairs, each of which
    names every machine once.
    """
    lines = [row.words for row in _bare(rows(text))]
    if not lines or len(lines[0]) != 2 or not all(_is_whole(word) for word in lines[0]):
        return False
    stated, machines = map(int, lines[0])
    if (
        len(lines) - 1 != stated
        or machines < 1
        or any(len(words) != 2 * machines for words in lines[1:])
    ):
        return False
    visits = [sorted(int(word) for word in words[::2] if _is_whole(word)) for words in lines[1:]]
    return any(
        all(visit == list(range(first, machines + first)) for visit in visits) for first in (0, 1)
    )


def read(text: str, source: str) -> Translated:
    """The job shop as a cell: task `2.3` is the third operation of the second job.

    Raises:
      CellError: the file is not of this form; with the line where it ceases to be.
    """
    lines = _one_shop(rows(text), source)
    if not lines or len(lines[0].words) != 2:
        raise broken(
            source,
            lines[0].line if lines else 1,
            "the first line states the numbers of jobs and of machines, and nothing else.",
        )
    head = lines[0]
    stated, machines = (
        whole(source, head.line, word, what)
        for word, what in zip(
            head.words, ("the number of jobs", "the number of machines"), strict=True
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
    shop = []
    for row in lines[1:]:
        if len(row.words) % 2:
            raise broken(
                source,
                row.line,
                f"a job is pairs of machine and time, but this line has {len(row.words)} numbers.",
            )
        job = [
            (
                whole(source, row.line, word, f"the machine of operation {step}"),
                seconds(source, row.line, time, f"the time of operation {step}"),
            )
            for step, (word, time) in enumerate(
                zip(row.words[::2], row.words[1::2], strict=True), 1
            )
        ]
        shop.append((row.line, job))
    return chains(shop, machines, source, head.line)


def chains(
    shop: list[tuple[int, list[tuple[int, float]]]], machines: int, source: str, line: int
) -> Translated:
    """Jobs, each with its line and the machine and time of each operation, as a cell.

    Args:
      line: where the number of machines is stated.
    """
    few_enough(source, line, machines, 1)
    tasks: dict[str, Any] = {}
    places: dict[Path, int] = {}
    for number, (where, job) in enumerate(shop, 1):
        for step, (machine, time) in enumerate(job, 1):
            key = f"{number}.{step}"
            tasks[key] = {
                "time": {robot(machine): time},
                "part": str(number),
                "after": [f"{number}.{step - 1}"] if step > 1 else [],
            }
            places["tasks", key] = where
    visits = [(where, [operation]) for where, job in shop for operation in job]
    first = counted_from(source, line, machines, visits)
    return Translated(
        source,
        {"name": title(source), "operators": robots(first, machines), "tasks": tasks},
        places,
    )


def _bare(lines: list[Row]) -> list[Row]:
    """Without the name, the rules of plus signs and the remark of the OR-Library."""
    first = next((place for place, row in enumerate(lines) if _is_head(row)), 0)
    bare = lines[first:]
    return bare[:-1] if bare and _is_rule(bare[-1]) else bare


def _is_head(row: Row) -> bool:
    return len(row.words) == 2 and all(map(_is_whole, row.words))


def _is_rule(row: Row) -> bool:
    return len(row.words) == 1 and set(row.words[0]) == {"+"}


def _one_shop(lines: list[Row], source: str) -> list[Row]:
    names = [row for row in lines if row.words[0] == "instance" and len(row.words) == 2]
    if len(names) > 1:
        raise broken(
            source,
            names[1].line,
            f"the file holds {len(names)} job shops, from {names[0].words[1]} to"
            f" {names[-1].words[1]}; a cell is one. Save the one that you mean in a file of its"
            " own.",
        )
    return _bare(lines) if names else lines


def _is_whole(word: str) -> bool:
    return word.isascii() and word.isdigit() and len(word) < 10


def write(cell: Cell) -> Written:
    """The cell as a classic job shop: a job for each row of tasks, each task on its one machine.

    Raises:
      CellError: the cell says more than that, its precedence is no rows, or several operators can
        do a task; with every reason.
    """
    rows_of_tasks, faults = jobs(cell, "jsp")
    faults += [
        Fault(
            f"{len(task.time)} operators can do it, but jsp has one machine for each task. `fjs`"
            " holds several.",
            ("tasks", name, "time"),
        )
        for name, task in cell.tasks.items()
        if len(task.time) > 1
    ]
    refuse(cell, "jsp", task=("time", "after"), further=faults)
    unit, first = whole_numbers(all_times(cell)), first_machine(cell)
    ways = {name: found[0] for name, found in alone(cell, unit).items()}
    lines = [f"{len(rows_of_tasks)} {len(cell.operators)}"]
    lines += [
        " ".join(f"{ways[task][0] + first} {ways[task][1]}" for task in job)
        for job in rows_of_tasks
    ]
    notes = (*not_said(cell, unit), *names_lost(cell, first))
    return Written("\n".join(lines) + "\n", notes)
