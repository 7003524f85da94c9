"""What comes to light while a sheet is read: remarks, faults, and where in the sheet each part of
the cell stands.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any

from tandem.cell.model import plain
from tandem.errors import Fault
from tandem.files.spreadsheet.grid import Grid, Value, shown, tidy
from tandem.files.spreadsheet.said import Said, say
from tandem.files.spreadsheet.values import (
    FINEST_AMOUNT,
    FINEST_TIME,
    NO_MARKS,
    Marks,
    Number,
    UnreadableError,
    cannot,
    duration,
    number,
    rounded,
    seconds,
    unit_named,
)

Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Note:
    """Something that was left out, assumed or understood in one of several ways.

    Attributes:
      kind: "column" or "row" for what was not read, "cannot" for a 0 or an empty time, "assumed"
        for what the sheet does not say, "sheet" for other sheets.
      said: what there is to say.
      place: where in the workbook; empty for the whole.
    """

    kind: str
    said: Said
    place: str = ""

    @property
    def message(self) -> str:
        """In English."""
        return self.said.sentence()

    def __str__(self) -> str:
        return self.sentence()

    def sentence(self, language: str = "en") -> str:
        """Where, and what."""
        what = self.said.sentence(language)
        return f"{self.place}: {what}" if self.place else what


@dataclass(frozen=True)
class Percent:
    """What numbers are multiplied by under a header that says per cent: plain ones, and those that
    the sheet shows as "30 %" and holds as 0.3.
    """

    of_numbers: Decimal
    of_percentages: Decimal


AS_SHOWN = Percent(Decimal(1), Decimal(100))
AS_FRACTION = Percent(Decimal("0.01"), Decimal(1))


@dataclass
class Findings:
    """Collects while reading; nothing stops at the first fault.

    Attributes:
      places: path in the cell -> place in the sheet.
      marks: how text numbers are written.
      shaky: paths whose value could not be read; a stand-in is checked in its stead, and never
        leaves this room.
    """

    notes: list[Note] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    places: dict[Path, str] = field(default_factory=dict)
    marks: Marks = NO_MARKS
    rounded: list[Said] = field(default_factory=list)

    def note(self, kind: str, said: Said, place: str = "") -> None:
        self.notes.append(Note(kind, said, place))

    def fault(self, message: str, place: str, path: Path = ()) -> None:
        self.faults.append(Fault(message, path, place))

    def place_of(self, path: Path) -> str:
        """The place of the path, or of the nearest thing around it."""
        for length in range(len(path), 0, -1):
            if found := self.places.get(path[:length]):
                return found
        return ""

    def sound(self, grid: Grid, row: int, column: int) -> bool:
        """The sheet cell holds a usable value; if not, that is a fault."""
        if why := grid.odd.get((row, column)):
            self.fault(f"{why}.", grid.place(row, column))
            return False
        return True

    def text(self, grid: Grid, row: int, column: int | None) -> str:
        """What stands there as text, the value of its merged area included; "" when nothing does or
        it is broken.
        """
        if column is None or not self.sound(grid, row, column):
            return ""
        top, left, _, _ = grid.spread_of(row, column)
        value = grid.rows[top][left]
        return tidy(value) if isinstance(value, str) else shown(value)

    def time(
        self,
        grid: Grid,
        row: int,
        column: int,
        unit: str,
        *,
        zero: bool = False,
        told: bool = False,
        durations: bool = False,
    ) -> float | None:
        """Seconds; None when the cell says "cannot" or is a fault.

        Args:
          unit: for numbers that have none of their own, be it typed behind them or shown by their
            number format.
          zero: lets 0 pass, for moments.
          told: the unit is told by `--map`, which counts more than a number format.
          durations: reads "0:01:30", which as a moment might be a time of the day.
        """
        row = grid.origin(row, column)
        length = duration(grid.rows[row][column]) if durations else None
        if length is not None and (row, column) not in grid.odd:
            return length or None
        words = "" if told else grid.words.get((row, column), "")

        def in_seconds(found: Number) -> tuple[Decimal, bool]:
            if words and not unit_named(words):
                raise UnreadableError(
                    f"is shown with {words!r} by its number format, which is no unit of time: mend"
                    " the format, or say the unit with --map"
                )
            return seconds(found, unit_named(words) or unit)

        return self._amount(grid, row, column, in_seconds, "a time", zero, FINEST_TIME)

    def amount(
        self, grid: Grid, row: int, column: int, what: str, percent: Percent | None = None
    ) -> float | None:
        """A number that is 0 or more, such as stress; None when the cell is empty or a fault.

        Args:
          percent: what becomes of numbers under a header that says per cent; without it, a
            percentage is its fraction, 0.3 for 30 %.
        """
        row = grid.origin(row, column)
        words = grid.words.get((row, column), "")

        def unitless(found: Number) -> tuple[Decimal, bool]:
            if found.unit or unit_named(words):
                raise UnreadableError(
                    f"holds {shown(grid.rows[row][column])} {words}".rstrip()
                    + f", a time, where {what} is expected"
                )
            factor = (
                Decimal(1)
                if percent is None
                else percent.of_percentages
                if words == "%"
                else percent.of_numbers
            )
            return rounded(found.value * factor, FINEST_AMOUNT)

        return self._amount(grid, row, column, unitless, what, True, FINEST_AMOUNT)

    def _amount(
        self,
        grid: Grid,
        row: int,
        column: int,
        convert: Callable[[Number], tuple[Decimal, bool]],
        what: str,
        zero: bool,
        finest: Decimal,
    ) -> float | None:
        if not self.sound(grid, row, column):
            return None
        value: Value = grid.rows[row][column]
        place = grid.place(row, column)
        if cannot(value) and not (zero and shown(value)[:1] == "0"):
            return None
        try:
            found = number(value, self.marks)
            size, changed = convert(found)
        except UnreadableError as error:
            self.fault(f"{error}.", place)
            return None
        if size < 0:
            self.fault(f"holds {shown(value)}: {what} cannot be negative.", place)
            return None
        if size == 0 and found.value != 0:
            self.fault(
                f"holds {shown(value)}: {what} shorter than {finest} cannot be planned.", place
            )
            return None
        if changed:
            size_now = str(plain(float(size)))
            self.rounded.append(say("rounded.cell", cell=place, value=shown(value), size=size_now))
        return float(size)

    def value(self, grid: Grid, row: int, column: int) -> Value | None:
        """What stands there, the value of the area that is merged downwards included; None when it
        is broken, which is a fault.
        """
        row = grid.origin(row, column)
        return grid.rows[row][column] if self.sound(grid, row, column) else None


def listed(items: Iterable[Any], most: int = 200) -> str:
    """Joined by commas; the rest counted."""
    texts = [str(item) for item in items]
    return ", ".join(texts[:most]) + (f" and {len(texts) - most} more" if len(texts) > most else "")
