"""A front of cycle times as a workbook: the points, of one of them the cycle and the load of each
operator, a sheet for each human, assumptions; and the cell itself, as `tandem import` reads it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tandem.draw.imprint import remarks
from tandem.draw.lanes import product_mark
from tandem.draw.style import looks
from tandem.plan.cycle.result import CycleFront, CycleResult
from tandem.report.cycle.sheet import (
    CycleStep,
    cycle_steps,
    sheet_columns,
    sheet_origin,
    sheet_rules,
    sheet_title,
)
from tandem.report.cycle.tables import LOAD, by_place, load_heads, load_of, load_rows
from tandem.report.cycle.told import (
    assumed,
    cost,
    idle,
    in_process,
    per_hour,
    status,
    title,
    which,
)
from tandem.report.language import Words, words
from tandem.report.sources import made
from tandem.report.tables import named
from tandem.report.workbook import (
    book_of,
    finished,
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
from tandem.report.xlsx import ON_A_PAGE, WIDTHS, said

if TYPE_CHECKING:
    from openpyxl import Workbook

ACROSS = {**WIDTHS, "at": 8, "until": 12, "product": 18}
"""Characters across the columns of an instruction sheet."""
SHARE = "0%"
"""How a workbook shows a share."""


def xlsx(
    front: CycleFront,
    *,
    command: str = "",
    date: str = "",
    language: str = "en",
    point: int | None = None,
    stale: bool = False,
) -> bytes:
    """The workbook as bytes; see `report.cycle.files.write`."""
    t = words(language)
    book, cell_sheets = book_of(front.cell, language)
    _points(book, front, t, point, stale)
    if len(front):
        result, place = front.shown(point), front.knee_place if point is None else point - 1
        named_so = title(front, place, t)
        _steps(book, result, named_so, t)
        name_plan(book, result, t, stale)
        _load(book, result, named_so, t)
        name_plan(book, result, t, stale)
        told = "; ".join([named_so, *remarks(result, t, stale=stale)])
        for operator, found in cycle_steps(result, t).items():
            _sheet(book, result, operator, found, told, t)
            name_on_paper(book, result, t, stale)
    write_made(book, assumed(front, t), made(front, t, command, date), t)
    return finished(book, cell_sheets)


def _points(book: Workbook, front: CycleFront, t: Words, point: int | None, stale: bool) -> None:
    sheet = book.create_sheet(t("sheet.front"))
    write_title(sheet, t("cycle.title", name=front.cell.name or t("unnamed")))
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
    price = [14] if front.cell.cost is not None else []
    write_header(sheet, 3, heads, [8, 14, 11, 14, 14, 12, *price, 40, 26, 16])
    for row, result in enumerate(front, 4):
        fewest = in_process(result, t)
        write_row(
            sheet,
            row,
            [
                row - 3,
                result.cycle_time,
                result.stress,
                per_hour(front, result),
                result.makespan,
                result.in_process if fewest.isdecimal() else fewest,
                *(each for each in [cost(front, result)] if each is not None),
                ", ".join(idle(result, t)),
                status(result, t),
                result.periodic.digest,
            ],
            bold=len(front) > 1 and row - 4 == front.knee_place,
        )
    below = [f"{t('front.knee')}: {front.knee_place + 1}"] if len(front) > 1 else []
    if len(front) and front.shown(point) is not front.knee:
        below.append(f"{t('plan.shown')}: {point}")
    below += [t("summary.stale")] if stale else []
    for row, says in enumerate(below, len(front) + 5):
        put(sheet, row, 1, says)
    if len(front):
        spread(sheet, len(front) + 6 + len(below), which(front, front.shown(point), t), len(heads))
    sheet.freeze_panes = "B4"


def _steps(book: Workbook, result: CycleResult, named_so: str, t: Words) -> None:
    """One row a task, in the order of the cycle: since its product's launch, and in the cycle."""
    periodic, shown = result.periodic, looks(result.cell)
    sheet = book.create_sheet(t("sheet.cycle.steps"))
    write_title(sheet, named_so)
    keys = ("task", "who", "start", "end", "place", "lap", "product", "stress")
    heads = [t(f"cycle.step.{key}") for key in keys]
    write_header(sheet, 3, heads, [36, 26, 14, 10, 14, 14, 10, 11])
    for row, a in enumerate(by_place(periodic), 4):
        write_row(
            sheet,
            row,
            [
                named(result.cell, a.task),
                " + ".join(shown[o].label for o in a.operators),
                a.start,
                a.end,
                periodic.position(a.start),
                periodic.lap(a.start),
                product_mark(-periodic.lap(a.start)),
                load_of(result, a),
            ],
        )
    sheet.freeze_panes = "B4"


def _load(book: Workbook, result: CycleResult, named_so: str, t: Words) -> None:
    sheet = book.create_sheet(t("sheet.cycle.load"))
    write_title(sheet, named_so)
    write_header(sheet, 3, load_heads(result.cell, t), [26, 12, 10, 11, 18, 11, 12, 12, 16])
    for row, values in enumerate(load_rows(result, t), 4):
        write_row(sheet, row, values)
        for column, key in enumerate(LOAD, 1):
            if key in ("used", "free"):
                sheet.cell(row, column).number_format = SHARE
    sheet.freeze_panes = "B4"


def _sheet(
    book: Workbook,
    result: CycleResult,
    operator: str,
    found: Sequence[CycleStep],
    told: str,
    t: Words,
) -> None:
    """A human's instructions for one cycle."""
    sheet = book.create_sheet(sheet_name(book, looks(result.cell)[operator].label))
    write_title(sheet, sheet_title(result, operator, t))
    if not found:
        put(sheet, 4, 1, t("cycle.sheet.none"))
        return
    shown = sheet_columns(found)
    heads, widths = [t(f"steps.{key}") for key in shown], [ACROSS[key] for key in shown]
    write_header(sheet, 3, heads, widths)
    for row, step in enumerate(found, 4):
        write_row(sheet, row, [said(step, key) for key in shown])
    spread(sheet, 2, " ".join(sheet_rules(result, operator, t)), len(shown))
    put(sheet, len(found) + 5, 1, sheet_origin(result, operator, told, t))
    sheet.page_setup.fitToHeight = 1 if len(found) <= ON_A_PAGE else 0
