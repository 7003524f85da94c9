"""Where a front goes: to files, and to stdout as a document or for people."""

from __future__ import annotations

import datetime
import json
import shlex
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from tandem.plan.result import Front


def source_of(cell_file: str, *, is_variant: bool) -> str | None:
    """The file that a plan names as its cell's. A variant stands in none, so that none can have
    changed since.
    """
    return None if is_variant or cell_file == "-" else cell_file


def kept_when_interrupted(front: Front, files: Iterable[Path], cell_file: str) -> list[Path]:
    """Where an interrupted front is kept when no file was asked for that holds all of it."""
    if not front.interrupted or any(path.suffix == ".json" for path in files):
        return []
    name = "stdin" if cell_file == "-" else Path(cell_file).stem
    return [Path(f"{name}.interrupted.json")]


def write_outputs(
    front: Front,
    files: Iterable[Path],
    lang: str,
    *,
    point: int | None = None,
    stale: bool = False,
) -> None:
    """Writes the files, with the command and the day."""
    from tandem.report.files import write

    for path in files:
        write(
            front,
            path,
            command=shlex.join(["tandem", *sys.argv[1:]]),
            date=datetime.date.today().isoformat(),
            language=lang,
            point=point,
            stale=stale,
        )


def tell_written(files: Iterable[Path], lang: str) -> None:
    """Says on stderr which files were written."""
    from tandem.report.language import words

    for path in files:
        click.echo(words(lang)("terminal.wrote", path=path), err=True)


def show(
    front: Front,
    as_json: bool,
    lang: str = "en",
    *,
    point: int | None = None,
    stale: bool = False,
) -> None:
    """The front on stdout: as the result document, or for people."""
    if as_json:
        click.echo(json.dumps(front.to_dict(), ensure_ascii=False))
        return
    from rich.console import Console

    from tandem.report.terminal import FrontView

    Console(file=sys.stdout, highlight=False).print(
        FrontView(front, language=lang, point=point, stale=stale)
    )
