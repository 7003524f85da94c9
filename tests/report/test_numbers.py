"""Numbers that a person reads: without the noise of binary fractions, and with the decimal mark of
the language in every file.
"""

from __future__ import annotations

import csv
import io
import re
from html.parser import HTMLParser
from pathlib import Path

import openpyxl
import pytest
from rich.console import Console
from tests.draw.cells import front_of, rows

from tandem.files.validate import cell_of
from tandem.plan.result import Front
from tandem.report.files import write
from tandem.report.language import words
from tandem.report.terminal import FrontView

NOISE = re.compile(r"\d[.,]\d{7,}|\d[eE][+-]?\d")
POINT = re.compile(r"(?<![\d.])\d+\.\d+(?![\d.])")


class _Visible(HTMLParser):
    """What a reader sees or hears of a page: text outside scripts and styles, and what elements are
    labelled with.
    """

    def __init__(self) -> None:
        super().__init__()
        self.said: list[str] = []
        self.hidden = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.hidden = tag in ("script", "style")
        self.said += [value or "" for key, value in attrs if key == "aria-label"]

    def handle_data(self, data: str) -> None:
        if not self.hidden:
            self.said.append(data)


def fractions() -> Front:
    """Three tasks of 0.1, 0.2 and 1234.5 s one after the other, with stress 0.1 and 0.2: sums that
    floats get wrong.
    """
    tasks = {
        "1": {"time": {"h": 0.1}, "stress": 0.1, "release": 0.1, "tool": "t"},
        "2": {"time": {"h": 0.2}, "stress": 0.2, "after": ["1"], "deadline": 99.5},
        "3": {"time": {"r": 1234.5, "h": 2000.25}, "stress": 40.5, "after": ["2"]},
    }
    human = {"kind": "human", "label": "Hanna", "breaks": [[0.5, 0.75]]}
    cell = cell_of(
        {
            "name": "Zelle",
            "operators": {"h": human, "r": {"kind": "robot", "label": "Rob"}},
            "tasks": tasks,
        }
    )
    slow = rows(("1", "h", 0.1, 0.2), ("2", "h", 0.2, 0.4), ("3", "r", 0.4, 1234.9))
    return front_of(cell, [slow], proven=False, slack=0.1)


def said_in(path: Path) -> str:
    """The text that a reader sees in a file."""
    if path.suffix == ".html":
        reader = _Visible()
        reader.feed(path.read_text(encoding="utf-8"))
        return "\n".join(reader.said)
    if path.suffix == ".xlsx":
        book = openpyxl.load_workbook(path)
        assumptions = next(
            place
            for place, name in enumerate(book.sheetnames)
            if name in ("Assumptions", "Annahmen")
        )
        # Behind it the cell itself stands in the form of `tandem import`, where breaks are text
        # that a program reads.
        values = [
            cell.value
            for sheet in book.worksheets[: assumptions + 1]
            for row in sheet
            for cell in row
        ]
        return "\n".join(value for value in values if isinstance(value, str))
    text = path.read_text(encoding="utf-8-sig")
    return "\n".join(re.findall(r">([^<>]+)<", text)) if path.suffix == ".svg" else text


@pytest.mark.parametrize("ending", [".html", ".md", ".csv", ".json", ".svg", ".xml", ".xlsx"])
@pytest.mark.parametrize("language", ["en", "de"])
def test_no_number_shows_the_noise_of_binary_fractions(
    ending: str, language: str, tmp_path: Path
) -> None:
    said = said_in(write(fractions(), tmp_path / f"plan{ending}", language=language))
    assert re.search(r"0[.,]1", said)
    assert NOISE.findall(said.replace(fractions().cell.digest, "")) == []


@pytest.mark.parametrize("ending", [".html", ".md", ".svg", ".xlsx"])
def test_what_a_german_reads_has_a_decimal_comma(ending: str, tmp_path: Path) -> None:
    front = fractions()
    said = said_in(write(front, tmp_path / f"plan{ending}", language="de")).replace(
        front.solver, ""
    )
    said = re.sub(r"tandem \d+\.\S+|version \S+", "", said)
    assert "1234,9" in said
    assert POINT.findall(said) == []


@pytest.mark.parametrize("ending", [".html", ".md", ".svg"])
def test_what_a_german_reads_has_no_english_word(ending: str, tmp_path: Path) -> None:
    said = said_in(write(fractions(), tmp_path / f"plan{ending}", language="de"))
    for word in (
        "makespan",
        "stress ",
        "busy",
        "break",
        "task",
        "proven",
        "deadline",
        "human",
        "robot ",
        "recommended",
        "time [",
    ):
        assert word not in said


def test_csv_and_json_are_for_programs_and_the_same_in_every_language(tmp_path: Path) -> None:
    for ending in (".csv", ".json"):
        english, german = (
            write(fractions(), tmp_path / f"{lang}{ending}", language=lang).read_bytes()
            for lang in ("en", "de")
        )
        assert english == german
    rows = list(csv.DictReader(io.StringIO((tmp_path / "de.csv").read_text(encoding="utf-8"))))
    assert [float(row["end_s"]) for row in rows] == [0.2, 0.4, 1234.9]


def test_a_workbook_holds_numbers_as_numbers(tmp_path: Path) -> None:
    """So that every spreadsheet shows them with the reader's own decimal mark."""
    sheet = openpyxl.load_workbook(write(fractions(), tmp_path / "plan.xlsx", language="de"))[
        "Plan 1"
    ]
    assert [[sheet.cell(row, column).value for column in (3, 4)] for row in (4, 5, 6)] == [
        [0.1, 0.2],
        [0.2, 0.4],
        [0.4, 1234.9],
    ]


def test_the_terminal_shows_no_noise_either() -> None:
    with (console := Console(width=100, file=io.StringIO())).capture() as shown:
        console.print(FrontView(fractions()))
    assert "1234.9" in shown.get()
    assert NOISE.findall(shown.get()) == []


@pytest.mark.parametrize(
    ("value", "english", "german"),
    [
        (0.1 + 0.2, "0.3", "0,3"),
        (1e6, "1000000", "1000000"),
        (12.50, "12.5", "12,5"),
        (-0.25, "-0.25", "-0,25"),
    ],
)
def test_a_number_is_written_as_people_write_it(value: float, english: str, german: str) -> None:
    assert (words("en").number(value), words("de").number(value)) == (english, german)
