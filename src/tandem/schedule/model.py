"""A schedule: who does which task, from when to when. What follows from it is computed, never
stored.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from tandem.cell.names import clean


@dataclass(frozen=True, order=True)
class Assignment:
    """One task on the clock.

    Attributes:
      start, end: seconds since the start of the assembly.
      task: its name.
      operators: who does it, in the cell's order; several for a joint task.
    """

    start: float
    end: float
    task: str
    operators: tuple[str, ...]


@dataclass(frozen=True)
class Schedule:
    """Assignments in order of their start. A schedule may break its cell; `faults(cell, schedule)`
    judges it.
    """

    assignments: tuple[Assignment, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "assignments", tuple(sorted(self.assignments)))

    def __iter__(self) -> Iterator[Assignment]:
        return iter(self.assignments)

    def __len__(self) -> int:
        return len(self.assignments)

    def of(self, operator: str) -> tuple[Assignment, ...]:
        """What one operator does, in order."""
        return tuple(a for a in self.assignments if operator in a.operators)

    @cached_property
    def digest(self) -> str:
        """Twelve hexadecimal digits that change when anything in the schedule does: what sheets,
        pictures and explanations are told apart by.
        """
        rows = sorted(self.to_list(), key=lambda row: row["task"])
        return hashlib.sha256(json.dumps(rows, sort_keys=True).encode()).hexdigest()[:12]

    def to_list(self) -> list[dict[str, Any]]:
        """As the `assignments` of a result document."""
        return [
            {
                "task": a.task,
                "operators": list(a.operators),
                "start": _short(a.start),
                "end": _short(a.end),
            }
            for a in self.assignments
        ]

    @classmethod
    def from_list(cls, rows: list[Mapping[str, Any]]) -> Schedule:
        """The inverse of `to_list`, names in their one spelling. Raises KeyError, TypeError or
        ValueError when a row is not of its form.
        """
        return cls(
            tuple(
                Assignment(
                    float(r["start"]),
                    float(r["end"]),
                    _name(r["task"]),
                    tuple(map(_name, r["operators"])),
                )
                for r in rows
            )
        )


def _name(value: object) -> str:
    return clean(str(value))


def _short(seconds: float) -> float | int:
    return int(seconds) if seconds == int(seconds) else seconds
