"""How slow each person is today: a Bayesian estimate from what has been seen, with a prior, for
deciders and for the person to see.

A pace is a factor: 2 means twice the stated time. Each work that ended is one observation of it:
the logarithm of (time worked / time stated) scatters normally around the logarithm of the pace, by
the spread that the cell states. The prior's mean and variance are those of `Options.prior` (in
logarithms), so the posterior is normal too (Gelman et al., Bayesian Data Analysis, section 2.5).
Work that is still going on says that it takes longer than it has so far.

What was seen outlives the product (`Situation.learnt`) and fades: with each further task of a
person all that they did before counts a little less, halved after `HALF_LIFE` tasks. The prior does
not fade, so that somebody of whom little is left is believed to be as people are (exponential
forgetting that keeps the prior: Kulhavy and Zarrop, On a general concept of forgetting, Int. J.
Control 58, 1993). A person who is not there forgets nothing.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from statistics import NormalDist

from tandem.cell.model import Cell
from tandem.dispatch.situation.model import NOTHING, Learnt, Running, Situation, Work

NORMAL = NormalDist()
SURE = 0.005
"""Standard deviation (of the logarithm) that is left in any observation: times are told in small
steps, people are no clocks. ASSUMPTION.
"""
NARROW = 0.02
"""A posterior narrower than this (of the logarithm) is taken as one value."""
HALF_LIFE = 100.0
"""Tasks of a person after which what they did before counts half. ASSUMPTION: people change over
hours, not from one product to the next.
"""
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
    """One human's pace: of the person who stands at that place now; see `estimates`."""
    known, going = learnt(situation, human), _going(situation, human)
    if not known.seen:
        total = sum(prior.values())
        shares = _outlasting(
            situation,
            human,
            going,
            [(factor, share / total) for factor, share in sorted(prior.items()) if share > 0],
        )
        return _pace(shares, 0)
    centre, width = _posterior(known, prior)
    if width < NARROW:
        shares = [(_rounded(math.exp(centre)), 1.0)]
    else:
        shares = [(_rounded(math.exp(centre + width * place)), share) for place, share in NODES]
    shares = _outlasting(situation, human, going, shares)
    low, high = math.exp(centre - 1.645 * width), math.exp(centre + 1.645 * width)
    mean = sum(factor * share for factor, share in shares)
    return Pace(mean, min(low, mean), max(high, mean), known.seen, tuple(shares))


def _going(situation: Situation, human: str) -> tuple[str, Running] | None:
    """What the person at this human's place is at, and has been from its beginning."""
    since = situation.joined.get(human, -math.inf)
    return next(
        (
            (task, at)
            for task, at in situation.running.items()
            if human in at.operators and at.rests_since is None and at.start >= since
        ),
        None,
    )


def outlook(
    situation: Situation,
    human: str,
    prior: Mapping[float, float],
    first: Sequence[float],
    second: Sequence[float],
) -> tuple[list[float], list[float] | None]:
    """Draws from the belief about one human.

    Args:
      first, second: shares between 0 and 1, as many of each, independent of each other.

    Returns:
      paces, one for each share; and, where the human is at something, for each pace the normal
      deviate of how long it takes, given that it has not ended yet (None where it is at nothing).
    """
    known = learnt(situation, human)
    if known.seen:
        centre, width = _posterior(known, prior)
        drawn = [math.exp(centre + width * NORMAL.inv_cdf(share)) for share in first]
    else:
        drawn = _quantiles([(factor, share) for factor, share in sorted(prior.items())], first)
    going = _going(situation, human)
    if going is None:
        return drawn, None
    task, at = going
    worked = (situation.now - at.start - at.rested) / at.stated if at.stated > 0 else 0.0
    scatter = math.sqrt(math.log1p(_spread(situation.cell, task, human) ** 2))
    if worked <= 0:
        return drawn, [NORMAL.inv_cdf(share) for share in second]
    likely = [(factor, _survival(worked / factor, scatter)) for factor in sorted(drawn)]
    if sum(share for _, share in likely) < 1e-6:  # slower than was thought possible
        return [max(*drawn, worked * 1.1)] * len(first), [scatter / 2] * len(first)
    drawn = _quantiles(likely, first)
    ahead = []
    for factor, share in zip(drawn, second, strict=True):
        least = 1.0 - _survival(worked / factor, scatter)
        ahead.append(NORMAL.inv_cdf(min(least + (1 - least) * share, 1 - 1e-12)))
    return drawn, ahead


def _quantiles(shares: Sequence[tuple[float, float]], at: Sequence[float]) -> list[float]:
    """The quantiles of (value, weight), values in order, at these probabilities."""
    sums = list(accumulate(share for _, share in shares))
    last = len(shares) - 1
    return [shares[min(bisect_right(sums, one * sums[-1]), last)][0] for one in at]


def learnt(situation: Situation, human: str) -> Learnt:
    """What the work of the person at this human's place has told of their pace until now: at
    earlier products, and at this one since they are there.
    """
    known = situation.learnt.get(situation.person(human), NOTHING)
    since = situation.joined.get(human, -math.inf)
    for work in situation.past:
        if _tells(work, human) and work.start >= since:
            known = _with(known, work.worked / work.stated, _scatter(situation.cell, work, human))
    return known


def _with(known: Learnt, ratio: float, scatter: float) -> Learnt:
    """One observation more: a time that was `ratio` times the stated one; what was known fades."""
    kept = 0.5 ** (1 / HALF_LIFE)
    # the mean of a lognormal time lies above its median
    seen = math.log(ratio) + scatter**2 / 2
    return Learnt(
        kept * known.precision + 1 / scatter**2,
        kept * known.weighted + seen / scatter**2,
        known.seen + 1,
    )


def _tells(work: Work, human: str) -> bool:
    return (
        human in work.operators
        and work.outcome != "broken off"
        and work.stated > 0
        and work.worked > 0
    )


def _posterior(known: Learnt, prior: Mapping[float, float]) -> tuple[float, float]:
    """Mean and standard deviation of the logarithm of the pace."""
    total = sum(prior.values())
    centre = sum(share * math.log(factor) for factor, share in prior.items()) / total
    variance = max(
        sum(share * (math.log(factor) - centre) ** 2 for factor, share in prior.items()) / total,
        SURE**2,
    )
    precision = 1 / variance + known.precision
    return (centre / variance + known.weighted) / precision, precision**-0.5


def _scatter(cell: Cell, work: Work, human: str) -> float:
    """Standard deviation of the logarithm of one observation, from the coefficient of variation
    that the cell states.
    """
    return math.sqrt(math.log1p(_spread(cell, work.task, human) ** 2) + SURE**2)


def _spread(cell: Cell, task: str, human: str) -> float:
    stated = cell.tasks[task].spread
    return stated.get(human, 0.0) if isinstance(stated, Mapping) else stated


def sigma_of(cell: Cell, task: str, operators: Sequence[str]) -> float:
    """Standard deviation of the logarithm of how long these need for the task, by the spread that
    the cell states.
    """
    stated = cell.tasks[task].spread
    cv = max(stated.get(who, 0.0) for who in operators) if isinstance(stated, Mapping) else stated
    return math.sqrt(math.log1p(cv**2))


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
