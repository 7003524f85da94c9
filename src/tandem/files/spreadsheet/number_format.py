"""What a number format writes around a number: `0.00 "min"` shows 1.5 as "1.50 min", so that the
planner reads minutes.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from dataclasses import dataclass

BUILT_IN = {9: "0%", 10: "0.00%", 21: "h:mm:ss", 45: "mm:ss", 46: "[h]:mm:ss", 47: "mm:ss.0"}
"""Formats that a workbook names by number alone and that write something around the number, or show
a duration to the second (ECMA-376, part 1, 18.8.30).
"""

TOKEN = re.compile(
    r'"(?P<quoted>[^"]*)"?|\\(?P<escaped>.)|(?P<padding>[_*].)|\[\$(?P<currency>[^\]-]*)[^\]]*\]|\[(?P<bracket>[^\]]*)\]'
    r"|(?P<digits>General|[0#?](?:[0#?,.]*[0#?])?|[Ee][+-])|(?P<comma>,+)|(?P<other>.)",
    re.IGNORECASE | re.DOTALL,
)
CLOCK = re.compile(r"[ymdhs]|h+|m+|s+", re.IGNORECASE)
CONDITION = re.compile(r"(<=|>=|<>|<|>|=)\s*(-?[\d.]+)")
COMPARE: dict[str, Callable[[float, float], bool]] = {
    "<=": operator.le, ">=": operator.ge, "<>": operator.ne, "<": operator.lt, ">": operator.gt,
    "=": operator.eq,
}  # fmt: skip


@dataclass(frozen=True)
class Dress:
    """How a format shows one number.

    Attributes:
      words: what stands around it: "min", "%", "€", ""; padding, signs and brackets of accountants
        left out.
      hidden: the number itself is not shown.
      scaled: it is shown in thousands or millions.
    """

    words: str = ""
    hidden: bool = False
    scaled: bool = False


def dress(code: str, value: float) -> Dress:
    """What the format makes of the value; nothing for dates and clock times, which are no longer
    numbers to who reads the sheet.
    """
    words, digits, scaled = [], False, False
    section = list(TOKEN.finditer(_section(code, value)))
    if any(CLOCK.fullmatch(token["other"] or token["bracket"] or "") for token in section):
        return Dress()
    for token in section:
        if token["digits"]:
            digits = True
        elif token["comma"]:
            scaled |= digits
        elif token["bracket"] is None and token["padding"] is None:
            words.append(
                next(
                    text
                    for text in (
                        token["quoted"],
                        token["escaped"],
                        token["currency"],
                        token["other"],
                    )
                    if text is not None
                )
            )
    return Dress(
        " ".join("".join(words).split()).strip("()[]+-–−./ "), not digits and value != 0, scaled
    )


def shown_duration(code: str, value: float) -> str | None:
    """Days as the text that a format shows of them, "0:01:30", where it shows minutes and seconds
    and no date, nor the half of a day; None for every other format, and from an hour on.
    """
    section = [token for token in TOKEN.finditer(_section(code, value)) if not token["quoted"]]
    clock = "".join((token["other"] or token["bracket"] or "").casefold() for token in section)
    if not 0 <= value * 24 < 1 or not {"m", "s"} <= set(clock) or set(clock) & set("ydap"):
        return None
    whole, milliseconds = divmod(round(value * 86_400_000), 1000)
    text = f"0:{whole // 60:02}:{whole % 60:02}"
    return f"{text}.{milliseconds:03}" if milliseconds else text


def _section(code: str, value: float) -> str:
    """The part of the format that applies: by its conditions, or by the sign of the value."""
    parts = _sections(code)
    conditions = [
        next(
            (
                found
                for t in TOKEN.finditer(part)
                if t["bracket"] and (found := CONDITION.fullmatch(t["bracket"]))
            ),
            None,
        )
        for part in parts
    ]
    if any(conditions):
        for part, condition in zip(parts, conditions, strict=True):
            if condition is None or COMPARE[condition[1]](value, float(condition[2])):
                return part
        return parts[-1]
    if value < 0 and len(parts) > 1:
        return parts[1]
    return parts[2] if value == 0 and len(parts) > 2 else parts[0]


def _sections(code: str) -> list[str]:
    parts = [""]
    for token in TOKEN.finditer(code):
        if token["other"] == ";":
            parts.append("")
        else:
            parts[-1] += token[0]
    return parts
