"""An operator's instruction sheet in the page: folded away on the screen, a page of its own on
paper.
"""

from __future__ import annotations

from collections.abc import Iterable

from tandem.draw.style import looks
from tandem.plan.result import Result
from tandem.report.instructions import Condition, Step, columns, rules, steps
from tandem.report.language import Words
from tandem.report.markup import Markup, join, tag
from tandem.report.tables import table

LONG = 34
"""A sheet of more lines than that is printed in smaller letters, so that it stays on one page."""
NUMBERS = ("number", "start", "end", "deadline")


def sheets(result: Result, title: str, t: Words) -> Markup:
    """One sheet for each operator. Each printed page says whose it is and to which plan (`title`)
    it belongs; without a script all stand open.
    """
    return join(_sheet(result, operator, title, t) for operator in result.cell.operators)


def _sheet(result: Result, operator: str, title: str, t: Words) -> Markup:
    found = steps(result.cell, result.schedule, operator, t)
    heading = t("steps.title", who=looks(result.cell)[operator].label)
    above = [tag("p", sentence) for sentence in rules(result.cell, operator, t)] if found else []
    origin = t(
        "steps.of",
        who=looks(result.cell)[operator].label,
        cell=result.cell.name or t("unnamed"),
        plan=title,
    )
    inside = _table(found, heading, origin, t) if found else tag("p", t("steps.none"))
    lines = sum(max(len(step.begin), len(step.then), 1) for step in found)
    return tag(
        "details",
        tag("summary", tag("h3", heading)),
        *above,
        inside,
        class_="sheet long" if lines > LONG else "sheet",
        open=True,
    )


def _table(found: tuple[Step, ...], heading: str, origin: str, t: Words) -> Markup:
    shown = columns(found)
    heads = [(t(f"steps.{key}"), "number" if key in NUMBERS else "") for key in shown]
    return table(heads, (_row(step, shown, t) for step in found), heading, on_paper=origin)


def _row(step: Step, shown: tuple[str, ...], t: Words) -> Markup:
    return tag(
        "tr",
        *(_cell(step, key, t) for key in shown),
        class_=None if step.task else "change",
    )


def _cell(step: Step, key: str, t: Words) -> Markup:
    value = getattr(step, key)
    if key == "begin":
        return tag("td", _lines(map(_condition, step.begin)), class_="told")
    if key == "then":
        return tag("td", _lines(step.then), class_="told")
    if key in NUMBERS:
        return tag("td", "–" if value is None else t.number(value), class_="number")
    heads_row = key == "what" or key == ("task" if step.task else "does")
    return tag("th", value, scope="row") if heads_row else tag("td", value or "–")


def _condition(condition: Condition) -> Markup | str:
    """In bold when it is the one expected last."""
    return tag("b", condition.says) if condition.last else condition.says


def _lines(sentences: Iterable[Markup | str]) -> Markup | str:
    """Each on a line of its own."""
    return join(tag("div", sentence) for sentence in sentences) or "–"
