"""Variants of a product are the cell plus their changes."""

from __future__ import annotations

import pytest
from tests.schedule.cells import thesis

from tandem.cell.model import Cell
from tandem.errors import CellError
from tandem.files.load import load
from tandem.files.validate import cell_of
from tandem.files.yaml_writer import to_yaml

CHANGES = {
    "long": {"share": 2, "tasks": {"6": {"time": {"human": 9}}, "4": None}},
    "new": {"tasks": {"8": {"time": {"robot": 3}, "after": ["7"]}, "2": {"time": {"human": None}}}},
}


@pytest.fixture
def cell() -> Cell:
    return cell_of({**thesis().to_dict(), "variants": CHANGES})


def test_what_is_named_replaces_what_stands_there(cell: Cell):
    base, long, new = cell, cell.variant("long"), cell.variant("new")
    assert (base.tasks["6"].time["human"], long.tasks["6"].time["human"]) == (3, 9)
    assert long.tasks["6"].time["robot"] == base.tasks["6"].time["robot"]
    assert long.tasks["6"].stress == base.tasks["6"].stress
    assert list(new.tasks) == [*base.tasks, "8"]
    assert "human" not in new.tasks["2"].time
    assert not long.variants
    assert long.name == "long"
    assert base.replace(name="Pump").variant("long").name == "Pump, long"


def test_a_task_that_is_taken_out_is_bridged():
    data = thesis().to_dict()
    data["tasks"] = {
        "a": {"time": {"robot": 1}},
        "b": {"time": {"robot": 1}, "after": ["a"]},
        "c": {"time": {"robot": 1}, "after": ["b"]},
        "d": {"time": {"robot": 1}, "after": ["c", "a"]},
    }
    data["same_operator"] = [["b", "d"], ["c", "d"]]
    data["variants"] = {"short": {"tasks": {"b": None, "c": None}}}
    short = cell_of(data).variant("short")
    assert short.tasks["d"].after == ("a",)
    assert short.same_operator == ()


def test_mending_a_time_of_the_cell_mends_every_variant(cell: Cell):
    data = cell.to_dict()
    data["tasks"]["5"]["time"]["human"] = 99
    assert cell_of(data).variant("long").tasks["5"].time["human"] == 99


def test_variants_are_part_of_the_file(cell: Cell, tmp_path):
    path = tmp_path / "cell.yaml"
    path.write_text(to_yaml(cell), encoding="utf-8")
    again = load(path)
    assert again == cell
    assert again.digest == cell.digest != thesis().digest
    assert hash(again) == hash(cell)


@pytest.mark.parametrize(
    ("variants", "said"),
    [
        ({"v": {"share": 0}}, r"^- variants.v.share: variant 'v': share is 0, but must be more than 0"),
        ({"v": {"tasks": {"9": None}}}, r"variants.v.tasks.9: .*takes out task '9'"),
        (
            {"v": {"tasks": {"6": {"time": {"humn": 9}}}}},
            r"variants.v.tasks.6.time.humn: variant 'v': .*Did you mean 'human'",
        ),
        (
            {"v": {"tasks": {"6": {"time": {"human": -9}}}}},
            r"variants.v.tasks.6.time.human: .* is -9, but a time is more than 0 s",
        ),
        ({"v": {"tasks": {"3": {"after": ["7"]}}}}, r"variant 'v': "),
        ({"v": {"taks": {}}}, r"variants.v.taks: .*no key"),
        ({"v": 3}, r"variants.v: "),
        ({"v": {"tasks": {"6": 3}}}, r"variants.v.tasks.6"),
    ],
)
def test_what_is_wrong_is_said_at_its_place(variants: dict, said: str):
    with pytest.raises(CellError, match=said):
        cell_of({**thesis().to_dict(), "variants": variants})


def test_all_faults_of_all_variants_are_said_at_once():
    variants = {
        "v": {"tasks": {"6": {"time": {"human": -9}}, "9": None}},
        "w": {"tasks": {"5": {"after": ["x"]}}},
    }
    with pytest.raises(CellError) as refused:
        cell_of({**thesis().to_dict(), "variants": variants})
    assert len(refused.value.faults) == 3


def test_a_cell_that_is_made_in_python_is_sound_too():
    with pytest.raises(CellError, match="variant 'v'"):
        Cell.model_validate(
            {**thesis().to_dict(), "variants": {"v": {"tasks": {"6": {"time": {"human": -9}}}}}}
        )
