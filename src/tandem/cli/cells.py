"""`tandem generate`, `tandem convert`, `tandem formats`, `tandem schema`: cells to try things on,
in and out of files.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from tandem.cell.names import clean
from tandem.cli.options import AS_JSON, FORMAT
from tandem.errors import UsageError
from tandem.files.formats.table import WRITERS

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.lab.yu2020.board import Board

OUTPUT = click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Cell file to write, .yaml or .json; YAML on stdout when absent.",
)

MOST_OF_A_LOT = 100
"""Products of one lot; longer lots are what `tandem dispatch --products` is for."""

PICTURE = click.option(
    "--picture",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Draw the board too: .svg, .png or .pdf.",
)


class Kinds(click.Group):
    """The commands of `generate`, and the name of any benchmark instance as one more."""

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        return super().get_command(ctx, cmd_name) or _instance_command(cmd_name)


def _instance_command(name: str) -> click.Command:
    @click.command(name, help=f"The benchmark instance {name} as a cell.")
    @OUTPUT
    def command(output: Path | None) -> None:
        from tandem.files.instances.named import instance

        _put(instance(name), output)

    return command


@click.group("generate", cls=Kinds, subcommand_metavar="KIND|NAME [OPTIONS]")
def generate() -> None:
    """Make a cell: random layers, Yu's chessboards, Yu's desk, or a benchmark instance by its name.

    With Tandem come the job shops ft06, ft10, ft20 (Fisher and Thompson 1963) and ta01 to ta80
    (Taillard 1993). All others are looked for in the folder that the environment variable
    TANDEM_BENCHMARKS names: NAME, or SET/NAME where several sets have one of that name.

    \b
    Examples:
      tandem generate layered --tasks 50 --humans 2 --seed 7 -o cell.yaml
      tandem generate desk | tandem plan -
      tandem generate ft06 | tandem plan - --minimize makespan
    """


@generate.command("layered")
@click.option("--tasks", type=int, default=20, show_default=True, help="How many tasks.")
@click.option("--humans", type=int, default=1, show_default=True, help="How many humans.")
@click.option("--robots", type=int, default=1, show_default=True, help="How many robots.")
@click.option(
    "--exclusive",
    type=float,
    default=0.3,
    show_default=True,
    help="Share of tasks that only humans or only robots can do.",
)
@click.option(
    "--density",
    type=float,
    default=0.2,
    show_default=True,
    help="Share of the layer before that a task waits for.",
)
@click.option(
    "--heterogeneity",
    type=float,
    default=0.5,
    show_default=True,
    help="How far times differ from operator to operator, 0 to 1.",
)
@click.option(
    "--layers", type=int, help="Number of layers; chosen from the number of tasks when absent."
)
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the draw.")
@OUTPUT
def layered_command(
    tasks: int,
    humans: int,
    robots: int,
    exclusive: float,
    density: float,
    heterogeneity: float,
    layers: int | None,
    seed: int,
    output: Path | None,
) -> None:
    """A random cell whose tasks lie in layers; the same numbers give the same cell."""
    from tandem.files.generators import layered

    try:
        cell = layered(
            tasks,
            humans,
            robots,
            exclusive=exclusive,
            density=density,
            heterogeneity=heterogeneity,
            layers=layers,
            seed=seed,
        )
    except ValueError as error:
        raise UsageError(str(error)) from error
    _put(cell, output)


@generate.command("chessboard")
@click.option("--height", type=int, default=15, show_default=True, help="Rows of the board.")
@click.option("--width", type=int, default=12, show_default=True, help="Columns of the board.")
@click.option("--human", type=int, default=15, show_default=True, help="Pieces for the human only.")
@click.option("--joint", type=int, default=10, show_default=True, help="Pieces for either.")
@click.option("--robot", type=int, default=20, show_default=True, help="Pieces for the robot only.")
@click.option(
    "--max-time",
    type=int,
    default=10,
    show_default=True,
    help="Times are whole seconds from 1 to one less.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the draw.")
@OUTPUT
@PICTURE
def chessboard_command(
    height: int,
    width: int,
    human: int,
    joint: int,
    robot: int,
    max_time: int,
    seed: int,
    output: Path | None,
    picture: Path | None,
) -> None:
    """A random board of Yu, Huang, Chang (2020) as a cell; the same numbers give the same board."""
    from tandem.lab.yu2020.board import random_board

    try:
        board = random_board(height, width, human, joint, robot, max_time, seed=seed)
    except ValueError as error:
        raise UsageError(str(error)) from error
    _put(board.to_cell(), output)
    _draw(board, picture)


@generate.command("desk")
@OUTPUT
@PICTURE
def desk_command(output: Path | None, picture: Path | None) -> None:
    """The height-adjustable desk of Yu, Huang, Chang (2020): 53 tasks."""
    from tandem.lab.yu2020.board import desk

    _put(desk().to_cell(), output)
    _draw(desk(), picture)


@generate.command("lot")
@click.argument("given", metavar="[NAME=]CELL...", nargs=-1, required=True)
@click.option(
    "--times",
    type=click.IntRange(1, MOST_OF_A_LOT),
    default=1,
    show_default=True,
    help="So many of each cell; they are then numbered.",
)
@OUTPUT
def lot_command(given: tuple[str, ...], times: int, output: Path | None) -> None:
    """Several products of one station in one cell, begun together: whoever is idle may begin the
    next one while others finish the last. Plan it, print it, or let `tandem dispatch` make it.

    Each product's tasks are named after it, such as `A-17/4`; products without a NAME are numbered.
    Operators, tools and zones must be the same in all cells.

    \b
    Examples:
      tandem generate lot cell.yaml --times 2 -o pair.yaml
      tandem generate lot A-17=short.yaml A-18=long.yaml -o both.yaml
    """
    from tandem.files.load import load
    from tandem.files.lot import lot

    named = _named(given, times)
    cells = {file: load(file) for file in dict.fromkeys(named.values())}
    _put(lot({name: cells[file] for name, file in named.items()}), output)


def _named(given: tuple[str, ...], times: int) -> dict[str, str]:
    """Product -> its file; numbers for those without a name. Raises UsageError with every fault."""
    wrong: list[str] = []
    named: dict[str, str] = {}
    for text in given * times:
        name, equals, file = text.partition("=")
        # a file whose own name has an equals sign in it is a file
        is_named = bool(equals) and not Path(text).exists()
        key = clean(name) if is_named else str(len(named) + 1)
        if is_named and times > 1:
            wrong.append(
                f"{text}: products of --times are numbered. Leave the name or --times out."
            )
        elif key in named:
            wrong.append(
                f"{text}: the name {key!r} was given twice, or is a number of another one."
            )
        named[key] = file if is_named else text
    if len(given) * times < 2:
        wrong.append("a lot needs two products at least; name another cell, or state --times 2.")
    if len(given) * times > MOST_OF_A_LOT:
        wrong.append(f"a lot of {len(given) * times}: at most {MOST_OF_A_LOT} products can be one.")
    if wrong:
        raise UsageError("\n".join(dict.fromkeys(wrong)))
    return named


@click.command("convert")
@click.argument("cell_file", metavar="CELL", type=click.Path(allow_dash=True))
@FORMAT
@click.option(
    "--to",
    metavar="NAME",
    help=(
        "What to write; told from the ending of -o when absent (.yaml, .json, .fjs, .jsp), else"
        f" yaml: {', '.join(WRITERS)}."
    ),
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="File to write; stdout when absent.",
)
def convert_command(cell_file: str, form: str | None, to: str | None, output: Path | None) -> None:
    """Turn a file of a public format into a cell file, or a cell into a public format.

    What decides which schedules there are is never lost: a cell that the other format cannot hold
    is refused, with every reason. What it leaves out though no schedule depends on it (stress,
    names) is said on stderr.

    \b
    Examples:
      tandem convert k1.fjs -o k1.yaml
      tandem convert instance.alb --format alb
      tandem convert cell.yaml -o cell.fjs
      tandem convert cell.yaml --to pyjobshop -o cell.json
    """
    from tandem.files.load import load

    _put(load(cell_file, form), output, to)


@click.command("formats")
@click.argument(
    "folder", required=False, type=click.Path(exists=True, file_okay=False, path_type=Path)
)
@AS_JSON
def formats_command(folder: Path | None, as_json: bool) -> None:
    """List the formats that are read and written; or read all files of a folder of benchmark sets,
    and say of each set how many are cells, and why the others are not.

    \b
    Examples:
      tandem formats
      tandem formats ../benchmarks
    """
    from tandem.cli.formats import survey, tell_formats

    if folder is None:
        tell_formats(as_json)
    else:
        survey(folder, as_json)


@click.command("schema")
@click.option(
    "--of",
    "what",
    type=click.Choice(["cell", "events", "decisions", "rotation"]),
    default="cell",
    show_default=True,
    help="Cell files, the lines of `tandem dispatch`, or what `tandem rotate --json` prints.",
)
def schema_command(what: str) -> None:
    """Print the JSON Schema of cell files, for editors that check while you type; of a shift's
    events and decisions; or of a job rotation.
    """
    if what == "cell":
        from tandem.files.schema import schema_text

        click.echo(schema_text(), nl=False)
    elif what == "rotation":
        from tandem.report.rotation import schema_text as rotation_schema_text

        click.echo(rotation_schema_text(), nl=False)
    else:
        from tandem.dispatch.shift.schema import schema_text as live_schema_text

        click.echo(live_schema_text(what), nl=False)


def _put(cell: Cell, output: Path | None, form: str | None = None) -> None:
    from tandem.files.load import dump, dumps

    if output is None:
        click.echo(dumps(cell, form or "yaml"), nl=False)
        return
    dump(cell, output, form)
    click.echo(
        f"wrote {output}: {len(cell.tasks)} tasks, {len(cell.operators)} operators.", err=True
    )


def _draw(board: Board, picture: Path | None) -> None:
    if picture is not None:
        from tandem.draw.saving import save
        from tandem.lab.yu2020.board_picture import plot_board

        click.echo(f"wrote {save(plot_board(board), picture)}", err=True)
