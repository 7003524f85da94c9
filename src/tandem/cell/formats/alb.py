"""Simple assembly line balancing: `.alb` (Otto et al., EJOR 228, 2013, 33-45) and Scholl's older `.IN2`. Workers are humans.

`.alb` has sections in angle brackets, with a decimal comma in the order strength; `.IN2` states the number of tasks, a time
a line, then arcs `i,j` up to `-1,-1`. Tasks are counted from 1. A cell has no stations: there are as many workers as the work
fills at the stated cycle time, and one where none is stated.
"""

from __future__ import annotations

import math
import re
from itertools import islice
from typing import Any

from tandem.cell.formats.lines import Row, Translated, broken, rows, seconds, title, whole
from tandem.cell.marked import Path

SECTION = re.compile(r"<\s*(.+?)\s*>")


def looks_like(text: str) -> bool:
    """Whether it begins with the section `<number of tasks>`, or is one number a line and then arcs with a comma."""
    if text.lstrip()[:200].lower().startswith("<number of tasks>"):
        return True
    first = list(islice(rows(text), 2))
    if len(first) < 2 or any(len(row.words) != 1 or not row.words[0].isdigit() for row in first):
        return False
    arcs = next((row.words for row in rows(text)[1:] if not (len(row.words) == 1 and row.words[0].replace(".", "", 1).isdigit())), [""])
    return bool(re.fullmatch(r"-?\d+\s*,\s*-?\d+", "".join(arcs)))


def read(text: str, source: str) -> Translated:
    """The tasks as a cell of as many workers as the work fills.

    Raises:
      CellError: the file is not of this form; with the line where it ceases to be.
    """
    lines = rows(text)
    sections = _sections(lines) if lines and lines[0].words[0].startswith("<") else _unnamed_sections(lines, source)
    for needed in ("number of tasks", "task times"):
        if not sections.get(needed):
            raise broken(source, lines[-1].line if lines else 1, f"the section <{needed}> is missing or empty.")
    row = sections["number of tasks"][0]
    count = whole(source, row.line, row.words[0], "the number of tasks")
    times, places = _times(sections["task times"], source, count)
    if len(times) != count:
        missing = next(number for number in range(1, count + 1) if number not in times) if count else 0
        raise broken(source, row.line, f"{count} tasks are stated here, but {len(times)} times are given; the time of task {missing} is missing.")
    after: dict[int, list[str]] = {number: [] for number in times}
    for row in sections.get("precedence relations", []):
        arc = "".join(row.words).split(",")
        if arc in (["-1", "-1"], ["0", "0"]):
            break
        if len(arc) != 2:
            raise broken(source, row.line, f"{' '.join(row.words)!r} is no precedence; `i,j` says that task i goes before task j.")
        i, j = (whole(source, row.line, word, "a task of a precedence") for word in arc)
        if unknown := [number for number in (i, j) if number not in times]:
            raise broken(source, row.line, f"there is no task {unknown[0]}: {count} are stated, counted from 1.")
        places["tasks", str(j), "after", len(after[j])] = row.line
        after[j].append(str(i))
    workers = _workers(sections.get("cycle time", []), sum(times.values()), source)
    tasks: dict[str, Any] = {str(n): {"time": dict.fromkeys(workers, times[n]), "after": after[n]} for n in sorted(times)}
    return Translated(source, {"name": title(source), "operators": {who: {"kind": "human"} for who in workers}, "tasks": tasks}, places)


def _times(lines: list[Row], source: str, count: int) -> tuple[dict[int, float], dict[Path, int]]:
    times: dict[int, float] = {}
    places: dict[Path, int] = {}
    for row in lines:
        if len(row.words) != 2:
            raise broken(source, row.line, f"a task's number and its time are needed, but the line is {' '.join(row.words)!r}.")
        number = whole(source, row.line, row.words[0], "a task's number")
        if number in times or not 1 <= number <= count:
            problem = "is stated twice" if number in times else f"does not exist: {count} tasks are stated, counted from 1"
            raise broken(source, row.line, f"task {number} {problem}.")
        times[number] = seconds(source, row.line, row.words[1].replace(",", "."), f"the time of task {number}")
        places["tasks", str(number)] = row.line
    return times, places


def _workers(lines: list[Row], work: float, source: str) -> list[str]:
    if not lines:
        return ["worker_1"]
    cycle = seconds(source, lines[0].line, lines[0].words[0].replace(",", "."), "the cycle time")
    if cycle <= 0:
        raise broken(source, lines[0].line, f"the cycle time is {lines[0].words[0]}, but must be more than 0.")
    count = max(1, math.ceil(work / cycle))
    if count > 1000:
        raise broken(source, lines[0].line, f"the work of {work:g} fills {count} workers at this cycle time; that is no one cell.")
    return [f"worker_{number}" for number in range(1, count + 1)]


def _sections(lines: list[Row]) -> dict[str, list[Row]]:
    sections: dict[str, list[Row]] = {}
    here: list[Row] = []
    for row in lines:
        if found := SECTION.fullmatch(" ".join(row.words)):
            here = sections.setdefault(found[1].lower(), [])
        else:
            here.append(row)
    return sections


def _unnamed_sections(lines: list[Row], source: str) -> dict[str, list[Row]]:
    """The same for `.IN2`, where only the order tells what a line means; what follows the end mark is a remark."""
    if not lines:
        raise broken(source, 1, "the number of tasks comes first; this file is empty.")
    count = whole(source, lines[0].line, lines[0].words[0], "the number of tasks")
    times = lines[1 : count + 1]
    for row in times:
        if len(row.words) != 1 or "," in row.words[0]:
            raise broken(source, row.line, f"{count} tasks are stated and each has a line with its time, but this line is {' '.join(row.words)!r}.")
    numbered = [Row(row.line, [str(number), *row.words]) for number, row in enumerate(times, 1)]
    return {"number of tasks": lines[:1], "task times": numbered, "precedence relations": lines[count + 1 :]}
