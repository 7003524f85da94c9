"""What the formats that a cell can be written in have in common: whole numbers, and a refusal of
whatever they have no word for.

What decides which schedules there are, or how long they take, is refused when the form cannot say
it. What does not (stress, names, kinds of operators, money) is left out and named.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from graphlib import TopologicalSorter
from typing import NamedTuple

from tandem.cell.beyond import beyond
from tandem.cell.model import Cell
from tandem.errors import CellError, Fault

HARMLESS = ("stress", "difficulty", "spread")
"""Keys of a task that no schedule depends on: they say what it costs, or how much it scatters."""
FREE = {("cost",), ("places",)}
"""Top-level keys of the same sort: places alone cost nobody a second."""


class Written(NamedTuple):
    """A cell in another form, and what of it is not there, a sentence each."""

    text: str
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Whole:
    """Seconds as whole numbers of a unit.

    Attributes:
      per_second: units in a second: 1, 10, 100, ...
    """

    per_second: int

    def __call__(self, seconds: float) -> int:
        """Seconds that the cell states, in units."""
        return int(Decimal(repr(seconds)) * self.per_second)


def whole_numbers(seconds: Iterable[float]) -> Whole:
    """The largest unit, a second or a decimal part of it, of which all these are multiples."""
    places = [-int(Decimal(repr(value)).normalize().as_tuple().exponent) for value in seconds]
    return Whole(10 ** max(0, *places, 0))


def not_said(cell: Cell, unit: Whole) -> Iterator[str]:
    """What no form but our own says, in sentences."""
    if any(task.stress for task in cell.tasks.values()):
        yield "the stress of tasks is not written: this form knows only time."
    if any(task.ergonomics for task in cell.tasks.values()):
        yield "the facts for ergonomic methods are not written: this form knows only time."
    if any(task.scatters for task in cell.tasks.values()):
        yield "the spread of times is not written."
    if cell.cost is not None:
        yield "what an hour costs is not written."
    if unit.per_second > 1:
        yield (
            f"times are written in units of {1 / unit.per_second:g} s, because this form has whole"
            " numbers only."
        )


def refuse(
    cell: Cell,
    form: str,
    *,
    operator: Collection[str] = (),
    task: Collection[str] = (),
    further: Iterable[Fault] = (),
) -> None:
    """Refuses a cell that says more than the form can.

    Args:
      operator, task: keys of an operator and of a task that the form can say.

    Raises:
      CellError: with each of them, all at once.
    """
    faults = [
        Fault(f"{form} has no word for `{path[-1]}`. {REMEDY}", path)
        for path in beyond(cell, operator=operator, task=(*HARMLESS, *task))
        if path not in FREE
    ]
    if faults := [*faults, *further]:
        raise CellError(faults)


REMEDY = "Take it out for this purpose, or write the cell as yaml or json."


def direct_predecessors(cell: Cell) -> dict[str, tuple[str, ...]]:
    """Task -> its predecessors without those that come before another of them anyway, in the
    cell's order.
    """
    graph = {name: task.predecessors for name, task in cell.tasks.items()}
    earlier: dict[str, frozenset[str]] = {}
    for name in TopologicalSorter(graph).static_order():
        earlier[name] = frozenset(graph[name]).union(*(earlier[first] for first in graph[name]))
    return {
        name: tuple(
            first for first in firsts if not any(first in earlier[other] for other in firsts)
        )
        for name, firsts in graph.items()
    }


def jobs(cell: Cell, form: str) -> tuple[list[list[str]], list[Fault]]:
    """The tasks as jobs, each a row in which one follows another; and a fault for each task that
    stands in no such row.
    """
    before = direct_predecessors(cell)
    follows: dict[str, str] = {}
    faults = []
    for name, firsts in before.items():
        if len(firsts) > 1:
            faults.append(
                _no_chain(form, name, f"it comes after {len(firsts)} tasks, {_named(firsts)}")
            )
        elif firsts and firsts[0] in follows:
            other = follows[firsts[0]]
            faults.append(
                _no_chain(form, name, f"it follows task {firsts[0]!r}, as {other!r} does")
            )
        elif firsts:
            follows[firsts[0]] = name
    found = []
    for name, firsts in before.items():
        if not firsts:
            job = [name]
            while job[-1] in follows:
                job.append(follows[job[-1]])
            found.append(job)
    return found, faults


def _named(names: Iterable[str]) -> str:
    return " and ".join(map(repr, names))


def _no_chain(form: str, name: str, why: str) -> Fault:
    return Fault(
        f"{why}, but {form} has jobs: rows of tasks, one after another. `fjs-dag` and `pyjobshop`"
        " hold any precedence.",
        ("tasks", name, "after"),
    )


def first_machine(cell: Cell) -> int:
    """From what machines are counted when the cell is written: from 0 when its operators are called
    machine_0, machine_1, ... as those of a file that was read so, else from 1.
    """
    names = [f"machine_{number}" for number in range(len(cell.operators))]
    used = any("machine_0" in task.time for task in cell.tasks.values())
    return 0 if list(cell.operators) == names and used else 1


def alone(cell: Cell, unit: Whole) -> dict[str, list[tuple[int, int]]]:
    """Task -> the place of each operator that can do it alone, and its time in units."""
    place = {name: number for number, name in enumerate(cell.operators)}
    return {
        name: sorted((place[who], unit(time)) for who, time in task.time.items())
        for name, task in cell.tasks.items()
    }


def names_lost(cell: Cell, first: int) -> Iterator[str]:
    """Which operator is which machine from here on, unless they are called so.

    Args:
      first: the number of the first machine.
    """
    named = dict(enumerate(cell.operators, first))
    if any(name != f"machine_{number}" for number, name in named.items()):
        shown = [f"{number} is {name}" for number, name in list(named.items())[:8]]
        rest = f", and {len(named) - 8} more" if len(named) > 8 else ""
        yield f"names are not written; of the machines {', '.join(shown)}{rest}."


def all_times(cell: Cell) -> Iterator[float]:
    """The time of every way of doing a task, seconds."""
    for task in cell.tasks.values():
        yield from task.time.values()
        yield from (joint.time for joint in task.together)
