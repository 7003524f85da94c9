"""`tandem simulate` and `tandem policies`: deciders beside people, judged."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cell.written import number
from tandem.cli.compiled import needs_jax
from tandem.cli.options import FORMAT, decider_options
from tandem.cli.seeds import say_which_seed
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell

PICTURE = click.Path(dir_okay=False, path_type=Path)


@click.command("simulate")
@click.argument("cell_file", metavar="CELL", type=click.Path(allow_dash=True))
@FORMAT
@click.option(
    "--policy",
    "policies",
    required=True,
    help=(
        "Who decides, joined by commas; `tandem policies` lists them, one of your own is"
        " package.module:maker. The others are compared with the first."
    ),
)
@click.option(
    "--people",
    multiple=True,
    default=("compliant",),
    show_default=True,
    help="Who works there: compliant, random:0.5, pace:2.0, population:FILE, ...",
)
@click.option(
    "--episodes",
    type=click.IntRange(2, 1_000_000),
    default=1000,
    show_default=True,
    help="Assemblies for each policy and people.",
)
@click.option(
    "--seed",
    type=int,
    default=0,
    show_default=True,
    help="Of all chance. The same seed gives every policy the same episodes.",
)
@decider_options
@click.option(
    "--spread",
    type=click.Choice(["off", "lognormal", "triangular"]),
    default="off",
    show_default=True,
    help="How real times scatter around the stated ones.",
)
@click.option(
    "--cv",
    type=click.FloatRange(0.0, 10.0),
    default=0.0,
    show_default=True,
    help="Coefficient of variation where the cell does not state a spread.",
)
@click.option(
    "--failures",
    type=click.FloatRange(0.0, min_open=True),
    help="Mean seconds until a robot or machine breaks down; never when absent.",
)
@click.option(
    "--absences",
    type=click.FloatRange(0.0, min_open=True),
    help="Mean seconds until a human is called away; never when absent.",
)
@click.option("--chart", type=PICTURE, help="Draw what came out into this .svg, .png or .pdf.")
@click.option("-o", "--output", type=PICTURE, help="Write the document into this .json file too.")
@click.option(
    "--json", "as_json", is_flag=True, help="Print the document; a list of them for several people."
)
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def simulate_command(
    cell_file: str,
    form: str | None,
    policies: str,
    people: tuple[str, ...],
    chart: Path | None,
    output: Path | None,
    as_json: bool,
    quiet: bool,
    **given: Any,
) -> None:
    """Judge who decides beside people: many assemblies, the same chances for all, next to the exact
    optimum.

    \b
    Examples:
      tandem simulate cell.yaml --policy fixed,replan-robust --people pace:1.5
      tandem simulate cell.yaml --policy expected,fixed --people random:0.5 --chart regret.svg
      tandem simulate cell.yaml --plan plan.json --point 2 --policy fixed,auto --people pace:1.3
    """
    from tandem.files.load import load

    needs_jax("simulating many episodes")
    from tandem.dispatch.evaluation.trial import judge, split_people

    cell = load(cell_file, form)
    if chart is not None and chart.suffix.lower() not in (".svg", ".png", ".pdf"):
        raise UsageError(f"--chart {chart}: a picture's name ends in .svg, .png or .pdf.")
    told = _told(cell, _split(policies), given)
    say_which_seed(given["learned"])
    documents = judge(
        cell,
        _split(policies),
        split_people(people),
        given["episodes"],
        given["seed"],
        tell=(lambda _: None) if quiet else _tell,
        **told,
    )
    for remark in dict.fromkeys(remark for one in documents for remark in _remarks(one)):
        _tell(remark)
    document: Any = documents[0] if len(documents) == 1 else documents
    if output is not None:
        from tandem.files.atomic import store

        store(output, json.dumps(document, indent=1, ensure_ascii=False) + "\n")
        _tell(f"wrote {output}")
    if chart is not None:
        from tandem.draw.judged import judged_figure
        from tandem.draw.saving import save

        _tell(f"wrote {save(judged_figure(documents), chart)}")
    if as_json:
        click.echo(json.dumps(document, ensure_ascii=False))
    else:
        for one in documents:
            _show(one)


def _remarks(document: dict[str, Any]) -> Iterator[str]:
    """Who was left out, and whose plan is not proven: what nobody should overlook."""
    from tandem.dispatch.deciders.policy import Basis

    for row in document["left_out"]:
        yield f"{row['policy']} is left out: {row['reason']}"
    for row in document["policies"]:
        plan = row.get("plan")
        if plan is not None and plan["status"] != "optimal":
            basis = Basis(
                plan["makespan"],
                plan["stress"],
                False,
                plan["bound"]["makespan"],
                plan["bound"]["stress"],
            )
            yield f"{row['policy']}: {basis.doubt}"


def _told(cell: Cell, policies: tuple[str, ...], given: dict[str, Any]) -> dict[str, Any]:
    """What is to be small, what may happen, and what the deciders are told: as `judge` takes it."""
    from tandem.cli.following import change_penalty, steered
    from tandem.dispatch.deciders.policy import Options
    from tandem.world.randomness import Chance

    objective, plan = steered(cell, given, policies, (1.0, 0.0))
    prior = {} if given["prior"] is None else {"prior": given["prior"]}
    return {
        "objective": objective,
        "chance": Chance(
            spread=given["spread"],
            cv=given["cv"],
            failure_s=given["failures"],
            absence_s=given["absences"],
            undo=given["taking_apart"],
        ),
        "options": Options(
            budget_ms=given["budget"],
            seed=given["seed"],
            frozen_s=given["frozen"],
            change_penalty=change_penalty(given, plan),
            learned=given["learned"],
            plan=plan,
            **prior,
        ),
    }


def _split(text: str) -> tuple[str, ...]:
    return tuple(name for part in text.split(",") if (name := part.strip()))


def _tell(text: str) -> None:
    click.echo(text, err=True)


def _show(document: dict[str, Any]) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    heads = ("policy", "makespan, s", "p95", "stress", "regret", "p50/p99 ms", "above first")
    for place, head in enumerate(heads):
        table.add_column(head, justify="right" if place else "left", no_wrap=True)
    for row in document["policies"]:
        time, stress, difference = row["makespan"], row["stress"], row.get("difference")
        latency = [row["latency_ms"][share] for share in ("p50", "p99")]
        table.add_row(
            row["policy"],
            _with_half(time),
            f"{time['p95']:.4g}",
            _with_half(stress),
            "-" if row["regret"] is None else f"{100 * row['regret_share']:.1f} %",
            "/".join("-" if one is None else f"{one:.1f}" for one in latency),
            "" if difference is None else _with_half(difference),
        )
    console = Console(highlight=False)
    unit = " s" if document["weights"] == [1, 0] else ""
    best = (
        ""
        if document["optimum"] is None
        else f", exact optimum {number(document['optimum'])}{unit}"
    )
    console.print(
        f"beside {document['people']}: {document['episodes']} episodes, seed"
        f" {document['seed']}{best}",
        soft_wrap=True,
    )
    console.print(table)


def _with_half(measure: dict[str, Any]) -> str:
    """The mean and half its 95 % interval."""
    return f"{measure['mean']:.4g}±{(measure['ci95'][1] - measure['ci95'][0]) / 2:.2g}"


@click.command("policies")
@click.option("--json", "as_json", is_flag=True, help="Print them as one document.")
def policies_command(as_json: bool) -> None:
    """List the policies: who can decide live."""
    from tandem.dispatch.deciders.table import POLICIES

    listed = POLICIES.told(lambda entry: entry.what)
    if as_json:
        click.echo(
            json.dumps(
                {
                    "schema_version": 1,
                    "policies": [{"name": name, "what": what} for name, what in listed.items()],
                }
            )
        )
        return
    width = max(map(len, listed))
    for name, what in listed.items():
        click.echo(f"{name:<{width}}  {what}")
