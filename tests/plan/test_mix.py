"""Several products in each cycle."""

from __future__ import annotations

from pathlib import Path

import pytest

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError, UsageError
from tandem.files.validate import cell_of
from tandem.plan.cycle.methods import plan_cycle
from tandem.plan.cycle.mix import each_alone, plan_mix, product_of, shares
from tandem.schedule.cycle import combined

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def cover() -> Cell:
    data = tandem.load(EXAMPLES / "cover.yaml").to_dict()
    data["variants"] = {
        "long": {"share": 1, "tasks": {"drive screws": {"time": {"cobot": 24, "anna": 30}}}},
        "plain": {"share": 2, "tasks": {"grease": None}},
    }
    return cell_of(data)


@pytest.mark.parametrize(("products", "seconds"), [(1, 31), (2, 57), (3, 85), (4, 113)])
def test_products_may_take_turns_between_two_ways(cover: Cell, products: int, seconds: int):
    front = plan_mix(cover, {"base": products}, minimize="cycle_time")
    assert (front[0].cycle_time, front.complete, front.products) == (seconds, True, products)
    assert front.to_dict()["products_per_cycle"] == products


def test_twelve_products_a_cycle_come_within_a_twelfth_of_the_mean_of_two_ways(cover: Cell):
    """Five in twelve by the one, seven by the other: 31a + 26(1 - a) = 24a + 31(1 - a) s, so that
    no mix of the two, and as the proof shows no other, is below 337 / 12 s a product.
    """
    front = plan_mix(cover, {"base": 12}, minimize="cycle_time", time_limit=120)
    assert (front[0].cycle_time, front.complete) == (337, True)


def test_both_proofs_agree_on_a_mix(cover: Cell):
    small = product_of(cover, "plain")
    mix = combined([small, small])
    fronts = [
        plan_cycle(mix, method=method, minimize="cycle_time") for method in ("exact", "exhaustive")
    ]
    assert fronts[0].points == fronts[1].points


def test_one_allocation_for_all_is_never_quicker(cover: Cell):
    mix = {"long": 1, "plain": 2}
    free, tied = (
        plan_mix(cover, mix, one_allocation=one, minimize="cycle_time")[0] for one in (False, True)
    )
    assert free.cycle_time <= tied.cycle_time
    who: dict[str, set[tuple[str, ...]]] = {}
    for row in tied.schedule:
        who.setdefault(row.task.rpartition(" #")[0], set()).add(row.operators)
    assert all(len(groups) == 1 for groups in who.values())
    alone = each_alone(cover, mix)
    assert alone.seconds == {
        name: plan_cycle(product_of(cover, name), minimize="cycle_time")[0].cycle_time
        for name in mix
    }
    assert alone.worst == max(alone.seconds.values())
    assert alone.mean == pytest.approx((alone.seconds["long"] + 2 * alone.seconds["plain"]) / 3)
    assert free.cycle_time <= 3 * alone.mean + 1e-9


def test_shares_are_told_in_the_fewest_products(cover: Cell):
    assert shares(cover) == {"long": 1, "plain": 2}
    data = cover.to_dict()
    data["variants"]["long"]["share"], data["variants"]["plain"]["share"] = 0.25, 0.75
    assert shares(cell_of(data)) == {"long": 1, "plain": 3}


def test_wrong_mixes_are_refused(cover: Cell):
    with pytest.raises(UsageError, match=r"'lang'.*Did you mean 'long'"):
        plan_mix(cover, {"lang": 1})
    with pytest.raises(UsageError, match="base=0"):
        plan_mix(cover, {"base": 0})
    with pytest.raises(UsageError, match="empty mix"):
        plan_mix(cover, {})
    with pytest.raises(CellError):
        plan_mix(tandem.load(EXAMPLES / "strain-index.yaml"), {"base": 2})
