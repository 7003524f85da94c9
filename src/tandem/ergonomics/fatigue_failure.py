"""What three tools of fatigue failure share: damage per cycle adds up like wear of a material, and
the dose of a day gives the chance that the job is one that injures.

Source: Gallagher S, Schall MC, Sesek RF, Huangfu R (2018) Human Factors 60(8):1146-1162, equations
1 to 6; the S-N curve of tendon, S = 101.25 - 14.83 log10 N, is used by DUET and the Shoulder Tool.
Palmgren-Miner: damage of different cycles is added.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from tandem.ergonomics.outcome import Outcome, Reason, Step


def cycles_to_failure(percent_of_ultimate: float) -> float:
    """N of the S-N curve of tendon at a stress in % of the ultimate one."""
    return float(10 ** ((101.25 - percent_of_ultimate) / 14.83))


def probability(dose: float, intercept: float, slope: float) -> float:
    """The logistic function of the logarithm of a dose; 0 for no dose."""
    if dose <= 0:
        return 0.0
    return 1 / (1 + math.exp(-(intercept + slope * math.log10(dose))))


def outcome(
    method: str,
    steps: Sequence[Step],
    damages: Sequence[float],
    chance: tuple[float, float],
    level: Callable[[float, float], int],
) -> Outcome:
    """The dose of the tasks' damages, the share of each, and the chance that goes with it.

    Args:
      chance: intercept and slope of the logistic function.
      level: dose and chance to the level of action.
    """
    dose = math.fsum(damages)
    risk = probability(dose, *chance)
    outputs: dict[str, Any] = {
        "CD": dose,
        "probability": risk,
        "shares": [damage / dose if dose > 0 else 0.0 for damage in damages],
    }
    told = (
        *steps,
        Step("CD", dose, (Reason("sum_of_damage", float(len(damages))),)),
        Step("probability", risk, (Reason("logistic"),)),
    )
    return Outcome(method, dose, level(dose, risk), outputs, told)
