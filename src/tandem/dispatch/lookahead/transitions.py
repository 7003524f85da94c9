"""The cell in motion in plain whole numbers: what may begin, and what the next event leaves. For
exact values and for live search.

Written apart from `tandem.world`, so that each can judge the other. A position knows no clock where
none is needed (no release, no break): two moments of an assembly that lie alike before it are one
position.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

from tandem.dispatch.lookahead.numbers import Numbers


class Position(NamedTuple):
    """An assembly under way, seen from now.

    Attributes:
      done: bits of the tasks that have ended.
      running: `(way, ticks left)` of what is being done, sorted; at least 1 tick is left.
      wrong: bits of the tasks, among those that have ended, that must be taken apart and done
        again.
      clock: ticks since the start; 0 where no rule of the cell looks at the clock.
      hand: per operator, the tool in hand, -1 for none yet; empty where changing tools costs
        nothing.
      load: stress units per operator so far; empty where nobody has a limit.
      teams: `(team, operators)` of the `same_operator` teams that have begun, sorted.
    """

    done: int
    running: tuple[tuple[int, int], ...]
    wrong: int = 0
    clock: int = 0
    hand: tuple[int, ...] = ()
    load: tuple[int, ...] = ()
    teams: tuple[tuple[int, int], ...] = ()


def _go_on() -> None:
    """Whoever has all the time needs no look at the clock."""


@dataclass(frozen=True)
class Moves(Numbers):
    """The moves of one cell in these numbers; what is ready, and what is left, is remembered by the
    set of tasks.
    """

    _ready: dict[tuple[int, int, int], tuple[int, ...]] = field(default_factory=dict)
    _rest: dict[int, tuple[int, int, int]] = field(default_factory=dict)

    def root(self) -> Position:
        """Nothing has begun."""
        operators = len(self.instance.operators)
        hand = (
            tuple(-1 if tool is None else tool for tool in self.instance.in_hand)
            if self.swaps
            else ()
        )
        return Position(0, (), 0, 0, hand, (0,) * operators if self.limited else ())

    def is_over(self, position: Position) -> bool:
        """Everything is done, and nothing of it must be done again."""
        return not position.wrong and position.done & self.full == self.full

    def begun(self, position: Position) -> int:
        """Bits of the tasks that have ended or are being done."""
        bits = position.done
        for way, _ in position.running:
            bits |= 1 << self.task[way]
        return bits

    def busy(self, position: Position) -> int:
        """Bits of the operators who are doing something."""
        bits = 0
        for way, _ in position.running:
            bits |= self.who[way]
        return bits

    def legal(self, position: Position, among: int | None = None) -> list[int]:
        """The ways that may begin now; with `among`, those that need one of these operators."""
        begun, busy = self.begun(position), self.busy(position)
        who = self.who
        found = [
            way
            for way in self.ready(position.done, begun, position.wrong)
            if not who[way] & busy and (among is None or who[way] & among)
        ]
        if position.wrong:
            going = {self.task[way] for way, _ in position.running}
            found = [way for way in found if self.task[way] not in going]
        return found if self.plain else [way for way in found if self._may(position, way)]

    def ready(self, done: int, begun: int, wrong: int = 0) -> tuple[int, ...]:
        """The ways of tasks that have not begun and whose predecessors have ended, and of taking
        apart what is wrong and bears nothing.
        """
        known = self._ready.get((done, begun, wrong))
        if known is None:
            fine = done & ~wrong
            tasks = [
                t for t, need in enumerate(self.need) if not begun >> t & 1 and need & fine == need
            ]
            found = [way for t in tasks for way in self.ways[t]]
            if wrong:
                found += [
                    self.count + way
                    for t, row in enumerate(self.ways)
                    if wrong >> t & 1 and not self.behind_task[t] & begun
                    for way in row
                ]
            known = self._ready[done, begun, wrong] = tuple(found)
        return known

    def begin(self, position: Position, way: int) -> Position:
        """The way begins now. Assumes that it is legal."""
        left = self.ticks[way] + (self._change(position, way) if self.swaps else 0)
        running = tuple(sorted([*position.running, (way, left)]))
        if self.plain:
            return Position(position.done, running, position.wrong)
        hand, load, teams, task = position.hand, position.load, position.teams, self.task[way]
        tool = self.instance.tool[task]
        if hand and tool is not None:
            hand = tuple(tool if self.who[way] >> o & 1 else held for o, held in enumerate(hand))
        if load:
            extra = dict(self.loads[way])
            load = tuple(units + extra.get(o, 0) for o, units in enumerate(load))
        if self.team[task] >= 0 and all(team != self.team[task] for team, _ in teams):
            teams = tuple(sorted([*teams, (self.team[task], self.who[way])]))
        return Position(position.done, running, position.wrong, position.clock, hand, load, teams)

    def next_event(self, position: Position) -> int | None:
        """Ticks until something happens: a task ends, or, where the clock matters, a release or a
        break comes or goes. None for never.
        """
        least = min([left for _, left in position.running], default=None)
        if self.timeless:
            return least
        moments = [moment for moment in self._moments if moment > position.clock]
        if moments and (least is None or moments[0] - position.clock < least):
            return moments[0] - position.clock
        return least

    def after(self, position: Position, ticks: int) -> Position:
        """Time has run for so many ticks, at most until the next event."""
        done, wrong, running = position.done, position.wrong, []
        for way, left in position.running:
            if left > ticks:
                running.append((way, left - ticks))
            elif way < self.count:
                done |= 1 << self.task[way]
            elif way < 2 * self.count:
                done &= ~(1 << self.task[way])
                wrong &= ~(1 << self.task[way])
        if self.plain:
            return Position(done, tuple(running), wrong)
        clock = 0 if self.timeless else position.clock + ticks
        return Position(
            done, tuple(running), wrong, clock, position.hand, position.load, position.teams
        )

    def spoiled(self, position: Position, task: int) -> Position:
        """It is noticed that the task, which has ended, was done wrongly: it and all that stands on
        it must come off.
        """
        wrong, pending = position.wrong, [task]
        while pending:
            one = pending.pop()
            if position.done >> one & 1 and not wrong >> one & 1:
                wrong |= 1 << one
                pending += self.instance.behind[one]
        return position._replace(wrong=wrong)

    def without(self, ways: Iterable[int]) -> Moves:
        """The same cell, in which nobody does a task in one of these ways; tasks that would be left
        without any keep theirs.
        """
        gone = set(ways)
        kept = tuple(tuple(way for way in row if way not in gone) or row for row in self.ways)
        return replace(self, ways=kept, _ready={}, _rest={})

    def choices(
        self, position: Position, among: int | None = None, look: Callable[[], None] = _go_on
    ) -> Iterator[tuple[int, ...]]:
        """Every set of ways that may begin together now, the empty one last; with `among`, only
        ways within these operators.

        There may be very many. `look` is called again and again while they are put together, and
        may raise.
        """
        legal = self.legal(position)
        if among is not None:
            legal = [way for way in legal if not self.who[way] & ~among]
        if self.plain:
            yield from self._plain_sets(legal, look)
        else:
            yield from self._sets(position, legal, ())

    def floor(self, position: Position) -> tuple[int, int]:
        """(ticks, units) below which no continuation falls."""
        begun, load, ticks = position.done & ~position.wrong, 0, 0
        for way, left in position.running:
            if way >= self.count:
                continue
            begun |= 1 << self.task[way]
            load += left * self.price[way]
            chain = left + self.behind[way]
            if chain > ticks:
                ticks = chain
        rest = self._rest.get(begun)
        work, chain, ease = self._of_rest(begun) if rest is None else rest
        if work:
            shared = -(-(work + load) // self.total)
            ticks = max(ticks, chain, shared)
        return ticks, ease

    def flat(self, task: str, operators: Sequence[str]) -> int | None:
        """The number of the way in which these operators do the task; None when there is none."""
        bits = sum(1 << self.instance.operators.index(name) for name in operators)
        return next(
            (way for way in self.ways[self.instance.tasks.index(task)] if self.who[way] == bits),
            None,
        )

    def named(self, way: int) -> tuple[str, tuple[str, ...]]:
        """The way of doing or taking apart as people say it: the task and its operators."""
        return self.instance.tasks[self.task[way]], tuple(
            name for o, name in enumerate(self.instance.operators) if self.who[way] >> o & 1
        )

    @cached_property
    def _moments(self) -> list[int]:
        """Ticks at which the clock alone changes what is allowed, sorted."""
        return sorted(
            {moment for row in self.breaks for pair in row for moment in pair}
            | set(self.release) - {0}
        )

    def _of_rest(self, begun: int) -> tuple[int, int, int]:
        """Of the tasks that have not begun: cheapest work at the prices, longest chain, least
        stress.
        """
        left = [t for t in range(len(self.ways)) if not begun >> t & 1]
        chain = max((self.tails[t] for t in left), default=0)
        self._rest[begun] = known = (
            sum(self.work[t] for t in left),
            chain,
            sum(self.ease[t] for t in left),
        )
        return known

    def _plain_sets(self, legal: Sequence[int], look: Callable[[], None]) -> list[tuple[int, ...]]:
        """`choices` where any ways of different tasks and operators can begin together."""
        who, task = self.who, self.task
        sets: list[tuple[tuple[int, ...], int, int]] = [((), 0, 0)]
        for way in legal:
            look()
            mine, bit = who[way], 1 << task[way]
            sets += [
                ((*chosen, way), busy | mine, begun | bit)
                for chosen, busy, begun in sets
                if not busy & mine and not begun & bit
            ]
        return [chosen for chosen, _, _ in sets[::-1]]

    def _sets(
        self, position: Position, legal: Sequence[int], chosen: tuple[int, ...]
    ) -> Iterator[tuple[int, ...]]:
        for place, way in enumerate(legal):
            after = self.begin(position, way)
            rest = [
                other
                for other in legal[place + 1 :]
                if not self.who[other] & self.who[way] and self.task[other] != self.task[way]
            ]
            if not self.plain:
                rest = [other for other in rest if self._may(after, other)]
            yield from self._sets(after, rest, (*chosen, way))
        yield chosen

    def _may(self, position: Position, way: int) -> bool:
        """Whether clock, breaks, tools, zones, limits and teams allow the way now. Assumes that it
        is ready and its operators are free.
        """
        task, who = self.task[way], self.who[way]
        if self.release[task] > position.clock:
            return False
        operators = [o for o in range(len(self.prices)) if who >> o & 1]
        if any(team == self.team[task] and others != who for team, others in position.teams):
            return False
        if position.load and any(
            self.limits[o] is not None and position.load[o] + units > self.limits[o]  # type: ignore[operator]
            for o, units in self.loads[way]
        ):
            return False
        if not self.timeless:
            end = (
                position.clock
                + self.ticks[way]
                + (self._change(position, way) if self.swaps else 0)
            )
            if any(
                off < end and position.clock < back
                for o in operators
                for off, back in self.breaks[o]
            ):
                return False
        return self._has_place(
            position, self.instance.tool, self.tool_places, task, len(operators)
        ) and self._has_place(position, self.instance.zone, self.zone_places, task, len(operators))

    def _has_place(
        self,
        position: Position,
        thing: Sequence[int | None],
        places: Sequence[int],
        task: int,
        count: int,
    ) -> bool:
        mine = thing[task]
        if mine is None or not places[mine]:
            return True
        # what comes after are absences, which take no place
        at_work = (way for way, _ in position.running if way < 2 * self.count)
        taken = sum(self.who[way].bit_count() for way in at_work if thing[self.task[way]] == mine)
        return taken + count <= places[mine]

    def _change(self, position: Position, way: int) -> int:
        """Ticks that the operators need first to take up the way's tool."""
        tool = self.instance.tool[self.task[way]]
        if tool is None:
            return 0
        return max(
            self.changeover[tool][o] if position.hand[o] not in (-1, tool) else 0
            for o in range(len(self.prices))
            if self.who[way] >> o & 1
        )
