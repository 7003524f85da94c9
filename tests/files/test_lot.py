"""Several products in one cell: each keeps its own rules, and the station is there once."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, reject, settings
from tests.strategies import cells

import tandem
from tandem.cell.model import Cell
from tandem.cli.root import run
from tandem.errors import CellError, InfeasibleError, NothingFoundError, NotReadWarning
from tandem.files.load import load
from tandem.files.lot import lot
from tandem.files.validate import cell_of
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule

THESIS = load("examples/thesis.yaml")
STATION: dict[str, Any] = {
    "operators": {
        "cobot": {"kind": "robot", "tool": "grip"},
        "anna": {"kind": "human", "stress_limit": 4.1},
        "press": {"kind": "machine"},
    },
    "tools": {"grip": {"changeover": {"cobot": 2}}},
    "zones": {"bench": {"capacity": 2}},
    "places": {"rack": [0, 0], "table": [3, 4]},
    "walk": {"anna": {"speed": 1}},
}


def product(tasks: Mapping[str, Any], **more: Any) -> Cell:
    return cell_of({**STATION, "tasks": tasks, **more})


def planned(cell: Cell) -> Schedule:
    """A list schedule of the cell; where there is none, the case counts for nothing."""
    try:
        return next(iter(tandem.plan(cell, method="longest-tail"))).schedule
    except (InfeasibleError, NothingFoundError):
        reject()


def moved(schedule: Schedule, product: str, seconds: float = 0.0) -> Schedule:
    """The product's own schedule as a part of the lot's."""
    return Schedule(
        tuple(
            replace(
                row,
                task=f"{product}/{row.task}",
                start=round(row.start + seconds, 6),
                end=round(row.end + seconds, 6),
            )
            for row in schedule.assignments
        )
    )


def of_product(schedule: Schedule, product: str) -> Schedule:
    """What the lot's schedule says of one product, under the names of its own cell."""
    return Schedule(
        tuple(
            replace(row, task=row.task.removeprefix(f"{product}/"))
            for row in schedule.assignments
            if row.task.startswith(f"{product}/")
        )
    )


def without(cell: Cell, *keys: str) -> Cell:
    """The cell without these keys of its operators and tasks, and without a table of stress."""
    data = cell.to_dict()
    data.pop("stress_of_set", None)
    for kind in ("operators", "tasks"):
        data[kind] = {
            name: {key: told for key, told in one.items() if key not in keys}
            for name, one in data[kind].items()
        }
    return cell_of(data)


@given(cells(min_tasks=2))
@settings(max_examples=30, deadline=None)
def test_whatever_a_lot_does_each_product_keeps_its_own_rules(cell: Cell) -> None:
    """The lot's limit is the products' together, and a way over a third place may be no way of the
    product's own: these two are left out.
    """
    cell = without(cell.replace(walk={}), "stress_limit")
    schedule = planned(lot({"A": cell, "B": cell}))
    for name in ("A", "B"):
        assert faults(cell, of_product(schedule, name)) == []


@given(cells(min_tasks=2))
@settings(max_examples=30, deadline=None)
def test_one_product_after_another_is_a_schedule_of_the_lot(cell: Cell) -> None:
    """What belongs to the clock of a product that begins later is left out."""
    cell = without(cell, "breaks", "deadline")
    alone = planned(cell)
    rows = (*moved(alone, "A").assignments, *moved(alone, "B", 1000.0).assignments)
    assert faults(lot({"A": cell, "B": cell}), Schedule(rows)) == []


def test_two_of_the_thesis_take_less_than_one_after_another() -> None:
    front = tandem.plan(lot({"1": THESIS, "2": THESIS}), minimize="makespan", workers=1)
    [best], [alone] = front, tandem.plan(THESIS, minimize="makespan", workers=1)
    assert (best.makespan, alone.makespan) == (38, 23)
    spans = [
        (min(row.start for row in rows), max(row.end for row in rows))
        for rows in (of_product(best.schedule, name).assignments for name in "12")
    ]
    assert max(start for start, _ in spans) < min(end for _, end in spans), "they overlap"


def test_different_products_of_one_station() -> None:
    both = lot(
        {
            "A-17": product(
                {
                    "base": {"label": "Base", "time": {"anna": 4}, "zone": "bench"},
                    "shaft": {"time": {"cobot": 3, "anna": 5}, "after": ["base"], "tool": "grip"},
                    "lid": {"time": {"anna": 1}, "wait": {"after": "shaft", "at_least": 9}},
                },
                same_operator=[["base", "lid"]],
            ),
            "B": product(
                {"in": {"time": {"press": 2}}, "out": {"time": {"press": 1}, "after": ["in"]}},
                operators={
                    **STATION["operators"],
                    "anna": {"kind": "human", "stress_limit": 0.2},
                    "press": {"kind": "machine", "holds": [["in", "out"]]},
                },
            ),
        }
    )
    assert list(both.tasks) == ["A-17/base", "A-17/shaft", "A-17/lid", "B/in", "B/out"]
    assert both.tasks["A-17/base"].label == "A-17: Base"
    assert both.tasks["A-17/lid"].predecessors == ("A-17/shaft",)
    assert both.same_operator == (("A-17/base", "A-17/lid"),)
    assert both.operators["press"].holds == (("B/in", "B/out"),)
    assert both.operators["anna"].stress_limit == 4.3
    assert both.operators["cobot"].tool == "grip"
    assert (both.zones["bench"].capacity, both.tools["grip"].changeover["cobot"]) == (2, 2)
    assert both.walking["anna"]["rack", "table"] == 5


def test_what_is_no_lot_is_told_with_every_reason() -> None:
    tasks = {"a": {"time": {"cobot": 1, "anna": 1}, "tool": "grip"}}
    mine = product(tasks)
    operators = {**STATION["operators"], "cobot": {"kind": "robot", "setup": 3}}
    operators["anna"] = {"kind": "human"}
    other = cell_of(
        {**STATION, "tasks": tasks, "operators": operators, "tools": {}, "cost": {"station": 9}}
    )
    table = cell_of({**STATION, "tasks": tasks, "stress_of_set": {"a": 1, "": 0}})
    few = cell_of(
        {"operators": {"cobot": {"kind": "robot"}}, "tasks": {"a": {"time": {"cobot": 1}}}}
    )
    with pytest.raises(CellError) as raised:
        lot({"A": mine, "B": other, "C": table, "D/": few})
    found = {fault.path for fault in raised.value.faults}
    assert found == {
        (),
        ("B", "operators", "cobot", "setup"),
        ("B", "operators", "cobot", "tool"),
        ("B", "operators", "anna", "stress_limit"),
        ("B", "tools", "grip"),
        ("B", "cost"),
        ("C", "stress_of_set"),
        ("D/", "operators"),
    }
    assert "as product 'A' states it" in str(raised.value)
    with pytest.raises(CellError, match="two products at least"):
        lot({"A": mine})


def test_variants_are_left_out_and_that_is_said() -> None:
    cell = THESIS.replace(variants={"long": {"tasks": {"6": {"time": {"human": 9}}}}})
    with pytest.warns(NotReadWarning, match=r"product 'B': its variants \(long\)"):
        assert not lot({"A": THESIS, "B": cell}).variants


def test_the_command_writes_a_cell_that_can_be_planned(tmp_path: Path, capsys: Any) -> None:
    pair, mixed = tmp_path / "pair.yaml", tmp_path / "mixed.yaml"
    assert run(["generate", "lot", "examples/thesis.yaml", "--times", "2", "-o", str(pair)]) == 0
    assert "14 tasks, 2 operators" in capsys.readouterr().err
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert load(pair) == lot({"1": THESIS, "2": THESIS})
    both = ["A-17=examples/thesis.yaml", "examples/thesis.yaml", "-o", str(mixed)]
    assert run(["generate", "lot", *both]) == 0
    assert list(load(mixed).tasks) == [
        f"{name}/{task}" for name in ("A-17", "2") for task in THESIS.tasks
    ]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (["examples/thesis.yaml"], ["two products at least"]),
        (["A=x.yaml", "A=y.yaml"], ["the name 'A' was given twice"]),
        (["A=x.yaml", "--times", "101"], ["101 is not in the range"]),
        (
            ["A=x.yaml", "y.yaml", "--times", "60"],
            ["A=x.yaml: products of --times are numbered", "a lot of 120: at most 100"],
        ),
    ],
)
def test_wrong_usage_is_told_all_at_once(given: list[str], told: list[str], capsys: Any) -> None:
    assert run(["generate", "lot", *given]) == 2
    said = capsys.readouterr().err
    assert all(text in said for text in told), said
