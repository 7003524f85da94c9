"""From what stands in a sheet cell to a number: decimal commas, units behind the number, Excel's
dates, "cannot".
"""

from __future__ import annotations

import datetime
import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from typing import Literal

from tandem.files.spreadsheet.grid import Value, shown, tidy

Mark = Literal[",", "."]

UNITS: dict[str, tuple[str, ...]] = {
    "s": ("s", "sec", "secs", "second", "seconds", "sek", "sekunde", "sekunden"),
    "min": ("min", "mins", "minute", "minutes", "minuten"),
    "1/100 min": (
        "1/100 min",
        "1/100min",
        "min/100",
        "cmin",
        "hm",
        "hmin",
        "hundertstel minuten",
        "hundertstelminuten",
        "0,01 min",
        "0.01 min",
    ),
    "h": ("h", "hr", "hrs", "hour", "hours", "std", "stunde", "stunden"),
    "ms": ("ms", "millisecond", "milliseconds", "millisekunden"),
    "TMU": ("tmu", "tmus"),
}
SECONDS: dict[str, Decimal] = {
    "s": Decimal(1),
    "min": Decimal(60),
    "1/100 min": Decimal("0.6"),
    "h": Decimal(3600),
    "ms": Decimal("0.001"),
    "TMU": Decimal("0.036"),
}
"""Seconds in one unit. A TMU is 1/100,000 of an hour (MTM)."""

CANNOT = {
    "",
    "-",
    "–",
    "—",
    "−",
    "/",
    "n/a",
    "na",
    "n.a.",
    "k.a.",
    "k. a.",
    "no",
    "nein",
    "none",
    "never",
    "cannot",
    "not possible",
    "nicht möglich",
}
CANNOT |= {"entfällt", "keine", "nie", "n.m.", "0"}

FINEST_TIME = Decimal("0.001")
FINEST_AMOUNT = Decimal("0.000001")


class UnreadableError(ValueError):
    """Why a value cannot be taken for a number; the end of a sentence that begins with the
    place.
    """


@dataclass(frozen=True)
class Number:
    """A number and the unit that stood behind it in the same sheet cell, if any."""

    value: Decimal
    unit: str | None = None


def unit_named(text: str) -> str | None:
    """The unit that a text names, whatever the spelling; None when it is none."""
    plain = tidy(text).casefold().rstrip(".")
    return next((unit for unit, spellings in UNITS.items() if plain in spellings), None)


def cannot(value: Value) -> bool:
    """Empty, 0 (also as text, "0,0 s"), or one of the words for "cannot do it"."""
    if isinstance(value, bool):
        return False
    if isinstance(value, int | float):
        return value == 0
    if not isinstance(value, str):
        return False
    zero = re.fullmatch(r"0+(?:[.,]0*)?\s*(.*)", tidy(value))
    return (
        tidy(value).casefold() in CANNOT
        or duration(value) == 0
        or (zero is not None and (not zero[1] or unit_named(zero[1]) is not None))
    )


ABLE = {
    "1",
    "x",
    "✓",
    "✔",
    "☑",
    "●",
    "•",
    "*",
    "true",
    "wahr",
    "yes",
    "y",
    "ja",
    "j",
    "can",
    "kann",
}
UNABLE = {".", "false", "falsch", "n", "☐", "✗", "✘"}
"""Besides the words of `CANNOT`."""


def says_able(value: Value) -> bool | None:
    """Whether a mark such as 1, TRUE or x says that somebody can do it; None when the value is no
    such mark.
    """
    if isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        return bool(value) if value in (0, 1) else None
    if not isinstance(value, str):
        return None
    word = tidy(value).casefold()
    return True if word in ABLE else False if word in UNABLE or cannot(value) else None


SIGN = r"(?P<sign>[-+−]?) ?"
GROUPED = r"[1-9]\d{0,2}(?:(?P<group>[.,'’ ])\d{3})(?:(?P=group)\d{3})*"
"""1'200, 1 200 000, 1.200.000: one to three digits, then groups of exactly three, with one kind of
mark.
"""
WRITTEN = re.compile(
    rf"{SIGN}(?:(?P<grouped>{GROUPED})|(?P<whole>\d*))(?:(?P<mark>[.,])(?P<part>\d*))?(?P<unit>\D.*|"
    r" .+)?"
)
MARKS: dict[str, Mark] = {",": ",", ".": "."}
MOST_DIGITS = 40
LARGEST = Decimal(10) ** 12


@dataclass(frozen=True)
class Written:
    """A number as typed: its digits before and behind a mark, and what may be a mark of thousands
    or of decimals.

    Attributes:
      doubtful: "12,500" may be 12500 or 12.5; its only mark is then in `mark`.
      grouped: thousands are grouped by a point or a comma.
      shows: the decimal mark that it shows beyond doubt; None when it has none, or is doubtful.
    """

    sign: str
    whole: str
    part: str
    unit: str | None
    mark: Mark | None = None
    doubtful: bool = False
    shows: Mark | None = None
    grouped: bool = False


def written(text: str) -> Written | None:
    """The one number that a text holds, with a unit of time behind it or not; None when it holds
    something else.
    """
    found = WRITTEN.fullmatch(_in_one_line(text)) if len(text) <= MOST_DIGITS else None
    if not found:
        return None
    group, mark, part = found["group"], MARKS.get(found["mark"]), found["part"] or ""
    unit = unit_named(found["unit"]) if found["unit"] else None
    if (
        (found["unit"] and not unit)
        or not ((found["grouped"] or found["whole"] or "") + part)
        or (mark is not None and mark == group)
    ):
        return None
    digits = re.sub(r"\D", "", found["grouped"] or found["whole"] or "")
    sign = "-" if found["sign"] in ("-", "−") else ""
    if group in MARKS and mark is None:
        if len(digits) <= 6:
            return Written(sign, digits[:-3], digits[-3:], unit, MARKS[group], doubtful=True)
        return Written(sign, digits, "", unit, shows="." if group == "," else ",", grouped=True)
    return Written(
        sign, digits, part, unit, mark, shows=mark if part else None, grouped=group in MARKS
    )


def _in_one_line(text: str) -> str:
    """Blanks of every width as single ones, invisible marks away; line breaks and soft hyphens
    stay, as they part what looks like one number.
    """
    if text.isascii():
        return text.strip()
    plain = unicodedata.normalize("NFC", text)
    kept = (
        " " if unicodedata.category(c) == "Zs" else c
        for c in plain
        if c == "\u00ad" or unicodedata.category(c) != "Cf"
    )
    return "".join(kept).strip()


@dataclass(frozen=True)
class Marks:
    """How text numbers are written.

    Attributes:
      decimal: the mark before the decimals, or None when it is not known.
      grouped: the other mark is known to group thousands.
    """

    decimal: Mark | None = None
    grouped: bool = False


def marks_of(values: Iterable[Value]) -> Marks:
    """The marks that text numbers show beyond doubt: `10,5` and `1.200.000` do, `1,234` may be a
    thousand or not.

    Args:
      values: of cells that hold times or amounts. Only those that are one number and nothing else
        are heard; when they disagree, nothing is known.
    """
    numbers = [
        found
        for value in values
        if isinstance(value, str) and (found := written(value)) and found.shows
    ]
    decimals = {found.shows for found in numbers}
    return (
        Marks(decimals.pop(), any(found.grouped for found in numbers))
        if len(decimals) == 1
        else Marks()
    )


NO_MARKS = Marks()


def number(value: Value, marks: Marks = NO_MARKS) -> Number:
    """The number in a sheet cell, exactly as the sheet shows it (15 digits, as Excel does).

    Args:
      marks: those of the sheet's text numbers, as far as they are known.

    Raises:
      UnreadableError: with the way out, when it is a date, a clock time, a truth value, several
        numbers or another text.
    """
    if isinstance(value, bool):
        raise UnreadableError(f"holds {shown(value)} where a number is expected")
    if isinstance(value, datetime.time | datetime.timedelta):
        way_out = (
            "format the cell as a number and type the duration anew (of a task, up to an hour, it"
            " may be shown as h:mm:ss)"
        )
        raise UnreadableError(
            f"holds the clock time {value} where a plain number is expected: {way_out}"
        )
    if isinstance(value, datetime.date):
        raise UnreadableError(
            f"holds the date {value} where a number is expected (Excel makes dates of entries such"
            " as 1.2 or 3-4): format the cell as a number and type it anew"
        )
    found = (
        Number(Decimal(f"{value:.15g}"))
        if isinstance(value, int | float)
        else _text_number(value, marks)
    )
    if not found.value.is_finite() or abs(found.value) > LARGEST:
        raise UnreadableError(
            f"holds {shown(value)}, which is larger than any number that can be meant here"
            f" ({LARGEST:,})"
        )
    return found


DURATION = re.compile(r"0{1,2}:([0-5]\d):([0-5]\d)(?:[.,](\d{1,3}))?")
"""Hours, minutes and seconds, all three: "0:12" may be either two of them, and who meant minutes
and seconds finds "12:30:00".
"""


def duration(value: Value) -> float | None:
    """The seconds of a text such as "0:01:30"; None when it is no such text."""
    found = DURATION.fullmatch(tidy(value)) if isinstance(value, str) else None
    if found is None:
        return None
    return float(f"{60 * int(found[1]) + int(found[2])}.{found[3] or 0}")


def is_number(value: Value) -> bool:
    """A number or a duration, or a text that is one and nothing else."""
    return not isinstance(value, bool) and (
        isinstance(value, int | float)
        or (isinstance(value, str) and written(value) is not None)
        or duration(value) is not None
    )


def _text_number(text: str, marks: Marks) -> Number:
    found = written(text)
    if found is None:
        hint = (
            "type the duration in one unit"
            if re.fullmatch(r"\d+:\d+(:\d+)?", tidy(text))
            else "write one number"
        )
        if written(tidy(text)) is not None:
            hint = "write one number in one line, without doubled blanks or soft hyphens"
        short = tidy(text) if len(text) <= MOST_DIGITS else tidy(text)[:MOST_DIGITS] + "…"
        raise UnreadableError(
            f"holds {short!r} where a number is expected: {hint}, or leave the cell empty if there"
            " is none"
        )
    whole, part = found.whole, found.part
    if found.doubtful and found.mark != marks.decimal and not marks.grouped:
        raise UnreadableError(
            f"holds {tidy(text)!r}, which may be {whole}{part} or {whole}.{part}: format the cell"
            " as a number and type it anew"
        )
    if found.doubtful and found.mark != marks.decimal:
        whole, part = whole + part, ""
    return Number(Decimal(f"{found.sign}{whole or 0}.{part or 0}"), found.unit)


def seconds(amount: Number, unit: str) -> tuple[Decimal, bool]:
    """The duration in seconds to the millisecond, and whether rounding changed more than the noise
    of a computed value.
    """
    return rounded(amount.value * SECONDS[amount.unit or unit], FINEST_TIME)


def rounded(value: Decimal, finest: Decimal) -> tuple[Decimal, bool]:
    """The value to the finest step, and whether that changed more than the noise of a computed
    value.
    """
    near = value.quantize(finest)
    return near, abs(near - value) > Decimal("1e-9")
