"""Precedence as overlap: tasks get columns so that a task shares one with exactly those that it
must have some order with.

On a chessboard two pieces in the same column always lie above each other, and the upper one waits.
So tasks that wait for one another directly must share a column, and tasks with no order between
them must not. Each task covers neighbouring columns, so a board exists exactly when there is a row
of columns, each a chain of tasks, in which every task stands in one unbroken stretch and every
direct pair meets.

Two tasks with no order between them lie beside each other, and that one is to the left decides
much: whatever must meet the left one lies to the left of whatever must meet the right one, unless
these two meet. Such decisions come in classes; a class that holds both "a left of b" and "b left of
a" proves that there is no board (`clash`). Otherwise the columns are found from left to right, task
by task: a task that has begun stays open until all its direct neighbours have begun too, and the
next to begin must have an order with everything that is still open. What can follow depends only on
which tasks have begun, so each such set is tried once.

(A sandwich problem for interval graphs: Golumbic, Kaplan and Shamir 1995, Journal of Algorithms
19(3). In general no way is known that is always quick; here the classes leave next to nothing to
try.)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise, permutations, product
from typing import NamedTuple

MOST_SETS = 20_000
"""Sets of begun tasks that are tried before the search gives up."""

Spans = dict[str, tuple[int, int]]
"""Task -> first and last column, from 1, both included."""


class TooManyError(Exception):
    """The search was given up: whether there is a board is open."""


def spans(after: Mapping[str, Sequence[str]]) -> Spans | None:
    """Columns for the tasks of a precedence relation (task -> what must come before; no cycles), or
    None when there are none.

    Raises TooManyError when more than `MOST_SETS` sets were tried.
    """
    order = Order.of(after)
    beginnings = _beginnings(order)
    if beginnings is None:
        return None
    place = {task: number for number, task in enumerate(beginnings)}
    last = {
        task: max([place[task], *(place[other] for other in order.direct[task])])
        for task in beginnings
    }
    wanted = _joined_columns(
        order,
        [
            [task for task in beginnings if place[task] <= column <= last[task]]
            for column in range(len(beginnings))
        ],
    )
    found = {}
    for task in beginnings:
        covered = [number for number, column in enumerate(wanted, 1) if task in column]
        found[task] = (covered[0], covered[-1])
    return found


def rows(after: Mapping[str, Sequence[str]], columns: Spans) -> dict[str, int]:
    """Task -> row from 1: one above the highest task below it in its columns, so that nothing can
    fall.
    """
    order, found = Order.of(after), dict[str, int]()
    for task in sorted(order.before, key=lambda task: len(order.before[task])):
        first, last = columns[task]
        below = [
            found[low]
            for low in order.before[task]
            if columns[low][0] <= last and first <= columns[low][1]
        ]
        found[task] = 1 + max(below, default=0)
    return found


def clash(after: Mapping[str, Sequence[str]]) -> tuple[str, str] | None:
    """Two tasks of which each would have to lie to the left of the other; None when no two are
    found, which does not prove a board.
    """
    order = Order.of(after)
    for part in _parts(order):
        sides = _Sides(order, part)
        if sides.clash is not None:
            return sides.clash
    return None


class Order:
    """A partial order of tasks.

    before: task -> all that must come before it. direct: task -> those right before and right after
    it, without what follows from the rest.
    """

    def __init__(self, before: dict[str, set[str]]):
        self.before = before
        self.direct: dict[str, set[str]] = {task: set() for task in before}
        for task, firsts in before.items():
            implied = set().union(*(before[first] for first in firsts))
            for first in firsts - implied:
                self.direct[task].add(first)
                self.direct[first].add(task)

    @classmethod
    def of(cls, after: Mapping[str, Sequence[str]]) -> Order:
        """All that follows from what is given."""
        before: dict[str, set[str]] = {}
        waiting = dict(after)
        while waiting:
            for task in [
                task for task, firsts in waiting.items() if all(first in before for first in firsts)
            ]:
                before[task] = set(waiting[task]).union(
                    *(before[first] for first in waiting.pop(task))
                )
        return cls({task: before[task] for task in after})

    def ordered(self, one: str, other: str) -> bool:
        """Whether one of the two must come before the other."""
        return one in self.before[other] or other in self.before[one]


def _beginnings(order: Order) -> list[str] | None:
    """The tasks in an order of their first columns, or None when there is none."""
    found: list[str] = []
    for part in _parts(order):
        beginnings = _of_part(order, part)
        if beginnings is None:
            return None
        found += beginnings
    return found


def _parts(order: Order) -> Iterator[list[str]]:
    """Tasks that hang together, directly or through others; different parts lie side by side."""
    left = dict.fromkeys(order.before)
    while left:
        part, reached = [], [next(iter(left))]
        while reached:
            task = reached.pop()
            if task in left:
                del left[task]
                part.append(task)
                reached += order.direct[task]
        yield part


class _Sides:
    """The decisions "u left of v" of one part, as classes of which all hold or none does.

    class_of: ordered pair without order -> number of its class. members: class -> its pairs. clash:
    a pair whose two decisions are one class.
    """

    def __init__(self, order: Order, part: list[str]):
        number = {task: index for index, task in enumerate(part)}
        meets = [
            [number[other] for other in (task, *sorted(order.direct[task], key=number.__getitem__))]
            for task in part
        ]
        pairs = [
            (u, v)
            for u, v in permutations(range(len(part)), 2)
            if not order.ordered(part[u], part[v])
        ]
        root = {pair: pair for pair in pairs}

        def find(pair: tuple[int, int]) -> tuple[int, int]:
            while root[pair] != pair:
                root[pair] = pair = root[root[pair]]
            return pair

        for u, v in pairs:
            for pair in product(meets[u], meets[v]):
                if pair in root:
                    root[find(pair)] = find((u, v))
        classes = {pair: index for index, pair in enumerate(sorted({find(pair) for pair in pairs}))}
        self.class_of = {pair: classes[find(pair)] for pair in pairs}
        self.members: list[list[tuple[int, int]]] = [[] for _ in classes]
        for pair, index in self.class_of.items():
            self.members[index].append(pair)
        both = [(u, v) for u, v in pairs if self.class_of[u, v] == self.class_of[v, u]]
        self.clash = (part[both[0][0]], part[both[0][1]]) if both else None


class _Node(NamedTuple):
    """Tasks that have begun, as bits; the decided classes; per task those that are to its left; who
    may begin next, the best last.
    """

    begun: int
    decided: frozenset[int]
    left_of: tuple[int, ...]
    choices: list[int]


class _Sequences:
    """The search for an order of a part's tasks, left to right, in which whatever must meet stands
    side by side while it is open. Depth first; a set of begun tasks is tried once.
    """

    def __init__(self, order: Order, part: list[str], sides: _Sides):
        number = {task: index for index, task in enumerate(part)}
        self.size, self.sides = len(part), sides
        self.direct = [sum(1 << number[other] for other in order.direct[task]) for task in part]
        self.related = [
            sum(
                1 << number[other] for other in part if other != task and order.ordered(task, other)
            )
            for task in part
        ]

    def found(self) -> list[int] | None:
        """The tasks in the order in which they begin; None when there is none.

        Raises TooManyError when too many sets would have to be tried.
        """
        nothing = (0,) * self.size
        tried, path = {0}, [_Node(0, frozenset(), nothing, self._choices(0, nothing))]
        while path[-1].begun != (1 << self.size) - 1:
            if not path[-1].choices:
                path.pop()
                if not path:
                    return None
                continue
            task = path[-1].choices.pop()
            if (then := path[-1].begun | 1 << task) not in tried:
                tried.add(then)
                if (node := self._begin(path[-1], task)) is not None:
                    path.append(node)
            if len(tried) > MOST_SETS:
                raise TooManyError
        return [
            (later.begun & ~earlier.begun).bit_length() - 1 for earlier, later in pairwise(path)
        ]

    def _open(self, begun: int) -> int:
        """The tasks that have begun and still wait for one that they must meet, as bits."""
        return sum(
            1 << task
            for task in range(self.size)
            if begun >> task & 1 and self.direct[task] & ~begun
        )

    def _choices(self, begun: int, left_of: Sequence[int]) -> list[int]:
        """Who may begin now, last those that leave fewest tasks open. When one leaves none open
        that was not, no other need be tried.
        """
        still = self._open(begun)
        can = [
            task
            for task in range(self.size)
            if not begun >> task & 1
            and not still & ~self.related[task]
            and not left_of[task] & ~begun
        ]
        after = {task: self._open(begun | 1 << task) for task in can}
        harmless = [task for task in can if not after[task] & ~still]
        return harmless[:1] or sorted(
            can,
            key=lambda task: (
                after[task].bit_count(),
                -(self.direct[task] & begun).bit_count(),
                task,
            ),
            reverse=True,
        )

    def _begin(self, node: _Node, task: int) -> _Node | None:
        """The node in which the task has begun too, to the left of all that have not; None when
        that contradicts what is decided.
        """
        begun, decided, left_of = node.begun | 1 << task, set(node.decided), list(node.left_of)
        for other in range(self.size):
            if begun >> other & 1 or (task, other) not in self.sides.class_of:
                continue
            if self.sides.class_of[other, task] in decided:
                return None
            if (side := self.sides.class_of[task, other]) not in decided:
                decided.add(side)
                for left, right in self.sides.members[side]:
                    left_of[right] |= 1 << left
        return _Node(begun, frozenset(decided), tuple(left_of), self._choices(begun, left_of))


def _of_part(order: Order, part: list[str]) -> list[str] | None:
    sides = _Sides(order, part)
    if sides.clash is not None:
        return None
    found = _Sequences(order, part, sides).found()
    return None if found is None else [part[task] for task in found]


def _joined_columns(order: Order, columns: list[list[str]]) -> list[set[str]]:
    """Neighbouring columns made one wherever all of their tasks have an order; no meeting is lost,
    and none comes that precedence forbids.
    """
    kept: list[set[str]] = []
    for column in map(set, columns):
        if kept and all(
            order.ordered(one, other) for one in kept[-1] - column for other in column - kept[-1]
        ):
            kept[-1] |= column
        else:
            kept.append(column)
    return kept
