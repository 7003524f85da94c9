"""What if: the options of a command that plans a variant, and what becomes of the front."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

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


def tell_difference(
    base: Cell, front: Front, plan_base: Callable[[], Front], lang: str = "en"
) -> None:
    """Prints what the variant changed in the cell, and what becomes of each point of the base's
    front.
    """
    from tandem.errors import InfeasibleError, NothingFoundError
    from tandem.explain.compare import compare_cells
    from tandem.explain.language import words

    t = words(lang)
    changed = [f"  {change.sentence(lang)}" for change in compare_cells(base, front.cell)]
    click.echo("\n".join(["", t("fronts.with"), *changed]))
    try:
        click.echo("\n".join(difference_lines(plan_base(), front, lang)))
    except InfeasibleError:
        click.echo(t("fronts.infeasible"))
    except NothingFoundError:
        click.echo(t("fronts.not_found"))


def difference(
    base: Cell, front: Front, plan_base: Callable[[], Front], lang: str = "en"
) -> dict[str, Any]:
    """What `tell_difference` says, for programs: the changes of the cell, and of each point of the
    base's front.

    `base` is None, and `points` empty, when the cell as it is has no schedule or none was found;
    `why` says which.
    """
    from tandem.errors import InfeasibleError, NothingFoundError
    from tandem.explain.compare import compare_cells
    from tandem.explain.fronts import changes

    found: dict[str, Any] = {
        "cell": [change.to_dict(lang) for change in compare_cells(base, front.cell)],
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


def difference_lines(base: Front, other: Front, lang: str = "en") -> list[str]:
    """A table: for each point of the base, what the other front offers at the same stress and in
    the same time.
    """
    from tandem.explain.fronts import changes
    from tandem.explain.language import words

    t = words(lang)
    heads = ("point", "makespan", "stress", "same_stress", "same_time")
    table: list[tuple[str, ...]] = [tuple(t(f"fronts.{head}") for head in heads)]
    for place, change in enumerate(changes(base, other), 1):
        faster = easier = t("fronts.impossible")
        if change.makespan_then is not None and change.seconds is not None:
            time, more = t.seconds(change.makespan_then), t.signed(change.seconds)
            faster = t("fronts.faster", makespan=time, more=more)
        if change.stress_then is not None and change.more_stress is not None:
            load, more = t.number(change.stress_then), t.signed(change.more_stress)
            easier = t("fronts.easier", stress=load, more=more)
        values = (t.seconds(change.makespan), t.number(change.stress))
        table.append((str(place), *values, faster, easier))
    points = ", ".join(
        t("fronts.pair", makespan=t.seconds(time), stress=t.number(load))
        for time, load in other.points
    )
    lines = aligned(table)
    lines.append(t("fronts.then" if other.complete else "fronts.then.open", points=points))
    before, after = base[0].cost, other[0].cost
    if before is not None and after is not None:
        more = t.signed(round(after - before, 4))
        lines.append(t("fronts.cost", before=t.number(before), after=t.number(after), more=more))
    if not (base.complete and other.complete):
        lines.append(t("fronts.unproven"))
    return lines
