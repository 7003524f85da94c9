"""`tandem explain`: why a plan is so, and what every other choice would cost."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

from tandem.cli.options import AS_JSON, FORMAT, LANGUAGE, check_time, point_options
from tandem.cli.stored import is_plan, stored_plan

if TYPE_CHECKING:
    from tandem.explain.bottleneck import Bottleneck
    from tandem.explain.explanation import TaskAnswer
    from tandem.plan.result import Front


@click.command("explain")
@click.argument("cell_file", metavar="CELL|PLAN", type=click.Path(allow_dash=True))
@FORMAT
@click.option("--task", help="Only this task.")
@point_options
@click.option(
    "--time-limit",
    type=float,
    default=17.0,
    show_default=True,
    help="Seconds for everything; what is not proven by then says so.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the search.")
@click.option(
    "--workers", type=int, help="Threads that plan at the same time; one per core when absent."
)
@LANGUAGE
@AS_JSON
def explain_command(
    cell_file: str,
    form: str | None,
    task: str | None,
    point: int | None,
    makespan: float | None,
    stress: float | None,
    time_limit: float,
    seed: int,
    workers: int | None,
    lang: str,
    as_json: bool,
) -> None:
    """Say why a schedule is as it is, and what every other choice would cost.

    \b
    Examples:
      tandem explain cell.yaml
      tandem explain cell.yaml --task 4 --point 1
      tandem explain plan.json --point 2 --lang de

    Of a PLAN that `tandem plan` has stored, the very schedule in it is explained. Each cost is that
    of a schedule found by planning anew with the other choice forced.
    """
    from tandem.explain.explanation import explain
    from tandem.files.load import load

    check_time(time_limit, workers)
    plan = stored_plan(cell_file, language=lang) if is_plan(cell_file) else None
    stale = plan is not None and plan.is_stale
    which: dict[str, Any] = {"point": point, "makespan": makespan, "stress": stress}
    found = explain(
        plan.cell if plan else load(cell_file, form),
        front=plan.front if plan else None,
        task=task,
        **which,
        time_limit=time_limit,
        seed=seed,
        workers=workers,
        on_answer=None if as_json else Telling(which, lang, stale),
    )
    if as_json:
        document = {**found.to_dict(lang), **({"stale": True} if stale else {})}
        click.echo(json.dumps(document, ensure_ascii=False))


class Telling:
    """Prints each answer as it comes. `which`: how the point was named, as `point_of` takes it."""

    def __init__(self, which: dict[str, Any], language: str, stale: bool):
        self.which, self.language, self.stale = which, language, stale

    def __call__(self, answer: Front | Bottleneck | TaskAnswer) -> None:
        from tandem.explain.bottleneck import Bottleneck, sentences
        from tandem.explain.explanation import TaskAnswer, heading
        from tandem.plan.choice import point_of

        if isinstance(answer, TaskAnswer):
            lines = answer.sentences(self.language)
        elif isinstance(answer, Bottleneck):
            lines = [*sentences(answer, self.language), ""]
        else:
            place = point_of(answer, **self.which) + 1
            lines = [heading(answer, place, self.language, stale=self.stale), ""]
        click.echo("\n".join(lines))
