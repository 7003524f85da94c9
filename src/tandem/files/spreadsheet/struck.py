"""Texts that are struck through, whole or in part, and raised marks behind a number: what a person
sees at once, and a reader of values does not.

The line may be a format of the cell or of a part of its text, or typed: `~~old~~`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from tandem.files.spreadsheet.grid import Value

STRUCK = "is struck through, so it may count no more: delete it, or take the line away"

LINE = "\u0335\u0336"
"""Signs that lay a line over the letter before them."""
TYPED = re.compile(
    rf"~~(?=\S)(?P<waves>[^~]*\S)~~|<(?P<tag>s|del|strike)>(?P<marked>.*?)</(?P=tag)>"
    rf"|(?P<lined>(?:[^{LINE}][{LINE}])+)",
    re.IGNORECASE,
)
"""How people strike out in plain text: as in Markdown, as in HTML, or letter by letter."""


@dataclass(frozen=True)
class Run:
    """A part of a text in one font."""

    text: str
    struck: bool = False
    raised: bool = False


def odd_runs(runs: Iterable[Run]) -> str | None:
    """Why a text of several runs may not be what it reads in one: "10" struck out before "12", a
    raised 1 behind 10; None when it is.
    """
    own = list(runs)
    whole = "".join(run.text for run in own)
    struck = "".join(run.text for run in own if run.struck)
    raised = "".join(run.text for run in own if run.raised and not run.struck)
    if struck.strip():
        return _struck_of(whole, struck, struck.strip() == whole.strip())
    if raised.strip() and re.fullmatch(r"\s*\d[\d.,]*\s*", whole.removesuffix(raised)):
        return f"holds {whole!r}, of which {raised!r} is a raised mark: leave only the number"
    return None


def struck_by_marks(rows: Sequence[Sequence[Value]]) -> dict[tuple[int, int], str]:
    """`(row, column)` of the texts that somebody struck out by typing -> what is odd about them. A
    text in double quotes stands for itself.
    """
    return {
        (row, column): why
        for row, values in enumerate(rows)
        for column, value in enumerate(values)
        if isinstance(value, str) and (why := odd_marks(value))
    }


def odd_marks(text: str) -> str | None:
    """The same for one text."""
    if not any(sign in text for sign in ("~~", "</", *LINE)) or text[:1] == '"' == text[-1:]:
        return None
    found = list(TYPED.finditer(text))
    struck = "".join(
        part["waves"] or part["marked"] or re.sub(f"[{LINE}]", "", part["lined"] or "")
        for part in found
    )
    return _struck_of(text, struck, not TYPED.sub("", text).strip()) if struck.strip() else None


def _struck_of(whole: str, struck: str, all_of_it: bool) -> str:
    if all_of_it:
        return STRUCK
    return f"holds {whole!r}, of which {struck!r} is struck through: leave only what counts"
