"""Whatever tasks, operators and cells are called, no exported file makes a reader's program run,
draw or break anything by their names.
"""

from __future__ import annotations

import csv
import html.parser
import io
import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import openpyxl
import pytest

import tandem
from tandem.files.validate import cell_of
from tandem.report.files import EXPORTERS, write
from tandem.report.terminal import GanttText

NAMES = [
    "=1+1",
    "+cmd|' /C calc'!A0",
    "-2+3",
    "@SUM(A1)",
    "<img src=x onerror=alert(1)>",
    "</script><script>alert(2)</script>",
    "a & \"b\" 'c'",
    "$\\frac{$ %d",
    "[x](javascript:alert(3)) | `y`",
    "]]>",
]


@pytest.fixture(scope="module")
def front() -> tandem.Front:
    """A plan of tasks, operators, tools, zones and a cell that are all called such things."""
    operators = {"=cobot": {"kind": "robot"}, "<b>@anna": {"kind": "human", "label": "</title><b>"}}
    tasks: dict[str, Any] = {
        name: {
            "time": {"=cobot": 2, "<b>@anna": 3},
            "stress": 1,
            "label": f"{name} !",
            "tool": "+tool",
            "zone": "-zone",
        }
        for name in NAMES
    }
    for first, then in pairwise(NAMES):
        tasks[then]["after"] = [first]
    return tandem.plan(
        cell_of(
            {"name": '=HYPERLINK("x") </script><script>', "operators": operators, "tasks": tasks}
        ),
        time_limit=20,
        workers=1,
    )


def in_csv(data: bytes) -> None:
    """No cell begins like a formula, but for negative numbers."""
    fields = [field for row in csv.reader(io.StringIO(data.decode("utf-8-sig"))) for field in row]
    assert [field for field in fields if re.match(r"[=+@\t\r]|-(?![\d.]+$)", field)] == []
    assert any("SUM(A1)" in field for field in fields)


def in_json(data: bytes) -> None:
    assert {row["task"] for row in json.loads(data)["front"][0]["assignments"]} == set(NAMES)


def in_xlsx(data: bytes) -> None:
    """No cell is a formula that a name has made."""
    book = openpyxl.load_workbook(io.BytesIO(data))
    cells = [cell for sheet in book for row in sheet.iter_rows() for cell in row]
    assert [
        cell.value
        for cell in cells
        if cell.data_type == "f" and any(name in str(cell.value) for name in (*NAMES, "HYPERLINK"))
    ] == []
    assert [
        cell.hyperlink.target
        for cell in cells
        if cell.hyperlink and "javascript" in (cell.hyperlink.target or "")
    ] == []
    assert any(cell.value == "=1+1" and cell.data_type == "s" for cell in cells)


class _Tags(html.parser.HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.scripts: list[dict[str, str | None]] = []
        self.handlers: list[str] = []
        self.images = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.scripts += [dict(attrs)] if tag == "script" else []
        self.images += tag == "img"
        self.handlers += [
            name
            for name, value in attrs
            if name.startswith("on") or (value or "").startswith("javascript:")
        ]


def in_html(data: bytes) -> None:
    """As many scripts as the page has for a cell with plain names, and no element that a name has
    made.
    """
    page = _Tags()
    page.feed(data.decode())
    assert (page.handlers, page.images) == ([], 0)
    assert [script.get("type") for script in page.scripts if script.get("id") != "result"] == [None]


def in_xml(data: bytes) -> None:
    text = "".join(ET.fromstring(data).itertext())
    assert all(name in text for name in NAMES)


def in_svg(data: bytes) -> None:
    root = ET.fromstring(data)
    assert {element.tag.rpartition("}")[2] for element in root.iter()} & {
        "script",
        "foreignObject",
        "image",
        "a",
    } == set()


def in_markdown(data: bytes) -> None:
    """No element, no link and no further column of a table comes from a name; a line that is broken
    within a column is ours.
    """
    text = data.decode().replace("<br>", " ")
    assert re.findall(r"(?<!\\)<(?:img|script|/script|b|/title)", text) == []
    assert re.findall(r"(?<!\\)\[x(?<!\\)\]\(javascript", text) == []


def in_picture(data: bytes) -> None:
    """It was drawn, although dollars and braces mean mathematics to the one who draws it."""
    assert len(data) > 1000


CHECKS: dict[str, Callable[[bytes], None]] = {
    ".csv": in_csv,
    ".json": in_json,
    ".xlsx": in_xlsx,
    ".html": in_html,
    ".xml": in_xml,
    ".svg": in_svg,
    ".md": in_markdown,
    ".png": in_picture,
    ".pdf": in_picture,
}


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("ending", EXPORTERS)
def test_no_name_does_harm_in_any_file(
    tmp_path: Path, front: tandem.Front, ending: str, language: str
) -> None:
    path = write(front, tmp_path / f"plan{ending}", language=language)
    CHECKS[ending](path.read_bytes())


def test_no_name_does_harm_in_the_terminal(front: tandem.Front) -> None:
    """Brackets are markup to the library that colours the terminal; escapes never get into a
    cell.
    """
    from rich.console import Console

    console = Console(file=(out := io.StringIO()), width=400, force_terminal=False)
    console.print(GanttText(front.cell, front.knee.schedule))
    assert "\x1b" not in out.getvalue()
    with pytest.raises(tandem.CellError, match=r"control character U\+001B"):
        cell_of({"operators": {"r": {"kind": "robot"}}, "tasks": {"a\x1b[31m": {"time": {"r": 1}}}})
