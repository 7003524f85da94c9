"""Where a front goes: to files, and to stdout as a document or for people."""

from __future__ import annotations

import datetime
import json
import shlex
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from tandem.plan.result import Front


def source_of(cell_file: str, *, is_variant: bool) -> str | None:
    """The file that a plan names as its cell's. A variant stands in none, so that none can have
    changed since.
    """
    return None if is_variant or cell_file == "-" else cell_file


def kept_when_interrupted(front: Front, files: Iterable[Path], cell_file: str) -> list[Path]:
    """Where an interrupted front is kept when no file was asked for that holds all of it."""
    if not front.interrupted or any(path.suffix == ".json" for path in files):
        return []
    name = "stdin" if cell_file == "-" else Path(cell_file).stem
    return [Path(f"{name}.interrupted.json")]


def write_outputs(
    front: Front,
    files: Iterable[Path],
    lang: str,
    *,
    point: int | None = None,
    stale: bool = False,
) -> None:
    """Writes the files, with the command and the day."""
    from tandem.report.files import write

    for path in files:
        write(
            front,
            path,
            command=shlex.join(["tandem", *sys.argv[1:]]),
            date=datetime.date.today().isoformat(),
            language=lang,
            point=point,
            stale=stale,
        )


def tell_written(files: Iterable[Path], lang: str) -> None:
    """Says on stderr which files were written."""
    from tandem.report.language import words

    for path in files:
        click.echo(words(lang)("terminal.wrote", path=path), err=True)


def show(
    front: Front,
    as_json: bool,
    lang: str = "en",
    *,
    point: int | None = None,
    stale: bool = False,
) -> None:
    """The front on stdout: as the result document, or for people."""
    if as_json:
        click.echo(json.dumps(front.to_dict(), ensure_ascii=False))
        return
    from rich.console import Console

    from tandem.report.terminal import FrontView

    Console(file=sys.stdout, highlight=False).print(
        FrontView(front, language=lang, point=point, stale=stale)
    )


@click.command("check")
@click.argument("cell_file", metavar="CELL|PLAN|FOLDER", type=click.Path(allow_dash=True))
@click.argument(
    "result_file",
    metavar="[RESULT]",
    required=False,
    type=click.Path(dir_okay=False, path_type=Path),
)
@FORMAT
@click.option("--json", "as_json", is_flag=True, help="Print what was found as one document.")
def check_command(
    cell_file: str, result_file: Path | None, form: str | None, as_json: bool
) -> None:
    """Say whether CELL is sound and, with RESULT, whether its schedules keep to it; whether a
    stored PLAN keeps to the cell that it holds; of a project's FOLDER, which results are stale.

    \b
    Examples:
      tandem check cell.yaml
      tandem check cell.yaml plan.json
      tandem check plan.json
      tandem check line-3

    A result is stale when it was made for another state of the cell. Exit code 3 when the cell is
    not sound, 6 when a schedule breaks it.
    """
    from tandem.files.load import load
    from tandem.report.results import points_of, read_result, schedules_of, stale
    from tandem.report.stored import cell_in, faults_in, stale_note, stale_now

    if cell_file != "-" and Path(cell_file).is_dir():
        if result_file is not None:
            raise UsageError(
                f"{cell_file} is a folder: give a cell file with a result, or the folder alone."
            )
        return tell_folder(Path(cell_file), as_json)
    if result_file is None and is_plan(cell_file):
        result_file = Path(cell_file)
        document = read_result(result_file)
        cell, values = cell_in(document, result_file), points_of(document, cell_file)
        is_stale: bool | None = stale_now(document, result_file)[1]
    else:
        cell, values = load(cell_file, form), []
        document = read_result(result_file) if result_file else {"front": []}
        is_stale = stale(document, cell)
    found = faults_in(document, cell, values)
    if as_json:
        answer: dict[str, Any] = {
            "schema_version": 1,
            "cell": cell.name,
            "cell_digest": cell.digest,
        }
        if result_file:
            answer["stale"] = is_stale
            answer["plans"] = [schedule.digest for schedule in schedules_of(document)]
        wrong = [{"point": place, "fault": fault} for place, fault in found]
        click.echo(json.dumps({**answer, "faults": wrong}, ensure_ascii=False))
    if result_file and is_stale:
        click.echo(stale_note(result_file), err=True)
    if found:
        raise UnsoundScheduleError([f"schedule {place}: {fault}" for place, fault in found])
    if not as_json:
        click.echo(sound(cell, cell_file))
        count = len(document["front"])
        if count:
            whose = "the cell" if str(result_file) != cell_file else "the cell that it holds"
            click.echo(f"{result_file}: {count} schedule{'s' * (count != 1)}, none breaks {whose}.")
    return None


@click.command("methods")
@click.option("--json", "as_json", is_flag=True, help="Print them as one document.")
def methods_command(as_json: bool) -> None:
    """List the methods of planning."""
    from tandem.plan.methods import METHODS, describe

    if as_json:
        click.echo(
            json.dumps(
                {
                    "schema_version": 1,
                    "methods": [
                        {"name": name, "kind": "planning", "what": describe(name)}
                        for name in METHODS
                    ],
                }
            )
        )
        return
    width = max(map(len, METHODS))
    for name in METHODS:
        click.echo(f"{name:<{width}}  {describe(name)}")
