"""`tandem report`: a plan that was kept, in every form."""

from __future__ import annotations

import json
from pathlib import Path

import click

from tandem.cli.options import AS_JSON, FORMAT, LANGUAGE, OUTPUTS, point_options
from tandem.cli.stored import holds_cycles, stored_cycle, stored_plan
from tandem.errors import UsageError


@click.command("report")
@click.argument("plan_file", metavar="PLAN", type=click.Path(dir_okay=False, path_type=Path))
@click.argument("more", metavar="", nargs=-1, type=click.Path(dir_okay=False, path_type=Path))
@point_options
@click.option(
    "--cell",
    "cell_file",
    metavar="CELL",
    type=click.Path(),
    help="The cell as it is now, which the plan is to keep too; the file that PLAN names when"
    " absent.",
)
@FORMAT
@OUTPUTS
@LANGUAGE
@AS_JSON
def report_command(
    plan_file: Path,
    more: tuple[Path, ...],
    point: int | None,
    makespan: float | None,
    stress: float | None,
    cell_file: str | None,
    form: str | None,
    outputs: tuple[Path, ...],
    lang: str,
    as_json: bool,
) -> None:
    """Write reports, sheets, pictures and files of a plan as it was stored; nothing is planned.

    \b
    Examples:
      tandem report plan.json
      tandem report plan.json --point 2 -o sheets.xlsx slide.svg --lang de
      tandem report plan.json --makespan 30 --cell cell.yaml -o wiki.md

    PLAN is what `tandem plan CELL -o plan.json` wrote. Without -o the plan is shown in the
    terminal. A plan whose cell has changed since is stale: that is said, in the files too. Exit
    code 6 when a schedule breaks the cell that PLAN holds, or CELL. The cycles of a station that
    repeats, kept in the same way, are read too: --point and --stress choose among them.
    """
    from tandem.cli.outputs import show, tell_written, write_outputs
    from tandem.files.load import load
    from tandem.plan.choice import point_of
    from tandem.report.cycle import files as cycle_files
    from tandem.report.files import ready_to_write

    if more and not outputs:
        files = " ".join(map(str, more))
        raise UsageError(f"{files}: one PLAN is read; name files to write with -o {files}.")
    outputs = (*outputs, *more)
    of_cycles = holds_cycles(plan_file)
    if of_cycles and makespan is not None:
        raise UsageError(
            f"--makespan {makespan:g}: {plan_file} holds cycles; choose one with --point or"
            " --stress."
        )
    (cycle_files.ready_to_write if of_cycles else ready_to_write)(outputs)
    read = stored_cycle if of_cycles else stored_plan
    plan = read(plan_file, load(cell_file, form) if cell_file else None, lang)
    place = point_of(plan.front, point, makespan, stress) + 1
    if as_json:
        stale = {"stale": True} if plan.is_stale else {}
        click.echo(json.dumps({**plan.front.to_dict(), **stale}, ensure_ascii=False))
    elif not outputs:
        show(plan.front, False, lang, point=place, stale=plan.is_stale)
    write_outputs(plan.front, outputs, lang, point=place, stale=plan.is_stale)
    tell_written(outputs, lang)
