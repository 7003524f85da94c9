"""Stored results and records that are damaged: one message with the file and the way out, exit
3.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("jax", reason="needs tandem[learn]")

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
    file = package / {"thesis": "kinat2023/results.json", "cells": "other_cells.json"}.get(
        name, f"{name}/results.json"
    )
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
    from tandem.lab.antonelli2021.experiment import _kept

    file = tmp_path / "one.json"
    for text in ("[]", "{}", "null", json.dumps({"asked": {"p": 2}, "found": 1})):
        file.write_text(text)
        assert _kept(file, {"p": 1}, lambda: 5) == 5
        assert json.loads(file.read_text()) == {"asked": {"p": 1}, "found": 5}
