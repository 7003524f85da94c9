"""`tandem times`: task times for tasks that nobody has timed yet."""

from __future__ import annotations

import json
import shlex
import sys
from pathlib import Path

import click

from tandem.cli.options import AS_JSON, LANGUAGE
from tandem.errors import CellError, UsageError


@click.command("times", epilog="Formulas, sources and errors: docs/ergonomics.md")
@click.argument(
    "facts_file", metavar="FILE", type=click.Path(path_type=Path, dir_okay=False, allow_dash=True)
)
@click.option(
    "--cell",
    "cell_file",
    type=click.Path(dir_okay=False, path_type=Path),
    help="A cell whose tasks get the times; with -o.",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write that cell with the times, rounded up to tenths of a second.",
)
@AS_JSON
@LANGUAGE
def times_command(
    facts_file: Path, cell_file: Path | None, output: Path | None, as_json: bool, lang: str
) -> None:
    """Work out task times from motions of a robot, TMU, or a learning curve.

    FILE is YAML or JSON: for each task and operator `moves` (d in m, v in m/s, a in m/s2, j in
    m/s3 where it is known, times) with `grip`, `grips`, `process`, `settle` in s; or `tmu`; or
    `first` (s), `rate` and `unit`.

    \b
    Examples:
      tandem times times.yaml
      tandem times times.yaml --cell cell.yaml -o timed.yaml
    """
    from tandem.assessment import sentences as say
    from tandem.assessment.times import document_of, filled, sentences, timed
    from tandem.files.facts.document import tree
    from tandem.files.load import dump, load, text_of

    if (cell_file is None) != (output is None):
        raise UsageError("--cell and -o go together: the cell, and where it is written with times.")
    if output is not None and output.exists():
        raise UsageError(f"-o {output}: the file exists already. Choose another name.")
    source = "standard input" if str(facts_file) == "-" else str(facts_file)
    document = tree(text_of(facts_file, source), source)
    if document.faults:
        raise CellError(document.faults)
    t = say.words(lang)
    try:
        times = timed(document.plain())
        cell = None if cell_file is None else filled(load(cell_file), times)
    except CellError as error:
        raise CellError(
            fault if fault.place else fault.at(document.place(fault.path).text)
            for fault in error.faults
        ) from error
    if cell is not None and output is not None:
        dump(cell, output)
    if as_json:
        from tandem import __version__

        made = {"version": __version__, "command": shlex.join(["tandem", *sys.argv[1:]])}
        click.echo(json.dumps(document_of(t, times, made), ensure_ascii=False))
    else:
        click.echo("\n".join(sentences(t, times)))
    if output is not None:
        click.echo(t("wrote", path=output), err=True)
