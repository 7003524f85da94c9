"""Chance: right on average, the same for every decider, and gone when it is off."""

from __future__ import annotations

import jax
import numpy as np
import pytest

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.world.arrays import NEVER, Names
from tandem.world.randomness import (
    OFF,
    Chance,
    Draw,
    away_until,
    nominal_scenario,
    scenario,
    scenarios,
    with_rests,
)


def drawn(cell: Cell, chance: Chance, episodes: int = 4000, undo: float | None = None):
    names = Names.of(cell)
    arrays = names.arrays(undo=undo)
    return (
        names,
        arrays,
        scenarios(jax.random.key(0), Draw.of(names, arrays, chance), arrays, episodes),
    )


@pytest.mark.parametrize("chance", [Chance("lognormal", cv=0.3), Chance("triangular", cv=0.3)])
def test_durations_have_the_stated_mean_and_spread(thesis: Cell, chance: Chance) -> None:
    factor = drawn(thesis, chance)[2].factor
    assert factor.min() > 0
    assert factor.mean() == pytest.approx(1, abs=0.01)
    assert factor.std() == pytest.approx(0.3, abs=0.02)


def test_the_cells_own_spread_comes_first(rich: Cell) -> None:
    _names, arrays, chances = drawn(rich, Chance("lognormal"))
    stated = arrays.spread > 0
    assert stated.sum() == 2
    assert chances.factor[:, stated].std() == pytest.approx(0.2, abs=0.02)
    assert (chances.factor[:, ~stated] == 1).all()


def test_measured_factors_come_as_they_are(thesis: Cell) -> None:
    factor = drawn(thesis, Chance("empirical", factors=(0.5, 1.0, 2.0)))[2].factor
    assert set(np.unique(factor)) == {0.5, 1.0, 2.0}
    assert (factor == 2.0).mean() == pytest.approx(1 / 3, abs=0.02)


def test_off_is_nominal(thesis: Cell) -> None:
    names = Names.of(thesis)
    arrays = names.arrays()
    draw = Draw.of(names, arrays, OFF)
    one = nominal_scenario(draw, arrays)
    assert one.factor.size == one.away_from.size == one.slip.size == 0


def test_breakdowns_are_the_robots_and_absences_the_humans(rich: Cell) -> None:
    names, arrays, chances = drawn(rich, Chance(failure_s=20.0, repair_s=5.0), 2000)
    there = chances.away_from < NEVER
    assert there.any()
    assert not (chances.away[there] & arrays.human[None, :]).any()
    lasts = (chances.away_to - chances.away_from)[there]
    assert lasts.mean() / names.per_second == pytest.approx(5.0, rel=0.05)
    human = drawn(rich, Chance(absence_s=50.0, away_s=10.0), 10)
    there = human[2].away_from < NEVER
    assert not (human[2].away[there] & ~human[1].human[None, :]).any()


def test_work_rests_while_somebody_is_away(thesis: Cell) -> None:
    _names, _arrays, chances = drawn(thesis, Chance(failure_s=10.0), 1)
    two = chances._replace(
        away_from=np.array([3, 6], np.int32),
        away_to=np.array([5, 9], np.int32),
        away=np.array([[True, False], [True, False]]),
    )
    robot, human = np.array([True, False]), np.array([False, True])
    assert with_rests(two, np.int32(0), np.int32(5), robot) == 10, "0-3 and 5-6 and 9-10"
    assert with_rests(two, np.int32(0), np.int32(3), robot) == 3
    assert with_rests(two, np.int32(0), np.int32(5), human) == 5
    assert away_until(two, np.int32(4)).tolist() == [5, 0]


def test_joint_work_rests_once_while_both_are_away(thesis: Cell) -> None:
    _names, _arrays, chances = drawn(thesis, Chance(failure_s=10.0), 1)
    both = chances._replace(
        away_from=np.array([3, 4], np.int32),
        away_to=np.array([8, 6], np.int32),
        away=np.array([[True, False], [False, True]]),
    )
    assert with_rests(both, np.int32(0), np.int32(5), np.array([True, True])) == 10


def test_the_same_numbers_give_the_same_scenario_in_numpy_and_jax(rich: Cell) -> None:
    names = Names.of(rich)
    arrays = names.arrays(undo=1.0)
    draw = Draw.of(names, arrays, Chance("lognormal", cv=0.2, failure_s=30.0, absence_s=40.0))
    uniform = np.random.default_rng(0).random(draw.numbers, np.float32)
    here, there = (
        scenario(draw, arrays, uniform),
        jax.jit(lambda numbers: scenario(draw, arrays, numbers))(uniform),
    )
    for mine, other in zip(here, there, strict=True):
        assert mine.shape == other.shape
        np.testing.assert_allclose(
            mine.astype(float), np.asarray(other).astype(float), rtol=2e-5, atol=1
        )


def test_everything_wrong_is_said_at_once() -> None:
    with pytest.raises(
        UsageError, match=r"(?s)spread='gauss'.*cv is -1.*later is 2.*failure_s is 0.*undo is 0"
    ):
        Chance("gauss", cv=-1, later=2, failure_s=0, undo=0)
    with pytest.raises(UsageError, match=r"a triangle ends at 0\.4"):
        Chance("triangular", cv=0.5)
    with pytest.raises(UsageError, match="needs factors"):
        Chance("empirical")
