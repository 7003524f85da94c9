"""The checker of periodic schedules: judges one by its cell alone. It knows no solver.

What holds within a product is judged by the rules of `checker.py`. What products share, each other
in the way, is judged here, modulo the cycle time: operators, changeovers around the cycle, tools
and zones. Times are compared as the exact decimals that they print as. Breaks, `setup` and the tool
in hand at the start of a day play no part: a cycle time holds between breaks.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from decimal import ROUND_FLOOR, Decimal
from math import isfinite
from typing import Literal, NamedTuple

from tandem.cell.model import Cell
from tandem.cell.written import number
from tandem.schedule import checker
from tandem.schedule.checker import Hold, Judged, Row, sec
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.measures import exact, made_ready
from tandem.schedule.said import listed, num

WITHIN_A_PRODUCT: tuple[Callable[[Judged], Iterator[str]], ...] = (
    checker.times_are_numbers,
    checker.tasks_are_known,
    checker.each_task_is_done_once,
    checker.operators_are_known,
    checker.the_group_can_do_the_task,
    checker.durations_are_right,
    checker.nothing_starts_before_zero,
    checker.predecessors_end_first,
    checker.waits_are_kept,
    checker.stress_limits_are_kept,
    checker.limits_of_a_person_are_kept,
    checker.pairs_have_the_same_operators,
    checker.the_set_of_human_tasks_is_listed,
    checker.the_stress_is_within_its_limit,
)
"""The rules that ask about one product only; limits of people are limits for each product."""


def faults(
    cell: Cell,
    periodic: PeriodicSchedule,
    *,
    max_in_process: int | None = None,
    max_cycle_time: float | None = None,
    max_stress: float | None = None,
) -> list[str]:
    """Everything that is wrong with the periodic schedule, in sentences; an empty list when it is
    sound.

    Args:
      max_in_process: at most so many products in the station at once.
      max_cycle_time: seconds that the cycle time has to keep, as a takt.
      max_stress: a limit for each product besides its cell's, in the cell's measure of stress.
    """
    if not (isfinite(periodic.cycle_time) and periodic.cycle_time > 0):
        return [f"a cycle time of {periodic.cycle_time} s: must be a number of more than 0."]
    lap = Lap.of(cell, periodic, max_stress)
    found = [sentence for _, sentence in not_periodic(cell)]
    found += [sentence for rule in WITHIN_A_PRODUCT for sentence in rule(lap.product)]
    found += [sentence for rule in BETWEEN_PRODUCTS for sentence in rule(lap)]
    if max_in_process is not None and lap.span > max_in_process * lap.length:
        found.append(
            f"a product is in the station for {sec(lap.span)}, which is more than {max_in_process}"
            f" cycle{'s' * (max_in_process != 1)} of {sec(lap.length)}: {periodic.in_process} are"
            " in process at once."
        )
    if max_cycle_time is not None and lap.length > exact(max_cycle_time):
        found.append(
            f"the cycle time is {sec(lap.length)}, over its limit of {sec(exact(max_cycle_time))}."
        )
    return found


def not_periodic(cell: Cell) -> Iterator[tuple[tuple[str, ...], str]]:
    """What stands in the cell at a time of its own and so cannot repeat with every product: its
    place in the document and a sentence each; nothing for a cell that can.
    """
    for name, task in cell.tasks.items():
        for key, value in (("release", task.release), ("deadline", task.deadline)):
            if value:
                yield (
                    ("tasks", name, key),
                    f"task {name!r}: has a {key} at {number(value)} s, a fixed time, and no cycle"
                    f" repeats it. Leave out `{key}`.",
                )


class Arc(NamedTuple):
    """A row on the cycle: from `begin`, at least 0 s and less than the cycle time, for `length`
    seconds, around the end of the cycle where that is longer.
    """

    begin: Decimal
    length: Decimal
    row: Row

    @property
    def end(self) -> Decimal:
        return self.begin + self.length

    def earlier(self, seconds: Decimal) -> Arc:
        """The same, begun so much earlier."""
        return Arc(self.begin - seconds, self.length + seconds, self.row)


@dataclass(frozen=True)
class Lap:
    """A periodic schedule laid out for the rules.

    Attributes:
      product: one product, as the checker of schedules sees it.
      length: of the cycle, seconds.
      arcs: rows of positive length, by where in the cycle they begin.
    """

    product: Judged
    length: Decimal
    arcs: tuple[Arc, ...]

    @classmethod
    def of(cls, cell: Cell, periodic: PeriodicSchedule, max_stress: float | None = None) -> Lap:
        """Reads the pattern."""
        product = Judged.of(cell, periodic.schedule, None, max_stress)
        length = exact(periodic.cycle_time)
        arcs = (
            Arc(row.start % length, row.end - row.start, row)
            for row in product.rows
            if row.start < row.end and row.start >= 0
        )
        return cls(product, length, tuple(sorted(arcs, key=lambda arc: (arc.begin, arc.end))))

    @property
    def span(self) -> Decimal:
        """How long a product is in the station, seconds."""
        return max((row.end for row in self.product.rows), default=Decimal(0))

    def of_operator(self, name: str) -> list[Arc]:
        """What one operator does, by where in the cycle it begins."""
        return [arc for arc in self.arcs if name in arc.row.who]

    def span_of(self, hold: Hold) -> Arc:
        """The hold on the cycle, in place of its first task."""
        (row, *_) = self.product.of_task[hold.first]
        return Arc(hold.start % self.length, hold.end - hold.start, row)

    def prepared(self, name: str) -> Iterator[tuple[Arc, Decimal]]:
        """What one operator does, and the seconds that it needs directly before it to get ready."""
        arcs = self.of_operator(name)
        rows = [arc.row.given for arc in arcs]
        # where it stands at the start of the day, and with which tool, plays no part later on
        ready = made_ready(self.product.cell, name, [*rows, *rows])[len(rows) :]
        for arc, before in zip(arcs, ready, strict=True):
            yield arc, exact(before.seconds)

    def overlap(self, one: Arc, other: Arc) -> bool:
        """Whether the two share more than a moment of some cycle."""
        return bool(self.present(one, other.begin) or self.present(other, one.begin))

    def present(self, arc: Arc, moment: Decimal) -> int:
        """How many products have the arc's task under way at a moment of the cycle."""
        began = _floor((moment - arc.begin) / self.length)
        ended = _floor((moment - arc.end) / self.length)
        return began - ended

    def told(self, arc: Arc) -> str:
        """The arc in words."""
        end = arc.end % self.length or self.length
        around = " of the next" if arc.end > self.length else ""
        return f"{num(arc.begin)} to {sec(end)}{around}"


def an_operator_does_one_task_at_a_time(lap: Lap) -> Iterator[str]:
    for name in lap.product.cell.operators:
        arcs = lap.of_operator(name)
        for arc in arcs:
            if arc.length > lap.length:
                yield (
                    f"operator {name!r}: does task {arc.row.task!r} for {sec(arc.length)}, longer"
                    f" than the cycle of {sec(lap.length)}: the next product needs it meanwhile."
                )
        for place, arc in enumerate(arcs):
            for other in arcs[place + 1 :]:
                if lap.overlap(arc, other):
                    yield (
                        f"operator {name!r}: does task {arc.row.task!r} ({lap.told(arc)} of the"
                        f" cycle) and task {other.row.task!r} ({lap.told(other)}) at the same time."
                    )


def operators_are_at_hand_in_time(lap: Lap) -> Iterator[str]:
    """Before a task there is time to walk to it and to take up its tool, around the cycle."""
    cell = lap.product.cell
    for name in cell.operators:
        arcs = lap.of_operator(name)
        rows = [arc.row.given for arc in arcs]
        # where it stands at the start of the day, and with which tool, plays no part later on
        for place, ready in enumerate(made_ready(cell, name, [*rows, *rows])[len(rows) :]):
            arc, before = arcs[place], arcs[place - 1]
            free = arc.begin + (0 if place else lap.length) - before.end
            if ready.seconds and 0 <= free < exact(ready.seconds):
                yield (
                    f"operator {name!r}: needs {checker.told(ready)} before task"
                    f" {arc.row.task!r} ({lap.told(arc)} of the cycle), which starts only"
                    f" {sec(free)} after task {before.row.task!r}."
                )


def tools_are_enough(lap: Lap) -> Iterator[str]:
    cell = lap.product.cell
    yield from _crowds(lap, "tool", {name: tool.capacity for name, tool in cell.tools.items()})


def zones_are_wide_enough(lap: Lap) -> Iterator[str]:
    cell = lap.product.cell
    yield from _crowds(lap, "zone", {name: zone.capacity for name, zone in cell.zones.items()})


def kinds_are_kept_apart(lap: Lap) -> Iterator[str]:
    cell = lap.product.cell
    for name, zone in cell.zones.items():
        there = [
            (arc, who, operator.kind)
            for arc in lap.arcs
            if cell.tasks[arc.row.task].zone == name
            for who, operator in cell.operators.items()
            if who in arc.row.who and operator.kind in zone.apart
        ]
        for place, (arc, who, kind) in enumerate(there):
            for other, its, of_kind in there[:place]:
                if of_kind != kind and lap.overlap(arc, other):
                    yield (
                        f"zone {name!r}: keeps {listed(zone.apart)} apart, but {its!r}"
                        f" (task {other.row.task!r}, {lap.told(other)} of the cycle) and {who!r}"
                        f" (task {arc.row.task!r}, {lap.told(arc)}) are in it at once."
                    )


def machines_hold_their_part(lap: Lap) -> Iterator[str]:
    for name, operator in lap.product.cell.operators.items():
        found = [hold for pair in operator.holds for hold in checker.held(lap.product, *pair)]
        spans = [lap.span_of(hold) for hold in found]
        for hold, span in zip(found, spans, strict=True):
            if span.length > lap.length:
                yield (
                    f"operator {name!r}: {hold}, longer than the cycle of {sec(lap.length)}: the"
                    " next product needs it meanwhile."
                )
                continue
            for arc, ready in lap.prepared(name):
                said = f"task {arc.row.task!r} ({lap.told(arc)} of the cycle)"
                if arc.row.task not in hold.within:
                    if lap.overlap(span, arc.earlier(ready)):
                        yield f"operator {name!r}: {hold}, but does {said} meanwhile."
                elif arc.row.start - ready < hold.end - lap.length:
                    yield (
                        f"operator {name!r}: {hold}, and gets ready for {said} while it holds that"
                        " of the product before."
                    )
        for place, hold in enumerate(found):
            for earlier, other in enumerate(found[:place]):
                if not checker.lies_within(hold, other) and lap.overlap(
                    spans[place], spans[earlier]
                ):
                    yield f"operator {name!r}: {hold}, and another product's: {other}."


BETWEEN_PRODUCTS: tuple[Callable[[Lap], Iterator[str]], ...] = (
    an_operator_does_one_task_at_a_time,
    operators_are_at_hand_in_time,
    tools_are_enough,
    zones_are_wide_enough,
    kinds_are_kept_apart,
    machines_hold_their_part,
)


def _crowds(lap: Lap, kind: Literal["tool", "zone"], places: dict[str, int]) -> Iterator[str]:
    """A sentence for each moment at which an operator comes to a tool or zone that is full."""
    users: dict[str, list[tuple[Arc, int]]] = {}
    for arc in lap.arcs:
        taken = lap.product.cell.takes(kind, arc.row.task, arc.row.given.operators)
        for name, count in Counter(taken.values()).items():
            users.setdefault(name, []).append((arc, count))
    for name, uses in users.items():
        most = places.get(name, 1)
        for arc, _ in uses:
            there = [(lap.present(other, arc.begin), count, other) for other, count in uses]
            used = sum(products * count for products, count, _ in there)
            if used > most:
                tasks = listed(repr(other.row.task) for products, _, other in there if products)
                room = checker.only(most, "place") if kind == "zone" else checker.only(most)
                yield (
                    f"{kind} {name!r}: there {room}{'' if kind == 'zone' else ' of it'}, but {used}"
                    f" operators need it at once at {sec(arc.begin)} of the cycle (tasks {tasks})."
                )


def _floor(number: Decimal) -> int:
    return int(number.to_integral_value(ROUND_FLOOR))
