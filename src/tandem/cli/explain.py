"""`tandem explain`: why a plan is so, and what every other choice would cost."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

from tandem.cli.options import AS_JSON, CELL, FORMAT, check_time

if TYPE_CHECKING:
    from tandem.explain.bottleneck import Bottleneck
    from tandem.explain.explanation import TaskAnswer
    from tandem.plan.result import Front


@click.command("explain")
@CELL
@FORMAT
@click.option("--task", help="Only this task.")
@click.option(
    "--point",
    type=int,
    help="A point of the front, counted from 1; the recommended compromise when absent.",
)
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
@AS_JSON
def explain_command(
    cell_file: str,
    form: str | None,
    task: str | None,
    point: int | None,
    time_limit: float,
    seed: int,
    workers: int | None,
    as_json: bool,
) -> None:
    """Say why a schedule is as it is, and what every other choice would cost.

    \b
    Examples:
      tandem explain cell.yaml
      tandem explain cell.yaml --task 4 --point 1

    Each cost is that of a schedule found by planning anew with the other choice forced.
    """
    from tandem.explain.explanation import explain
    from tandem.files.load import load

    check_time(time_limit, workers)
    cell = load(cell_file, form)
    show = None if as_json else Telling(point)
    found = explain(
        cell,
        task=task,
        point=point,
        time_limit=time_limit,
        seed=seed,
        workers=workers,
        on_answer=show,
    )
    if as_json:
        click.echo(json.dumps(found.to_dict(), ensure_ascii=False))


class Telling:
    """Prints each answer as it comes."""

    def __init__(self, point: int | None):
        self.point = point

    def __call__(self, answer: Front | Bottleneck | TaskAnswer) -> None:
        from tandem.explain.bottleneck import Bottleneck, sentences
        from tandem.explain.explanation import TaskAnswer, chosen_point, heading

        if isinstance(answer, TaskAnswer):
            lines = answer.sentences()
        elif isinstance(answer, Bottleneck):
            lines = [*sentences(answer), ""]
        else:
            lines = [heading(answer, chosen_point(answer, self.point)), ""]
        click.echo("\n".join(lines))
