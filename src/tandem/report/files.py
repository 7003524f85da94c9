"""A front as a file, by the ending of its name. Every file is whole or absent."""

from __future__ import annotations

import csv
import difflib
import io
import json
import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tandem.cell.written import number
from tandem.draw.figure import figure_for
from tandem.draw.front import plot_front
from tandem.draw.gantt import plot_gantt
from tandem.draw.graph import plot_graph
from tandem.draw.imprint import imprint
from tandem.draw.saving import save
from tandem.draw.style import task_label
from tandem.errors import UsageError
from tandem.files.atomic import store
from tandem.plan.cycle.result import CycleFront
from tandem.plan.result import Front
from tandem.report.html import write_html
from tandem.report.language import words
from tandem.schedule.critical import critical_path, slack
from tandem.schedule.measures import mode_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLUMNS = (
    "point", "makespan_s", "stress", "status", "bound_makespan_s", "bound_stress", "knee",
    "task", "label", "operators", "start_s", "end_s", "task_stress", "slack_s", "critical",
    "plan", "canonical", "shown", "stale",
)  # fmt: skip


def write(
    front: Front,
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
      point: whose schedule pictures, sheets and the MS Project file show, counted from 1; the
        recommended one when not given.
      stale: the cell has changed since; the file says so.

    Raises:
      UsageError: the name has none of these endings.
      OSError: the file cannot be written; nothing is left behind.
    """
    ending = Path(path).suffix.lower()
    if ending not in EXPORTERS:
        raise UsageError(_not_ready(Path(path)))
    EXPORTERS[ending].write(front, Path(path), About(command, date, language, point, stale))
    return Path(path)


def write_chart(
    front: Front,
    path: str | os.PathLike[str],
    chart: str,
    *,
    language: str = "en",
    point: int | None = None,
) -> Path:
    """Writes one chart alone as a picture, a line of `CHARTS`, and returns where.

    Args:
      point: whose schedule is shown, counted from 1; the recommended one when not given.

    Raises UsageError when there is no such chart, or no picture has this ending; OSError.
    """
    if chart not in CHARTS:
        raise UsageError(f"there is no chart {chart!r}. There are {', '.join(CHARTS)}.")
    result = front.shown(point)
    figure = figure_for(front.cell, result.schedule, kind=chart)
    CHARTS[chart](front, figure.axes[0], language, point)
    return save(figure, path, about=imprint(result, words(language)))


def _chart_of_front(front: Front, ax: Axes, language: str, point: int | None) -> None:
    plot_front(front, ax, language=language, point=point)


def _chart_of_plan(front: Front, ax: Axes, language: str, point: int | None) -> None:
    plot_gantt(front.cell, front.shown(point).schedule, ax, language=language)


def _chart_of_precedence(front: Front, ax: Axes, language: str, point: int | None) -> None:
    plot_graph(front.cell, ax, language=language)


CHARTS: dict[str, Callable[[Front, Axes, str, int | None], None]] = {
    "front": _chart_of_front,
    "gantt": _chart_of_plan,
    "graph": _chart_of_precedence,
}
"""Name -> what draws one chart alone."""


def ready_to_write(paths: Iterable[str | os.PathLike[str]]) -> None:
    """Asks, before a long search begins, whether `write` can write files of these names.

    Raises UsageError with everything that is wrong: an ending that says nothing, a folder that is
    missing or closed, a folder in place of a file.
    """
    if wrong := [fault for path in paths if (fault := _not_ready(Path(path)))]:
        raise UsageError("\n".join(wrong))


def _not_ready(path: Path) -> str:
    ending, folder = path.suffix.lower(), Path(os.path.realpath(path)).parent
    if ending not in EXPORTERS:
        near = difflib.get_close_matches(ending, EXPORTERS, n=1, cutoff=0.5)
        hint = f" Did you mean {near[0]}?" if near else ""
        return (
            f"{path}: cannot tell what to write from"
            f" {repr(ending) if ending else 'a name without an ending'}; use"
            f" {', '.join(EXPORTERS)}.{hint}"
        )
    if path.is_dir():
        return f"{path}: is a folder; name a file."
    if not folder.is_dir():
        return f"{path}: the folder {folder} does not exist; make it first or name another."
    if not path.exists() and not os.access(folder, os.W_OK | os.X_OK):
        return f"{path}: no permission to write into {folder}; name another folder."
    return ""


def to_json(front: Front | CycleFront, *, stale: bool = False) -> str:
    """The result document as text; with `stale` when the cell has changed since."""
    document = {**front.to_dict(), **({"stale": True} if stale else {})}
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def to_csv(front: Front, *, point: int | None = None, stale: bool = False) -> str:
    """One row for each task of each point, times in seconds, decimals with a point.

    A name that a spreadsheet would take for a formula gets an apostrophe in front, as spreadsheets
    themselves write it.
    """
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\r\n")
    writer.writerow(COLUMNS)
    writer.writerows(_rows(front, point, stale))
    return buffer.getvalue()


def _rows(front: Front, point: int | None, stale: bool) -> Iterator[list[str]]:
    knee, shown = (front.knee, front.shown(point)) if len(front) else (None, None)
    for place, result in enumerate(front, 1):
        path = {link.assignment.task for link in critical_path(front.cell, result.schedule)}
        slacks = slack(front.cell, result.schedule)
        values = [
            str(place),
            number(result.makespan),
            number(result.stress),
            str(result.status),
            number(result.bound.makespan),
        ]
        values += [number(result.bound.stress), yes(result is knee)]
        plan = [result.schedule.digest, yes(result.canonical), yes(result is shown), yes(stale)]
        for a in result.schedule:
            mode = mode_of(front.cell, a)
            load = number(sum(mode.stress.values())) if mode else ""
            names = [
                harmless(name)
                for name in (a.task, task_label(front.cell, a.task), " + ".join(a.operators))
            ]
            yield [
                *values,
                *names,
                number(a.start),
                number(a.end),
                load,
                number(slacks[a.task]),
                yes(a.task in path),
                *plan,
            ]


def table_bytes(text: str) -> bytes:
    """The text of a .csv file as its bytes."""
    # Excel takes a CSV file for the local 8-bit encoding unless it begins with this mark; plain
    # ASCII does without.
    return text.encode("ascii" if text.isascii() else "utf-8-sig")


def yes(value: bool) -> str:
    """As a table for programs says it."""
    return "yes" if value else "no"


def harmless(name: str) -> str:
    """A name that no spreadsheet takes for a formula."""
    risky = name[:1] in "=+@\t\r" or (
        name[:1] == "-" and not name[1:].replace(".", "", 1).isdecimal()
    )
    return "'" + name if risky else name


@dataclass(frozen=True)
class About:
    """What stands in an export beside the front: the command that made it, the day, the language,
    which point is shown, and whether the cell has changed since.
    """

    command: str
    date: str
    language: str
    point: int | None
    stale: bool

    @property
    def everywhere(self) -> dict[str, Any]:
        """As the arguments of a writer of reports."""
        return vars(self)

    @property
    def shown(self) -> dict[str, Any]:
        """As the arguments of a writer that tells neither command nor day."""
        return {key: value for key, value in vars(self).items() if key not in ("command", "date")}


def _write_json(front: Front, path: Path, about: About) -> None:
    store(path, to_json(front, stale=about.stale))


def _write_csv(front: Front, path: Path, about: About) -> None:
    store(path, table_bytes(to_csv(front, point=about.point, stale=about.stale)))


def _write_picture(front: Front, path: Path, about: About) -> None:
    from tandem.draw.overview import overview

    says = ""
    if len(front):
        says = imprint(front.shown(about.point), words(about.language), stale=about.stale)
    save(overview(front, **about.shown), path, about=says)


def _write_html(front: Front, path: Path, about: About) -> None:
    write_html(front, path, **about.everywhere)


def _write_workbook(front: Front, path: Path, about: About) -> None:
    from tandem.report.xlsx import xlsx

    store(path, xlsx(front, **about.everywhere))


def _write_project(front: Front, path: Path, about: About) -> None:
    from tandem.report.mspdi import mspdi

    result = front.shown(about.point)
    store(path, mspdi(result, language=about.language, stale=about.stale))


def _write_markdown(front: Front, path: Path, about: About) -> None:
    from tandem.report.markdown import markdown

    store(path, markdown(front, **about.everywhere))


@dataclass(frozen=True)
class Exporter:
    """A line of the table: what the file is, and what writes it, whole or not at all."""

    what: str
    write: Callable[[Front, Path, About], None]


PICTURE = "the front above one plan's Gantt chart"

EXPORTERS: dict[str, Exporter] = {
    ".json": Exporter("every number, for programs; the same in every language", _write_json),
    ".csv": Exporter("one row for each task of each point; the same in every language", _write_csv),
    ".svg": Exporter(PICTURE, _write_picture),
    ".png": Exporter(PICTURE, _write_picture),
    ".pdf": Exporter(PICTURE, _write_picture),
    ".html": Exporter("the report in one file that opens offline", _write_html),
    ".xlsx": Exporter("a workbook, which `tandem import` reads too", _write_workbook),
    ".xml": Exporter("one plan for MS Project", _write_project),
    ".md": Exporter("the report for wikis", _write_markdown),
}
"""How a file's name ends -> what is written there. A new exporter is a line here."""
