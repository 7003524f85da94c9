"""Whether one list of results is really larger than another: an exact permutation test, and
intervals.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from itertools import combinations

MOST_SPLITS = 200_000
"""So many ways of splitting the results are all looked at; beyond, as many are drawn."""


def larger(first: Sequence[float], second: Sequence[float], *, seed: int = 0) -> float:
    """The one-sided p-value of "the mean of `first` is larger".

    It is the share of all ways to split the pooled results in two such lists in which the first
    would have at least so large a mean. Exact up to 200,000 splits (10 against 10 have 184,756);
    beyond, that many are drawn with the seed, and the given split counts as one of them.
    Source: Fisher's permutation test; Phipson and Smyth (2010), doi 10.2202/1544-6115.1585, for
    drawn splits.
    """
    pooled, size = [*first, *second], len(first)
    reached = math.fsum(first) - 1e-12
    if math.comb(len(pooled), size) <= MOST_SPLITS:
        sums = [math.fsum(chosen) >= reached for chosen in combinations(pooled, size)]
        return sum(sums) / len(sums)
    draw = random.Random(seed)
    as_large = sum(math.fsum(draw.sample(pooled, size)) >= reached for _ in range(MOST_SPLITS))
    return (as_large + 1) / (MOST_SPLITS + 1)


def rank_sum(first: Sequence[float], second: Sequence[float]) -> float:
    """U of Mann and Whitney (1947) as a share: how often a result of `first` is larger than one of
    `second`, ties counting half.
    """
    wins = sum((a > b) + 0.5 * (a == b) for a in first for b in second)
    return wins / (len(first) * len(second))


def interval(values: Sequence[float], *, seed: int = 0, draws: int = 10_000) -> tuple[float, float]:
    """95 % interval of the mean, by drawing the results again with the seed (percentile bootstrap;
    Efron 1979).

    Shares near 0 or 1 have no normal interval.
    """
    draw, number = random.Random(seed), len(values)
    means = sorted(math.fsum(draw.choices(values, k=number)) / number for _ in range(draws))
    return means[round(0.025 * (draws - 1))], means[round(0.975 * (draws - 1))]
