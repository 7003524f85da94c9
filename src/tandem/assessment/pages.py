"""An assessment as a page that an ergonomist could sign: Markdown, HTML, PDF, a workbook,
JSON.
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tandem.assessment import printed
from tandem.assessment import sentences as say
from tandem.assessment.document import document, of_outside, of_shift
from tandem.assessment.printed import Block, Grid, Line
from tandem.assessment.shift import Shift
from tandem.cell.assessed import Assessed
from tandem.cell.language import Words
from tandem.cell.names import Known
from tandem.ergonomics.tasks import Scored, Total
from tandem.errors import UsageError
from tandem.files.atomic import store
from tandem.report.markup import Markup, tag

if TYPE_CHECKING:
    from openpyxl.worksheet.worksheet import Worksheet

COLOURS = ("#e3f1e4", "#fdf3d0", "#fbe0c4", "#f6cfc9", "#eeb4ae")
"""From the best level to the worst; the level is always written as well."""
STYLE = """
section.task { break-inside: avoid; border-top: 1px solid #c8ccd0; margin-top: 1.6rem; }
section.task h3 { margin-top: .8rem; }
table { font-size: .92rem; }
.columns td:last-child { min-width: 6rem; }
.columns table { font-size: .82rem; }
td.level { padding-left: .5rem; }
td.default { font-style: italic; }
.columns { display: flex; flex-wrap: wrap; gap: 0 2.4rem; }
.columns > div { flex: 1 1 22rem; }
.sign { display: grid; grid-template-columns: 2fr 1fr 3fr; gap: 2rem; margin: 3.2rem 0 1rem; }
.sign div { border-top: 1px solid #1a1a1a; padding-top: .2rem; }
@page { size: A4; margin: 14mm; }
@media print { html { font-size: 11px; } main, header, footer { padding: 0; } }
"""


@dataclass(frozen=True)
class Assessment:
    """What is written: the scored tasks, what they come to, and how that was made.

    Attributes:
      outside: of a cell, the numbers that were stated and not computed.
      shift: what a plan of the cell puts on each person.
    """

    name: str
    rows: Sequence[Scored]
    totals: Sequence[Total]
    made: Mapping[str, str]
    outside: Sequence[Assessed] = ()
    shift: Shift | None = None

    def levels(self) -> Iterator[tuple[Scored, str]]:
        """Each task with the colour of its level."""
        for row in self.rows:
            worst = {"rula": 3, "reba": 4}.get(row.given.method, 2)
            place = round(row.outcome.level * (len(COLOURS) - 1) / worst)
            yield row, COLOURS[min(place, len(COLOURS) - 1)]


def _summary(t: Words, row: Scored) -> list[str]:
    given, outcome = row.given, row.outcome
    return [
        given.task,
        t(f"side.{given.side}"),
        t(f"method.{given.method}"),
        say.score(t, given.method, outcome.score),
        say.level(t, given.method, outcome.level),
        t("yes") if row.stable else t("no"),
    ]


SUMMARY = ("task", "side", "method", "score", "action", "stable")


def _facts(t: Words, row: Scored) -> Iterator[tuple[list[str], bool]]:
    """The facts of a task as a table, and of each whether it was not stated."""
    for name, origin in row.given.origins.items():
        value = getattr(row.given.facts, name)
        if value is None:
            continue
        shown = [
            say.fact(t, row.given.method, name),
            say.number(t, value),
            say.unit_of(row, name),
            t(f"source.{origin.source}"),
            *([origin.assessor, origin.date] if origin.source != "default" else ["", ""]),
        ]
        yield shown, origin.source == "default"


FACTS = ("fact", "value", "unit", "source", "assessor", "date")


def _steps(t: Words, row: Scored) -> Iterator[list[str]]:
    for step in row.outcome.steps:
        yield [
            t(f"part.{step.part}"),
            say.number(t, step.value),
            ", ".join(say.reasoned(t, why) for why in step.reasons),
        ]


STEPS = ("step", "result", "reason")


OUTSIDE = ("task", "operators", "side", "method", "score", "source", "assessor", "date")


def _outside(t: Words, found: Assessment) -> Iterator[list[str]]:
    for one in found.outside:
        yield [
            one.task,
            ", ".join(one.operators),
            t(f"side.{one.side}"),
            say.method(t, one.method),
            say.number(t, one.value),
            t(f"source.{one.origin.source}"),
            one.origin.assessor,
            one.origin.date,
        ]


def _heads(t: Words, names: Sequence[str]) -> list[str]:
    return [t(f"col.{name}") for name in names]


def _limits(t: Words, found: Assessment) -> list[str]:
    methods = dict.fromkeys(row.given.method for row in found.rows)
    said = [f"{t(f'method.{method}')}: {t(f'limits.{method}')}" for method in methods]
    return [*said, *([t("limits.outside")] if found.outside else [])]


def _made(t: Words, found: Assessment) -> str:
    return t("made", version=found.made["version"], command=found.made["command"])


# --- Markdown -------------------------------------------------------------------------------------


def markdown(t: Words, found: Assessment) -> str:
    """The assessment as Markdown."""
    lines = [f"# {t('title', name=found.name)}", ""]
    lines += [*_md_table(_heads(t, SUMMARY), [_summary(t, row) for row in found.rows]), ""]
    if found.totals:
        lines += [f"## {t('head.shift')}", ""]
        lines += [*(f"- {say.total(t, one)}" for one in found.totals), ""]
    if found.outside:
        table = _md_table(_heads(t, OUTSIDE), list(_outside(t, found)))
        lines += [f"## {t('head.outside')}", "", *table, ""]
    if found.shift is not None:
        lines += [f"## {t('head.people')}", "", say.shift(t, found.shift), ""]
        for title, said in say.people(t, found.shift):
            lines += [f"### {title}", "", *(f"- {one}" for one in said), ""]
    lines += [f"## {t('head.tasks')}", ""]
    for row in found.rows:
        lines += [f"### {_title(t, row)}", "", say.explanation(t, row.outcome), ""]
        lines += [said for said in (say.stability(t, row), "", say.unstated(t, row)) if said]
        lines += ["", *_md_table(_heads(t, FACTS), [cells for cells, _ in _facts(t, row)]), ""]
        lines += [*_md_table(_heads(t, STEPS), list(_steps(t, row))), ""]
    lines += [f"## {t('head.limits')}", "", *(f"- {said}" for said in _limits(t, found)), ""]
    lines += [t("advice"), "", _made(t, found), ""]
    blank = f"{t('sign.name')}: ____________  {t('sign.date')}: ________"
    lines += [f"{blank}  {t('sign.signature')}: ____________", ""]
    return "\n".join(lines)


def _title(t: Words, row: Scored) -> str:
    side = t(f"side.{row.given.side}")
    return f"{row.given.task}{f' ({side})' if side else ''}: {t(f'method.{row.given.method}')}"


def _md_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"

    return [line(heads), "|" + "---|" * len(heads), *map(line, rows)]


# --- HTML -----------------------------------------------------------------------------------------


def html(t: Words, found: Assessment) -> str:
    """The assessment as one file that opens anywhere, prints on A4 and loads nothing."""
    style = resources.files("tandem.report").joinpath("page.css").read_text("utf-8") + STYLE
    body = tag(
        "body",
        tag("header", tag("h1", t("title", name=found.name)), *_people(t, found)),
        tag(
            "main",
            _html_summary(t, found),
            _html_shift(t, found),
            _html_people(t, found),
            _html_outside(t, found),
            _html_tasks(t, found),
        ),
        tag(
            "footer",
            tag("h2", t("head.limits")),
            *(tag("p", said) for said in _limits(t, found)),
            tag("p", tag("strong", t("advice"))),
            tag(
                "div",
                *(tag("div", t(f"sign.{name}")) for name in ("name", "date", "signature")),
                class_="sign",
            ),
            tag("p", _made(t, found), class_="note"),
        ),
    )
    head = tag(
        "head",
        Markup('<meta charset="utf-8">'),
        Markup('<meta name="viewport" content="width=device-width, initial-scale=1">'),
        tag("title", t("title", name=found.name)),
        tag("style", Markup(style)),
    )
    return "<!DOCTYPE html>\n" + tag("html", head, body, lang=t.language) + "\n"


def _people(t: Words, found: Assessment) -> list[Markup]:
    said = say.sources(t, found.rows)
    return [tag("p", f"{t('head.sign')}: {'; '.join(said)}", class_="note")] if said else []


def _html_table(
    heads: Sequence[str], rows: Sequence[Sequence[object]], marked: Sequence[bool] = ()
) -> Markup:
    lines = [
        tag(
            "tr",
            *(tag("td", cell, class_="default" if marked and marked[at] else None) for cell in row),
        )
        for at, row in enumerate(rows)
    ]
    head = tag("thead", tag("tr", *(tag("th", name) for name in heads)))
    return tag("div", tag("table", head, tag("tbody", *lines)), class_="wide")


def _html_summary(t: Words, found: Assessment) -> Markup:
    lines = []
    for row, colour in found.levels():
        cells = _summary(t, row)
        lines.append(
            tag(
                "tr",
                *(tag("td", cell) for cell in cells[:3]),
                tag("td", tag("strong", cells[3])),
                tag("td", cells[4], class_="level", style=f"background:{colour}"),
                tag("td", cells[5]),
            )
        )
    head = tag("thead", tag("tr", *(tag("th", name) for name in _heads(t, SUMMARY))))
    table = tag("div", tag("table", head, tag("tbody", *lines)), class_="wide")
    return tag("section", tag("h2", t("head.summary")), table)


def _html_shift(t: Words, found: Assessment) -> Markup:
    if not found.totals:
        return Markup("")
    said = [tag("p", say.total(t, one)) for one in found.totals]
    return tag("section", tag("h2", t("head.shift")), *said)


def _html_people(t: Words, found: Assessment) -> Markup:
    """What the plan does to each person."""
    if found.shift is None:
        return Markup("")
    told = [
        tag("div", tag("h3", title), *(tag("p", one) for one in said))
        for title, said in say.people(t, found.shift)
    ]
    return tag("section", tag("h2", t("head.people")), tag("p", say.shift(t, found.shift)), *told)


def _html_outside(t: Words, found: Assessment) -> Markup:
    if not found.outside:
        return Markup("")
    table = _html_table(_heads(t, OUTSIDE), list(_outside(t, found)))
    return tag("section", tag("h2", t("head.outside")), table)


def _html_tasks(t: Words, found: Assessment) -> Markup:
    return tag(
        "section",
        tag("h2", t("head.tasks")),
        *(_html_task(t, row, colour) for row, colour in found.levels()),
    )


def _html_task(t: Words, row: Scored, colour: str) -> Markup:
    facts = list(_facts(t, row))
    notes = [said for said in (say.stability(t, row), say.unstated(t, row)) if said]
    return tag(
        "section",
        tag("h3", _title(t, row)),
        tag("p", say.explanation(t, row.outcome), style=f"background:{colour};padding:.3rem .5rem"),
        *(tag("p", said) for said in notes),
        tag(
            "div",
            tag(
                "div",
                _html_table(
                    _heads(t, FACTS), [cells for cells, _ in facts], [mark for _, mark in facts]
                ),
            ),
            tag("div", _html_table(_heads(t, STEPS), list(_steps(t, row)))),
            class_="columns",
        ),
        class_="task",
    )


# --- PDF ------------------------------------------------------------------------------------------


def pdf(t: Words, found: Assessment) -> bytes:
    """The assessment on A4, page by page, with a place to sign."""
    return printed.pdf(list(_blocks(t, found)), t("title", name=found.name))


def _blocks(t: Words, found: Assessment) -> Iterator[Block]:
    yield Line(t("title", name=found.name), "title")
    if people := say.sources(t, found.rows):
        yield Line(f"{t('head.sign')}: {'; '.join(people)}")
    yield Line(t("head.summary"), "heading")
    yield Grid(
        _heads(t, SUMMARY),
        [_summary(t, row) for row in found.rows],
        (0.26, 0.1, 0.18, 0.1, 0.28, 0.08),
        [colour for _, colour in found.levels()],
    )
    if found.totals:
        yield Line(t("head.shift"), "heading")
        yield from (Line(say.total(t, one)) for one in found.totals)
    if found.shift is not None:
        yield Line(t("head.people"), "heading")
        yield Line(say.shift(t, found.shift))
        for title, said in say.people(t, found.shift):
            yield Line(title, "task")
            yield from map(Line, said)
    if found.outside:
        yield Line(t("head.outside"), "heading")
        widths = (0.19, 0.19, 0.1, 0.12, 0.08, 0.12, 0.1, 0.1)
        yield Grid(_heads(t, OUTSIDE), list(_outside(t, found)), widths)
    yield Line(t("head.tasks"), "heading")
    for row, colour in found.levels():
        yield Line(_title(t, row), "task")
        yield Line(say.explanation(t, row.outcome), colour=colour)
        yield from (Line(said) for said in (say.stability(t, row), say.unstated(t, row)) if said)
        facts = [cells for cells, _ in _facts(t, row)]
        yield Grid(_heads(t, FACTS), facts, (0.28, 0.12, 0.08, 0.26, 0.15, 0.11))
        yield Grid(_heads(t, STEPS), list(_steps(t, row)), (0.3, 0.14, 0.56))
    yield Line(t("head.limits"), "heading")
    yield from map(Line, (*_limits(t, found), t("advice")))
    blank = "   ".join(f"{t(f'sign.{name}')}: ____________________" for name in SIGNED)
    yield Line(" ")
    yield Line(blank)
    yield Line(_made(t, found))


SIGNED = ("name", "date", "signature")


# --- a workbook -----------------------------------------------------------------------------------


def xlsx(t: Words, found: Assessment) -> bytes:
    """The assessment as a workbook: summary, shift, facts and steps, ready to be printed."""
    from openpyxl import Workbook

    book = Workbook()
    book.remove(book.worksheets[0])
    title = t("title", name=found.name)
    summary = [
        [*cells[:3], row.outcome.score, *cells[4:], say.explanation(t, row.outcome), stays]
        for row in found.rows
        for cells, stays in [(_summary(t, row), say.stability(t, row))]
    ]
    heads = [*_heads(t, SUMMARY), t("col.explanation"), t("col.stable")]
    sheet = _sheet(book, t("sheet.summary"), title, heads, summary, (26, 11, 18, 10, 30, 8, 60, 50))
    _colour(sheet, [colour for _, colour in found.levels()], 5)
    below = len(summary) + 5
    blank = f"{t('sign.name')}: ______________   {t('sign.date')}: __________"
    blank += f"   {t('sign.signature')}: ______________"
    for said in (*_limits(t, found), t("advice"), blank, _made(t, found)):
        _across(sheet, below, said, len(heads))
        below += 1
    shift = [[say.total(t, one), ", ".join(dict.fromkeys(one.tasks))] for one in found.totals]
    if shift:
        _sheet(
            book, t("sheet.shift"), t("head.shift"), [t("col.total"), t("col.tasks")], shift,
            (90, 60),
        )  # fmt: skip
    if found.shift is not None:
        told = say.people(t, found.shift)
        lines = [[title, one] for title, said in told for one in said]
        sheet = _sheet(
            book, t("sheet.people"), t("head.people"), _heads(t, ("person", "total")), lines,
            (26, 110),
        )  # fmt: skip
        _across(sheet, len(lines) + 5, say.shift(t, found.shift), 2)
    if found.outside:
        _sheet(
            book, t("sheet.outside"), t("head.outside"), _heads(t, OUTSIDE),
            list(_outside(t, found)), (26, 22, 11, 18, 10, 14, 18, 12),
        )  # fmt: skip
    facts = [
        [row.given.task, t(f"side.{row.given.side}"), t(f"method.{row.given.method}"), *cells]
        for row in found.rows
        for cells, _ in _facts(t, row)
    ]
    of_task = _heads(t, SUMMARY[:3])
    _sheet(
        book, t("sheet.facts"), t("head.facts"), [*of_task, *_heads(t, FACTS)], facts,
        (26, 11, 18, 30, 16, 8, 22, 18, 12),
    )  # fmt: skip
    steps = [
        [row.given.task, t(f"side.{row.given.side}"), t(f"method.{row.given.method}"), *cells]
        for row in found.rows
        for cells in _steps(t, row)
    ]
    _sheet(
        book, t("sheet.steps"), t("head.steps"), [*of_task, *_heads(t, STEPS)], steps,
        (26, 11, 18, 30, 12, 60),
    )  # fmt: skip
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()


def _sheet(
    book: Any,
    name: str,
    title: str,
    heads: Sequence[str],
    rows: Sequence[Sequence[object]],
    widths: Sequence[float],
) -> Worksheet:
    from tandem.report.workbook import fit_to_page, write_header, write_row, write_title

    sheet: Worksheet = book.create_sheet(name)
    write_title(sheet, title)
    write_header(sheet, 3, list(heads), list(widths))
    for number, row in enumerate(rows, 4):
        write_row(sheet, number, list(row))
    sheet.freeze_panes = "B4"
    fit_to_page(sheet)
    return sheet


def _colour(sheet: Worksheet, colours: Sequence[str], column: int) -> None:
    from openpyxl.styles import PatternFill

    for number, colour in enumerate(colours, 4):
        cell = sheet.cell(number, column)
        cell.fill = PatternFill("solid", fgColor=colour.removeprefix("#").upper())


def _across(sheet: Worksheet, row: int, text: str, columns: int) -> None:
    from tandem.report.workbook import spread

    spread(sheet, row, text, columns)


# --- files ----------------------------------------------------------------------------------------


def json_text(t: Words, found: Assessment) -> str:
    """The assessment as one JSON document."""
    data = document(t, found.name, found.rows, found.totals, found.made)
    data["outside"] = [of_outside(one) for one in found.outside]
    data["shift"] = None if found.shift is None else of_shift(t, found.shift)
    return json.dumps(data, ensure_ascii=False, indent=1) + "\n"


WRITERS: dict[str, Callable[[Words, Assessment], str | bytes]] = {
    ".html": html,
    ".pdf": pdf,
    ".md": markdown,
    ".xlsx": xlsx,
    ".json": json_text,
}
"""Ending of a file -> what is written into it."""


def check(path: Path) -> None:
    """Raises UsageError when a file of that name cannot be written."""
    if path.suffix.lower() not in WRITERS:
        hint = Known(WRITERS).hint(path.suffix.lower())
        raise UsageError(f"-o {path}: an assessment is written as {', '.join(WRITERS)}. {hint}")


def write(t: Words, found: Assessment, path: Path) -> None:
    """Writes the assessment in the form that the file's ending says. Raises OSError, UsageError."""
    check(path)
    store(path, WRITERS[path.suffix.lower()](t, found))
