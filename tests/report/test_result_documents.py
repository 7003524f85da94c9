"""A file that is no result document is refused with the place in it, and without a word of
Python.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tandem.cli.root import run

CELL = "operators: {r: {kind: robot}}\ntasks: {1: {time: {r: 9}}}\n"
ROW = {"task": "1", "operators": ["r"], "start": 0, "end": 9}


def document(*rows: object) -> str:
    return json.dumps({"front": [{"assignments": list(rows)}]})


@pytest.fixture
def checked(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Checks a result document against a cell of one task; gives the exit code and what was said on
    stderr.
    """
    (tmp_path / "cell.yaml").write_text(CELL, encoding="utf-8")

    def check(text: str | bytes) -> tuple[int, str]:
        file = tmp_path / "result.json"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        code = run(["check", str(tmp_path / "cell.yaml"), str(file)])
        return code, capsys.readouterr().err.replace(f"{tmp_path}/", "")

    return check


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "{}",
            (
                "result.json: is no result document, but a mapping without a list `front`. Give"
                " what `tandem plan CELL --json` prints."
            ),
        ),
        ("[1]", "is no result document, but a list without a list `front`"),
        ('{"front": 3}', "is no result document, but a mapping without a list `front`"),
        ('{"front": [{}]}', "point 1 of the front is a mapping without a list `assignments`"),
        ('{"front": [7]}', "point 1 of the front is 7 without a list `assignments`"),
        ('{"front":\n [', "result.json:2:3: is no result document: no well-formed JSON here"),
        ("[" * 100_000, "result.json: is no result document: no JSON text"),
        (b'{"front": "\xff"}', "result.json: is no result document: no JSON text"),
        (
            document({"task": "1"}),
            "point 1 of the front, assignment 1: `operators` and `start` and `end` are missing",
        ),
        (
            document(ROW, 3),
            (
                'assignment 2: is 3, but must be like {"task": "1", "operators": ["robot"],'
                ' "start": 0, "end": 9}'
            ),
        ),
        (
            document({**ROW, "operators": "r"}),
            "assignment 1: operators is 'r', but must be a list of names",
        ),
        (
            document({**ROW, "start": None}),
            "assignment 1: start is empty, but must be a number of seconds",
        ),
        (
            document({**ROW, "end": True}),
            "assignment 1: end is true, but must be a number of seconds",
        ),
        (
            document({**ROW, "end": float("nan")}),
            "assignment 1: end is not a number, but must be a number of seconds",
        ),
        (document({**ROW, "task": []}), "assignment 1: task is a list, but must be a name"),
    ],
)
def test_what_is_no_result_document_is_refused_at_its_place(
    checked, text: str | bytes, said: str
) -> None:
    code, message = checked(text)
    assert code == 3
    assert said in message
    assert not any(
        sign in message for sign in ("KeyError", "TypeError", "None", "True", "{'", "bug")
    )


def test_everything_that_is_wrong_is_said_at_once(checked) -> None:
    code, message = checked(document({"task": "1"}, 3, {**ROW, "start": "soon"}))
    assert code == 3
    assert message.count("assignment") == 3


def test_a_sound_document_that_breaks_its_cell_is_another_matter(checked) -> None:
    assert checked(document(ROW))[0] == 0
    assert checked(document({**ROW, "start": -1, "end": 8}))[0] == 6
