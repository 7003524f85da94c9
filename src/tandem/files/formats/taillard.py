"""Job shops as Taillard published them (EJOR 64, 1993, 278-285): a table of times, then a table of
machines.

A line of titles and a line of numbers (jobs, machines, seeds and bounds, of which only the first
two count); `Times` and a line a job; `Machines` and a line a job, counted from 1. Without the
titles' line the numbers may come first.
"""

from __future__ import annotations

import re

from tandem.files.formats.jsp import chains
from tandem.files.formats.lines import Row, Translated, broken, rows, seconds, whole

TABLES = ("times", "machines")


def looks_like(text: str) -> bool:
    """Whether `Times` and `Machines` stand in lines of their own."""
    found = {line.strip().rstrip(":").lower() for line in text[:1_000_000].splitlines()}
    return set(TABLES) <= found


def read(text: str, source: str) -> Translated:
    """The job shop as a cell: task `2.3` is the third operation of the second job.

    Raises:
      CellError: the file is not of this form, or holds several job shops; with the line.
    """
    lines = rows(text)
    marks = [place for place, row in enumerate(lines) if _mark(row)]
    if [_mark(lines[place]) for place in marks] != list(TABLES):
        if len(marks) > 2:
            raise broken(
                source,
                lines[marks[2]].line,
                f"the file holds {len(marks) // 2} job shops or more; a cell is one. Save the one"
                " that you mean in a file of its own.",
            )
        raise broken(source, 1, "the tables `Times` and `Machines` are needed, in this order.")
    head = next((row for row in lines[: marks[0]] if _is_number(row.words[0])), None)
    if head is None or len(head.words) < 2:
        raise broken(
            source, 1, "a line with the numbers of jobs and of machines comes before `Times`."
        )
    jobs, machines = (
        whole(source, head.line, word, what)
        for word, what in zip(
            head.words, ("the number of jobs", "the number of machines"), strict=False
        )
    )
    times = _table(lines[marks[0] + 1 : marks[1]], source, head, jobs, machines)
    visits = _table(lines[marks[1] + 1 :], source, head, jobs, machines)
    shop = []
    for row, order in zip(times, visits, strict=True):
        job = [
            (
                whole(source, order.line, machine, f"the machine of operation {step}"),
                seconds(source, row.line, time, f"the time of operation {step}"),
            )
            for step, (machine, time) in enumerate(zip(order.words, row.words, strict=True), 1)
        ]
        shop.append((order.line, job))
    return chains(shop, machines, source, head.line)


def _mark(row: Row) -> str:
    word = row.words[0].rstrip(":").lower()
    return word if len(row.words) == 1 and word in TABLES else ""


def _table(lines: list[Row], source: str, head: Row, jobs: int, machines: int) -> list[Row]:
    if len(lines) != jobs:
        raise broken(
            source,
            head.line,
            f"{jobs} jobs are stated, but a table has {len(lines)} lines. There is one line for"
            " each job.",
        )
    for row in lines:
        if len(row.words) != machines:
            raise broken(
                source,
                row.line,
                f"{machines} machines are stated, but this line has {len(row.words)} numbers.",
            )
    return lines


def _is_number(word: str) -> bool:
    return re.fullmatch(r"[0-9]+", word) is not None
