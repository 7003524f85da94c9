"""`tandem reproduce`: published systems, run here."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from tandem.cli.compiled import needs_jax
from tandem.errors import UsageError
from tandem.lab.systems import SYSTEMS, Experiment, System, system

FOLDER = click.Path(file_okay=False, path_type=Path)
CASE = click.Path(dir_okay=False, path_type=Path)


HELP = """Run a published system here: published, ours and exact side by side, figures redrawn.

SYSTEM is one of these:

\b
{systems}

\b
Examples:
  tandem reproduce thesis --stored
  tandem reproduce antonelli2021 --quick
  tandem reproduce --all --stored

Long runs can be stopped and go on where they were.
""".format(systems="\n".join(f"  {name:<15}{known.title}" for name, known in SYSTEMS.items()))


@click.command("reproduce", help=HELP)
@click.argument("name", metavar="[SYSTEM]", required=False)
@click.option(
    "--all",
    "everything",
    is_flag=True,
    help="Every published system, and one page that compares them: OUTPUT/comparison.html.",
)
@click.option(
    "--quick",
    is_flag=True,
    help=(
        "A short version: few seeds, small budgets; shows that the code runs, not what the recipes"
        " reach."
    ),
)
@click.option(
    "-o",
    "--output",
    type=FOLDER,
    help="Folder for the result, the records and the figures; tandem-out/SYSTEM when absent.",
)
@click.option(
    "--seeds",
    type=click.IntRange(1, 100),
    help="How many seeds; as many as the stored run has when absent.",
)
@click.option(
    "--case",
    "cases",
    multiple=True,
    type=CASE,
    help="With `cells`: a case study to train on besides the random cells; may be repeated.",
)
@click.option("--stored", is_flag=True, help="Train nothing: show the stored long run.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as one document.")
def reproduce_command(
    name: str | None,
    everything: bool,
    quick: bool,
    output: Path | None,
    seeds: int | None,
    cases: tuple[Path, ...],
    stored: bool,
    as_json: bool,
) -> None:
    """See `HELP`."""
    if everything == (name is not None):
        raise UsageError(f"give one SYSTEM ({', '.join(SYSTEMS)}), or --all.")
    if name is None:
        needs_jax("training")  # what a system can do is found by letting it learn a little
        if cases:
            raise UsageError("--case: only `tandem reproduce cells` takes case studies.")
        return _compare(
            output or Path("tandem-out") / "all",
            quick=quick,
            stored=stored,
            seeds=seeds,
            as_json=as_json,
        )
    chosen = system(name)
    if cases and not chosen.takes_cases:
        raise UsageError(
            f"--case: {name} is run on its own cells; only `tandem reproduce cells` takes case"
            " studies."
        )
    if not stored:
        needs_jax("training")
    experiment, folder = _load(chosen), output or Path("tandem-out") / name
    further: dict[str, Any] = {"cases": cases} if chosen.takes_cases else {}
    document = (
        experiment.stored()
        if stored
        else experiment.reproduce(folder, quick=quick, seeds=seeds, tell=_tell, **further)
    )
    for file in experiment.draw_figures(document, folder):
        _tell(f"wrote {file}")
    click.echo(json.dumps(document, ensure_ascii=False) if as_json else experiment.table(document))


def _load(chosen: System) -> Experiment:
    """The system's module. Some need the packages for learning even to show a stored result."""
    try:
        return chosen.load()
    except ImportError:
        needs_jax("training")
        raise


def _compare(folder: Path, *, quick: bool, stored: bool, seeds: int | None, as_json: bool) -> None:
    from tandem.lab.comparison import compare

    page, document = compare(folder, quick=quick, stored=stored, seeds=seeds, tell=_tell)
    _tell(f"wrote {page}")
    if as_json:
        click.echo(json.dumps(document, ensure_ascii=False))
        return
    for name, entries in document["features"].items():
        click.echo(name)
        for feature, entry in entries.items():
            click.echo(f"  {feature:<30}{entry['value']}")


def _tell(text: str) -> None:
    click.echo(text, err=True)
