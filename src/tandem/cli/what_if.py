"""What if: the options of a command that plans a variant, and what becomes of the front."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from tandem.cell.written import number, signed
from tandem.cli.columns import aligned

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.plan.result import Front


def variant_options(command: Any) -> Any:
    """The options `--set`, `--without` and `--force` of a command that plans a variant; its
    arguments `sets`, `without` and `force`.
    """
    for option in (
        click.option(
            "--force",
            multiple=True,
            metavar="TASK=OPERATOR",
            help="Have the task done so and not otherwise: 5=human, 5=human+robot.",
        ),
        click.option(
            "--without",
            multiple=True,
            metavar="OPERATOR",
            help="Plan as if this operator were not there.",
        ),
        click.option(
            "--set",
            "sets",
            multiple=True,
            metavar="PATH=VALUE",
            help="Plan with another value: tasks.6.time.robot=8, or =-10%, or =none.",
        ),
    ):
        command = option(command)
    return command


def tell_difference(base: Cell, front: Front, plan_base: Callable[[], Front]) -> None:
    """Prints what the variant changed in the cell, and what becomes of each point of the base's
    front.
    """
    from tandem.errors import InfeasibleError, NothingFoundError
    from tandem.explain.compare import compare_cells

    click.echo("")
    click.echo(
        "\n".join(
            [
                "compared with the cell as it is:",
                *(f"  {change}" for change in compare_cells(base, front.cell)),
            ]
        )
    )
    try:
        click.echo("\n".join(difference_lines(plan_base(), front)))
    except InfeasibleError:
        click.echo("the cell as it is has no schedule at all.")
    except NothingFoundError:
        click.echo("no schedule of the cell as it is was found within the limit.")


def difference(base: Cell, front: Front, plan_base: Callable[[], Front]) -> dict[str, Any]:
    """What `tell_difference` says, for programs: the changes of the cell, and of each point of the
    base's front.

    `base` is None, and `points` empty, when the cell as it is has no schedule or none was found;
    `why` says which.
    """
    from tandem.errors import InfeasibleError, NothingFoundError
    from tandem.explain.compare import compare_cells
    from tandem.explain.fronts import changes

    found: dict[str, Any] = {
        "cell": [change.to_dict() for change in compare_cells(base, front.cell)],
        "base": None,
        "points": [],
    }
    try:
        before = plan_base()
    except InfeasibleError:
        return {**found, "why": "infeasible"}
    except NothingFoundError:
        return {**found, "why": "nothing found"}
    points = [[row["makespan"], row["stress"]] for row in before.to_dict()["front"]]
    found["base"] = {
        "cell": base.name,
        "cell_digest": base.digest,
        "complete": before.complete,
        "front": points,
    }
    return {**found, "points": [change.to_dict() for change in changes(before, front)]}


def difference_lines(base: Front, other: Front) -> list[str]:
    """A table: for each point of the base, what the other front offers at the same stress and in
    the same time.
    """
    from tandem.explain.fronts import changes

    table: list[tuple[str, ...]] = [
        ("point", "makespan", "stress", "at the same stress", "in the same time")
    ]
    for place, change in enumerate(changes(base, other), 1):
        time, load = change.makespan_then, change.stress_then
        faster = (
            "not possible" if time is None else f"{number(time)} s ({_signed(change.seconds)} s)"
        )
        easier = (
            "not possible"
            if load is None
            else f"stress {number(load)} ({_signed(change.more_stress)})"
        )
        table.append(
            (str(place), f"{number(change.makespan)} s", f"{number(change.stress)}", faster, easier)
        )
    lines = aligned(table)
    points = ", ".join(f"({number(time)} s, {number(load)})" for time, load in other.points)
    lines.append(f"front then: {points}{'' if other.complete else ', not complete'}")
    if not (base.complete and other.complete):
        lines.append("not everything is proven: the differences are between what was found.")
    return lines


def _signed(value: float | None) -> str:
    return "?" if value is None else signed(value)
