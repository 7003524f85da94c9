"""`tandem explain`, `compare`, `sensitivity` and the what-if of `tandem plan`, as people type
them.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from tandem.cell.model import Cell
from tandem.cli.root import tandem
from tandem.errors import UsageError
from tandem.explain.variant import variant
from tandem.files.load import dump


@pytest.fixture
def cell_file(thesis: Cell, tmp_path: Path) -> Path:
    dump(thesis, tmp_path / "cell.yaml")
    return tmp_path / "cell.yaml"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(tandem, [str(argument) for argument in arguments])


def test_explain(cell_file: Path) -> None:
    result = run("explain", cell_file)
    assert result.exit_code == 0, result.exception
    assert "point 2 of 3: makespan 24 s, stress 3" in result.stdout
    assert "23 s is the floor: tasks 2, 1 and 4 keep robot busy until 18 s" in result.stdout
    assert (
        "instead robot (10 s): +10 s (34 s) at no more stress, or +13 stress (16) in no more time."
        in result.stdout
    )


def test_explain_as_json_prints_one_document(cell_file: Path) -> None:
    result = run("explain", cell_file, "--task", "6", "--point", "1", "--json")
    document = json.loads(result.stdout)
    assert [row["task"] for row in document["tasks"]] == ["6"]
    assert document["makespan"] == 23


def test_what_if_prints_the_difference_per_point(cell_file: Path) -> None:
    result = run("plan", cell_file, "--set", "tasks.6.time.robot=8", "--force", "5=human", "-q")
    assert result.exit_code == 0, result.exception
    assert "task 6: robot takes 8 s instead of 10 s" in result.stdout
    assert "task 5: robot can no longer do it" in result.stdout
    rows = [
        line.split()
        for line in result.stdout.splitlines()
        if line.startswith(("1  ", "2  ", "3  "))
    ]
    assert ["2", "24", "s", "3", "not", "possible", "stress", "7", "(+4)"] in rows


def test_what_if_that_cannot_be(cell_file: Path) -> None:
    result = run("plan", cell_file, "--without", "rob")
    assert isinstance(result.exception, UsageError)
    assert "Did you mean 'robot'" in str(result.exception)


def test_compare_cells(cell_file: Path, thesis: Cell) -> None:
    other = cell_file.with_name("other.yaml")
    dump(variant(thesis, ["tasks.6.time.robot=8"]), other)
    result = run("compare", cell_file, other)
    assert result.stdout.splitlines()[0] == "task 6: robot takes 8 s instead of 10 s"
    assert "at the same stress" in result.stdout
    assert run("compare", cell_file, cell_file).stdout == "the two cells are the same.\n"
    document = json.loads(run("compare", cell_file, other, "--json").stdout)
    assert document["changes"][0]["path"] == ["tasks", "6", "time", "robot"]
    assert len(document["front_changes"]) == 3


def test_compare_results(cell_file: Path) -> None:
    first, second = cell_file.with_name("a.json"), cell_file.with_name("b.json")
    run("plan", cell_file, "-o", first, "-q")
    run("plan", cell_file, "--minimize", "makespan", "-o", second, "-q")
    result = run("compare", first, second)
    assert "makespan 24 s -> 23 s, stress 3 -> 7" in result.stdout
    assert "task 5: robot -> human" in result.stdout
    assert isinstance(run("compare", first, cell_file).exception, UsageError)
    assert isinstance(run("compare", first, second, "--point", "2").exception, UsageError)
    assert "the same operators at the same time" in run("compare", first, first).stdout


def test_sensitivity_with_a_picture(cell_file: Path) -> None:
    picture = cell_file.with_name("tornado.svg")
    result = run(
        "sensitivity", cell_file, "--change", "-10%", "--change", "+10%", "-o", picture, "-q"
    )
    assert result.exit_code == 0, result.exception
    lines = result.stdout.splitlines()
    assert lines[0] == "the front of the cell as it is: 3 points, least makespan 23 s"
    assert lines[3].startswith("1 ")
    assert "task 1" in picture.read_text()
    assert "time -10%" in picture.read_text()
