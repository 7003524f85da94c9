"""`tandem explain`, `tandem compare`, `tandem sensitivity`: why a plan is so, what changed, and what would help."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.explain.explanation import TaskAnswer
    from tandem.explain.floor import Floor
    from tandem.plan.result import Front

CELL = click.argument("cell_file", metavar="CELL", type=click.Path(allow_dash=True))
FORMAT = click.option("--format", "form", metavar="NAME", help="What CELL is written in; told from its content when absent.")
AS_JSON = click.option("--json", "as_json", is_flag=True, help="Print one document on stdout and nothing else there.")


@click.command("explain")
@CELL
@FORMAT
@click.option("--task", help="Only this task.")
@click.option("--point", type=int, help="A point of the front, counted from 1; the recommended compromise when absent.")
@click.option("--time-limit", type=float, default=20.0, show_default=True, help="Seconds for everything; what is not proven by then says so.")
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the search.")
@click.option("--workers", type=int, help="Threads that plan at the same time; one per core when absent.")
@AS_JSON
def explain_command(
    cell_file: str, form: str | None, task: str | None, point: int | None, time_limit: float, seed: int, workers: int | None, as_json: bool
) -> None:
    """Say why a schedule is as it is, and what every other choice would cost.

    \b
    Examples:
      tandem explain cell.yaml
      tandem explain cell.yaml --task 4 --point 1

    Each cost is that of a schedule found by planning anew with the other choice forced.
    """
    from tandem.cell.files import load
    from tandem.explain.explanation import explain

    check_time(time_limit, workers)
    cell = load(cell_file, form)
    show = None if as_json else Telling(point)
    found = explain(cell, task=task, point=point, time_limit=time_limit, seed=seed, workers=workers, on_answer=show)
    if as_json:
        click.echo(json.dumps(found.to_dict(), ensure_ascii=False))


class Telling:
    """Prints each answer as it comes."""

    def __init__(self, point: int | None):
        self.point = point

    def __call__(self, answer: Front | Floor | TaskAnswer) -> None:
        from tandem.explain.explanation import TaskAnswer, chosen_point, heading
        from tandem.explain.floor import Floor, sentences

        if isinstance(answer, TaskAnswer):
            lines = answer.sentences()
        elif isinstance(answer, Floor):
            lines = [*sentences(answer), ""]
        else:
            lines = [heading(answer, chosen_point(answer, self.point)), ""]
        click.echo("\n".join(lines))


def check_time(time_limit: float, workers: int | None) -> None:
    """Raises UsageError for a time limit or a number of workers that makes no sense."""
    if not time_limit > 0:
        raise UsageError(f"--time-limit {time_limit}: must be more than 0 seconds.")
    if workers is not None and workers < 1:
        raise UsageError(f"--workers {workers}: must be 1 or more.")
