"""`tandem reproduce`: published systems, run here."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cli.compiled import needs_jax
from tandem.errors import UsageError
from tandem.files.load import load
from tandem.lab.systems import SYSTEMS, Experiment, System, system

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.lab.kinat2023.episode import Episode

FOLDER = click.Path(file_okay=False, path_type=Path)
CASE = click.Path(dir_okay=False, path_type=Path)
CELL = click.Path(dir_okay=False, allow_dash=True)
POLICY = click.Path(exists=True, dir_okay=False, path_type=Path)


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


@click.command("play")
@click.argument("cell_file", metavar="CELL", type=CELL)
@click.option("--robot", required=True, type=POLICY, help="The policy whose robot plays.")
@click.option("--human", type=POLICY, help="The policy whose human plays; the robot's when absent.")
@click.option(
    "--simulations", default=100, show_default=True, type=click.IntRange(1, 100_000), help="Plays."
)
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Of the draws.")
@click.option("--log", type=CASE, help="Write every step of every simulation there, as CSV.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as one document.")
def play_command(
    cell_file: str,
    robot: Path,
    human: Path | None,
    simulations: int,
    seed: int,
    log: Path | None,
    as_json: bool,
) -> None:
    """Simulate two trained agents on the thesis's station, and take the shortest simulation.

    The files are policies of `tandem train --recipe thesis` or `station`: the robot of one beside
    the human of the same or of another. They draw their actions, so that simulations differ.

    \b
    Examples:
      tandem play examples/thesis.yaml --robot runs/a/policy-0.safetensors
      tandem play examples/thesis.yaml --robot a.safetensors --human b.safetensors --log steps.csv
    """
    from tandem.lab.kinat2023.simulations import agents_of, shortest, write_log
    from tandem.lab.kinat2023.simulations import simulations as simulated

    cell = load(cell_file)
    policy = agents_of(robot, human or robot, cell)
    played = list(simulated(cell, policy, simulations, seed=seed))
    if log:
        write_log(log, cell, [steps for _, steps in played])
        _tell(f"wrote {log}")
    episodes = [episode for episode, _ in played]
    document = simulated_document(cell, episodes, shortest(episodes), seed)
    click.echo(json.dumps(document, ensure_ascii=False) if as_json else _simulated(document))


def simulated_document(
    cell: Cell, episodes: Sequence[Episode], best: int | None, seed: int
) -> dict[str, Any]:
    """What came of the simulations, in plain data; `shortest` is None when none came to its end."""
    document: dict[str, Any] = {
        "schema_version": 1,
        "cell": cell.name,
        "simulations": len(episodes),
        "seed": seed,
        "finished": sum(episode.done for episode in episodes),
        "shortest": None,
    }
    if best is not None:
        rows = sorted(episodes[best].schedule, key=lambda row: (row.start, row.task))
        document["shortest"] = {
            "simulation": best + 1,
            "makespan": max(row.end for row in rows),
            "stress": episodes[best].stress,
            "illegal": episodes[best].illegal,
            "assignments": [
                {
                    "task": row.task,
                    "operators": list(row.operators),
                    "start": row.start,
                    "end": row.end,
                }
                for row in rows
            ],
        }
    return document


def _simulated(document: Mapping[str, Any]) -> str:
    head = f"{document['finished']} of {document['simulations']} simulations came to their end"
    best = document["shortest"]
    if best is None:
        return f"{head}. Train longer, or take more --simulations."
    lines = [
        f"{head}; the shortest is number {best['simulation']}: {best['makespan']:g} s, stress"
        f" {best['stress']:g}, {best['illegal']} illegal actions."
    ]
    lines += [
        f"  {row['start']:>6g} to {row['end']:>6g} s  {' and '.join(row['operators']):<12}"
        f" {row['task']}"
        for row in best["assignments"]
    ]
    return "\n".join(lines)


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
