"""`tandem crossplay`: the robots of one run beside the humans of another."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tandem.cli.compiled import keep_compiled
from tandem.cli.options import FRONT_LIMIT
from tandem.files.atomic import store

if TYPE_CHECKING:
    from tandem.learn.training.crossplay import CrossPlay, Mean
    from tandem.learn.training.evaluate import Line

FOLDER = click.Path(file_okay=False, path_type=Path)
WIDEST = 6
"""More policies are shown by runs; the documents have every pair."""


@click.command("crossplay")
@click.argument("runs", metavar="RUN...", nargs=-1, required=True, type=FOLDER)
@click.option(
    "--cell",
    "cell_file",
    metavar="CELL",
    type=click.Path(dir_okay=False, allow_dash=True),
    help="Another cell than the first run's own.",
)
@click.option(
    "--people",
    metavar="SPEC",
    default="compliant",
    show_default=True,
    help="Whose pace, fatigue and slips the humans have, such as pace:0.8..1.5.",
)
@click.option("--draw", is_flag=True, help="Draw actions instead of taking the most probable.")
@click.option(
    "--episodes",
    type=click.IntRange(2, 100_000),
    default=100,
    show_default=True,
    help="Of each pair, where people or actions are drawn.",
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the draws.")
@click.option(
    "--stress-factor", type=float, help="What a unit of stress counts; as trained when absent."
)
@FRONT_LIMIT
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False, path_type=Path), help="Every pair, as CSV."
)
@click.option("--json", "as_json", is_flag=True, help="Print everything as one document.")
@click.option("-q", "--quiet", is_flag=True, help="No progress on stderr.")
def crossplay_command(
    runs: tuple[Path, ...],
    cell_file: str | None,
    people: str,
    draw: bool,
    episodes: int,
    seed: int,
    stress_factor: float | None,
    front_limit: float,
    output: Path | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Play the robots of each policy beside the humans of each other one.

    RUN: folders of `tandem train`; all their seeds take part. What was trained together may play
    well together and with nobody else: that shows here.

    \b
    Examples:
      tandem crossplay runs/a runs/b
      tandem crossplay runs/a runs/b --people pace:0.8..1.5 --episodes 200 -o pairs.csv
      tandem crossplay runs/thesis --draw --json
    """
    from tandem.files.load import load

    keep_compiled()
    from tandem.learn.training.crossplay import crossplay

    found = crossplay(
        runs,
        load(cell_file) if cell_file else None,
        people=people,
        episodes=episodes,
        draws=draw,
        seed=seed,
        stress_factor=stress_factor,
        front_limit=front_limit,
        tell=lambda text: None if quiet else click.echo(text, err=True),
    )
    if output:
        store(output, _csv(found))
        click.echo(f"wrote {output}", err=True)
    if as_json:
        click.echo(json.dumps(found.to_dict(), ensure_ascii=False))
    else:
        _show(found)


def _csv(found: CrossPlay) -> str:
    """A line for each pair."""
    text = io.StringIO()
    pairs = found.to_dict()["pairs"]
    names = [
        name for name in pairs[0] if name not in ("player", "assignments", "faults", "beaten_by")
    ]
    writer = csv.DictWriter(text, names, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(pairs)
    return text.getvalue()


def _show(found: CrossPlay) -> None:
    from rich.console import Console
    from rich.table import Table

    console = Console(highlight=False)
    if len(found.partners) <= WIDEST:
        names = [partner.name for partner in found.partners]
        table = Table("robots of \\ humans of", *names)
        for name, row in zip(names, found.lines, strict=True):
            table.add_row(name, *map(_pair, row))
        console.print(table)
    means = Table("robots of", "humans of", "which", "pairs", "finished", "makespan", "gap [95 %]")
    for mean in found.means():
        time = "-" if mean.makespan is None else f"{mean.makespan:g} s"
        means.add_row(
            mean.robots,
            mean.humans,
            mean.which,
            str(mean.pairs),
            f"{mean.done:.0%}",
            time,
            _gap(mean),
        )
    console.print(means)
    front = found.front
    points = "not found in time"
    if front:
        points = ", ".join(f"({makespan:g} s, {stress:g})" for makespan, stress in front.points)
    complete = "" if front and front.complete else " (not proven complete)"
    console.print(f"exact front{complete}: {points}; gaps at stress factor {found.stress_factor:g}")


def _pair(line: Line) -> str:
    if line.makespan is None:
        return "not finished"
    half = "" if line.makespan_ci95 is None else f" ± {line.makespan_ci95:.2g}"
    ended = "" if line.done == 1 else f", {line.done:.0%} finished"
    gap = "" if line.gap is None else f", {line.gap:.1%}"
    return f"{line.makespan:g}{half} s / {line.stress:g}{gap}{ended}"


def _gap(mean: Mean) -> str:
    if mean.gap is None:
        return "-"
    if mean.gap_ci95 is None:
        return f"{mean.gap:.1%}"
    low, high = mean.gap_ci95
    return f"{mean.gap:.1%} [{low:.1%}, {high:.1%}]"
