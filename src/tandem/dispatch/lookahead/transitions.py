"""The cell in motion in plain whole numbers: what may begin, and what the next event leaves. For
exact values and for live search.

Written apart from `tandem.world`, so that each can judge the other. A position knows no clock where
none is needed (no release, no break): two moments of an assembly that lie alike before it are one
position.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import accumulate
from typing import Any, NamedTuple

from tandem.cell.measures import OWN
from tandem.cell.model import Cell
from tandem.errors import CellError, Fault
from tandem.plan.bounds import WorkPrices
from tandem.plan.instance import Allowance, Instance, Preparation, Way, bits
from tandem.plan.list_scheduling import Layout

PER_SECOND = 1000
"""Ticks in a second at least, so that a pace of 0.6 or 1.25 leaves whole numbers."""


class Position(NamedTuple):
    """An assembly under way, seen from now.

    Attributes:
      done: bits of the tasks that have ended.
      running: `(way, ticks left)` of what is being done, sorted; at least 1 tick is left.
      wrong: bits of the tasks, among those that have ended, that must be taken apart and done
        again.
      clock: ticks since the start; 0 where no rule of the cell looks at the clock.
      stance: per operator, what it has in hand, see `Instance.stance`; empty where nobody needs
        time to get ready for a task.
      taken: per allowance, what the work that stands or runs has taken of it; empty where nobody
        has a limit.
      teams: `(team, operators)` of the `same_operator` teams that have begun, sorted.
      waits: `(number of the wait, ticks left)` of the waits after other tasks that last still,
        sorted; at least 1 tick is left.
    """

    done: int
    running: tuple[tuple[int, int], ...]
    wrong: int = 0
    clock: int = 0
    stance: tuple[int, ...] = ()
    taken: tuple[int, ...] = ()
    teams: tuple[tuple[int, int], ...] = ()
    waits: tuple[tuple[int, int], ...] = ()


def _go_on(sets: int) -> None:
    """Whoever may do all the work counts none of it."""


@dataclass(frozen=True)
class Moves:
    """The moves of one cell at certain paces; what is ready, and what is left, is remembered.

    Ways are numbered through: those of the first task as `cell.modes` lists them, then the
    second's, and so on: `count` ways of doing. Then come as many of taking apart what was done
    wrongly, in the same order, and then, per operator, being away.

    Attributes:
      layout: the cell in whole numbers, paces in the times; `prices` bound its makespan.
      taking_apart: how long taking a task apart takes, as a share of doing it in the same way.
      ways: per task, the ways of doing it that are open.
      instance: the layout's. `modes`: the ways of doing, `count` of them.
      task: per way, its task; whoever is away is at a task of their own, behind all others.
      who: per way, bits of its operators. `dues`: `(allowance, units of it)`; `units`: of stress.
      ticks: per way, how long it takes; how long somebody is away is known to the position alone.
      price: per way, the prices of its operators together.
      preparations: per way of doing and of taking apart, `(operator, what it needs before)`, of
        those who need a tool or a place that may cost time.
      scarce: per way of doing and of taking apart, `Instance.scarce`.
      timeless: no rule looks at the clock.
      plain: ways of different tasks and operators never stand in each other's way.
    """

    layout: Layout
    prices: WorkPrices
    taking_apart: float
    ways: tuple[tuple[int, ...], ...]
    instance: Instance = field(init=False, repr=False)
    modes: tuple[Way, ...] = field(init=False, repr=False)
    count: int = field(init=False, repr=False)
    task: tuple[int, ...] = field(init=False, repr=False)
    who: tuple[int, ...] = field(init=False, repr=False)
    ticks: tuple[int, ...] = field(init=False, repr=False)
    dues: tuple[tuple[tuple[int, int], ...], ...] = field(init=False, repr=False)
    units: tuple[int, ...] = field(init=False, repr=False)
    price: tuple[int, ...] = field(init=False, repr=False)
    preparations: tuple[tuple[tuple[int, Preparation], ...], ...] = field(init=False, repr=False)
    scarce: tuple[tuple[tuple[int, int], ...], ...] = field(init=False, repr=False)
    timeless: bool = field(init=False, repr=False)
    plain: bool = field(init=False, repr=False)
    _ready: dict[tuple[int, int, int], tuple[int, ...]] = field(default_factory=dict)
    _rest: dict[int, tuple[int, int, int]] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        cell: Cell,
        pace: Mapping[str, float] | None = None,
        *,
        taking_apart: float = 1.0,
        max_stress: float | None = None,
        prices: Sequence[int] | None = None,
        stated: Instance | None = None,
    ) -> Moves:
        """The cell's moves when every operator needs `pace` times the stated time.

        Args:
          pace: by name, 1 for who is not named; a group goes at its slowest.
          max_stress: limits the stress of the one human.
          prices: of the operators' time, above 0, to bound makespans with; the best for these paces
            when None.
          stated: `Instance.of(cell)`, where it is at hand.

        Raises:
          CellError: stress comes from a table of sets: it is then no sum, and what is still to
            come cannot be told apart from what was; or `max_stress` is to hold for several
            humans together.
        """
        if cell.stress_of_set is not None:
            what = (
                "live decisions need a stress that adds up; take stress_of_set out, or plan with"
                " `tandem plan`."
            )
            raise CellError([Fault(what, ("stress_of_set",))])
        stated = stated or Instance.of(cell)
        finer = max(PER_SECOND, stated.per_second) // stated.per_second
        instance = stated.scaled(finer, [(pace or {}).get(name, 1.0) for name in stated.operators])
        layout = Layout.of(instance if max_stress is None else _capped(instance, max_stress))
        firsts = accumulate((len(row) for row in instance.ways), initial=0)
        ways = tuple(
            tuple(sorted(first + step.way for step in row))
            for first, row in zip(firsts, layout.steps, strict=False)
        )
        work = WorkPrices.of(layout) if prices is None else WorkPrices.at(layout, prices)
        return cls(layout, work, taking_apart, ways)

    def __post_init__(self) -> None:
        # Fields, not views: a search looks at them a million times, and fields are the quickest.
        for name, value in (_per_way(self) | _rules(self.layout.instance)).items():
            object.__setattr__(self, name, value)

    # ------------------------------------------------------------ positions

    def root(self) -> Position:
        """Nothing has begun."""
        stance = self.instance.stances if self.instance.has_preparations else ()
        return Position(0, (), 0, 0, stance, (0,) * len(self.instance.allowances))

    def is_over(self, position: Position) -> bool:
        """Everything is done, and nothing of it must be done again."""
        every = self.instance.all_tasks
        return not position.wrong and position.done & every == every

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
                t
                for t, need in enumerate(self.instance.needs)
                if not begun >> t & 1 and need & fine == need
            ]
            found = [way for t in tasks for way in self.ways[t]]
            if wrong:
                bare = [not followers & begun for followers in self.instance.followers]
                off = [t for t in range(len(self.ways)) if wrong >> t & 1 and bare[t]]
                found += [self.count + way for t in off for way in self.ways[t]]
            known = self._ready[done, begun, wrong] = tuple(found)
        return known

    def begin(self, position: Position, way: int) -> Position:
        """The way begins now. Assumes that it is legal."""
        left = self.ticks[way]
        if self.preparations[way]:
            left += self._preparation(position, way)
        running = tuple(sorted([*position.running, (way, left)]))
        if self.plain:
            return Position(position.done, running, position.wrong)
        stance, taken, teams = position.stance, position.taken, position.teams
        team = self.instance.team[self.task[way]]
        if self.preparations[way]:
            moved = list(stance)
            for operator, preparation in self.preparations[way]:
                moved[operator] = preparation[moved[operator]][1]
            stance = tuple(moved)
        if taken:
            dues = dict(self.dues[way])
            taken = tuple(units + dues.get(number, 0) for number, units in enumerate(taken))
        if team >= 0 and all(other != team for other, _ in teams):
            teams = tuple(sorted([*teams, (team, self.who[way])]))
        waits = position.waits
        if self.instance.has_lags and way < self.count:
            waits = self._counted(waits, self.task[way], left - self.ticks[way], from_start=True)
        return Position(
            position.done, running, position.wrong, position.clock, stance, taken, teams, waits
        )

    def _counted(
        self, waits: tuple[tuple[int, int], ...], task: int, ticks: int, *, from_start: bool
    ) -> tuple[tuple[int, int], ...]:
        """The waits with those that count from the task's start, or end, `ticks` from now."""
        fresh = {
            number: ticks + lag.least
            for number, lag in enumerate(self.instance.lags)
            if lag.before == task and lag.from_start == from_start
        }
        if not fresh:
            return waits
        kept = [(number, left) for number, left in waits if number not in fresh]
        return tuple(sorted([*kept, *((n, left) for n, left in fresh.items() if left > 0)]))

    def next_event(self, position: Position) -> int | None:
        """Ticks until something happens: a task or a wait ends, or, where the clock matters, a
        release or a break comes or goes. None for never.
        """
        least = min([left for _, left in position.running], default=None)
        for _, left in position.waits:
            least = left if least is None else min(least, left)
        if self.timeless:
            return least
        moments = [moment for moment in self._moments if moment > position.clock]
        if moments and (least is None or moments[0] - position.clock < least):
            return moments[0] - position.clock
        return least

    def after(self, position: Position, ticks: int) -> Position:
        """Time has run for so many ticks, at most until the next event."""
        done, wrong, running = position.done, position.wrong, []
        waits = position.waits
        if waits:
            waits = tuple((number, left - ticks) for number, left in waits if left > ticks)
        for way, left in position.running:
            if left > ticks:
                running.append((way, left - ticks))
            elif way < self.count:
                done |= 1 << self.task[way]
                if self.instance.has_lags:
                    waits = self._counted(waits, self.task[way], left - ticks, from_start=False)
            elif way < 2 * self.count:
                done &= ~(1 << self.task[way])
                wrong &= ~(1 << self.task[way])
        if self.plain:
            return Position(done, tuple(running), wrong)
        clock = 0 if self.timeless else position.clock + ticks
        return Position(
            done,
            tuple(running),
            wrong,
            clock,
            position.stance,
            position.taken,
            position.teams,
            waits,
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
        self, position: Position, among: int | None = None, look: Callable[[int], None] = _go_on
    ) -> Iterator[tuple[int, ...]]:
        """Every set of ways that may begin together now, the empty one last; with `among`, only
        ways within these operators.

        There may be very many. `look` is told of so many more while they are put together, and
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
        task_of, behind = self.task, self.layout.behind
        for way, left in position.running:
            if way >= self.count:
                continue
            task = task_of[way]
            begun |= 1 << task
            load += left * self.price[way]
            chain = left + behind[task]
            if chain > ticks:
                ticks = chain
        for number, left in position.waits:
            ticks = max(ticks, left + self.layout.tail[self.instance.lags[number].task])
        rest = self._rest.get(begun)
        work, chain, ease = self._of_rest(begun) if rest is None else rest
        if work:
            shared = -(-(work + load) // self.prices.total)
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
            {moment for row in self.instance.breaks for pair in row for moment in pair}
            | set(self.instance.release) - {0}
        )

    def _of_rest(self, begun: int) -> tuple[int, int, int]:
        """Of the tasks that have not begun: cheapest work at the prices, longest chain, least
        stress.
        """
        left = [t for t in range(len(self.ways)) if not begun >> t & 1]
        chain = max((self.layout.tail[t] for t in left), default=0)
        self._rest[begun] = known = (
            sum(self.prices.work[t] for t in left),
            chain,
            sum(self.layout.easiest[t] for t in left),
        )
        return known

    def _plain_sets(
        self, legal: Sequence[int], look: Callable[[int], None]
    ) -> list[tuple[int, ...]]:
        """`choices` where any ways of different tasks and operators can begin together."""
        who, task = self.who, self.task
        sets: list[tuple[tuple[int, ...], int, int]] = [((), 0, 0)]
        for way in legal:
            mine, bit = who[way], 1 << task[way]
            more = [
                ((*chosen, way), busy | mine, begun | bit)
                for chosen, busy, begun in sets
                if not busy & mine and not begun & bit
            ]
            look(len(more))
            sets += more
        return [chosen for chosen, _, _ in sets[::-1]]

    def _sets(
        self, position: Position, legal: Sequence[int], chosen: tuple[int, ...]
    ) -> Iterator[tuple[int, ...]]:
        for index, way in enumerate(legal):
            after = self.begin(position, way)
            rest = [
                other
                for other in legal[index + 1 :]
                if not self.who[other] & self.who[way] and self.task[other] != self.task[way]
            ]
            if not self.plain:
                rest = [other for other in rest if self._may(after, other)]
            yield from self._sets(after, rest, (*chosen, way))
        yield chosen

    def _may(self, position: Position, way: int) -> bool:
        """Whether clock, waits, breaks, tools, zones, holds, limits and teams allow the way now.
        Assumes that it is ready and its operators are free.
        """
        instance, task, who = self.instance, self.task[way], self.who[way]
        if instance.has_lags and way < self.count and self._waits(position, task):
            return False
        if instance.release[task] > position.clock:
            return False
        operators = self.modes[way % self.count].operators
        if any(team == instance.team[task] and others != who for team, others in position.teams):
            return False
        # counted only where somebody has a limit
        if position.taken:
            for number, due in self.dues[way]:
                if position.taken[number] + due > instance.allowances[number].most:
                    return False
        # work and the preparation before it lie in one piece between two breaks
        if not self.timeless:
            end = position.clock + self.ticks[way] + self._preparation(position, way)
            if any(
                off < end and position.clock < back
                for o in operators
                for off, back in instance.breaks[o]
            ):
                return False
        if not (self._has_tools(position, way) and self._has_zone(position, way)):
            return False
        return not instance.has_holds or not self._is_barred(position, way)

    def _waits(self, position: Position, task: int) -> bool:
        """Whether a wait of the task lasts still, or counts from a start that has not come."""
        lags = self.instance.lags
        if any(lags[number].task == task for number, _ in position.waits):
            return True
        firsts = bits({lag.before for lag in self.instance.lags_into[task] if lag.from_start})
        if not firsts:
            return False
        begun = position.done
        for way, _ in position.running:
            if way < self.count:
                begun |= 1 << self.task[way]
            elif way < 2 * self.count:
                begun &= ~(1 << self.task[way])
        return begun & firsts != firsts

    def _has_tools(self, position: Position, way: int) -> bool:
        return all(
            sum(
                units
                for other, _ in self._at_work(position)
                for mine, units in self.scarce[other]
                if mine == tool
            )
            + count
            <= self.instance.tool_room[tool]
            for tool, count in self.scarce[way]
        )

    def _has_zone(self, position: Position, way: int) -> bool:
        """Whether the zone has room, and nobody is in it whom it keeps apart from the way's
        operators.
        """
        instance, zone = self.instance, self.instance.zone[self.task[way]]
        if zone is None or not (instance.zone_room[zone] or instance.keeps_apart[zone]):
            return True
        there = [
            other for other, _ in self._at_work(position) if instance.zone[self.task[other]] == zone
        ]
        if instance.zone_room[zone]:
            taken = sum(self.who[other].bit_count() for other in (*there, way))
            if taken > instance.zone_room[zone]:
                return False
        kinds = [self._sides(other) for other in there] if instance.keeps_apart[zone] else []
        mine = self._sides(way) if kinds else frozenset()
        return not mine or all(not theirs or theirs == mine for theirs in kinds)

    def _sides(self, way: int) -> frozenset[int]:
        return self.instance.sides(self.task[way], self.modes[way % self.count])

    def _is_barred(self, position: Position, way: int) -> bool:
        """Whether a machine holds a part that must come out first, or is at work where it is to
        take up one.
        """
        instance, task = self.instance, self.task[way]
        comes_off = way >= self.count
        if not comes_off:
            busy = 0
            for other, _ in self._at_work(position):
                busy |= self.who[other]
            if any(busy >> instance.holds[hold][0] & 1 for hold in instance.held_from[task]):
                return True
        return instance.is_barred(
            self.begun(position),
            position.done,
            task,
            self.who[way],
            wrong=position.wrong,
            comes_off=comes_off,
        )

    def _at_work(self, position: Position) -> Iterator[tuple[int, int]]:
        """What runs without the absences, which take no place."""
        return ((way, left) for way, left in position.running if way < 2 * self.count)

    def _preparation(self, position: Position, way: int) -> int:
        """Ticks that the operators need first to get ready."""
        stance = position.stance
        return max((need[stance[o]][0] for o, need in self.preparations[way]), default=0)


def _capped(instance: Instance, max_stress: float) -> Instance:
    """The instance with a limit over all humans: that of the one there is."""
    if sum(instance.human) > 1:
        what = (
            "a limit on the stress of several humans together cannot be kept live; give each human"
            " a stress_limit."
        )
        raise CellError([Fault(what, ("operators",))])
    one = Allowance(
        instance.human.index(True) if any(instance.human) else 0,
        OWN,
        int(max_stress * instance.per_stress + 1e-9),
    )
    number = len(instance.allowances)
    ways = tuple(
        tuple(replace(way, dues=(*way.dues, (number, way.stress))) for way in row)
        for row in instance.ways
    )
    return replace(instance, allowances=(*instance.allowances, one), ways=ways)


def _per_way(moves: Moves) -> dict[str, Any]:
    """The ways of doing, of taking apart and of being away, in this order: what each is."""
    instance = moves.layout.instance
    away = range(len(instance.operators))
    modes = tuple(way for row in instance.ways for way in row)
    task = [task for task, row in enumerate(instance.ways) for _ in row]
    who, ticks = [way.who for way in modes], [way.ticks for way in modes]
    apart = [max(1, round(one * moves.taking_apart)) for one in ticks]
    dues = [way.dues for way in modes]
    units = [way.stress for way in modes]
    prices = moves.prices.of_operator
    price = [sum(prices[operator] for operator in way.operators) for way in modes]
    preparations = [
        instance.prepared(number, way) for number, row in enumerate(instance.ways) for way in row
    ]
    scarce = [instance.scarce(way) for way in modes]
    return {
        "instance": instance,
        "modes": modes,
        "count": len(modes),
        "task": (*task, *task, *(len(instance.tasks) + operator for operator in away)),
        "who": (*who, *who, *(1 << operator for operator in away)),
        "ticks": (*ticks, *apart, *(1 for _ in away)),
        # what has to come off does so, whatever it takes
        "dues": (*dues, *(() for _ in modes), *(() for _ in away)),
        "units": (*units, *units, *(0 for _ in away)),
        "price": (*price, *price, *prices),
        "preparations": (*preparations, *preparations),
        "scarce": (*scarce, *scarce),
    }


def _rules(at: Instance) -> dict[str, bool]:
    """Which rules matter in this cell."""
    timeless = not any(at.release) and not at.has_breaks
    free = at.is_plain and not (at.has_preparations or at.has_limits or at.has_teams or at.has_lags)
    return {"timeless": timeless, "plain": timeless and free}
