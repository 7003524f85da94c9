"""A cell in whole numbers, as solvers want it: names become indices, seconds become ticks, exactly.

Only solvers read this form. The checker and the measures never do: they judge from the cell itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, Decimal
from functools import cached_property
from itertools import groupby
from typing import Any, NamedTuple

from tandem.cell.measures import OWN
from tandem.cell.model import Cell
from tandem.cell.parts import Mode, Tool, Zone
from tandem.cell.precedence import between
from tandem.schedule.exposure import all_limits
from tandem.schedule.model import Assignment, Schedule


@dataclass(frozen=True)
class Way:
    """One mode of one task.

    Attributes:
      operators: indices.
      ticks: the duration.
      load: the stress per operator, 0 for robots.
      tools: the tool that each operator needs in hand, or None.
      dues: `(allowance, units of it)` that the way takes, of the allowances of its operators.
    """

    operators: tuple[int, ...]
    ticks: int
    load: tuple[int, ...]
    tools: tuple[int | None, ...]
    dues: tuple[tuple[int, int], ...] = ()

    @cached_property
    def stress(self) -> int:
        """Units of stress on all who take part."""
        return sum(self.load)

    @cached_property
    def who(self) -> int:
        """The operators as bits."""
        return bits(self.operators)

    @cached_property
    def units(self) -> tuple[tuple[int, int], ...]:
        """`(tool, how many of it)` that are taken, sorted."""
        taken = sorted(tool for tool in self.tools if tool is not None)
        return tuple((tool, len(list(same))) for tool, same in groupby(taken))

    def tool(self, operator: int) -> int | None:
        """The tool that the operator, who takes part, needs in hand."""
        return self.tools[self.operators.index(operator)]


class Preparation(dict[int, tuple[int, int]]):
    """What an operator needs before one kind of work: its stance -> (ticks directly before the
    work, its stance in the work). Worked out when it is first asked for.

    First it walks, then it takes up its tool. A stance says in one number which tool somebody has
    in hand and where it stands, see `Instance.stance`.
    """

    __hash__ = object.__hash__  # type: ignore[assignment]
    __eq__ = object.__eq__
    __ne__ = object.__ne__

    def __init__(self, tool: int, change: int, place: int, walk: tuple[int, ...]) -> None:
        """For work at the place with the tool, -1 for none.

        Args:
          change: ticks to take the tool up.
          walk: ticks from each place of the cell to this one.
        """
        super().__init__()
        self.tool, self.change, self.place, self.walk = tool, change, place, walk

    def __missing__(self, stance: int) -> tuple[int, int]:
        held, at = divmod(stance, len(self.walk) + 1)
        ticks = 0
        if self.tool >= 0:
            ticks += self.change if held not in (0, self.tool + 1) else 0
            held = self.tool + 1
        if self.place >= 0:
            ticks += self.walk[at - 1] if at else 0
            at = self.place + 1
        self[stance] = found = (ticks, held * (len(self.walk) + 1) + at)
        return found

    @property
    def is_none(self) -> bool:
        """The work needs neither a tool nor a place."""
        return self.tool < 0 and self.place < 0

    @property
    def lengths(self) -> set[int]:
        """Every number of ticks that it may take."""
        walks = {0, *self.walk} if self.place >= 0 else {0}
        return walks | {walk + self.change for walk in walks}


class Lag(NamedTuple):
    """A wait between two tasks, ticks: `task` starts at least `least` and at most `most` (None: at
    any time) after `before` has ended, or has started.
    """

    before: int
    task: int
    from_start: bool
    least: int
    most: int | None


class Allowance(NamedTuple):
    """What one person may have of a measure: the `dues` of all that they do come to `most` units at
    most, which the measure's exact limit says in whole numbers.

    Attributes:
      operator: whose it is.
      measure: its name, as in `limits` of the cell; "stress" for the `stress_limit`.
    """

    operator: int
    measure: str
    most: int


MOST_DUE = 1 << 30
"""Units that the dues of all ways of an allowance stay below, so that 32 bits hold their sums."""


@dataclass(frozen=True)
class Instance:
    """The cell's numbers; tasks, operators, tools and zones are indices in the cell's order.

    The fields are what the cell says; what searches want of it besides (bits, chains, what can
    bind at all) are views, worked out when they are first asked for.

    Attributes:
      per_second: ticks in a second, a power of ten that makes every time of the cell whole.
      per_stress: units of stress in 1, likewise.
      ways: per task, every mode of it, in the order of `cell.modes`.
      before: per task, its direct predecessors, those of waits from end to start included.
      lags: the waits.
      release, deadline: ticks per task; a task without a deadline has None.
      zone, place: per task, an index or None. `tools`, `zones` and `places` are names.
      tool_places, zone_places: capacity per tool and zone.
      zone_apart: `[zone][operator]`, the number of the operator's kind among those that the zone
        keeps apart; -1 for operators that nobody there minds.
      changeover: `[tool][operator]` ticks.
      in_hand, stands: per operator, the tool and the place at the start, or None.
      walk: `[operator][from][to]` ticks.
      breaks: per operator, `(from, to)` ticks in which it does nothing, sorted, disjoint.
      allowances: what limits of persons leave them; the `stress_limit` in units of stress, others
        in units of their own.
      holds: `(operator, first, last)`: from the start of the first task to the end of the last one
        the operator, a machine, holds a part. Of some tasks alone (`restricted`) a first of -1
        stands for one that has begun before them, a last of -1 for one that comes behind them.
      within: per hold, bits of the tasks that the machine may do meanwhile.
      same_operator: pairs of tasks.
      stress_of_set: set of tasks done by humans -> units; None when stress adds up.
    """

    cell: Cell
    per_second: int
    per_stress: int
    operators: tuple[str, ...]
    tasks: tuple[str, ...]
    tools: tuple[str, ...]
    zones: tuple[str, ...]
    places: tuple[str, ...]
    human: tuple[bool, ...]
    ways: tuple[tuple[Way, ...], ...]
    before: tuple[tuple[int, ...], ...]
    release: tuple[int, ...]
    deadline: tuple[int | None, ...]
    zone: tuple[int | None, ...]
    place: tuple[int | None, ...]
    tool_places: tuple[int, ...]
    zone_places: tuple[int, ...]
    zone_apart: tuple[tuple[int, ...], ...]
    changeover: tuple[tuple[int, ...], ...]
    in_hand: tuple[int | None, ...]
    stands: tuple[int | None, ...]
    walk: tuple[tuple[tuple[int, ...], ...], ...]
    breaks: tuple[tuple[tuple[int, int], ...], ...]
    allowances: tuple[Allowance, ...]
    holds: tuple[tuple[int, int, int], ...]
    within: tuple[int, ...]
    same_operator: tuple[tuple[int, int], ...]
    stress_of_set: dict[frozenset[int], int] | None
    lags: tuple[Lag, ...]

    @classmethod
    def of(cls, cell: Cell) -> Instance:
        """The cell's instance: nothing is rounded."""
        count = _Count(_scale(_times_in(cell)), _scale(_stresses_in(cell)))
        allowances, dues = _allowances(cell, count)
        return cls(
            cell=cell,
            per_second=count.per_second,
            per_stress=count.per_stress,
            tools=cell.tool_names,
            zones=cell.zone_names,
            places=cell.place_names,
            allowances=allowances,
            **_tasks(cell, count, dues),
            **_places(cell, count),
            **_operators(cell, count),
            **_holds(cell),
        )

    def scaled(self, times: int, pace: Sequence[float] | None = None) -> Instance:
        """The same in ticks that are `times` finer, and with everybody at their own pace.

        Args:
          pace: per operator, the factor on the stated times; a group goes at its slowest, and
            every task takes at least a tick. Stated times when None.
        """
        if times == 1 and pace is None:
            return self
        pace = [1.0] * len(self.operators) if pace is None else pace

        def way(stated: Way) -> Way:
            slowest = max(pace[operator] for operator in stated.operators)
            ticks = stated.ticks * times
            return replace(stated, ticks=max(1, round(ticks * slowest)))

        return replace(
            self,
            per_second=self.per_second * times,
            ways=tuple(tuple(map(way, row)) for row in self.ways),
            release=tuple(ticks * times for ticks in self.release),
            deadline=tuple(None if ticks is None else ticks * times for ticks in self.deadline),
            changeover=tuple(tuple(ticks * times for ticks in row) for row in self.changeover),
            walk=tuple(
                tuple(tuple(ticks * times for ticks in row) for row in table) for table in self.walk
            ),
            breaks=tuple(tuple((a * times, b * times) for a, b in row) for row in self.breaks),
            lags=tuple(
                lag._replace(
                    least=lag.least * times, most=None if lag.most is None else lag.most * times
                )
                for lag in self.lags
            ),
        )

    def restricted(
        self,
        tasks: Sequence[int],
        ways: Sequence[Sequence[Way]],
        release: Sequence[int],
        *,
        before: Sequence[Iterable[int]] | None = None,
        **changed: Any,
    ) -> Instance:
        """These tasks alone as an instance of their own: its task `i` is `tasks[i]` here.

        What the other tasks leave behind does not follow from this instance and is handed in: the
        ways that are still open, releases that stand for what is being waited for (a wait after a
        task that does not stay is dropped), and among `changed` the tools in hand, the breaks and
        the stress that is left.

        Args:
          ways, release: per task that stays.
          before: per task that stays, tasks of this instance that must have ended first; those
            that do not stay are dropped. Its predecessors when None.
          changed: any other fields, as the restricted instance shall have them.
        """
        index = {task: i for i, task in enumerate(tasks)}
        firsts = [self.before[task] for task in tasks] if before is None else before
        kept: dict[str, Any] = {
            "tasks": tuple(self.tasks[task] for task in tasks),
            "ways": tuple(map(tuple, ways)),
            "before": tuple(tuple(index[f] for f in row if f in index) for row in firsts),
            "release": tuple(release),
            "deadline": tuple(self.deadline[task] for task in tasks),
            "zone": tuple(self.zone[task] for task in tasks),
            "place": tuple(self.place[task] for task in tasks),
            **self.still_held(tasks, 0),
            "same_operator": tuple(
                (index[a], index[b]) for a, b in self.same_operator if a in index and b in index
            ),
            "lags": tuple(
                lag._replace(before=index[lag.before], task=index[lag.task])
                for lag in self.lags
                if lag.before in index and lag.task in index
            ),
            "stress_of_set": None,  # stress by sets of all tasks says nothing about some of them
        }
        return replace(self, **(kept | changed))

    def taken(self, ways: Iterable[Way]) -> list[int]:
        """Per allowance, what these ways take of it."""
        found = [0] * len(self.allowances)
        for way in ways:
            for number, due in way.dues:
                found[number] += due
        return found

    def allowances_left(self, taken: Sequence[int]) -> tuple[Allowance, ...]:
        """The allowances when so much of each is taken; none falls below 0."""
        return tuple(
            allowance._replace(most=max(0, allowance.most - due))
            for allowance, due in zip(self.allowances, taken, strict=True)
        )

    def without_allowance(self, number: int) -> Instance:
        """The instance in which this allowance is as much as anybody could take."""
        every = sum(self.taken(way for ways in self.ways for way in ways))
        kept = list(self.allowances)
        kept[number] = kept[number]._replace(most=every)
        return replace(self, allowances=tuple(kept))

    def still_held(self, tasks: Sequence[int], begun: int) -> dict[str, Any]:
        """`holds` and `within` of these tasks alone, when of the others those in `begun` (bits)
        have begun before them, and the rest comes behind them.
        """
        index = {task: i for i, task in enumerate(tasks)}
        holds, within = [], []
        for (operator, first, last), inside in zip(self.holds, self.within, strict=True):
            is_over = last not in index and begun >> last & 1
            is_to_come = first not in index and not begun >> first & 1
            if not (is_over or is_to_come):
                holds.append((operator, index.get(first, -1), index.get(last, -1)))
                within.append(bits(i for task, i in index.items() if inside >> task & 1))
        return {"holds": tuple(holds), "within": tuple(within)}

    # ------------------------------------------------------------ precedence

    @cached_property
    def behind(self) -> tuple[tuple[int, ...], ...]:
        """Per task, its direct successors."""
        behind: list[list[int]] = [[] for _ in self.tasks]
        for task, firsts in enumerate(self.before):
            for first in firsts:
                behind[first].append(task)
        return tuple(map(tuple, behind))

    @cached_property
    def order(self) -> tuple[int, ...]:
        """The tasks so that predecessors come first, and what is waited for."""
        return _topological(self.waits_for, self.begun_behind)

    @cached_property
    def needs(self) -> tuple[int, ...]:
        """Per task, its direct predecessors as bits."""
        return tuple(map(bits, self.before))

    @cached_property
    def followers(self) -> tuple[int, ...]:
        """Per task, its direct successors as bits."""
        return tuple(map(bits, self.behind))

    @cached_property
    def tail(self) -> tuple[int, ...]:
        """Per task, ticks on the longest chain that starts with it, each task at its quickest, with
        the least waits in between.
        """
        return self.chains([min(way.ticks for way in ways) for ways in self.ways])

    @cached_property
    def rest(self) -> tuple[int, ...]:
        """Per task, ticks on the longest chain behind its end, in whatever way it is done."""
        quickest = [min(way.ticks for way in ways) for ways in self.ways]
        return self.behind_ends(self.tail, quickest, self.slowest)

    @cached_property
    def slowest(self) -> tuple[int, ...]:
        """Per task, ticks of its slowest way."""
        return tuple(max((way.ticks for way in ways), default=0) for ways in self.ways)

    @cached_property
    def head(self) -> tuple[int, ...]:
        """Per task, ticks before which it cannot start.

        Because of releases, predecessors in their quickest modes, and operators who come later.
        """
        head = [0] * len(self.tasks)
        for task in self.order:
            arrival = min(max(self.arrival[o] for o in way.operators) for way in self.ways[task])
            ends = (
                head[first] + min(way.ticks for way in self.ways[first])
                for first in self.before[task]
            )
            head[task] = max([self.release[task], arrival, *ends])
            for lag in self.lags_into[task] if self.has_lags else ():
                own = 0 if lag.from_start else min(way.ticks for way in self.ways[lag.before])
                head[task] = max(head[task], head[lag.before] + own + lag.least)
        return tuple(head)

    def chains(self, ticks: Sequence[int]) -> tuple[int, ...]:
        """Per task, the longest chain that starts with it, when task `i` takes `ticks[i]`."""
        tail = [0] * len(self.tasks)
        for task in reversed(self.order):
            tail[task] = ticks[task] + max([tail[after] for after in self.behind[task]], default=0)
            for lag in self.lags_from[task] if self.has_lags else ():
                own = 0 if lag.from_start else ticks[task]
                tail[task] = max(tail[task], own + lag.least + tail[lag.task])
        return tuple(tail)

    def behind_ends(
        self, tail: Sequence[int], quickest: Sequence[int], slowest: Sequence[int]
    ) -> tuple[int, ...]:
        """Per task, ticks that must pass behind its end: its tail in its quickest way less that
        way, but for waits from its start, of which a slow way leaves less behind its end.
        """
        if not self.has_lags:
            return tuple(whole - own for whole, own in zip(tail, quickest, strict=True))
        rest = []
        for task in range(len(self.tasks)):
            behind = [0, *(tail[after] for after in self.behind[task])]
            for lag in self.lags_from[task]:
                own = slowest[task] if lag.from_start else 0
                behind.append(lag.least + tail[lag.task] - own)
            rest.append(max(behind))
        return tuple(rest)

    # ------------------------------------------------------------ waits

    @cached_property
    def has_lags(self) -> bool:
        """Some task waits after another one."""
        return bool(self.lags)

    @cached_property
    def has_most_lags(self) -> bool:
        """Some task must start within a time after another one."""
        return bool(self.most_lags)

    @cached_property
    def most_lags(self) -> tuple[tuple[Lag, int], ...]:
        """The waits that have a most, and that most."""
        return tuple((lag, lag.most) for lag in self.lags if lag.most is not None)

    @cached_property
    def lags_into(self) -> tuple[tuple[Lag, ...], ...]:
        """Per task, the waits before it."""
        rows: list[list[Lag]] = [[] for _ in self.tasks]
        for lag in self.lags:
            rows[lag.task].append(lag)
        return tuple(map(tuple, rows))

    @cached_property
    def lags_from(self) -> tuple[tuple[Lag, ...], ...]:
        """Per task, the waits that are counted from it."""
        rows: list[list[Lag]] = [[] for _ in self.tasks]
        for lag in self.lags:
            rows[lag.before].append(lag)
        return tuple(map(tuple, rows))

    @cached_property
    def begun_first(self) -> tuple[int, ...]:
        """Per task, bits of the tasks that it must not start before: its predecessors, and those
        whose start it waits from.
        """
        if not self.has_lags:
            return self.needs
        return tuple(
            need | bits({lag.before for lag in row})
            for need, row in zip(self.needs, self.lags_into, strict=True)
        )

    @cached_property
    def waits_for(self) -> tuple[int, ...]:
        """Per task, how many tasks it must not start before."""
        if not self.has_lags:
            return tuple(map(len, self.before))
        return tuple(first.bit_count() for first in self.begun_first)

    @cached_property
    def begun_behind(self) -> tuple[tuple[int, ...], ...]:
        """Per task, those that must not start before it."""
        if not self.has_lags:
            return self.behind
        waiting = (tuple(lag.task for lag in row) for row in self.lags_from)
        return tuple(
            tuple(dict.fromkeys((*direct, *more)))
            for direct, more in zip(self.behind, waiting, strict=True)
        )

    # ------------------------------------------------------------ sets as bits

    @cached_property
    def all_tasks(self) -> int:
        """Bits of all tasks."""
        return (1 << len(self.tasks)) - 1

    @cached_property
    def everybody(self) -> int:
        """Bits of all operators."""
        return (1 << len(self.operators)) - 1

    @cached_property
    def humans(self) -> int:
        """Bits of the humans."""
        return bits(operator for operator, human in enumerate(self.human) if human)

    # ------------------------------------------------------------ what can bind

    @cached_property
    def team(self) -> tuple[int, ...]:
        """Per task, the number of its group of tasks that the same operators do; -1 for none."""
        return _teams(len(self.tasks), self.same_operator)

    @cached_property
    def tool_room(self) -> tuple[int, ...]:
        """Per tool, its capacity, or 0 when there are as many as operators: it never binds."""
        return tuple(self._room(places) for places in self.tool_places)

    @cached_property
    def zone_room(self) -> tuple[int, ...]:
        """Per zone, its capacity, or 0 when all operators find room: it never binds."""
        return tuple(self._room(places) for places in self.zone_places)

    def _room(self, places: int) -> int:
        return places if places < len(self.operators) else 0

    @cached_property
    def swap_ticks(self) -> tuple[tuple[int, ...] | None, ...]:
        """Per tool, ticks per operator to take it up; None when it costs nobody any."""
        return tuple(row if any(row) else None for row in self.changeover)

    @cached_property
    def has_swaps(self) -> bool:
        """Changing tools costs somebody time."""
        return any(self.swap_ticks)

    @cached_property
    def walks(self) -> tuple[bool, ...]:
        """Per operator, whether some way costs it time."""
        return tuple(any(map(any, table)) for table in self.walk)

    @cached_property
    def has_preparations(self) -> bool:
        """Somebody may need time directly before a task, to walk there or to take up its tool."""
        return self.has_swaps or any(self.walks)

    @cached_property
    def stances(self) -> tuple[int, ...]:
        """Per operator, its stance at the start."""
        return tuple(map(self.stance, self.in_hand, self.stands))

    def stance(self, tool: int | None, place: int | None) -> int:
        """The stance of who has this tool in hand and stands there; None while the first one costs
        nothing.
        """
        held, at = (0 if one is None else one + 1 for one in (tool, place))
        return held * (len(self.places) + 1) + at

    def read(self, stance: int) -> tuple[int | None, int | None]:
        """The tool in hand and the place in this stance."""
        held, at = divmod(stance, len(self.places) + 1)
        return (held - 1 if held else None, at - 1 if at else None)

    def preparations(self, task: int, way: Way) -> tuple[Preparation, ...]:
        """Per operator of the way, what it needs before the task; empty where nobody needs time to
        get ready for anything.
        """
        if not self.has_preparations:
            return ()
        return tuple(
            self._preparation(operator, tool, self.place[task])
            for operator, tool in zip(way.operators, way.tools, strict=True)
        )

    def prepared(self, task: int, way: Way) -> tuple[tuple[int, Preparation], ...]:
        """The same as `(operator, what it needs)`, without those who need neither a tool nor a
        place.
        """
        needs = zip(way.operators, self.preparations(task, way), strict=False)
        return tuple((operator, need) for operator, need in needs if not need.is_none)

    def _preparation(self, operator: int, tool: int | None, place: int | None) -> Preparation:
        known = self._preparations.get((operator, tool, place))
        if known is None:
            # what costs nothing is not told apart, so that searches see what is alike
            tool_counts = tool is not None and self.has_swaps
            place_counts = place is not None and self.walks[operator]
            known = Preparation(
                tool if tool is not None and tool_counts else -1,
                self.changeover[tool][operator] if tool is not None else 0,
                place if place is not None and place_counts else -1,
                tuple(0 if place is None else row[place] for row in self.walk[operator]),
            )
            self._preparations[operator, tool, place] = known
        return known

    @cached_property
    def _preparations(self) -> dict[tuple[int, int | None, int | None], Preparation]:
        return {}

    @cached_property
    def longest_preparation(self) -> tuple[int, ...]:
        """Per operator, ticks that it needs at most to get ready for a task."""
        return tuple(
            max((row[o] for row in self.changeover), default=0)
            + max((ticks for row in self.walk[o] for ticks in row), default=0)
            for o in range(len(self.operators))
        )

    @cached_property
    def has_breaks(self) -> bool:
        """Somebody is off at some time."""
        return any(self.breaks)

    @cached_property
    def has_limits(self) -> bool:
        """Somebody has a limit."""
        return bool(self.allowances)

    @cached_property
    def has_teams(self) -> bool:
        """Some tasks must be done by the same operators."""
        return any(team >= 0 for team in self.team)

    @cached_property
    def has_tools(self) -> bool:
        """Some tool can matter for times."""
        used = {tool for ways in self.ways for way in ways for tool, _ in way.units}
        return bool(used) and (self.has_swaps or any(self.tool_room[tool] for tool in used))

    def scarce(self, way: Way) -> tuple[tuple[int, int], ...]:
        """`(tool, how many of it)` that the way takes, of the tools that not all can have at
        once.
        """
        return tuple(unit for unit in way.units if self.tool_room[unit[0]])

    @cached_property
    def timed_zone(self) -> tuple[int, ...]:
        """Per task, its zone where that can matter for times, else -1."""
        return tuple(-1 if zone is None or not self.zone_room[zone] else zone for zone in self.zone)

    @cached_property
    def keeps_apart(self) -> tuple[bool, ...]:
        """Per zone, whether it keeps operators apart whom the cell has."""
        return tuple(len({kind for kind in row if kind >= 0}) > 1 for row in self.zone_apart)

    @cached_property
    def has_apart(self) -> bool:
        """Some zone keeps operators apart."""
        return any(self.keeps_apart)

    def sides(self, task: int, way: Way) -> frozenset[int]:
        """The kinds, of those that the task's zone keeps apart, of the operators who take part; a
        way with several can be part of no schedule.
        """
        zone = self.zone[task]
        if zone is None or not self.keeps_apart[zone]:
            return frozenset()
        return frozenset(self.zone_apart[zone][operator] for operator in way.operators) - {-1}

    @cached_property
    def has_holds(self) -> bool:
        """Some machine holds a part while tasks go on."""
        return bool(self.holds)

    @cached_property
    def held_from(self) -> tuple[tuple[int, ...], ...]:
        """Per task, the holds that begin with it."""
        return _by_task(len(self.tasks), (first for _, first, _ in self.holds))

    @cached_property
    def held_until(self) -> tuple[tuple[int, ...], ...]:
        """Per task, the holds that end with it."""
        return _by_task(len(self.tasks), (last for _, _, last in self.holds))

    @cached_property
    def rivals(self) -> tuple[int, ...]:
        """Per hold, bits of those that the same machine cannot have at the same time: one of the
        two would have to lie within the other.
        """
        ends = [bits({first, last} - {-1}) for _, first, last in self.holds]

        def apart(one: int, other: int) -> bool:
            nested = ends[one] & ~self.within[other] == 0 or ends[other] & ~self.within[one] == 0
            return one != other and self.holds[one][0] == self.holds[other][0] and not nested

        numbers = range(len(self.holds))
        return tuple(bits(other for other in numbers if apart(one, other)) for one in numbers)

    @cached_property
    def barred(self) -> tuple[int, ...]:
        """Per hold, bits of the tasks that the machine cannot do meanwhile."""
        return tuple(self.all_tasks & ~inside for inside in self.within)

    @cached_property
    def ahead_of_hold(self) -> tuple[int, ...]:
        """Per hold, bits of the tasks that must have begun before it: its last task waits for them,
        and once it has begun the machine could not do them any more.
        """
        found = []
        for hold, (operator, _, last) in enumerate(self.holds):
            before = self._ancestors(last) if last >= 0 else 0
            ahead = bits(
                task
                for task, ways in enumerate(self.ways)
                if (before & self.barred[hold]) >> task & 1
                and all(way.who >> operator & 1 for way in ways)
            )
            for other, (_, first, its_last) in enumerate(self.holds):
                if self.rivals[hold] >> other & 1 and first >= 0 and before >> first & 1:
                    ahead |= bits({its_last} - {-1})
            found.append(ahead)
        return tuple(found)

    def _ancestors(self, task: int) -> int:
        """Bits of the tasks that it waits for to end or to begin, directly or not."""
        found, pending = 0, [task]
        while pending:
            new = self.begun_first[pending.pop()] & ~found
            found |= new
            pending += [first for first in range(len(self.tasks)) if new >> first & 1]
        return found

    def is_barred(
        self, begun: int, over: int, task: int, who: int, *, wrong: int = 0, comes_off: bool = False
    ) -> bool:
        """Whether holds keep these operators (bits) from the task now.

        A machine that holds a part does nothing but what lies within the hold, and takes up no
        other part. A hold does not begin while a task is open that could then no longer be done.
        What only mistakes can bring about bars nothing: two holds of a machine that are open at
        once, and one that is open while such a task must be done again.

        Args:
          begun: bits of the tasks that have begun. over: of those that have ended; of these `wrong`
            are to be done again.
          comes_off: the task is not done but taken apart.
        """
        opened = 0
        for hold, (_, first, last) in enumerate(self.holds):
            if (first < 0 or begun >> first & 1) and (last < 0 or not over >> last & 1):
                opened |= 1 << hold
        new = bits(self.held_from[task])
        for hold in range(len(self.holds)):
            is_sound = not self.ahead_of_hold[hold] & (~begun | wrong)
            if opened >> hold & 1 and is_sound and not opened & self.rivals[hold]:
                operator = self.holds[hold][0]
                does = who >> operator & 1 and self.barred[hold] >> task & 1
                if does or new & self.rivals[hold]:
                    return True
        return not comes_off and any(
            self.ahead_of_hold[hold] & ~begun or new & self.rivals[hold]
            for hold in self.held_from[task]
        )

    @cached_property
    def is_plain(self) -> bool:
        """Tools, zones, holds, breaks and walking play no part in times."""
        if self.has_breaks or self.has_tools or self.has_preparations:
            return False
        if self.has_apart or self.has_holds:
            return False
        return max(self.timed_zone, default=-1) < 0

    @cached_property
    def arrival(self) -> tuple[int, ...]:
        """Per operator, ticks before which it does nothing, being off from the start."""
        return tuple(row[0][1] if row and row[0][0] <= 0 else 0 for row in self.breaks)

    @cached_property
    def horizon(self) -> int:
        """Ticks by which everything can end, if it can end at all.

        All tasks one after the other, with every wait, behind every release and break.
        """
        work = sum(max(way.ticks for way in ways) for ways in self.ways)
        swaps = max(self.longest_preparation) * len(self.tasks)
        waits = sum(end for breaks in self.breaks for _, end in breaks)
        lags = sum(lag.least for lag in self.lags)
        return work + swaps + waits + lags + max(self.release, default=0)

    @cached_property
    def tied(self) -> dict[int, tuple[int, ...]]:
        """Task -> all tasks of its group, for tasks that hang together in time: something must
        follow within a time, or a machine holds a part from one to another. Any other can be put
        off without limit.

        The groups are the strongly connected parts of what must come before what, with an arc back
        for each wait that has a most and for each hold.
        """
        if not (self.has_most_lags or self.has_holds):
            return {}
        arcs: list[set[int]] = [set(row) for row in self.behind]
        for lag in self.lags:
            arcs[lag.before].add(lag.task)
            if lag.most is not None:
                arcs[lag.task].add(lag.before)
        for _, first, last in self.holds:
            arcs[last].add(first)
        reached = [_reached(arcs, task) for task in range(len(arcs))]
        found = {}
        for task, there in enumerate(reached):
            group = tuple(other for other in sorted(there) if task in reached[other])
            if len(group) > 1:
                found[task] = group
        return found

    # ------------------------------------------------------------ back into words

    def seconds(self, ticks: int) -> float:
        """Ticks in seconds: the nearest float, which prints as the exact decimal."""
        return float(Decimal(ticks) / self.per_second)

    def stress(self, units: int) -> float:
        """Units in the cell's own measure of stress."""
        return float(Decimal(units) / self.per_stress)

    def schedule(self, starts: Iterable[tuple[int, int]]) -> Schedule:
        """Per task, in order, `(way, start in ticks)` -> the schedule in names and seconds."""
        rows = []
        for task, (way, start) in enumerate(starts):
            chosen = self.ways[task][way]
            rows.append(
                Assignment(
                    self.seconds(start),
                    self.seconds(start + chosen.ticks),
                    self.tasks[task],
                    tuple(self.operators[i] for i in chosen.operators),
                )
            )
        return Schedule(tuple(rows))

    def starts(self, schedule: Schedule) -> tuple[tuple[int, int], ...]:
        """Per task `(way, start in ticks)` of a sound schedule; starts between two ticks are cut
        down to the earlier one.
        """
        by_task = {a.task: a for a in schedule}
        starts = []
        for task, ways in enumerate(self.ways):
            row = by_task[self.tasks[task]]
            start, end = (
                int(Decimal(repr(moment)) * self.per_second) for moment in (row.start, row.end)
            )
            team = tuple(sorted(self.operators.index(name) for name in row.operators))
            starts.append(
                (
                    next(
                        w
                        for w, way in enumerate(ways)
                        if way.operators == team and way.ticks == end - start
                    ),
                    start,
                )
            )
        return tuple(starts)


def bits(numbers: Iterable[int]) -> int:
    """A set of whole numbers as bits: number `i` is bit `i`."""
    return sum(1 << number for number in numbers)


class _Count(NamedTuple):
    """How many ticks and units of stress there are in 1."""

    per_second: int
    per_stress: int

    def ticks(self, seconds: float) -> int:
        return _whole(seconds, self.per_second)

    def units(self, stress: float) -> int:
        return _whole(stress, self.per_stress)


def _tasks(cell: Cell, count: _Count, dues: Dues) -> dict[str, Any]:
    index = {name: i for i, name in enumerate(cell.tasks)}
    tasks = cell.tasks.values()
    table = cell.stress_of_set
    return {
        "tasks": tuple(cell.tasks),
        "ways": _ways(cell, count, dues),
        "before": tuple(tuple(index[a] for a in task.predecessors) for task in tasks),
        "lags": tuple(_lags(cell, count, index)),
        "release": tuple(count.ticks(task.release) for task in tasks),
        "deadline": tuple(
            None if task.deadline is None else count.ticks(task.deadline) for task in tasks
        ),
        "same_operator": tuple((index[a], index[b]) for a, b in cell.same_operator),
        "stress_of_set": table
        and {
            frozenset(index[name] for name in key.split(",") if name): count.units(value)
            for key, value in table.items()
        },
    }


def _lags(cell: Cell, count: _Count, index: dict[str, int]) -> Iterator[Lag]:
    for name, task in cell.tasks.items():
        for wait in task.wait:
            most = None if wait.at_most is None else count.ticks(wait.at_most)
            yield Lag(
                index[wait.after],
                index[name],
                wait.between == "start-start",
                count.ticks(wait.at_least),
                most,
            )


def _ways(cell: Cell, count: _Count, dues: Dues) -> tuple[tuple[Way, ...], ...]:
    number = {name: i for i, name in enumerate(cell.operators)}
    tool: dict[str | None, int | None] = {name: i for i, name in enumerate(cell.tool_names)}

    def way(mode: Mode, taken: tuple[tuple[int, int], ...]) -> Way:
        return Way(
            operators=tuple([number[who] for who in mode.operators]),
            ticks=count.ticks(mode.time),
            load=tuple([count.units(mode.stress.get(who, 0.0)) for who in mode.operators]),
            tools=tuple([tool.get(mode.tools.get(who)) for who in mode.operators]),
            dues=taken,
        )

    nothing: list[list[tuple[tuple[int, int], ...]]]
    nothing = [[()] * len(cell.modes(name)) for name in cell.tasks]
    return tuple(
        [
            tuple(map(way, cell.modes(name), taken))
            for name, taken in zip(cell.tasks, dues or nothing, strict=True)
        ]
    )


Dues = list[list[tuple[tuple[int, int], ...]]]
"""`[task][way]`, the dues of the way; empty where nobody has a limit."""


def _allowances(cell: Cell, count: _Count) -> tuple[tuple[Allowance, ...], Dues]:
    """What each limit leaves, and what each way takes of it."""
    if not any(x.stress_limit is not None or x.limits for x in cell.operators.values()):
        return (), []
    modes = [(task, mode) for task in cell.tasks for mode in cell.modes(task)]
    places = {who: number for number, who in enumerate(cell.operators)}
    allowances: list[Allowance] = []
    rows: list[list[tuple[int, int]]] = [[] for _ in modes]
    for name, limit in all_limits(cell):
        who = limit.who or ""
        stated = [limit.due(cell, *mode).get(who, Decimal(0)) for mode in modes]
        if name == OWN:
            units = [count.units(float(due)) for due in stated]
            most = min(count.units(float(limit.most)), sum(units))
        else:
            units, most = _in_units(stated, limit.room)
        for row, (_, mode), due in zip(rows, modes, units, strict=True):
            if who in mode.operators:
                row.append((len(allowances), due))
        allowances.append(Allowance(places[who], name, most))
    ways = iter(rows)
    return tuple(allowances), [[tuple(next(ways)) for _ in cell.modes(t)] for t in cell.tasks]


def _in_units(dues: Sequence[Decimal], room: Decimal) -> tuple[list[int], int]:
    """Dues and the room for them in whole numbers: exactly, or where decimals do not allow that
    with dues rounded up and the room rounded down, so that the limit is never exceeded.
    """
    highest = sum(dues, Decimal(0))
    # what is beyond all dues together binds nobody, and its decimals do not matter
    most = min(room, highest)
    scale, _ = scale_of([*dues, most], highest, MOST_DUE)
    return [up(due * scale) for due in dues], int(most * scale)


def _places(cell: Cell, count: _Count) -> dict[str, Any]:
    """A tool or a zone that the cell does not list exists once and costs nothing."""
    tools, zones = cell.tool_names, cell.zone_names
    place = {name: i for i, name in enumerate(cell.place_names)}
    tasks = cell.tasks.values()
    listed = [cell.tools.get(name, Tool()) for name in tools]
    return {
        "zone": tuple(None if task.zone is None else zones.index(task.zone) for task in tasks),
        "place": tuple(None if task.place is None else place[task.place] for task in tasks),
        "walk": tuple(_walk(cell, count, who) for who in cell.operators),
        "tool_places": tuple(tool.capacity for tool in listed),
        "zone_places": tuple(cell.zones.get(name, Zone()).capacity for name in zones),
        "zone_apart": tuple(
            tuple(
                apart.index(operator.kind) if operator.kind in apart else -1
                for operator in cell.operators.values()
            )
            for apart in (cell.zones.get(name, Zone()).apart for name in zones)
        ),
        "changeover": tuple(
            tuple(count.ticks(tool.changeover.get(who, 0.0)) for who in cell.operators)
            for tool in listed
        ),
    }


def _walk(cell: Cell, count: _Count, who: str) -> tuple[tuple[int, ...], ...]:
    """Ticks from each place to each."""
    places, times = cell.place_names, cell.walking.get(who)
    if not times:
        return ((0,) * len(places),) * len(places)
    return tuple(
        tuple(count.ticks(times.get((one, other), 0.0)) for other in places) for one in places
    )


def _operators(cell: Cell, count: _Count) -> dict[str, Any]:
    tools, places, operators = cell.tool_names, cell.place_names, cell.operators.values()
    return {
        "operators": tuple(cell.operators),
        "human": tuple(operator.kind == "human" for operator in operators),
        "in_hand": tuple(None if x.tool is None else tools.index(x.tool) for x in operators),
        "stands": tuple(None if x.place is None else places.index(x.place) for x in operators),
        "breaks": tuple(
            tuple((count.ticks(off.start), count.ticks(off.end)) for off in operator.times_off)
            for operator in operators
        ),
    }


def _holds(cell: Cell) -> dict[str, Any]:
    index = {name: i for i, name in enumerate(cell.tasks)}
    found = [
        (place, first, last)
        for place, operator in enumerate(cell.operators.values())
        for first, last in operator.holds
    ]
    return {
        "holds": tuple((place, index[first], index[last]) for place, first, last in found),
        "within": tuple(
            bits(index[name] for name in between(cell, first, last)) for _, first, last in found
        ),
    }


def _by_task(tasks: int, of_hold: Iterable[int]) -> tuple[tuple[int, ...], ...]:
    rows: list[list[int]] = [[] for _ in range(tasks)]
    for hold, task in enumerate(of_hold):
        if task >= 0:
            rows[task].append(hold)
    return tuple(map(tuple, rows))


def _teams(tasks: int, pairs: Iterable[tuple[int, int]]) -> tuple[int, ...]:
    """Per task, the number of its connected group of pairs, or -1."""
    root = list(range(tasks))

    def find(task: int) -> int:
        while root[task] != task:
            task = root[task]
        return task

    paired = set()
    for one, other in pairs:
        root[find(one)] = find(other)
        paired |= {one, other}
    return tuple(find(task) if task in paired else -1 for task in range(tasks))


def _topological(waited_for: Sequence[int], behind: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """The tasks in order, given for how many each waits, and which wait for it."""
    waiting = list(waited_for)
    ready = [task for task, count in enumerate(waiting) if count == 0]
    for task in ready:
        for after in behind[task]:
            waiting[after] -= 1
            if waiting[after] == 0:
                ready.append(after)
    return tuple(ready)


def _reached(arcs: Sequence[Iterable[int]], task: int) -> set[int]:
    """The tasks to which arcs lead from this one."""
    reached, pending = set[int](), [task]
    while pending:
        new = set(arcs[pending.pop()]) - reached
        reached |= new
        pending += new
    return reached


def scale_of(
    numbers: Sequence[Decimal], highest: Decimal | int, largest: int
) -> tuple[Decimal, bool]:
    """Units in 1, and whether they make every number whole: the least power of ten that does, or as
    many as keep `highest` below `largest`.
    """
    exponents = [number.normalize().as_tuple().exponent for number in numbers if number]
    scale = Decimal(10) ** max([0, *(-int(e) for e in exponents if int(e) < 0)])
    if highest * scale <= largest:
        return scale, True
    return Decimal(10) ** int((Decimal(largest) / highest).logb()), False


def up(number: Decimal) -> int:
    """The next whole number."""
    return int(number.to_integral_value(ROUND_CEILING))


def _whole(number: float, scale: int) -> int:
    """The decimal that the number prints as, times the scale that makes it whole."""
    return int(number) * scale if float(number).is_integer() else int(Decimal(repr(number)) * scale)


def _scale(numbers: Iterable[float]) -> int:
    """The smallest power of ten that makes every number whole."""
    exponents = (
        Decimal(repr(number)).normalize().as_tuple().exponent
        for number in set(numbers)  # of thousands most are said again and again
        if not float(number).is_integer()
    )
    scale: int = 10 ** max(
        (-int(exponent) for exponent in exponents if int(exponent) < 0), default=0
    )
    return scale


def _times_in(cell: Cell) -> Iterable[float]:
    for task in cell.tasks.values():
        yield from task.time.values()
        yield from (joint.time for joint in task.together)
        yield task.release
        if task.deadline is not None:
            yield task.deadline
        for wait in task.wait:
            yield wait.at_least
            yield wait.at_most or 0.0
    for tool in cell.tools.values():
        yield from tool.changeover.values()
    for table in cell.walking.values():
        yield from table.values()
    for operator in cell.operators.values():
        for off in operator.times_off:
            yield from (off.start, off.end)


def _stresses_in(cell: Cell) -> Iterable[float]:
    for name in cell.tasks:
        for mode in cell.modes(name):
            yield from mode.stress.values()
    yield from (
        operator.stress_limit
        for operator in cell.operators.values()
        if operator.stress_limit is not None
    )
    yield from (cell.stress_of_set or {}).values()
