"""Interquartile means, intervals, profiles and chances: by hand, against SciPy, and against the
library of those who defined them.
"""

from __future__ import annotations

import numpy as np
import pytest

from tandem.bench.statistics import (
    better,
    better_interval,
    interquartile_mean,
    interval,
    mean,
    pooled,
    share_within,
)

SCORES = np.random.default_rng(3).beta(5, 2, size=(10, 6))
OTHERS = np.random.default_rng(4).beta(5, 3, size=(10, 6))
"""`[seeds, cells]`, as rliable takes them."""
STRATA, OTHER_STRATA = list(SCORES.T), list(OTHERS.T)


def test_the_interquartile_mean_leaves_out_a_quarter_at_each_end() -> None:
    assert interquartile_mean(np.array([100.0, 1.0, 2.0, 3.0, -50.0, 4.0, 5.0, 0.0])) == 2.5
    assert interquartile_mean(np.array([1.0, 2.0, 6.0])) == 3.0  # a quarter of three is none
    assert list(interquartile_mean(np.array([[0.0, 1, 2, 9], [4, 4, 6, 6]]))) == [1.5, 5.0]


@pytest.mark.parametrize("count", [1, 3, 4, 7, 60])
def test_it_is_the_trimmed_mean_of_scipy(count: int) -> None:
    stats = pytest.importorskip("scipy.stats", reason="needs SciPy")
    scores = SCORES.ravel()[:count]
    assert interquartile_mean(scores) == pytest.approx(stats.trim_mean(scores, 0.25))


def test_seeds_that_agree_have_an_interval_of_no_width_however_much_cells_differ() -> None:
    strata = [np.full(5, level) for level in (0.2, 0.9, 1.0)]
    assert list(interval(strata, mean)) == pytest.approx([0.7, 0.7])


def test_the_interval_repeats_for_a_seed_and_holds_the_statistic() -> None:
    low, high = interval(STRATA, interquartile_mean, seed=1)
    assert (low, high) == tuple(interval(STRATA, interquartile_mean, seed=1))
    assert low < interquartile_mean(pooled(STRATA)) < high


def test_the_share_within_a_limit_counts_the_limit_itself() -> None:
    shares = share_within(np.array([0.0, 0.5, 1.0]))
    assert list(shares(np.array([0.5, 0.7, 1.0, 2.0]))) == [0.0, 0.25, 0.75]


def test_the_chance_of_being_better_counts_ties_half_and_cells_alike() -> None:
    first = [np.array([2.0, 2.0]), np.array([1.0])]
    second = [np.array([1.0, 2.0]), np.array([5.0, 0.0, 0.0, 1.0])]
    assert better(first, second) == pytest.approx((0.75 + 0.625) / 2)


@pytest.mark.parametrize("name", ["iqm", "mean"])
def test_rliable_finds_the_same(name: str) -> None:
    library = pytest.importorskip("rliable.library", reason="needs rliable")
    metrics = pytest.importorskip("rliable.metrics", reason="needs rliable")
    ours, theirs = {
        "iqm": (interquartile_mean, metrics.aggregate_iqm),
        "mean": (mean, metrics.aggregate_mean),
    }[name]
    points, edges = library.get_interval_estimates(
        {"x": SCORES}, lambda scores: np.array([theirs(scores)]), reps=4_000
    )
    assert ours(pooled(STRATA)) == pytest.approx(points["x"][0], abs=1e-12)
    # two bootstraps with other random numbers: 4,000 draws leave about 0.001
    assert interval(STRATA, ours, draws=4_000) == pytest.approx(edges["x"][:, 0], abs=0.006)


def test_rliable_finds_the_same_chance_and_profile() -> None:
    library = pytest.importorskip("rliable.library", reason="needs rliable")
    metrics = pytest.importorskip("rliable.metrics", reason="needs rliable")
    assert better(STRATA, OTHER_STRATA) == pytest.approx(
        metrics.probability_of_improvement(SCORES, OTHERS), abs=1e-12
    )
    _, edges = library.get_interval_estimates(
        {"x": (SCORES, OTHERS)},
        lambda a, b: np.array([metrics.probability_of_improvement(a, b)]),
        reps=400,
    )
    ours = better_interval(STRATA, OTHER_STRATA, draws=400)
    assert ours == pytest.approx(edges["x"][:, 0], abs=0.03)
    limits = np.linspace(0.1, 0.95, 9)
    above = [library.run_score_deviation(SCORES, limit) for limit in limits]
    assert 1 - share_within(limits)(pooled(STRATA)) == pytest.approx(above)
