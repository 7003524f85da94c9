"""A front of cycle times as a file, by the ending of its name. Every file is whole or absent."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from tandem.cell.written import number
from tandem.draw.imprint import imprint
from tandem.draw.saving import save
from tandem.draw.style import task_label
from tandem.errors import UsageError
from tandem.files.atomic import store
from tandem.plan.cycle.result import CycleFront
from tandem.report import files
from tandem.report.cycle.tables import load_of
from tandem.report.cycle.told import cost, per_hour
from tandem.report.files import About, harmless, table_bytes, to_json, yes
from tandem.report.language import words

COLUMNS = (
    "point", "cycle_time_s", "stress", "makespan_s", "in_process", "per_hour", "cost", "status",
    "bound_cycle_time_s", "bound_stress", "bound_in_process", "knee", "task", "label", "operators",
    "start_s", "end_s", "place_s", "lap", "task_stress", "cycle", "canonical", "shown", "stale",
)  # fmt: skip


def write(
    front: CycleFront,
    path: str | os.PathLike[str],
    *,
    command: str = "",
    date: str = "",
    language: str = "en",
    point: int | None = None,
    stale: bool = False,
) -> Path:
    """Writes the front as the ending of the name says, a line of `EXPORTERS`, and returns where.

    Args:
      command, date: for the reports.
      language: of reports and pictures.
      point: whose cycle pictures and sheets show, counted from 1; the recommended one when not
        given.
      stale: the cell has changed since; the file says so.

    Raises:
      UsageError: the name has none of these endings, or the form cannot hold what repeats.
      OSError: the file cannot be written; nothing is left behind.
    """
    target = Path(path)
    ready_to_write([target])
    EXPORTERS[target.suffix.lower()](front, target, About(command, date, language, point, stale))
    return target


def ready_to_write(paths: Iterable[str | os.PathLike[str]]) -> None:
    """Asks, before a long search begins, whether `write` can write files of these names. Raises
    UsageError with everything that is wrong.
    """
    wrong = [fault for path in paths if (fault := _not_ready(Path(path)))]
    if wrong:
        raise UsageError("\n".join(wrong))


def _not_ready(path: Path) -> str:
    if path.suffix.lower() in files.EXPORTERS and path.suffix.lower() not in EXPORTERS:
        return (
            f"{path}: MS Project knows no work that repeats in a cycle; write"
            f" {', '.join(EXPORTERS)} instead."
        )
    try:
        files.ready_to_write([path])
    except UsageError as error:
        return str(error)
    return ""


def to_csv(front: CycleFront, *, point: int | None = None, stale: bool = False) -> str:
    """One row for each task of each point, times in seconds, decimals with a point; `start_s` and
    `end_s` since the product's launch, `place_s` in the cycle.

    A name that a spreadsheet would take for a formula gets an apostrophe in front, as spreadsheets
    themselves write it.
    """
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\r\n")
    writer.writerow(COLUMNS)
    writer.writerows(_rows(front, point, stale))
    return buffer.getvalue()


def _rows(front: CycleFront, point: int | None, stale: bool) -> Iterator[list[str]]:
    shown = front.knee_place if point is None and len(front) else (point or 0) - 1
    for place, result in enumerate(front):
        bound, price = result.bound, cost(front, result)
        values = [
            str(place + 1),
            number(result.cycle_time),
            number(result.stress),
            number(result.makespan),
            str(result.in_process),
            number(per_hour(front, result)),
            "" if price is None else number(price),
            str(result.status),
            number(bound.cycle_time),
            number(bound.stress),
            str(bound.in_process),
            yes(place == front.knee_place),
        ]
        told = [
            result.periodic.digest,
            yes(result.canonical),
            yes(place == shown),
            yes(stale),
        ]
        for a in result.schedule:
            load = load_of(result, a)
            names = (a.task, task_label(front.cell, a.task), " + ".join(a.operators))
            yield [
                *values,
                *map(harmless, names),
                number(a.start),
                number(a.end),
                number(result.periodic.position(a.start)),
                str(result.periodic.lap(a.start)),
                "" if load is None else number(load),
                *told,
            ]


def _write_json(front: CycleFront, path: Path, about: About) -> None:
    store(path, to_json(front, stale=about.stale))


def _write_csv(front: CycleFront, path: Path, about: About) -> None:
    store(path, table_bytes(to_csv(front, point=about.point, stale=about.stale)))


def _write_picture(front: CycleFront, path: Path, about: About) -> None:
    from tandem.draw.cycle_overview import cycle_overview

    says = ""
    if len(front):
        says = imprint(front.shown(about.point), words(about.language), stale=about.stale)
    save(cycle_overview(front, **about.shown), path, about=says)


def _write_html(front: CycleFront, path: Path, about: About) -> None:
    from tandem.report.cycle.html import html

    store(path, html(front, **about.everywhere))


def _write_workbook(front: CycleFront, path: Path, about: About) -> None:
    from tandem.report.cycle.xlsx import xlsx

    store(path, xlsx(front, **about.everywhere))


def _write_markdown(front: CycleFront, path: Path, about: About) -> None:
    from tandem.report.cycle.markdown import markdown

    store(path, markdown(front, **about.everywhere))


EXPORTERS: dict[str, Callable[[CycleFront, Path, About], None]] = {
    ".json": _write_json,
    ".csv": _write_csv,
    ".svg": _write_picture,
    ".png": _write_picture,
    ".pdf": _write_picture,
    ".html": _write_html,
    ".xlsx": _write_workbook,
    ".md": _write_markdown,
}
"""How a file's name ends -> what writes it there, whole or not at all."""
