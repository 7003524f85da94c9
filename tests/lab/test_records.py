"""Stored results and records that are damaged: one message with the file and the way out, exit
3.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("jax", reason="needs tandem[learn]")

from tests.mutants import mutants

from tandem.cli.root import run
from tandem.errors import CellError
from tandem.lab import records
from tandem.lab.systems import SYSTEMS

DEEP = b"[" * 100_000 + b"]" * 100_000
DAMAGED = {
    "empty": b"",
    "cut off": b'{"schema_version": 1, "comm',
    "noise": bytes(range(256)),
    "deep": DEEP,
    "zeros": bytes(100),
    "digits": b"9" * 9999,
}
HEADLESS = {
    "null": b"null",
    "a list": b"[]",
    "another version": b'{"schema_version": "1", "command": "x", "versions": {}}',
    "no command": b'{"schema_version": 1, "versions": {}}',
    "versions of numbers": b'{"schema_version": 1, "command": "x", "versions": {"tandem": 1}}',
}


LAB = Path(records.__file__).parent


def shipped_file(name: str) -> Path:
    """The stored result of a system."""
    return LAB / {"thesis": "kinat2023/results.json", "cells": "other_cells.json"}.get(
        name, f"{name}/results.json"
    )


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the stored results are looked for."""
    monkeypatch.setattr(records.resources, "files", lambda _: tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("damage", [*DAMAGED, *HEADLESS, "missing", "a folder"])
def test_a_damaged_stored_result_is_named(
    package: Path, capfd: pytest.CaptureFixture[str], name: str, damage: str
) -> None:
    file = package / shipped_file(name).relative_to(LAB)
    file.parent.mkdir(exist_ok=True)
    if damage == "a folder":
        file.mkdir()
    elif damage != "missing":
        file.write_bytes({**DAMAGED, **HEADLESS}[damage])
    assert run(["reproduce", name, "--stored"]) == 3
    said = capfd.readouterr().err
    assert str(file) in said
    assert "bug" not in said
    assert "tandem reproduce" in said or "is no result of a reproduction" in said


@pytest.mark.parametrize("name", SYSTEMS)
def test_every_stored_result_that_ships_is_read(name: str) -> None:
    document = SYSTEMS[name].load().stored()
    assert document["command"].startswith(f"tandem reproduce {name}")


@pytest.mark.parametrize("damage", DAMAGED)
def test_a_damaged_record_is_named_and_left_alone(tmp_path: Path, damage: str) -> None:
    file = tmp_path / "records" / "one.json"
    assert records.kept_record(file, lambda: {"found": 1}) == {"found": 1}
    assert records.kept_record(file, lambda: {"found": 2}) == {"found": 1}
    file.write_bytes(DAMAGED[damage])
    with pytest.raises(
        CellError,
        match=r"one\.json: is no JSON that can be read .*Delete it: the reproduction makes it anew",
    ):
        records.kept_record(file, lambda: {"found": 3})
    assert file.read_bytes() == DAMAGED[damage]


def test_a_record_of_another_question_is_made_anew(tmp_path: Path) -> None:
    file = tmp_path / "one.json"
    assert records.kept_record(file, lambda: 5, {"p": 1}) == 5
    assert records.kept_record(file, lambda: 6, {"p": 1}) == 5
    assert records.kept_record(file, lambda: 7, {"p": 2}) == 7
    assert records.read_record(file) == 7


# --- one value changed, anywhere ---


@pytest.mark.parametrize("name", SYSTEMS)
def test_a_stored_result_in_which_anything_was_changed_is_never_shown(
    package: Path, name: str
) -> None:
    shipped = json.loads(shipped_file(name).read_text("utf-8"))
    file = package / shipped_file(name).relative_to(LAB)
    file.parent.mkdir(exist_ok=True)
    for mutant in mutants(shipped, seed=3, count=60):
        file.write_text(mutant.text)
        if mutant.document == shipped:
            continue
        with pytest.raises(CellError) as refused:
            SYSTEMS[name].load().stored()
        assert str(file) in str(refused.value), mutant.what
        assert f"tandem reproduce {name}" in str(refused.value), mutant.what


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_command_refuses_a_stored_result_in_which_a_figure_was_changed(
    package: Path, capfd: pytest.CaptureFixture[str], name: str
) -> None:
    text = shipped_file(name).read_text("utf-8")
    digit = text.rindex("1", 0, text.rindex('"sha256"'))
    file = package / shipped_file(name).relative_to(LAB)
    file.parent.mkdir(exist_ok=True)
    file.write_text(text[:digit] + "2" + text[digit + 1 :])
    assert run(["reproduce", name, "--stored"]) == 3
    said = capfd.readouterr().err
    assert said.count(str(file)) == 1
    assert "was changed or damaged after it was written" in said
    assert f"tandem reproduce {name}" in said


@pytest.mark.parametrize("seed", range(3))
def test_a_record_in_which_anything_was_changed_is_refused_and_kept(
    tmp_path: Path, seed: int
) -> None:
    file = tmp_path / "one.json"
    found = json.loads(shipped_file("zhang2022").read_text("utf-8"))["records"][:2]
    records.kept_record(file, lambda: found, {"factor": 1.5})
    written = json.loads(file.read_text())
    for mutant in mutants(written, seed, count=60):
        if mutant.document == written:
            continue
        file.write_text(mutant.text)
        with pytest.raises(
            CellError, match=r"one\.json: .*Delete it: the reproduction makes it anew"
        ):
            records.kept_record(file, lambda: pytest.fail("made again"), {"factor": 1.5})
        assert file.read_text() == mutant.text


def test_a_result_of_a_reproduction_is_no_record_of_one(tmp_path: Path) -> None:
    file = tmp_path / "one.json"
    file.write_bytes(shipped_file("yu2021").read_bytes())
    with pytest.raises(CellError, match="is no record of a reproduction"):
        records.read_record(file)


def test_what_is_not_a_number_is_kept_as_it_was(tmp_path: Path) -> None:
    file = tmp_path / "one.json"
    records.kept_record(file, lambda: {1: (float("nan"), 1e-7, 10**30)})
    assert str(records.read_record(file)) == "{'1': [nan, 1e-07, 1000000000000000000000000000000]}"
