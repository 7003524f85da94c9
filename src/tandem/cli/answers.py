"""`tandem explain`, `tandem compare`, `tandem sensitivity`: why a plan is so, what changed, and
what would help.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cell.written import number, signed
from tandem.cli.options import FORMAT
from tandem.errors import CellError, UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.explain.bottleneck import Bottleneck
    from tandem.explain.explanation import TaskAnswer
    from tandem.explain.sensitivity import Effect, Sensitivity
    from tandem.plan.result import Front

CELL = click.argument("cell_file", metavar="CELL", type=click.Path(allow_dash=True))
AS_JSON = click.option(
    "--json", "as_json", is_flag=True, help="Print one document on stdout and nothing else there."
)


class Percent(click.ParamType):  # type: ignore[type-arg,unused-ignore]
    """ "-10%", "+5 %"."""

    name = "PERCENT"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        if isinstance(value, float):
            return value
        try:
            return float(str(value).replace("−", "-").removesuffix("%")) / 100
        except ValueError:
            self.fail(f"{value!r} is no percentage such as -10%.", param, ctx)


@click.command("explain")
@CELL
@FORMAT
@click.option("--task", help="Only this task.")
@click.option(
    "--point",
    type=int,
    help="A point of the front, counted from 1; the recommended compromise when absent.",
)
@click.option(
    "--time-limit",
    type=float,
    default=17.0,
    show_default=True,
    help="Seconds for everything; what is not proven by then says so.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the search.")
@click.option(
    "--workers", type=int, help="Threads that plan at the same time; one per core when absent."
)
@AS_JSON
def explain_command(
    cell_file: str,
    form: str | None,
    task: str | None,
    point: int | None,
    time_limit: float,
    seed: int,
    workers: int | None,
    as_json: bool,
) -> None:
    """Say why a schedule is as it is, and what every other choice would cost.

    \b
    Examples:
      tandem explain cell.yaml
      tandem explain cell.yaml --task 4 --point 1

    Each cost is that of a schedule found by planning anew with the other choice forced.
    """
    from tandem.explain.explanation import explain
    from tandem.files.load import load

    check_time(time_limit, workers)
    cell = load(cell_file, form)
    show = None if as_json else Telling(point)
    found = explain(
        cell,
        task=task,
        point=point,
        time_limit=time_limit,
        seed=seed,
        workers=workers,
        on_answer=show,
    )
    if as_json:
        click.echo(json.dumps(found.to_dict(), ensure_ascii=False))


class Telling:
    """Prints each answer as it comes."""

    def __init__(self, point: int | None):
        self.point = point

    def __call__(self, answer: Front | Bottleneck | TaskAnswer) -> None:
        from tandem.explain.bottleneck import Bottleneck, sentences
        from tandem.explain.explanation import TaskAnswer, chosen_point, heading

        if isinstance(answer, TaskAnswer):
            lines = answer.sentences()
        elif isinstance(answer, Bottleneck):
            lines = [*sentences(answer), ""]
        else:
            lines = [heading(answer, chosen_point(answer, self.point)), ""]
        click.echo("\n".join(lines))


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


@click.command("sensitivity")
@CELL
@FORMAT
@click.option(
    "--change",
    "shares",
    type=Percent(),
    multiple=True,
    default=("-10%",),
    show_default=True,
    help="How much longer or shorter; may be repeated.",
)
@click.option(
    "--each",
    is_flag=True,
    help="Change the time of one operator at a time, not all times of a task together.",
)
@click.option(
    "--time-limit", type=float, default=60.0, show_default=True, help="Seconds for everything."
)
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the search.")
@click.option("--workers", type=int, help="Processes; one per core when absent.")
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Draw a tornado chart: .svg, .png or .pdf.",
)
@click.option("-q", "--quiet", is_flag=True, help="No progress on stderr.")
@AS_JSON
def sensitivity_command(
    cell_file: str,
    form: str | None,
    shares: tuple[float, ...],
    each: bool,
    time_limit: float,
    seed: int,
    workers: int | None,
    output: Path | None,
    quiet: bool,
    as_json: bool,
) -> int:
    """Say which task time, made shorter or longer, moves the front most.

    \b
    Examples:
      tandem sensitivity cell.yaml
      tandem sensitivity cell.yaml --change -20% --change +20% -o tornado.svg

    Each change is planned anew, in parallel processes.
    """
    from tandem.draw.saving import PICTURES
    from tandem.explain.sensitivity import sensitivity
    from tandem.files.load import load

    check_time(time_limit, workers)
    if output is not None and output.suffix.lower() not in PICTURES:
        raise UsageError(f"-o {output}: a picture's name ends in {', '.join(PICTURES)}.")
    cell = load(cell_file, form)
    with Counting(quiet) as counting:
        found = sensitivity(
            cell,
            shares,
            each=each,
            time_limit=time_limit,
            seed=seed,
            workers=workers,
            on_done=counting,
        )
    if output is not None:
        _draw(found, output)
        click.echo(f"wrote {output}", err=True)
    if as_json:
        _print(found.to_dict())
    else:
        click.echo("\n".join(_effect_lines(found)))
    return 130 if found.interrupted else 0


# --- what if --------------------------------------------------------------------------------------


def variant_options(command: Any) -> Any:
    """The options `--set`, `--without` and `--force` of a command that plans a variant; its
    arguments `sets`, `without` and `force`.
    """
    for option in (
        click.option(
            "--force",
            multiple=True,
            metavar="TASK=OPERATOR",
            help="Have the task done so and not otherwise: 5=human, 5=human+robot.",
        ),
        click.option(
            "--without",
            multiple=True,
            metavar="OPERATOR",
            help="Plan as if this operator were not there.",
        ),
        click.option(
            "--set",
            "sets",
            multiple=True,
            metavar="PATH=VALUE",
            help="Plan with another value: tasks.6.time.robot=8, or =-10%, or =none.",
        ),
    ):
        command = option(command)
    return command


def tell_difference(base: Cell, front: Front, plan_base: Callable[[], Front]) -> None:
    """Prints what the variant changed in the cell, and what becomes of each point of the base's
    front.
    """
    from tandem.errors import InfeasibleError, NothingFoundError
    from tandem.explain.compare import compare_cells

    click.echo("")
    click.echo(
        "\n".join(
            [
                "compared with the cell as it is:",
                *(f"  {change}" for change in compare_cells(base, front.cell)),
            ]
        )
    )
    try:
        click.echo("\n".join(difference_lines(plan_base(), front)))
    except InfeasibleError:
        click.echo("the cell as it is has no schedule at all.")
    except NothingFoundError:
        click.echo("no schedule of the cell as it is was found within the limit.")


def difference(base: Cell, front: Front, plan_base: Callable[[], Front]) -> dict[str, Any]:
    """What `tell_difference` says, for programs: the changes of the cell, and of each point of the
    base's front.

    `base` is None, and `points` empty, when the cell as it is has no schedule or none was found;
    `why` says which.
    """
    from tandem.errors import InfeasibleError, NothingFoundError
    from tandem.explain.compare import compare_cells
    from tandem.explain.fronts import changes

    found: dict[str, Any] = {
        "cell": [change.to_dict() for change in compare_cells(base, front.cell)],
        "base": None,
        "points": [],
    }
    try:
        before = plan_base()
    except InfeasibleError:
        return {**found, "why": "infeasible"}
    except NothingFoundError:
        return {**found, "why": "nothing found"}
    points = [[row["makespan"], row["stress"]] for row in before.to_dict()["front"]]
    found["base"] = {
        "cell": base.name,
        "cell_digest": base.digest,
        "complete": before.complete,
        "front": points,
    }
    return {**found, "points": [change.to_dict() for change in changes(before, front)]}


def difference_lines(base: Front, other: Front) -> list[str]:
    """A table: for each point of the base, what the other front offers at the same stress and in
    the same time.
    """
    from tandem.explain.fronts import changes

    table: list[tuple[str, ...]] = [
        ("point", "makespan", "stress", "at the same stress", "in the same time")
    ]
    for place, change in enumerate(changes(base, other), 1):
        time, load = change.makespan_then, change.stress_then
        faster = (
            "not possible" if time is None else f"{number(time)} s ({_signed(change.seconds)} s)"
        )
        easier = (
            "not possible"
            if load is None
            else f"stress {number(load)} ({_signed(change.more_stress)})"
        )
        table.append(
            (str(place), f"{number(change.makespan)} s", f"{number(change.stress)}", faster, easier)
        )
    lines = aligned(table)
    points = ", ".join(f"({number(time)} s, {number(load)})" for time, load in other.points)
    lines.append(f"front then: {points}{'' if other.complete else ', not complete'}")
    if not (base.complete and other.complete):
        lines.append("not everything is proven: the differences are between what was found.")
    return lines


# --- showing --------------------------------------------------------------------------------------


class Counting:
    """Progress on stderr: a bar in a terminal, else a line now and then."""

    def __init__(self, quiet: bool):
        self.quiet = quiet
        self.bar: Any = None
        self.row: Any = None

    def __enter__(self) -> Counting:
        from rich.console import Console
        from rich.progress import Progress

        console = Console(stderr=True)
        if not self.quiet and console.is_terminal and not console.is_dumb_terminal:
            self.bar = Progress(console=console, transient=True)
            self.bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self.bar is not None:
            self.bar.stop()

    def __call__(self, done: int, of: int) -> None:
        if self.bar is not None:
            self.row = (
                self.bar.add_task("planning anew", total=of) if self.row is None else self.row
            )
            self.bar.update(self.row, completed=done)
        elif not self.quiet and (done == of or done % max(of // 4, 1) == 0):
            click.echo(f"{done} of {of} planned", err=True)


def _effect_lines(found: Sensitivity) -> list[str]:
    table: list[tuple[str, ...]] = [("task", "change", "least makespan", "front")]
    for effect in found.effects:
        if effect.gain is None or effect.seconds is None or effect.floor is None:
            table.append(
                (
                    _effect_name(found, effect),
                    f"{effect.share:+.0%}",
                    "no schedule" if effect.proven else "none found",
                    "",
                )
            )
            continue
        mark = "" if effect.proven else " (not complete)"
        table.append(
            (
                _effect_name(found, effect),
                f"{effect.share:+.0%}",
                f"{number(effect.floor)} s ({_signed(effect.seconds)} s)",
                f"{effect.gain:+.1%}{mark}",
            )
        )
    base = (
        f"{len(found.front)} point{'s' * (len(found.front) != 1)}, least makespan"
        f" {number(found.front[0].makespan)} s"
    )
    return [
        (
            "the front of the cell as it is:"
            f" {base}{'' if found.front.complete else ' (not complete)'}"
        ),
        "",
        *aligned(table),
    ]


def _effect_name(found: Sensitivity, effect: Effect) -> str:
    label = found.front.cell.tasks[effect.task].label
    who = f" of {' + '.join(effect.operators)}" if effect.operators else ""
    return f"{effect.task}{f' {label}' if label else ''}{who}"


def _draw(found: Sensitivity, path: Path) -> None:
    from tandem.draw.saving import save
    from tandem.draw.tornado import plot_tornado

    rows: dict[str, dict[str, float]] = {}
    for effect in found.effects:
        rows.setdefault(f"task {_effect_name(found, effect)}", {})
    for effect in sorted(found.effects, key=lambda effect: effect.share):
        if effect.gain is not None:
            rows.setdefault(f"task {_effect_name(found, effect)}", {})[
                f"time {effect.share:+.0%}"
            ] = round(effect.gain * 100, 2)
    title = f"What moves the front: {found.front.cell.name or 'cell'}"
    save(
        plot_tornado(
            list(rows.items()), xlabel="area that the front dominates, change in %", title=title
        ),
        path,
    )


def aligned(rows: list[tuple[str, ...]]) -> list[str]:
    """Rows of a table in columns, the first row being the header."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return [
        "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def _signed(value: float | None) -> str:
    return "?" if value is None else signed(value)


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


def check_time(time_limit: float, workers: int | None) -> None:
    """Raises UsageError for a time limit or a number of workers that makes no sense."""
    if not time_limit > 0:
        raise UsageError(f"--time-limit {time_limit}: must be more than 0 seconds.")
    if workers is not None and workers < 1:
        raise UsageError(f"--workers {workers}: must be 1 or more.")
