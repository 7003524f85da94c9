"""A precedence graph laid out in layers, as plain data: where each task stands and how its arrows
run.

The four steps of Sugiyama, Tagawa and Toda (1981): layers by the longest chain of predecessors,
placeholders where an arrow passes a layer, few crossings by repeated medians, then straight lanes.
Only arrows that say something are drawn: one that follows from others is left out (transitive
reduction).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal

from tandem.cell.model import Cell

SWEEPS = 12
Point = tuple[float, float]
"""Column and row."""


@dataclass(frozen=True)
class Layers:
    """The drawn graph.

    Attributes:
      at: task -> (column, row); columns go with precedence, rows may be fractions.
      arrows: (first, second) -> the points of its polyline in columns and rows, ends included.
      critical: the tasks of one longest chain, every task in its quickest mode, in order.
      critical_s: its length in seconds.
    """

    at: Mapping[str, tuple[float, float]]
    arrows: Mapping[tuple[str, str], tuple[tuple[float, float], ...]]
    critical: tuple[str, ...]
    critical_s: float

    @property
    def extent(self) -> tuple[float, float]:
        """Columns and rows that the graph takes."""
        return max(x for x, _ in self.at.values()) + 1, max(y for _, y in self.at.values()) + 1


def layers(cell: Cell) -> Layers:
    """The cell's precedence graph in layers. The same cell gives the same picture."""
    critical, length = critical_chain(cell)
    return Layers(*arranged(reduced(cell)), critical, length)


def arranged(
    after: Mapping[str, Sequence[str]],
) -> tuple[dict[str, Point], dict[tuple[str, str], tuple[Point, ...]]]:
    """Where tasks stand and how their arrows run, as in `Layers`, from each one's direct
    predecessors: without circles, and without arrows that follow from others.
    """
    linked = {name for name, firsts in after.items() if firsts} | {
        first for firsts in after.values() for first in firsts
    }
    free = [name for name in after if name not in linked]
    at, arrows = _linked_part({name: tuple(after[name]) for name in after if name in linked})
    return {**at, **_free_part(free, at)}, arrows


def reduced(cell: Cell) -> dict[str, tuple[str, ...]]:
    """Task -> the predecessors that do not already follow from another predecessor."""
    return without_implied({name: task.predecessors for name, task in cell.tasks.items()})


def without_implied(after: Mapping[str, Sequence[str]]) -> dict[str, tuple[str, ...]]:
    """The same without predecessors that follow from others. Whatever stands on a circle is left
    out; `without_circles` opens them.
    """
    above: dict[str, frozenset[str]] = {}
    direct: dict[str, tuple[str, ...]] = {}
    for name in topological(after):
        firsts = after[name]
        implied: frozenset[str] = frozenset().union(*(above[first] for first in firsts))
        direct[name] = tuple(first for first in firsts if first not in implied)
        above[name] = implied | set(firsts)
    return {name: direct[name] for name in after if name in direct}


def without_circles(after: Mapping[str, Sequence[str]]) -> dict[str, tuple[str, ...]]:
    """The same without what no graph in layers can show: each arrow in its order stays unless it
    comes from no task of these, is there already, or closes a circle with those that stay.
    """
    kept: dict[str, list[str]] = {name: [] for name in after}
    for name, firsts in after.items():
        for first in firsts:
            if first in kept and first not in kept[name] and not _is_above(name, first, kept):
                kept[name].append(first)
    return {name: tuple(firsts) for name, firsts in kept.items()}


def _is_above(first: str, name: str, after: Mapping[str, Sequence[str]]) -> bool:
    """Whether the task is the other one, or comes before it."""
    seen, waiting = {name}, [name]
    for then in waiting:
        more = [other for other in after[then] if other not in seen]
        seen.update(more)
        waiting += more
    return first in seen


def topological(after: Mapping[str, Sequence[str]]) -> list[str]:
    """Task names so that predecessors come first; otherwise in their own order."""
    places = {name: place for place, name in enumerate(after)}
    waiting = {name: len(firsts) for name, firsts in after.items()}
    behind: dict[str, list[str]] = {name: [] for name in after}
    for name, firsts in after.items():
        for first in firsts:
            behind[first].append(name)
    ready = [name for name, count in waiting.items() if count == 0]
    for name in ready:
        for later in sorted(behind[name], key=places.__getitem__):
            waiting[later] -= 1
            if waiting[later] == 0:
                ready.append(later)
    return ready


def critical_chain(cell: Cell) -> tuple[tuple[str, ...], float]:
    """One longest chain of tasks, each in its quickest mode, and its seconds, with the least waits
    from an end to a start: no schedule can be shorter.
    """
    ends: dict[str, Decimal] = {}
    back: dict[str, str | None] = {}
    for name in topological({name: task.predecessors for name, task in cell.tasks.items()}):
        task = cell.tasks[name]
        gap = {w.after: w.at_least for w in task.wait if w.between == "end-start"}
        ready = {
            first: ends[first] + Decimal(repr(float(gap.get(first, 0.0))))
            for first in task.predecessors
        }
        first = max(ready, key=ready.__getitem__, default=None)
        quickest = min(Decimal(repr(float(mode.time))) for mode in cell.modes(name))
        ends[name], back[name] = quickest + (ready[first] if first is not None else 0), first
    chain: list[str] = []
    name_or_none: str | None = max(ends, key=ends.__getitem__)
    length = ends[name_or_none] if name_or_none is not None else Decimal(0)
    while name_or_none is not None:
        chain.append(name_or_none)
        name_or_none = back[name_or_none]
    return tuple(reversed(chain)), float(length)


Node = tuple[str, str, int]
"""A task `(name, "", 0)`, or the placeholder of an arrow in a column `(first, second, column)`."""


def _linked_part(
    after: Mapping[str, tuple[str, ...]],
) -> tuple[dict[str, Point], dict[tuple[str, str], tuple[Point, ...]]]:
    column = _columns(after)
    rows: list[list[Node]] = [[] for _ in range(max(column.values(), default=-1) + 1)]
    for name in after:
        rows[column[name]].append((name, "", 0))
    paths: dict[tuple[str, str], list[Node]] = {}
    for name, firsts in after.items():
        for first in firsts:
            between: list[Node] = [(first, name, x) for x in range(column[first] + 1, column[name])]
            paths[first, name] = [(first, "", 0), *between, (name, "", 0)]
            for place in between:
                rows[place[2]].append(place)
    left: dict[Node, list[Node]] = {node: [] for layer in rows for node in layer}
    right: dict[Node, list[Node]] = {node: [] for layer in rows for node in layer}
    for path in paths.values():
        for one, two in itertools.pairwise(path):
            right[one].append(two)
            left[two].append(one)
    height = _straighten(_uncrossed(rows, left, right), left, right)
    where = {node: (float(x), height[node]) for x, layer in enumerate(rows) for node in layer}
    arrows = {pair: tuple(where[node] for node in path) for pair, path in paths.items()}
    return {name: where[name, "", 0] for name in after}, arrows


def _columns(after: Mapping[str, tuple[str, ...]]) -> dict[str, int]:
    """Task -> number of tasks on the longest chain before it; what waits for nothing stands right
    before the first that waits for it.
    """
    column: dict[str, int] = {}
    waiting = list(after)
    while waiting:
        rest = [name for name in waiting if any(first not in column for first in after[name])]
        for name in waiting:
            if all(first in column for first in after[name]):
                column[name] = 1 + max((column[first] for first in after[name]), default=-1)
        waiting = [name for name in rest if name not in column]
    for name, firsts in after.items():
        if not firsts:
            column[name] = (
                min(column[other] for other, others in after.items() if name in others) - 1
            )
    return column


def _uncrossed(
    rows: list[list[Node]],
    left: Mapping[Node, Sequence[Node]],
    right: Mapping[Node, Sequence[Node]],
) -> list[list[Node]]:
    """The layers in an order with few crossings: each node moves to the middle of its neighbours,
    left to right and back.
    """
    best, fewest = [list(layer) for layer in rows], _crossings(rows, right)
    for sweep in range(SWEEPS):
        if fewest == 0:
            break
        forward = sweep % 2 == 0
        near = left if forward else right
        order = range(1, len(rows)) if forward else range(len(rows) - 2, -1, -1)
        for x in order:
            beside = {node: place for place, node in enumerate(rows[x - 1 if forward else x + 1])}
            old = {node: place for place, node in enumerate(rows[x])}
            mean = {
                n: sum(beside[m] for m in near[n]) / len(near[n]) if near[n] else float(old[n])
                for n in rows[x]
            }
            rows[x].sort(key=lambda node, mean=mean, old=old: (mean[node], old[node]))  # type: ignore[misc]
        count = _crossings(rows, right)
        if count < fewest:
            best, fewest = [list(layer) for layer in rows], count
    for layer, found in zip(rows, best, strict=True):
        layer[:] = found
    return rows


def _crossings(rows: Sequence[Sequence[Node]], right: Mapping[Node, Sequence[Node]]) -> int:
    total = 0
    for layer, beside in itertools.pairwise(rows):
        place = {node: i for i, node in enumerate(beside)}
        seen: list[int] = []
        for node in layer:
            ends = sorted(place[other] for other in right[node])
            total += sum(1 for end in ends for other in seen if other > end)
            seen.extend(ends)
    return total


def _straighten(
    rows: Sequence[Sequence[Node]],
    left: Mapping[Node, Sequence[Node]],
    right: Mapping[Node, Sequence[Node]],
) -> dict[Node, float]:
    """Row of each node: as near to its neighbours' as the order and one row of room for each task
    allow.
    """
    most = max((_room(layer) for layer in rows), default=0.0)
    height: dict[Node, float] = {}
    for layer in rows:
        y = (most - _room(layer)) / 2
        for node in layer:
            height[node] = y + _half(node)
            y += 2 * _half(node)
    for sweep in range(SWEEPS):
        forward = sweep % 2 == 0
        for layer in rows if forward else list(reversed(rows)):
            near = left if forward else right
            wish = [
                sum(height[m] for m in near[n]) / len(near[n]) if near[n] else height[n]
                for n in layer
            ]
            for node, y in zip(layer, _apart(layer, wish), strict=True):
                height[node] = y
    low = min((y - _half(node) for node, y in height.items()), default=0.0)
    return {node: y - low - 0.5 for node, y in height.items()}


def _half(node: Node) -> float:
    """Half of the room a node needs: a whole row for a task, a third for an arrow that passes."""
    return 0.5 if node[1] == "" else 0.17


def _room(layer: Sequence[Node]) -> float:
    return sum(2 * _half(node) for node in layer)


def _apart(layer: Sequence[Node], wish: Sequence[float]) -> list[float]:
    """The places nearest to the wishes (least squares) that keep the order and the room between
    neighbours.
    """
    offset, shifts = 0.0, []
    for place, node in enumerate(layer):
        offset += 0.0 if place == 0 else _half(layer[place - 1]) + _half(node)
        shifts.append(offset)
    blocks: list[list[float]] = []
    for y, shift in zip(wish, shifts, strict=True):
        blocks.append([y - shift, 1.0])
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            (mean, weight), (other, more) = blocks[-2], blocks[-1]
            blocks[-2:] = [[(mean * weight + other * more) / (weight + more), weight + more]]
    flat = [mean for mean, weight in blocks for _ in range(int(weight))]
    return [y + shift for y, shift in zip(flat, shifts, strict=True)]


def _free_part(
    free: Sequence[str], linked: Mapping[str, tuple[float, float]]
) -> dict[str, tuple[float, float]]:
    """Tasks without any precedence stand in a block of their own under the others."""
    if not free:
        return {}
    below = max((y for _, y in linked.values()), default=-1.35) + 1.35
    across = max(
        int(max((x for x, _ in linked.values()), default=-1) + 1), math.ceil(math.sqrt(len(free)))
    )
    return {
        name: (float(place % across), below + place // across) for place, name in enumerate(free)
    }
