"""`tandem board` and the pictures of `tandem generate`."""

from __future__ import annotations

import json

import pytest

from tandem.cli.root import run


@pytest.fixture
def desk(tmp_path):
    assert (
        run(
            [
                "generate",
                "desk",
                "-o",
                str(tmp_path / "desk.yaml"),
                "--picture",
                str(tmp_path / "desk.svg"),
            ]
        )
        == 0
    )
    return tmp_path / "desk.yaml"


def test_the_desk_and_its_proven_optimum(desk, capfd):
    assert (desk.parent / "desk.svg").read_text().count("B12b") == 1
    assert run(["board", str(desk), "--optimum", "--json"]) == 0
    document = json.loads(capfd.readouterr().out)
    assert {piece["name"] for piece in document["pieces"]} >= {"A1", "B12b", "C4"}
    assert len(document["pieces"]) == 53
    assert (
        document["optimum"]["no_waiting"]["makespan"]
        == document["optimum"]["waiting"]["makespan"]
        == 94
    )
    assert max(row["end"] for row in document["optimum"]["waiting"]["assignments"]) == 94


def test_a_board_in_the_terminal_stands_as_it_lies(tmp_path, capfd):
    file = tmp_path / "three.yaml"
    file.write_text(
        "operators: {cobot: {kind: robot}, anna: {kind: human}}\n"
        "tasks:\n"
        "  a: {time: {cobot: 2}}\n"
        "  b: {time: {anna: 3}}\n"
        "  c: {time: {cobot: 4, anna: 4}, after: [a, b]}\n"
    )
    assert run(["board", str(file), "-o", str(tmp_path / "board.png")]) == 0
    captured = capfd.readouterr()
    top, bottom = captured.out.splitlines()
    assert (top.split("|")[1].strip("_"), [part.strip("_") for part in bottom.split("|")[1:3]]) == (
        "c E4",
        ["a R2", "b H3"],
    )
    assert len(top) == len(bottom)
    assert (tmp_path / "board.png").stat().st_size > 1000


def test_a_cell_that_is_no_board_is_refused_with_every_reason(capfd):
    assert run(["board", "examples/thesis.yaml"]) == 3
    said = capfd.readouterr().err
    assert (
        "tasks.1.time: a piece takes the same time whoever does it; this one takes robot 9 s and"
        " human 10 s." in said
    )
    assert said.count("the chessboard knows no stress") == 6
