"""A front as one HTML file: it opens anywhere, without a network, prints on A4 and needs no script
to be read.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from tandem.cell.model import Cell
from tandem.draw.front import bound_points
from tandem.draw.imprint import imprint, remarks
from tandem.draw.lanes import kinds_shaded, lanes
from tandem.draw.style import looks
from tandem.files.atomic import store
from tandem.plan.result import Front, Result, Status
from tandem.report.instruction_sheet import sheets
from tandem.report.language import Words, words
from tandem.report.markup import Markup, tag
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
from tandem.report.players import Player, players_section
from tandem.report.risk import is_told, risk_heads, risk_note, risk_rows
from tandem.report.sources import assumptions, made
from tandem.report.svg_front import front_chart
from tandem.report.svg_gantt import gantt
from tandem.report.svg_graph import chain_words, graph
from tandem.report.tables import balance, doubt, plans, steps, table, tasks, used_limits
from tandem.schedule.critical import critical_path


def write_html(
    front: Front,
    path: str | os.PathLike[str],
    *,
    command: str = "",
    date: str = "",
    language: str = "en",
    players: Sequence[Player] = (),
    point: int | None = None,
    stale: bool = False,
) -> Path:
    """Writes the report and returns where. The same arguments give the same bytes.

    Args:
      command: the command line that made the front, to be printed in the report.
      date: when it was made, to be printed; left out when empty.
      players: others who played the cell, to be shown beside the front.
      point: the plan with which the page opens, counted from 1; the recommended one when not given.
      stale: the cell has changed since; the page says so.

    Raises:
      OSError: the file cannot be written; nothing is left behind.
      UsageError: there is no such language.
    """
    text = html(
        front,
        command=command,
        date=date,
        language=language,
        players=players,
        point=point,
        stale=stale,
    )
    store(path, text)
    return Path(path)


def html(
    front: Front,
    *,
    command: str = "",
    date: str = "",
    language: str = "en",
    players: Sequence[Player] = (),
    point: int | None = None,
    stale: bool = False,
) -> str:
    """The report as text; see `write_html`."""
    t = words(language)
    name = front.cell.name or t("unnamed")
    opens = front.results.index(front.shown(point)) + 1 if len(front) else 0
    sections = [
        _trade_off(front, t, players),
        players_section(front.cell, players, t),
        *(_plan(front, place, t, point, stale) for place in range(len(front))),
        _graph(front.cell, t),
        _tasks(front, t),
    ]
    document = {**front.to_dict(), **({"stale": True} if stale else {})}
    return page(
        front.cell,
        t("title", name=name),
        [*lead(summary(front, t, point, stale), stale=stale), _printing(front, t)],
        [*sections, assumed(assumptions(front, t), t), how_made(made(front, t, command, date), t)],
        document,
        t,
        opens=opens,
    )


def summary(front: Front, t: Words, point: int | None = None, stale: bool = False) -> list[str]:
    """What a reader must know, in a few sentences; `point` was chosen, `stale` as in `write`."""
    cell = front.cell
    *people, last = (t.count(kind, len(names)) for kind, names in cell.crew.items())
    operators = t("and", first=", ".join(people), last=last) if people else last
    first = t("summary.cell", tasks=t.count("task", len(cell.tasks)), operators=operators)
    asked = front.question
    limits = (
        []
        if asked.max_makespan is None
        else [t("summary.limit.makespan", limit=t.seconds(asked.max_makespan))]
    )
    limits += (
        []
        if asked.max_stress is None
        else [t("summary.limit.stress", limit=t.number(asked.max_stress))]
    )
    first = " ".join([first, *limits])
    if not len(front):
        return [first, t("summary.none")]
    if len(front) == 1:
        found = t(
            "summary.one", makespan=t.seconds(front[0].makespan), stress=t.number(front[0].stress)
        )
    else:
        ends = {
            "first_makespan": t.seconds(front[0].makespan),
            "first_stress": t.number(front[0].stress),
        }
        ends |= {
            "last_makespan": t.seconds(front[len(front) - 1].makespan),
            "last_stress": t.number(front[len(front) - 1].stress),
        }
        found = t("summary.many", n=len(front), **ends) + " " + _advice(front, t)
    proof = (
        {"front": "proven", "change": "change"}.get(asked.minimize, "answer")
        if front.complete
        else "answer"
        if all(r.status == Status.OPTIMAL for r in front) and len(front) == 1
        else "open"
    )
    sentences = [f"{first} {found}", t(f"summary.{proof}")]
    sentences += [t("summary.interrupted")] if front.interrupted else []
    chosen = front.shown(point)
    if chosen is not front.knee:
        values = {"makespan": t.seconds(chosen.makespan), "stress": t.number(chosen.stress)}
        sentences.append(t("summary.shown", n=point, **values))
    return [*([t("summary.stale")] if stale else []), *sentences]


def _advice(front: Front, t: Words) -> str:
    knee, quickest = front.knee, front[0]
    values = {
        "n": front.results.index(knee) + 1,
        "makespan": t.seconds(knee.makespan),
        "stress": t.number(knee.stress),
    }
    if knee is quickest:
        return " ".join([t("summary.knee.first", **values), *doubt(front, t)])
    longer, spared = knee.makespan - quickest.makespan, quickest.stress - knee.stress
    part = t.share(spared / quickest.stress) if quickest.stress else "0 %"
    advice = t(
        "summary.knee",
        **values,
        longer=f"{t.seconds(longer)} ({t.share(longer / quickest.makespan)})",
        spared=f"{t.number(spared)} ({part})",
    )
    return " ".join([advice, *doubt(front, t)])


def _printing(front: Front, t: Words) -> Markup:
    """What is printed, and what more can be: two boxes to tick, which need no script."""
    if not len(front):
        return Markup("")
    keys = ("plans", "more") if len(front) > 1 else ("more",)
    return printing(t("print.lead"), {key: t(f"print.{key}") for key in keys})


def _trade_off(front: Front, t: Words, players: Sequence[Player]) -> Markup:
    if not len(front):
        return Markup("")
    hint = all_or_one(t) if len(front) > 1 else Markup("")
    key_to_it = "front.legend.open" if bound_points(front) else "front.legend"
    legend = tag("p", t(key_to_it), class_="note")
    return tag(
        "section",
        tag("h2", t("front.title"), id="trade-off"),
        hint,
        front_chart(front, t, players),
        legend,
        tag("div", plans(front, t), _risk(front, t), class_="beside"),
        class_="trade",
    )


def _risk(front: Front, t: Words) -> Markup:
    if not is_told(front):
        return Markup("")
    heads = [(head, "number") for head in risk_heads(front, t)]
    rows = [
        tag("tr", *(tag("td", cell, class_="number") for cell in row))
        for row in risk_rows(front, t)
    ]
    return tag(
        "div",
        tag("h3", t("risk.title")),
        table(heads, rows, t("risk.title")),
        tag("p", risk_note(front, t), class_="note"),
        class_="risk",
    )


def _plan(front: Front, place: int, t: Words, point: int | None, stale: bool) -> Markup:
    result = front[place]
    values = {
        "n": place + 1,
        "makespan": t.seconds(result.makespan),
        "stress": t.number(result.stress),
    }
    marks = [("plan.recommended", front.knee)]
    marks += [("plan.shown", front.shown(point))] if front.shown(point) is not front.knee else []
    special = [mark for mark, marked in marks if len(front) > 1 and result is marked]
    title, origin = t("plan.title", **values), imprint(result, t, stale=stale)
    return tag(
        "section",
        tag("h2", title, *badges(special, t)),
        tag("p", origin, class_="note"),
        gantt(front.cell, result.schedule, t, label=t("plan.chart", **values)),
        tag("p", *(key(look, front.cell) for look in looks(front.cell).values())),
        tag("p", _legend(front.cell, result, t), class_="note"),
        tag("p", t("plan.critical", chain=_chain(result))),
        tag(
            "div",
            tag("h3", t("balance.title")),
            balance(front.cell, result.schedule, t),
            used_limits(front.cell, result.schedule, t),
            class_="keep extra",
        ),
        tag(
            "div",
            tag("h3", t("plan.steps")),
            tag("div", steps(front.cell, result.schedule, t), class_="steps"),
            class_="keep" if len(result.schedule) <= ON_A_PAGE else None,
        ),
        sheets(result, "; ".join([title, *remarks(result, t, stale=stale)]), t),
        id=f"plan-{place + 1}",
        class_="plan chosen" if result is front.shown(point) else "plan",
        data_plan=place + 1,
    )


def _chain(result: Result) -> str:
    names = [link.assignment.task for link in critical_path(result.cell, result.schedule)]
    return " → ".join([*names[:20], "…", *names[-10:]] if len(names) > 32 else names)


def _legend(cell: Cell, result: Result, t: Words) -> str:
    found = [t("plan.legend")]
    found += [t("plan.legend.machine")] if cell.machines else []
    found += [t("plan.legend.joint")] if any(len(a.operators) > 1 for a in result.schedule) else []
    rows = lanes(cell, result.schedule, until=result.makespan, critical=False)
    waits = any(bar.since for lane in rows for bar in lane.bars)
    found += [t("plan.legend.wait")] if waits else []
    found += [t(f"plan.legend.{kind}") for kind in kinds_shaded(rows)]
    return " ".join(found)


def _graph(cell: Cell, t: Words) -> Markup:
    notes = [tag("p", chain_words(cell, t)), tag("p", t("graph.legend"), class_="note")]
    keys = tag("p", *(key(look, cell) for look in looks(cell).values()))
    return tag(
        "section",
        tag("h2", t("graph.title"), id="graph"),
        *notes[:1],
        graph(cell, t),
        keys,
        *notes[1:],
        class_="page extra",
    )


def _tasks(front: Front, t: Words) -> Markup:
    return tag(
        "section", tag("h2", t("tasks.title"), id="tasks"), tasks(front, t), class_="page extra"
    )
