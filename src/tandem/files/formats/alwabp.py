"""Assembly lines with workers of different abilities (Chaves, Miralles, Lorena 2007): times differ,
`Inf` means cannot.

Number of tasks; a line a task with the time of every worker; then precedence pairs `i j`, counted
from 1, up to `-1 -1`.
"""

from __future__ import annotations

from itertools import islice
from typing import Any

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
from tandem.files.positions import Path


def looks_like(text: str) -> bool:
    """Whether a line with one number is followed by one with several times."""
    first = [row.words for row in islice(rows(text[:100_000]), 2)]
    return (
        len(first) == 2
        and len(first[0]) == 1
        and first[0][0].isdigit()
        and len(first[1]) > 1
        and all(_is_time(word) for word in first[1])
    )


def read(text: str, source: str) -> Translated:
    """The tasks and workers as a cell; workers are humans.

    Raises:
      CellError: the file is not of this form; with the line where it ceases to be.
    """
    lines = rows(text)
    if not lines:
        raise broken(source, 1, "the number of tasks comes first; this file is empty.")
    count = whole(source, lines[0].line, lines[0].words[0], "the number of tasks")
    times = lines[1 : count + 1]
    if len(times) < count or not times:
        raise broken(
            source, lines[0].line, f"{count} tasks are stated here, but {len(times)} lines follow."
        )
    workers = len(times[0].words)
    few_enough(source, lines[0].line, workers, count)
    tasks: dict[str, Any] = {}
    places: dict[Path, int] = {}
    for number, row in enumerate(times, 1):
        if len(row.words) != workers:
            raise broken(
                source,
                row.line,
                f"task {number} has {len(row.words)} times, but the first task has {workers}: one"
                " for each worker.",
            )
        tasks[str(number)] = {"time": _abilities(source, row, number), "after": []}
        places["tasks", str(number)] = row.line
    for row in lines[count + 1 :]:
        if row.words == ["-1", "-1"]:
            break
        if len(row.words) != 2:
            raise broken(
                source,
                row.line,
                f"a precedence is two numbers, but this line has {len(row.words)}.",
            )
        i, j = (whole(source, row.line, word, "a task of a precedence") for word in row.words)
        if unknown := [number for number in (i, j) if not 1 <= number <= count]:
            raise broken(
                source,
                row.line,
                f"there is no task {unknown[0]}: {count} are stated, counted from 1.",
            )
        after = tasks[str(j)]["after"]
        places["tasks", str(j), "after", len(after)] = row.line
        after.append(str(i))
    operators = {f"worker_{worker}": {"kind": "human"} for worker in range(1, workers + 1)}
    return Translated(
        source, {"name": title(source), "operators": operators, "tasks": tasks}, places
    )


def _abilities(source: str, row: Row, number: int) -> dict[str, float]:
    return {
        f"worker_{worker}": seconds(
            source, row.line, word, f"the time of worker {worker} for task {number}"
        )
        for worker, word in enumerate(row.words, 1)
        if word.lower() not in ("inf", "infinity")
    }


def _is_time(word: str) -> bool:
    return word.lower() in ("inf", "infinity") or word.replace(".", "", 1).isdigit()
