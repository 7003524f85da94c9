"""`tandem init`, and what `tandem check` says of a project's folder."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tandem.cli.sheets import tell_notes
from tandem.errors import CellError, UnsoundScheduleError, UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.report.project import Standing


@click.command("init")
@click.argument("folder", metavar="DIR", type=click.Path(file_okay=False, path_type=Path))
@click.option(
    "--from",
    "source",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Your workbook or cell file; the example when absent.",
)
@click.option(
    "--force", is_flag=True, help="Replace the files when they exist; results are never touched."
)
def init_command(folder: Path, source: Path | None, force: bool) -> None:
    """Lay out a small project: a cell, variants of it, and a place for results.

    \b
    Examples:
      tandem init line-3
      tandem init line-3 --from tasks.xlsx

    A workbook whose columns need a word of explanation: `tandem import` it first, and begin from
    the cell file.
    """
    from tandem.report.project import CELL, RESULTS, lay_out

    cell, text = _beginning(source)
    try:
        written = lay_out(folder, cell, text=text, force=force)
    except FileExistsError as error:
        raise UsageError(
            f"{error.filename}: is a file where a folder is needed. Choose another name."
        ) from error
    for path in written:
        click.echo(f"wrote {path}", err=True)
    cell_file, plan, page = (
        _as_typed(folder, name) for name in (CELL, f"{RESULTS}/plan.json", f"{RESULTS}/plan.html")
    )
    click.echo(f"next: tandem plan {cell_file} -o {plan} --report {page}", err=True)


def _as_typed(folder: Path, name: str) -> str:
    """The file as a command line would name it."""
    return shlex.quote((folder / name).as_posix())


def _beginning(source: Path | None) -> tuple[Cell, bytes | None]:
    """The cell to begin with and, of a YAML file, its text as it is."""
    from tandem.cell.model import Cell
    from tandem.files.load import load
    from tandem.files.spreadsheet.draft import read_workbook
    from tandem.files.spreadsheet.form import EXAMPLE
    from tandem.files.spreadsheet.workbook import ENDINGS

    if source is None:
        return Cell.model_validate(EXAMPLE), None
    if source.suffix.lower() in ENDINGS:
        draft = read_workbook(source)
        tell_notes(draft)
        return draft.cell(), None
    cell = load(source)
    return cell, source.read_bytes() if source.suffix.lower() in (".yaml", ".yml") else None


def tell_folder(folder: Path, as_json: bool) -> None:
    """Prints whether each cell of the project is sound, and whether each result is current or
    stale.

    Raises:
      CellError: a cell is not sound, or there is none; or a result is damaged.
      UnsoundScheduleError: a current result breaks the cell that it belongs to.
    """
    from tandem.report.project import Freshness, cells_of, standings

    cells = cells_of(folder)
    found = list(standings(folder, cells))
    if as_json:
        document = {
            "schema_version": 1,
            "cells": [
                {
                    "file": path.relative_to(folder).as_posix(),
                    "cell": c.name,
                    "cell_digest": c.digest,
                }
                for path, c in cells.items()
            ],
            "results": [_row(standing, folder) for standing in found],
        }
        click.echo(json.dumps(document, ensure_ascii=False))
    else:
        for path, cell in cells.items():
            click.echo(sound(cell, str(path), named=False))
        click.echo("\n".join(_line(standing, folder) for standing in found) or "no results yet.")
    old = sum(standing.state is Freshness.STALE for standing in found)
    if old:
        click.echo(
            f"{old} of {len(found)} results {'is' if old == 1 else 'are'} stale: made for another"
            " state of the cell. Plan anew.",
            err=True,
        )
    if damage := [fault for standing in found for fault in standing.damage]:
        raise CellError(damage)
    if any(standing.faults for standing in found):
        raise UnsoundScheduleError(
            [f"{standing.path}: {fault}" for standing in found for fault in standing.faults]
        )


def sound(cell: Cell, file: str, named: bool = True) -> str:
    """ "cell.yaml: sound; 7 tasks, 1 human, 1 robot."; by the cell's own name where it has one and
    `named` is set.
    """
    counts = [("human", len(cell.humans)), ("robot", len(cell.robots))]
    counts += [("machine", len(cell.machines))] if cell.machines else []
    people = ", ".join(f"{count} {kind}{'s' * (count != 1)}" for kind, count in counts)
    return (
        f"{(cell.name if named else '') or file}: sound; {len(cell.tasks)}"
        f" task{'s' * (len(cell.tasks) != 1)}, {people}."
    )


def _line(standing: Standing, folder: Path) -> str:
    from tandem.report.project import Freshness

    match standing.state:
        case Freshness.STALE:
            return f"{standing.path}: stale: made for another state of the cell"
        case Freshness.UNKNOWN:
            return f"{standing.path}: does not say which cell it belongs to"
        case Freshness.DAMAGED:
            return f"{standing.path}: damaged"
    assert standing.belongs_to is not None
    many = f"{standing.schedules} schedule{'s' * (standing.schedules != 1)}"
    judged = (
        ""
        if not standing.schedules
        else (
            f"; {many}, none breaks it"
            if not standing.faults
            else f"; {many}, {len(standing.faults)} faults"
        )
    )
    return (
        f"{standing.path}: current, of {standing.belongs_to.relative_to(folder).as_posix()}{judged}"
    )


def _row(standing: Standing, folder: Path) -> dict[str, object]:
    from tandem.report.project import Freshness

    return {
        "file": standing.path.relative_to(folder).as_posix(),
        "stale": {Freshness.STALE: True, Freshness.CURRENT: False}.get(standing.state),
        "belongs_to": (
            standing.belongs_to.relative_to(folder).as_posix() if standing.belongs_to else None
        ),
        "schedules": standing.schedules,
        "faults": [*standing.faults, *(fault.message for fault in standing.damage)],
    }
