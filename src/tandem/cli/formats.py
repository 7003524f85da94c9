"""What `tandem formats` shows: the formats, and how a folder of benchmark sets reads."""

from __future__ import annotations

import json
import re
import warnings
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import click

from tandem.cli.columns import aligned
from tandem.errors import CellError, NotReadWarning
from tandem.files.formats.table import FORMATS, WRITERS, detected
from tandem.files.instances.named import files_of
from tandem.files.load import load

NUMBERS = re.compile(r"[0-9][0-9,.]*")
NAMED = re.compile(r"\b(activity|resource|task) [A-Z]?[0-9]+")


@dataclass
class Set:
    """How the files of one folder read.

    Attributes:
      formats: name of a format -> files that are of it.
      refused: reason, with its numbers taken out -> files refused for it.
      example: the same reason -> one file's own words.
    """

    name: str
    files: int = 0
    cells: int = 0
    formats: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    example: dict[str, str] = field(default_factory=dict)

    def read(self, path: Path) -> None:
        """Counts one file."""
        self.files += 1
        try:
            self.formats[detected(path.read_bytes().decode("latin-1"), str(path))] += 1
            load(path)
            self.cells += 1
        except CellError as error:
            first = error.faults[0]
            reason = NUMBERS.sub("…", NAMED.sub(r"\1 …", first.message.partition(". ")[0])).rstrip(
                "."
            )
            self.refused[reason] += 1
            self.example.setdefault(reason, str(first))

    def to_dict(self) -> dict[str, Any]:
        """Plain values, for `--json`."""
        return {
            "set": self.name,
            "files": self.files,
            "cells": self.cells,
            "formats": dict(self.formats),
            "refused": [
                {"files": count, "reason": reason, "example": self.example[reason]}
                for reason, count in self.refused.most_common()
            ],
        }


def tell_formats(as_json: bool) -> None:
    """All formats, what each is, whether it is read and written."""
    names = list(dict.fromkeys([*FORMATS, *WRITERS]))
    rows: list[dict[str, Any]] = [
        {
            "name": name,
            "what": FORMATS[name].what if name in FORMATS else WRITERS[name].what,
            "read": name in FORMATS,
            "written": name in WRITERS,
        }
        for name in names
    ]
    if as_json:
        click.echo(json.dumps({"schema_version": 1, "formats": rows}, indent=1))
        return
    shown: list[tuple[str, ...]] = [("format", "read", "written", "what it is")]
    shown += [(r["name"], _yes(r["read"]), _yes(r["written"]), r["what"]) for r in rows]
    click.echo("\n".join(aligned(shown)))


def survey(folder: Path, as_json: bool) -> None:
    """Reads every file below the folder and shows a row for each folder in it."""
    sets: dict[str, Set] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotReadWarning)
        for path in files_of(folder):
            parts = path.relative_to(folder).parts
            name = parts[0] if len(parts) > 1 else folder.resolve().name
            sets.setdefault(name, Set(name)).read(path)
    if as_json:
        document = {"schema_version": 1, "sets": [one.to_dict() for one in sets.values()]}
        click.echo(json.dumps(document, indent=1, ensure_ascii=False))
        return
    _show(list(sets.values()))


def _show(sets: list[Set]) -> None:
    rows = [("set", "format", "files", "cells")]
    rows += [(one.name, ", ".join(one.formats), str(one.files), str(one.cells)) for one in sets]
    files, cells = sum(one.files for one in sets), sum(one.cells for one in sets)
    click.echo("\n".join(aligned([*rows, ("all", "", str(files), str(cells))])))
    refused: dict[str, Counter[str]] = {}
    for one in sets:
        for reason, count in one.refused.items():
            refused.setdefault(reason, Counter())[one.name] += count
    if refused:
        click.echo("\nNot cells, because")
    for reason, counts in refused.items():
        where = ", ".join(f"{count} of {name}" for name, count in counts.items())
        click.echo(f"  {reason}: {where}")


def _yes(fact: bool) -> str:
    return "yes" if fact else ""
