"""How slow each person is today: a Bayesian estimate from what has been seen, with a prior, for
deciders and for the person to see.

A pace is a factor: 2 means twice the stated time. Each work that ended is one observation of it:
the logarithm of (time worked / time stated) scatters normally around the logarithm of the pace, by
the spread that the cell states. The prior's mean and variance are those of `Options.prior` (in
logarithms), so the posterior is normal too (Gelman et al., Bayesian Data Analysis, section 2.5).
Work that is still going on says that it takes longer than it has so far.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from tandem.cell.model import Cell
from tandem.dispatch.situation.model import Running, Situation, Work

SURE = 0.005
"""Standard deviation (of the logarithm) that is left in any observation: times are told in small
steps, people are no clocks. ASSUMPTION.
"""
NARROW = 0.02
"""A posterior narrower than this (of the logarithm) is taken as one value."""
NODES = ((0.0, 2 / 3), (-math.sqrt(3), 1 / 6), (math.sqrt(3), 1 / 6))
"""Gauss-Hermite: three values that stand for a normal distribution up to its fifth moment,
(standard deviations, share).
"""


@dataclass(frozen=True)
class Pace:
    """What is believed of one operator's pace.

    Attributes:
      mean: factor on stated times, expected.
      low, high: between these with 90 %.
      seen: how many pieces of work it rests on.
      shares: (factor, probability) that stand for the whole belief.
    """

    mean: float
    low: float
    high: float
    seen: int
    shares: tuple[tuple[float, float], ...]

    @property
    def words(self) -> str:
        """For the person to see."""
        if not self.seen:
            return "not known yet"
        return (
            f"about {self.mean:.2f} times the stated times ({self.low:.2f} to {self.high:.2f}, from"
            f" {self.seen} task{'s' if self.seen > 1 else ''})"
        )


def estimates(situation: Situation, prior: Mapping[float, float]) -> dict[str, Pace]:
    """Every human's pace. `prior`: factor -> probability, before anything was seen. Robots keep
    their stated times.
    """
    return {human: estimate(situation, human, prior) for human in situation.cell.humans}


def estimate(situation: Situation, human: str, prior: Mapping[float, float]) -> Pace:
    """One human's pace; see `estimates`."""
    seen = [
        (work.worked / work.stated, _scatter(situation.cell, work, human))
        for work in situation.past
        if _tells(work, human)
    ]
    going = next(
        (
            (task, at)
            for task, at in situation.running.items()
            if human in at.operators and at.rests_since is None
        ),
        None,
    )
    if not seen:
        total = sum(prior.values())
        shares = _outlasting(
            situation,
            human,
            going,
            [(factor, share / total) for factor, share in sorted(prior.items()) if share > 0],
        )
        return _pace(shares, 0)
    centre, width = _posterior(seen, prior)
    if width < NARROW:
        shares = [(_rounded(math.exp(centre)), 1.0)]
    else:
        shares = [(_rounded(math.exp(centre + width * place)), share) for place, share in NODES]
    shares = _outlasting(situation, human, going, shares)
    low, high = math.exp(centre - 1.645 * width), math.exp(centre + 1.645 * width)
    mean = sum(factor * share for factor, share in shares)
    return Pace(mean, min(low, mean), max(high, mean), len(seen), tuple(shares))


def _tells(work: Work, human: str) -> bool:
    return (
        human in work.operators
        and work.outcome != "broken off"
        and work.stated > 0
        and work.worked > 0
    )


def _posterior(
    seen: list[tuple[float, float]], prior: Mapping[float, float]
) -> tuple[float, float]:
    """Mean and standard deviation of the logarithm of the pace."""
    total = sum(prior.values())
    centre = sum(share * math.log(factor) for factor, share in prior.items()) / total
    variance = max(
        sum(share * (math.log(factor) - centre) ** 2 for factor, share in prior.items()) / total,
        SURE**2,
    )
    precision, weighted = 1 / variance, centre / variance
    for ratio, scatter in seen:
        precision += 1 / scatter**2
        # the mean of a lognormal time lies above its median
        weighted += (math.log(ratio) + scatter**2 / 2) / scatter**2
    return weighted / precision, precision**-0.5


def _scatter(cell: Cell, work: Work, human: str) -> float:
    """Standard deviation of the logarithm of one observation, from the coefficient of variation
    that the cell states.
    """
    return math.sqrt(math.log1p(_spread(cell, work.task, human) ** 2) + SURE**2)


def _spread(cell: Cell, task: str, human: str) -> float:
    stated = cell.tasks[task].spread
    return stated.get(human, 0.0) if isinstance(stated, Mapping) else stated


def _outlasting(
    situation: Situation,
    human: str,
    going: tuple[str, Running] | None,
    shares: list[tuple[float, float]],
) -> list[tuple[float, float]]:
    """The shares, given that what the human is at has not ended yet."""
    if going is None:
        return shares
    task, at = going
    worked = situation.now - at.start - at.rested
    if worked <= 0 or at.stated <= 0:
        return shares
    scatter = math.sqrt(math.log1p(_spread(situation.cell, task, human) ** 2))
    left = [
        (factor, share * _survival(worked / (at.stated * factor), scatter))
        for factor, share in shares
    ]
    total = sum(share for _, share in left)
    if total < 1e-9:  # slower than was thought possible
        return [(_rounded(max(shares[-1][0], worked / at.stated * 1.1)), 1.0)]
    return [(factor, share / total) for factor, share in left if share > 1e-6 * total]


def _survival(ratio: float, scatter: float) -> float:
    """The probability that a time of mean 1 is longer than `ratio`."""
    if scatter < 1e-9:
        return 1.0 if ratio < 1 - 1e-9 else 0.0
    return 0.5 * math.erfc((math.log(ratio) / scatter + scatter / 2) / math.sqrt(2))


def _pace(shares: list[tuple[float, float]], seen: int) -> Pace:
    return Pace(
        sum(factor * share for factor, share in shares),
        shares[0][0],
        shares[-1][0],
        seen,
        tuple(shares),
    )


def _rounded(factor: float) -> float:
    return round(factor, 3)
