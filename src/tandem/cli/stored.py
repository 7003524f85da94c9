"""Plans that were kept, as commands read them: told from cell files, and known when stale."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.report.stored import StoredPlan


def is_plan(name: str | Path) -> bool:
    """Whether a file holds a result document, and so no cell."""
    from tandem.report.results import is_result

    try:
        return is_result(json.loads(Path(name).read_bytes()))
    except (OSError, ValueError, RecursionError):
        return False


def stored_plan(name: str | Path, cell: Cell | None = None, language: str = "en") -> StoredPlan:
    """The plan in a file, and a warning on stderr when its cell has changed since. Raises as
    `read_plan` does.
    """
    from tandem.report.stored import read_plan

    plan = read_plan(Path(name), cell)
    if plan.is_stale:
        click.echo(plan.stale_note(language), err=True)
    return plan
