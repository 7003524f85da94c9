"""Waits between tasks in words."""

from __future__ import annotations

from typing import Literal

from tandem.cell.model import Cell
from tandem.cell.parts import Wait
from tandem.report.language import Words

Kind = Literal["none", "least", "most", "both", "exact"]


def kind_of(wait: Wait) -> Kind:
    """Which of its two ends a wait states; "exact" where they are one moment."""
    if wait.at_most is None:
        return "least" if wait.at_least else "none"
    if wait.at_least == wait.at_most:
        return "exact"
    return "both" if wait.at_least else "most"


def wait_words(cell: Cell, task: str, t: Words) -> list[str]:
    """The waits of a task after others: `40 to 60 s after glue has ended`."""
    return [_words(wait, t) for wait in cell.tasks[task].wait]


def _words(wait: Wait, t: Words) -> str:
    span = t(
        f"tasks.span.{kind_of(wait)}",
        least=t.number(wait.at_least),
        most="" if wait.at_most is None else t.number(wait.at_most),
    )
    key = "tasks.wait.end" if wait.between == "end-start" else "tasks.wait.start"
    return t(key, task=wait.after, span=span)
