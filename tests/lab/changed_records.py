"""Records of a real reproduction, one figure changed in each: the command must refuse, not go
on.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tandem.cli.root import run


def refuses_changed_records(
    command: list[str], folder: Path, scratch: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Runs the command on copies of the reproduction's folder, in each of which one record was
    changed: exit 3, one message that names the record and the way out, and the record is kept."""
    records = sorted((folder / "records").rglob("*.json"))
    records = [file for file in records if '"sha256"' in file.read_text()]
    assert records
    for number, record in enumerate(records):
        copy = scratch / str(number)
        shutil.copytree(folder, copy)
        file = copy / record.relative_to(folder)
        damaged = one_digit_changed(file.read_text())
        file.write_text(damaged)
        capfd.readouterr()
        assert run([*command, "-o", str(copy)]) == 3, file
        said = [line for line in capfd.readouterr().err.splitlines() if line.startswith("tandem:")]
        assert len(said) == 1
        assert str(file) in said[0]
        assert "Delete it" in said[0]
        assert file.read_text() == damaged


def one_digit_changed(text: str) -> str:
    """Another figure in what was found; the JSON stays well formed."""
    place = next(
        place
        for place in range(text.index('"found"'), len(text))
        if text[place].isdigit() and text[place] != "0"
    )
    return text[:place] + ("2" if text[place] == "1" else "1") + text[place + 1 :]
