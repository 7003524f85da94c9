"""A cell is frozen, knows the ways of doing a task, and survives every kind of copy."""

from __future__ import annotations

import copy
import pickle

import pytest
from hypothesis import given
from pydantic import ValidationError
from tests.strategies import cells

from tandem.cell.parts import Mode
from tandem.errors import CellError
from tandem.files.validate import cell_of

PRESS = {
    "operators": {"cobot": {"kind": "robot"}, "anna": {"kind": "human"}, "ben": {"kind": "human"}},
    "tasks": {
        "press": {
            "time": {"ben": 5, "cobot": 4.5},
            "together": [
                {"operators": ["ben", "cobot"], "time": 3},
                {"operators": ["ben", "anna"], "time": 2, "stress": {"anna": 1}},
            ],
            "stress": {"ben": 7},
        }
    },
}


def test_modes_are_each_operator_alone_in_the_cells_order_and_then_the_groups():
    assert cell_of(PRESS).modes("press") == (
        Mode(("cobot",), 4.5, {}),
        Mode(("ben",), 5.0, {"ben": 7.0}),
        Mode(("cobot", "ben"), 3.0, {"ben": 7.0}),
        Mode(("anna", "ben"), 2.0, {"anna": 1.0, "ben": 0.0}),
    )


def test_a_cell_is_frozen_all_the_way_down():
    cell = cell_of(PRESS)
    with pytest.raises(ValidationError, match="frozen"):
        cell.tasks["press"].stress = 3
    with pytest.raises(TypeError, match=r"frozen; make a variant with cell\.replace"):
        cell.tasks["press"].time["ben"] = 1  # type: ignore[index]
    with pytest.raises(TypeError, match="frozen"):
        cell.tasks.update({})  # type: ignore[attr-defined]


def test_a_variant_is_checked_again():
    cell = cell_of(PRESS)
    assert cell.replace(name="second").name == "second"
    with pytest.raises(CellError, match="names 'ben', who is no operator"):
        cell.replace(operators={"cobot": {"kind": "robot"}, "anna": {"kind": "human"}})


def test_whole_numbers_may_name_tasks_in_python():
    cell = cell_of(
        {
            "operators": {"h": {"kind": "human"}},
            "tasks": {1: {"time": {"h": 2}}, 2: {"time": {"h": 2}, "after": [1]}},
        }
    )
    assert cell.tasks["2"].after == ("1",)


def test_the_error_can_be_sent_to_another_process():
    with pytest.raises(CellError) as caught:
        cell_of({**PRESS, "same_operator": [["press", "pres"]]})
    assert pickle.loads(pickle.dumps(caught.value)).faults == caught.value.faults


@given(cells())
def test_copies_are_equal_and_have_the_same_digest(cell):
    for twin in (pickle.loads(pickle.dumps(cell)), copy.deepcopy(cell), cell_of(cell.to_dict())):
        assert twin == cell
        assert twin.digest == cell.digest
        assert list(twin.tasks) == list(cell.tasks)


@given(cells())
def test_every_task_of_a_random_cell_can_be_done(cell):
    assert all(cell.modes(task) for task in cell.tasks)
