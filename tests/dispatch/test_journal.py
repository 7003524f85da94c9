"""The journal keeps what it was given, all or nothing, for one shift at a time."""

from __future__ import annotations

import sqlite3
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from tests.dispatch.cells import GEARBOX

from tandem.dispatch.journal import Entry, Journal, JournalError
from tandem.dispatch.shift.documents import document
from tandem.dispatch.shift.live import Settings
from tandem.dispatch.situation.model import Situation
from tandem.errors import UsageError

SETTINGS = Settings(policy="longest-tail")
DECISION = document(
    Situation.of(GEARBOX), SETTINGS.decider(GEARBOX).decide(Situation.of(GEARBOX)), 0
)
OPENING = Entry(0, "2026-03-02T06:00:00Z", "", None, None, DECISION, "digest")
ANSWER = {"type": "answer", "number": 1, "event": "tick", "accepted": True, "remarks": []}


def begun(path: Path) -> Journal:
    journal = Journal(path)
    journal.begin(GEARBOX, SETTINGS.to_dict(), None, OPENING)
    return journal


def test_what_was_appended_is_there_for_the_next_one(tmp_path: Path) -> None:
    entry = Entry(
        1,
        "2026-03-02T06:00:01Z",
        '{"täst": 1}',
        {"event": "tick", "at": 1.5},
        ANSWER,
        None,
        "other",
    )
    with begun(tmp_path / "shift.db") as journal:
        assert not journal.is_new
        journal.append(entry, "an id")
    with Journal(tmp_path / "shift.db") as journal:
        assert list(journal.entries()) == [OPENING, entry]
        assert journal.with_id("an id") == (1, {"event": "tick", "at": 1.5})
        assert journal.with_id("another") is None
        assert journal.about()["digest"] == GEARBOX.digest


def test_it_is_written_through(tmp_path: Path) -> None:
    with begun(tmp_path / "shift.db") as journal:
        assert journal.connection.execute("PRAGMA journal_mode").fetchone() == ("wal",)
        assert journal.connection.execute("PRAGMA synchronous").fetchone() == (2,)


def test_an_entry_that_cannot_be_written_leaves_nothing_behind(tmp_path: Path) -> None:
    with begun(tmp_path / "shift.db") as journal:
        journal.append(replace(OPENING, number=1), "a")
        with pytest.raises(JournalError, match="cannot be written"):
            journal.append(replace(OPENING, number=2), "a")
        journal.append(replace(OPENING, number=2), "b")
        assert [entry.number for entry in journal.entries()] == [0, 1, 2]


def test_a_full_disk_ends_the_shift_and_loses_nothing(tmp_path: Path) -> None:
    with begun(tmp_path / "shift.db") as journal:
        journal.connection.execute("PRAGMA max_page_count = 12")
        entries = (replace(OPENING, number=number, line="x" * 500) for number in range(1, 1000))
        with pytest.raises(JournalError, match="disk is full"):
            all(journal.append(entry) is None for entry in entries)
        written = next(entries).number - 1
    with Journal(tmp_path / "shift.db") as journal:
        assert [entry.number for entry in journal.entries()] == list(range(written))
        journal.append(replace(OPENING, number=written))


def test_a_second_shift_is_kept_out_and_a_reader_is_not(tmp_path: Path) -> None:
    with begun(tmp_path / "shift.db"):
        with pytest.raises(UsageError, match="another shift is writing this journal"):
            Journal(tmp_path / "shift.db")
        with Journal(tmp_path / "shift.db", read_only=True) as reader:
            assert list(reader.entries()) == [OPENING]
    Journal(tmp_path / "shift.db").close()


def test_the_lock_falls_with_the_process_that_held_it(tmp_path: Path) -> None:
    program = (
        "import os, sys; from tandem.dispatch.journal import Journal; Journal(sys.argv[1]);"
        " os.kill(os.getpid(), 9)"
    )
    assert (
        subprocess.run([sys.executable, "-c", program, str(tmp_path / "shift.db")]).returncode == -9
    )
    Journal(tmp_path / "shift.db").close()


def test_what_is_no_journal_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text.db").write_text(
        "this is no database, but a text that is long enough to be taken for something\n" * 20
    )
    with pytest.raises(JournalError, match="no journal of a shift, or a damaged one"):
        Journal(tmp_path / "text.db")
    assert not (tmp_path / "text.db.lock").exists(), (
        "nothing is left beside a file that is not ours"
    )
    with sqlite3.connect(tmp_path / "other.db") as other:
        other.execute("CREATE TABLE birds (name TEXT)")
    with pytest.raises(JournalError, match="a database, but no journal"):
        Journal(tmp_path / "other.db")
    with pytest.raises(UsageError, match="no folder"):
        Journal(tmp_path / "nowhere" / "shift.db")
    with pytest.raises(UsageError, match="there is no such journal"):
        Journal(tmp_path / "none.db", read_only=True)


@pytest.mark.parametrize(("key", "value"), [("format", "99"), ("tandem", '"0.0.0"')])
def test_a_journal_of_another_version_is_refused(tmp_path: Path, key: str, value: str) -> None:
    with begun(tmp_path / "shift.db") as journal:
        journal.connection.execute("UPDATE shift SET value = ? WHERE key = ?", (value, key))
    with pytest.raises(JournalError, match="may decide otherwise"):
        Journal(tmp_path / "shift.db")


def test_the_same_file_is_left_alone_when_nothing_was_begun(tmp_path: Path) -> None:
    with Journal(tmp_path / "shift.db") as journal:
        assert journal.is_new
    with begun(tmp_path / "shift.db") as journal:
        assert not journal.is_new
