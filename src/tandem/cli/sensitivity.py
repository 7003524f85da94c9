"""`tandem sensitivity`: which task time moves the front most."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cell.written import number, signed
from tandem.cli.columns import aligned
from tandem.cli.options import AS_JSON, CELL, FORMAT, check_time
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.explain.sensitivity import Effect, Sensitivity


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
        click.echo(json.dumps(found.to_dict(), ensure_ascii=False))
    else:
        click.echo("\n".join(_effect_lines(found)))
    return 130 if found.interrupted else 0


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
                f"{number(effect.floor)} s ({signed(effect.seconds)} s)",
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
