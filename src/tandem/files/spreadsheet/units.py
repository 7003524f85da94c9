"""The unit of all times of a sheet, as a line above the header or a footnote states it: "alle
Zeiten in HM", "Unit: min".
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from tandem.files.spreadsheet.grid import Grid, tidy
from tandem.files.spreadsheet.values import UNITS, unit_named
from tandem.files.spreadsheet.vocabulary import PER_PIECE

_SPELLINGS = "|".join(
    re.escape(text)
    for text in sorted(
        (s for spellings in UNITS.values() for s in spellings), key=len, reverse=True
    )
)
IN_A_UNIT = re.compile(
    rf"(?:\bin\s+|[\[(]\s*(?:in\s+)?)({_SPELLINGS})\.?(?=[\s.;:,)\]]|$|{PER_PIECE.pattern})",
    re.IGNORECASE,
)
AFTER_A_WORD = re.compile(
    rf"(?:[:=,]\s*|\s(?:sind|are|is|ist)\s+)({_SPELLINGS})\.?\s*(?:{PER_PIECE.pattern}\s*)?$",
    re.IGNORECASE,
)
OF_TIMES = re.compile(
    r"\b(\w*zeit(en)?|zeit\w*|times?|dauern?|durations?|angaben|werte|values|\w*einheit(en)?|units?)\b",
    re.IGNORECASE,
)
OF_SOMETHING_ELSE = re.compile(
    r"\b(takt|zyklus|cycle|durchlauf|lead|schicht|shift|pause|break|gesamt|total|sum|rüst|setup|warte|wait|stand|start)\w*",
    re.IGNORECASE,
)


_PIECES = r"(?:stück|stueck|stk|stck|teile?|pieces|pcs|parts|units|produkte|products)"
_SPEED = r"(?:geschwindigkeit|speed|override|tempo)"
OF_OTHER_WORK = re.compile(
    rf"\b(?:je|pro|per|für|fuer|for)\s+(?!1\b)\d+\s*{_PIECES}\b"
    r"|\b(?:je|pro|per)\s+(?:los|charge|auftrag|batch|lot|order)\b"
    r"|(?<!\d)(?<!\d )[x×*]\s*10+\b"
    rf"|(?<!\d)(?!100)\d+\s*%\s*(?:der\s+)?{_SPEED}\b|\b{_SPEED}\s*[:=]?\s*(?!100)\d+\s*%",
    re.IGNORECASE,
)
"""Words in a line about times that make them other than those of a task as it will be done."""

OF_OTHER_KINDS = {
    "d",
    "day",
    "days",
    "tag",
    "tage",
    "wk",
    "m",
    "mm",
    "cm",
    "km",
    "kg",
    "n",
    "eur",
    "us",
    "µs",
    "ns",
    "stk",
    "stck",
    "stück",
    "pcs",
    "rpm",
}


def unclear_unit(header: str) -> str:
    """What stands in a header where a unit would, and is none that is known: "0.1 min",
    "min/Stück", "d", a second unit; "" when nothing does.

    Args:
      header: without the unit that was understood.
    """
    in_brackets = (found[1].strip() for found in re.finditer(r"[\[({]([^\[\](){}]*)[\])}]", header))
    if odd := next((text for text in in_brackets if text and _looks_like_a_unit(text)), ""):
        return odd
    tail = re.search(r"\d+[.,/]\d+\s*$", header)
    return tail[0].strip() if tail else ""


def _looks_like_a_unit(text: str) -> bool:
    words = re.findall(r"[^\W\d_]+", text.casefold())
    units = [word for word in words if unit_named(word)]
    factors = re.search(r"[/%×*'\"]|\d|\b(per|je|pro|x|in)\b", text.casefold())
    return (
        not words
        or (bool(units) and (len(units) == len(words) or bool(factors)))
        or all(word in OF_OTHER_KINDS for word in words)
    )


def unit_said(grid: Grid, header_row: int, first_row: int, counted: bool) -> tuple[str | None, str]:
    """The unit of all times and the line that states it, or None and why nothing may be assumed:
    two lines contradict each other, or one names a unit of something; "" where no line does.

    Args:
      counted: a column says how many pieces a task has, so that a line must not leave open whether
        its times are those of one.
    """
    stated: dict[str, str] = {}
    named: dict[str, str] = {}
    for row, text in _lines(grid, header_row, first_row):
        place = grid.place(row, next(grid.filled(row))[0])
        of_times = bool(OF_TIMES.search(text)) and not OF_SOMETHING_ELSE.search(text)
        found = IN_A_UNIT.search(text) or (AFTER_A_WORD.search(text) if of_times else None)
        if found and (unit := unit_named(found[1])):
            if counted and PER_PIECE.match(text, found.end(1)):
                return None, f"{text!r} ({place})"
            if of_times:
                stated.setdefault(unit, f"{text!r} ({place})")
            elif row < header_row:
                named.setdefault(unit, f"{text!r} ({place})")
    if len(stated) == 1:
        return next(iter(stated.items()))
    if stated or set(named) - {"s"}:
        return None, " and ".join((stated or named).values())
    return None, ""


def other_work_said(grid: Grid, header_row: int, first_row: int) -> tuple[str, str]:
    """The line and its place, and what it says, where one makes the times those of a lot or of half
    the speed: "Zeiten je Los"; two empty texts where none does.
    """
    for row, text in _lines(grid, header_row, first_row):
        of_times = OF_TIMES.search(text) and not OF_SOMETHING_ELSE.search(text)
        if of_times and (found := OF_OTHER_WORK.search(text)):
            return f"{text!r} ({grid.place(row, next(grid.filled(row))[0])})", found[0]
    return "", ""


def _lines(grid: Grid, header_row: int, first_row: int) -> Iterator[tuple[int, str]]:
    """`(row, text)` of what stands above the header, and alone in its row below it; "Unit" and
    "min" in two cells are one text.
    """
    for row in range(len(grid.rows)):
        texts = [tidy(value) for _, value in grid.filled(row) if isinstance(value, str)]
        if row < header_row:
            yield from ((row, text) for text in texts)
            for word, unit in pairwise(texts):
                if unit_named(unit.strip("[]()")) and not unit_named(word):
                    yield row, f"{word.rstrip(':= ')}: {unit}"
        elif row >= first_row and len(texts) == 1 == len(list(grid.filled(row))):
            yield row, texts[0]
