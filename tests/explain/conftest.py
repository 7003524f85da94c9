"""Small cells whose answers a person can work out."""

from __future__ import annotations

import pytest

from tandem.cell.model import Cell
from tandem.files.spreadsheet.form import EXAMPLE


@pytest.fixture(scope="session")
def thesis() -> Cell:
    """The seven tasks of Kinat (2023), chapter 6; its front is (23, 7), (24, 3), (34, 2)."""
    return Cell.model_validate(EXAMPLE)
