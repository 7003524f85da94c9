"""Simple assembly line balancing: `.alb` (Otto et al., EJOR 228, 2013, 33-45) and Scholl's older
`.IN2`. Workers are humans.

A dialect may add sections, such as setup times or ergonomic figures. A cell has no place for them:
each is named, so that nothing is lost unsaid.

`.alb` has sections in angle brackets, with a decimal comma in the order strength; `.IN2` states the
number of tasks, a time a line, then arcs `i,j` up to `-1,-1`. Tasks are counted from 1. A cell has
no stations: there are as many workers as the work fills at the stated cycle time, and one where
none is stated.
"""

from __future__ import annotations

import math
import re
from difflib import get_close_matches
from itertools import islice
from typing import Any

from tandem.cell.names import Known
from tandem.errors import Fault
from tandem.files.formats.lines import (
    NUMBERLIKE,
    Row,
    Translated,
    broken,
    few_enough,
    rows,
    seconds,
    shown,
    title,
    whole,
)
from tandem.files.positions import Path

SECTION = re.compile(r"<\s*(.*?)\s*>?")
NEEDED = ("number of tasks", "task times", "precedence relations")
CYCLE = "cycle time"
HARMLESS = ("order strength", "end", "optimal salbp-1 value")
"""Sections that say nothing about the work itself."""
END_MARKS = (["-1", "-1"], ["0", "0"])
LOST = {"setup": "a cell has no setup times between tasks, so that plans come out too short"}
"""First word of a section -> what is lost with it, where more can be said than its name."""


def looks_like(text: str) -> bool:
    """Whether it begins with the section `<number of tasks>`, or is one number a line and then arcs
    with a comma.
    """
    if text.lstrip()[:200].lower().startswith("<number of tasks>"):
        return True
    first = list(islice(rows(text), 2))
    if len(first) < 2 or any(len(row.words) != 1 or not row.words[0].isdigit() for row in first):
        return False
    arcs = next(
        (
            row.words
            for row in rows(text)[1:]
            if not (len(row.words) == 1 and row.words[0].replace(".", "", 1).isdigit())
        ),
        [""],
    )
    return bool(re.fullmatch(r"-?\d+\s*,\s*-?\d+", "".join(arcs)))


def read(text: str, source: str) -> Translated:
    """The tasks as a cell of as many workers as the work fills.

    Raises:
      CellError: the file is not of this form; with the line where it ceases to be.
    """
    lines = rows(text)
    named = bool(lines) and lines[0].words[0].startswith("<")
    sections, notes = _sections(lines, source) if named else _unnamed_sections(lines, source)
    last = lines[-1].line if lines else 1
    for needed in ("number of tasks", "task times"):
        if not sections.get(needed):
            raise broken(source, last, f"the section <{needed}> is missing or empty.")
    row = sections["number of tasks"][0]
    count = whole(source, row.line, row.words[0], "the number of tasks")
    times, places = _times(sections["task times"], source, count)
    if len(times) != count:
        missing = (
            next(number for number in range(1, count + 1) if number not in times) if count else 0
        )
        raise broken(
            source,
            row.line,
            f"{count} tasks are stated here, but {len(times)} times are given; the time of task"
            f" {missing} is missing.",
        )
    if "precedence relations" not in sections:
        remedy = "Add it, with nothing in it when every task may come first."
        raise broken(source, last, f"the section <precedence relations> is missing. {remedy}")
    after: dict[int, list[str]] = {number: [] for number in times}
    for row in sections["precedence relations"]:
        arc = "".join(row.words).split(",")
        if arc in END_MARKS:
            break
        if len(arc) != 2:
            raise broken(
                source,
                row.line,
                f"{' '.join(row.words)!r} is no precedence; `i,j` says that task i goes before"
                " task j.",
            )
        i, j = (whole(source, row.line, word, "a task of a precedence") for word in arc)
        if unknown := [number for number in (i, j) if number not in times]:
            raise broken(
                source,
                row.line,
                f"there is no task {unknown[0]}: {count} are stated, counted from 1.",
            )
        places["tasks", str(j), "after", len(after[j])] = row.line
        after[j].append(str(i))
    workers = _workers(sections.get(CYCLE, []), sum(times.values()), source)
    few_enough(source, sections["number of tasks"][0].line, len(workers), count)
    tasks: dict[str, Any] = {
        str(n): {"time": dict.fromkeys(workers, times[n]), "after": after[n]} for n in sorted(times)
    }
    data = {
        "name": title(source),
        "operators": {who: {"kind": "human"} for who in workers},
        "tasks": tasks,
    }
    return Translated(source, data, places, notes=notes)


def _times(lines: list[Row], source: str, count: int) -> tuple[dict[int, float], dict[Path, int]]:
    times: dict[int, float] = {}
    places: dict[Path, int] = {}
    for row in lines:
        if len(row.words) != 2:
            raise broken(
                source,
                row.line,
                "a task's number and its time are needed, but the line is"
                f" {' '.join(row.words)!r}.",
            )
        number = whole(source, row.line, row.words[0], "a task's number")
        if number in times or not 1 <= number <= count:
            problem = (
                "is stated twice"
                if number in times
                else f"does not exist: {count} tasks are stated, counted from 1"
            )
            raise broken(source, row.line, f"task {number} {problem}.")
        times[number] = seconds(
            source, row.line, row.words[1].replace(",", "."), f"the time of task {number}"
        )
        places["tasks", str(number)] = row.line
    return times, places


def _workers(lines: list[Row], work: float, source: str) -> list[str]:
    if not lines:
        return ["worker_1"]
    cycle = seconds(source, lines[0].line, lines[0].words[0].replace(",", "."), "the cycle time")
    if cycle <= 0:
        raise broken(
            source,
            lines[0].line,
            f"the cycle time is {lines[0].words[0]}, but must be more than 0.",
        )
    count = max(1, math.ceil(work / cycle))
    if count > 1000:
        raise broken(
            source,
            lines[0].line,
            f"the work of {work:g} fills {count} workers at this cycle time; that is no one cell.",
        )
    return [f"worker_{number}" for number in range(1, count + 1)]


def _sections(lines: list[Row], source: str) -> tuple[dict[str, list[Row]], list[Fault]]:
    """The rows of each section, and a note for each that is not read.

    Raises:
      CellError: a heading that is nearly one that is missing: what stands under it would be lost by
        a slip of the pen.
    """
    sections: dict[str, list[Row]] = {}
    headings: dict[str, int] = {}
    here: list[Row] = []
    for row in lines:
        if row.words[0].startswith("<") and (found := SECTION.fullmatch(" ".join(row.words))):
            name = " ".join(found[1].lower().split())
            headings.setdefault(name, row.line)
            here = sections.setdefault(name, [])
        else:
            here.append(row)
    unknown = {
        name: line for name, line in headings.items() if name not in (*NEEDED, CYCLE, *HARMLESS)
    }
    missing = Known(name for name in NEEDED if name not in headings)
    for name, line in unknown.items():
        meant = missing.nearest(name) or (
            CYCLE
            if CYCLE not in headings and get_close_matches(name, [CYCLE], cutoff=0.8)
            else None
        )
        if meant is not None:
            raise broken(
                source, line, f"<{name}> is no section that is known. Did you mean <{meant}>?"
            )
    return sections, [
        *(_not_read(source, line, name) for name, line in unknown.items()),
        *_cut_off(source, lines, "end" in headings, "<end>"),
    ]


def _not_read(source: str, line: int, name: str) -> Fault:
    lost = next(
        (what for word, what in LOST.items() if name.startswith(word)),
        "what it says is not in the cell",
    )
    return Fault(f"the section <{name}> is not read: {lost}.", (), f"{source}:{line}")


def _cut_off(source: str, lines: list[Row], ended: bool, mark: str) -> list[Fault]:
    return (
        []
        if ended
        else [
            Fault(
                f"the end mark {mark} is missing. Is the file complete?",
                (),
                f"{source}:{lines[-1].line}",
            )
        ]
    )


def _unnamed_sections(lines: list[Row], source: str) -> tuple[dict[str, list[Row]], list[Fault]]:
    """The same for `.IN2`, where only the order tells what a line means; what follows the end mark
    is a remark.
    """
    if not lines:
        raise broken(source, 1, "the number of tasks comes first; this file is empty.")
    count = whole(source, lines[0].line, lines[0].words[0], "the number of tasks")
    times = lines[1 : count + 1]
    for row in times:
        if len(row.words) != 1 or "," in row.words[0]:
            words = " ".join(row.words)
            remedy = (
                f" If it is a time, write it with a point: {words.replace(',', '.')}."
                if NUMBERLIKE.fullmatch(words)
                else ""
            )
            raise broken(
                source,
                row.line,
                f"{count} tasks are stated and each has a line with its time, but this line is"
                f" {shown(words)}.{remedy}",
            )
    numbered = [Row(row.line, [str(number), *row.words]) for number, row in enumerate(times, 1)]
    arcs = lines[count + 1 :]
    ended = any("".join(row.words).split(",") in END_MARKS for row in arcs)
    sections = {"number of tasks": lines[:1], "task times": numbered, "precedence relations": arcs}
    return sections, _cut_off(source, lines, ended, "-1,-1")
