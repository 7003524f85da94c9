"""The way out that a message names fits the column in which the fault is."""

from __future__ import annotations

from pathlib import Path

import pytest

from tandem.cell.spreadsheet import import_cell
from tandem.errors import CellError

HEADERS = ("Task", "t human [s]", "t robot [s]", "Stress", "Release [s]", "Deadline [s]", "Predecessors")


@pytest.mark.parametrize("column", ["t human [s]", "Stress", "Release [s]", "Deadline [s]"])
def test_no_column_but_a_time_speaks_of_who_can_do_the_task(column: str, tmp_path: Path) -> None:
    row = dict(zip(HEADERS, ("1", "5", "6", "2", "0", "90", ""), strict=True)) | {column: "about ten"}
    file = tmp_path / "tasks.csv"
    file.write_text("\n".join(",".join(cells) for cells in (HEADERS, row.values(), ("2", "5", "6", "1", "0", "90", "1"))), encoding="utf-8")
    with pytest.raises(CellError) as refused:
        import_cell(file)
    (fault,) = refused.value.faults
    letter = "ABCDEFG"[HEADERS.index(column)]
    assert fault.place.endswith(f"!{letter}2")
    assert fault.message == "holds 'about ten' where a number is expected: write one number, or leave the cell empty if there is none."
