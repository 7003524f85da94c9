"""What `tandem plan` does about times that scatter: the risk of each point of the front."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from time import monotonic
from typing import TYPE_CHECKING

import click

from tandem.cli.compiled import must_have_jax, needs_jax
from tandem.errors import TandemError, UsageError

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.plan.result import Front

PURPOSE = "telling the risk of a plan"
MISSED = {
    "fixed": "No time was left to tell what the points risk:",
    "replanned": "No time was left to plan anew at every event:",
}
"""What there was no time for, by the key of `tandem.plan.result.Risk`."""


@dataclass(frozen=True)
class AskedRisk:
    """What was asked about the risk.

    Attributes:
      cv: of the times for which the cell states no spread.
      robust: recommend by risk.
      wanted: True for what comes of re-planning too, as with a cv or `robust`; False to leave all
        out although the cell states a spread.
    """

    cv: float = 0.0
    robust: bool = False
    wanted: bool | None = None

    @property
    def is_asked(self) -> bool:
        """It was asked for, and is not only told because the cell states a spread."""
        return bool(self.cv or self.robust or self.wanted)

    def check(self, cell: Cell) -> None:
        """Raises UsageError when a risk is asked for and nothing scatters, or when it is asked for
        and left out at once, and TandemError where it cannot be told for want of JAX: before the
        search, which would be in vain.
        """
        if self.wanted is False and self.is_asked:
            raise UsageError("--no-risk and --cv or --robust exclude each other.")
        if self.is_asked:
            from tandem.dispatch.evaluation.risk import check_scatter

            check_scatter(cell, self.cv)
            must_have_jax(PURPOSE)

    def searching(self, time_limit: float) -> float:
        """Seconds of the limit that the search gets: not all of them where a risk is asked for."""
        if not self.is_asked:
            return time_limit
        from tandem.dispatch.evaluation.risk import searching

        return searching(time_limit)

    def is_told_of(self, cell: Cell) -> bool:
        """Whether the points of the cell are to show it."""
        scatters = any(task.scatters for task in cell.tasks.values())
        return self.wanted is not False and (self.is_asked or scatters)


def told_risk(front: Front, asked: AskedRisk, until: float | None, quiet: bool) -> Front:
    """The front with the risk of each point, where times scatter or shall; as it is otherwise.

    Args:
      until: `monotonic()` seconds at which to stop; None to carry out all assemblies.
    """
    if not asked.is_told_of(front.cell):
        return front
    from tandem.dispatch.evaluation.risk import has_time, with_risk

    missed = partial(_say_missed, asked)
    # loading JAX takes a part of a second that the limit does not have
    if not has_time(front, until, monotonic):
        missed("fixed")
        return front
    try:
        needs_jax(PURPOSE)
        return with_risk(
            front,
            cv=asked.cv,
            robust=asked.robust,
            replanned=asked.is_asked,
            until=until,
            tell=(lambda _: None) if quiet else lambda text: click.echo(text, err=True),
            missed=missed,
        )
    except TandemError as error:
        if asked.is_asked:
            raise
        click.echo(f"{error} The points are shown without their risk.", err=True)
        return front
    except KeyboardInterrupt:
        return replace(front, interrupted=True)  # what was planned is not lost


def _say_missed(asked: AskedRisk, what: str) -> None:
    """In one line what there was no time for, and how there would be."""
    remedy = " give a larger --time-limit"
    if not asked.is_asked:
        remedy += ", set a part of it aside with --risk, or leave the risk out with --no-risk"
    elif what == "fixed" and asked.robust:
        remedy += "; so the recommendation goes by the planned makespan"
    click.echo(f"{MISSED[what]}{remedy}.", err=True)
