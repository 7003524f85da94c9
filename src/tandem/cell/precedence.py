"""Precedence must not run in circles."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from tandem.errors import Fault

if TYPE_CHECKING:
    from tandem.cell.parts import Fields

MOST = 20
"""Cycles told of at once; whoever mends these will see the next."""
SHOWN = 12
"""Tasks of one cycle that a message spells out."""


def no_task_waits_for_itself(cell: Fields) -> Iterator[Fault]:
    """No chain of predecessors, and of tasks whose start is waited from, leads back to where it
    began. A task that names itself has a rule of its own.
    """
    after = {
        name: tuple(first for first in task.begun_first if first != name and first in cell.tasks)
        for name, task in cell.tasks.items()
    }
    for cycle, _ in zip(cycles(after), range(MOST), strict=False):
        last, first = cycle[-1], cycle[0]
        path = _place(cell, first, last)
        keys = _keys(cell, cycle)
        if len(cycle) == 2:
            yield Fault(
                f"tasks {first!r} and {last!r} wait for each other. Take one of them out of the"
                f" other's {keys}.",
                path,
            )
            continue
        names = (
            [*cycle, first]
            if len(cycle) <= SHOWN
            else [*cycle[: SHOWN // 2], "...", *cycle[-SHOWN // 2 :], first]
        )
        circle = " before ".join(name if name == "..." else repr(name) for name in names)
        yield Fault(
            f"{len(cycle)} tasks wait for each other in a circle: {circle}. Take one of these out"
            f" of the next one's {keys}.",
            path,
        )


def _place(cell: Fields, task: str, first: str) -> tuple[str | int, ...]:
    """Where it stands that `first` comes before the task."""
    stated = cell.tasks[task]
    if first in stated.after:
        return ("tasks", task, "after", stated.after.index(first))
    waits = [wait.after for wait in stated.wait]
    return ("tasks", task, "wait", waits.index(first), "after")


def _keys(cell: Fields, cycle: Sequence[str]) -> str:
    """The keys in which the tasks of a circle name each other."""
    arcs = zip(cycle, [*cycle[1:], cycle[0]], strict=True)
    places = {str(_place(cell, task, first)[2]) for first, task in arcs}
    return " or ".join(f"`{key}`" for key in sorted(places))


def between(cell: Fields, first: str, last: str) -> frozenset[str]:
    """The tasks that come after the first and before the last, directly or not, and these two;
    empty when the last does not come after the first.
    """
    before: set[str] = set()
    pending = [last]
    while pending:
        new = set(_before(cell, pending.pop())) - before
        before |= new
        pending += new
    if first not in before:
        return frozenset()
    found, grown = {first}, True
    while grown:
        more = {name for name in before - found if found & set(_before(cell, name))}
        found |= more
        grown = bool(more)
    return frozenset(found | {last})


def _before(cell: Fields, name: str) -> tuple[str, ...]:
    return cell.tasks[name].predecessors if name in cell.tasks else ()


def cycles(after: Mapping[str, Sequence[str]]) -> Iterator[list[str]]:
    """Circles in a graph given by the predecessors of each node; when each loses one arc, none is
    left.

    Each circle comes once, its nodes so that one goes before the next and the one named first in
    `after` stands first. Depth-first without recursion: a chain may be thousands of tasks long.
    """
    order = {name: place for place, name in enumerate(after)}
    done: set[str] = set()
    for root in after:
        if root in done:
            continue
        trail = [root]
        place_on_trail = {root: 0}
        rest = [iter(after[root])]
        while trail:
            for first in rest[-1]:
                if first in place_on_trail:
                    backwards = trail[place_on_trail[first] :]
                    start = min(range(len(backwards)), key=lambda place: order[backwards[place]])
                    yield (
                        (backwards[start::-1] + backwards[:start:-1])
                        if start
                        else [backwards[0], *backwards[:0:-1]]
                    )
                elif first not in done:
                    place_on_trail[first] = len(trail)
                    trail.append(first)
                    rest.append(iter(after[first]))
                    break
            else:
                done.add(trail[-1])
                del place_on_trail[trail.pop()]
                rest.pop()
