"""`tandem board`: a cell as a chessboard, and what the game on it takes at best."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cli.compiled import needs_jax
from tandem.cli.options import FORMAT

if TYPE_CHECKING:
    from tandem.lab.yu2020.board import Board

PLACE = 7
"""Characters of one place on the board."""


@click.command("board")
@click.argument("cell_file", metavar="CELL", type=click.Path(allow_dash=True))
@FORMAT
@click.option(
    "-o",
    "--output",
    multiple=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help="Picture to draw: .svg, .png or .pdf.",
)
@click.option(
    "--optimum",
    "proven",
    is_flag=True,
    help="Prove what the game takes at best, and what it would if agents might wait.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one document instead of the board.")
def board_command(
    cell_file: str, form: str | None, output: tuple[Path, ...], proven: bool, as_json: bool
) -> None:
    """Put a cell on the chessboard of Yu, Huang, Chang (2020), or say why it cannot be put there.

    \b
    Examples:
      tandem generate desk | tandem board - --optimum
      tandem board cell.yaml -o board.svg
    """
    from tandem.files.load import load
    from tandem.lab.yu2020.board import Board

    board = Board.of(load(cell_file, form))
    document: dict[str, Any] = {
        "schema_version": 1,
        "board": board.name,
        "height": board.height,
        "width": board.width,
        "pieces": [
            {
                "name": p.name,
                "row": p.row,
                "first": p.first,
                "last": p.last,
                "who": p.who.name.lower(),
                "time": p.time,
            }
            for p in board.pieces
        ],
    }
    if proven:
        needs_jax("the optimum of a board")
        document["optimum"] = {
            name: _proof(board, waiting)
            for name, waiting in (("no_waiting", False), ("waiting", True))
        }
    for file in output:
        from tandem.draw.saving import save
        from tandem.lab.yu2020.board_picture import plot_board

        save(plot_board(board), file)
        click.echo(f"wrote {file}", err=True)
    if as_json:
        click.echo(json.dumps(document, ensure_ascii=False))
        return
    click.echo(text_board(board), nl=False)
    for name, found in document.get("optimum", {}).items():
        click.echo(
            f"optimum {'with' if name == 'waiting' else 'without'} waiting: {found['makespan']} s"
            f" (proven, {found['states']:,} states)"
        )
        click.echo(f"  proven in {found['wall_s']} s", err=True)


def text_board(board: Board) -> str:
    """Rows from the top: name, who (R robot, H human, E either) and seconds of each piece over the
    columns that it covers.
    """
    lines = []
    margin = len(str(board.height))
    for row in range(board.height, 0, -1):
        line = [" "] * (board.width * PLACE + 1)
        for piece in board.pieces:
            if piece.row == row:
                left, right = (piece.first - 1) * PLACE, piece.last * PLACE
                words = f" {piece.who.name[0]}{piece.time}"
                room = right - left - 1
                line[left], line[right] = "|", "|"
                line[left + 1 : right] = (piece.name[: max(room - len(words), 0)] + words)[
                    :room
                ].center(room, "_")
        lines.append(f"{row:>{margin}} {''.join(line).rstrip()}\n")
    return "".join(lines)


def _proof(board: Board, waiting: bool) -> dict[str, Any]:
    from tandem.lab.yu2020.optimal import optimum

    began = time.perf_counter()
    found = optimum(board, waiting=waiting)
    return {
        "makespan": found.makespan,
        "states": found.states,
        "wall_s": round(time.perf_counter() - began, 3),
        "assignments": found.schedule.to_list(),
    }
