"""The cells that the system of Antonelli and others (2021) is run on."""

from __future__ import annotations

from importlib import resources

from tandem.cell.model import Cell
from tandem.files.load import load
from tandem.lab.kinat2023.game import thesis_cell


def cells() -> dict[str, Cell]:
    """The cells that it is run on: its own, and one that is not."""
    return {"flanges": own_cell(), "thesis": thesis_cell()}


def own_cell() -> Cell:
    """Two flanges on a base, each with fasteners."""
    with resources.as_file(
        resources.files("tandem.lab.antonelli2021") / "antonelli2021.yaml"
    ) as file:
        return load(file)
