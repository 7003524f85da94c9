"""What becomes of makespans where times scatter, as a table: the same in the terminal, in the page,
in the workbook and in Markdown.
"""

from __future__ import annotations

from tandem.plan.result import Front
from tandem.report.language import Words

FIXED, REPLANNED = ("planned", "fixed.p50", "fixed.p95"), ("replanned.p50", "replanned.p95")
"""Keys of the heads, after the number of the plan."""


def is_told(front: Front) -> bool:
    """Whether the front's risk was asked for."""
    return any(result.risk is not None for result in front)


def risk_values(front: Front) -> list[list[float]]:
    """One row a point that has a risk: its number, then seconds, to a tenth. What re-planning comes
    to stands at the end, if it was asked for.
    """
    rows = []
    for place, result in enumerate(front, 1):
        if result.risk is not None:
            told = [way for way in (result.risk.fixed, result.risk.replanned) if way is not None]
            quantiles = [round(value, 1) for way in told for value in (way.p50, way.p95)]
            rows.append([place, result.makespan, *quantiles])
    return rows


def risk_rows(front: Front, t: Words) -> list[list[str]]:
    """The same in words."""
    return [[t.number(value) for value in row] for row in risk_values(front)]


def risk_heads(front: Front, t: Words) -> list[str]:
    """The heads of such rows."""
    heads = (*FIXED, *(REPLANNED if _is_replanned(front) else ()))
    return [t("front.plan"), *(t(f"risk.{head}") for head in heads)]


def _is_replanned(front: Front) -> bool:
    return any(result.risk is not None and result.risk.replanned is not None for result in front)


def risk_note(front: Front, t: Words) -> str:
    """What the columns mean, and how many assemblies stand behind them. Assumes that a point has a
    risk.
    """
    told = next(result.risk for result in front if result.risk is not None)
    notes = [t("risk.fixed", episodes=told.fixed.episodes)]
    if told.replanned is not None:
        notes.append(t("risk.replanned", episodes=told.replanned.episodes))
    return " ".join([*notes, *([t("risk.robust")] if front.robust else [])])
