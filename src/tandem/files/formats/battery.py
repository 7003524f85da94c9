"""Sampled battery cells of FlexHRCA (hrc_battery_sampled): lines as in a flexible job shop, whose
machines are people, robots and teams of one of each.

First line: jobs, columns, mean number of columns of an operation. Then a line a job as in FJSPLIB.
Columns 1..H are humans, H+1..H+R robots, then the teams: human 1 with robot 1 to R, human 2 with
robot 1 to R, ... The file does not say how many of its columns are which; its name does, as in
`H2R1_7.txt`. Of a job with several operations, all further ones follow the first, not each other;
the one operation of the last job of a pack (every fifth) follows all others of its pack.
"""

from __future__ import annotations

import re
from pathlib import PurePath
from typing import Any

from tandem.files.formats.fjs import jobs_of
from tandem.files.formats.lines import Translated, broken, rows, title
from tandem.files.positions import Path

NAME = re.compile(r"H([1-9])R([1-9])(?![0-9]).*")
PACK = 5
"""Jobs of a battery pack; the last of them joins what the others mounted."""


def named_so(source: str) -> bool:
    """Whether a file's name says how many humans and robots it is for."""
    return NAME.fullmatch(PurePath(source).name) is not None


def looks_like(text: str) -> bool:
    """Never by its content: it is written as a flexible job shop. Its name or `--format` says
    so.
    """
    return False


def read(text: str, source: str) -> Translated:
    """The cell: task `2.3` is the third operation of the second job.

    Raises:
      CellError: the file is not of this form, or its name and its columns disagree; with the line.
    """
    named = NAME.fullmatch(PurePath(source).name)
    lines = rows(text)
    if named is None:
        raise broken(
            source,
            lines[0].line if lines else 1,
            "how many columns are humans and how many robots is told by the file's name, such as"
            " H2R1_7.txt. Name it so.",
        )
    humans, robots = int(named[1]), int(named[2])
    columns, shop = jobs_of(lines, source)
    if columns != humans + robots + humans * robots:
        raise broken(
            source,
            lines[0].line,
            f"{columns} columns are stated, but {humans} humans, {robots} robots and their"
            f" {humans * robots} teams are {humans + robots + humans * robots}.",
        )
    who: list[tuple[str, ...]] = [(f"H{number}",) for number in range(1, humans + 1)]
    who += [(f"R{number}",) for number in range(1, robots + 1)]
    who += [(f"H{h}", f"R{r}") for h in range(1, humans + 1) for r in range(1, robots + 1)]
    tasks: dict[str, Any] = {}
    places: dict[Path, int] = {}
    for number, (row, job) in enumerate(shop, 1):
        pack = (number - 1) // PACK + 1
        for step, ways in enumerate(job, 1):
            if outside := [column for column, _ in ways if not 1 <= column <= columns]:
                raise broken(
                    source,
                    row.line,
                    f"there is no column {outside[0]}: {columns} are stated, counted from 1.",
                )
            key = f"{number}.{step}"
            tasks[key] = _task([(who[column - 1], time) for column, time in ways])
            tasks[key] |= {"part": f"pack {pack}", "after": [f"{number}.1"] if step > 1 else []}
            places["tasks", key] = row.line
        if number % PACK == 0:
            others = range(number - PACK + 1, number)
            tasks[f"{number}.1"]["after"] = [
                f"{other}.{step}"
                for other in others
                for step in range(1, len(shop[other - 1][1]) + 1)
            ]
    operators = {
        name: {"kind": "human" if name.startswith("H") else "robot"}
        for name in (alone[0] for alone in who[: humans + robots])
    }
    return Translated(
        source, {"name": title(source), "operators": operators, "tasks": tasks}, places
    )


def _task(ways: list[tuple[tuple[str, ...], float]]) -> dict[str, Any]:
    return {
        "time": {who[0]: time for who, time in ways if len(who) == 1},
        "together": [{"operators": list(who), "time": time} for who, time in ways if len(who) > 1],
    }
