"""Sixty ugly workbooks, half of them German: each is read to the numbers that it shows, or refused
with the cell to mend.
"""

from __future__ import annotations

import datetime
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from tests.files.spreadsheet import books

from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell

Rows = Sequence[Sequence[Any]]


@dataclass(frozen=True)
class Ugly:
    """One workbook.

    Attributes:
      story: what its planner did.
      rows: from A1; text of a file with semicolons when `text` is given instead.
      reads: task -> its times by operator, with "stress" and "after" where the sheet states them.
      refused: a part of the one refusal, beginning with the cell.
      options: those of `import_cell`.
    """

    story: str
    rows: Rows = ()
    reads: dict[str, dict[str, Any]] = field(default_factory=dict)
    refused: str = ""
    text: str = ""
    merged: Sequence[str] = ()
    formats: dict[str, str] = field(default_factory=dict)
    options: dict[str, Any] = field(default_factory=dict)

    def save(self, folder: Path) -> Path:
        if self.text:
            (folder / "Plan.csv").write_text(self.text, encoding="utf-8")
            return folder / "Plan.csv"
        book = openpyxl.Workbook()
        target = books.fill(book.active, self.rows, "Plan", self.merged)
        for place, code in self.formats.items():
            target[place].number_format = code
        book.save(folder / "Plan.xlsx")
        return folder / "Plan.xlsx"


EN = ["Task", "Time human [s]", "Time robot [s]", "Predecessors", "Stress"]
DE = ["Vorgang", "Zeit Mensch [s]", "Zeit Roboter [s]", "Vorgänger", "Belastung"]
AB = {"a": {"human": 10, "robot": 20}, "b": {"human": 12, "robot": 30, "after": ("a",)}}
AB_DE = {"a": {"Mensch": 10, "Roboter": 20}, "b": {"Mensch": 12, "Roboter": 30, "after": ("a",)}}

ENGLISH = [
    Ugly("A plain list.", [EN, ["a", 10, 20], ["b", 12, 30, "a"]], AB),
    Ugly(
        "The unit is told by a footnote.",
        [["Task", "Time human"], ["a", 2], [], ["* all times in minutes"]],
        {"a": {"human": 120}},
    ),
    Ugly(
        "A unit in the number format only.",
        [["Task", "Time human"], ["a", 1.5]],
        {"a": {"human": 90}},
        formats={"B2": '0.0 "min"'},
    ),
    Ugly(
        "Hours, minutes and seconds as a duration.",
        [EN, ["a", datetime.timedelta(seconds=90), 20]],
        {"a": {"human": 90, "robot": 20}},
    ),
    Ugly(
        "Minutes and seconds with a colon.",
        [EN, ["a", "1:30", 20]],
        refused="Plan!B2: holds '1:30'",
    ),
    Ugly(
        "Feet and inches for minutes and seconds.",
        [EN, ["a", "1'30\"", 20]],
        refused="Plan!B2: holds ",
    ),
    Ugly(
        "Two readings in one cell.", [EN, ["a", "10 / 12", 20]], refused="Plan!B2: holds '10 / 12'"
    ),
    Ugly("From 10 to 12.", [EN, ["a", "10-12", 20]], refused="Plan!B2: holds '10-12'"),
    Ugly("A sum typed as text.", [EN, ["a", "5+7", 20]], refused="Plan!B2: holds '5+7'"),
    Ugly("Roughly.", [EN, ["a", "~10", 20]], refused="Plan!B2: holds '~10'"),
    Ugly(
        "Excel made a date of 1.2.",
        [EN, ["a", datetime.datetime(2024, 2, 1), 20]],
        refused="Plan!B2: holds the date 2024-02-01",
    ),
    Ugly(
        "Predecessors merged downwards.",
        [EN, ["a", 10, 20], ["b", 12, 30, "a"], ["c", 5, 6]],
        {**AB, "c": {"human": 5, "robot": 6, "after": ("a",)}},
        merged=["D3:D4"],
    ),
    Ugly(
        "One time merged over both operators.",
        [EN, ["a", 10], ["b", 12, 30, "a"]],
        refused="Plan!B2: is merged over B2:C2",
        merged=["B2:C2"],
    ),
    Ugly(
        "Who can do what, without times.",
        [["Task", "Human", "Robot"], ["a", 1, 0], ["b", 1, 1]],
        refused="Plan!B1: 'Human', 'Robot': nothing but 1 and 0",
    ),
    Ugly(
        "Who can do what, with crosses and a time.",
        [["Task", "Time [s]", "Human", "Robot"], ["a", 9, "x", "x"], ["b", 7, None, "x"]],
        {"a": {"Human": 9, "Robot": 9}, "b": {"Robot": 7}},
    ),
    Ugly(
        "Thousands with commas, and decimals.",
        [EN, ["a", "1,234.5", "2,500"]],
        {"a": {"human": 1234.5, "robot": 2500}},
    ),
    Ugly(
        "A thousand, or a decimal comma.",
        [EN, ["a", "2,500", 20]],
        refused="Plan!B2: holds '2,500', which may be 2500 or 2.500",
    ),
    Ugly(
        "No-break spaces from a web page.",
        [EN, ["a\u00a0", "1\u00a0200\u00a0s", "\u00a020"]],
        {"a": {"human": 1200, "robot": 20}},
    ),
    Ugly(
        "A scale in brackets.",
        [[*EN[:4], "Stress (0-10)"], ["a", 10, 20, None, 3], ["b", 12, 30, "a", 4]],
        {"a": {**AB["a"], "stress": 3}, "b": {**AB["b"], "stress": 4}},
    ),
    Ugly(
        "Stress in per cent.",
        [[*EN[:4], "Stress [%]"], ["a", 10, 20, None, 0.3]],
        {"a": {**AB["a"], "stress": 30}},
        formats={"E2": "0%"},
    ),
    Ugly(
        "Stress with a time in it.",
        [EN, ["a", 10, 20, None, "3 min"]],
        refused="Plan!E2: holds 3 min, a time, where a number for stress is expected",
    ),
    Ugly(
        "A time column split by text to columns.",
        [["Task", "Time human [s]", None, "Time robot [s]"], ["a", 12, 5, 20]],
        refused="Plan!C2: column C has no header",
    ),
    Ugly(
        "Decimal commas in a file with commas.",
        text="Task,Time human [s],Time robot [s]\na,12,5,20\nb,9,30\n",
        refused="Plan!D2: row 2: more columns than the header, which has 3",
    ),
    Ugly(
        "A quotation mark left open.",
        text='Task;Time human [s];Description\na;10;5" bolt\nb;12;"cover\nc;13;clip\n',
        refused="Plan!C3: row 3: a quotation mark is opened and never closed",
    ),
    Ugly(
        "A decimal comma beside a version.",
        text="Version 1.2\nTask;Time human [s]\na;12,500\n",
        refused="Plan!B3: holds '12,500', which may be",
    ),
    Ugly(
        "Times in thousands.",
        [EN, ["a", 12500, 20]],
        refused="Plan!B2: holds 12500, which its number format shows in thousands",
        formats={"B2": "0.0,"},
    ),
    Ugly(
        "Header and data one column apart.", [[None, *EN], ["a", 10, 20, None, 1]], refused="Plan!"
    ),
    Ugly(
        "A percentage of the day.",
        [EN, ["a", 0.1, 20]],
        refused="Plan!B2: is shown with '%' by its number format",
        formats={"B2": "0%"},
    ),
    Ugly(
        "Rows of totals and means.",
        [EN, ["a", 10, 20], ["b", 12, 30, "a"], ["Total", 22, 50], ["Average", 11, 25]],
        AB,
    ),
    Ugly(
        "A task without a name.",
        [EN, ["a", 10, 20], [None, 12, 30, "a"]],
        refused="Plan!A3: is empty: the row has values and no task",
    ),
    Ugly(
        "Units in a row of their own, TMU and minutes.",
        [["Task", "Time human", "Time robot"], [None, "TMU", "min"], ["a", 250, 0.5]],
        {"a": {"human": 9, "robot": 30}},
    ),
    Ugly(
        "A column told by letter, its unit by the header.",
        [["Task", "Reading (HM)"], ["a", 16.5]],
        {"a": {"robot": 9.9}},
        options={"columns": {"B": "time robot"}},
    ),
    Ugly(
        "The larger unit typed behind some times.",
        [["Task", "Time human"], ["a", "2 min"], ["b", 30]],
        refused="Plan!B3: has no unit, B2 has min",
    ),
]
GERMAN = [
    Ugly("Eine schlichte Liste.", [DE, ["a", 10, 20], ["b", 12, 30, "a"]], AB_DE),
    Ugly(
        "Zeiten in HM, gesagt in der Zeile darüber.",
        [["Alle Zeiten in HM"], ["Vorgang", "Zeit Mensch"], ["a", 50]],
        {"a": {"Mensch": 30}},
    ),
    Ugly(
        "Einheit in zwei Zellen.",
        [["Einheit:", "min"], [], ["Vorgang", "Zeit Mensch"], ["a", 1.5]],
        {"a": {"Mensch": 90}},
    ),
    Ugly(
        "Zwei Zeilen widersprechen sich.",
        [["Zeiten in min"], ["Zeiten in HM"], ["Vorgang", "Zeit Mensch"], ["a", 2]],
        refused="Plan!B3: no unit is stated for 'Zeit Mensch'",
    ),
    Ugly(
        "Zahlenformat mit Einheit.",
        [["Vorgang", "Zeit Mensch"], ["a", 16.5]],
        {"a": {"Mensch": 9.9}},
        formats={"B2": '#,##0.0 "HM"'},
    ),
    Ugly(
        "Dezimalkomma als Text.",
        [DE, ["a", "10,5", "1.234,5"]],
        {"a": {"Mensch": 10.5, "Roboter": 1234.5}},
    ),
    Ugly(
        "Ein Tausender oder ein Dezimalpunkt.",
        [DE, ["a", "10,5", "1.234"]],
        refused="Plan!C2: holds '1.234', which may be 1234 or 1.234",
    ),
    Ugly(
        "Ein Datum als Zeit.", [DE, ["a", "01.02.2024", 20]], refused="Plan!B2: holds '01.02.2024'"
    ),
    Ugly("Eine Minute dreißig.", [DE, ["a", "1'30", 20]], refused='Plan!B2: holds "1\'30"'),
    Ugly(
        "Schweizer Tausender.",
        [DE, ["a", "1'200", "1’200,5"]],
        {"a": {"Mensch": 1200, "Roboter": 1200.5}},
    ),
    Ugly("Zwei Zahlen in einer Zelle.", [DE, ["a", "5 10", 20]], refused="Plan!B2: holds '5 10'"),
    Ugly("Ungefähr.", [DE, ["a", "ca. 10", 20]], refused="Plan!B2: holds 'ca. 10'"),
    Ugly(
        "Fünf Stück.",
        [DE, ["a", 5, 20]],
        refused="Plan!B2: is shown with 'Stk' by its number format",
        formats={"B2": '0 "Stk"'},
    ),
    Ugly(
        "Belastung nach unten verbunden.",
        [DE, ["a", 10, 20, None, 4], ["b", 12, 30, "a"]],
        {"a": {**AB_DE["a"], "stress": 4}, "b": {**AB_DE["b"], "stress": 4}},
        merged=["E2:E3"],
    ),
    Ugly(
        "Zeit nach unten verbunden.",
        [DE, ["a", 10, 20], ["b", None, 30, "a"]],
        {"a": AB_DE["a"], "b": {"Mensch": 10, "Roboter": 30, "after": ("a",)}},
        merged=["B2:B3"],
    ),
    Ugly(
        "Vorgangsname über zwei Zeilen.",
        [DE, ["a", 10, 20], [None, 12, 30]],
        refused="Plan!A3: task 'a' stands here a second time",
        merged=["A2:A3"],
    ),
    Ugly(
        "Bemerkung über die Zeit verbunden.",
        [["Vorgang", "Bemerkung", "Zeit Mensch [s]"], ["a", "siehe Zeichnung"], ["b", "ok", 3]],
        refused="Plan!B2: is merged over B2:C2",
        merged=["B2:C2"],
    ),
    Ugly(
        "Wer kann was, mit ja und nein.",
        [["Vorgang", "Mensch", "Roboter"], ["a", "ja", "nein"], ["b", "ja", "ja"]],
        refused="Plan!B1: 'Mensch', 'Roboter': nothing but 1 and 0",
    ),
    Ugly(
        "Wer kann was, mit einer Zeit.",
        [["Vorgang", "Dauer [min]", "Mensch", "Roboter"], ["a", 0.5, 1, 0], ["b", 1, 1, 1]],
        {"a": {"Mensch": 30}, "b": {"Mensch": 60, "Roboter": 60}},
    ),
    Ugly(
        "Skala in Klammern.",
        [[*DE[:4], "Belastung (1–7)"], ["a", 10, 20, None, 3]],
        {"a": {**AB_DE["a"], "stress": 3}},
    ),
    Ugly(
        "Punkte als Einheit.",
        [[*DE[:4], "Belastung [Pkt.]"], ["a", 10, 20, None, "2,5"]],
        {"a": {**AB_DE["a"], "stress": 2.5}},
    ),
    Ugly(
        "Newton als Einheit.",
        [[*DE[:4], "Belastung [N]"], ["a", 10, 20, None, 12]],
        {"a": {**AB_DE["a"], "stress": 12}},
    ),
    Ugly(
        "Prozente und Zahlen gemischt.",
        [DE, ["a", 10, 20, None, 30], ["b", 12, 30, None, 0.4]],
        refused="Plan!E2: is no percentage, and Plan!E3 is one",
        formats={"E3": "0%"},
    ),
    Ugly(
        "Vorgangsnummern mit Dezimalkomma.",
        [
            ["Nr.", "Zeit Mensch [s]", "Vorgänger"],
            [1.1, 5, None],
            [1.2, 6, None],
            [1.3, 7, "1,1; 1,2"],
        ],
        {"1.1": {"Mensch": 5}, "1.2": {"Mensch": 6}, "1.3": {"Mensch": 7, "after": ("1.1", "1.2")}},
    ),
    Ugly(
        "Vorgang 1,3 oder 1 und 3.",
        [["Nr.", "Zeit Mensch [s]", "Vorgänger"], [1, 5], [3, 6], [1.3, 7], [4, 8, "1,3"]],
        refused="Plan!C5: holds '1,3', which may be task 1.3 or tasks 1 and 3",
    ),
    Ugly(
        "Offenes Anführungszeichen.",
        text='Vorgang;Zeit Mensch [s];Bezeichnung\na;10;"Deckel\nb;12;Rad\nc;13;Kabel"\nd;4;Clip\n',
        refused="Plan!C2: row 2: a quotation mark is opened and closed only in line 4",
    ),
    Ugly(
        "Dezimalkommas neben einer Teilenummer.",
        text="Vorgang;Zeit Mensch [s];Teil\na;12,500;4711.1\n",
        refused="Plan!B2: holds '12,500', which may be",
    ),
    Ugly(
        "Dezimalkommas mit Beleg.",
        text="Vorgang;Zeit Mensch [s];Zeit Roboter [s]\na;12,500;8,25\n",
        reads={"a": {"Mensch": 12.5, "Roboter": 8.25}},
    ),
    Ugly(
        "Kopf über zwei Zeilen mit Einheit.",
        [["Vorgang", "Zeit [HM]"], [None, "Mensch", "Roboter"], ["a", 50, 100]],
        {"a": {"Mensch": 30, "Roboter": 60}},
        merged=["B1:C1", "A1:A2"],
    ),
    Ugly(
        "Verborgene Zahl.",
        [DE, ["a", 10, 20]],
        refused="Plan!B2: holds 10, which its number format hides",
        formats={"B2": ";;;"},
    ),
    Ugly(
        "Uhrzeit statt Dauer.",
        [DE, ["a", datetime.time(1, 30), 20]],
        refused="Plan!B2: holds the clock time 01:30:00",
    ),
    Ugly(
        "Negativ und in Klammern.",
        [DE, ["a", -10, "(20)"]],
        refused="Plan!B2: holds -10: a time cannot be negative",
    ),
    Ugly(
        "Summe und Überschriften.",
        [
            ["Montage 4711, Stand 01.02.2024"],
            DE,
            ["Vormontage"],
            ["a", 10, 20],
            ["b", 12, 30, "a"],
            ["Summe", 22, 50],
        ],
        AB_DE,
        merged=["A3:E3"],
    ),
]


def test_they_are_sixty() -> None:
    assert len(ENGLISH) + len(GERMAN) >= 60
    assert min(len(ENGLISH), len(GERMAN)) >= 30


@pytest.mark.parametrize("ugly", [*ENGLISH, *GERMAN], ids=lambda ugly: ugly.story)
def test_it_reads_what_it_shows_or_is_refused_at_its_cell(ugly: Ugly, tmp_path: Path) -> None:
    path = ugly.save(tmp_path)
    if ugly.refused:
        with pytest.raises(CellError) as caught:
            import_cell(path, **ugly.options)
        assert ugly.refused in str(caught.value)
        return
    cell, _ = import_cell(path, **ugly.options)
    found = {
        name: {
            **task.time,
            **({"stress": task.stress} if task.stress else {}),
            **({"after": task.after} if task.after else {}),
        }
        for name, task in cell.tasks.items()
    }
    assert found == ugly.reads
