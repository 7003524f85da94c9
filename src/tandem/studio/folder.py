"""The files that the studio may touch: those of one folder, or one file. Everything else is
refused, links included.
"""

from __future__ import annotations

import hashlib
import json
import os
import stat
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault, UsageError
from tandem.files.atomic import store
from tandem.files.json_writer import to_json
from tandem.files.load import LARGEST, document_in
from tandem.files.validate import cell_of
from tandem.files.yaml_edit import changed
from tandem.files.yaml_writer import to_yaml

READ = (".yaml", ".yml", ".json")
"""How the names of files end that the studio opens and writes."""
DRAFT = ".draft.json"
"""What is put behind the name of a file for what was not saved when the server was stopped."""
MOST_FILES = 500
DEEPEST = 4
"""Folders below the given one that are looked into."""


class OutsideError(UsageError):
    """A name that leads out of the folder, over a link, or to no cell file."""


class MissingError(CellError):
    """There is no such file, or it cannot be read."""


class NewerError(Exception):
    """The file on disk is not the one that was read.

    Attributes:
      now: the file as it is; None when it is gone.
    """

    def __init__(self, now: Opened | None):
        super().__init__("the file on disk is newer than what was opened")
        self.now = now


@dataclass(frozen=True)
class Opened:
    """A cell file as it stands on the disk.

    Attributes:
      name: from the folder, with `/`.
      document: the cell as JSON: as a sound cell is written, else as it stands there.
      faults: what keeps it from being a sound cell.
      version: changes when the content does.
    """

    name: str
    document: Any
    faults: tuple[Fault, ...]
    version: str


class Folder:
    """One folder with cell files, or one cell file.

    Args:
      given: the folder or the file, as the user named it.

    Raises CellError when there is no such thing, or the file cannot be opened in the studio.
    """

    def __init__(self, given: str | os.PathLike[str]):
        path = Path(os.path.realpath(given))
        self.is_folder = path.is_dir()
        self.root = path if self.is_folder else path.parent
        self.only = None if self.is_folder else path.name
        self._writing = threading.Lock()
        if self.only is not None:
            if path.suffix.lower() not in READ:
                fault = (
                    "the studio opens .yaml and .json files. Turn it into one first:"
                    f" `tandem convert {given} -o cell.yaml`, or `tandem import` for a workbook."
                )
                raise CellError([Fault(fault, (), os.fspath(given))])
            self._bytes(self.only)

    # --- names ------------------------------------------------------------------------------------

    def chosen(self, name: str | None) -> str:
        """The file that a request means: the one it names, else the only or the first one. Raises
        OutsideError; CellError when there is none.
        """
        if name is None:
            files = self.names()
            if not files:
                fault = "there is no cell file in this folder yet. Import a workbook or save one."
                raise MissingError([Fault(fault)])
            return files[0]
        self._inside(name)
        return name

    def names(self) -> list[str]:
        """The cell files, in order of their names; at most `MOST_FILES`."""
        if self.only is not None:
            return [self.only]
        found: list[str] = []
        for here, folders, files in os.walk(self.root, followlinks=False):
            below = Path(here).relative_to(self.root)
            folders[:] = sorted(
                name
                for name in folders
                if not name.startswith(".") and len(below.parts) + 1 < DEEPEST
            )
            found += [
                (below / name).as_posix()
                for name in sorted(files)
                if self._is_cell_file(Path(here, name))
            ]
            if len(found) >= MOST_FILES:
                break
        return sorted(found[:MOST_FILES], key=lambda name: (name.count("/"), name))

    def _is_cell_file(self, path: Path) -> bool:
        if path.name.startswith(".") or path.suffix.lower() not in READ or path.is_symlink():
            return False
        if path.name.endswith(DRAFT):
            return False
        # of JSON files some are plans; those have a front, which no cell has
        return path.suffix.lower() != ".json" or _looks_like_a_cell(path)

    def _inside(self, name: str) -> Path:
        """Where the file is. Raises OutsideError for every name that is not plainly one of this
        folder's.
        """
        parts = name.split("/")
        if self.only is not None and name != self.only:
            raise OutsideError(f"the studio was opened on {self.only} alone; {name!r} is not open.")
        if (
            "\\" in name
            or "\0" in name
            or ":" in parts[0]
            or any(part in ("", ".", "..") or part.startswith(".") for part in parts)
        ):
            raise OutsideError(f"{name!r} is no file of this folder.")
        if Path(name).suffix.lower() not in READ:
            raise OutsideError(f"{name!r} is no cell file: {', '.join(READ)} are opened.")
        path = self.root
        for part in parts:
            path = path / part
            if path.is_symlink():
                raise OutsideError(f"{name!r} is or lies behind a link, which is not followed.")
        return path

    # --- reading ----------------------------------------------------------------------------------

    def open(self, name: str) -> Opened:
        """The file as it is now. Raises OutsideError; CellError when it is no text of a cell."""
        data = self._bytes(name)
        document = document_in(data, name)
        plain = document.plain()
        try:
            cell = cell_of(plain, document.place, document.faults)
        except CellError as error:
            return Opened(name, plain, error.faults, version_of(data))
        return Opened(name, cell.to_dict(), (), version_of(data))

    def version(self, name: str) -> str | None:
        """That of the file as it is now; None when there is none."""
        try:
            return version_of(self._bytes(name))
        except CellError:
            return None

    def _bytes(self, name: str) -> bytes:
        path = self._inside(name)
        try:
            # the last step is opened without following a link that came meanwhile
            handle = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0))
            with os.fdopen(handle, "rb") as file:
                if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                    raise MissingError([Fault("is no file.", (), name)])
                return file.read(LARGEST + 1)
        except OSError as error:
            why = (error.strerror or "unknown").lower()
            raise MissingError([Fault(f"cannot be read: {why}.", (), name)]) from error

    # --- writing ----------------------------------------------------------------------------------

    def save(self, name: str, cell: Cell, version: str | None) -> str:
        """Writes the cell and returns the new version. Of a YAML file what has not changed stays
        as it was written, comments included.

        Args:
          version: of the file that was read; None for a new file.

        Raises:
          NewerError: the file is another one now, or is there already.
          OutsideError, OSError: it cannot be written; what was there is as it was.
        """
        path = self._inside(name)
        with self._writing:
            if self.version(name) != version:
                raise NewerError(self.open(name) if path.exists() else None)
            text = self._text(name, cell, version)
            store(path, text)
        self.forget_draft(name)
        return version_of(text.encode())

    def _text(self, name: str, cell: Cell, version: str | None) -> str:
        """What is to stand in the file."""
        if name.lower().endswith(".json"):
            return to_json(cell)
        if version is None:
            return to_yaml(cell)
        try:
            before = self.open(name).document
        except CellError:  # no YAML at all
            return to_yaml(cell)
        return changed(self._bytes(name).decode(), before, cell)

    # --- what was not saved -----------------------------------------------------------------------

    def keep_draft(self, name: str, document: Any, version: str | None) -> Path:
        """Keeps what a page had not saved beside its file; returns where."""
        beside = self._beside(name)
        kept = {"cell": document, "version": version}
        store(beside, json.dumps(kept, ensure_ascii=False, indent=1) + "\n")
        return beside

    def keep_plan(self, name: str, document: Any) -> Path:
        """Keeps what an interrupted search had found beside its cell; returns where."""
        path = self._inside(name)
        beside = path.with_name(f"{path.stem}.interrupted.json")
        if beside.is_symlink():
            raise OutsideError(f"{beside.name} is a link, which is not followed.")
        store(beside, json.dumps(document, ensure_ascii=False, indent=2) + "\n")
        return beside

    def draft(self, name: str) -> Mapping[str, Any] | None:
        """What was kept for the file; None when nothing was, or it is damaged."""
        try:
            kept = json.loads(self._beside(name).read_bytes())
        except (OSError, ValueError, RecursionError):
            return None
        return kept if isinstance(kept, dict) and set(kept) == {"cell", "version"} else None

    def forget_draft(self, name: str) -> None:
        """Takes away what was kept for the file."""
        self._beside(name).unlink(missing_ok=True)

    def _beside(self, name: str) -> Path:
        path = self._inside(name)
        beside = path.with_name(path.name + DRAFT)
        if beside.is_symlink():
            raise OutsideError(f"{beside.name} is a link, which is not followed.")
        return beside


def version_of(data: bytes) -> str:
    """Sixteen bytes in hexadecimal that change when the content does."""
    return hashlib.sha256(data).hexdigest()[:32]


def _looks_like_a_cell(path: Path) -> bool:
    try:
        document = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(document, dict) and "tasks" in document and "front" not in document
