"""The doors for files: YAML, JSON and public formats in and out. Spreadsheets have a
door of their own.
"""

from __future__ import annotations

import gc
import os
import re
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.cell.names import Known
from tandem.errors import CellError, Fault, NotReadWarning, NotWrittenWarning, UsageError
from tandem.files.atomic import store
from tandem.files.formats import hrcalbp
from tandem.files.formats.table import FORMATS, WRITERS, Readable, detected
from tandem.files.validate import cell_of

LARGEST = 20_000_000
"""Bytes that a cell file may have: a cell of 10,000 tasks has about one million."""
SHEETS = (".xls", ".ods", ".csv", ".tsv")
"""How the names of spreadsheets end or begin to end. Reading one takes assumptions that a person
should see.
"""
CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff]")


def load(path: str | os.PathLike[str] | Mapping[str, Any], format: str | None = None) -> Cell:
    """The cell that a file holds, or that plain values keyed as in a cell file describe; `-` reads
    standard input.

    Args:
      path: the file, or the values.
      format: a name from `FORMATS`, such as "yaml", "json" or "fjs"; told from the content, and the
        ending, when not given.

    Warns `NotReadWarning` of what stands in the file and has no place in a cell.

    Raises:
      CellError: the file cannot be read, is not of its form, or describes no sound cell; with every
        fault at its line and column.
      UsageError: there is no such format.
    """
    if isinstance(path, Mapping):
        return cell_of(path)
    if os.fspath(path) == "-":
        return loads(
            _text(sys.stdin.buffer.read(LARGEST + 1), "standard input", format),
            format,
            source="standard input",
        )
    source = os.fspath(path)
    data = _bytes(Path(path), source)
    if format is None and _is_sheet(Path(path), data):
        remedy = (
            f"Import it first, which shows how each column is read: `tandem import {source} -o"
            " cell.yaml`."
        )
        raise CellError([Fault(f"this is a spreadsheet. {remedy}", (), source)])
    return loads(_text(data, source, format), format, source=source)


def loads(text: str, format: str | None = None, source: str = "text") -> Cell:
    """The cell that a text holds; `source` is what messages call it. Raises as `load` does."""
    with _uncollected():
        document = _read(text, format, source)
        cell = cell_of(document.plain(), document.place, document.faults)
    for note in document.notes:
        warnings.warn(str(note), NotReadWarning, stacklevel=2)
    return cell


def document_in(data: bytes, source: str, format: str | None = None) -> Readable:
    """What stands in a file of these bytes, with its places, whether or not it is a sound cell;
    `source` is what messages call it. Raises as `load` does where it cannot be read at all.
    """
    return _read(_text(data, source, format), format, source)


def _read(text: str, format: str | None, source: str) -> Readable:
    if format is not None and format not in FORMATS:
        raise UsageError(f"there is no format {format!r}. {Known(FORMATS).hint(format)}")
    # the byte-order mark of Windows, the end mark of DOS
    text = text.removeprefix("\ufeff").rstrip("\x1a")
    _refuse_control_characters(text, source)
    if not text.strip():
        raise CellError(
            [Fault("the file is empty. A cell file has `operators` and `tasks`.", (), source)]
        )
    return FORMATS[format or detected(text, source)].read(text, source)


@contextmanager
def _uncollected() -> Iterator[None]:
    """No search for circular rubbish meanwhile: a tree of a million values has none, and looking
    through it takes half of the time.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


def dumps(cell: Cell, format: str = "yaml") -> str:
    """The cell as YAML, as JSON, or in the form of a public benchmark: a name from `WRITERS`.

    Warns `NotWrittenWarning` of what the form leaves out though no schedule depends on it: stress,
    names.

    Raises:
      UsageError: there is no such form.
      CellError: the form cannot say all that decides which schedules there are; with every reason.
    """
    if format not in WRITERS:
        raise UsageError(
            f"cells are not written as {format!r}. {Known(WRITERS).hint(format)} Cells are written"
            f" as {', '.join(WRITERS)}."
        )
    written = WRITERS[format].write(cell)
    for note in written.notes:
        warnings.warn(f"{format}: {note}", NotWrittenWarning, stacklevel=2)
    return written.text


def dump(cell: Cell, path: str | os.PathLike[str], format: str | None = None) -> None:
    """Writes the cell: in the form given, else in that of the file's ending (`.json`, `.fjs`,
    `.jsp`), else as YAML. The file is whole or, after an OSError, as it was before. Warns and
    raises as `dumps` does.
    """
    form = format or WRITTEN_ENDINGS.get(Path(path).suffix.lower(), "yaml")
    store(path, dumps(cell, form))


WRITTEN_ENDINGS = {".json": "json", ".fjs": "fjs", ".jsp": "jsp"}
"""How the name of a file ends, and what is written into it."""


def text_of(path: Path, source: str) -> str:
    """The text of a file that goes with a cell, such as one of people; `-` reads standard input.

    Raises:
      CellError: it cannot be read, is no text in UTF-8, or empty.
    """
    data = sys.stdin.buffer.read(LARGEST + 1) if str(path) == "-" else _bytes(path, source)
    text = _text(data, source, "yaml").removeprefix("\ufeff").rstrip("\x1a")
    _refuse_control_characters(text, source)
    if not text.strip():
        raise CellError([Fault("the file is empty.", (), source)])
    return text


def _bytes(path: Path, source: str) -> bytes:
    try:
        with open(path, "rb") as file:
            return file.read(LARGEST + 1)
    except FileNotFoundError as error:
        raise CellError([Fault(_not_there(path), (), source)]) from error
    except IsADirectoryError as error:
        raise CellError([Fault("this is a folder. Name a file in it.", (), source)]) from error
    except PermissionError as error:
        raise CellError(
            [
                Fault(
                    "there is no permission to read this file. Change its permissions, or copy it.",
                    (),
                    source,
                )
            ]
        ) from error
    except (OSError, ValueError) as error:
        raise CellError(
            [
                Fault(
                    f"this file cannot be read: {getattr(error, 'strerror', None) or error}.",
                    (),
                    source,
                )
            ]
        ) from error


def _is_sheet(path: Path, data: bytes) -> bool:
    """Whether a file's name is that of a spreadsheet, and what is in it no public format."""
    if not path.suffix.lower().startswith(SHEETS):
        return False
    return not hrcalbp.looks_like(data[:100_000].decode("latin-1"))


def _not_there(path: Path) -> str:
    folder = path.parent
    if not folder.is_dir():
        return f"there is no such file, and no folder {str(folder)!r}."
    try:
        near = Known(sorted(entry.name for entry in folder.iterdir())).nearest(path.name)
    except OSError:
        near = None
    return "there is no such file." + (f" Did you mean {str(folder / near)!r}?" if near else "")


def _text(data: bytes, source: str, format: str | None) -> str:
    if len(data) > LARGEST:
        raise CellError(
            [
                Fault(
                    f"the file has more than {LARGEST // 1_000_000} MB. A cell of 10,000 tasks has"
                    " about one.",
                    (),
                    source,
                )
            ]
        )
    if data.startswith(b"PK\x03\x04"):
        raise CellError(
            [
                Fault(
                    "this is a workbook or an archive, not a text. Import a workbook under its own"
                    " name (.xlsx, .ods).",
                    (),
                    source,
                )
            ]
        )
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise CellError([Fault("the text is encoded as UTF-16. Save it as UTF-8.", (), source)])
    if b"\x00" in data:
        raise CellError(
            [
                Fault(
                    "this is a binary file. A cell file is text: YAML, JSON or one of the public"
                    " formats.",
                    (),
                    source,
                )
            ]
        )
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        text = data.decode("latin-1")
        if (known := FORMATS.get(format or detected(text, source))) is not None and known.numbers:
            return text
        before = data[: error.start]
        place = f"{source}:{before.count(10) + 1}:{error.start - before.rfind(10)}"
        raise CellError(
            [
                Fault(
                    f"the byte 0x{data[error.start]:02x} is not UTF-8. Save the file as UTF-8.",
                    (),
                    place,
                )
            ]
        ) from error


def _refuse_control_characters(text: str, source: str) -> None:
    if found := CONTROL.search(text):
        place = found.start()
        line, column = text.count("\n", 0, place) + 1, place - text.rfind("\n", 0, place)
        message = (
            f"the control character 0x{ord(found.group()):02x} stands here; this is no text, or a"
            " damaged one. Take it out."
        )
        raise CellError([Fault(message, (), f"{source}:{line}:{column}")])
