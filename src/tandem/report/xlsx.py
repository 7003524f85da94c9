"""A front as a workbook: the plans, a Gantt chart of coloured cells, instructions for each
operator, assumptions; and the cell itself in the form that `tandem import` reads, so that the
workbook gives the same cell again.
"""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell, plain
from tandem.draw.imprint import remarks
from tandem.draw.style import contrast, looks
from tandem.plan.result import Front, Result
from tandem.report.instructions import Row, columns, instructed, origin, rules, steps
from tandem.report.language import Words, words
from tandem.report.limits import limit_heads, used_of_limits
from tandem.report.risk import is_told, risk_heads, risk_note, risk_values
from tandem.report.sources import assumptions, made
from tandem.report.tables import between, doubt, named, shown_plans, status
from tandem.report.workbook import (
    FONT,
    book_of,
    edge,
    finished,
    letter,
    name_on_paper,
    name_plan,
    put,
    sheet_name,
    spread,
    write_header,
    write_made,
    write_row,
    write_title,
)
from tandem.schedule.critical import critical_path, slack
from tandem.schedule.measures import (
    changing,
    exact,
    idle,
    makespan,
    mode_of,
    stress_by_human,
    working,
)
from tandem.schedule.model import Schedule

if TYPE_CHECKING:
    from openpyxl import Workbook
    from openpyxl.worksheet.worksheet import Worksheet

MOST_SLOTS = 120
"""Columns of a Gantt chart."""
STEPS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600)
"""Seconds that one column may stand for."""
PAGE = 118.0
"""Characters across a page in A4 landscape, beside the column of names."""
WIDTHS = {
    "number": 7, "task": 10, "does": 30, "what": 30, "means": 28, "begin": 46, "then": 36,
    "start": 10, "end": 10, "deadline": 12,
}  # fmt: skip
"""Characters across the columns of an instruction sheet."""
ON_A_PAGE = 24
"""So many steps of an operator are printed on one page."""
BREAK = "BDBDBD"


def xlsx(
    front: Front,
    *,
    command: str = "",
    date: str = "",
    language: str = "en",
    point: int | None = None,
    stale: bool = False,
) -> bytes:
    """The workbook as bytes; see `write`. Of a long front the ends, the knee, the chosen plan and
    some between get sheets of their own; all stand in the first.

    Raises:
      UsageError: reports do not speak the language.
    """
    t = words(language)
    book, cell_sheets = book_of(front.cell, language)
    _front(book, front, t, point, stale)
    if is_told(front):
        _risk(book, front, t)
    for place in shown_plans(front, point) if len(front) else []:
        _plan(book, front[place], place + 1, t)
        name_plan(book, front[place], t, stale)
        _gantt(book, front[place], place + 1, t)
        name_plan(book, front[place], t, stale)
    if len(front):
        result = front.shown(point)
        title = _plan_title(result, front.results.index(result) + 1, t)
        title = "; ".join([title, *remarks(result, t, stale=stale)])
        for operator in instructed(front.cell):
            _instructions(book, result, operator, title, t)
            name_on_paper(book, result, t, stale)
    write_made(book, assumptions(front, t), made(front, t, command, date), t)
    return finished(book, cell_sheets)


# --- sheets ---------------------------------------------------------------------------------------


def _front(book: Workbook, front: Front, t: Words, point: int | None, stale: bool) -> None:
    sheet = book.create_sheet(t("sheet.front"))
    write_title(sheet, t("title", name=front.cell.name or t("unnamed")))
    shown = looks(front.cell)
    heads = [
        t("front.plan"),
        t("front.makespan"),
        t("front.stress"),
        *([t("front.cost")] if front.cell.cost is not None else []),
        t("front.status"),
        t("front.digest"),
        *(t("front.does", who=look.label) for look in shown.values()),
    ]
    cost = [14] if front.cell.cost is not None else []
    write_header(sheet, 3, heads, [8, 14, 10, *cost, 26, 16, *[34] * len(shown)])
    for row, result in enumerate(front, 4):
        does = [
            ", ".join(a.task for a in result.schedule.of(name)) or "–"
            for name in front.cell.operators
        ]
        write_row(
            sheet,
            row,
            [
                row - 3,
                result.makespan,
                result.stress,
                *([result.cost] if result.cost is not None else []),
                status(result, t),
                result.schedule.digest,
                *does,
            ],
            bold=len(front) > 1 and result is front.knee,
        )
    below = [f"{t('front.knee')}: {front.results.index(front.knee) + 1}"] if len(front) > 1 else []
    below += doubt(front, t) if len(front) > 1 else []
    if len(front) and front.shown(point) is not front.knee:
        below.append(f"{t('plan.shown')}: {point}")
    for row, says in enumerate([*below, *([t("summary.stale")] if stale else [])], len(front) + 5):
        put(sheet, row, 1, says)
    sheet.freeze_panes = "B4"


def _risk(book: Workbook, front: Front, t: Words) -> None:
    """What the plans risk where times scatter."""
    sheet, rows = book.create_sheet(t("sheet.risk")), risk_values(front)
    write_title(sheet, t("risk.title"))
    write_header(sheet, 3, risk_heads(front, t), [8, *[16] * (len(rows[0]) - 1)])
    for number, row in enumerate(rows, 4):
        write_row(sheet, number, row)
    spread(sheet, len(rows) + 5, risk_note(front, t), len(rows[0]))
    sheet.freeze_panes = "B4"


def _plan_title(result: Result, place: int, t: Words) -> str:
    return t(
        "plan.title",
        n=place,
        makespan=t.seconds(result.makespan),
        stress=t.number(result.stress),
    )


def _plan(book: Workbook, result: Result, place: int, t: Words) -> None:
    """The steps of one plan, and below them the balance of its operators."""
    cell, schedule = result.cell, result.schedule
    sheet = book.create_sheet(t("sheet.plan", n=place))
    write_title(sheet, _plan_title(result, place, t))
    keys = ("task", "who", "start", "end", "stress", "slack")
    write_header(
        sheet,
        3,
        [t("plan.step.task"), *(t(f"plan.step.{key}") for key in keys[1:])],
        [36, 24, 11, 11, 11, 11],
    )
    critical, free, shown = (
        {link.assignment.task for link in critical_path(cell, schedule)},
        slack(cell, schedule),
        looks(cell),
    )
    for row, a in enumerate(schedule, 4):
        mode = mode_of(cell, a)
        load = float(sum(map(exact, mode.stress.values()))) if mode and mode.stress else None
        late: Any = t("plan.step.critical") if a.task in critical else free[a.task]
        write_row(
            sheet,
            row,
            [
                named(cell, a.task),
                " + ".join(shown[o].label for o in a.operators),
                a.start,
                a.end,
                load,
                late,
            ],
            bold=a.task in critical,
        )
    _balance(sheet, len(schedule) + 6, cell, schedule, t)
    sheet.freeze_panes = "B4"


def _balance(sheet: Worksheet, top: int, cell: Cell, schedule: Schedule, t: Words) -> None:
    keys = ("operator", "kind", "busy", between(cell), "break", "idle", "stress")
    put(sheet, top - 1, 1, t("balance.title"), bold=True)
    write_header(sheet, top, [t(f"balance.{key}") for key in keys], [])
    busy, swaps, free = working(cell, schedule), changing(cell, schedule), idle(cell, schedule)
    loads, total = stress_by_human(cell, schedule), makespan(schedule)
    for row, (name, look) in enumerate(looks(cell).items(), top + 1):
        off = exact(total) - exact(busy[name]) - exact(swaps[name]) - exact(free[name])
        write_row(
            sheet,
            row,
            [
                look.label,
                t(look.kind),
                busy[name],
                swaps[name],
                max(float(off), 0.0),
                free[name],
                loads.get(name),
            ],
        )
    if told := used_of_limits(cell, schedule):
        top += len(cell.operators) + 3
        put(sheet, top - 1, 1, t("limits.title"), bold=True)
        write_header(sheet, top, limit_heads(t), [])
        for row, one in enumerate(told, top + 1):
            write_row(sheet, row, [*one, one.value / one.most if one.most else None])


def _gantt(book: Workbook, result: Result, place: int, t: Words) -> None:
    """One row an operator, one column a slot of time; a task is a merged, coloured cell."""
    from openpyxl.styles import Alignment, Font

    cell, schedule = result.cell, result.schedule
    sheet = book.create_sheet(t("sheet.gantt", n=place))
    write_title(sheet, _plan_title(result, place, t))
    slot = slot_seconds(result.makespan)
    count = max(ceil(round(result.makespan / slot, 6)), 1)
    sheet.column_dimensions["A"].width = 20
    width = max(min(PAGE / count, 8), 1.0)
    for column in range(2, count + 2):
        sheet.column_dimensions[letter(column)].width = width
        sheet.cell(3, column).border = edge()
    every = max(round(count / 12), 1)
    for column in range(0, count, every):
        axis = sheet.cell(3, column + 2, plain(round(column * slot, 3)))
        axis.font, axis.alignment = Font(name=FONT, size=9), Alignment(horizontal="left")
        sheet.merge_cells(
            start_row=3,
            end_row=3,
            start_column=column + 2,
            end_column=min(column + every, count) + 1,
        )
    for row, (name, look) in enumerate(looks(cell).items(), 4):
        put(sheet, row, 1, look.label, bold=True)
        sheet.row_dimensions[row].height = 34
        for start, end in cell.operators[name].breaks:
            _bar(sheet, row, start, min(end, result.makespan), slot, count, BREAK, "", "mediumGray")
        for a in schedule.of(name):
            _bar(
                sheet,
                row,
                a.start,
                a.end,
                slot,
                count,
                look.colour.lstrip("#"),
                named(cell, a.task),
                "",
            )
    put(sheet, len(cell.operators) + 5, 1, t("sheet.slot", seconds=t.number(slot)))
    sheet.freeze_panes = "B4"


def slot_seconds(total: float) -> float:
    """Seconds for one column, so that there are at most `MOST_SLOTS` of them."""
    return next((step for step in STEPS if total / step <= MOST_SLOTS), total / MOST_SLOTS)


def _bar(
    sheet: Worksheet,
    row: int,
    start: float,
    end: float,
    slot: float,
    count: int,
    colour: str,
    label: str,
    pattern: str,
) -> None:
    from openpyxl.styles import Alignment, Font, PatternFill

    first, last = round(start / slot), max(round(end / slot), round(start / slot) + 1)
    first, last = min(first, count - 1), min(last, count)
    if last <= first or start >= end:
        return
    taken = sheet.cell(row, first + 2)
    if type(taken).__name__ == "MergedCell" or taken.value is not None:
        return  # shorter than a column, and the column is taken
    taken.fill = PatternFill(pattern or "solid", fgColor=colour)
    if label:
        ink = (
            "FFFFFF"
            if contrast(f"#{colour}", "#FFFFFF") >= contrast(f"#{colour}", "#1A1A1A")
            else "1A1A1A"
        )
        taken.value, taken.data_type, taken.font = label, "s", Font(name=FONT, size=10, color=ink)
        taken.alignment = Alignment(horizontal="center", vertical="center", wrap_text=True)
    for column in range(first + 2, last + 2):
        sheet.cell(row, column).border = edge()
    if last - first > 1:
        sheet.merge_cells(start_row=row, end_row=row, start_column=first + 2, end_column=last + 1)


def _instructions(book: Workbook, result: Result, operator: str, plan: str, t: Words) -> None:
    look = looks(result.cell)[operator]
    sheet = book.create_sheet(sheet_name(book, look.label))
    write_title(sheet, t("steps.title", who=look.label))
    found = steps(result.cell, result.schedule, operator, t)
    if not found:
        put(sheet, 4, 1, t("steps.none"))
        return
    shown = columns(found)
    write_header(sheet, 3, [t(f"steps.{key}") for key in shown], [WIDTHS[key] for key in shown])
    for row, step in enumerate(found, 4):
        write_row(sheet, row, [said(step, key) for key in shown])
    spread(sheet, 2, " ".join(rules(result.cell, operator, t)), len(shown))
    put(sheet, len(found) + 5, 1, origin(result, operator, plan, t))
    sheet.page_setup.fitToHeight = 1 if len(found) <= ON_A_PAGE else 0


def said(step: Row, key: str) -> Any:
    """What stands in a column of an instruction sheet; of the conditions, the one expected last in
    bold.
    """
    from openpyxl.cell.rich_text import CellRichText, TextBlock
    from openpyxl.cell.text import InlineFont

    if key != "begin":
        value = getattr(step, key)
        return "\n".join(value) if isinstance(value, tuple) else value
    bold, pieces = InlineFont(rFont=FONT, sz=11, b=True), []
    for place, condition in enumerate(step.begin):
        line = ("\n" if place else "") + condition.says
        pieces.append(TextBlock(bold, line) if condition.last else line)
    return CellRichText(pieces)
