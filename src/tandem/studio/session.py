"""What one start of the studio holds: the folder, the processes that search, and what pages have
not saved yet.
"""

from __future__ import annotations

import secrets
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tandem.errors import UsageError
from tandem.studio.folder import Folder
from tandem.studio.pool import Pool

Json = dict[str, Any]

MOST_DRAFTS = 50
"""Drafts that are held; the oldest goes first."""


@dataclass(frozen=True)
class Draft:
    """A cell that a page has and its file has not.

    Attributes:
      name: the file; None for a cell that has none yet.
      version: of the file, when the page read it.
    """

    cell: Any
    name: str | None
    version: str | None


class Session:
    """One start of the server. `pool` is made when the event loop runs."""

    def __init__(self, folder: Folder):
        self.folder = folder
        self.pool = Pool()
        self.drafts: OrderedDict[str, Draft] = OrderedDict()
        self.is_ending = False
        self.kept: list[str] = []

    def hold(self, draft: Draft) -> str:
        """Holds a draft and returns what it is called."""
        number = secrets.token_hex(8)
        self.drafts[number] = draft
        while len(self.drafts) > MOST_DRAFTS:
            self.drafts.popitem(last=False)
        return number

    def drop(self, name: str) -> None:
        """Forgets the drafts of a file, which is saved now or is to stay as it is."""
        for number in [key for key, draft in self.drafts.items() if draft.name == name]:
            del self.drafts[number]
        self.folder.forget_draft(name)

    def document(self, given: Mapping[str, Any]) -> Any:
        """The cell that a request means: the one in it, that of its draft, or that of its file.
        Raises UsageError; CellError.
        """
        if given.get("cell") is not None:
            return given["cell"]
        if (number := given.get("draft")) is not None:
            if number not in self.drafts:
                raise UsageError(f"there is no draft {number!r} any more; give the cell again.")
            return self.drafts[number].cell
        return self.folder.open(self.folder.chosen(given.get("file"))).document

    def name_of(self, given: Mapping[str, Any]) -> str | None:
        """The file that a request is about; None for a draft that has none yet."""
        if (number := given.get("draft")) is not None:
            draft = self.drafts.get(number)
            return None if draft is None else draft.name
        return self.folder.chosen(given.get("file"))

    def keep_found(self, name: str | None, document: Json) -> None:
        """Keeps what a search had found when the server was stopped, as the command line does."""
        if name is not None and document.get("interrupted"):
            self.kept.append(str(self.folder.keep_plan(name, document)))

    def keep_unsaved(self) -> list[str]:
        """Writes what pages had not saved beside their files, the latest of each; returns where."""
        latest = {draft.name: draft for draft in self.drafts.values() if draft.name is not None}
        for name, draft in latest.items():
            try:
                if self.folder.open(name).document == draft.cell:
                    continue
            except Exception:  # noqa: BLE001  whatever became of the file, the draft is not lost
                pass
            try:
                self.kept.append(str(self.folder.keep_draft(name, draft.cell, draft.version)))
            except (OSError, UsageError):
                continue
        return self.kept
