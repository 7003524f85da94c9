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

from tandem.cell.written import number
from tandem.draw.saving import save
from tandem.draw.style import task_label
from tandem.errors import UsageError
from tandem.files.atomic import store
from tandem.plan.result import Front
from tandem.report.html import write_html
from tandem.schedule.critical import critical_path, slack
from tandem.schedule.measures import mode_of

COLUMNS = (
    "point", "makespan_s", "stress", "status", "bound_makespan_s", "bound_stress", "knee",
    "task", "label", "operators", "start_s", "end_s", "task_stress", "slack_s", "critical",
)  # fmt: skip


def write(
    front: Front,
    path: str | os.PathLike[str],
    *,
    command: str = "",
    date: str = "",
    language: str = "en",
) -> Path:
    """Writes the front as the ending of the name says, a line of `EXPORTERS`, and returns where.

    `command` and `date` are for the reports, `language` for them and the pictures.

    Raises:
      UsageError: the name has none of these endings.
      OSError: the file cannot be written; nothing is left behind.
    """
    ending = Path(path).suffix.lower()
    if ending not in EXPORTERS:
        raise UsageError(_not_ready(Path(path)))
    EXPORTERS[ending].write(front, Path(path), About(command, date, language))
    return Path(path)


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


def to_json(front: Front) -> str:
    """The result document as text."""
    return json.dumps(front.to_dict(), indent=2, ensure_ascii=False) + "\n"


def to_csv(front: Front) -> str:
    """One row for each task of each point, times in seconds, decimals with a point.

    A name that a spreadsheet would take for a formula gets an apostrophe in front, as spreadsheets
    themselves write it.
    """
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\r\n")
    writer.writerow(COLUMNS)
    writer.writerows(_rows(front))
    return buffer.getvalue()


def _rows(front: Front) -> Iterator[list[str]]:
    knee = front.knee if len(front) else None
    for place, result in enumerate(front, 1):
        path = {link.assignment.task for link in critical_path(front.cell, result.schedule)}
        slacks = slack(front.cell, result.schedule)
        point = [
            str(place),
            number(result.makespan),
            number(result.stress),
            str(result.status),
            number(result.bound.makespan),
        ]
        point += [number(result.bound.stress), "yes" if result is knee else "no"]
        for a in result.schedule:
            mode = mode_of(front.cell, a)
            load = number(sum(mode.stress.values())) if mode else ""
            names = [
                _harmless(name)
                for name in (a.task, task_label(front.cell, a.task), " + ".join(a.operators))
            ]
            yield [
                *point,
                *names,
                number(a.start),
                number(a.end),
                load,
                number(slacks[a.task]),
                "yes" if a.task in path else "no",
            ]


def _harmless(name: str) -> str:
    risky = name[:1] in "=+@\t\r" or (
        name[:1] == "-" and not name[1:].replace(".", "", 1).isdecimal()
    )
    return "'" + name if risky else name


@dataclass(frozen=True)
class About:
    """What stands in an export beside the front: the command that made it, the day, the
    language.
    """

    command: str
    date: str
    language: str


def _write_json(front: Front, path: Path, about: About) -> None:
    store(path, to_json(front))


def _write_csv(front: Front, path: Path, about: About) -> None:
    text = to_csv(front)
    # Excel takes a CSV file for the local 8-bit encoding unless it begins with this mark; plain
    # ASCII does without.
    store(path, text if text.isascii() else text.encode("utf-8-sig"))


def _write_picture(front: Front, path: Path, about: About) -> None:
    from tandem.draw.overview import overview

    save(overview(front, language=about.language), path)


def _write_html(front: Front, path: Path, about: About) -> None:
    write_html(front, path, command=about.command, date=about.date, language=about.language)


def _write_workbook(front: Front, path: Path, about: About) -> None:
    from tandem.report.xlsx import xlsx

    store(path, xlsx(front, command=about.command, date=about.date, language=about.language))


def _write_project(front: Front, path: Path, about: About) -> None:
    from tandem.report.mspdi import mspdi

    store(path, mspdi(front.knee, language=about.language))


def _write_markdown(front: Front, path: Path, about: About) -> None:
    from tandem.report.markdown import markdown

    text = markdown(front, command=about.command, date=about.date, language=about.language)
    store(path, text)


@dataclass(frozen=True)
class Exporter:
    """A line of the table: what the file is, and what writes it, whole or not at all."""

    what: str
    write: Callable[[Front, Path, About], None]


PICTURE = "the front above the recommended plan's Gantt chart"

EXPORTERS: dict[str, Exporter] = {
    ".json": Exporter("every number, for programs; the same in every language", _write_json),
    ".csv": Exporter("one row for each task of each point; the same in every language", _write_csv),
    ".svg": Exporter(PICTURE, _write_picture),
    ".png": Exporter(PICTURE, _write_picture),
    ".pdf": Exporter(PICTURE, _write_picture),
    ".html": Exporter("the report in one file that opens offline", _write_html),
    ".xlsx": Exporter("a workbook, which `tandem import` reads too", _write_workbook),
    ".xml": Exporter("the recommended plan for MS Project", _write_project),
    ".md": Exporter("the report for wikis", _write_markdown),
}
"""How a file's name ends -> what is written there. A new exporter is a line here."""
