"""What a piece costs."""

from __future__ import annotations

import pytest
from tests.schedule.cells import thesis

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError
from tandem.explain.variant import variant
from tandem.files.validate import cell_of
from tandem.plan.cycle.methods import plan_cycle
from tandem.schedule.cost import cost_of_a_piece, cost_of_an_hour

COST = {"operators": {"human": 36, "robot": 3.6}, "station": 7.2, "invest": 43200, "hours": 12000}


@pytest.fixture
def cell() -> Cell:
    return cell_of({**thesis().to_dict(), "cost": COST})


def test_an_hour_is_everybody_and_everything(cell: Cell):
    assert cost_of_an_hour(cell) == 50.4  # 36 + 3.6 + 7.2 + 43200 / 12000
    assert cost_of_a_piece(cell, 100) == 1.4
    assert cost_of_an_hour(thesis()) is None
    assert cost_of_a_piece(thesis(), 100) is None


def test_each_point_says_what_a_piece_costs(cell: Cell):
    front = tandem.plan(cell)
    assert [row["cost_per_piece"] for row in front.to_dict()["front"]] == [0.322, 0.336, 0.476]
    cycle = plan_cycle(cell)
    assert [row["cost_per_piece"] for row in cycle.to_dict()["front"]] == [
        0.266,
        0.28,
        0.336,
        0.476,
    ]
    assert "cost_per_piece" not in tandem.plan(thesis()).to_dict()["front"][0]


def test_who_is_not_there_costs_nothing(cell: Cell):
    helped = cell_of(
        {
            **cell.to_dict(),
            "operators": {**cell.to_dict()["operators"], "second": {"kind": "robot"}},
            "cost": {**COST, "operators": {**COST["operators"], "second": 5}},
        }
    )
    assert cost_of_an_hour(helped) == 55.4
    assert cost_of_an_hour(variant(helped, without=["second"])) == 50.4


@pytest.mark.parametrize(
    ("cost", "said"),
    [
        ({"operators": {"hmuan": 3}}, "cost.operators.hmuan: .*Did you mean 'human'"),
        ({"invest": 5}, "cost.invest: cost states invest .5. but not hours"),
        ({"hours": 5}, "cost.hours: cost states hours .5. but not invest"),
        ({"station": -1}, "cost.station: "),
        ({"hours": 0, "invest": 3}, "cost.hours: "),
        ({"statoin": 1}, "cost.statoin: .*Did you mean 'station'"),
        (3, "cost: "),
    ],
)
def test_what_is_wrong_is_said_at_its_place(cost: object, said: str):
    with pytest.raises(CellError, match=said):
        cell_of({**thesis().to_dict(), "cost": cost})
