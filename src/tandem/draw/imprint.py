"""The line by which a picture, a page or a sheet names the plan that it shows."""

from __future__ import annotations

from tandem.draw.language import Words
from tandem.plan.result import Result, Status


def imprint(result: Result, t: Words, *, stale: bool = False) -> str:
    """The plan's short digest, and all that a reader must not overlook: that the cell has
    changed since, that it is not proven, that another run may give another schedule of the same
    values.
    """
    open_ends = (
        ["unproven"]
        if result.status is not Status.OPTIMAL
        else []
        if result.canonical
        else ["not_canonical"]
    )
    remarks = [t(f"imprint.{key}") for key in [*(["stale"] if stale else []), *open_ends]]
    return "; ".join([t("imprint.plan", digest=result.schedule.digest), *remarks])
