"""`tandem train`, `tandem evaluate`: agents that learn, beside the exact optimum."""

from __future__ import annotations

import datetime
import json
import shlex
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from tandem.cli.compiled import keep_compiled, needs_jax
from tandem.cli.options import FORMAT, FRONT_LIMIT
from tandem.cli.seeds import say_which_seed
from tandem.errors import CellError, Fault, UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.learn.algorithm import AnyRecipe
    from tandem.learn.training.trainer import TrainingProgress

A = TypeVar("A")
B = TypeVar("B")

FOLDER = click.Path(file_okay=False, path_type=Path)
PICTURE = click.Path(dir_okay=False, path_type=Path)
CELL_FILES = (".yaml", ".yml", ".json")
"""How the names of files end that are read as cells where a folder is named."""


class _Train(click.Command):
    """`train`, whose help lists the table of recipes, those that installed packages add
    included.
    """

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        from tandem.learn.training.recipes import RECIPES

        with formatter.section("Recipes"):
            formatter.write_dl(list(RECIPES.told(lambda recipe: recipe.what).items()))
        super().format_options(ctx, formatter)


@click.command("train", cls=_Train)
@click.argument("cell_file", metavar="[CELL]", required=False, type=click.Path(allow_dash=True))
@FORMAT
@click.option(
    "--recipe",
    "recipe_name",
    default="tandem",
    show_default=True,
    help="How to train: a name of the list above, or one of your own, package.module:recipe.",
)
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE",
    help="Change a number of the recipe, such as waiting=false; may be repeated.",
)
@click.option(
    "--people",
    metavar="SPEC",
    help="With `tandem` and `response`: beside whom, such as random:0.5 or population:FILE.",
)
@click.option(
    "--stress-factor",
    type=float,
    default=0.0,
    show_default=True,
    help="How much a unit of stress counts; a second counts 10.",
)
@click.option(
    "--seeds",
    type=click.IntRange(1, 1000),
    default=1,
    show_default=True,
    help="How many trainings, side by side.",
)
@click.option(
    "--first-seed",
    type=click.IntRange(0),
    default=0,
    show_default=True,
    help="The seeds are this one and those that follow.",
)
@click.option(
    "--run",
    "folder",
    type=FOLDER,
    help="Folder that the run is kept in; a new one under runs/ when absent.",
)
@click.option("--resume", type=FOLDER, metavar="RUN", help="Go on with a run that was stopped.")
@FRONT_LIMIT
@click.option(
    "--tensorboard", is_flag=True, help="Write TensorBoard events into the run's folder too."
)
@click.option(
    "--json",
    "as_json",
    is_flag=True,
    help="Print the result document on stdout and nothing else there.",
)
@click.option("-q", "--quiet", is_flag=True, help="No progress on stderr.")
def train_command(
    cell_file: str | None,
    form: str | None,
    recipe_name: str,
    settings: tuple[str, ...],
    people: str | None,
    stress_factor: float,
    seeds: int,
    first_seed: int,
    folder: Path | None,
    resume: Path | None,
    front_limit: float,
    tensorboard: bool,
    as_json: bool,
    quiet: bool,
) -> int:
    """Train on CELL by trial and error what decides who begins which task, beside the exact front.
    With the recipe `graph` CELL may be a folder of cells.

    What is learned serves `tandem evaluate`, `tandem simulate` and `tandem dispatch`.

    \b
    Examples:
      tandem train cell.yaml --stress-factor 5 --seeds 3
      tandem train cell.yaml --recipe alphazero --set simulations=64
      tandem train cell.yaml --recipe response --people random:0..1+pace:0.6..3
      tandem train cells/ --recipe graph
      tandem train --resume runs/my-run

    Ctrl-C saves; the exit code is then 130 and --resume goes on to the same end.
    """
    needs_jax("training")
    from tandem.learn.training import trainer
    from tandem.learn.training.recipes import changed, recipe

    if (cell_file is None) == (resume is None):
        raise UsageError(
            "give a CELL to train on, or --resume RUN to go on with a run; one of the two."
        )
    own_recipe = changed(
        recipe(recipe_name), [*settings, *([f"people={people}"] if people else [])]
    )
    cell, own_recipe = _to_train_on(cell_file, form, own_recipe)
    with _Bar(quiet) as bar:
        if resume is not None:
            document = trainer.resume(
                resume, tensorboard=tensorboard, on_progress=bar, on_notice=_notice
            )
        else:
            assert cell is not None
            document = trainer.train(
                cell,
                recipe_name=recipe_name,
                own_recipe=own_recipe,
                stress_factor=stress_factor,
                seeds=range(first_seed, first_seed + seeds),
                folder=folder,
                front_limit=front_limit,
                tensorboard=tensorboard,
                on_progress=bar,
            )
    if as_json:
        click.echo(json.dumps(document, ensure_ascii=False))
    else:
        _show_training(document)
    if document["interrupted"]:
        click.echo(
            f"interrupted and saved. Go on with: tandem train --resume {document['run']}", err=True
        )
        return 130
    return 0


def _to_train_on(
    cell_file: str | None, form: str | None, own_recipe: AnyRecipe
) -> tuple[Cell | None, AnyRecipe]:
    """The cell, None for none, and the recipe, which holds the other cells of a folder."""
    from dataclasses import replace

    from tandem.files.load import load
    from tandem.learn.graph.recipes import GraphRecipe

    if cell_file is None:
        return None, own_recipe
    if not Path(cell_file).is_dir():
        return load(cell_file, form), own_recipe
    if not isinstance(own_recipe, GraphRecipe):
        raise UsageError(
            f"{cell_file}: is a folder. Only the recipe graph trains on several cells; name a file,"
            " or add --recipe graph."
        )
    (_, first), *others = _cells_of(Path(cell_file), form)
    beside = tuple(one.to_dict() for _, one in others)
    return first, replace(own_recipe, beside=beside or None)


def _cells_of(folder: Path, form: str | None = None) -> list[tuple[str, Cell]]:
    """The cells of a folder and their files' names, in the order of these. Raises UsageError when
    it holds no cell file.
    """
    from tandem.files.load import load

    found = sorted(path for path in folder.iterdir() if path.suffix.lower() in CELL_FILES)
    if not found:
        raise UsageError(f"{folder}: holds no cell file ({', '.join(CELL_FILES)}).")
    named = [(path.name, path) for path in found]
    return list(_of_all(named, lambda path: load(str(path), form)).items())


def _of_all(named: Sequence[tuple[str, A]], one: Callable[[A], B]) -> dict[str, B]:
    """`one` of each file's.

    Raises CellError, or UsageError, with what is wrong with all of them; each file is named.
    """
    found, faults, misfits = dict[str, B](), list[Fault](), dict[str, list[str]]()
    for name, given in named:
        try:
            found[name] = one(given)
        except CellError as error:
            faults += [fault if fault.place else fault.at(name) for fault in error.faults]
        except UsageError as error:
            misfits.setdefault(str(error), []).append(name)
    if faults:
        others = (Fault(text, (), ", ".join(names)) for text, names in misfits.items())
        raise CellError(dict.fromkeys([*faults, *others]))
    if misfits:
        raise UsageError(
            "\n".join(
                # what is wrong with all is no matter of the files
                text if len(names) == len(named) else f"{', '.join(names)}: {text}"
                for text, names in misfits.items()
            )
        )
    return found


def _notice(text: str) -> None:
    click.echo(f"tandem: {text}", err=True)


class _Bar:
    """The training's progress on stderr: share done, and what the greedy policy of the first seed
    reaches.
    """

    def __init__(self, quiet: bool) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        console = Console(stderr=True)
        self.bar = Progress(
            TextColumn("training"),
            BarColumn(),
            TextColumn("{task.percentage:>3.0f} %  {task.description}"),
            TimeElapsedColumn(),
            console=console,
            disable=quiet,
        )
        self.task = self.bar.add_task("compiling", total=1.0)

    def __enter__(self) -> _Bar:
        self.bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.bar.stop()

    def __call__(self, progress: TrainingProgress) -> None:
        row = progress.rows[0]
        reached = (
            "not finished"
            if row["greedy_makespan"] is None
            else f"makespan {row['greedy_makespan']:g} s, stress {row['greedy_stress']:g}"
        )
        gap = "" if row["gap"] is None else f", {row['gap']:.1%} above the optimum"
        self.bar.update(self.task, completed=progress.share, description=f"greedy: {reached}{gap}")


def _show_training(document: dict[str, Any]) -> None:
    from rich.console import Console
    from rich.table import Table

    searched = any("searched" in row for row in document["seeds"])
    best = f"best of {document['seeds'][0]['best_of_n']['n']}"
    table = Table(
        "seed",
        "greedy makespan",
        "stress",
        "illegal",
        "gap",
        *["searched", "gap"] * searched,
        best,
        "gap",
        "steps",
        "CPU s",
    )
    for row in document["seeds"]:
        plays = [row[name] for name in ("searched", "best_of_n") if name in row]
        table.add_row(
            str(row["seed"]), *_figures(row["greedy"]), str(row["greedy"]["illegal"]),
            _share(row["greedy"]["gap"]),
            *(text for played in plays for text in (" / ".join(_figures(played)),
            _share(played["gap"]))), str(row["steps"]), f"{row['cpu_s']:.1f}",
        )  # fmt: skip
    console = Console(highlight=False)
    console.print(table)
    points = (
        ", ".join(f"({makespan:g} s, {stress:g})" for makespan, stress in document["exact_front"])
        or "not found in time"
    )
    console.print(
        f"exact front{'' if document['exact_front_complete'] else ' (not proven complete)'}:"
        f" {points}"
    )
    console.print(f"run: {document['run']}   look at it with: tandem evaluate {document['run']}")


@click.command("evaluate")
@click.argument("learned", metavar="RUN|POLICY", type=click.Path(path_type=Path))
@click.argument(
    "cell_file", metavar="[CELL|FOLDER]", required=False, type=click.Path(allow_dash=True)
)
@click.option("--seed", type=int, help="Which of the run's seeds; its best when absent.")
@click.option(
    "--episodes",
    type=click.IntRange(2, 100_000),
    default=100,
    show_default=True,
    help="Episodes of the sampled and the random player.",
)
@FRONT_LIMIT
@click.option(
    "--gantt", type=PICTURE, help="Draw the greedy schedule into this .svg, .png or .pdf."
)
@click.option(
    "--curves", type=PICTURE, help="Draw the training's curves into this .svg, .png or .pdf."
)
@click.option(
    "--report",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write the front with the players beside it: one HTML file.",
)
@click.option("--json", "as_json", is_flag=True, help="Print everything as one document.")
def evaluate_command(
    learned: Path,
    cell_file: str | None,
    seed: int | None,
    episodes: int,
    front_limit: float,
    gantt: Path | None,
    curves: Path | None,
    report: Path | None,
    as_json: bool,
) -> None:
    """Play what a RUN has learned, or one POLICY's file, beside the exact front, the best dispatch
    rule and a random player; on its own cell, on CELL, or on each cell of a FOLDER.

    \b
    Examples:
      tandem evaluate runs/my-run
      tandem evaluate runs/my-run cells/
      tandem evaluate policy-0.safetensors cells/ --json
      tandem evaluate runs/my-run --gantt greedy.svg --curves training.svg
    """
    from tandem.draw.saving import save
    from tandem.files.load import load

    keep_compiled()
    from tandem.learn.training.evaluate import evaluate

    if seed is None and not as_json:  # the document has it
        say_which_seed(str(learned))
    judge = partial(evaluate, learned, seed=seed, episodes=episodes, front_limit=front_limit)
    if cell_file and Path(cell_file).is_dir():
        if gantt or curves or report:
            raise UsageError("--gantt, --curves and --report are of one cell; name its file.")
        cells = _cells_of(Path(cell_file))
        _show_cells(_of_all(cells, judge), as_json)
        return
    found = judge(load(cell_file) if cell_file else None)
    greedy = found.line("greedy")
    if gantt:
        if greedy.schedule is None:
            raise UsageError(
                "--gantt: the greedy policy gives no schedule to draw"
                f" ({'; '.join(greedy.faults) or 'it did not finish'})."
            )
        from tandem.draw.gantt import plot_gantt

        save(plot_gantt(found.cell, greedy.schedule), gantt)
    if curves:
        from tandem.learn.training.pictures import plot_training
        from tandem.learn.training.runs import RunFolder

        if learned.is_file():
            raise UsageError(f"--curves: {learned} has no figures; name the run's folder.")
        rows = RunFolder(learned).figures()
        if not rows:
            raise UsageError(
                f"--curves: {learned} has no figures yet; they come with the first interval of the"
                " training."
            )
        save(plot_training(rows), curves)
    if report:
        _write_report(found, report)
    for picture in filter(None, (gantt, curves, report)):
        click.echo(f"wrote {picture}", err=True)
    if as_json:
        click.echo(json.dumps(found.to_dict(), ensure_ascii=False))
    else:
        _show_players(found)


def _show_cells(found: dict[str, Any], as_json: bool) -> None:
    """The gap of each player on each cell, and the mean over the cells in which it has one."""
    import numpy as np
    from rich.console import Console
    from rich.table import Table

    players = list(dict.fromkeys(_kind(line) for one in found.values() for line in one.lines))
    gaps = {
        name: {_kind(line): line.gap for line in one.lines if line.gap is not None}
        for name, one in found.items()
    }
    means = {
        player: float(np.mean(mine))
        for player in players
        if (mine := [row[player] for row in gaps.values() if player in row])
    }
    if as_json:
        cells = [{"file": name, **one.to_dict()} for name, one in found.items()]
        document = {"schema_version": 1, "cells": cells, "mean_gap": means}
        click.echo(json.dumps(document, ensure_ascii=False))
        return
    open_still = {name for name, one in found.items() if not (one.front and one.front.complete)}
    table = Table("gap to the exact optimum", *players)
    for name, row in [*gaps.items(), ("mean", means)]:
        shares = (_share(row.get(player)) for player in players)
        table.add_row(f"{name} *" if name in open_still else name, *shares)
    console = Console(highlight=False)
    console.print(table)
    if open_still:
        console.print("* its exact front is not proven complete; --front-limit gives it more time.")


def _kind(line: Any) -> str:
    """The player, all rules together: the best one is another in each cell."""
    player: str = line.player
    return "best rule" if player.startswith("rule ") else player


def _write_report(found: Any, path: Path) -> None:
    from tandem.report.html import write_html
    from tandem.report.players import Player

    if found.front is None:
        raise UsageError(
            "--report: there is no exact front to report; give it more time with --front-limit."
        )
    players = [
        Player(line.player, line.makespan, line.stress, line.gap, line.schedule)
        for line in found.lines
    ]
    command, today = shlex.join(["tandem", *sys.argv[1:]]), datetime.date.today().isoformat()
    write_html(found.front, path, command=command, date=today, players=players)


def _show_players(found: Any) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table("player", "makespan", "stress", "illegal", "finished", "gap to the exact optimum")
    for line in found.lines:
        time, stress = _figures({"makespan": line.makespan, "stress": line.stress})
        if line.makespan_ci95 is not None:
            time, stress = (
                f"{time} ± {line.makespan_ci95:.2g}",
                f"{stress} ± {line.stress_ci95:.2g}",
            )
        table.add_row(
            line.player,
            time,
            stress,
            f"{line.illegal:g}",
            f"{line.done:.0%}",
            _share(line.gap) + _beaten(line.beaten_by),
        )
    console = Console(highlight=False)
    console.print(table)
    greedy = found.line("greedy")
    if greedy.schedule is not None:
        from tandem.report.terminal import GanttText

        console.print(GanttText(found.cell, greedy.schedule))
    front = found.front
    points = (
        ", ".join(f"({makespan:g} s, {stress:g})" for makespan, stress in front.points)
        if front
        else "not found in time"
    )
    console.print(
        f"exact front{'' if front and front.complete else ' (not proven complete)'}: {points}   (±"
        " = 95 % interval of the mean)"
    )


def _figures(played: dict[str, Any]) -> tuple[str, str]:
    return (
        ("not finished", "-")
        if played["makespan"] is None
        else (f"{played['makespan']:g} s", f"{played['stress']:g}")
    )


def _beaten(point: tuple[float, float] | None) -> str:
    """What is said of a result that a point of the exact front beats in one number and matches in
    the other.
    """
    return "" if point is None else f", beaten by {point[0]:g} s / {point[1]:g}"


def _share(value: float | None) -> str:
    return "-" if value is None else f"{value:.1%}"
