"""No method returns a plan that exceeds a limit of a person; the exact ones pay no more than they
must; what no plan can keep is said with the limits to blame.
"""

from __future__ import annotations

from decimal import Decimal

import pytest
from tests import limited

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError
from tandem.plan.axes.search import plan_axes
from tandem.plan.cycle.methods import plan_cycle
from tandem.plan.instance import MOST_DUE, Instance
from tandem.plan.methods import METHODS, plan
from tandem.plan.question import Question
from tandem.schedule.checker import faults
from tandem.world.replay import replay


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("limits", "least"), limited.PRICES)
def test_every_method_keeps_them_and_the_exact_ones_pay_the_least(
    method: str, limits: dict[str, float], least: float
) -> None:
    cell = limited.cell(**limits)
    best = METHODS[method](cell, Question("makespan"), time_limit=30)[0]
    assert faults(cell, best.schedule) == []
    assert replay(cell, best.schedule) == best.makespan >= least
    if method in ("exact", "exhaustive"):
        assert best.makespan == least


def bound_to_fail() -> Cell:
    data = limited.data(peak_reba=3)
    data["tasks"]["cover"]["time"] = {"anna": 2}
    return limited.cell_of(data)


@pytest.mark.parametrize("method", ["exact", "exhaustive"])
def test_what_no_plan_keeps_is_proven(method: str) -> None:
    with pytest.raises(InfeasibleError):
        METHODS[method](bound_to_fail(), Question("makespan"), time_limit=30)


def test_the_limit_to_blame_is_named_with_what_lifting_it_gives() -> None:
    with pytest.raises(InfeasibleError) as caught:
        plan(bound_to_fail(), time_limit=30)
    told = " ".join(caught.value.reasons)
    assert "the limit of anna on peak:reba (3) cannot be kept" in told
    assert "Without the limit of anna on peak:reba (3) it works: 6 s" in told


def test_fronts_over_axes_keep_the_cells_limits_and_count_its_shift() -> None:
    front = plan_axes(limited.cell(dose_lifft=0.25), ["makespan", "dose:lifft"])
    assert front.points[0].values[0] == 7
    assert front.cycles == 100


def test_a_station_that_repeats_keeps_them_for_each_product() -> None:
    free, tight = limited.cell(), limited.cell(peak_reba=8)
    assert (
        plan_cycle(free, time_limit=30)[0].cycle_time
        < plan_cycle(tight, time_limit=30)[0].cycle_time
    )


def test_decimals_that_fit_are_counted_exactly_and_others_upwards() -> None:
    (allowance,) = Instance.of(limited.cell(dose_lifft=0.3)).allowances
    assert allowance.most == 3
    data = limited.data(dose_lifft=0.3)
    data["tasks"]["base"]["ergonomics"][1]["score"] = 0.00123456789012345
    fine = Instance.of(limited.cell_of(data))
    (allowance,) = fine.allowances
    (way,) = [way for way in fine.ways[0] if way.dues]
    share = Decimal(way.dues[0][1]) / allowance.most
    assert 0 <= share - Decimal("0.123456789012345") / Decimal("0.3") < Decimal(2) / allowance.most
    assert allowance.most < MOST_DUE
