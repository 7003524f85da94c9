"""The column of waits between tasks: "glue >= 40 <= 60; base (start) >= 5" as parts of a cell
document, and back.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any, NamedTuple

from tandem.cell.parts import Wait
from tandem.cell.written import number as as_text
from tandem.files.spreadsheet.findings import Findings
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.precedence import sentence
from tandem.files.spreadsheet.references import References, UnknownTaskError, unquoted
from tandem.files.spreadsheet.values import UnreadableError, number, seconds, unit_named

EXAMPLE = "'glue >= 40 <= 60' (seconds from its end), 'glue (start) >= 5' (from its start)"
LEAST, MOST = (">=", "≥", "=>"), ("<=", "≤", "=<")
BOUND = re.compile(r"\s*(>=|≥|=>|<=|≤|=<)\s*([\d.,]+(?:\s*[^\W\d_]+\.?)?)\s*")
PART = re.compile(r'(?:"[^"]*"|[^;])+')
FROM_START = re.compile(r"(.*\S)\s*\((?:start|begin|beginn|anfang)\)", re.IGNORECASE | re.DOTALL)

LAGGED = re.compile(
    r"([^;,\n]+?)\s*-?\s*(?:FS|EA)\s*\+\s*(\d+(?:[.,]\d+)?\s*([^\W\d]+)\.?)", re.IGNORECASE
)
"""A link of a project tool with a wait behind it: "2FS+5 min"."""


class Written(NamedTuple):
    """A wait as a cell of a sheet holds it: the task, whether its start counts, and the numbers."""

    task: str
    from_start: bool
    least: str | None
    most: str | None


def written_waits(text: str) -> list[Written]:
    """What stands in one cell, part by part. Raises UnreadableError for what is no wait."""
    return [_written(part) for part in map(str.strip, PART.findall(text)) if part]


def _written(part: str) -> Written:
    end = len(part)
    found: dict[bool, str] = {}
    bounds = list(BOUND.finditer(part))
    while bounds and bounds[-1].end() == end:
        bound = bounds.pop()
        is_least = bound[1] in LEAST
        if is_least in found:
            raise UnreadableError(f"holds {part!r}, which states {bound[1]} twice")
        found[is_least], end = bound[2].strip(), bound.start()
    name = part[:end].strip()
    start = FROM_START.fullmatch(name)
    if not name or not (found or start):
        raise UnreadableError(f"holds {part!r}, which says of no task how long to wait after it")
    task = start[1].strip() if start else name
    return Written(task, start is not None, found.get(True), found.get(False))


def without_lags(text: str) -> tuple[str, list[Written]]:
    """A list of predecessors without the waits that a project tool wrote into it, "1; 2FS+5 min",
    and those waits; what has no unit of time up to hours stays in the list.
    """
    found = list[Written]()

    def put_aside(lag: re.Match[str]) -> str:
        if unit_named(lag[3]) is None or not re.match(r"[0.,]*[1-9]", lag[2]):
            return lag[0]
        found.append(Written(lag[1].strip(), False, lag[2], None))
        return lag[1]

    return LAGGED.sub(put_aside, text), found


def read_waits(
    table: Table,
    row: int,
    column: Column,
    unit: str,
    references: References,
    findings: Findings,
) -> list[dict[str, Any]]:
    """The waits in one cell as a cell document holds them; what is wrong goes to `findings`."""
    text = findings.text(table.grid, row, column.index)
    place = table.grid.place(table.grid.origin(row, column.index), column.index)
    found = []
    try:
        for stated in written_waits(text):
            found.append(wait_of(stated, unit, references, findings))
    except UnknownTaskError as error:
        findings.fault(sentence(error), place)
    except UnreadableError as error:
        findings.fault(f"{error}: write {EXAMPLE}, several with semicolons.", place)
    return found


def wait_of(
    stated: Written, unit: str, references: References, findings: Findings
) -> dict[str, Any]:
    """The wait as a cell document holds it.

    Raises:
      UnknownTaskError: where it names no task; UnreadableError: for a number that is none.
    """
    wait: dict[str, Any] = {"after": _task(stated.task, references)}
    if stated.from_start:
        wait["between"] = "start-start"
    for key, amount in (("at_least", stated.least), ("at_most", stated.most)):
        if amount is not None:
            wait[key] = float(seconds(number(amount, findings.marks), unit)[0])
    return wait


def _task(text: str, references: References) -> str:
    """The one task that the text names."""
    if (name := references.task(unquoted(text))) is not None:
        return name
    names = references.read(text)
    if len(names) != 1:
        raise UnreadableError(f"holds {text!r}, which is not one task")
    return names[0]


def waits_text(waits: Iterable[Wait]) -> str | None:
    """The waits of a task as a cell of a sheet holds them; None for none."""
    return "; ".join(map(_text, waits)) or None


def _text(wait: Wait) -> str:
    odd = bool(re.search(r"[;<>=≥≤()]", wait.after))
    text = f'"{wait.after}"' if odd else wait.after
    if wait.between == "start-start":
        text += " (start)"
    if wait.at_least or (wait.at_most is None and wait.between == "end-start"):
        text += f" >= {as_text(wait.at_least)}"
    return text if wait.at_most is None else f"{text} <= {as_text(wait.at_most)}"
