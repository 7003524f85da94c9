"""A front of cycle times as Markdown for wikis: the points, the cycle of one of them, the load, a
sheet for each human, assumptions.
"""

from __future__ import annotations

from tandem.draw.imprint import imprint, remarks
from tandem.draw.lanes import product_mark
from tandem.draw.style import looks
from tandem.plan.cycle.result import CycleFront, CycleResult
from tandem.report.cycle.sheet import (
    cycle_steps,
    sheet_columns,
    sheet_origin,
    sheet_rules,
    sheet_title,
    until_told,
)
from tandem.report.cycle.tables import by_place, load_heads, load_of, load_rows, load_words
from tandem.report.cycle.told import (
    assumed,
    cost,
    idle,
    in_process,
    per_hour,
    status,
    summary,
    title,
)
from tandem.report.language import Words, words
from tandem.report.markdown import escaped, said, table
from tandem.report.sources import made
from tandem.report.tables import named
from tandem.schedule.measures import exact


def markdown(
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
    parts = [
        f"# {escaped(t('cycle.title', name=front.cell.name or t('unnamed')))}",
        *map(escaped, summary(front, t, point, stale)),
    ]
    if len(front):
        parts += [f"## {t('front.title')}", _points(front, t)]
        result, place = front.shown(point), front.knee_place if point is None else point - 1
        named_so = title(front, place, t)
        parts += [
            f"## {named_so}",
            f"*{escaped(imprint(result, t, stale=stale))}*",
            f"### {t('cycle.steps')}",
            _steps(result, t),
            f"### {t('cycle.load.title')}",
            _load(result, t),
        ]
        told = "; ".join([named_so, *remarks(result, t, stale=stale)])
        parts += _sheets(result, told, t)
    parts += [
        f"## {t('assume.title')}",
        "\n".join(f"- {escaped(sentence)}" for sentence in assumed(front, t)),
        f"## {t('made.title')}",
        "\n".join(f"- {what}: {escaped(value)}" for what, value in made(front, t, command, date)),
        f"*{escaped(t('safety'))}*",
    ]
    return "\n\n".join(parts) + "\n"


def _points(front: CycleFront, t: Words) -> str:
    heads = [
        t("cycle.number.point"),
        t("front.cycle_time"),
        t("front.stress"),
        t("cycle.per_hour"),
        t("cycle.makespan"),
        t("cycle.in_process"),
        *([t("front.cost")] if front.cell.cost is not None else []),
        t("cycle.idle"),
        t("front.status"),
        t("front.digest"),
    ]
    rows = []
    for place, result in enumerate(front):
        knee = len(front) > 1 and place == front.knee_place
        rows.append(
            [
                f"**{place + 1}** ({t('plan.recommended')})" if knee else str(place + 1),
                t.number(result.cycle_time),
                t.number(result.stress),
                t.number(per_hour(front, result)),
                t.number(result.makespan),
                in_process(result, t),
                *(t.number(each) for each in [cost(front, result)] if each is not None),
                escaped(", ".join(idle(result, t))),
                status(result, t),
                result.periodic.digest,
            ]
        )
    return table(heads, rows)


def _steps(result: CycleResult, t: Words) -> str:
    """One row a task, in the order of the cycle."""
    periodic, shown, rows = result.periodic, looks(result.cell), []
    for a in by_place(periodic):
        at, seconds = periodic.position(a.start), float(exact(a.end) - exact(a.start))
        stress = load_of(result, a)
        rows.append(
            [
                escaped(named(result.cell, a.task)),
                escaped(" + ".join(shown[o].label for o in a.operators)),
                t.number(at),
                until_told(at, seconds, periodic.cycle_time, t),
                escaped(product_mark(-periodic.lap(a.start))),
                "–" if stress is None else t.number(stress),
            ]
        )
    keys = ("task", "who", "at", "until", "product", "stress")
    return table([t(f"cycle.step.{key}") for key in keys], rows)


def _load(result: CycleResult, t: Words) -> str:
    rows = [[escaped(value) for value in load_words(row, t)] for row in load_rows(result, t)]
    return table(load_heads(result.cell, t), rows)


def _sheets(result: CycleResult, told: str, t: Words) -> list[str]:
    """A sheet for each human."""
    parts = []
    for operator, found in cycle_steps(result, t).items():
        parts.append(f"### {escaped(sheet_title(result, operator, t))}")
        if not found:
            parts.append(t("cycle.sheet.none"))
            continue
        shown = sheet_columns(found)
        rows = [[said(step, key, t) for key in shown] for step in found]
        parts += [
            *map(escaped, sheet_rules(result, operator, t)),
            table([t(f"steps.{key}") for key in shown], rows),
            escaped(sheet_origin(result, operator, told, t)),
        ]
    return parts
