"""What becomes of makespans where times scatter, as a table: the same in the terminal, in the page,
in the workbook and in Markdown.
"""

from __future__ import annotations

from tandem.plan.result import Front, Quantiles, Risk
from tandem.report.language import Words

RISK_COLUMNS = ("planned", "fixed.p50", "fixed.p95", "replanned.p50", "replanned.p95")
"""Keys of the heads, after the number of the plan."""


def is_told(front: Front) -> bool:
    """Whether the front's risk was asked for."""
    return any(result.risk is not None for result in front)


def risk_values(front: Front) -> list[list[float]]:
    """One row a point that has a risk: its number, then seconds, to a tenth."""
    return [
        [
            place,
            result.makespan,
            *(round(value, 1) for way in _ways(result.risk) for value in (way.p50, way.p95)),
        ]
        for place, result in enumerate(front, 1)
        if result.risk is not None
    ]


def _ways(risk: Risk) -> tuple[Quantiles, Quantiles]:
    return risk.fixed, risk.replanned


def risk_rows(front: Front, t: Words) -> list[list[str]]:
    """The same in words."""
    return [[t.number(value) for value in row] for row in risk_values(front)]


def risk_heads(t: Words) -> list[str]:
    """The heads of such rows."""
    return [t("front.plan"), *(t(f"risk.{head}") for head in RISK_COLUMNS)]


def risk_note(front: Front, t: Words) -> str:
    """What the columns mean, and how many assemblies stand behind them. Assumes that a point has a
    risk.
    """
    told = next(result.risk for result in front if result.risk is not None)
    note = t("risk.note", fixed=told.fixed.episodes, replanned=told.replanned.episodes)
    return f"{note} {t('risk.robust')}" if front.robust else note
