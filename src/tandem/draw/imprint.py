"""The line by which a picture, a page or a sheet names the plan that it shows."""

from __future__ import annotations

from tandem.draw.language import Words
from tandem.plan.cycle.result import CycleResult
from tandem.plan.result import Result, Status


def imprint(result: Result | CycleResult, t: Words, *, stale: bool = False) -> str:
    """The plan's short digest, and behind it all that is to be known of it: `remarks`, and that
    another run may give another schedule of the same values.
    """
    proven = result.status is Status.OPTIMAL
    others = [t("imprint.not_canonical")] if proven and not result.canonical else []
    named = t(
        "imprint.cycle" if isinstance(result, CycleResult) else "imprint.plan",
        digest=digest_of(result),
    )
    return "; ".join([named, *remarks(result, t, stale=stale), *others])


def digest_of(result: Result | CycleResult) -> str:
    """The digits by which a plan, or a pattern that repeats, is told."""
    if isinstance(result, CycleResult):
        return result.periodic.digest
    return result.schedule.digest


def remarks(result: Result | CycleResult, t: Words, *, stale: bool = False) -> list[str]:
    """What nobody who works by the plan may overlook: that the cell has changed since (`stale`),
    and that it is not proven.
    """
    found = ["stale"] if stale else []
    found += [] if result.status is Status.OPTIMAL else ["unproven"]
    return [t(f"imprint.{key}") for key in found]
