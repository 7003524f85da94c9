"""The JSON Schema: the shipped file is the model's, and it takes what the model takes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from jsonschema import Draft202012Validator
from tests.strategies import cells

from tandem.errors import CellError
from tandem.files import yaml_reader
from tandem.files.formats.table import FORMATS
from tandem.files.load import loads
from tandem.files.schema import SHIPPED, schema, schema_text

EXAMPLES = [
    *sorted(Path(__file__).parents[2].glob("examples/*.yaml")),
    Path(__file__).parents[2] / "examples/ergonomics/thesis-with-facts.yaml",
    Path(__file__).parents[2] / "examples/ergonomics/limits.yaml",
]
VALIDATOR = Draft202012Validator(schema())


def test_the_shipped_schema_is_that_of_the_model():
    assert SHIPPED.read_text("utf-8") == schema_text()


def test_it_is_a_schema_and_describes_every_key():
    Draft202012Validator.check_schema(schema())
    parts = [schema(), *schema()["$defs"].values()]
    undescribed = [
        key
        for part in parts
        for key, item in part["properties"].items()
        if not item.get("description") and key != "format"
    ]
    assert undescribed == []


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_keeps_to_it(path):
    VALIDATOR.validate(yaml_reader.read(path.read_text("utf-8"), path.name).plain())


@given(cells())
def test_it_takes_what_the_model_takes(cell):
    VALIDATOR.validate(cell.to_dict())


GOOD = {"operators": {"h": {"kind": "human"}}, "tasks": {"1": {"time": {"h": 2}}}}


@pytest.mark.parametrize(
    "changes",
    [
        {"tasks": {}},
        {"tasks": {"1": {"time": {"h": 0}}}},
        {"tasks": {"1": {"time": {"h": "2"}}}},
        {"tasks": {"1": {"time": {"h": 2}, "aftr": []}}},
        {"tasks": {" ": {"time": {"h": 2}}}},
        {"tasks": {"1": {"time": {"h": 2}, "stress": -1}}},
        {"tasks": {"1": {"time": {"h": 2}, "stress": {"h": -1}}}},
        {"tasks": {"1": {"together": [{"operators": ["h"], "time": 2}]}}},
        {"operators": {"h": {"kind": "person"}}},
        {"operators": {"h": {"kind": "human", "breaks": [[1, 2, 3]]}}},
        {"zones": {"jig": {"capacity": 0}}},
        {"same_operator": [["1"]]},
        {"format": 2},
    ],
    ids=str,
)
def test_it_refuses_what_the_model_refuses_by_form(changes):
    data = {**GOOD, **changes}
    assert not VALIDATOR.is_valid(data)
    with pytest.raises(CellError):
        loads(json.dumps(data))


def test_every_format_says_what_it_is():
    assert all(format.what for format in FORMATS.values())
