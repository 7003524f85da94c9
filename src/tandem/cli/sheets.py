"""`tandem import` and `tandem template`: planners' workbooks in, and a form to fill out."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cell.language import spoken
from tandem.cli.columns import indented
from tandem.cli.options import LANGUAGE
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.files.spreadsheet.draft import Draft

KINDS = ("column", "row", "sheet", "cannot", "assumed")
"""Kinds of notes, in the order in which they are told."""
ROOM = "tandem.files.spreadsheet"


@click.command(
    "import",
    epilog="Notes and faults go to the error stream, each with its place such as Sheet1!C4.",
)
@click.argument("workbook", type=click.Path(path_type=Path, dir_okay=False))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Cell file to write, .yaml or .json; else YAML on stdout.",
)
@click.option("--preview", is_flag=True, help="Show what would be read, and write nothing.")
@click.option("--sheet", help="The sheet with the tasks, when several look like it.")
@click.option(
    "--map",
    "columns",
    multiple=True,
    metavar='"HEADER=MEANING"',
    help='What a column holds: "Spalte 4=time robot [s]", "F=ignore".',
)
@click.option(
    "--human", "humans", multiple=True, metavar="NAME", help="An operator that is a human."
)
@click.option(
    "--robot", "robots", multiple=True, metavar="NAME", help="An operator that is a robot."
)
@click.option(
    "--machine", "machines", multiple=True, metavar="NAME", help="An operator that is a machine."
)
@click.option(
    "--aggregate",
    type=click.Choice(["sum", "peak", "time-weighted", "time-above", "ignore"]),
    help=(
        "What columns of scores that only rank (RULA, REBA, ...) are for: added up all the same,"
        " kept for a plan that minds their peak, mean or time above a level, or left out."
    ),
)
@click.option("--force", is_flag=True, help="Replace the output file when it exists.")
@LANGUAGE
def import_command(
    workbook: Path,
    output: Path | None,
    preview: bool,
    sheet: str | None,
    columns: tuple[str, ...],
    humans: tuple[str, ...],
    robots: tuple[str, ...],
    machines: tuple[str, ...],
    aggregate: str | None,
    force: bool,
    lang: str,
) -> None:
    """Turn a planner's workbook (xlsx, xls, xlsb, ods, csv) into a cell file.

    \b
    Examples:
      tandem import tasks.xlsx --preview
      tandem import tasks.xlsx -o cell.yaml --human Anna --robot "Station 2"
      tandem import arbeitsplan.xlsx -o zelle.yaml --lang de
    """
    from tandem.files.load import dump, dumps
    from tandem.files.spreadsheet.draft import read_workbook

    if output is not None and output.exists() and not force and not preview:
        raise UsageError(f"{output} exists already. Give --force to replace it, or another name.")
    draft = read_workbook(
        workbook,
        sheet=sheet,
        columns=dict(map(_pair, columns)),
        humans=humans,
        robots=robots,
        machines=machines,
        aggregate=aggregate,
    )
    if preview:
        click.echo(preview_text(draft, lang))
    tell_notes(draft, lang)
    cell = draft.cell()
    if preview:
        return
    if output is None:
        click.echo(dumps(cell), nl=False)
        return
    dump(cell, output)
    t = spoken(lang, ROOM)
    counts = {
        "tasks": t.count("task", len(cell.tasks)),
        "operators": t.count("operator", len(cell.operators)),
    }
    click.echo(t("imported", file=output, **counts, who=", ".join(cell.operators)), err=True)


@click.command("template")
@click.argument(
    "cell_file", metavar="[CELL]", required=False, type=click.Path(path_type=Path, dir_okay=False)
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path, dir_okay=False),
    default=Path("template.xlsx"),
    show_default=True,
    help="Workbook to write.",
)
@click.option(
    "--lang",
    type=click.Choice(["en", "de"]),
    default="en",
    show_default=True,
    help="Language of headers and help.",
)
@click.option("--force", is_flag=True, help="Replace the workbook when it exists.")
def template_command(cell_file: Path | None, output: Path, lang: Any, force: bool) -> None:
    """Write a workbook to fill in, with an example; or CELL in the same form.

    \b
    Examples:
      tandem template -o tasks.xlsx --lang de
      tandem template cell.yaml -o tasks.xlsx
    """
    from tandem.files.spreadsheet.template import export_cell, write_template

    if output.suffix.lower() != ".xlsx":
        raise UsageError(
            f"-o {output}: a template is an .xlsx workbook. Write -o {output.with_suffix('.xlsx')}."
        )
    if output.exists() and not force:
        raise UsageError(f"{output} exists already. Give --force to replace it, or another name.")
    if cell_file is None:
        write_template(output, lang=lang)
    else:
        from tandem.files.load import load

        for sentence in export_cell(load(cell_file), output, lang=lang):
            click.echo(f"not kept in the workbook: {sentence}", err=True)
    click.echo(
        f"{output}: overwrite the tasks, save, then `tandem import {output} -o cell.yaml`.",
        err=True,
    )


def preview_text(draft: Draft, language: str = "en") -> str:
    """The mapping of columns, the first rows, and what cell would come out, as plain text."""
    t = spoken(language, ROOM)
    where = t("preview.where", file=draft.path.name, sheet=repr(draft.sheet), header=draft.header)
    lines = [where, ""]
    heads = tuple(t(f"preview.{head}") for head in ("column", "header", "read"))
    table: list[tuple[str, ...]] = [heads]
    for column in draft.columns:
        letter = column.place.rpartition("!")[2].rstrip("0123456789")
        table.append(
            (
                letter,
                column.header,
                (
                    str(column.meaning)
                    if column.meaning and column.meaning.what != "ignore"
                    else t("preview.unread")
                ),
            )
        )
    lines += indented(table)
    if draft.rows:
        letters = [column.place.rpartition("!")[2].rstrip("0123456789") for column in draft.columns]
        lines += ["", t("preview.rows")]
        lines += indented(
            [
                tuple(letters),
                *(
                    tuple(_short(row[column.index]) for column in draft.columns)
                    for row in draft.rows
                ),
            ]
        )
    tasks, operators = draft.document["tasks"], draft.document["operators"]
    who = ", ".join(
        t(f"preview.kind.{data['kind']}", name=name) for name, data in operators.items()
    )
    counts = {
        "tasks": t.count("task", len(tasks)),
        "operators": t.count("operator", len(operators)),
    }
    lines += ["", t("preview.cell", **counts, who=who)]
    return "\n".join(lines)


def tell_notes(draft: Draft, language: str = "en") -> None:
    """What was not read, and what was assumed, on stderr."""
    t = spoken(language, ROOM)
    for kind in KINDS:
        notes = [note for note in draft.notes if note.kind == kind]
        if notes:
            click.echo(f"{t(f'title.{kind}')}:", err=True)
        for note in notes:
            click.echo(f"  {note.sentence(language)}", err=True)
    sys.stderr.flush()


def _short(text: str) -> str:
    return text if len(text) <= 24 else text[:23] + "…"


def _pair(text: str) -> tuple[str, str]:
    header, equals, meaning = text.rpartition("=")
    if not equals or not header.strip() or not meaning.strip():
        raise UsageError(
            f'--map {text!r}: write HEADER=MEANING, such as --map "Spalte 4=time robot [s]".'
        )
    return header.strip(), meaning.strip()
