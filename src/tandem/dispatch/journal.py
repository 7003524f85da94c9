"""The journal of a shift: one SQLite file that is the truth. Each line from the floor, its answer
and the decision stand in one transaction.

`shift`     what the shift was opened with: format, version, the cell, the settings, the start if
one was stated `entries`   number 0 is the opening; then one entry for each line that came, taken or
not

WAL with `synchronous=FULL`: what was answered is on disk before the answer leaves, and a process
that is killed at any moment leaves a whole journal. Others may read it while the shift runs; a lock
beside it (`FILE.lock`) keeps a second shift out and falls with the process that held it.
"""

from __future__ import annotations

import json
import os
import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from tandem import __version__
from tandem.cell.model import Cell
from tandem.errors import TandemError, UsageError

FORMAT = 1
"""Of the journal. One of another format is refused."""

IN_MEMORY = ":memory:"
"""The journal of a shift that nobody wants to keep."""

TABLES = """
CREATE TABLE shift (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE entries (
  number INTEGER PRIMARY KEY,
  received TEXT NOT NULL,
  line TEXT NOT NULL,
  event TEXT,
  id TEXT UNIQUE,
  answer TEXT,
  decision TEXT,
  situation TEXT NOT NULL
);
"""


class JournalError(TandemError):
    """The journal cannot be used for this shift."""

    exit_code = 3


@dataclass(frozen=True)
class Entry:
    """What one line brought.

    Attributes:
      number: 0 for the opening, then counting up without gaps.
      received: wall clock, ISO 8601. Nothing depends on it.
      line: as it came; cut where it was longer than any event. Bytes where it was not UTF-8.
      event: as plain values when it was taken; None when it changed nothing.
      answer: what the floor was told; None for the opening.
      decision: what was decided; None when nothing was.
      situation: a digest of where the shift stood afterwards.
    """

    number: int
    received: str
    line: str | bytes
    event: Mapping[str, Any] | None
    answer: Mapping[str, Any] | None
    decision: Mapping[str, Any] | None
    situation: str


class Journal:
    """One journal, open. Use it as a context, or close it."""

    def __init__(
        self, path: str | os.PathLike[str] = IN_MEMORY, *, read_only: bool = False
    ) -> None:
        """Opens the file, or makes it.

        Raises:
          UsageError: another shift writes it at the moment, or there is nothing to read.
          JournalError: it is no journal, damaged, or not of this format and version.
        """
        self.path = os.fspath(path)
        self._lock: int | None = None
        locks_before = os.path.exists(f"{self.path}.lock")
        if self.path != IN_MEMORY:
            if read_only and not os.path.exists(self.path):
                raise UsageError(f"{self.path}: there is no such journal.")
            if not read_only:
                self._lock = _locked(self.path)
        try:
            self.connection = sqlite3.connect(self.path, isolation_level=None, timeout=5.0)
            self.connection.execute("PRAGMA journal_mode=WAL")
            self.connection.execute("PRAGMA synchronous=FULL")
            if read_only:
                self.connection.execute("PRAGMA query_only=ON")
            self._check()
        except sqlite3.OperationalError as error:
            self.close(forget_lock=not locks_before)
            raise JournalError(
                f"{self.path}: the journal cannot be opened ({error}). Look at its permissions and"
                " the space on the disk."
            ) from error
        except sqlite3.Error as error:
            self.close(forget_lock=not locks_before)
            raise JournalError(
                f"{self.path}: this is no journal of a shift, or a damaged one ({error}). Name"
                " another file."
            ) from error
        except TandemError:
            self.close(forget_lock=not locks_before)
            raise

    @property
    def is_new(self) -> bool:
        """Nothing has been opened in it yet."""
        return not self.connection.execute(
            "SELECT 1 FROM sqlite_master WHERE name = 'entries'"
        ).fetchone()

    def begin(
        self, cell: Cell, settings: Mapping[str, Any], start: str | None, opening: Entry
    ) -> None:
        """Opens the shift: what it is, and its first decision, in one transaction."""
        about = {
            "format": FORMAT,
            "tandem": __version__,
            "digest": cell.digest,
            "cell": cell.to_dict(),
            "settings": settings,
            "start": start,
        }
        with self._transaction():
            for statement in filter(str.strip, TABLES.split(";")):
                self.connection.execute(statement)
            self.connection.executemany(
                "INSERT INTO shift VALUES (?, ?)",
                [(key, _json(value)) for key, value in about.items()],
            )
            self._insert(opening, None)

    def append(self, entry: Entry, id: str | None = None) -> None:
        """Adds an entry; it is on disk when this returns. `id`: of the event that was taken; the
        next one with it will be known as a repetition.
        """
        with self._transaction():
            self._insert(entry, id)

    def about(self) -> dict[str, Any]:
        """What the shift was opened with."""
        return {
            key: json.loads(value)
            for key, value in self.connection.execute("SELECT key, value FROM shift")
        }

    def entries(self) -> Iterator[Entry]:
        """All entries, in order."""
        for row in self.connection.execute(
            "SELECT number, received, line, event, answer, decision, situation FROM entries ORDER"
            " BY number"
        ):
            number, received, line, *texts, situation = row
            event, answer, decision = (None if text is None else json.loads(text) for text in texts)
            yield Entry(number, received, line, event, answer, decision, situation)

    def with_id(self, id: str) -> tuple[int, dict[str, Any]] | None:
        """The number and the event of the entry that was taken under this id."""
        found = self.connection.execute(
            "SELECT number, event FROM entries WHERE id = ?", (id,)
        ).fetchone()
        return (found[0], json.loads(found[1])) if found else None

    def close(self, *, forget_lock: bool = False) -> None:
        """Closes the file and gives the lock back; with `forget_lock` the lock's file goes too.
        Closing twice is fine.
        """
        if hasattr(self, "connection"):
            with suppress(sqlite3.Error):
                self.connection.close()
        if self._lock is not None:
            if forget_lock:
                with suppress(OSError):
                    os.unlink(f"{self.path}.lock")
            os.close(self._lock)
            self._lock = None

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _check(self) -> None:
        found = self.connection.execute("PRAGMA quick_check").fetchone()[0]
        if found != "ok":
            raise JournalError(
                f"{self.path}: the journal is damaged ({found}). Restore a copy, or name another"
                " file."
            )
        names = {
            name
            for (name,) in self.connection.execute(
                "SELECT name FROM sqlite_master WHERE type = 'table'"
            )
        }
        if not names:
            return
        if not {"shift", "entries"} <= names:
            raise JournalError(
                f"{self.path}: this is a database, but no journal of a shift. Name another file."
            )
        about = self.about()
        if about.get("format") != FORMAT or about.get("tandem") != __version__:
            raise JournalError(
                f"{self.path}: the journal is of format {about.get('format')}, by Tandem"
                f" {about.get('tandem')}. This is Tandem {__version__}, format {FORMAT}; it may"
                " decide otherwise. End the shift with the version that began it, or name another"
                " file."
            )

    def _transaction(self) -> _Transaction:
        return _Transaction(self)

    def _insert(self, entry: Entry, id: str | None) -> None:
        texts = [
            None if value is None else _json(value)
            for value in (entry.event, entry.answer, entry.decision)
        ]
        event, answer, decision = texts
        row = (
            entry.number,
            entry.received,
            entry.line,
            event,
            id,
            answer,
            decision,
            entry.situation,
        )
        self.connection.execute("INSERT INTO entries VALUES (?, ?, ?, ?, ?, ?, ?, ?)", row)


class _Transaction:
    """All or nothing; what cannot be written is told in a sentence."""

    def __init__(self, journal: Journal) -> None:
        self.journal = journal

    def __enter__(self) -> None:
        self._do("BEGIN IMMEDIATE")

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is None:
            self._do("COMMIT")
            return
        with suppress(sqlite3.Error):
            self.journal.connection.execute("ROLLBACK")
        if isinstance(error, sqlite3.Error):
            raise self._cannot(error) from error

    def _do(self, statement: str) -> None:
        try:
            self.journal.connection.execute(statement)
        except sqlite3.Error as error:
            with suppress(sqlite3.Error):
                self.journal.connection.execute("ROLLBACK")
            raise self._cannot(error) from error

    def _cannot(self, error: sqlite3.Error) -> JournalError:
        return JournalError(
            f"{self.journal.path}: the journal cannot be written ({error}). What was answered so"
            " far is in it; mend the cause and start again."
        )


def _locked(path: str) -> int:
    """A lock on `path + ".lock"`, as a file descriptor; the system gives it back when the process
    ends, however it ends.
    """
    folder = Path(path).parent
    if not folder.is_dir():
        raise UsageError(f"{path}: there is no folder {str(folder)!r} to keep the journal in.")
    handle = os.open(f"{path}.lock", os.O_RDWR | os.O_CREAT, 0o644)
    try:
        if os.name == "nt":
            import msvcrt

            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        else:
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(handle)
        raise UsageError(
            f"{path}: another shift is writing this journal. End it first, or name another file."
        ) from error
    return handle


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
