"""A second proof of a station that repeats, without a constraint solver: every allocation, and for
each a search over who passes whom, cycle time by cycle time.

For one allocation and one cycle time T, what two tasks have to keep of each other is a disjunction
of differences: two tasks of one operator keep `ticks + q T <= start' - start <= (q + 1) T - ticks'`
for some whole q, which is how many products lie between them (Hanen and Munier 1995, A study of the
cyclic scheduling problem on parallel processors, section 2). A search chooses the q of each pair;
what is chosen is held in a table of longest paths, and a positive circle refutes it (Dechter, Meiri
and Pearl 1991, Temporal constraint networks, section 4). Where work alone can bind, there is
nothing to search: an operator is busy for the sum of what is theirs.

Slow, and sure: for cells of up to eight tasks or so.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise, product
from time import monotonic
from typing import NamedTuple

import numpy as np

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError, UsageError
from tandem.plan.cycle.door import Admitted, CycleDoor
from tandem.plan.cycle.pattern import Pattern, launched, lifted, most_laps, stacked
from tandem.plan.cycle.question import FRONT, CycleQuestion, whole
from tandem.plan.cycle.result import CycleBound, CycleFront, CycleResult
from tandem.plan.instance import Instance
from tandem.plan.result import Status

SOLVER = "difference constraints"
"""What proves."""
MOST_TASKS = 12
"""With more, the allocations alone are too many."""


class Edge(NamedTuple):
    """`start[later] - start[earlier] >= ticks`."""

    earlier: int
    later: int
    ticks: int


Choice = tuple[Edge, ...]
"""Edges that hold together; a disjunction is a list of choices."""


_Thing = tuple[str, int]
"""A tool or a zone: "tool" or "zone", and its number."""


class _Late(Exception):
    """Time is up."""


@dataclass
class Network:
    """Longest paths between starts: `least[a, b]` ticks lie between the starts of `a` and `b` at
    least. Row and column `-1` are the launch, at 0.
    """

    least: np.ndarray

    @classmethod
    def of(cls, latest: Sequence[int]) -> Network:
        """No constraint but that each start lies from 0 to the latest, ticks."""
        least = np.repeat(-np.array([[*latest, 0]], dtype=np.int64).T, len(latest) + 1, axis=1)
        np.fill_diagonal(least, 0)
        return cls(least)

    def with_edges(self, choice: Choice) -> Network | None:
        """The network with these constraints besides; None when they close a positive circle."""
        least = self.least
        for earlier, later, ticks in choice:
            if least[earlier, later] >= ticks:
                continue
            if ticks + least[later, earlier] > 0:
                return None
            least = np.maximum(least, least[:, earlier, None] + ticks + least[None, later, :])
        return Network(least)

    def starts(self) -> list[int]:
        """The earliest starts, ticks."""
        return [int(ticks) for ticks in self.least[-1, :-1]]


class _Pair(NamedTuple):
    """Two tasks that mind each other.

    Attributes:
      apart: they must not overlap.
      shared: the tools and zones that both need and not all can have at once.
    """

    one: int
    two: int
    apart: bool
    shared: tuple[_Thing, ...]


class _Held(NamedTuple):
    """A hold from `first` to `last`, and what must lie outside it: from the start of `begin` to the
    end of `end`.
    """

    first: int
    last: int
    begin: int
    end: int


class _Piece(NamedTuple):
    """How two tasks lie to each other; who is under way when the other starts."""

    edges: Choice
    one_there: bool
    two_there: bool


@dataclass
class _Allocation:
    """One way for each task.

    Attributes:
      ways: per task.
      stress: units of a product.
    """

    instance: Instance
    ways: tuple[int, ...]
    stress: int
    until: float | None

    def ticks(self, task: int) -> int:
        """How long the task takes."""
        return self.instance.ways[task][self.ways[task]].ticks

    def who(self, task: int) -> tuple[int, ...]:
        """Who does it."""
        return self.instance.ways[task][self.ways[task]].operators

    def least_length(self) -> int:
        """No cycle is shorter: somebody has so much to do, ticks."""
        load = [0] * len(self.instance.operators)
        for task in range(len(self.ways)):
            for operator in self.who(task):
                load[operator] += self.ticks(task)
        return max(load)

    def least_possible(self, longest: int, laps: int | None) -> int | None:
        """The least cycle time of at most `longest` ticks that has a pattern; None when none has.

        What is possible in a cycle is possible in every longer one: the pattern waits a tick more
        at the end of each, so that halving the span finds the least.
        """
        low, high = self.least_length(), longest
        if self.instance.has_most_lags:
            # what must follow in time may just miss its place in a longer cycle
            lengths = range(low, high + 1)
            return next((n for n in lengths if self.pattern(n, laps) is not None), None)
        if low > high or self.pattern(high, laps) is None:
            return None
        while low < high:
            middle = (low + high) // 2
            if self.pattern(middle, laps) is None:
                low = middle + 1
            else:
                high = middle
        return low

    def pattern(self, length: int, laps: int | None) -> Pattern | None:
        """A pattern of this cycle time, a product in at most so many cycles; None when there is
        none.
        """
        tasks = range(len(self.ways))
        if any(self.ticks(task) > length for task in tasks):
            return None
        network = Network.of([end - 1 for end in self._windows(length, laps)]).with_edges(
            tuple(self._within_a_product(length, laps))
        )
        if network is None:
            return None
        pairs = list(self._pairs())
        if laps is None and not self._needs_search(pairs):
            return lifted(self.instance, stacked(self.instance, self.ways), length)
        found = self._searched(network, pairs, {}, list(self._held_against()), length)
        if found is None:
            return None
        chosen = tuple(zip(self.ways, found.starts(), strict=True))
        return launched(chosen) if laps is not None else lifted(self.instance, chosen, length)

    def _needs_search(self, pairs: list[_Pair]) -> bool:
        """Whether more than work can bind: tasks of several operators, tools or zones that are
        shared, changeovers. Where not, an operator does what is theirs in any order.
        """
        return (
            self.instance.has_preparations
            or self.instance.has_apart
            or bool(self.instance.tied)
            or any(len(self.who(task)) > 1 for task in range(len(self.ways)))
            or any(pair.shared for pair in pairs)
        )

    def _windows(self, length: int, laps: int | None) -> list[int]:
        """Per task, ticks before which it starts; without a limit on laps, those of tied tasks
        alone are asked for.
        """
        tied, instance = self.instance.tied, self.instance
        if laps is not None:
            return [laps * length] * len(self.ways)
        counts = [
            most_laps(instance, tied[task]) if task in tied else 1 for task in range(len(self.ways))
        ]
        return [count * length for count in counts]

    def _within_a_product(self, length: int, laps: int | None) -> Iterator[Edge]:
        """Predecessors end first, waits are kept, no part is held for longer than a cycle, and all
        is over within the laps; without a limit on laps, only between tasks that are tied.
        """
        tied = self.instance.tied
        for task, firsts in enumerate(self.instance.before):
            if laps is not None:
                yield Edge(task, -1, self.ticks(task) - laps * length)
            for first in firsts:
                if laps is not None or first in tied.get(task, ()):
                    yield Edge(first, task, self.ticks(first))
        for _, first, last in self.instance.holds:
            yield Edge(last, first, self.ticks(last) - length)
        for lag in self.instance.lags:
            if laps is None and lag.before not in tied.get(lag.task, ()):
                continue
            own = 0 if lag.from_start else self.ticks(lag.before)
            yield Edge(lag.before, lag.task, own + lag.least)
            if lag.most is not None:
                yield Edge(lag.task, lag.before, -own - lag.most)

    def _pairs(self) -> Iterator[_Pair]:
        """Every two tasks that mind each other."""
        for one, two in combinations(range(len(self.ways)), 2):
            apart = bool(set(self.who(one)) & set(self.who(two))) or self._mind(one, two)
            shared = tuple(thing for thing in self.uses[one] if thing in self.uses[two])
            if apart or shared:
                yield _Pair(one, two, apart, shared)

    def _mind(self, one: int, two: int) -> bool:
        """Whether the zone of both keeps their operators apart."""
        instance = self.instance
        if not instance.has_apart or instance.zone[one] != instance.zone[two]:
            return False
        sides = [instance.sides(t, instance.ways[t][self.ways[t]]) for t in (one, two)]
        return bool(sides[0] and sides[1] and sides[0] != sides[1])

    @cached_property
    def uses(self) -> list[dict[_Thing, int]]:
        """Per task, how many of a tool, or places in a zone, it takes; only of those that not all
        can have at once.
        """
        instance = self.instance
        found: list[dict[_Thing, int]] = []
        for task, way in enumerate(self.ways):
            chosen = instance.ways[task][way]
            mine: dict[_Thing, int] = {
                ("tool", tool): count for tool, count in instance.scarce(chosen)
            }
            zone = instance.zone[task]
            if zone is not None and instance.zone_room[zone]:
                mine["zone", zone] = len(chosen.operators)
            found.append(mine)
        return found

    def _room(self, thing: _Thing) -> int:
        kind, number = thing
        return (self.instance.tool_room if kind == "tool" else self.instance.zone_room)[number]

    # ------------------------------------------------------------ the search

    def _held_against(self) -> Iterator[_Held]:
        """What must not lie within a hold: other tasks of the machine, and its other holds."""
        instance = self.instance
        for hold, (machine, first, last) in enumerate(instance.holds):
            for task in range(len(self.ways)):
                if instance.barred[hold] >> task & 1 and machine in self.who(task):
                    yield _Held(first, last, task, task)
            for other in range(hold):
                if instance.rivals[hold] >> other & 1:
                    yield _Held(first, last, *instance.holds[other][1:])

    def _searched(
        self,
        network: Network,
        open_pairs: list[_Pair],
        held: dict[_Pair, _Piece],
        parts: list[_Held],
        length: int,
    ) -> Network | None:
        """The network with a choice for every pair; None when every choice ends in a circle. The
        pair with the fewest choices left comes first.
        """
        if self.until is not None and monotonic() > self.until:
            raise _Late
        if not self._has_room(held):
            return None
        if not open_pairs:
            return self._with_parts(network, parts, length)
        offers = []
        for pair in open_pairs:
            pieces = list(self._pieces(network, pair, length))
            offers.append((len(pieces), pair, pieces))
            if not pieces:
                return None
        _, pair, pieces = min(offers, key=lambda offer: offer[0])
        rest = [other for other in open_pairs if other != pair]
        for piece in pieces:
            tighter = network.with_edges(piece.edges)
            if tighter is not None:
                found = self._searched(tighter, rest, {**held, pair: piece}, parts, length)
                if found is not None:
                    return found
        return None

    def _with_parts(self, network: Network, parts: list[_Held], length: int) -> Network | None:
        """The network with a choice for everything that must not lie within a hold: in which gap
        between two products' holds it lies.
        """
        if not parts:
            return self._ready_in_time(network, length)
        (first, last, begin, end), *rest = parts
        low, high = int(network.least[first, begin]), -int(network.least[begin, first])
        for lap in range(low // length - 1, high // length + 2):
            tighter = network.with_edges(
                (
                    Edge(last, begin, self.ticks(last) + lap * length),
                    Edge(end, first, self.ticks(end) - (lap + 1) * length),
                )
            )
            if tighter is not None:
                found = self._with_parts(tighter, rest, length)
                if found is not None:
                    return found
        return None

    def _pieces(self, network: Network, pair: _Pair, length: int) -> Iterator[_Piece]:
        """How the two may lie to each other: by how many cycles, and who is under way when the
        other starts.
        """
        one, two = pair.one, pair.two
        low, high = int(network.least[one, two]), -int(network.least[two, one])
        for lap in range(low // length, high // length + 1):
            for first, last, one_there, two_there in self._residues(one, two, length):
                if pair.apart and (one_there or two_there):
                    continue
                least, most = first + lap * length, last + lap * length
                if least <= high and most >= low:
                    edges = (Edge(one, two, least), Edge(two, one, -most))
                    yield _Piece(edges, one_there, two_there)

    def _residues(self, one: int, two: int, length: int) -> Iterator[tuple[int, int, bool, bool]]:
        """Spans of `(start[two] - start[one]) mod length`, both ends included, in which it does not
        change whether `one` is under way when `two` starts, and the other way round.
        """
        marks = sorted({0, 1, self.ticks(one), length - self.ticks(two) + 1, length})
        for first, after in pairwise(marks):
            if 0 <= first < after <= length:
                one_there = first < self.ticks(one)
                two_there = (-first) % length < self.ticks(two)
                yield first, after - 1, one_there, two_there

    def _has_room(self, held: dict[_Pair, _Piece]) -> bool:
        """Whether no tool and no zone is asked for by too many when a task starts there."""
        there = [dict(uses) for uses in self.uses]
        for pair, piece in held.items():
            for thing in pair.shared:
                there[pair.two][thing] += self.uses[pair.one][thing] if piece.one_there else 0
                there[pair.one][thing] += self.uses[pair.two][thing] if piece.two_there else 0
        return all(
            count <= self._room(thing) for counts in there for thing, count in counts.items()
        )

    def _ready_in_time(self, network: Network, length: int) -> Network | None:
        """The network in which operators walk and take up tools in time. Who follows whom is
        settled: the laps between tasks of an operator put them in a row around the cycle.
        """
        found: Network | None = network
        for operator in range(len(self.instance.operators)):
            mine = [task for task in range(len(self.ways)) if operator in self.who(task)]
            if found is None:
                return None
            starts = found.starts()
            # any starts of the network give the same order around the cycle
            row = sorted(mine, key=lambda task: (starts[task] - starts[mine[0]]) % length)
            found = found.with_edges(tuple(self._preparations(operator, row, starts, length)))
        return found

    def _preparations(
        self, operator: int, row: list[int], starts: list[int], length: int
    ) -> Iterator[Edge]:
        """What lies between tasks that follow each other: the work, the way and the changeover.

        The laps between the two are the same for all starts of the network.
        """
        stance = self.instance.stance(None, None)
        # in the second round it is known what was in hand, and where it stood, before the first
        for place, task in enumerate([*row, *row]):
            before = row[place % len(row) - 1]
            way = self.instance.ways[task][self.ways[task]]
            needs = self.instance.preparations(task, way)
            if not needs:
                return
            ticks, stance = needs[way.operators.index(operator)][stance]
            if ticks and place >= len(row):
                laps = (starts[task] - starts[before]) // length
                yield Edge(before, task, self.ticks(before) + ticks + laps * length)
                yield from self._not_while_holding(operator, task, ticks, starts, length)

    def _not_while_holding(
        self, operator: int, task: int, ticks: int, starts: list[int], length: int
    ) -> Iterator[Edge]:
        """Getting ready for a task falls into no hold of another part."""
        for hold, (machine, first, last) in enumerate(self.instance.holds):
            if machine == operator:
                is_barred = self.instance.barred[hold] >> task & 1
                # of what belongs to the hold, the part of the product before is another
                laps = (starts[task] - starts[first]) // length if is_barred else -1
                yield Edge(last, task, self.ticks(last) + ticks + laps * length)


def solve(
    cell: Cell,
    question: CycleQuestion = FRONT,
    *,
    time_limit: float | None = None,
    **unused: object,
) -> CycleFront:
    """The complete front of a small cell, or the one pattern asked for, with proof.

    Raises:
      UsageError: the cell is too large.
      InfeasibleError: it is proven that no pattern answers the question.
      NothingFoundError: the time was over before the proof.
    """
    if len(cell.tasks) > MOST_TASKS:
        raise UsageError(
            f"the cell has {len(cell.tasks)} tasks: the exhaustive method tries every allocation"
            f" and is for cells of at most {MOST_TASKS}. Use the method exact."
        )
    began = monotonic()
    try:
        points = _Enumeration(cell, question, time_limit).points()
    except _Late:
        raise NothingFoundError(
            f"{_asked(question)}: nothing was proven in {monotonic() - began:.1f} s."
        ) from None
    if not points:
        raise InfeasibleError(f"{_asked(question)}: no pattern; this is proven.")
    results = tuple(
        CycleResult(
            cell,
            found.periodic,
            Status.OPTIMAL,
            CycleBound(
                found.periodic.cycle_time,
                found.stress / Instance.of(cell).per_stress,
                found.in_process,
            ),
        )
        for found in points
    )
    wall = monotonic() - began
    return CycleFront(cell, results, True, "exhaustive", SOLVER, 0, wall, question=question)


class _Enumeration:
    """Every allocation of a cell, and the patterns that they have."""

    def __init__(self, cell: Cell, question: CycleQuestion, time_limit: float | None) -> None:
        self.instance = instance = Instance.of(cell)
        self.question = question
        self.door = CycleDoor(cell, instance, question)
        until = None if time_limit is None else monotonic() + time_limit
        top = whole(question.max_stress, instance.per_stress)
        takt = whole(question.takt, instance.per_second)
        self.longest = instance.horizon if takt is None else min(takt, instance.horizon)
        self.allocations = sorted(
            (
                _Allocation(instance, ways, stress, until)
                for ways, stress in _allowed(instance)
                if top is None or stress <= top
            ),
            key=lambda allocation: (allocation.least_length(), allocation.stress),
        )

    def points(self) -> list[Admitted]:
        """What answers the question."""
        if self.question.takt is not None:
            return self._within_takt()
        # stress -> least cycle time of the allocations so far that have it
        best: dict[int, int] = {}
        for allocation in self.allocations:
            below = min(
                (length for stress, length in best.items() if stress <= allocation.stress),
                default=self.longest + 1,
            )
            length = allocation.least_possible(below - 1, self.question.max_in_process)
            if length is not None:
                best[allocation.stress] = length
        front: list[tuple[int, int]] = []
        for length, stress in sorted((length, stress) for stress, length in best.items()):
            if not front or stress < front[-1][1]:
                front.append((length, stress))
        if self.question.minimize != "front":
            front = front[:1] if self.question.minimize == "cycle_time" else front[-1:]
        return [self._fewest(length, stress) for length, stress in front]

    def _within_takt(self) -> list[Admitted]:
        """The least stress that keeps the takt, the fewest in process, the least cycle time."""
        for stress in sorted({allocation.stress for allocation in self.allocations}):
            if any(
                allocation.least_possible(self.longest, self.question.max_in_process) is not None
                for allocation in self._of(stress)
            ):
                return [self._fewest(self.longest, stress)]
        return []

    def _fewest(self, longest: int, stress: int) -> Admitted:
        """The pattern of this stress and at most this cycle time with the fewest in process and, of
        those, the least cycle time. Assumes that there is one.
        """
        laps = 0
        while True:
            laps += 1
            least: tuple[int, _Allocation] | None = None
            for allocation in self._of(stress):
                below = longest if least is None else least[0] - 1
                length = allocation.least_possible(below, laps)
                if length is not None:
                    least = length, allocation
            if least is not None:
                length, allocation = least
                pattern = allocation.pattern(length, laps)
                assert pattern is not None
                admitted = self.door.vouched(pattern, length)
                if admitted is None:
                    raise NothingFoundError(self.door.apology())
                return admitted

    def _of(self, stress: int) -> list[_Allocation]:
        return [allocation for allocation in self.allocations if allocation.stress == stress]


def _allowed(instance: Instance) -> Iterator[tuple[tuple[int, ...], int]]:
    """Every allocation that keeps the limits and rules on who does what, and its stress, units."""
    for ways in product(*(range(len(row)) for row in instance.ways)):
        chosen = [instance.ways[task][way] for task, way in enumerate(ways)]
        if any(
            chosen[one].operators != chosen[two].operators for one, two in instance.same_operator
        ):
            continue
        if any(len(instance.sides(task, way)) > 1 for task, way in enumerate(chosen)):
            continue
        taken = [0] * len(instance.allowances)
        for way in chosen:
            for number, due in way.dues:
                taken[number] += due
        if any(
            due > allowance.most for due, allowance in zip(taken, instance.allowances, strict=True)
        ):
            continue
        if instance.stress_of_set is None:
            yield ways, sum(way.stress for way in chosen)
        else:
            by_human = frozenset(
                task
                for task, way in enumerate(chosen)
                if any(instance.human[operator] for operator in way.operators)
            )
            if by_human in instance.stress_of_set:
                yield ways, instance.stress_of_set[by_human]


def _asked(question: CycleQuestion) -> str:
    return " and ".join([*question.limits, "the cell's own limits"])
