"""From what stands in a sheet cell to a number: decimal commas, units behind the number, Excel's dates, "cannot"."""

from __future__ import annotations

import datetime
import re
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from typing import Literal

from tandem.cell.spreadsheet.grid import Value, shown, tidy

Mark = Literal[",", "."]

UNITS: dict[str, tuple[str, ...]] = {
    "s": ("s", "sec", "secs", "second", "seconds", "sek", "sekunde", "sekunden"),
    "min": ("min", "mins", "minute", "minutes", "minuten"),
    "1/100 min": ("1/100 min", "1/100min", "min/100", "cmin", "hm", "hmin", "hundertstel minuten", "hundertstelminuten", "0,01 min", "0.01 min"),
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

CANNOT = {"", "-", "–", "—", "−", "/", "n/a", "na", "n.a.", "k.a.", "k. a.", "no", "nein", "none", "never", "cannot", "not possible", "nicht möglich"}
CANNOT |= {"entfällt", "keine", "nie", "n.m.", "0"}

FINEST_TIME = Decimal("0.001")
FINEST_AMOUNT = Decimal("0.000001")


class UnreadableError(ValueError):
    """Why a value cannot be taken for a number; the end of a sentence that begins with the place."""


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
    return isinstance(value, str) and (tidy(value).casefold() in CANNOT or bool(re.fullmatch(r"0+([.,]0*)?(\s*[^\W\d]+\.?)?", tidy(value))))


def decimal_mark(values: Iterable[Value]) -> Mark | None:
    """The decimal mark that text numbers of a sheet show beyond doubt: `10,5` is one, `1,234` may be a thousand; None without evidence."""
    marks = set()
    for value in values:
        if not isinstance(value, str):
            continue
        for number in re.findall(r"(?<![\d.,])\d+(?:[.,]\d+)+(?![\d.,])", tidy(value)):
            kinds = set(number) & set(",.")
            last = number[max(number.rfind(","), number.rfind("."))]
            digits = len(number) - 1 - number.rfind(last)
            if len(kinds) == 2 or (number.count(last) == 1 and (digits != 3 or number.startswith("0") or number.index(last) > 3)):
                marks.add(last)
            elif number.count(last) > 1:
                marks.add("," if last == "." else ".")
    return marks.pop() if len(marks) == 1 else None


def number(value: Value, mark: Mark | None = None) -> Number:
    """The number in a sheet cell, exactly as the sheet shows it (15 digits, as Excel does).

    Args:
      mark: the decimal mark of the sheet's text numbers when it is known.

    Raises:
      UnreadableError: with the way out, when it is a date, a clock time, a truth value or another text.
    """
    if isinstance(value, bool):
        raise UnreadableError(f"holds {shown(value)} where a number is expected")
    if isinstance(value, int | float):
        return Number(Decimal(f"{value:.15g}"))
    if isinstance(value, datetime.time | datetime.timedelta):
        way_out = "format the cell as a number and type the duration anew"
        raise UnreadableError(f"holds the clock time {value} where a plain number is expected: {way_out}")
    if isinstance(value, datetime.date):
        raise UnreadableError(
            f"holds the date {value} where a number is expected (Excel makes dates of entries such as 1.2 or 3-4): "
            "format the cell as a number and type it anew"
        )
    return _text_number(tidy(value), mark)


def _text_number(text: str, mark: Mark | None) -> Number:
    found = re.fullmatch(r"([-+−]?)\s*([\d][\d.,'’ ]*|[.,]\d+)\s*([^\d\s].*)?", text)
    unit = unit_named(found[3]) if found and found[3] else None
    if not found or (found[3] and not unit):
        hint = "type the duration in one unit" if re.fullmatch(r"\d+:\d+(:\d+)?", text) else "write one number"
        raise UnreadableError(f"holds {text!r} where a number is expected: {hint}, or leave the cell empty if there is none")
    digits = re.sub(r"['’ ]", "", found[2])
    plain = _with_point(digits, mark, text)
    sign = "-" if found[1] in ("-", "−") else ""
    return Number(Decimal(sign + plain), unit)


def _with_point(digits: str, mark: Mark | None, text: str) -> str:
    marks = [c for c in digits if c in ",."]
    if not marks:
        return digits
    if len(set(marks)) == 2:
        mark = "," if marks[-1] == "," else "."
        whole, _, part = digits.rpartition(mark)
        whole = re.sub(r"[.,]", "", whole)
    elif len(marks) > 1:
        whole, part = re.sub(r"[.,]", "", digits), ""
    else:
        whole, sign, part = digits.partition(marks[0])
        if len(part) == 3 and 0 < len(whole) <= 3 and whole != "0":
            if mark is None:
                raise UnreadableError(f"holds {text!r}, which may be {whole}{part} or {whole}.{part}: format the cell as a number and type it anew")
            if sign != mark:
                whole, part = whole + part, ""
    return f"{whole or 0}.{part or 0}"


def seconds(amount: Number, unit: str) -> tuple[Decimal, bool]:
    """The duration in seconds to the millisecond, and whether rounding changed more than the noise of a computed value."""
    return rounded(amount.value * SECONDS[amount.unit or unit], FINEST_TIME)


def rounded(value: Decimal, finest: Decimal) -> tuple[Decimal, bool]:
    """The value to the finest step, and whether that changed more than the noise of a computed value."""
    near = value.quantize(finest)
    return near, abs(near - value) > Decimal("1e-9")
