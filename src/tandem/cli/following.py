"""What a decider is to do, from the options of `tandem dispatch` and `tandem simulate`: the plan
that was chosen, and what is made small.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cell.written import number
from tandem.cli.options import KNEE
from tandem.errors import InfeasibleError, NothingFoundError, UnsoundScheduleError, UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.dispatch.deciders.policy import Chosen
    from tandem.dispatch.lookahead.objective import Objective
    from tandem.plan.result import Front

FRONT_S = 5.0
"""Seconds for the front whose recommended point gives the weights."""
WORTH_LEAVING = 0.02
"""Share of a plan's makespan that leaving it must gain where nothing is said; it is also what
`tandem replan --allow` pays for staying near a plan."""


def steered(
    cell: Cell, given: dict[str, Any], policies: Sequence[str], weights: tuple[float, float] | str
) -> tuple[Objective, Chosen | None]:
    """What is made small, and the plan that is carried out or followed (None: none was chosen).

    Args:
      given: the command's options.
      policies: who decides. With a plan, one of them at least has to heed it.
      weights: where neither weights, nor a limit of stress, nor a plan are given; `KNEE` for those
        of the recommended point.

    Raises:
      UsageError: a point is named without a plan, or there is none of that kind.
      CellError: the plan cannot be read.
      UnsoundScheduleError: it breaks the cell.
    """
    from tandem.dispatch.lookahead.objective import Objective

    limit = given["max_stress"]
    wanted = given["weights"] or ((1.0, 0.0) if limit is not None else weights)
    if given["plan"] is not None:
        front, point = stored(given["plan"], cell, given)
        _is_heeded(policies)
        objective = (
            Objective.of_point(front, point)
            if given["weights"] in (None, KNEE)
            else Objective(*given["weights"])
        )
        return replace(objective, max_stress=limit), _chosen(front, point)
    for option in ("point", "makespan", "stress"):
        if given[option] is not None:
            raise UsageError(f"--{option}: chooses a point of a plan; give it with --plan.")
    if isinstance(wanted, tuple):
        time, stress = wanted
        return Objective(time, stress, limit), None
    recommended = _recommended(cell, given["seed"])
    if recommended is None:
        return Objective(max_stress=limit), None
    front, point = recommended
    objective = replace(Objective.of_point(front, point), max_stress=limit)
    # a fixed plan that is made for the recommended point is that point's, and no other of its kind
    carried = _chosen(front, point) if "fixed" in policies and limit is None else None
    return objective, carried


def change_penalty(given: dict[str, Any], chosen: Chosen | None) -> float:
    """Seconds to gain before an announced task is changed or the plan is left: what is given, else
    a share of the makespan of the plan that was given, else none.
    """
    if given["change_penalty"] is not None:
        return float(given["change_penalty"])
    if given["plan"] is None or chosen is None:
        return 0.0
    return WORTH_LEAVING * chosen.basis.makespan


def stored(path: Path, cell: Cell, given: dict[str, Any]) -> tuple[Front, int]:
    """The front in the file and the index of the point that is meant; where the cell has changed
    since, that is said.
    """
    from tandem.report.stored import point_of, read_plan

    try:
        plan = read_plan(path, cell)
    except UnsoundScheduleError as error:
        raise UnsoundScheduleError(
            [
                *error.faults,
                f"{path}: this is no plan of {cell.name!r} as it is now. Plan anew, or change it a"
                " little: tandem replan CELL --from PLAN.json",
            ]
        ) from None
    if plan.is_stale:
        click.echo(
            f"{plan.stale_note()} Its schedules still keep it, and may not be the best any more.",
            err=True,
        )
    return plan.front, point_of(plan.front, given["point"], given["makespan"], given["stress"])


def _is_heeded(policies: Sequence[str]) -> None:
    from tandem.dispatch.deciders.table import POLICIES

    heeding = [name for name, entry in POLICIES.sound().items() if entry.follows]
    known = [name for name in policies if name in POLICIES]
    if known and not any(POLICIES[name].follows for name in known):
        raise UsageError(
            f"--plan: {', '.join(known)} would not heed it; {', '.join(heeding)} do. Name one of"
            " them with --policy."
        )


def _chosen(front: Front, point: int) -> Chosen:
    from tandem.dispatch.deciders.policy import Basis, Chosen
    from tandem.plan.result import Status

    best = front[point]
    return Chosen(best.schedule, Basis.of(best, proven=best.status == Status.OPTIMAL))


def _recommended(cell: Cell, seed: int) -> tuple[Front, int] | None:
    """The front, as far as it is found in a few seconds, and its recommended point; None where no
    schedule is found. What is not proven is said.
    """
    from tandem.plan.methods import plan

    try:
        front = plan(cell, time_limit=FRONT_S, seed=seed, confirm=False)
    except (InfeasibleError, NothingFoundError) as error:
        why = str(error).splitlines()[0].rstrip(".")
        click.echo(
            f"no point of a front can be recommended ({why}): seconds alone count.", err=True
        )
        return None
    point = front.knee_place
    if not front.complete:
        time, stress = front.points[point]
        click.echo(
            f"the front was not proven within {FRONT_S:g} s: the weights are those of the best"
            f" compromise found, {number(time)} s with a stress of {number(stress)}. --weights or"
            " --plan say better what is wanted.",
            err=True,
        )
    return front, point
