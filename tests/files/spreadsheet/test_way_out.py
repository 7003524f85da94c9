"""The way out that a message names fits the column in which the fault is."""

from __future__ import annotations

from pathlib import Path

import pytest

from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell


@pytest.mark.parametrize("column", ["t human [s]", "Stress", "Release [s]", "Deadline [s]"])
def test_no_column_but_a_time_speaks_of_who_can_do_the_task(column: str, tmp_path: Path) -> None:
    headers = ["Task", "t human [s]", *({column} - {"t human [s]"}), "Predecessors"]
    file = tmp_path / "tasks.csv"
    rows = [["1", *"5" * (len(headers) - 2), ""], ["2", *"5" * (len(headers) - 2), "1"]]
    rows[1][headers.index(column)] = "about ten"
    file.write_text("\n".join(",".join(cells) for cells in (headers, *rows)), encoding="utf-8")
    with pytest.raises(CellError) as refused:
        import_cell(file)
    (fault,) = refused.value.faults
    letter = "ABC"[headers.index(column)]
    assert fault.place.endswith(f"!{letter}3")
    assert (
        fault.message
        == "holds 'about ten' where a number is expected: write one number, or leave the cell empty"
        " if there is none."
    )
