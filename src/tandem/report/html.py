"""A front as one HTML file: it opens anywhere, without a network, prints on A4 and needs no script
to be read.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from functools import lru_cache
from importlib import resources
from pathlib import Path

from tandem.cell.model import Cell
from tandem.draw.imprint import imprint, remarks
from tandem.draw.lanes import kinds_shaded, lanes
from tandem.draw.style import Look, looks
from tandem.files.atomic import store
from tandem.plan.result import Front, Result, Status
from tandem.report.instruction_sheet import sheets
from tandem.report.language import Words, words
from tandem.report.markup import Markup, hatch_id, hatches, tag
from tandem.report.players import Player, players_section
from tandem.report.risk import is_told, risk_heads, risk_note, risk_rows
from tandem.report.sources import assumptions, made
from tandem.report.svg_front import front_chart
from tandem.report.svg_gantt import gantt
from tandem.report.svg_graph import chain_words, graph
from tandem.report.tables import balance, plans, steps, table, tasks
from tandem.schedule.critical import critical_path

POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
"""What a browser may load for this page: nothing that is not in it."""

ON_A_PAGE = 40
"""So many steps of a plan fit on a page of paper, and so are not torn apart."""


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
    page = html(
        front,
        command=command,
        date=date,
        language=language,
        players=players,
        point=point,
        stale=stale,
    )
    store(path, page)
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
    body = tag(
        "body",
        hatches(looks(front.cell)),
        tag(
            "header",
            tag("h1", t("title", name=name)),
            *(
                tag("p", tag("strong", said) if stale and not place else said, class_="lead")
                for place, said in enumerate(summary(front, t, point, stale))
            ),
            _printing(front, t),
        ),
        tag("main", *sections, _assumptions(front, t), _made(front, t, command, date)),
        tag("footer", tag("p", t("safety"), class_="note")),
        _data(front, stale),
        tag("script", Markup(_shipped("page.js"))),
        data_opens=opens,
    )
    head = tag(
        "head",
        Markup('<meta charset="utf-8">'),
        Markup(f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'),
        Markup('<meta name="viewport" content="width=device-width, initial-scale=1">'),
        Markup('<link rel="icon" href="data:,">'),
        tag("title", t("title", name=name)),
        tag("style", Markup(_shipped("page.css"))),
    )
    return "<!DOCTYPE html>\n" + tag("html", head, body, lang=t("language")) + "\n"


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
        return t("summary.knee.first", **values)
    longer, spared = knee.makespan - quickest.makespan, quickest.stress - knee.stress
    part = t.share(spared / quickest.stress) if quickest.stress else "0 %"
    return t(
        "summary.knee",
        **values,
        longer=f"{t.seconds(longer)} ({t.share(longer / quickest.makespan)})",
        spared=f"{t.number(spared)} ({part})",
    )


def _printing(front: Front, t: Words) -> Markup:
    """What is printed, and what more can be: two boxes to tick, which need no script."""
    if not len(front):
        return Markup("")
    keys = ("plans", "more") if len(front) > 1 else ("more",)
    boxes = (
        tag(
            "label",
            Markup(f'<input type="checkbox" id="print-{key}" autocomplete="off">'),
            " ",
            t(f"print.{key}"),
        )
        for key in keys
    )
    return tag("p", t("print.lead"), *boxes, class_="screen printing")


def _trade_off(front: Front, t: Words, players: Sequence[Player]) -> Markup:
    if not len(front):
        return Markup("")
    button = tag(
        "button",
        t("front.all"),
        id="all",
        type="button",
        hidden=True,
        data_all=t("front.all"),
        data_single=t("front.single"),
    )
    hint = tag("p", t("front.hint"), " ", button, class_="screen") if len(front) > 1 else Markup("")
    legend = tag("p", t("front.legend"), class_="note")
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
    badge = [
        piece
        for key, marked in marks
        if len(front) > 1 and result is marked
        for piece in (" ", tag("span", t(key), class_="badge"))
    ]
    title, origin = t("plan.title", **values), imprint(result, t, stale=stale)
    return tag(
        "section",
        tag("h2", title, *badge),
        tag("p", origin, class_="note"),
        gantt(front.cell, result.schedule, t, label=t("plan.chart", **values)),
        tag("p", *(_key(look, front.cell) for look in looks(front.cell).values())),
        tag("p", _legend(front.cell, result, t), class_="note"),
        tag("p", t("plan.critical", chain=_chain(result))),
        tag(
            "div",
            tag("h3", t("balance.title")),
            balance(front.cell, result.schedule, t),
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


def _key(look: Look, cell: Cell) -> Markup:
    """An operator's fill, name and letters."""
    box = tag(
        "svg",
        tag("rect", width=30, height=20, fill=f"url(#{hatch_id(look, looks(cell))})"),
        width=30,
        height=20,
        aria_hidden="true",
    )
    return tag("span", box, f"{look.letters}: {look.label}", class_="key")


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
    keys = tag("p", *(_key(look, cell) for look in looks(cell).values()))
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


def _assumptions(front: Front, t: Words) -> Markup:
    """What was modelled and how far it is proven. Only what this cell has."""
    found = assumptions(front, t)
    return tag(
        "section",
        tag("h2", t("assume.title"), id="assumptions"),
        tag("ul", *(tag("li", sentence) for sentence in found)),
        class_="keep papers",
    )


def _made(front: Front, t: Words, command: str, date: str) -> Markup:
    listed = tag(
        "dl",
        *(
            piece
            for key, value in made(front, t, command, date)
            for piece in (tag("dt", key), tag("dd", value))
        ),
    )
    return tag(
        "section",
        tag("h2", t("made.title"), id="made"),
        listed,
        tag("p", t("made.data"), class_="note"),
        class_="keep",
    )


def _data(front: Front, stale: bool) -> Markup:
    """The result document and the cell, so that every number of the page can be read by a
    program.
    """
    document = {**front.to_dict(), **({"stale": True} if stale else {})}
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"))
    for sign, safe in (
        ("<", "\\u003c"),
        (">", "\\u003e"),
        ("&", "\\u0026"),
        ("\u2028", "\\u2028"),
        ("\u2029", "\\u2029"),
    ):
        text = text.replace(sign, safe)
    return tag("script", Markup(text), type="application/json", id="result")


@lru_cache
def _shipped(name: str) -> str:
    return (resources.files("tandem.report") / name).read_text("utf-8")
