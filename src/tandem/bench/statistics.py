"""Numbers for a whole sweep, as Agarwal et al. define them: interquartile means, performance
profiles and chances of being better, each with an interval by the stratified bootstrap.

Source: Agarwal, Schwarzer, Castro, Courville, Bellemare (2021), Deep reinforcement learning at the
edge of the statistical precipice, NeurIPS 34, sections 4.1 to 4.3, arXiv:2108.13264. A test holds
these functions against the authors' own library, rliable.

A sweep's scores come in strata: one for each cell (and kind of people), with one score for each
seed. Drawing again happens within each of them, so that every cell keeps its weight.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Scores = NDArray[np.float64]
Strata = Sequence[Scores]
"""`[seeds]` each."""
Statistic = Callable[[Scores], Any]
"""`[..., N]` to `[...]`: along the last axis."""

DRAWS = 2000
"""Of the bootstrap."""
COVERED = (2.5, 97.5)
"""Percentiles between which 95 % of the drawn statistics lie."""


def interquartile_mean(scores: Scores) -> Any:
    """Mean of the middle half, along the last axis: a quarter of the scores, rounded down, is left
    out at each end, as `scipy.stats.trim_mean` does.
    """
    cut = scores.shape[-1] // 4
    return np.sort(scores, axis=-1)[..., cut : scores.shape[-1] - cut].mean(axis=-1)


def mean(scores: Scores) -> Any:
    """Along the last axis."""
    return scores.mean(axis=-1)


def share_within(limits: Scores) -> Statistic:
    """The statistic of a performance profile: for each of the limits, `[L]`, the share of the
    scores that are at most so large; `[..., N]` to `[..., L]`.
    """

    def shares(scores: Scores) -> Any:
        ordered = np.sort(scores.reshape(-1, scores.shape[-1]), axis=-1)
        counted = [np.searchsorted(row, limits, side="right") for row in ordered]
        return np.stack(counted).reshape(*scores.shape[:-1], -1) / scores.shape[-1]

    return shares


def pooled(strata: Strata) -> Scores:
    """`[N]`: the scores of all strata, one after the other."""
    return np.concatenate(strata)


def interval(strata: Strata, statistic: Statistic, *, draws: int = DRAWS, seed: int = 0) -> Any:
    """`[2, ...]`: 95 % interval of a statistic of the pooled scores, by the percentiles of
    `draws` samples, each drawn with replacement within every stratum.
    """
    return np.percentile(statistic(_drawn(strata, draws, seed)), COVERED, axis=0)


def _drawn(strata: Strata, draws: int, seed: int) -> Scores:
    """`[draws, N]`: the strata drawn anew so many times."""
    generator = np.random.default_rng(seed)
    return np.concatenate(
        [scores[generator.integers(len(scores), size=(draws, len(scores)))] for scores in strata],
        axis=1,
    )


def better(first: Strata, second: Strata) -> float:
    """The chance that a score of the first is larger than one of the second on the same stratum,
    ties counting half (Mann and Whitney 1947); mean over the strata.
    """
    return float(np.mean([_wins(a[None], b[None])[0] for a, b in zip(first, second, strict=True)]))


def better_interval(
    first: Strata, second: Strata, *, draws: int = DRAWS, seed: int = 0
) -> tuple[float, float]:
    """95 % interval of `better`: both are drawn anew within each stratum."""
    generator = np.random.default_rng(seed)
    wins = []
    for pair in zip(first, second, strict=True):
        a, b = (
            scores[generator.integers(len(scores), size=(draws, len(scores)))] for scores in pair
        )
        wins.append(_wins(a, b))
    low, high = np.percentile(np.mean(wins, axis=0), COVERED)
    return float(low), float(high)


def _wins(first: Scores, second: Scores) -> Scores:
    """`[D]`: of `[D, N]` and `[D, M]` the share of pairs of which the first one is larger."""
    a, b = first[:, :, None], second[:, None, :]
    return np.asarray(((a > b) + 0.5 * (a == b)).mean(axis=(1, 2)))
