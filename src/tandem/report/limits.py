"""What each person has used of the `limits` of the cell: in words, and as rows of a table."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from tandem.cell.burdens import named, worth
from tandem.cell.measures import OWN
from tandem.cell.model import Cell
from tandem.draw.style import looks
from tandem.report.language import Words
from tandem.schedule.exposure import all_limits, by_person
from tandem.schedule.model import Schedule

HEADS = ("operator", "measure", "used", "most", "share")
"""What is told of a limit, in the order of the columns."""


class Used(NamedTuple):
    """What a person has used of a limit: their label, the measure, the value and its limit."""

    who: str
    measure: str
    value: float
    most: float

    def words(self, t: Words) -> list[str]:
        """As `HEADS` says."""
        share = t.share(self.value / self.most) if self.most else "–"
        shown = t.number(float(f"{self.value:.6g}"))
        return [self.who, self.measure, shown, t.number(self.most), share]


def used_of_limits(cell: Cell, schedule: Schedule) -> list[Used]:
    """Of every limit in `limits`, what the schedule uses; a `stress_limit` stands with the stress
    of its operator.
    """
    shown = looks(cell)
    return [
        Used(
            shown[limit.who or ""].label,
            name,
            float(by_person(cell, schedule, limit.measure, cycles=limit.cycles)[limit.who or ""]),
            float(limit.most),
        )
        for name, limit in all_limits(cell)
        if name != OWN
    ]


def limit_heads(t: Words) -> list[str]:
    """The words above the columns."""
    return [t(f"limits.{key}") for key in HEADS]


def assumed(cell: Cell, t: Words) -> Iterator[str]:
    """What every plan keeps, and what nobody knows: tasks without a value on a limited scale."""
    shown, scales = looks(cell), dict[str, dict[str, None]]()
    told = []
    for who, operator in cell.operators.items():
        for name, most in operator.limits.items():
            told.append(f"{shown[who].label} {name} {t.number(most)}")
            if (scale := named(name, cell).scale) != OWN:
                scales.setdefault(scale, {})[who] = None
    if not told:
        return
    yield t("assume.limits.more", limits=", ".join(told))
    if cell.cycles_per_shift is not None:
        yield t("assume.cycles", n=t.number(cell.cycles_per_shift))
    for scale, people in scales.items():
        unknown = [
            task
            for task in cell.tasks
            if any(
                who in mode.operators and who not in worth(cell, scale, task, mode)
                for mode in cell.modes(task)
                for who in people
            )
        ]
        if unknown:
            yield t("assume.unknown", scale=scale, tasks=", ".join(unknown))
