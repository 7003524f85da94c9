"""Where a front goes: to files, and to stdout as a document or for people."""

from __future__ import annotations

import datetime
import functools
import json
import shlex
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.errors import InfeasibleError, UsageError

if TYPE_CHECKING:
    from tandem.explain.bounds import ProofChain
    from tandem.plan.axes.search import AxesFront
    from tandem.plan.cycle.result import CycleFront
    from tandem.plan.result import Front


def source_of(cell_file: str, *, is_variant: bool) -> str | None:
    """The file that a plan names as its cell's. A variant stands in none, so that none can have
    changed since.
    """
    return None if is_variant or cell_file == "-" else cell_file


def kept_when_interrupted(
    front: Front | CycleFront | AxesFront, files: Iterable[Path], cell_file: str
) -> list[Path]:
    """Where an interrupted front is kept when no file was asked for that holds all of it."""
    if not front.interrupted or any(path.suffix == ".json" for path in files):
        return []
    name = "stdin" if cell_file == "-" else Path(cell_file).stem
    return [Path(f"{name}.interrupted.json")]


def write_outputs(
    front: Front | CycleFront,
    files: Iterable[Path],
    lang: str,
    *,
    point: int | None = None,
    stale: bool = False,
) -> None:
    """Writes the files, with the command and the day."""
    from tandem.plan.cycle.result import CycleFront
    from tandem.report.cycle.files import write as write_cycle
    from tandem.report.files import write

    about: dict[str, Any] = {
        "command": shlex.join(["tandem", *sys.argv[1:]]),
        "date": datetime.date.today().isoformat(),
        "language": lang,
        "point": point,
        "stale": stale,
    }
    for path in files:
        if isinstance(front, CycleFront):
            write_cycle(front, path, **about)
        else:
            write(front, path, **about)


def tell_written(files: Iterable[Path], lang: str) -> None:
    """Says on stderr which files were written."""
    from tandem.report.language import words

    for path in files:
        click.echo(words(lang)("terminal.wrote", path=path), err=True)


def says_infeasible(command: Callable[..., int | None]) -> Callable[..., int | None]:
    """The command, which with --json also prints what cannot be kept together when that is the
    answer: one document on stdout, the same in words on stderr, exit code 4.
    """

    @functools.wraps(command)
    def told(*arguments: Any, as_json: bool, **options: Any) -> int | None:
        try:
            return command(*arguments, as_json=as_json, **options)
        except InfeasibleError as error:
            if as_json:
                click.echo(json.dumps(error.to_dict(), ensure_ascii=False))
            raise

    return told


def show(
    front: Front | CycleFront,
    as_json: bool,
    lang: str = "en",
    *,
    point: int | None = None,
    stale: bool = False,
    explain_bound: bool = False,
) -> None:
    """The front on stdout: as the result document, or for people; with who proved what where that
    is asked for.
    """
    proofs = proofs_of(front) if explain_bound else None
    if as_json:
        more = {} if proofs is None else {"bounds": proofs.to_dict(lang)}
        click.echo(json.dumps({**front.to_dict(), **more}, ensure_ascii=False))
        return
    from rich.console import Console

    from tandem.plan.cycle.result import CycleFront
    from tandem.report.cycle.terminal import CycleView
    from tandem.report.terminal import FrontView

    view = (
        CycleView(front, language=lang, point=point, stale=stale)
        if isinstance(front, CycleFront)
        else FrontView(front, language=lang, point=point, stale=stale)
    )
    Console(file=sys.stdout, highlight=False).print(view)
    if proofs is not None:
        click.echo("\n".join(["", *proofs.sentences(lang)]))


def proofs_of(front: Front | CycleFront) -> ProofChain:
    """Who proved what of the front. Raises UsageError when it is one of cycles."""
    from tandem.explain.bounds import ProofChain
    from tandem.plan.cycle.result import CycleFront

    if isinstance(front, CycleFront):
        raise UsageError("--explain-bound is told of fronts of one product, without --cycle.")
    return ProofChain.of(front)
