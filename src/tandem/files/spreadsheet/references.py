"""Lists of tasks as planners write them: "1; 2", "1,2", "T1 T2", "1-3", "2FS", or numbers of
rows.
"""

from __future__ import annotations

import datetime
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from tandem.cell.names import Known
from tandem.files.spreadsheet.grid import Value, blank, shown, tidy
from tandem.files.spreadsheet.said import Said, say

NO_TASK = {
    "-",
    "–",
    "—",
    "−",
    "/",
    "none",
    "no",
    "keine",
    "keiner",
    "kein",
    "nein",
    "n/a",
    "na",
    "n.a.",
    "k.a.",
    "start",
    "beginn",
    "0",
    ".",
}
SEPARATORS = (r"[;\n]", r"[;\n,]", r"[;\n,/|+&]|\bund\b|\band\b", r"[;\n,/|+&\s]+|\bund\b|\band\b")
"""From the surest to the least sure; the first by which every part is a known task holds."""
DAYS_AND_LAGS = re.compile(r"(.+?)\s*-?\s*(FS|EA|SS|AA|FF|EE|SF|AE)\s*([=+-].*)?", re.IGNORECASE)
LAG = re.compile(
    r"(?<=\d)\s*-?\s*(FS|EA|SS|AA|FF|EE|SF|AE)\b\s*([=+-](?:[^;,\n]|,(?=\d))*)?", re.IGNORECASE
)
"""What stands behind a number of a task, kind of link and wait: "2FS+5 min"."""
NO_LAG = re.compile(r"[=+-]+\s*P?T?0+([.,]0+)?\s*[^\W\d]*\.?", re.IGNORECASE)
"""A wait of 0 behind a link, as project tools write it: "2FS+0 d", "2-FS=P0D"."""
QUOTED = re.compile(r'"([^"]+)"')


class UnknownTaskError(ValueError):
    """What is wrong with a list of tasks; the end of a sentence that begins with the place."""


class LagError(UnknownTaskError):
    """A kind of link between known tasks that a cell does not have."""


@dataclass
class References:
    """Resolves what stands in a column of task lists.

    Attributes:
      names: the tasks, in the order of their rows.
      labels: label -> name, for sheets that refer to tasks by their description.
      rows: task -> its row number as the sheet shows it.
      by_row: number -> task, when the column counts rows instead of naming tasks; set by
        `agree_on_numbers`.
      counted: the names are counts that the sheet does not show, so that numbers may as well be
        rows.
      said: how numbers were understood, for the notes; None when they simply are names.
      unread: value -> the sentence that says in which column that is not read it stands.
    """

    names: Sequence[str]
    labels: Mapping[str, str] = field(default_factory=dict)
    rows: Mapping[str, int] = field(default_factory=dict)
    counted: bool = False
    by_row: dict[str, str] = field(default_factory=dict)
    said: Said | None = None
    unread: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._exact = set(self.names)
        self._known = Known(self.names)
        self._folded = _unique((_fold(name), name) for name in self.names)
        self._whole = _unique(
            (str(int(name)), name) for name in self.names if name.isdecimal() and name.isascii()
        )
        self._labels = _unique((_fold(label), name) for label, name in self.labels.items() if label)
        self._blanks = any(" " in name for name in self.names)
        self._dotted = {
            name.replace(".", ","): name
            for name in self.names
            if re.fullmatch(r"\d+(\.\d+)+", name)
        }

    def agree_on_numbers(self, values: Iterable[Value], sheet_rows: bool = False) -> None:
        """Decides for a whole column what bare numbers mean that name no task: the number behind a
        common prefix ("1" for "T1"), the place in the list, or the row of the sheet.
        """
        if self._dotted and not sheet_rows:
            return  # beside 1.1 and 1.2, a bare 1 is rather what they belong to
        free = sheet_rows or self.counted
        texts = [LAG.sub("", shown(value)) for value in values]
        numbers = {
            piece
            for text in texts
            if free or not self.task(text)
            for piece in re.findall(r"(?<![\w.])\d+(?![\w.])", text)
        }
        if not numbers or (not free and any(self.task(piece) for piece in numbers if piece != "0")):
            return
        if not free and any(_whole(text) in self._whole for text in texts):
            return  # one names a task by its number: another is no place, but may be a slip
        numbers.discard("0")
        tails = _unique(
            (str(int(found[1])), name)
            for name in self.names
            if (found := re.search(r"(\d+)$", name))
        )
        places = {str(place): name for place, name in enumerate(self.names, 1)}
        in_sheet = {str(row): name for name, row in self.rows.items()}
        readings = [
            (tails, say("numbers.tails")),
            (places, say("numbers.places")),
            (in_sheet, say("numbers.rows")),
        ]
        for reading, said in (
            readings[2:] if sheet_rows else readings[1:] if self.counted else readings
        ):
            if all(piece in reading for piece in numbers):
                self.by_row, self.said = reading, said
                return

    def task(self, text: str) -> str | None:
        """The task that a text names, or None."""
        text = tidy(text)
        if self.counted and (row := self.by_row.get(_whole(text))):
            return row
        if text in self._exact:
            return text
        return (
            self._folded.get(_fold(text))
            or self._whole.get(_whole(text))
            or self.by_row.get(_whole(text))
            or self._labels.get(_fold(text))
        )

    def read(self, value: Value) -> list[str]:
        """The tasks of a list, each once, in its order.

        Raises:
          UnknownTaskError: naming what is no task, with the nearest one.
        """
        if blank(value):
            return []
        if isinstance(value, bool | datetime.date | datetime.time | datetime.timedelta):
            raise UnknownTaskError(
                f"holds {shown(value)}, not tasks (Excel makes dates of entries such as 1.2 or"
                " 1-2): format the cell as text and write the tasks with semicolons, such as"
                " '1; 2'"
            )
        text = shown(value)
        if (
            isinstance(value, float)
            and (
                longer := [
                    name for name in self._exact if re.fullmatch(rf"{re.escape(text)}0+", name)
                ]
            )
            and "." in text
        ):
            raise UnknownTaskError(
                f"holds the number {text}, which may be task {listed_or([text, *sorted(longer)])}"
                " (Excel drops the last 0): format the cell as text and write the task"
            )
        if (name := self.task(text) or self._dotted.get(text)) is not None:
            return [self._beyond_doubt(text, name)]
        if text.casefold() in NO_TASK:
            return []
        if isinstance(value, float) and not value.is_integer():
            raise UnknownTaskError(
                f"holds the number {text}, which is no task (Excel makes a number of '1,2'): "
                "format the cell as text and write the tasks with semicolons, such as '1; 2'"
            )
        return list(dict.fromkeys(self._split(value if isinstance(value, str) else text)))

    def _beyond_doubt(self, text: str, name: str) -> str:
        """The task that a text names, be it with a decimal comma, "1,3" for 1.3, unless the parts
        at its commas are tasks too.

        Raises:
          UnknownTaskError: when it may be either.
        """
        parts = [part.strip() for part in text.split(",")]
        if len(parts) > 1 and all(part in self._exact or part in self._whole for part in parts):
            raise UnknownTaskError(
                f"holds {text!r}, which may be task {name} or tasks {' and '.join(parts)}: write"
                " several with semicolons"
            )
        return name

    def _split(self, text: str) -> list[str]:
        text, quoted = _quotes_aside(text)
        for separator in SEPARATORS:
            parts = _pieces(separator, text, quoted)
            try:
                return [name for part in parts for name in self._part(part)]
            except LagError:
                raise
            except UnknownTaskError:
                continue
        parts = _pieces(SEPARATORS[2 if self._blanks else 3], text, quoted)
        complaints = []
        for part in parts:
            try:
                self._part(part)
            except UnknownTaskError as error:
                complaints.append(str(error).removesuffix("."))
        raise UnknownTaskError("; ".join(complaints) + ".")

    def _part(self, part: str) -> list[str]:
        if (name := self.task(part) or self._dotted.get(part)) is not None:
            return [self._beyond_doubt(part, name)]
        if found := DAYS_AND_LAGS.fullmatch(part):
            name = self.task(found[1])
            if (
                name is not None
                and found[2].upper() in ("FS", "EA")
                and (not found[3] or NO_LAG.fullmatch(found[3]))
            ):
                return [name]
            if name is not None:
                only = (
                    "a list of predecessors knows only end-to-start (FS), with a wait in seconds,"
                    " minutes or hours at most"
                )
                raise LagError(
                    f"holds {part!r}: {only}; write {found[1]!r}, and the wait into a column 'Wait"
                    f" after', such as '{found[1]} >= 40'"
                )
        span = re.fullmatch(r"(.+?)\s*(?:-|–|\.\.|\bbis\b|\bto\b)\s*(.+)", part)
        if span and (between := self._between(span[1], span[2])) is not None:
            return between
        hint = self.unread.get(part) or self._known.hint(part)
        raise UnknownTaskError(f"holds {part!r}, which is no task. {hint}")

    def _between(self, first: str, last: str) -> list[str] | None:
        """ "2-4" as 2, 3, 4: both ends are tasks, and the numbers rise."""
        start, end = self.task(first), self.task(last)
        if start is None or end is None:
            return None
        ends = [re.fullmatch(r"(.*?)(\d+)", name) for name in (start, end)]
        if not all(ends) or ends[0][1] != ends[1][1] or int(ends[0][2]) >= int(ends[1][2]):  # type: ignore[index]
            return None
        numbered = {name: re.fullmatch(r"(.*?)(\d+)", name) for name in self.names}
        low, high = int(ends[0][2]), int(ends[1][2])  # type: ignore[index]
        return [
            name
            for name, found in numbered.items()
            if found and found[1] == ends[0][1] and low <= int(found[2]) <= high  # type: ignore[index]
        ]


def unquoted(text: str) -> str:
    """A name in double quotes stands for itself, though it looks like something else: a total, the
    number of a group.
    """
    return text[1:-1] if len(text) > 2 and text[0] == text[-1] == '"' else text


def _quotes_aside(text: str) -> tuple[str, list[str]]:
    quoted = QUOTED.findall(text)
    places = iter(range(len(quoted)))
    return QUOTED.sub(lambda _: f"\x00{next(places)}\x00", text), quoted


def _pieces(separator: str, text: str, quoted: Sequence[str]) -> list[str]:
    """The parts of a list; names in double quotes, kept aside in `quoted`, stand for themselves
    whatever marks they hold.
    """
    pieces = [tidy(piece) for piece in re.split(separator, text)]
    return [_put_back(piece, quoted) for piece in pieces if piece]


def _put_back(piece: str, quoted: Sequence[str]) -> str:
    alone = re.fullmatch("\x00(\\d+)\x00", piece)
    return (
        quoted[int(alone[1])]
        if alone
        else re.sub("\x00(\\d+)\x00", lambda found: f'"{quoted[int(found[1])]}"', piece)
    )


def task_name(value: Value) -> str:
    """A task's name as the sheet shows it: 1.0 is "1"."""
    return shown(value)


def listed_or(names: Sequence[str]) -> str:
    """ "1.1 or 1.10"."""
    return " or ".join(names)


def _fold(text: str) -> str:
    return "".join(text.split()).casefold()


def _whole(text: str) -> str:
    return str(int(text)) if text.isdecimal() and text.isascii() and len(text) < 12 else text


def _unique(pairs: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Keys that lead to one name only."""
    found: dict[str, str | None] = {}
    for spelled, name in pairs:
        found[spelled] = name if found.get(spelled, name) == name else None
    return {spelled: name for spelled, name in found.items() if name is not None}
