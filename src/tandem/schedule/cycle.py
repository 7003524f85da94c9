"""A periodic schedule: one product's tasks from its own launch, and how often a product is
launched. What follows from it is computed, never stored.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, Decimal
from functools import cached_property

from tandem.cell.measures import adds_up
from tandem.cell.model import Cell
from tandem.schedule import measures
from tandem.schedule.measures import exact
from tandem.schedule.model import Assignment, Schedule


@dataclass(frozen=True)
class PeriodicSchedule:
    """The pattern that a station repeats: a product is launched every `cycle_time` seconds, and
    each is assembled by the same schedule from its own launch on.

    It may break its cell; `cycle_checker.faults` judges it.

    Attributes:
      schedule: one product, seconds since its launch; starts may exceed the cycle time.
      cycle_time: seconds between two launches.
    """

    schedule: Schedule
    cycle_time: float

    def __iter__(self) -> Iterator[Assignment]:
        return iter(self.schedule)

    @cached_property
    def makespan(self) -> float:
        """How long one product is in the station, seconds."""
        return measures.makespan(self.schedule)

    @cached_property
    def in_process(self) -> int:
        """The most products that are in the station at once: those launched and not yet done."""
        products = exact(self.makespan) / exact(self.cycle_time)
        return int(products.to_integral_value(ROUND_CEILING))

    @cached_property
    def digest(self) -> str:
        """Twelve hexadecimal digits that change when the pattern does."""
        pattern = json.dumps([self.schedule.digest, str(exact(self.cycle_time).normalize())])
        return hashlib.sha256(pattern.encode()).hexdigest()[:12]

    def position(self, moment: float) -> float:
        """Where in the cycle a moment of a product's own clock lies: seconds, from 0 on and less
        than the cycle time.
        """
        cycle = exact(self.cycle_time)
        return float((exact(moment) % cycle + cycle) % cycle)

    def lap(self, moment: float) -> int:
        """How many cycles after its own launch: 0 in the first. In a cycle of the steady state, the
        product that is in its lap 2 was launched two cycles before the one in its lap 0.
        """
        return int(exact(moment) // exact(self.cycle_time))

    def products(self, count: int, begin: float = 0.0) -> Schedule:
        """So many products on one clock, the first launched at `begin`, then one each cycle; task
        names as `copied` gives them. The product of number k leaves at `begin + makespan + (k - 1)
        * cycle_time`.
        """
        step, first = exact(self.cycle_time), exact(begin)
        return Schedule(
            tuple(
                Assignment(
                    float(exact(a.start) + first + number * step),
                    float(exact(a.end) + first + number * step),
                    copy_of(a.task, number + 1),
                    a.operators,
                )
                for number in range(count)
                for a in self.schedule
            )
        )


def start_up(cell: Cell) -> float:
    """Seconds after which every operator is ready for any task, at the start of a day: set up, and
    with the time to walk there and to take up a tool.
    """
    longest = Decimal(0)
    for name, operator in cell.operators.items():
        swaps = [exact(tool.changeover.get(name, 0.0)) for tool in cell.tools.values()]
        ways = map(exact, cell.walking.get(name, {}).values())
        ready = max(swaps, default=Decimal(0)) + max(ways, default=Decimal(0))
        longest = max(longest, exact(operator.setup) + ready)
    return float(longest)


def copy_of(task: str, product: int) -> str:
    """The name of a task of the product of this number, counted from 1."""
    return f"{task} #{product}"


def copied(cell: Cell, count: int) -> Cell:
    """The cell that makes so many products: each task once for each of them."""
    return combined([cell] * count)


def combined(products: Sequence[Cell], *, one_allocation: bool = False) -> Cell:
    """The cell that makes these products, of one station: the tasks of each, with the rules that
    hold within it. Limits of people hold for all of them together, but for those of one task.

    A table of stress by sets says nothing about several products, and is left out.

    Args:
      products: cells with the same operators, tools and zones.
      one_allocation: tasks of the same name are done by the same operators in every product.

    Raises CellError when one allocation cannot be, since nobody can do a task in every product.
    """
    document = products[0].to_dict()
    document["tasks"], document["same_operator"] = {}, []
    for number, product in enumerate(products, 1):
        own = product.to_dict()
        for name, task in own["tasks"].items():
            if "after" in task:
                task["after"] = [copy_of(first, number) for first in task["after"]]
            for wait in task.get("wait", ()):
                wait["after"] = copy_of(wait["after"], number)
            document["tasks"][copy_of(name, number)] = task
        document["same_operator"] += [
            [copy_of(first, number), copy_of(second, number)]
            for first, second in product.same_operator
        ]
    for operator in document["operators"].values():
        if "holds" in operator:
            operator["holds"] = [
                [copy_of(first, number), copy_of(last, number)]
                for number in range(1, len(products) + 1)
                for first, last in operator["holds"]
            ]
    if one_allocation:
        document["same_operator"] += _same_everywhere(products)
    for operator in document["operators"].values():
        if "stress_limit" in operator:
            operator["stress_limit"] *= len(products)
        for name in operator.get("limits", ()):
            if adds_up(name):
                # without the dust that multiplying floats leaves
                operator["limits"][name] = round(operator["limits"][name] * len(products), 6)
    document.pop("stress_of_set", None)
    document.pop("variants", None)
    return Cell.model_validate(document)


def _same_everywhere(products: Sequence[Cell]) -> list[list[str]]:
    """Pairs that tie each task to the one of the same name in the product before that has it."""
    pairs, last = [], dict[str, int]()
    for number, product in enumerate(products, 1):
        for name in product.tasks:
            if name in last:
                pairs.append([copy_of(name, last[name]), copy_of(name, number)])
            last[name] = number
    return pairs
