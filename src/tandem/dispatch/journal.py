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
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, TypeVar

from pydantic import AwareDatetime, Field, ValidationError

from tandem.cell.model import Cell
from tandem.errors import TandemError, UsageError
from tandem.learn.forms import Form, complaints

VERSION = version("tandem")
FORMAT = 2
"""Of the journal. One of another format is refused."""

MOST_FAULTS = 3
"""Of one damaged document, of which a message speaks."""

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


class _Objective(Form):
    """What a shift makes small; see `Objective`."""

    time: float
    stress: float
    max_stress: float | None


class _Assignment(Form):
    """A task of a plan that was kept."""

    task: str
    operators: tuple[str, ...]
    start: float
    end: float


class _Basis(Form):
    """What is known of it; see `Basis`."""

    makespan: float
    stress: float
    proven: bool
    least_makespan: float
    least_stress: float


class _Plan(Form):
    """A plan that was kept; see `Chosen`."""

    assignments: tuple[_Assignment, ...]
    basis: _Basis


class _Options(Form):
    """What was set of its decider; see `Options`."""

    budget_ms: float
    steps_per_ms: float
    seed: int
    random: float
    prior: tuple[tuple[float, float], ...]
    frozen_s: float
    change_penalty: float
    learned: str | None
    plan: _Plan | None


class _Settings(Form):
    """What a shift is steered by; see `Settings` in `shift/live.py`."""

    policy: str
    objective: _Objective
    options: _Options
    taking_apart: float = Field(gt=0)
    products: int = Field(ge=0)


class _About(Form):
    """The table `shift`: what the shift was opened with."""

    format: Literal[2]
    tandem: str
    digest: str
    cell: dict[str, Any]
    variants: dict[str, dict[str, Any]]
    settings: _Settings
    start: AwareDatetime | None


class _Start(Form):
    task: str
    operators: tuple[str, ...]


class _Order(_Start):
    order: int


class _Alternative(Form):
    starts: tuple[_Start, ...]
    expected_cost: float | None


class _Product(Form):
    number: int
    order: str | None
    variant: str | None
    began: float


class _Forecast(Form):
    p50: float
    p90: float
    plan: float


class _Ordered(Form):
    order: str | None
    variant: str | None


class _Open(Form):
    tasks: tuple[str, ...]
    products: tuple[_Ordered, ...]


class _Decision(Form):
    """A decision as the floor heard it; see `documents.document`."""

    type: Literal["decision"]
    number: int
    at: float
    product: _Product | None
    queued: int
    starts: tuple[_Order, ...]
    announced: dict[str, str]
    asks: tuple[_Start, ...]
    take_apart: tuple[str, ...]
    revoked: tuple[_Order, ...]
    alternatives: tuple[_Alternative, ...]
    expected_cost: float | None
    bound: float | None
    why: str
    by: str
    instead: Literal["", "late", "failed"]
    look_again: float | None
    over: bool
    forecast: _Forecast | None
    latency_ms: float
    fault: str = ""
    stuck: tuple[str, ...] = ()
    open: _Open | None = None


class _Answer(Form):
    """What the floor was told of a line."""

    type: Literal["answer"]
    number: int
    event: str | None = None
    id: str | None = None
    accepted: bool
    reasons: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    duplicate_of: int | None = None


class _Event(Form):
    """An event that was taken. Whether it fits the cell and the shift, the shift tells."""

    event: str
    at: float
    task: str | None = None
    operator: str | None = None
    operators: tuple[str, ...] | None = None
    until: float | None = None
    id: str | None = None
    order: str | None = None
    variant: str | None = None
    tool: str | None = None
    part: str | None = None
    person: str | None = None


class _Row(Form):
    """The columns of an entry that are no documents."""

    number: int
    received: str
    line: str | bytes
    situation: str


Made = TypeVar("Made", bound=Form)


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
        self,
        cell: Cell,
        settings: Mapping[str, Any],
        start: str | None,
        opening: Entry,
        variants: Mapping[str, Cell] | None = None,
    ) -> None:
        """Opens the shift: what it is, and its first decision, in one transaction."""
        about = {
            "format": FORMAT,
            "tandem": VERSION,
            "digest": cell.digest,
            "cell": cell.to_dict(),
            "variants": {name: other.to_dict() for name, other in (variants or {}).items()},
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
        """What the shift was opened with. Raises JournalError when that cannot be relied on."""
        found = self._about()
        self._held(_About, json.dumps(found), "shift")
        return found

    def entries(self) -> Iterator[Entry]:
        """All entries, in order. Raises JournalError at one that is not as entries are, or
        missing.
        """
        columns = "number, received, line, event, answer, decision, situation"
        expected = 0
        for row in self._rows(f"SELECT {columns} FROM entries ORDER BY number"):
            number, received, line, event, answer, decision, situation = row
            here = f"entry {number}"
            if number != expected:
                raise self._damaged(f"entry {expected} is missing")
            expected += 1
            self._plain(
                {"number": number, "received": received, "line": line, "situation": situation}, here
            )
            yield Entry(
                number,
                received,
                line,
                self._document(_Event, event, f"{here}, event"),
                self._document(_Answer, answer, f"{here}, answer"),
                self._document(_Decision, decision, f"{here}, decision"),
                situation,
            )
        if not expected:
            raise self._damaged("entry 0 is missing")

    def with_id(self, id: str) -> tuple[int, dict[str, Any]] | None:
        """The number and the event of the entry that was taken under this id."""
        for number, text in self._rows("SELECT number, event FROM entries WHERE id = ?", (id,)):
            event = self._document(_Event, text, f"entry {number}, event")
            return None if event is None else (number, event)
        return None

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
        about = self._about()
        if about.get("format") != FORMAT or about.get("tandem") != VERSION:
            raise JournalError(
                f"{self.path}: the journal is of format {about.get('format')}, by Tandem"
                f" {about.get('tandem')}. This is Tandem {VERSION}, format {FORMAT}; it may"
                " decide otherwise. End the shift with the version that began it, or name another"
                " file."
            )

    def _about(self) -> dict[str, Any]:
        """The table `shift` as it stands there."""
        found = {}
        for key, text in self._rows("SELECT key, value FROM shift"):
            found[str(key)] = self._json(text, f"shift, {key}")
        return found

    def _rows(self, query: str, values: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
        """The rows that a query gives. Raises JournalError where they cannot be read as they
        are.
        """
        try:
            yield from self.connection.execute(query, values)
        except sqlite3.Error as error:
            raise self._damaged(f"its tables cannot be read ({error})") from error

    def _document(self, form: type[Made], text: Any, place: str) -> dict[str, Any] | None:
        """A document of an entry, None where there is none."""
        if text is None:
            return None
        found = self._json(text, place)
        self._held(form, text, place)
        return dict(found)

    def _json(self, text: Any, place: str) -> Any:
        try:
            return json.loads(text)
        except (ValueError, TypeError, RecursionError) as error:
            why = str(error).splitlines()[0]
            raise self._damaged(f"{place}: is no JSON that can be read ({why})") from error

    def _held(self, form: type[Form], text: str | bytes, place: str) -> None:
        """Raises JournalError, with all that is wrong, when the JSON text is not of that form."""
        try:
            form.model_validate_json(text)
        except ValidationError as error:
            raise self._damaged(f"{place}: {_few(form, error)}") from None

    def _plain(self, row: dict[str, Any], place: str) -> None:
        """Raises JournalError when the columns of an entry that are no documents are not theirs."""
        try:
            _Row.model_validate(row)
        except ValidationError as error:
            raise self._damaged(f"{place}: {_few(_Row, error)}") from None

    def _damaged(self, what: str) -> JournalError:
        remedy = "It was changed, or is damaged. Restore a copy, or name another file."
        return JournalError(f"{self.path}: {what}. {remedy}")

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


def _few(form: type[Form], error: ValidationError) -> str:
    """What is wrong with data of a form, in a sentence that can still be read."""
    told = [fault.rstrip(".") for fault in dict.fromkeys(complaints(form, error))]
    more = [f"and {len(told) - MOST_FAULTS} more"] * (len(told) > MOST_FAULTS)
    return "; ".join([*told[:MOST_FAULTS], *more])


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
