"""From a cell to the thesis's arrays. What its encoding cannot hold is refused, every reason at
once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal

import numpy as np

from tandem.cell.beyond import beyond
from tandem.cell.model import Cell
from tandem.errors import CellError, Fault, UsageError
from tandem.lab.kinat2023.world import Station
from tandem.lab.refusal import enumerated_crew

LONGEST = 30_000
"""The largest time, ticks, that the world's whole numbers are meant for."""


def station(cell: Cell, *, per_second: int = 1) -> Station:
    """The cell as the thesis encodes it, in NumPy arrays; tasks keep the cell's order and are
    numbered from 1.

    Args:
      per_second: ticks in a second. The thesis has 1; a cell whose times are no whole seconds fits
        with more (`whole_ticks(cell)`).

    Raises:
      CellError: with everything that the thesis's encoding cannot hold.
      UsageError: `per_second` is no whole number above 0.
    """
    if isinstance(per_second, bool) or not isinstance(per_second, int) or per_second < 1:
        raise UsageError(
            f"per_second is {per_second!r}: give the ticks in a second as a whole number from 1."
        )
    faults = [fault for rule in RULES for fault in rule(cell)]
    faults += list(_times_do_not_fit(cell, per_second))
    if faults:
        raise CellError(faults)
    agents, tasks, human = (cell.robots[0], cell.humans[0]), cell.tasks.values(), cell.humans[0]
    time = [
        [int(_ticks(task.time[who], per_second)) if who in task.time else 0 for task in tasks]
        for who in agents
    ]
    stress = [
        task.stress.get(human, 0.0) if isinstance(task.stress, Mapping) else task.stress
        for task in tasks
    ]
    needs = [[other in task.after for other in cell.tasks] for task in tasks]
    return Station(np.array(time, np.int32), np.array(stress, np.float32), np.array(needs, bool))


def whole_ticks(cell: Cell) -> int:
    """The fewest ticks in a second (1, or 2, 5, 10, 20, 50, ...) that make every time of the cell a
    whole number of at least 2 ticks.
    """
    times = [
        Decimal(repr(seconds)) for task in cell.tasks.values() for seconds in task.time.values()
    ]
    scale = 1
    while not all((time * scale) % 1 == 0 and time * scale >= 2 for time in times):
        scale = scale * 5 // 2 if str(scale)[0] == "2" else scale * 2
    return scale


def _one_robot_and_one_human(cell: Cell) -> Iterator[Fault]:
    if len(cell.robots) != 1 or len(cell.humans) != 1 or cell.machines:
        yield Fault(
            f"the cell has {enumerated_crew(cell)}; the thesis's world has exactly one of each.",
            ("operators",),
        )


def _only_what_it_knows(cell: Cell) -> Iterator[Fault]:
    task = ("time", "stress", "after", "difficulty", "spread")
    yield from (
        Fault(_unknown(path[-1]), path) for path in beyond(cell, operator=("tool",), task=task)
    )


def _somebody_can_do_each_task(cell: Cell) -> Iterator[Fault]:
    for name, task in cell.tasks.items():
        if not task.time:
            yield Fault(
                "nobody can do it alone. The thesis's world holds 0 for who cannot, and a task with"
                " two zeros counts as done from the start.",
                ("tasks", name, "time"),
            )


RULES: tuple[Callable[[Cell], Iterator[Fault]], ...] = (
    _one_robot_and_one_human,
    _only_what_it_knows,
    _somebody_can_do_each_task,
)


def _times_do_not_fit(cell: Cell, per_second: int) -> Iterator[Fault]:
    for name, task in cell.tasks.items():
        for who, seconds in task.time.items():
            ticks, path = _ticks(seconds, per_second), ("tasks", name, "time", who)
            if ticks % 1:
                yield Fault(
                    f"{seconds:g} s is {ticks.normalize():f} ticks, no whole number; the thesis's"
                    f" world moves in whole ticks. With per_second={whole_ticks(cell)} every time"
                    " of this cell fits.",
                    path,
                )
            elif ticks == 1:
                yield Fault(
                    f"{seconds:g} s is one tick; the thesis takes one tick off every time at the"
                    f" start, so the task would vanish. With per_second={whole_ticks(cell)} every"
                    " time of this cell fits.",
                    path,
                )
            elif ticks > LONGEST:
                yield Fault(
                    f"{seconds:g} s is {ticks:f} ticks; the thesis's world counts to {LONGEST}. Use"
                    " a smaller per_second.",
                    path,
                )


def _ticks(seconds: float, per_second: int) -> Decimal:
    return Decimal(repr(seconds)) * per_second


def _unknown(key: str) -> str:
    return f"the thesis's world knows no {key.replace('_', ' ')}; leave it out to train there."
