"""Journals of real shifts in which one value was changed: told in one message, exit 3, nothing
written.

Whatever was changed, no command that reads the journal calls it a bug in Tandem.
"""

from __future__ import annotations

import io
import json
import random
import shutil
import sqlite3
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from tests.mutants import mutants

from tandem.cli.root import run

THESIS = str(Path(__file__).parents[2] / "examples" / "thesis.yaml")
DOCUMENTS = ("event", "answer", "decision")
VALUES = (
    None,
    "",
    "seven",
    "{}",
    "[]",
    "null",
    b"\xff\xfe",
    -1,
    1.5,
    2**62,
    "[" * 5000,
    "9" * 9999,
)
"""What a column may hold instead: SQLite takes any value in any column."""


@pytest.fixture(scope="module")
def shift(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A shift that was simulated to its end, with people who change their minds and a robot that
    breaks down.
    """
    file = tmp_path_factory.mktemp("shift") / "shift.db"
    people = ["--simulate", "random:0.5+pace:1.5", "--failures", "40", "--policy", "longest-tail"]
    assert run(["dispatch", THESIS, "--journal", str(file), *people, "--json"]) == 0
    return file


def said(
    arguments: list[str], capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> tuple[int, str]:
    """How the command ends, and what it says beside its answer."""
    monkeypatch.setattr(
        sys, "stdin", io.TextIOWrapper(io.BytesIO(b'{"event": "tick", "at": 9000}\n'))
    )
    capfd.readouterr()
    code = run(arguments)
    return code, capfd.readouterr().err


def judged(
    file: Path, what: str, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> list[int]:
    """Every command that reads a journal, on this one; how each ended."""
    codes = []
    for command in (["--replay"], ["--json"], ["--words"], ["--json", "--policy", "longest-tail"]):
        before = content(file)
        code, err = said(["dispatch", THESIS, "--journal", str(file), *command], capfd, monkeypatch)
        told = f"{what}, {' '.join(command)}: {code} {err}"
        assert "bug in Tandem" not in err, told
        assert "Traceback" not in err, told
        assert code in ((0, 1, 3) if command == ["--replay"] else (0, 2, 3)), told
        if code == 3:
            assert err.count("tandem:") == 1, told
            assert str(file) in err, told
            assert content(file) == before, told
        codes.append(code)
    return codes


def changed(file: Path, statement: str, values: tuple[Any, ...]) -> None:
    with closing(sqlite3.connect(file, isolation_level=None)) as connection:
        connection.execute(statement, values)


def content(file: Path) -> list[Any]:
    """All that stands in the tables, as it is."""
    with closing(sqlite3.connect(file)) as connection:
        connection.text_factory = bytes
        tables = [
            name
            for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
        ]
        return [connection.execute(f"SELECT * FROM {name.decode()}").fetchall() for name in tables]


@pytest.mark.parametrize("column", DOCUMENTS)
def test_a_document_of_an_entry_with_one_value_changed(
    shift: Path, tmp_path: Path, capfd, monkeypatch, column: str
) -> None:
    with closing(sqlite3.connect(shift)) as kept:
        rows = dict(
            kept.execute(f"SELECT number, {column} FROM entries WHERE {column} IS NOT NULL")
        )
    rng, refused = random.Random(7), 0
    for number in rng.sample(sorted(rows), 4):
        for place, mutant in enumerate(mutants(json.loads(rows[number]), seed=number, count=8)):
            file = tmp_path / f"{number}-{place}.db"
            shutil.copy(shift, file)
            changed(
                file, f"UPDATE entries SET {column} = ? WHERE number = ?", (mutant.text, number)
            )
            refused += 3 in judged(
                file, f"entry {number}, {column}, {mutant.what}", capfd, monkeypatch
            )
    assert refused > 10


def test_the_head_of_a_journal_with_one_value_changed(
    shift: Path, tmp_path: Path, capfd, monkeypatch
) -> None:
    with closing(sqlite3.connect(shift)) as kept:
        about = dict(kept.execute("SELECT key, value FROM shift"))
    for key, text in about.items():
        for place, mutant in enumerate(
            mutants(json.loads(text), seed=11, count=25 if key == "settings" else 4)
        ):
            file = tmp_path / f"{key}-{place}.db"
            shutil.copy(shift, file)
            changed(file, "UPDATE shift SET value = ? WHERE key = ?", (mutant.text, key))
            judged(file, f"{key}, {mutant.what}", capfd, monkeypatch)
        file = tmp_path / f"{key}-missing.db"
        shutil.copy(shift, file)
        changed(file, "DELETE FROM shift WHERE key = ?", (key,))
        assert set(judged(file, f"{key} missing", capfd, monkeypatch)) == {3}


COLUMNS = ("number", "received", "line", "event", "id", "answer", "decision", "situation")


@pytest.mark.parametrize("column", COLUMNS)
def test_a_column_of_another_type(
    shift: Path, tmp_path: Path, capfd, monkeypatch, column: str
) -> None:
    for place, value in enumerate(VALUES):
        file = tmp_path / f"{place}.db"
        shutil.copy(shift, file)
        try:
            changed(file, f"UPDATE entries SET {column} = ? WHERE number = 3", (value,))
        except sqlite3.Error:
            continue  # SQLite does not take it
        judged(file, f"{column} = {value!r:.20}", capfd, monkeypatch)


@pytest.mark.parametrize(
    "statement",
    [
        "DELETE FROM entries WHERE number = 3",
        "DELETE FROM entries",
        "ALTER TABLE entries DROP COLUMN situation",
        "ALTER TABLE entries RENAME COLUMN event TO events",
        "UPDATE entries SET event = (SELECT event FROM entries WHERE number = 1) WHERE number = 5",
        "UPDATE entries SET decision = CAST(x'ff22' AS TEXT) WHERE number = 2",
        "DROP TABLE shift",
    ],
)
def test_tables_that_are_not_whole(
    shift: Path, tmp_path: Path, capfd, monkeypatch, statement: str
) -> None:
    file = tmp_path / "shift.db"
    shutil.copy(shift, file)
    changed(file, statement, ())
    assert 3 in judged(file, statement, capfd, monkeypatch)


def test_the_message_names_entry_and_place(shift: Path, tmp_path: Path, capfd, monkeypatch) -> None:
    file = tmp_path / "shift.db"
    shutil.copy(shift, file)
    with closing(sqlite3.connect(file)) as kept:
        decision = json.loads(
            kept.execute("SELECT decision FROM entries WHERE number = 2").fetchone()[0]
        )
    decision["latency_ms"] = "seven"
    changed(file, "UPDATE entries SET decision = ? WHERE number = 2", (json.dumps(decision),))
    code, err = said(["dispatch", THESIS, "--journal", str(file), "--json"], capfd, monkeypatch)
    assert code == 3
    assert err == (
        f"tandem: {file}: entry 2, decision: latency_ms 'seven': must be a number. "
        "It was changed, or is damaged. Restore a copy, or name another file.\n"
    )
