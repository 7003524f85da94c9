"""Cell files: what is read is what was written, and what a person may write by hand is taken as
meant.
"""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.errors import CellError, UsageError
from tandem.files.load import dump, dumps, load, loads
from tandem.files.validate import cell_of
from tandem.files.yaml_reader import scalar

EXAMPLES = [
    *sorted(Path(__file__).parents[2].glob("examples/*.yaml")),
    Path(__file__).parents[2] / "examples/ergonomics/thesis-with-facts.yaml",
    Path(__file__).parents[2] / "examples/ergonomics/limits.yaml",
]


@given(cells())
def test_yaml_and_json_give_back_the_same_cell(cell):
    for form in ("yaml", "json"):
        again = loads(dumps(cell, form))
        assert again == cell
        assert list(again.tasks) == list(cell.tasks)
        assert list(again.operators) == list(cell.operators)


@given(name=st.text(min_size=1, max_size=12), other=st.text(min_size=1, max_size=12))
def test_any_name_survives_a_file(name, other):
    """Names that look like numbers, nulls, truth values, or are full of signs that mean something
    in YAML.
    """
    data = {
        "operators": {"h": {"kind": "human"}},
        "tasks": {name: {"time": {"h": 1}, "label": other, "tool": name}},
    }
    try:
        cell = cell_of(data)
    except CellError:
        return  # blank or not storable; that is another rule
    for form in ("yaml", "json"):
        assert loads(dumps(cell, form)) == cell


@pytest.mark.parametrize(
    "name",
    [
        "1.10",
        "010",
        "1e3",
        "null",
        "~",
        "yes",
        "true",
        "0x1F",
        "1:30",
        "-",
        "- a",
        "a: b",
        "a #b",
        "é",
        "[",
        "'",
        '"',
        "*a",
        "&a",
        "!t",
        "<<",
        "\\",
    ],
)
def test_names_are_kept_to_the_letter(name):
    data = {
        "operators": {"h": {"kind": "human"}},
        "tasks": {name: {"time": {"h": 1}}, "next": {"time": {"h": 1}, "after": [name]}},
    }
    for form in ("yaml", "json"):
        cell = loads(dumps(cell_of(data), form))
        assert list(cell.tasks) == [name, "next"]
        assert cell.tasks["next"].after == (name,)


def test_names_written_like_numbers_are_taken_as_written():
    cell = loads(
        "operators: {7: {kind: human}}\n"
        "tasks:\n"
        " 1.10: {time: {7: 1}}\n"
        " 010: {time: {7: 2}, after: [1.10]}\n"
        " 1.1: {time: {7: 2}, after: [010, 1.10], label: 1.50}\n"
    )
    assert list(cell.tasks) == ["1.10", "010", "1.1"]
    assert cell.tasks["1.1"].after == ("010", "1.10")
    assert cell.tasks["1.1"].label == "1.50"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("10", 10), ("010", 10), ("-3", -3), ("+3", 3), ("1.5", 1.5), (".5", 0.5), ("5.", 5.0),
        ("1e3", 1000.0),
        ("true", True), ("false", False), ("null", None),
        ("~", None), ("yes", "yes"), ("no", "no"), ("on", "on"), ("Off", "Off"), ("1_000", "1_000"),
        ("1:30", "1:30"), ("0x10", "0x10"), ("0o17", "0o17"),
        ("2024-01-01", "2024-01-01"), ("1,5", "1,5"), (".inf", float("inf")), ("-.inf",
        float("-inf")), ("+.inf", float("inf")),
    ],
)  # fmt: skip
def test_scalars_are_those_of_yaml_1_2(text, value):
    assert scalar(text) == value
    assert type(scalar(text)) is type(value)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_load_and_come_back(path):
    cell = load(path)
    assert loads(dumps(cell)) == cell
    assert list(loads(dumps(cell)).tasks) == list(cell.tasks)


def test_the_examples_show_every_key():
    """Whoever looks for a key finds it used."""
    text = "\n".join(path.read_text("utf-8") for path in EXAMPLES)
    models = [model.model_fields for model in _models()]
    missing = {key for fields in models for key in fields if f"{key}:" not in text}
    assert missing == set()


def _models():
    from tandem.cell.parts import Operator, Task, Together, Tool, Zone

    return [Cell, Operator, Task, Together, Tool, Zone]


def test_a_cell_file_is_written_one_line_a_task(tmp_path):
    thesis = load(next(path for path in EXAMPLES if path.stem == "thesis"))
    lines = dumps(thesis).splitlines()
    assert "  4: {time: {robot: 2}, after: [1, 2]}" in lines
    assert len(lines) == 2 + 1 + 2 + 1 + 7
    dump(thesis, tmp_path / "cell.yaml")
    dump(thesis, tmp_path / "cell.json")
    assert (tmp_path / "cell.yaml").read_text("utf-8") == dumps(thesis)
    assert json.loads((tmp_path / "cell.json").read_text("utf-8")) == thesis.to_dict()


def test_standard_input_is_read_for_a_dash(monkeypatch):
    monkeypatch.setattr(
        sys,
        "stdin",
        io.TextIOWrapper(io.BytesIO(b"operators: {h: {kind: human}}\ntasks: {1: {time: {h: 0}}}")),
    )
    with pytest.raises(CellError, match=r"standard input:2:20: task '1': time of 'h' is 0"):
        load("-")


def test_a_byte_order_mark_and_windows_line_ends_do_no_harm(tmp_path):
    path = tmp_path / "cell.yaml"
    path.write_bytes(
        b"\xef\xbb\xbfoperators: {h: {kind: human}}\r\ntasks:\r\n  1: {time: {h: 2}}\r\n"
    )
    assert load(path).tasks["1"].time == {"h": 2.0}


def test_an_unknown_format_is_a_wrong_call():
    with pytest.raises(UsageError, match=r"no format 'fsj'\. Did you mean 'fjs'"):
        loads("", "fsj")
    with pytest.raises(UsageError, match=r"cells are not written as 'psplib'\. .* pyjobshop"):
        dumps(load(EXAMPLES[0]), "psplib")
