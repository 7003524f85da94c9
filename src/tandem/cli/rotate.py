"""`tandem rotate`: who works in whose place of a cell, period by period."""

from __future__ import annotations

import json
import shlex
import sys
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cli.options import AS_JSON, LANGUAGE, check_time
from tandem.cli.outputs import says_infeasible
from tandem.cli.stored import holds_cycles, is_plan, stored_plan
from tandem.errors import CellError, InfeasibleError, NothingFoundError, UsageError

if TYPE_CHECKING:
    from tandem.cell.measures import Measure
    from tandem.cell.model import Cell
    from tandem.plan.rotation import Rotated
    from tandem.schedule.model import Schedule
    from tandem.schedule.rotation import Shift

MOST_PERIODS = 48


@click.command("rotate", epilog="What is counted, and what is not: docs/ergonomics.md")
@click.argument("source", metavar="PLAN|CELL", type=click.Path(path_type=Path, dir_okay=False))
@click.option(
    "--people",
    "people_file",
    metavar="FILE",
    required=True,
    type=click.Path(path_type=Path, dir_okay=False, allow_dash=True),
    help="Who is there, what they can do, their limits: YAML or JSON.",
)
@click.option(
    "--periods",
    type=click.IntRange(1, MOST_PERIODS),
    help="Periods of equal length; those of the file of people when absent, or 4.",
)
@click.option(
    "--hours",
    type=click.FloatRange(0, 24, min_open=True),
    default=8.0,
    show_default=True,
    help="Work in the shift, without its breaks, where the file states no minutes.",
)
@click.option(
    "--cycles",
    type=click.IntRange(1),
    help=(
        "Products a shift, spread over the periods; when absent those that the cell states"
        " (cycles_per_shift), else as many as fit."
    ),
)
@click.option(
    "--measure",
    "measures",
    multiple=True,
    metavar="NAME",
    help=(
        "What is to be fair: dose:SCALE, peak:SCALE, time-above:SCALE:LEVEL, time-weighted:SCALE."
        " May be repeated, the first goes first; the cell's doses when absent, or dose:stress."
    ),
)
@click.option(
    "--point", type=int, help="A point of the plan's front; the recommended one when absent."
)
@click.option(
    "--time-limit",
    type=float,
    default=60.0,
    show_default=True,
    help="Seconds for the plan of a CELL, and again for the rotation.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Of the search.")
@click.option(
    "-o",
    "--output",
    "outputs",
    multiple=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write .xlsx, .csv, .md or .json; may be repeated.",
)
@AS_JSON
@LANGUAGE
@says_infeasible
def rotate_command(
    source: Path,
    people_file: Path,
    periods: int | None,
    hours: float,
    cycles: int | None,
    measures: tuple[str, ...],
    point: int | None,
    time_limit: float,
    seed: int,
    outputs: tuple[Path, ...],
    as_json: bool,
    lang: str,
) -> None:
    """Rotate people over the human roles of a cell, so that the one who bears most bears least.

    \b
    Examples:
      tandem rotate plan.json --people people.yaml --periods 4
      tandem rotate cell.yaml --people people.yaml --measure dose:duet -o rotation.xlsx --lang de

    PLAN is what `tandem plan CELL -o plan.json` wrote; a CELL is planned first. Each human of the
    plan is a role, filled by one person in each period. Of all rotations that keep everybody's
    limits this is one whose worst person bears least, then one with the least spread, then one in
    which people stay least; proven. Exit code 4 when the limits cannot be kept, with a smallest
    set of what cannot be kept together.
    """
    from tandem.files.crew import load_crew
    from tandem.plan.rotation import rotate
    from tandem.report import rotation as report
    from tandem.report.language import words
    from tandem.schedule.rotation import Shift, measures_of, rotation_measure, unfit

    check_time(time_limit, None)
    for output in outputs:
        report.check(output)
    file = load_crew(people_file)
    cell, schedule, each_s = _planned(source, point, time_limit, seed, lang)
    if cycles is None and cell.cycles_per_shift is not None:
        cycles = ceil(cell.cycles_per_shift)
    shift = Shift(
        cell, schedule, _periods(file.crew.minutes, periods, hours, each_s, cycles), file.crew,
        each_s,
    )  # fmt: skip
    if wrong := unfit(shift):
        raise CellError(file.placed(wrong))
    wanted = [rotation_measure(name, cell) for name in measures or measures_of(cell)]
    wanted = list(dict.fromkeys(wanted))
    effort: dict[str, Any] = {"time_limit": time_limit, "seed": seed}
    found = rotate(shift, wanted, **effort)
    told = report.Told(found, _staying(shift, wanted, effort), _made(source))
    t = words(lang)
    for output in outputs:
        report.write(t, told, output)
    if as_json:
        click.echo(json.dumps(report.document(told), ensure_ascii=False))
    else:
        click.echo(report.text(t, told))
    for output in outputs:
        click.echo(t("terminal.wrote", path=output), err=True)


def _periods(
    stated: tuple[float, ...] | None,
    periods: int | None,
    hours: float,
    each_s: float,
    cycles: int | None,
) -> Any:
    from tandem.schedule.rotation import periods_of

    if stated is not None and periods not in (None, len(stated)):
        raise UsageError(
            f"--periods {periods}: the file of people states the minutes of {len(stated)} periods."
            " Leave the option out, or correct the file."
        )
    number = periods or 4
    minutes = stated or (hours * 60 / number,) * number
    found = periods_of(minutes, each_s, cycles)
    if any(one.products < 1 for one in found):
        raise UsageError(
            f"a period of {min(minutes):g} min has not one whole product of {each_s:g} s. Take"
            " fewer periods, or longer ones."
        )
    return found


def _planned(
    source: Path, point: int | None, time_limit: float, seed: int, lang: str
) -> tuple[Cell, Schedule, float]:
    """The schedule of a stored plan, or of a cell that is planned now, and its makespan."""
    from tandem.files.load import load
    from tandem.plan.choice import point_of
    from tandem.plan.methods import plan

    if holds_cycles(source):
        raise UsageError(
            f"{source}: this is a plan of a station that repeats, whose products overlap. Give a"
            " plan of one product, and --cycles N for the products of a shift."
        )
    if is_plan(source):
        front = stored_plan(source, None, lang).front
    else:
        front = plan(load(source), time_limit=time_limit, seed=seed)
        if not len(front):
            raise NothingFoundError(f"{source}: no plan was found within {time_limit:g} s.")
    result = front[point_of(front, point)]
    return front.cell, result.schedule, result.makespan


def _staying(shift: Shift, wanted: list[Measure], effort: dict[str, Any]) -> Rotated | None:
    """The best without rotation; None when there is none."""
    from tandem.plan.rotation import rotate

    try:
        return rotate(shift, wanted, staying=True, **effort)
    except (InfeasibleError, NothingFoundError):
        return None


def _made(source: Path) -> dict[str, str]:
    from tandem import __version__

    plan = {"plan": str(source)} if is_plan(source) else {}
    return {"version": __version__, "command": shlex.join(["tandem", *sys.argv[1:]]), **plan}
