"""`tandem bench`: methods and policies over cells, seeds and people."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cli.options import F, Weights
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.bench.outcome import Failure
    from tandem.bench.spec import Spec
    from tandem.bench.sweep import State

MOST_FAILURES = 10


class Shard(click.ParamType):  # type: ignore[type-arg]  # older releases of click take no parameter
    """One part of several, counted from 1: 2/4."""

    name = "I/N"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        if isinstance(value, tuple):
            return value
        found = re.fullmatch(r"([0-9]+)/([0-9]+)", str(value).strip())
        if found is None or not 1 <= int(found[1]) <= int(found[2]):
            self.fail(f"{value!r} is no part of several, counted from 1, such as 2/4.", param, ctx)
        return int(found[1]), int(found[2])


class Bench(click.Group):
    """`tandem bench SPEC` is `tandem bench run SPEC`."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if args and args[0] not in (*self.commands, *ctx.help_option_names):
            args = ["run", *args]
        return super().parse_args(ctx, args)


@click.group("bench", cls=Bench, subcommand_metavar="SPEC.yaml -o FOLDER | show FOLDER...")
def bench_command() -> None:
    """Sweep methods of planning and policies of dispatch over cells, seeds and people: one file for
    each job, tables with intervals.

    `tandem bench SPEC` is short for `tandem bench run SPEC`.

    \b
    Examples:
      tandem bench sweep.yaml -o runs/sweep --jobs 4
      tandem bench --method exact,best-of-n --cell cells/ --seeds 5 -o runs/sweep
      tandem bench show runs/monday runs/tuesday -o comparison.tex
    """


def _several(help_text: str, name: str) -> Callable[[F], F]:
    return click.option(name, multiple=True, help=help_text)


@bench_command.command("run")
@click.argument("spec_file", metavar="[SPEC]", required=False, type=click.Path(dir_okay=False))
@click.option(
    "-o",
    "--output",
    "folder",
    required=True,
    type=click.Path(path_type=Path),
    help="Folder of the sweep. One that is there is gone on with.",
)
@_several("Methods of planning, joined by commas, as `tandem methods` lists them.", "--method")
@_several("Who decides live, joined by commas, as `tandem policies` lists them.", "--policy")
@_several("A cell file, a folder of them, or a benchmark's name; may be repeated.", "--cell")
@_several(
    "A run of `tandem train`, which the policy `learned` plays; may be repeated.", "--learned"
)
@click.option("--seeds", type=int, help="How many seeds, from 0 on; 5 when absent.")
@_several("Who works there, as in `tandem simulate`; may be repeated.", "--people")
@click.option("--episodes", type=int, help="Assemblies for each job of a policy; 200 when absent.")
@click.option(
    "--weights",
    type=Weights(),
    help="A job costs TIME * makespan + STRESS * stress; 1,0 when absent.",
)
@click.option(
    "--work",
    type=float,
    help="Limit of each planning, CP-SAT's deterministic seconds: it repeats; 10 when absent.",
)
@click.option(
    "--time-limit",
    type=float,
    help="Instead of --work: seconds. The tables then depend on the machine.",
)
@click.option(
    "--optimum-work",
    type=float,
    help="Limit for proving each cell's optimum, as --work; 60 when absent.",
)
@click.option(
    "--budget", type=float, help="Milliseconds for each decision of a policy; 50 when absent."
)
@click.option("--name", help="Title of the tables.")
@click.option(
    "--jobs",
    type=click.IntRange(1, 1024),
    default=1,
    show_default=True,
    help="Done side by side.",
)
@click.option("--shard", type=Shard(), help="Only the I-th of N parts; others are done elsewhere.")
@click.option(
    "--engine",
    type=click.Choice(["processes", "ray"]),
    default="processes",
    show_default=True,
    help="Who does the jobs: processes of this machine, or Ray (RAY_ADDRESS names a cluster).",
)
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def run_command(
    spec_file: str | None,
    folder: Path,
    jobs: int,
    shard: tuple[int, int] | None,
    engine: str,
    quiet: bool,
    **given: Any,
) -> int:
    """Carry a sweep out, or go on with one: what is done is not done again.

    It may be stopped at any moment, by Ctrl-C too; the same command goes on. The folder then holds
    a file for each job, the tables (summary.md, .csv, .tex, .json), their picture (summary.svg),
    each result in a line (results.csv) and, apart from them, what the jobs took (times.csv).

    \b
    Examples:
      tandem bench sweep.yaml -o runs/sweep --jobs 4
      tandem bench sweep.yaml -o runs/sweep --shard 2/3
      tandem bench --policy fixed,replan --cell cell.yaml --people random:0.5 -o runs/live
    """
    from tandem.bench.spec import read_spec

    keys = {"method": "methods", "policy": "policies", "cell": "cells"}
    told = {keys.get(name, name): value for name, value in given.items()}
    for name in ("methods", "policies"):
        told[name] = [one for text in told[name] for one in _split(text)] or None
    told["cells"] = list(told["cells"]) or None
    told["learned"] = list(told["learned"]) or None
    told["people"] = _people(told["people"])
    spec = read_spec(spec_file, **told)
    if spec.policies:
        from tandem.cli.compiled import needs_jax

        needs_jax("judging policies beside people")
    return _carried_out(spec, folder, jobs, shard, engine, quiet)


def _split(text: str) -> list[str]:
    return [name for part in text.split(",") if (name := part.strip())]


def _people(texts: tuple[str, ...]) -> list[str] | None:
    if not texts:
        return None
    from tandem.dispatch.evaluation.trial import split_people

    return list(split_people(texts))


def _carried_out(
    spec: Spec,
    folder: Path,
    jobs: int,
    shard: tuple[int, int] | None,
    engine: str,
    quiet: bool,
) -> int:
    """Does what is missing, and shows how the sweep stands."""
    from tandem.bench.sweep import carry_on
    from tandem.bench.written import markdown, write_all

    last = list[Any]()

    def tell(state: State) -> None:
        last[:] = [state]
        if not quiet:
            _tell(state)

    try:
        failures = carry_on(spec, folder, jobs=jobs, shard=shard, engine=engine, tell=tell)
    except KeyboardInterrupt:
        done = f"{last[0].done} of {last[0].of} jobs" if last else "what is done"
        click.echo(
            f"tandem: stopped; {done} are kept in {folder}. The same command goes on.", err=True
        )
        return 130
    document = write_all(folder)
    click.echo(markdown(document), nl=False)
    click.echo(f"wrote the tables into {folder}", err=True)
    if failures:
        raise UsageError(_failed(failures))
    return 0


def _tell(state: State) -> None:
    which = "" if state.last is None else f": {state.last.kind} {state.last.who}"
    seed = "" if state.last is None or state.last.seed is None else f", seed {state.last.seed}"
    click.echo(f"{state.done} of {state.of} jobs{which}{seed}", err=True)


def _failed(failures: list[Failure]) -> str:
    """What went wrong, and that it is not kept."""
    told = dict.fromkeys(f"- {one.job.kind} {one.job.who}: {one.message}" for one in failures)
    shown = list(told)[:MOST_FAILURES]
    rest = [f"... and {len(told) - len(shown)} more."] if len(told) > len(shown) else []
    number = f"{len(failures)} job{'s' * (len(failures) > 1)} failed"
    head = f"{number}, and will be done again by the next call:"
    return "\n".join([head, *shown, *rest])


@bench_command.command("show")
@click.argument("folders", metavar="FOLDER...", nargs=-1, required=True)
@click.option(
    "-o",
    "--output",
    "outputs",
    multiple=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write .md, .csv, .tex, .json, or a picture as .svg, .png or .pdf; may be repeated.",
)
@click.option("--times", "as_times", is_flag=True, help="Show what the jobs took instead, as CSV.")
@click.option("--json", "as_json", is_flag=True, help="Print one document on stdout.")
def show_command(
    folders: tuple[str, ...], outputs: tuple[Path, ...], as_times: bool, as_json: bool
) -> None:
    """Show a sweep as far as it is done; lay several over each other.

    Several are compared on the cells that all of them have. Folders that ask for the same, such as
    shards done on several machines, are taken together.

    \b
    Examples:
      tandem bench show runs/sweep
      tandem bench show runs/monday runs/tuesday -o comparison.tex -o comparison.pdf
    """
    from tandem.bench.summary import read_runs, summarised
    from tandem.bench.written import as_json as document_text
    from tandem.bench.written import check, markdown, times, write

    check(outputs)
    runs = read_runs(folders)
    if as_times:
        click.echo(times(runs), nl=False)
        return
    document = summarised(runs)
    for path in outputs:
        write(document, path)
        click.echo(f"wrote {path}", err=True)
    click.echo(document_text(document) if as_json else markdown(document), nl=False)
