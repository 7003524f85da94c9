"""What somebody struck out is asked about, whatever program wrote the line and however it was
drawn: by a format of LibreOffice, or by marks in a text file.
"""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from openpyxl.styles import Font
from tests.files.spreadsheet.books import ods

from tandem.cell.model import Cell
from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell
from tandem.files.spreadsheet.template import export_cell

STRUCK = "is struck through, so it may count no more: delete it, or take the line away."


def refused(path: Path) -> list[tuple[str, str]]:
    with pytest.raises(CellError) as caught:
        import_cell(path)
    return [(fault.place.rpartition("!")[2], fault.message) for fault in caught.value.faults]


def plan(folder: Path, name: str, time: str = "11", after: str = "a") -> Path:
    """A text file whose second task has that name, time and predecessor."""
    file = folder / "plan.csv"
    lines = ["Task,Human [s],Robot [s],Pred", "a,10,12,", f"{name},{time},13,{after}", "c,4,5,a"]
    file.write_text("\n".join(lines), encoding="utf-8")
    return file


# --- by marks that are typed ----------------------------------------------------------------------


@pytest.mark.parametrize("name", ["~~old~~", "<s>old</s>", "<del>old</del>", "o̶l̶d̶", "~~a~~ ~~b~~"])
def test_a_name_that_is_struck_out_by_typing_is_asked_about(name: str, tmp_path: Path) -> None:
    assert refused(plan(tmp_path, name)) == [("A3", STRUCK)]


def test_times_and_predecessors_that_are_struck_out_by_typing(tmp_path: Path) -> None:
    """Each with its way out, rather than as a number that cannot be read."""
    path = plan(tmp_path, "b", "~~10~~ 12", "~~a~~")
    half = "holds '~~10~~ 12', of which '10' is struck through: leave only what counts."
    assert refused(path) == [("B3", half), ("D3", STRUCK)]


def test_marks_in_a_workbook_count_as_in_a_text_file(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    for row in (["Task", "Human [s]"], ["a", 10], ["~~b~~", 11]):
        book.active.append(row)
    book.save(tmp_path / "plan.xlsx")
    assert refused(tmp_path / "plan.xlsx") == [("A3", STRUCK)]


@pytest.mark.parametrize("name", ["~ 5 mm cut", "a ~~ b", "seal ~~", "x < y", "glue <s> side"])
def test_names_with_such_signs_that_strike_nothing_out(name: str, tmp_path: Path) -> None:
    cell, _ = import_cell(plan(tmp_path, name))
    assert list(cell.tasks) == ["a", name, "c"]


def test_a_name_in_double_quotes_stands_for_itself(tmp_path: Path) -> None:
    cell, _ = import_cell(plan(tmp_path, '"""~~old~~"""'))
    assert list(cell.tasks) == ["a", "~~old~~", "c"]
    export_cell(cell, tmp_path / "back.xlsx")
    assert list(import_cell(tmp_path / "back.xlsx")[0].tasks) == list(cell.tasks)


def test_a_column_whose_header_is_struck_through_is_asked_about(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    for row in (["Task", "Human [s]", "Robot [s]"], ["a", 10, 12]):
        book.active.append(row)
    book.active["C1"].font = Font(strike=True)
    path = tmp_path / "plan.xlsx"
    book.save(path)
    assert refused(path) == [("C1", STRUCK)]
    cell, _ = import_cell(path, columns={"C": "ignore"})
    assert cell.tasks["a"].time == {"Human": 10}


# --- in .ods --------------------------------------------------------------------------------------

ROWS = [["No", "Task", "Human [s]", "Robot [s]", "Pred"], [1, "a", 10, 12, None]]
ROWS += [[2, "b", 11, 13, 1]]
STYLES = (
    '<office:automatic-styles xmlns:style="urn:oasis:names:tc:opendocument:xmlns:style:1.0">'
    '<style:style style:name="ce1" style:family="table-cell"><style:text-properties'
    ' style:text-line-through-style="solid"/></style:style>'
    '<style:style style:name="ce2" style:family="table-cell"'
    ' style:parent-style-name="ce1"/>'
    '<style:style style:name="ce3" style:family="table-cell" style:parent-style-name="ce1">'
    '<style:text-properties style:text-line-through-style="none"/></style:style>'
    '<style:style style:name="ce4" style:family="table-cell"'
    ' style:parent-style-name="Deleted"/>'
    '<style:style style:name="T1" style:family="text"><style:text-properties'
    ' style:text-line-through-type="single"/></style:style>'
    '<style:style style:name="T2" style:family="text"><style:text-properties'
    ' style:text-position="33% 58%"/></style:style></office:automatic-styles>'
)
NAMED = (
    '<office:document-styles xmlns:office="urn:oasis:names:tc:opendocument:xmlns:office:1.0"'
    ' xmlns:style="urn:oasis:names:tc:opendocument:xmlns:style:1.0"><office:styles>'
    '<style:style style:name="Deleted" style:family="table-cell"><style:text-properties'
    ' style:text-line-through-type="double"/></style:style></office:styles>'
    "</office:document-styles>"
)


def with_styles(path: Path, rows: Sequence[Sequence[Any]], *changes: tuple[str, str]) -> Path:
    """An ods of these rows with styles, and its content changed here and there, each change
    once.
    """
    with zipfile.ZipFile(ods(path, rows)) as archive:
        parts = {name: archive.read(name).decode() for name in archive.namelist()}
    content = parts["content.xml"].replace("<office:body>", f"{STYLES}<office:body>")
    for old, new in changes:
        assert content.count(old) == 1
        content = content.replace(old, new)
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in {**parts, "content.xml": content, "styles.xml": NAMED}.items():
            archive.writestr(name, text)
    return path


B3 = '<table:table-cell office:value-type="string"><text:p>b</text:p>'
D3 = '<table:table-cell office:value-type="float" office:value="13">'


@pytest.mark.parametrize("style", ["ce1", "ce2", "ce4"])
def test_cells_of_an_ods_that_are_struck_through_are_asked_about(
    style: str, tmp_path: Path
) -> None:
    """By a style of their own, one above it, or one that has a name."""
    styled = f'<table:table-cell table:style-name="{style}"'
    changes = [(cell, cell.replace("<table:table-cell", styled)) for cell in (B3, D3)]
    path = with_styles(tmp_path / "plan.ods", ROWS, *changes)
    assert sorted(refused(path)) == [("B3", STRUCK), ("D3", STRUCK)]


def test_a_style_without_a_line_takes_that_of_the_one_above_away(tmp_path: Path) -> None:
    plain = B3.replace("<table:table-cell", '<table:table-cell table:style-name="ce3"')
    path = with_styles(tmp_path / "plan.ods", ROWS, (B3, plain))
    assert list(import_cell(path)[0].tasks) == ["1", "2"]


def test_a_column_of_an_ods_that_is_struck_through(tmp_path: Path) -> None:
    """Its cells have no style; that of the column is theirs."""
    columns = (
        '<table:table-column table:number-columns-repeated="3"/>'
        '<table:table-column table:default-cell-style-name="ce1"/>'
    )
    start = '<table:table table:name="Tabelle1">'
    path = with_styles(tmp_path / "plan.ods", ROWS, (start, start + columns))
    ((place, message),) = refused(path)
    assert place == "D1"
    assert message == f"column D 'Robot [s]', rows 1 to 3, as here: {STRUCK}"


def test_parts_of_a_text_of_an_ods_are_not_read_in_one(tmp_path: Path) -> None:
    """Read in one, the first time would be 1012 and the second 101."""
    rows = [*ROWS[:2], [2, "b", "1012", "101", 1]]
    run = '<text:span text:style-name="{}">{}</text:span>'
    path = with_styles(
        tmp_path / "plan.ods",
        rows,
        ("<text:p>1012</text:p>", f"<text:p>{run.format('T1', '10')}12</text:p>"),
        ("<text:p>101</text:p>", f"<text:p>10{run.format('T2', '1')}</text:p>"),
    )
    assert refused(path) == [
        ("C3", "holds '1012', of which '10' is struck through: leave only what counts."),
        ("D3", "holds '101', of which '1' is a raised mark: leave only the number."),
    ]


def test_styles_that_stand_above_each_other_in_a_ring_end(tmp_path: Path) -> None:
    ring = STYLES.replace('"ce1" style:family', '"ce1" style:parent-style-name="ce2" style:family')
    ring = ring.replace('<style:text-properties style:text-line-through-style="solid"/>', "")
    plain = B3.replace("<table:table-cell", '<table:table-cell table:style-name="ce2"')
    path = with_styles(tmp_path / "plan.ods", ROWS, (STYLES, ring), (B3, plain))
    assert isinstance(import_cell(path)[0], Cell)
