"""The tables of a cycle's page: the points, who does what at which place in the cycle, the load of
each operator.
"""

from __future__ import annotations

from tandem.cell.model import Cell
from tandem.draw.lanes import product_mark
from tandem.draw.style import looks
from tandem.plan.cycle.result import CycleFront, CycleResult
from tandem.report.cycle.sheet import until_told
from tandem.report.cycle.told import cost, idle, in_process, per_hour, status
from tandem.report.language import Words
from tandem.report.markup import Markup, join, tag
from tandem.report.tables import MOST_PRINTED, between, named, pieces, shown_plans, table
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.measures import exact, mode_of, stress_by_human
from tandem.schedule.model import Assignment
from tandem.schedule.steady import rounds


def points(front: CycleFront, t: Words) -> Markup:
    """One row a point: numbers, what they mean for the station, how far proven."""
    heads = [
        (t("cycle.number.point"), ""),
        (t("front.cycle_time"), "number"),
        (t("front.stress"), "number"),
        (t("cycle.per_hour"), "number"),
        (t("cycle.makespan"), "number"),
        (t("cycle.in_process"), "number"),
        *([(t("front.cost"), "number")] if front.cell.cost is not None else []),
        (t("cycle.idle"), ""),
        (t("front.status"), ""),
        (t("front.digest"), ""),
    ]
    printed = range(len(front)) if len(front) <= MOST_PRINTED else shown_plans(front)
    rows = []
    for place, result in enumerate(front):
        link = tag("a", str(place + 1), href=f"#plan-{place + 1}")
        if len(front) > 1 and place == front.knee_place:
            link = join([link, " ", tag("span", t("plan.recommended"), class_="badge")])
        cells = [
            tag("th", link, scope="row"),
            tag("td", t.number(result.cycle_time), class_="number"),
            tag("td", t.number(result.stress), class_="number"),
            tag("td", t.number(per_hour(front, result)), class_="number"),
            tag("td", t.number(result.makespan), class_="number"),
            tag("td", in_process(result, t), class_="number"),
            *(
                tag("td", t.number(each), class_="number")
                for each in [cost(front, result)]
                if each is not None
            ),
            tag("td", pieces(idle(result, t))),
            tag("td", status(result, t)),
            tag("td", tag("code", result.periodic.digest)),
        ]
        more = None if place in printed else "more"
        rows.append(tag("tr", *cells, data_plan=place + 1, class_=more))
    some = t("front.some", shown=len(printed), n=len(front)) if len(printed) < len(front) else ""
    return join([table(heads, rows, t("cycle.table")), tag("p", some, class_="paper some note")])


def by_place(periodic: PeriodicSchedule) -> list[Assignment]:
    """The tasks in the order of the cycle."""
    return sorted(periodic, key=lambda a: (periodic.position(a.start), a))


def load_of(result: CycleResult, a: Assignment) -> float | None:
    """The stress that a task puts on the humans who do it; None when no human does."""
    mode = mode_of(result.cell, a)
    return float(sum(map(exact, mode.stress.values()))) if mode and mode.stress else None


def steps(result: CycleResult, t: Words) -> Markup:
    """One row a task, in the order of the cycle."""
    periodic, shown = result.periodic, looks(result.cell)
    keys = (
        ("task", ""),
        ("who", ""),
        ("at", "number"),
        ("until", "number"),
        ("product", ""),
        ("stress", "number"),
    )
    rows = []
    for a in by_place(periodic):
        at, seconds = periodic.position(a.start), float(exact(a.end) - exact(a.start))
        stress = load_of(result, a)
        cells = [
            tag("th", named(result.cell, a.task), scope="row"),
            tag("td", " + ".join(shown[o].label for o in a.operators)),
            tag("td", t.number(at), class_="number"),
            tag("td", until_told(at, seconds, periodic.cycle_time, t), class_="number"),
            tag("td", product_mark(-periodic.lap(a.start))),
            tag("td", "–" if stress is None else t.number(stress), class_="number"),
        ]
        rows.append(tag("tr", *cells))
    return table([(t(f"cycle.step.{key}"), kind) for key, kind in keys], rows, t("cycle.steps"))


LOAD = ("operator", "kind", "tasks", "work", "between", "idle", "used", "free", "stress")
"""What is told of an operator's load, in the order of the columns."""


def load_heads(cell: Cell, t: Words) -> list[str]:
    """The words above those columns."""
    return [t(f"cycle.load.{between(cell) if key == 'between' else key}") for key in LOAD]


def load_rows(result: CycleResult, t: Words) -> list[list[str | float | None]]:
    """Per operator what `LOAD` names: words, seconds, shares of 1, stress; None where it is no
    human's.
    """
    stress, shown = stress_by_human(result.cell, result.schedule), looks(result.cell)
    return [
        [
            shown[name].label,
            t(shown[name].kind),
            float(len(own.turns)),
            own.working,
            float(exact(own.walking) + exact(own.changing)),
            own.idle,
            own.share(own.working),
            own.share(own.idle),
            stress.get(name),
        ]
        for name, own in rounds(result.cell, result.periodic).items()
    ]


def load_words(row: list[str | float | None], t: Words) -> list[str]:
    """A row of them, in words."""
    return [
        value
        if isinstance(value, str)
        else "–"
        if value is None
        else t.share(value)
        if key in ("used", "free")
        else t.number(value)
        for key, value in zip(LOAD, row, strict=True)
    ]


def load(result: CycleResult, t: Words) -> Markup:
    """One row an operator: how the cycle is spent, and the stress of each product."""
    heads = [
        (says, "" if key in ("operator", "kind") else "number")
        for key, says in zip(LOAD, load_heads(result.cell, t), strict=True)
    ]
    rows = []
    for row in load_rows(result, t):
        head, kind, *numbers = load_words(row, t)
        cells = [tag("th", head, scope="row"), tag("td", kind)]
        cells += [tag("td", number, class_="number") for number in numbers]
        rows.append(tag("tr", *cells))
    return table(heads, rows, t("cycle.load.title"))
