"""Who has a tool, or is in a zone, before whom: what must be over before a task may begin there,
however late the others are.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Literal, NamedTuple

from tandem.cell.model import Cell
from tandem.schedule.measures import exact
from tandem.schedule.model import Assignment, Schedule

Kind = Literal["tool", "zone"]
KINDS: tuple[Kind, ...] = ("tool", "zone")


class Queue(NamedTuple):
    """What one task waits for at its tool or its zone; at a zone that keeps kinds of operators
    apart, one queue for the places and one for the others to be out.

    Attributes:
      kind, name: of the tool or the zone.
      places: units of the tool, or operators that the zone holds.
      spare: of `before`, so many may still be unfinished, whether begun or not; 0 says that all
        must be over.
      before: (operator, the last task of that operator that comes before this one there), in the
        schedule's order; more of them than `spare`.
      moment: when that is so in the schedule, seconds.
    """

    kind: Kind
    name: str
    places: int
    spare: int
    before: tuple[tuple[str, str], ...]
    moment: float


def queues(cell: Cell, schedule: Schedule) -> dict[str, tuple[Queue, ...]]:
    """Task -> what it waits for at its tool and its zone. Assumes a sound schedule.

    The order in which tasks come to a place is that of the schedule. An operator is at one task at
    a time, so it holds one place at most; when all but `spare` = places - (operators of the task)
    of the others are through with all that comes before, what comes before never needs more than
    `spare` places again. Whoever begins a task only when that is so never crowds the place, and
    since everything waits for what stands earlier in the schedule alone, nobody waits for ever.
    With one place that is the task directly before; with several it does not matter who of the
    others leaves first.

    What follows from the task's predecessors, or from what its operators did before, is left out
    where `spare` lets somebody be unfinished; where all must be over, the last ones are named in
    any case.
    """
    found: dict[str, tuple[Queue, ...]] = {}
    sure: dict[str, frozenset[str]] = {}
    latest: dict[str, str] = {}
    for place, a in enumerate(schedule):
        earlier = schedule.assignments[:place]
        direct = {
            *cell.tasks[a.task].predecessors,
            *(latest[who] for who in a.operators if who in latest),
        }
        found[a.task] = tuple(_queues_of(cell, a, earlier, sure, _closed(direct, sure)))
        direct |= {task for queue in found[a.task] if not queue.spare for _, task in queue.before}
        sure[a.task] = _closed(direct, sure)
        latest |= dict.fromkeys(a.operators, a.task)
    return found


def _closed(direct: set[str], sure: dict[str, frozenset[str]]) -> frozenset[str]:
    return frozenset(direct).union(*(sure[name] for name in direct))


def _queues_of(
    cell: Cell,
    a: Assignment,
    earlier: tuple[Assignment, ...],
    sure: dict[str, frozenset[str]],
    over: frozenset[str],
) -> Iterator[Queue]:
    """The queues of one task; `sure`: task -> what is over whenever it begins, `over`: the same of
    this task without its queues.
    """
    for kind, name, count in taken_by(cell, a):
        places = places_of(cell, kind, name)
        spare = max(places - count, 0)
        last = {
            who: row
            for row in earlier
            for who, used in cell.takes(kind, row.task, row.operators).items()
            if used == name and who not in a.operators
        }
        if spare:
            last = {who: row for who, row in last.items() if row.task not in over}
        else:
            implied = frozenset().union(*(sure[row.task] for row in last.values()))
            last = {who: row for who, row in last.items() if row.task not in implied}
        if kind == "zone" and spare:
            yield from _other_kinds(cell, a, earlier, sure)
        if len(last) > spare:
            ends = sorted(exact(row.end) for row in last.values())
            order = sorted(last.items(), key=lambda entry: entry[1])
            yield Queue(
                kind,
                name,
                places,
                spare,
                tuple((who, row.task) for who, row in order),
                float(ends[len(ends) - spare - 1]),
            )


def _other_kinds(
    cell: Cell,
    a: Assignment,
    earlier: tuple[Assignment, ...],
    sure: dict[str, frozenset[str]],
) -> Iterator[Queue]:
    """Those whom the zone keeps apart from the task's operators must all be out of it."""
    name = cell.tasks[a.task].zone
    apart = cell.zones[name].apart if name is not None and name in cell.zones else ()
    kinds = {cell.operators[who].kind for who in a.operators}
    if name is None or not kinds.intersection(apart):
        return
    last = {
        who: row
        for row in earlier
        if cell.tasks[row.task].zone == name
        for who in row.operators
        if cell.operators[who].kind in set(apart) - kinds
    }
    implied = frozenset().union(*(sure[row.task] for row in last.values()))
    last = {who: row for who, row in last.items() if row.task not in implied}
    if last:
        order = tuple((who, row.task) for who, row in sorted(last.items(), key=lambda one: one[1]))
        end = max(exact(row.end) for row in last.values())
        yield Queue("zone", name, places_of(cell, "zone", name), 0, order, float(end))


def taken_by(cell: Cell, a: Assignment) -> Iterator[tuple[Kind, str, int]]:
    """The tools and the zone that its operators take, and how many places of each."""
    for kind in KINDS:
        count = Counter(cell.takes(kind, a.task, a.operators).values())
        yield from ((kind, name, places) for name, places in count.items())


def places_of(cell: Cell, kind: Kind, name: str) -> int:
    """Units of a tool, or operators that a zone holds; 1 where the cell does not say."""
    table = cell.tools if kind == "tool" else cell.zones
    return table[name].capacity if name in table else 1
