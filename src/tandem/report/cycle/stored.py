"""The cycles of a station that were kept: the very front that was written, read back with the cell
that it was made for, every pattern judged by the checker of periodic schedules.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault, UsageError
from tandem.plan.cycle.question import FRONT, CycleQuestion
from tandem.plan.cycle.result import CycleBound, CycleFront, CycleResult
from tandem.report.results import is_cycle, is_number, patterns_of
from tandem.report.stored import Stored, number_or, open_stored, status_of, whole_of
from tandem.schedule.cycle import PeriodicSchedule

StoredCycle = Stored[CycleFront]


def read_cycle(path: str | os.PathLike[str], cell: Cell | None = None) -> StoredCycle:
    """The cycles in a result document, the very points that were stored; as `read_plan` reads
    plans.

    Raises:
      CellError: the file is no result document of cycles, holds no point, or no cell although none
        was given.
      UnsoundScheduleError: a pattern breaks a cell that it is to keep, or is not worth what the
        document says.
    """
    opened = open_stored(path, cell, cycles=True)
    if not is_cycle(opened.document):
        fault = "holds plans of one product, and no cycles. Read it as a plan."
        raise CellError([Fault(fault, (), str(path))])
    front = _front(opened.document, opened.cell)
    return StoredCycle(front, opened.made_for, opened.is_stale, opened.changed, opened.path)


def _front(document: Mapping[str, Any], cell: Cell) -> CycleFront:
    source = document.get("source")
    return CycleFront(
        cell,
        tuple(
            CycleResult(cell, pattern, status_of(row), _bound(row), row.get("canonical") is True)
            for pattern, row in zip(patterns_of(document), document["front"], strict=True)
            if isinstance(pattern, PeriodicSchedule)
        ),
        document.get("complete") is True,
        str(document.get("method", "")),
        str(document.get("solver", "")),
        whole_of(document.get("seed")),
        float(number_or(document.get("wall_s"), 0.0)),
        document.get("interrupted") is True,
        _question(document.get("question")),
        source if isinstance(source, str) else None,
        out_of_time=document.get("ended_by") == "time",
        mix=_mix(document.get("mix")),
    )


def _mix(told: Any) -> tuple[tuple[str, int], ...]:
    """What a cycle makes; one product of the cell where the document does not say."""
    told = told if isinstance(told, Mapping) else {}
    return tuple((str(name), count) for name, count in told.items() if whole_of(count) > 0)


def _bound(row: Mapping[str, Any]) -> CycleBound:
    """What is proven about a point; nothing where the document does not say."""
    told = row.get("bound")
    told = told if isinstance(told, Mapping) else {}
    return CycleBound(
        number_or(told.get("cycle_time"), 0.0),
        number_or(told.get("stress"), 0.0),
        max(whole_of(told.get("in_process")), 1),
    )


def _question(told: Any) -> CycleQuestion:
    """What was asked; the whole front where the document does not say."""
    if not isinstance(told, Mapping):
        return FRONT
    takt, most, stress = (told.get(key) for key in ("takt", "max_in_process", "max_stress"))
    if not all(limit is None or is_number(limit) for limit in (takt, most, stress)):
        return FRONT
    try:
        return CycleQuestion(told.get("minimize", "front"), takt, most, stress)
    except (UsageError, TypeError):
        return FRONT
