"""`tandem compare`: what changed between two cells, or between two plans."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from tandem.cell.written import number
from tandem.cli.options import AS_JSON, check_time
from tandem.cli.what_if import difference_lines
from tandem.errors import CellError, UsageError


@click.command("compare")
@click.argument("before_file", metavar="BEFORE", type=click.Path(dir_okay=False))
@click.argument("after_file", metavar="AFTER", type=click.Path(dir_okay=False))
@click.option(
    "--point",
    type=int,
    help=(
        "For results: the point of both fronts, counted from 1; the recommended compromise when"
        " absent."
    ),
)
@click.option(
    "--plan/--no-plan",
    "planned",
    default=True,
    show_default=True,
    help="For cells: plan both, and say what becomes of each point of the front.",
)
@click.option(
    "--time-limit",
    type=float,
    default=20.0,
    show_default=True,
    help="Seconds for planning each cell.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the search.")
@AS_JSON
def compare_command(
    before_file: str,
    after_file: str,
    point: int | None,
    planned: bool,
    time_limit: float,
    seed: int,
    as_json: bool,
) -> None:
    """Say what changed between two cells, or between two results of `tandem plan --json`.

    \b
    Examples:
      tandem compare cell.yaml faster-robot.yaml
      tandem compare monday.json tuesday.json --point 1
    """
    check_time(time_limit, None)
    results = [_result_document(Path(name)) for name in (before_file, after_file)]
    if (results[0] is None) != (results[1] is None):
        raise UsageError(
            f"{before_file} and {after_file} are a cell and a result: give two cells or two"
            " results."
        )
    if results[0] is not None and results[1] is not None:
        _tell_stale(before_file, after_file)
        _compare_results(results[0], results[1], (before_file, after_file), point, as_json)
        return
    _compare_cells(before_file, after_file, planned, time_limit, seed, as_json)


def _tell_stale(*names: str) -> None:
    """Of results that lie in a project, whether their cell has changed since."""
    from tandem.report.project import stale_at_home

    for name in dict.fromkeys(names):
        if stale_at_home(Path(name)):
            click.echo(f"{name}: stale: made for another state of the cell.", err=True)


def _compare_cells(
    before_file: str, after_file: str, planned: bool, time_limit: float, seed: int, as_json: bool
) -> None:
    from tandem.explain.compare import compare_cells
    from tandem.explain.fronts import changes
    from tandem.files.load import load
    from tandem.plan.methods import plan

    before, after = load(before_file), load(after_file)
    found = compare_cells(before, after)
    fronts = (
        [plan(cell, time_limit=time_limit, seed=seed) for cell in (before, after)]
        if planned and found
        else []
    )
    moved = changes(*fronts) if fronts else ()
    if as_json:
        document = {
            "schema_version": 1,
            "kind": "cells",
            "digests": [before.digest, after.digest],
            "changes": [change.to_dict() for change in found],
        }
        _print(
            {
                **document,
                "front_changes": [change.to_dict() for change in moved],
                "complete": all(front.complete for front in fronts),
            }
        )
        return
    click.echo("\n".join(map(str, found)) if found else "the two cells are the same.")
    if fronts:
        click.echo("")
        click.echo("\n".join(difference_lines(*fronts)))


def _compare_results(
    before: dict[str, Any],
    after: dict[str, Any],
    files: tuple[str, str],
    point: int | None,
    as_json: bool,
) -> None:
    from tandem.explain.compare import compare_schedules
    from tandem.schedule.model import Schedule

    places = [
        _point_of(document, point, name, file)
        for document, name, file in zip(
            (before, after), ("the first", "the second"), files, strict=True
        )
    ]
    rows = [
        document["front"][place] for document, place in zip((before, after), places, strict=True)
    ]
    moves = compare_schedules(*(Schedule.from_list(row["assignments"]) for row in rows))
    moved = [move for move in moves if move.changed]
    if as_json:
        values = [
            {"makespan": row["makespan"], "stress": row["stress"], "point": place + 1}
            for row, place in zip(rows, places, strict=True)
        ]
        same = before.get("cell_digest") == after.get("cell_digest")
        _print(
            {
                "schema_version": 1,
                "kind": "results",
                "same_cell": same,
                "before": values[0],
                "after": values[1],
                "tasks": [m.to_dict() for m in moves],
            }
        )
        return
    if before.get("cell_digest") != after.get("cell_digest"):
        click.echo("the two results belong to different cells, or to different versions of one.")
    times, loads = ([number(row[key]) for row in rows] for key in ("makespan", "stress"))
    click.echo(f"makespan {times[0]} s -> {times[1]} s, stress {loads[0]} -> {loads[1]}")
    click.echo(
        "\n".join(map(str, moved))
        if moved
        else "every task is done by the same operators at the same time."
    )
    if moved and len(moved) < len(moves):
        click.echo(f"{len(moves) - len(moved)} of {len(moves)} tasks stay as they were.")


def _print(document: dict[str, Any]) -> None:
    click.echo(json.dumps(document, ensure_ascii=False))


def _result_document(path: Path) -> dict[str, Any] | None:
    """The result document in a file, or None when it holds something else.

    Raises CellError for one that means to be a result and is damaged.
    """
    from tandem.report.results import is_result, read_result

    try:
        document = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return None
    return read_result(path) if is_result(document) else None


def _point_of(document: dict[str, Any], point: int | None, name: str, file: str) -> int:
    """Which point of the front is meant, from 0; `name` and `file` are for messages."""
    from tandem.plan.result import knee_index
    from tandem.report.results import points_of

    try:
        values = points_of(document)
    except CellError as error:
        raise CellError([fault.at(file) for fault in error.faults]) from None
    rows = document["front"]
    if point is None:
        return knee_index(values)
    if not 1 <= point <= len(rows):
        raise UsageError(
            f"--point {point}: {name} front has {len(rows)} point{'s' * (len(rows) != 1)}, counted"
            " from 1."
        )
    return point - 1
