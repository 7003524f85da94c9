"""A front of cycle times as one HTML file, in the frame of every page: the points, and of each two
cycles, the load of the operators, and a sheet for each human.
"""

from __future__ import annotations

from tandem.draw.imprint import imprint, remarks
from tandem.draw.lanes import kinds_shaded, steady_lanes
from tandem.draw.style import looks
from tandem.plan.cycle.result import CycleFront, CycleResult
from tandem.report.cycle.sheet import (
    cycle_steps,
    sheet_columns,
    sheet_origin,
    sheet_rules,
    sheet_title,
)
from tandem.report.cycle.svg_yamazumi import yamazumi
from tandem.report.cycle.tables import load, points, steps
from tandem.report.cycle.told import assumed as assumptions
from tandem.report.cycle.told import more, summary, title, values
from tandem.report.instruction_sheet import sheet_of
from tandem.report.language import Words, words
from tandem.report.markup import Markup, join, tag
from tandem.report.page import (
    ON_A_PAGE,
    all_or_one,
    assumed,
    badges,
    how_made,
    key,
    lead,
    page,
    printing,
)
from tandem.report.sources import made
from tandem.report.svg_front import front_chart
from tandem.report.svg_gantt import cycle_gantt


def html(
    front: CycleFront,
    *,
    command: str = "",
    date: str = "",
    language: str = "en",
    point: int | None = None,
    stale: bool = False,
) -> str:
    """The report as text; see `report.cycle.files.write`."""
    t = words(language)
    opens = 0 if not len(front) else front.knee_place + 1 if point is None else point
    return page(
        front.cell,
        t("cycle.title", name=front.cell.name or t("unnamed")),
        [
            *lead(summary(front, t, point, stale), stale=stale),
            _printing(front, t),
        ],
        [
            _trade_off(front, t),
            *(_point(front, place, t, opens, stale) for place in range(len(front))),
            assumed(assumptions(front, t), t),
            how_made(made(front, t, command, date), t),
        ],
        {**front.to_dict(), **({"stale": True} if stale else {})},
        t,
        opens=opens,
        shades=True,
    )


def _printing(front: CycleFront, t: Words) -> Markup:
    """What is printed, and what more can be."""
    if not len(front):
        return Markup("")
    plans = {"plans": t("cycle.print.points")} if len(front) > 1 else {}
    return printing(t("cycle.print.lead"), {**plans, "more": t("cycle.print.load")})


def _trade_off(front: CycleFront, t: Words) -> Markup:
    if not len(front):
        return Markup("")
    return tag(
        "section",
        tag("h2", t("front.title"), id="trade-off"),
        all_or_one(t) if len(front) > 1 else Markup(""),
        front_chart(front, t),
        tag("p", t("front.legend"), class_="note"),
        points(front, t),
        class_="trade cycle",
    )


def _point(front: CycleFront, place: int, t: Words, opens: int, stale: bool) -> Markup:
    result = front[place]
    marks = [("plan.recommended", front.knee_place), ("plan.shown", opens - 1)]
    if opens - 1 == front.knee_place:
        del marks[1]
    special = [mark for mark, marked in marks if len(front) > 1 and place == marked]
    named, told = title(front, place, t), values(front, result, t)
    return tag(
        "section",
        tag("h2", named, *badges(special, t)),
        tag("p", imprint(result, t, stale=stale), class_="note"),
        tag("p", more(front, result, t)),
        cycle_gantt(front.cell, result.periodic, t, label=t("cycle.chart", n=place + 1, **told)),
        tag("p", *(key(look, front.cell) for look in looks(front.cell).values())),
        tag("p", _legend(result, t), class_="note"),
        tag(
            "div",
            _load_chart(front, result, t),
            tag(
                "div",
                tag("h3", t("cycle.steps")),
                tag("div", steps(result, t), class_="steps"),
                class_="keep" if len(result.schedule) <= ON_A_PAGE else None,
            ),
            class_="pair",
        ),
        tag("div", tag("h3", t("cycle.load.title")), load(result, t), class_="keep extra"),
        _sheets(result, "; ".join([named, *remarks(result, t, stale=stale)]), t),
        id=f"plan-{place + 1}",
        class_="plan chosen" if place == opens - 1 else "plan",
        data_plan=place + 1,
    )


def _load_chart(front: CycleFront, result: CycleResult, t: Words) -> Markup:
    label = t("cycle.yamazumi", **values(front, result, t))
    takt = front.question.takt
    chart = yamazumi(front.cell, result.periodic, t, takt=takt, label=label)
    return tag("div", tag("h3", t("yamazumi.title")), chart, class_="keep")


def _legend(result: CycleResult, t: Words) -> str:
    found = [t("cycle.legend")]
    found += [t("plan.legend.machine")] if result.cell.machines else []
    found += [t("plan.legend.joint")] if any(len(a.operators) > 1 for a in result.schedule) else []
    rows = steady_lanes(result.cell, result.periodic)
    return " ".join([*found, *(t(f"plan.legend.{kind}") for kind in kinds_shaded(rows))])


def _sheets(result: CycleResult, told: str, t: Words) -> Markup:
    """One sheet for each human."""
    return join(
        sheet_of(
            found,
            sheet_columns(found),
            sheet_title(result, operator, t),
            sheet_rules(result, operator, t),
            sheet_origin(result, operator, told, t),
            t("cycle.sheet.none"),
            t,
        )
        for operator, found in cycle_steps(result, t).items()
    )
