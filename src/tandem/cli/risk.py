"""What `tandem plan` does about times that scatter: the risk of each point of the front."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import click

from tandem.errors import TandemError, UsageError

if TYPE_CHECKING:
    from tandem.plan.result import Front


def told_risk(front: Front, cv: float, robust: bool, wanted: bool | None, quiet: bool) -> Front:
    """The front with the risk of each point, where times scatter or shall; as it is otherwise.

    Args:
      cv: of the times for which the cell states no spread.
      robust: recommend by risk.
      wanted: True for what comes of re-planning too, as with a cv or `robust`; False to leave all
        out although the cell states a spread.

    Raises UsageError when a risk is asked for and nothing scatters, or when it is asked for and
    left out at once.
    """
    if wanted is False and (cv or robust):
        raise UsageError("--no-risk and --cv or --robust exclude each other.")
    stated = any(task.scatters for task in front.cell.tasks.values())
    asked = bool(cv or robust or wanted)
    if wanted is False or not (asked or stated):
        return front
    from tandem.cli.compiled import needs_jax

    try:
        needs_jax("telling the risk of a plan")
    except TandemError as error:
        if asked:
            raise
        click.echo(f"{error} The points are shown without it.", err=True)
        return front
    from tandem.dispatch.evaluation.risk import with_risk

    try:
        return with_risk(
            front,
            cv=cv,
            robust=robust,
            replanned=asked,
            tell=(lambda _: None) if quiet else lambda text: click.echo(text, err=True),
        )
    except TandemError as error:
        if asked:
            raise
        click.echo(f"{error} The points are shown without their risk.", err=True)
        return front
    except KeyboardInterrupt:
        return replace(front, interrupted=True)  # what was planned is not lost
