"""A file of facts in: `load_facts("facts.yaml")`, or a workbook."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from pathlib import Path

from tandem.cell.stated import Conditions
from tandem.ergonomics.facts import FactsError
from tandem.ergonomics.tasks import TaskFacts
from tandem.errors import CellError, Fault
from tandem.files.facts import document, sheet
from tandem.files.spreadsheet.workbook import is_spreadsheet

LARGEST = 20_000_000


@dataclass(frozen=True)
class FactsFile:
    """What a file of facts holds.

    Attributes:
      name: of the whole, from the file or its name.
      tasks: one for each task, side and method.
      remarks: what stands there and was not read, a sentence each.
    """

    name: str
    tasks: tuple[TaskFacts, ...]
    remarks: tuple[str, ...] = ()


def load_facts(path: str | os.PathLike[str], whole: Conditions | None = None) -> FactsFile:
    """The tasks that a file describes, with their facts.

    Args:
      path: YAML or JSON, `-` of standard input, or a spreadsheet by its ending.

    Raises:
      FactsError, CellError: with every fault at its place.
    """
    whole = whole or Conditions()
    where = Path(path)
    if is_spreadsheet(where):
        tasks, remarks = sheet.read(where, whole)
        return FactsFile(where.stem, tuple(tasks), tuple(remarks))
    try:
        data = _bytes(where)
    except OSError as error:
        said = (error.strerror or str(error)).lower()
        raise FactsError([Fault(f"the file cannot be read: {said}.", place=str(path))]) from error
    if len(data) > LARGEST:
        raise FactsError([Fault("the file has more than 20 MB.", place=str(path))])
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FactsError(
            [Fault("the text is not UTF-8. Save the file as UTF-8.", place=str(path))]
        ) from error
    if not text.strip():
        raise FactsError([Fault("the file is empty. It needs `tasks`.", place=str(path))])
    source = "standard input" if str(path) == "-" else str(path)
    tasks, name = document.read(text, source, whole)
    return FactsFile(name or Path(source).stem, tuple(tasks))


def holds_cell(path: str | os.PathLike[str]) -> bool:
    """Whether a file is a cell file, whose tasks may have facts. What cannot be read is none."""
    where = Path(path)
    if str(path) == "-" or is_spreadsheet(where):
        return False
    try:
        text = where.read_text("utf-8-sig")
        root = document.tree(text, str(path)).root.value if text.strip() else None
    except (OSError, UnicodeDecodeError, CellError):
        return False
    return isinstance(root, dict) and "operators" in root


def _bytes(path: Path) -> bytes:
    if str(path) == "-":
        return sys.stdin.buffer.read(LARGEST + 1)
    with open(path, "rb") as file:
        return file.read(LARGEST + 1)
