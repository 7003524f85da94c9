"""What the floor reports: events as JSON lines, read strictly.

One line of UTF-8, one event: `{"event": "started", "at": 12.5, "task": "4", "operator": "cobot",
"id": "cobot-17"}`. What is wrong with a line is said in sentences, all of it at once. Whether an
event fits where the shift stands is asked in `objections.py`.
"""

from __future__ import annotations

import json
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any, Literal

from tandem.cell.model import Cell
from tandem.cell.names import Known, clean
from tandem.errors import TandemError

LONGEST_LINE = 64_000
"""Characters of a line. An event has about a hundred."""
MOST_BYTES = 4 * LONGEST_LINE
"""Of a line that is not longer in UTF-8."""
LOST = "\ufffd"
"""What programs write in place of a character that they could not read. Different texts become the
same by it.
"""
LONGEST_SHIFT = 1e7
"""Seconds; whoever sends the seconds since 1970 is told so."""
BEYOND = 10**18
"""Nobody means a number of this size; `Infinity` and what has thousands of digits lie beyond."""
LONGEST_ID = 200

Presence = Literal["no", "may", "must"]


@dataclass(frozen=True)
class EventKind:
    """A kind of event: what it says, and which keys it has besides `event`, `at` and `id`.

    Attributes:
      names: further keys that hold a name, of `NAMES`.
    """

    what: str
    task: Presence = "no"
    operators: Literal["no", "may", "one", "some"] = "no"
    until: Presence = "no"
    names: Mapping[str, Presence] = field(default_factory=dict)


NAMES = {
    "order": "an order's id, the floor's own",
    "variant": "the name of a cell that the shift was opened with as a variant",
    "tool": "a tool that tasks need",
    "part": "a part that tasks mount",
    "person": "a person, by whatever name the floor knows them",
}
"""Keys that hold a name, and whose."""
OPEN_NAMES = ("order", "person")
"""Of these the ones that the floor makes up. The others are of the cells."""


KINDS: dict[str, EventKind] = {
    "started": EventKind(
        "the operators have begun the task (or, where it is mounted wrongly, taking it apart),"
        " changeover included",
        "must",
        "some",
    ),
    "done": EventKind("the task has ended well", "must", "may"),
    "refused": EventKind(
        "the operator will not do the task: before `until`, or in the whole shift",
        "must",
        "one",
        "may",
    ),
    "failed": EventKind(
        "with `task`: the attempt is given up, nothing is mounted; with `operator` alone: this"
        " robot or machine is down, its work rests",
        "may",
        "may",
    ),
    "repaired": EventKind(
        "the robot or machine works again and goes on with its task", "no", "one"
    ),
    "wrong": EventKind(
        "the task turned out to be mounted wrongly: it has to be taken apart, then done again",
        "must",
    ),
    "undone": EventKind("the task has been taken apart and is open again", "must"),
    "absent": EventKind("the human has left; their work rests", "no", "one"),
    "back": EventKind("the human is there again and goes on with their task", "no", "one"),
    "product": EventKind(
        "one more product is ordered: of the shift's cell, or of a variant. It begins when all"
        " ordered before it are done",
        names={"order": "may", "variant": "may"},
    ),
    "broken": EventKind(
        "the tool is broken: no task that needs it can begin", names={"tool": "must"}
    ),
    "mended": EventKind("the tool is there again", names={"tool": "must"}),
    "missing": EventKind(
        "the part is missing, or something that the task needs: what needs it cannot begin",
        "may",
        names={"part": "may"},
    ),
    "there": EventKind(
        "the part, or what the task needs, is there again", "may", names={"part": "may"}
    ),
    "person": EventKind(
        "from now on this person stands at the human's place; what is known of a pace is theirs",
        "no",
        "one",
        names={"person": "must"},
    ),
    "end": EventKind("the shift ends: no further product begins"),
    "tick": EventKind("time has passed, nothing else"),
}
"""Every kind of event by its name. A new one is a line here: then `transitions` says what it does,
and `objections` what speaks against it.
"""


@dataclass(frozen=True)
class Event:
    """One event.

    Attributes:
      kind: a name from `KINDS`.
      at: s since the start of the shift.
      task, operators, until: as its kind has them; `operators` in the cell's order, `until` in s.
      id: what makes sending it twice harmless; None when it has none.
      order, variant, tool, part, person: as its kind has them, see `NAMES`.
    """

    kind: str
    at: float
    task: str | None = None
    operators: tuple[str, ...] = ()
    until: float | None = None
    id: str | None = None
    order: str | None = None
    variant: str | None = None
    tool: str | None = None
    part: str | None = None
    person: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """As a line of JSON holds it, times in seconds."""
        made: dict[str, Any] = {"event": self.kind, "at": self.at}
        if self.task is not None:
            made["task"] = self.task
        if self.operators:
            made |= (
                {"operator": self.operators[0]}
                if len(self.operators) == 1
                else {"operators": list(self.operators)}
            )
        return made | {
            key: value
            for key in ("until", *NAMES, "id")
            if (value := getattr(self, key)) is not None
        }


class EventError(TandemError):
    """A line that is no event of this cell. Carries every reason, and the `id` that it gave, should
    that be readable.
    """

    exit_code = 2

    def __init__(self, reasons: list[str], id: str | None = None):
        self.reasons, self.id = tuple(reasons), id
        super().__init__("\n".join(reasons))


def read_event(
    line: str | bytes,
    cell: Cell,
    start: datetime | None = None,
    variants: Mapping[str, Cell] | None = None,
) -> Event:
    """The event that the line holds.

    Args:
      line: as text, or as the bytes that came.
      cell: of the product under way. `variants`: the other cells of the shift by name, whose tools
        and parts are known too.
      start: when the shift started, for times written as ISO 8601; when None, the first such time
        is taken as 0 s (`start_of`).

    Raises:
      EventError: it holds none, with every reason.
    """
    data = _table(line)
    reading = _Reading(data, cell, start, variants or {})
    event = reading.event()
    if event is None or reading.faults:
        raise EventError(reading.faults, reading.id())
    return event


def id_of(line: str | bytes) -> str | None:
    """The id that the line gives, whatever else it holds; None when it gives none that can be
    used.
    """
    try:
        return _id(_table(line).get("id"))
    except EventError:
        return None


def _id(value: Any) -> str | None:
    """What was given as an id, when it can be one."""
    whole = isinstance(value, int) and not isinstance(value, bool) and abs(value) < 10**LONGEST_ID
    text = str(value) if isinstance(value, str) or whole else ""
    return text if _can_be_told_apart(text) else None


def _can_be_told_apart(text: str) -> bool:
    """Whether a name that the floor makes up is one that nothing else can be taken for."""
    return 1 <= len(text) <= LONGEST_ID and text.isprintable() and LOST not in text


def start_of(line: str | bytes) -> datetime | None:
    """The time at which the line says that it happened, when that is written as ISO 8601 with a
    time zone: what a shift without a start begins at.
    """
    try:
        at = _table(line).get("at")
        moment = datetime.fromisoformat(at) if isinstance(at, str) else None
    except (EventError, ValueError):
        return None
    return moment if moment is not None and moment.tzinfo is not None else None


def _table(line: str | bytes) -> dict[str, Any]:
    if len(line) > (MOST_BYTES if isinstance(line, bytes) else LONGEST_LINE):
        raise _too_long()
    line = _decoded(line)
    if len(line) > LONGEST_LINE:
        raise _too_long()
    try:
        data = json.loads(line, object_pairs_hook=_once, parse_constant=_no_number)
    except EventError:
        raise
    except (ValueError, RecursionError) as error:
        raise EventError(
            [f"this is not JSON ({error}). An event is one line like {json.dumps(EXAMPLE)}."]
        ) from error
    if not isinstance(data, dict):
        raise EventError(
            [
                f"this is {_kind_of(data)}, not an event. An event is one line like"
                f" {json.dumps(EXAMPLE)}."
            ]
        )
    return data


def _too_long() -> EventError:
    return EventError(
        [
            f"the line has more than {LONGEST_LINE} characters. An event is one line like"
            f" {json.dumps(EXAMPLE)}."
        ]
    )


def _decoded(line: str | bytes) -> str:
    """The line as text, a mark of byte order at its beginning left out.

    Raises EventError where it is not UTF-8: whatever was put in the place of a byte, two ids could
    become one.
    """
    raw = line if isinstance(line, bytes) else line.encode(errors="surrogatepass")
    if b"\0" in raw:
        raise EventError(
            ["this line is not UTF-8: it holds zero bytes, as UTF-16 does. Send events as UTF-8."]
        )
    try:
        return raw.decode().removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        what = f"byte {error.start + 1} is 0x{raw[error.start]:02x}"
        raise EventError(
            [
                f"this line is not UTF-8: {what}, as in Windows-1252, Latin-1 or UTF-16. Send"
                " events as UTF-8."
            ]
        ) from error


EXAMPLE = {"event": "done", "at": 12.5, "task": "4"}


class _Reading:
    """Reads one table key by key and collects what is wrong."""

    def __init__(
        self,
        data: dict[str, Any],
        cell: Cell,
        start: datetime | None,
        variants: Mapping[str, Cell],
    ) -> None:
        self.data, self.cell, self.start, self.variants = data, cell, start, variants
        self.faults: list[str] = []

    def event(self) -> Event | None:
        name = self.data.get("event")
        at, id_ = self.at("at"), self.id(tell=True)
        if not isinstance(name, str) or name not in KINDS:
            self.faults.insert(0, _no_kind(self.data))
            return None
        kind = KINDS[name]
        task = self.task(name, kind.task)
        operators = self.operators(name, kind.operators)
        until = self.at("until") if "until" in self.data and kind.until != "no" else None
        if at is not None and until is not None and until <= at:
            self.faults.append(
                f"until {until:g} s is not after {at:g} s, when it happened. Leave `until` out to"
                " refuse for the whole shift."
            )
        if name == "failed" and task is None and not operators and not self.faults:
            self.faults.append(
                "failed: say which `task` was given up, or which `operator` is down."
            )
        names = {key: self.name(name, key, presence) for key, presence in kind.names.items()}
        if "part" in names and (task is None) == (names["part"] is None) and not self.faults:
            self.faults.append(f"{name}: give either the `part`, or the `task` that needs it.")
        self.faults += _unknown_keys(name, kind, self.data)
        return None if at is None else Event(name, at, task, operators, until, id_, **names)

    def at(self, key: str) -> float | None:
        """The time under this key, s since the start."""
        value = self.data.get(key)
        if value is None:
            self.faults.append(
                f"`{key}` is missing: when it happened, in seconds since the start of the shift or"
                " as ISO 8601."
            )
            return None
        if isinstance(value, str):
            return self.moment(key, value)
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or not -BEYOND < value < BEYOND
        ):
            self.faults.append(
                f"`{key}` is {_shown(value)}; it must be seconds since the start of the shift, or a"
                " time as ISO 8601."
            )
            return None
        if not 0 <= value <= LONGEST_SHIFT:
            hint = " Seconds since 1970 are not meant: write ISO 8601." if value > 1e9 else ""
            self.faults.append(
                f"`{key}` is {value:.10g} s; it must lie between 0 and {LONGEST_SHIFT:.0f} s after"
                f" the start of the shift.{hint}"
            )
            return None
        return round(float(value), 6)

    def moment(self, key: str, text: str) -> float | None:
        try:
            moment = datetime.fromisoformat(text)
        except ValueError:
            self.faults.append(
                f"`{key}` is {text!r}, which is no time. Write seconds since the start of the"
                " shift, or 2026-03-02T06:00:12.5+01:00."
            )
            return None
        if moment.tzinfo is None:
            self.faults.append(
                f"`{key}` is {text!r} without a time zone. Add one, such as +01:00 or Z."
            )
            return None
        seconds = (moment - (self.start or moment)).total_seconds()
        if not 0 <= seconds <= LONGEST_SHIFT:
            began = (self.start or moment).isoformat()
            wrong = "before" if seconds < 0 else f"more than {LONGEST_SHIFT:.0f} s after"
            self.faults.append(
                f"`{key}` is {text}, {wrong} the start of the shift at {began}. The start is stated"
                " with --start when a shift begins."
            )
            return None
        return seconds

    def id(self, tell: bool = False) -> str | None:
        """The id when there is one that can be used; with `tell` it is a fault when there is one
        that cannot.
        """
        value = self.data.get("id")
        if value is None:
            return None
        if (text := _id(value)) is not None:
            return text
        if tell and isinstance(value, str) and LOST in value:
            self.faults.append(
                f"`id` is {_shown(value)}: U+FFFD stands for a character that was lost on the way."
                " Send events as UTF-8."
            )
        elif tell:
            self.faults.append(
                f"`id` is {_shown(value)}; it must be a text of 1 to {LONGEST_ID} printable"
                " characters, or a whole number."
            )
        return None

    def name(self, kind: str, key: str, presence: Presence) -> str | None:
        """What the key of `NAMES` holds: a name of the floor's, or one that the cells have."""
        if key not in self.data and presence != "must":
            return None
        value = self.data.get(key)
        if isinstance(value, int) and not isinstance(value, bool) and abs(value) < 10**LONGEST_ID:
            value = str(value)
        if not isinstance(value, str):
            self.faults.append(
                f"{kind}: `{key}` is {'missing' if value is None else _shown(value)}; it must be"
                f" {NAMES[key]}."
            )
            return None
        if key in OPEN_NAMES:
            if _can_be_told_apart(value):
                return value
            self.faults.append(
                f"{kind}: `{key}` is {_shown(value)}; it must be a text of 1 to {LONGEST_ID}"
                " printable characters, or a whole number."
            )
            return None
        names = self.names(key)
        found = _known(value, names)
        if found is None:
            hint = Known(names).hint(value) if names else f"None has a {key}."
            where = "the shift was opened with" if key == "variant" else "the cell has"
            self.faults.append(f"{where} no {key} {_shown(value)}. {hint}")
        return found

    def names(self, key: str) -> list[str]:
        """The names that the cells of the shift have for this key."""
        if key == "variant":
            return list(self.variants)
        tasks = [
            task for cell in (self.cell, *self.variants.values()) for task in cell.tasks.values()
        ]
        return sorted({name for task in tasks if (name := getattr(task, key)) is not None})

    def task(self, name: str, presence: Presence) -> str | None:
        if presence == "no" or (presence == "may" and "task" not in self.data):
            return None
        value = self.data.get("task")
        if isinstance(value, int) and not isinstance(value, bool):
            value = str(value)
        if not isinstance(value, str):
            self.faults.append(
                f"{name}: `task` is {'missing' if value is None else _shown(value)}; it must be the"
                " name of a task."
            )
            return None
        found = _known(value, self.cell.tasks)
        if found is None:
            self.faults.append(
                f"the cell has no task {_shown(value)}. {Known(self.cell.tasks).hint(value)}"
            )
        return found

    def operators(
        self, name: str, presence: Literal["no", "may", "one", "some"]
    ) -> tuple[str, ...]:
        given = [key for key in ("operator", "operators") if key in self.data]
        if presence == "no" or (presence == "may" and not given):
            return ()
        if len(given) != 1:
            self.faults.append(
                f"{name}: give either `operator` or `operators`."
                if given
                else f"{name}: `operator` is missing: who it is about."
            )
            return ()
        value = self.data[given[0]]
        names = value if given[0] == "operators" and isinstance(value, list) else [value]
        names = [
            str(who) if isinstance(who, int) and not isinstance(who, bool) else who for who in names
        ]
        if not names or not all(isinstance(who, str) for who in names):
            self.faults.append(
                f"{name}: `{given[0]}` is {_shown(value)}; it must name operators of the cell."
            )
            return ()
        found = {who: _known(who, self.cell.operators) for who in names}
        unknown = [who for who, known in found.items() if known is None]
        self.faults += [
            f"the cell has no operator {_shown(who)}. {Known(self.cell.operators).hint(who)}"
            for who in unknown
        ]
        named = [found[who] for who in names]
        if len({who or number for number, who in enumerate(named)}) < len(names):
            self.faults.append(
                f"{name}: an operator is named twice in {', '.join(map(_shown, names))}; once is"
                " enough."
            )
        if presence == "one" and len(names) > 1:
            self.faults.append(
                f"{name}: is about one operator; send an event for each of"
                f" {', '.join(map(repr, names))}."
            )
        return tuple(who for who in self.cell.operators if who in named)


def _known(name: str, names: Container[str]) -> str | None:
    """The name of the cell that is meant, whatever its spelling; None when there is none."""
    return name if name in names else spelt if (spelt := clean(name)) in names else None


def _no_kind(data: dict[str, Any]) -> str:
    if "event" not in data:
        return f"`event` is missing: what happened. Known: {', '.join(KINDS)}."
    value = data["event"]
    return (
        f"there is no event {_shown(value)}."
        f" {Known(KINDS).hint(value if isinstance(value, str) else '')}"
    )


def _unknown_keys(name: str, kind: EventKind, data: dict[str, Any]) -> Iterator[str]:
    keys = ["event", "at", "id", *keys_of(kind)]
    for key in data:
        if key not in keys:
            yield f"{name}: has no key {_shown(key)}. It has {', '.join(keys)}."


def keys_of(kind: EventKind) -> list[str]:
    """Names of the keys that such an event has of its own."""
    return [
        *(["task"] if kind.task != "no" else []),
        *(
            ["operator"]
            if kind.operators == "one"
            else ["operator", "operators"]
            if kind.operators != "no"
            else []
        ),
        *(["until"] if kind.until != "no" else []),
        *kind.names,
    ]


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        names = [key for key, _ in pairs]
        twice = next(key for key in names if names.count(key) > 1)
        raise EventError([f"the key {_shown(twice)} stands twice."])
    return table


def _no_number(word: str) -> Any:
    raise ValueError(f"{word} is no number")


def _kind_of(value: Any) -> str:
    return {
        list: "a list",
        str: "a text",
        bool: "a yes or no",
        int: "a number",
        float: "a number",
    }.get(type(value), "nothing")


def _shown(value: Any) -> str:
    """What came, as it may stand in a message: a text in quotes, all else as JSON has it."""
    text = repr(value) if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
