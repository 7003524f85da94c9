"""Plans that were kept, as commands read them: told from cell files, and known when stale."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.report.cycle.stored import StoredCycle
    from tandem.report.stored import StoredPlan


def is_plan(name: str | Path) -> bool:
    """Whether a file holds a result document, and so no cell."""
    from tandem.report.results import is_result

    return is_result(_document(name))


def holds_cycles(name: str | Path) -> bool:
    """Whether a file holds a result document of a station that repeats."""
    from tandem.report.results import is_cycle

    return is_cycle(_document(name))


def _document(name: str | Path) -> Any:
    """What a JSON file holds; None when it is none."""
    try:
        return json.loads(Path(name).read_bytes())
    except (OSError, ValueError, RecursionError):
        return None


def stored_plan(name: str | Path, cell: Cell | None = None, language: str = "en") -> StoredPlan:
    """The plan in a file, and a warning on stderr when its cell has changed since. Raises as
    `read_plan` does.
    """
    from tandem.report.stored import read_plan

    plan = read_plan(Path(name), cell)
    _tell_stale(plan, language)
    return plan


def stored_cycle(name: str | Path, cell: Cell | None = None, language: str = "en") -> StoredCycle:
    """The cycles in a file, and a warning on stderr when their cell has changed since. Raises as
    `read_cycle` does.
    """
    from tandem.report.cycle.stored import read_cycle

    cycle = read_cycle(Path(name), cell)
    _tell_stale(cycle, language)
    return cycle


def _tell_stale(kept: StoredPlan | StoredCycle, language: str) -> None:
    if kept.is_stale:
        click.echo(kept.stale_note(language), err=True)
