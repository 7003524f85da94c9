"""A cell as JSON, one value a line."""

from __future__ import annotations

import json

from tandem.cell.model import Cell
from tandem.files.yaml_writer import escaped


def to_json(cell: Cell) -> str:
    """The cell file; reading it gives an equal cell."""
    return escaped(json.dumps(cell.to_dict(), ensure_ascii=False, indent=1)) + "\n"
