"""`tandem plan`, `tandem check`, `tandem methods`: the trade-off of a cell, and what is wrong with
a cell or a schedule.
"""

from __future__ import annotations

import datetime
import json
import shlex
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cli.answers import difference, tell_difference, variant_options
from tandem.cli.options import FORMAT, Weights
from tandem.cli.project import sound, tell_folder
from tandem.errors import CellError, Fault, UnsoundScheduleError, UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.plan.result import Front
    from tandem.schedule.model import Schedule


@click.command("plan")
@click.argument("cell_file", metavar="CELL", type=click.Path(allow_dash=True))
@FORMAT
@click.option(
    "--method", default="exact", show_default=True, help="How to plan; `tandem methods` lists them."
)
@click.option(
    "--minimize",
    type=click.Choice(["makespan", "stress"]),
    help="Only the one schedule that is best in this and, among those, in the other.",
)
@click.option(
    "--weights",
    type=Weights(),
    help="Only the one schedule with the least TIME * makespan (s) + STRESS * stress.",
)
@click.option("--max-stress", type=float, help="Only schedules of at most this stress.")
@click.option(
    "--max-makespan", type=float, help="Only schedules whose makespan is at most so many seconds."
)
@click.option(
    "--time-limit",
    type=float,
    default=60.0,
    show_default=True,
    help="Seconds; what is found by then is given with its bounds.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the search.")
@click.option(
    "--workers",
    type=int,
    help=(
        "Threads; one per core when absent. With 1, a run that ends before its limit repeats"
        " exactly."
    ),
)
@click.option(
    "--hint",
    type=click.Path(dir_okay=False, path_type=Path),
    help="A result document whose first schedule to begin with.",
)
@click.option(
    "--json",
    "as_json",
    is_flag=True,
    help="Print the result document on stdout and nothing else there.",
)
@click.option(
    "-o",
    "--output",
    "outputs",
    multiple=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help=(
        "Write .json, .csv, .svg, .png, .pdf, .html, .xlsx, .xml (MS Project) or .md; may be"
        " repeated."
    ),
)
@variant_options
@click.option(
    "--report",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write the report: one HTML file that opens offline.",
)
@click.option(
    "--lang",
    type=click.Choice(["en", "de"]),
    default="en",
    show_default=True,
    help=(
        "Language of the report, workbook, Markdown, MS Project file and pictures; what the"
        " terminal shows is English."
    ),
)
@click.option("-q", "--quiet", is_flag=True, help="No progress on stderr.")
def plan_command(
    cell_file: str,
    form: str | None,
    method: str,
    minimize: str | None,
    weights: tuple[float, float] | None,
    max_stress: float | None,
    max_makespan: float | None,
    time_limit: float,
    seed: int,
    workers: int | None,
    hint: Path | None,
    as_json: bool,
    outputs: tuple[Path, ...],
    report: Path | None,
    sets: tuple[str, ...],
    without: tuple[str, ...],
    force: tuple[str, ...],
    lang: str,
    quiet: bool,
) -> int:
    """Find every compromise between completion time and stress, with proof.

    \b
    Examples:
      tandem plan cell.yaml
      tandem plan cell.yaml --minimize makespan --json > result.json
      tandem plan cell.yaml --set tasks.6.time.robot=8 --without robot2 --force 5=human

    With --set, --without or --force the variant is planned, and what becomes of each point of
    CELL's own front is said.

    Ctrl-C ends the search: what was found so far is printed with its bounds and saved (in
    CELL.interrupted.json when no .json file was asked for), and the exit code is 130.
    """
    from tandem.explain.variant import variant
    from tandem.files.load import load
    from tandem.plan.methods import plan
    from tandem.plan.question import Question
    from tandem.report.files import ready_to_write, write
    from tandem.report.progress import SolveProgress

    if minimize and weights:
        raise UsageError("--minimize and --weights exclude each other: give one of them.")
    files = [*outputs, *([report] if report else [])]
    ready_to_write(files)
    kind = minimize or ("weighted" if weights else "front")
    question = Question(kind, weights or (1.0, 1.0), max_makespan, max_stress)  # type: ignore[arg-type]
    cell, base = load(cell_file, form), None
    if sets or without or force:
        base, cell = cell, variant(cell, sets, without, force)
    begin = _first_schedule(hint, cell) if hint else None
    with SolveProgress(quiet=quiet) as progress:
        front = plan(
            cell,
            question,
            method=method,
            time_limit=time_limit,
            seed=seed,
            workers=workers,
            hint=begin,
            on_solution=progress,
        )
    # a variant stands in no file, so that none can have changed since
    front = replace(front, source=cell_file if base is None and cell_file != "-" else None)
    if front.interrupted and not any(path.suffix == ".json" for path in files):
        name = "stdin" if cell_file == "-" else Path(cell_file).stem
        files.append(Path(f"{name}.interrupted.json"))
    for path in files:
        write(
            front,
            path,
            command=shlex.join(["tandem", *sys.argv[1:]]),
            date=datetime.date.today().isoformat(),
            language=lang,
        )
    if base is None or front.interrupted:
        show(front, as_json)
    else:
        _show_variant(
            base,
            front,
            as_json,
            lambda: plan(
                base, question, method=method, time_limit=time_limit, seed=seed, workers=workers
            ),
        )
    for path in files:
        click.echo(f"wrote {path}", err=True)
    if front.interrupted:
        click.echo("interrupted: this is the best found so far, with its bounds.", err=True)
    return 130 if front.interrupted else 0


def _show_variant(base: Cell, front: Front, as_json: bool, plan_base: Callable[[], Front]) -> None:
    """The front of a variant, and how it differs from that of the cell as it is: under `difference`
    in the document, or in words.
    """
    if as_json:
        click.echo(
            json.dumps(
                {**front.to_dict(), "difference": difference(base, front, plan_base)},
                ensure_ascii=False,
            )
        )
        return
    show(front, as_json)
    tell_difference(base, front, plan_base)


def show(front: Front, as_json: bool) -> None:
    """The front on stdout: as the result document, or for people."""
    if as_json:
        click.echo(json.dumps(front.to_dict(), ensure_ascii=False))
        return
    from rich.console import Console

    from tandem.report.terminal import FrontView

    Console(file=sys.stdout, highlight=False).print(FrontView(front))


@click.command("check")
@click.argument("cell_file", metavar="CELL|FOLDER", type=click.Path(allow_dash=True))
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
    """Say whether CELL is sound and, with RESULT, whether its schedules keep to it; of a project's
    FOLDER, which results are stale.

    \b
    Examples:
      tandem check cell.yaml
      tandem check cell.yaml result.json
      tandem check line-3

    A result is stale when it was made for another state of the cell. Exit code 3 when the cell is
    not sound, 6 when a schedule breaks it.
    """
    from tandem.files.load import load
    from tandem.report.results import read_result, schedules_of, stale
    from tandem.schedule.checker import faults

    if cell_file != "-" and Path(cell_file).is_dir():
        if result_file is not None:
            raise UsageError(
                f"{cell_file} is a folder: give a cell file with a result, or the folder alone."
            )
        return tell_folder(Path(cell_file), as_json)
    cell = load(cell_file, form)
    document = read_result(result_file) if result_file else {"front": []}
    found = [
        (place, faults(cell, schedule))
        for place, schedule in enumerate(schedules_of(document), start=1)
    ]
    if as_json:
        answer: dict[str, Any] = {
            "schema_version": 1,
            "cell": cell.name,
            "cell_digest": cell.digest,
        }
        if result_file:
            answer["stale"] = stale(document, cell)
        click.echo(
            json.dumps(
                {**answer, "faults": [{"point": p, "fault": f} for p, fs in found for f in fs]},
                ensure_ascii=False,
            )
        )
    if result_file and stale(document, cell):
        click.echo(f"{result_file}: stale: made for another state of the cell.", err=True)
    if any(wrong for _, wrong in found):
        raise UnsoundScheduleError(
            [f"schedule {place}: {fault}" for place, wrong in found for fault in wrong]
        )
    if not as_json:
        click.echo(sound(cell, cell_file))
        if found:
            click.echo(
                f"{result_file}: {len(found)} schedule{'s' * (len(found) != 1)}, none breaks the"
                " cell."
            )
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


def _first_schedule(path: Path, cell: Cell) -> Schedule:
    from tandem.report.results import read_result, schedules_of, stale

    document = read_result(path)
    schedules = schedules_of(document)
    if not schedules:
        raise CellError([Fault("holds no schedule.", (), str(path))])
    if stale(document, cell):
        click.echo(
            f"--hint {path}: stale: made for another state of the cell; what does not fit is not"
            " used.",
            err=True,
        )
    return schedules[0]
