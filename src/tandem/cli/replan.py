"""`tandem replan`: a stored plan, carried over into a cell that has changed, with as few changes as
can be.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Collection, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tandem.cli.columns import aligned
from tandem.cli.options import (
    AS_JSON,
    CELL,
    FORMAT,
    LANGUAGE,
    OUTPUTS,
    WORK,
    check_time,
    check_work,
    point_options,
)
from tandem.cli.outputs import (
    kept_when_interrupted,
    says_infeasible,
    source_of,
    tell_written,
    write_outputs,
)
from tandem.cli.what_if import variant_options
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.plan.replanned import Replanned
    from tandem.plan.result import Result
    from tandem.report.stored import StoredPlan


@click.command("replan")
@CELL
@FORMAT
@click.option(
    "--from",
    "plan_file",
    required=True,
    metavar="PLAN.json",
    type=click.Path(dir_okay=False, path_type=Path),
    help="The old plan: what `tandem plan --json` or `-o PLAN.json` wrote.",
)
@point_options
@click.option(
    "--done",
    multiple=True,
    metavar="TASK,...",
    help="Tasks that were done as planned: they stay where they are.",
)
@click.option(
    "--at",
    type=float,
    metavar="SECONDS",
    help="Now: what the old plan began before has started and stays, all else begins later.",
)
@click.option(
    "--keep", multiple=True, metavar="TASK,...", help="Tasks that keep their operators and start."
)
@click.option(
    "--allow",
    type=float,
    default=2.0,
    show_default=True,
    metavar="PERCENT",
    help="How far makespan and stress may be above the new optimum.",
)
@click.option(
    "--tolerance",
    type=float,
    default=5.0,
    show_default=True,
    metavar="SECONDS",
    help="By how much a start may move and still count as the same.",
)
@click.option(
    "--front",
    is_flag=True,
    help="For each number of changed tasks the least makespan, from as few as there can be.",
)
@click.option(
    "--time-limit",
    type=float,
    default=60.0,
    show_default=True,
    help="Seconds for everything; what is found by then is given with its bounds.",
)
@WORK
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the search.")
@click.option(
    "--workers", type=int, help="Threads; one per core when absent. With --work there is one."
)
@AS_JSON
@OUTPUTS
@variant_options
@LANGUAGE
@click.option("-q", "--quiet", is_flag=True, help="No progress on stderr.")
@says_infeasible
def replan_command(
    cell_file: str,
    form: str | None,
    plan_file: Path,
    point: int | None,
    makespan: float | None,
    stress: float | None,
    done: tuple[str, ...],
    at: float | None,
    keep: tuple[str, ...],
    allow: float,
    tolerance: float,
    front: bool,
    time_limit: float,
    work: float | None,
    seed: int,
    workers: int | None,
    as_json: bool,
    outputs: tuple[Path, ...],
    sets: tuple[str, ...],
    without: tuple[str, ...],
    force: tuple[str, ...],
    lang: str,
    quiet: bool,
) -> int:
    """Plan CELL anew and change as little of an old plan as can be.

    \b
    Examples:
      tandem replan cell.yaml --from plan.json
      tandem replan cell.yaml --from plan.json --point 2 --at 40 --keep 7 -o new.json
      tandem replan cell.yaml --from plan.json --front
      tandem replan cell.yaml --from plan.json --set tasks.6.time.robot=14 --without robot2

    With --set, --without or --force the variant is planned, not CELL as it stands in its file.

    Fewest tasks change operator; among those plans fewest change their order, then fewest begin at
    another time; then the makespan is least, then the stress. The new optimum, above which --allow
    counts, is the least makespan with at most the stress of the old plan.

    Exit code 4 when what is done, started or kept cannot stay where it is; the message says why.
    Ctrl-C ends the search: what was found is printed and saved, and the exit code is 130.
    """
    from tandem.explain.variant import variant
    from tandem.files.load import load
    from tandem.plan.least_change import replan
    from tandem.report.files import ready_to_write
    from tandem.report.language import words
    from tandem.report.progress import SolveProgress
    from tandem.report.stored import point_of

    check_work(work)
    check_time(time_limit, workers)
    files = list(outputs)
    ready_to_write(files)
    if front:
        _writes_a_table(files)
    cell = load(cell_file, form)
    is_variant = bool(sets or without or force)
    if is_variant:
        cell = variant(cell, sets, without, force)
    stored = _stored(plan_file, cell)
    old = stored.front[point_of(stored.front, point, makespan, stress)]
    known = {*cell.tasks, *(a.task for a in old.schedule)}
    with SolveProgress(quiet=quiet) as progress:
        found = replan(
            cell,
            old.schedule,
            stress=old.stress,
            done=_names(done, known),
            at=at,
            keep=_names(keep, known),
            allow=allow,
            tolerance=tolerance,
            front=front,
            time_limit=time_limit,
            work=work,
            seed=seed,
            workers=workers,
            on_solution=progress,
        )
    found = replace(found, source=source_of(cell_file, is_variant=is_variant))
    files += kept_when_interrupted(found, files, cell_file)
    write_outputs(found, files, lang)
    if stored.made_for not in (None, cell.digest):
        click.echo(words(lang)("replan.carried_over", file=plan_file), err=True)
    if as_json:
        click.echo(json.dumps(found.to_dict(), ensure_ascii=False))
    else:
        _show(found, old, front, lang)
    tell_written(files, lang)
    if found.interrupted:
        click.echo("interrupted: this is the best found so far, with its bounds.", err=True)
    return 130 if found.interrupted else 0


def _writes_a_table(files: Iterable[Path]) -> None:
    """Pictures and sheets show a front of time and stress, which a front of changes is not. Raises
    UsageError for files of another kind.
    """
    if other := [str(path) for path in files if path.suffix.lower() not in (".json", ".csv")]:
        raise UsageError(
            f"--front with -o {', '.join(other)}: change against time is written as .json or .csv."
            " Make sheets and pictures of the plan that you choose from it: tandem report"
            " FRONT.json --point N."
        )


def _stored(plan_file: Path, cell: Cell) -> StoredPlan:
    """The old plan with its own cell; where an earlier version wrote it without one, the cell as it
    is now has to do.
    """
    from tandem.report.results import read_result
    from tandem.report.stored import read_plan

    holds_its_cell = read_result(plan_file).get("cell_document") is not None
    return read_plan(plan_file, None if holds_its_cell else cell)


def _names(given: Iterable[str], known: Collection[str]) -> list[str]:
    """The tasks that options name, joined by commas; a name that holds a comma stands alone."""
    names: list[str] = []
    for text in given:
        names += [text] if text in known else filter(None, map(str.strip, text.split(",")))
    return names


# --- showing --------------------------------------------------------------------------------------


def _show(found: Replanned, old: Result, front: bool, lang: str) -> None:
    from rich.console import Console

    from tandem.report.language import words
    from tandem.report.replanned import about, about_the_plan, rows_of_the_front
    from tandem.report.terminal import GanttText

    t = words(lang)
    click.echo("\n".join(about(found, old, t)))
    if front:
        click.echo("\n".join(["", *aligned(rows_of_the_front(found, t))]))
        click.echo(t("replan.complete" if found.complete else "replan.incomplete"))
        return
    click.echo("\n".join(about_the_plan(found, t)))
    console = Console(file=sys.stdout, highlight=False)
    console.print(GanttText(found.cell, found[0].schedule, language=lang))
