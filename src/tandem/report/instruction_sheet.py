"""An operator's instruction sheet in the page: folded away on the screen, on a new page on
paper.
"""

from __future__ import annotations

from tandem.draw.style import looks
from tandem.plan.result import Result
from tandem.report.instructions import Turn, rules, times, turns
from tandem.report.language import Words
from tandem.report.markup import Markup, join, tag
from tandem.report.tables import table

EXTRAS = {"part": "part", "tool": "tool", "zone": "zone", "together_with": "with"}
"""Fields of a turn that only some cells have -> the key of their word."""


def sheets(result: Result, title: str, t: Words) -> Markup:
    """One sheet for each operator. Each printed page says whose it is and to which plan (`title`)
    it belongs; without a script all stand open.
    """
    return join(_sheet(result, operator, title, t) for operator in result.cell.operators)


def _sheet(result: Result, operator: str, title: str, t: Words) -> Markup:
    found = turns(result.cell, result.schedule, operator, t)
    heading = t("steps.title", who=looks(result.cell)[operator].label)
    above = [tag("p", sentence) for sentence in rules(result.cell, operator, t)] if found else []
    origin = t(
        "steps.of",
        who=looks(result.cell)[operator].label,
        cell=result.cell.name or t("unnamed"),
        plan=title,
    )
    inside = _table(found, heading, origin, t) if found else tag("p", t("steps.none"))
    return tag(
        "details", tag("summary", tag("h3", heading)), *above, inside, class_="sheet", open=True
    )


def _table(found: tuple[Turn, ...], heading: str, origin: str, t: Words) -> Markup:
    extras = [key for key in EXTRAS if any(getattr(turn, key) for turn in found)]
    heads = [
        (t("steps.turn"), "number"),
        (t("steps.does"), ""),
        *((t(f"steps.{EXTRAS[key]}"), "") for key in extras),
    ]
    heads += [
        (t("steps.wait"), ""),
        (t("steps.hands"), ""),
        *((t(f"steps.{key}"), "number") for key in times(found)),
    ]
    return table(
        heads, (_row(turn, extras, times(found), t) for turn in found), heading, on_paper=origin
    )


def _row(turn: Turn, extras: list[str], shown: tuple[str, ...], t: Words) -> Markup:
    return tag(
        "tr",
        tag("td", str(turn.number), class_="number"),
        tag("th", turn.does, scope="row"),
        *(tag("td", getattr(turn, key) or "–") for key in extras),
        tag("td", _lines(turn.wait), class_="told"),
        tag("td", _lines(turn.hands_to), class_="told"),
        *(
            tag(
                "td",
                "–" if getattr(turn, key) is None else t.number(getattr(turn, key)),
                class_="number",
            )
            for key in shown
        ),
    )


def _lines(sentences: tuple[str, ...]) -> Markup | str:
    """Each on a line of its own."""
    return join(tag("div", sentence) for sentence in sentences) if sentences else "–"
