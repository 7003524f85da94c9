"""An operator's instruction sheet in the page: folded away on the screen, a page of its own on
paper.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import ceil
from typing import Any

from tandem.draw.style import looks
from tandem.plan.result import Result
from tandem.report.instructions import Condition, Row, columns, instructed, origin, rules, steps
from tandem.report.language import Words
from tandem.report.markup import Markup, join, tag
from tandem.report.tables import table

PAGE, LINE, GAP = 142.0, 4.5, 1.8
"""Height of a printed page for rows, of a line and between rows, millimetres."""
ACROSS = {"does": 16, "what": 16, "product": 14, "means": 20, "begin": 36, "then": 22}
"""Characters across a column on paper."""
NUMBERS = ("number", "start", "end", "deadline", "at", "until")


def sheets(result: Result, title: str, t: Words) -> Markup:
    """One sheet for each operator but machines. Each printed page says whose it is and to
    which plan (`title`) it belongs; without a script all stand open.
    """
    return join(sheet(result, operator, title, t) for operator in instructed(result.cell))


def sheet(result: Result, operator: str, title: str, t: Words) -> Markup:
    """The sheet of one operator."""
    found = steps(result.cell, result.schedule, operator, t)
    return sheet_of(
        found,
        columns(found),
        t("steps.title", who=looks(result.cell)[operator].label),
        rules(result.cell, operator, t),
        origin(result, operator, title, t),
        t("steps.none"),
        t,
    )


def sheet_of(
    found: Sequence[Row],
    shown: Sequence[str],
    heading: str,
    above: Sequence[str],
    on_paper: str,
    none: str,
    t: Words,
) -> Markup:
    """A sheet of these steps.

    Args:
      shown: its columns.
      above: sentences above the steps.
      on_paper: what stands on every printed page.
      none: what is said when there are no steps.
    """
    inside = _table(found, shown, heading, on_paper, t) if found else tag("p", none)
    return tag(
        "details",
        tag("summary", tag("h3", heading)),
        *(tag("p", sentence) for sentence in (above if found else ())),
        inside,
        class_=f"sheet {_size(found)}",
        open=True,
    )


def _size(found: Sequence[Row]) -> str:
    """Large letters, where the page has room for them; small ones, where the sheet would need a
    second page; nothing on paper for who has nothing to do.
    """
    if not found:
        return "idle"
    height = _height(found)
    return "small" if height > PAGE else "large" if height * 1.8 < PAGE else "middle"


def _height(found: Sequence[Row]) -> float:
    """What the rows take on paper in letters of middle size, millimetres."""
    return sum(max(_lines_of(step, key) for key in ACROSS) * LINE + GAP for step in found)


def _lines_of(step: Row, key: str) -> int:
    """Lines of one column."""
    value: Any = getattr(step, key, "")
    if key == "begin":
        value = tuple(condition.says for condition in step.begin)
    sentences = value if isinstance(value, tuple) else (value,)
    return sum(ceil(len(sentence) / ACROSS[key]) for sentence in sentences)


def _table(
    found: Sequence[Row], shown: Sequence[str], heading: str, on_paper: str, t: Words
) -> Markup:
    heads = [(t(f"steps.{key}"), f"number {key}" if key in NUMBERS else key) for key in shown]
    return table(heads, (_row(step, shown, t) for step in found), heading, on_paper=on_paper)


def _row(step: Row, shown: Sequence[str], t: Words) -> Markup:
    return tag(
        "tr",
        *(_cell(step, key, t) for key in shown),
        class_=None if step.task else "change",
    )


def _cell(step: Row, key: str, t: Words) -> Markup:
    value = getattr(step, key)
    if key == "begin":
        return tag("td", _lines(map(_condition, step.begin)), class_="told")
    if key in ("means", "then"):
        return tag("td", _lines(value), class_="told")
    if key in NUMBERS:
        says = value if isinstance(value, str) else "–" if value is None else t.number(value)
        return tag("td", says, class_=f"number {key}")
    heads_row = key == "what" or key == ("task" if step.task else "does")
    return tag("th", value, scope="row") if heads_row else tag("td", value or "–")


def _condition(condition: Condition) -> Markup | str:
    """In bold when it is the one expected last."""
    return tag("b", condition.says) if condition.last else condition.says


def _lines(sentences: Iterable[Markup | str]) -> Markup | str:
    """Each on a line of its own."""
    return join(tag("div", sentence) for sentence in sentences) or "–"
