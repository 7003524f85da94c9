"""A front as a file, by the ending of its name. Every file is whole or absent."""

from __future__ import annotations

import csv
import difflib
import io
import json
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

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
    """Writes the front and returns where.

    `.json` is the result document, `.csv` has one row for each task of each point, `.svg`, `.png`
    and `.pdf` show the front above the knee's Gantt chart, `.html` is the report, `.md` the same
    for wikis, `.xlsx` a workbook that `tandem import` reads too, `.xml` the knee's plan for MS
    Project. `command` and `date` are for the reports, `language` for them and the pictures; `.json`
    and `.csv` are the same in every language.

    Raises:
      UsageError: the name has none of these endings.
      OSError: the file cannot be written; nothing is left behind.
    """
    if Path(path).suffix.lower() not in ENDINGS:
        raise UsageError(_not_ready(Path(path)))
    ending = Path(path).suffix.lower()
    if ending == ".html":
        return write_html(front, path, command=command, date=date, language=language)
    if ending in REPORTS:
        store(path, REPORTS[ending](front, command, date, language))
    else:
        WRITERS[ending](front, path, language)
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
    if ending not in ENDINGS:
        near = difflib.get_close_matches(ending, ENDINGS, n=1, cutoff=0.5)
        hint = f" Did you mean {near[0]}?" if near else ""
        return (
            f"{path}: cannot tell what to write from"
            f" {repr(ending) if ending else 'a name without an ending'}; use"
            f" {', '.join(ENDINGS)}.{hint}"
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


def _write_json(front: Front, path: str | os.PathLike[str], _: str) -> None:
    store(path, to_json(front))


def _write_csv(front: Front, path: str | os.PathLike[str], _: str) -> None:
    text = to_csv(front)
    # Excel takes a CSV file for the local 8-bit encoding unless it begins with this mark; plain
    # ASCII does without.
    store(path, text if text.isascii() else text.encode("utf-8-sig"))


def _write_picture(front: Front, path: str | os.PathLike[str], language: str) -> None:
    from tandem.draw.overview import overview

    save(overview(front, language=language), path)


WRITERS: dict[str, Callable[[Front, Any, str], None]] = {
    ".json": _write_json,
    ".csv": _write_csv,
    ".svg": _write_picture,
    ".png": _write_picture,
    ".pdf": _write_picture,
}


def _workbook(front: Front, command: str, date: str, language: str) -> bytes:
    from tandem.report.xlsx import xlsx

    return xlsx(front, command=command, date=date, language=language)


def _project(front: Front, command: str, date: str, language: str) -> bytes:
    from tandem.report.mspdi import mspdi

    return mspdi(front.knee, language=language)


def _markdown(front: Front, command: str, date: str, language: str) -> str:
    from tandem.report.markdown import markdown

    return markdown(front, command=command, date=date, language=language)


REPORTS: dict[str, Callable[[Front, str, str, str], str | bytes]] = {
    ".xlsx": _workbook,
    ".xml": _project,
    ".md": _markdown,
}
ENDINGS = (*WRITERS, ".html", *REPORTS)
