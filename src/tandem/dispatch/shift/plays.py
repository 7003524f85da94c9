"""A cell as arrays, and the rest of a product played many times at once by list scheduling.

The serial scheme (Kolisch 1996): tasks are looked at in one order, each by whoever is expected to
end it first. `rows` plays go side by side, each with its own order, paces and times. In NumPy.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import AWAY_S, awaited
from tandem.dispatch.deciders.policy import Start
from tandem.dispatch.situation.legal import waited_from
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.pace import sigma_of
from tandem.schedule.queues import KINDS

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Sheet:
    """A cell as arrays. `T` tasks, `W` ways, `O` operators, `R` tools and zones, `P` predecessors.

    Attributes:
      tasks, operators: names. `ways`: (task, operators) of each way.
      task: `[W]`, of each way. `slots`: `[T, S]`, the ways of each task, -1 where it has fewer.
      uses: `[W, O]` bool. `crew`: `[W, C]`, its operators, O for nobody; `size`: `[W]`, how many;
        `group`: `[W]`, a number for each set of operators.
      seconds, stress: `[W]`, stated. `sigma`: `[W]`, of the logarithm of the time.
      before: `[T, P]`, predecessors, T where it has fewer; `firsts`: with those whose start it
        waits from. `chain`: tasks, each before its `firsts`. `waits`: (task, the one that it waits
        after, whether from that one's start, s at least). `quickest`: `[T]` s. `release`: `[T]` s.
      room: `[W, K]`, its zone and its tools as numbers, -1 for none; `takes`: `[W, K]`, how many
        places of each. `places`: how many each has; `capacity`: the same, 1 for none.
      tool: `[W, C]`, number of the tool that changeovers look at, -1 for none; `change`:
        `[O + 1, tools]` s.
      place: `[T]`, where it is done, -1 for anywhere; `walk`: `[O + 1, P, P]` s, from the first
        place to the second.
      team: `[T]`, tasks of one number are done by the same operators; -1 for none.
      off: per operator, its breaks.
    """

    cell: Cell
    tasks: tuple[str, ...]
    operators: tuple[str, ...]
    ways: tuple[Start, ...]
    task: Array
    slots: Array
    uses: Array
    crew: Array
    size: Array
    group: Array
    seconds: Array
    stress: Array
    sigma: Array
    before: Array
    firsts: Array
    chain: tuple[int, ...]
    waits: tuple[tuple[int, int, bool, float], ...]
    quickest: Array
    release: Array
    room: Array
    takes: Array
    places: tuple[int, ...]
    capacity: Array
    tool: Array
    change: Array
    place: Array
    walk: Array
    team: Array
    off: tuple[tuple[tuple[float, float], ...], ...]


@lru_cache(maxsize=16)
def _kept_sheets(digest: str) -> dict[str, Sheet]:
    """Where the sheet of the cell of this digest is kept."""
    return {}


def sheet_of(cell: Cell) -> Sheet:
    kept = _kept_sheets(cell.digest)
    if "sheet" not in kept:
        kept["sheet"] = _made(cell)
    return kept["sheet"]


def _made(cell: Cell) -> Sheet:
    tasks, operators = tuple(cell.tasks), tuple(cell.operators)
    facts = Situation.of(cell).facts
    # all of them: the floor may report what no schedule can hold
    ways = [(task, way) for task in tasks for way in cell.modes(task)]
    number = {task: t for t, task in enumerate(tasks)}
    rows = [[w for w, (task, _) in enumerate(ways) if task == name] for name in tasks]
    slots = np.full((len(tasks), max(map(len, rows))), -1)
    for t, row in enumerate(rows):
        slots[t, : len(row)] = row
    needs = [[number[first] for first in task.predecessors] for task in cell.tasks.values()]
    firsts = [[number[first] for first in task.begun_first] for task in cell.tasks.values()]
    rooms: dict[tuple[str, str], int] = {}
    taken = [
        Counter(
            (kind, name)
            for kind in KINDS
            for name in cell.takes(kind, task, way.operators).values()
        )
        for task, way in ways
    ]
    room = np.full((len(ways), max(map(len, taken))), -1)
    takes = np.ones(room.shape, int)
    for w, things in enumerate(taken):
        for column, (thing, count) in enumerate(things.items()):
            room[w, column], takes[w, column] = rooms.setdefault(thing, len(rooms)), count
    tables: dict[str, Mapping[str, Any]] = {"tool": cell.tools, "zone": cell.zones}
    places = [tables[kind][name].capacity if name in tables[kind] else 1 for kind, name in rooms]
    timed = [name for name, tool in cell.tools.items() if any(tool.changeover.values())]
    teams: dict[frozenset[str], int] = {}
    team = [
        teams.setdefault(frozenset({task, *facts.team[task]}), len(teams))
        if facts.team[task]
        else -1
        for task in tasks
    ]
    crew = np.full((len(ways), max(len(way.operators) for _, way in ways)), len(operators))
    tool = np.full(crew.shape, -1)
    for w, (_, way) in enumerate(ways):
        for seat, who in enumerate(way.operators):
            crew[w, seat] = operators.index(who)
            if way.tools.get(who) in timed:
                tool[w, seat] = timed.index(way.tools[who])
    change = np.zeros((len(operators) + 1, len(timed)))
    change[:-1] = np.array(
        [[float(cell.tools[name].changeover.get(who, 0.0)) for name in timed] for who in operators]
    ).reshape(len(operators), len(timed))
    spots = {name: number for number, name in enumerate(cell.place_names)} if cell.walk else {}
    walk = np.zeros((len(operators) + 1, len(spots), len(spots)))
    for who, ways_of in cell.walking.items():
        for (one, other), seconds in ways_of.items():
            walk[operators.index(who), spots[one], spots[other]] = seconds
    groups: dict[tuple[str, ...], int] = {}
    return Sheet(
        cell,
        tasks,
        operators,
        tuple((task, way.operators) for task, way in ways),
        np.array([number[task] for task, _ in ways]),
        slots,
        np.array([[who in way.operators for who in operators] for _, way in ways]),
        crew,
        np.array([len(way.operators) for _, way in ways]),
        np.array([groups.setdefault(way.operators, len(groups)) for _, way in ways]),
        np.array([float(way.time) for _, way in ways]),
        np.array([float(sum(way.stress.values())) for _, way in ways]),
        np.array([sigma_of(cell, task, way.operators) for task, way in ways]),
        _table(needs),
        _table(firsts),
        _chain(firsts),
        tuple(
            (t, number[wait.after], wait.between == "start-start", wait.at_least)
            for t, task in enumerate(cell.tasks.values())
            for wait in task.wait
        ),
        np.array([min(float(way.time) for way in facts.ways[task]) for task in tasks]),
        np.array([float(task.release) for task in cell.tasks.values()]),
        room,
        takes,
        tuple(places),
        np.array([*places, 1]),
        tool,
        change,
        np.array([spots.get(task.place or "", -1) for task in cell.tasks.values()]),
        walk,
        np.array(team),
        tuple(
            tuple((off.start, off.end) for off in operator.times_off)
            for operator in cell.operators.values()
        ),
    )


def _table(needs: Sequence[Sequence[int]]) -> Array:
    """`[T, P]`, the rows, T where one is shorter."""
    table = np.full((len(needs), max(1, *map(len, needs))), len(needs))
    for t, row in enumerate(needs):
        table[t, : len(row)] = row
    return table


def _chain(needs: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """The tasks, each before its predecessors."""
    left, found = [0] * len(needs), list[int]()
    for row in needs:
        for first in row:
            left[first] += 1
    open_ = [t for t, count in enumerate(left) if not count]
    while open_:
        found.append(open_.pop())
        for first in needs[found[-1]]:
            left[first] -= 1
            if not left[first]:
                open_.append(first)
    return tuple(found)


@dataclass(frozen=True)
class Rest:
    """What is left, seconds from now.

    Attributes:
      tasks: numbers of the tasks that have to begin still. `begins`: `[T]`, the way in which each
        begins now or is planned, -1 where neither is so; `first`: `[T]`, how far it comes first.
      busy: task under way -> who is at it.
      open: `[W]` bool, ways that are open. `share`: `[T]`, the share of its time that it takes,
        more than 1 where it comes apart before.
      release: `[T]`. `free`: `[O]`, when those who are away are back.
      hand: `[O]`, the timed tool in hand, -1 for none; `at`: `[O]`, the place, -1 for anywhere.
        `since`: `[O]`, when they have been able to get ready for other work.
      team: `[teams]`, the crew that does it, -1 before it has begun.
      off: operator and their breaks, where there are any.
    """

    tasks: tuple[int, ...]
    begins: Array
    first: Array
    busy: Mapping[str, tuple[str, ...]]
    open: Array
    share: Array
    release: Array
    free: Array
    hand: Array
    at: Array
    since: Array
    team: Array
    off: tuple[tuple[int, tuple[tuple[float, float], ...]], ...]

    @classmethod
    def of(
        cls, sheet: Sheet, situation: Situation, begins: Sequence[Start], order: Sequence[Start]
    ) -> Rest:
        """Reads the situation.

        Args:
          begins: what was just decided to begin.
          order: of the plan that is carried out; empty where there is none.
        """
        number = {task: t for t, task in enumerate(sheet.tasks)}
        left = [t for t, task in enumerate(sheet.tasks) if task not in situation.done]
        left = [
            t
            for t in left
            if sheet.tasks[t] not in situation.running or situation.running[sheet.tasks[t]].undoing
        ]
        refused = {pair for pair in situation.refused if situation.is_refused(*pair)}
        ways = situation.facts.ways
        possible = {(task, way.operators) for task, modes in ways.items() for way in modes}
        open_ = np.array(
            [
                (task, group) in possible and not any((who, task) in refused for who in group)
                for task, group in sheet.ways
            ]
        )
        for row in sheet.slots:
            mine = row[row >= 0]
            if not open_[mine].any():
                open_[mine] = True
        share = np.ones(len(sheet.tasks))
        share[[number[task] for task in situation.wrong if task not in situation.running]] += (
            situation.taking_apart
        )
        release = np.maximum(0.0, sheet.release - situation.now)
        for task, back in awaited(situation).items():
            release[number[task]] = max(release[number[task]], back - situation.now)
        for task, others in ((task, situation.cell.tasks[task].wait) for task in situation.open):
            for wait in others if task not in situation.wrong else ():
                if (moment := waited_from(situation, wait)) is not None:
                    over = moment + wait.at_least - situation.now
                    release[number[task]] = max(release[number[task]], over)
        now, first = np.full(len(sheet.tasks), -1), np.zeros(len(sheet.tasks))
        way_of = {(task, frozenset(group)): way for way, (task, group) in enumerate(sheet.ways)}
        for place, (task, group) in enumerate(order):
            now[number[task]] = way_of[task, frozenset(group)]
            first[number[task]] = 1e8 * (len(order) - place)
        for task, group in begins:
            now[number[task]] = way_of[task, frozenset(group)]
            first[number[task]] = 1e8 * (len(sheet.tasks) + 1)
        gone = situation.absent | situation.failed
        timed = [name for name, tool in sheet.cell.tools.items() if any(tool.changeover.values())]
        held = [situation.in_hand.get(who) for who in sheet.operators]
        spots = {name: number for number, name in enumerate(sheet.cell.place_names)}
        at = [
            spots.get(situation.stands.get(who, ""), -1) if sheet.cell.walk else -1
            for who in sheet.operators
        ]
        begun = {task: one.operators for task, one in situation.done.items()}
        begun |= {task: one.operators for task, one in situation.running.items()}
        team = np.full(int(sheet.team.max()) + 1, -1)
        # the floor may report who can do none of the team's tasks: then the team is still open
        known = {frozenset(group): sheet.group[way] for way, (_, group) in enumerate(sheet.ways)}
        for task, group in begun.items():
            if sheet.team[number[task]] >= 0:
                team[sheet.team[number[task]]] = known.get(frozenset(group), -1)
        return cls(
            tuple(left),
            now,
            first,
            {task: at.operators for task, at in situation.running.items()},
            open_,
            share,
            release,
            np.array([AWAY_S if who in gone else 0.0 for who in sheet.operators]),
            np.array([timed.index(tool) if tool in timed else -1 for tool in held]),
            np.array(at),
            np.array([situation.since.get(who, 0.0) - situation.now for who in sheet.operators]),
            team,
            tuple(
                (number, tuple((a - situation.now, b - situation.now) for a, b in row))
                for number, row in enumerate(sheet.off)
                if row
            ),
        )


def played(
    sheet: Sheet,
    rest: Rest,
    orders: Array,
    liking: Array,
    steady: Array,
    real: Array,
    running: Mapping[str, Array],
) -> tuple[Array, Array]:
    """`[rows]` s from now until everything has ended, and the stress of what is still to begin, in
    each play.

    Args:
      orders: `[rows, n]`, the tasks in the order in which they are looked at.
      liking, steady, real: `[rows, W]`, s: what each way counts as longer, and takes, expected and
        really.
      running: task under way -> `[rows]`, when it ends.
    """
    play, stress = _Play(sheet, rest, len(real)), np.zeros(len(real))
    for name, ends in running.items():
        play.going(name, ends)
    for task in orders.T:
        way, start = play.chosen(task, liking, steady)
        play.put(task, way, start, start + rest.share[task] * real[play.line, way])
        stress += sheet.stress[way]
    return np.asarray(play.end.max(axis=0)), stress


def along_the_clock(
    sheet: Sheet,
    rest: Rest,
    rank: Array,
    steady: Array,
    real: Array,
    running: Mapping[str, Array],
) -> Array:
    """`[rows, n]`: the tasks in the order in which a rule looks at them as time goes on (Kolisch's
    parallel scheme): whatever can start first, of these the one of the highest `rank`, `[T]`. The
    rest as in `played`.
    """
    play, line = _Play(sheet, rest, len(real)), np.arange(len(real))
    for name, ends in running.items():
        play.going(name, ends)
    left = np.zeros((len(sheet.tasks) + 1, len(real)), bool)
    left[list(rest.tasks)] = True
    never, found = np.zeros(real.shape), []
    for _ in rest.tasks:
        waits = left[sheet.firsts].any(axis=1) | ~left[:-1]
        key = play.earliest(steady) - 1e-6 * rank[:, None] - rest.first[:, None]
        task = np.where(waits, np.inf, key).argmin(axis=0)
        way, start = play.chosen(task, never, steady)
        play.put(task, way, start, start + rest.share[task] * real[line, way])
        left[task, line] = False
        found.append(task)
    return np.array(found, dtype=int).reshape(len(rest.tasks), len(real)).T


class _Play:
    """Plays under way; the last axis is the play. One operator more than there are stands for
    nobody.

    Attributes:
      end: `[T + 1, rows]`, when each task ends. `ready`: `[T, rows]`, before which it cannot begin.
      free: `[O + 1, rows]`, when each operator is free.
      taken: `[R + 1, places, rows]`, until when each place of a tool or zone is taken, sorted, for
        ever where it has fewer places; the last row stands for neither and is always free.
      hand, at: `[O + 1, rows]`, the timed tool in hand and the place; `since`: when they could get
        ready for other work.
      team: `[teams, rows]`, the crew of each, -1 before it has begun.
    """

    def __init__(self, sheet: Sheet, rest: Rest, rows: int) -> None:
        self.sheet, self.rest, self.line = sheet, rest, np.arange(rows)
        self.end = np.zeros((len(sheet.tasks) + 1, rows))
        self.ready = np.repeat(rest.release[:, None], rows, axis=1)
        self.free = _with_nobody(rest.free, rows)
        most = max(sheet.places, default=1)
        self.taken = np.full((len(sheet.places) + 1, most, rows), -np.inf)
        for number, places in enumerate(sheet.places):
            self.taken[number, :places], self.taken[number, places:] = 0.0, np.inf
        self.hand, self.since = _with_nobody(rest.hand, rows), _with_nobody(rest.since, rows)
        self.at = _with_nobody(rest.at, rows)
        self.has_teams, self.has_swaps = bool((sheet.team >= 0).any()), sheet.change.shape[1] > 0
        self.has_walks = sheet.walk.shape[1] > 0
        self.team = np.repeat(rest.team[:, None], rows, axis=1)

    def going(self, name: str, ends: Array) -> None:
        """The task is under way and ends then; where it is being taken apart, it is open then."""
        task = self.sheet.tasks.index(name)
        if task in self.rest.tasks:
            self.ready[task] = np.maximum(self.ready[task], ends)
        else:
            self.end[task] = ends
            for after, first, of_start, least in self.sheet.waits:
                if first == task and not of_start:
                    self.ready[after] = np.maximum(self.ready[after], ends + least)
        way = self.sheet.ways.index((name, self.rest.busy[name]))
        self._occupy(np.full(len(ends), task), np.full(len(ends), way), ends)

    def chosen(self, task: Array, liking: Array, steady: Array) -> tuple[Array, Array]:
        """`[rows]` each: the way in which the task (`[rows]`) is done, and when it starts."""
        sheet, line = self.sheet, self.line
        ready = np.maximum(self.ready[task, line], self.end[sheet.before[task].T, line].max(axis=0))
        share = self.rest.share[task]
        way, begin, best = self.line, ready, np.full(len(line), np.inf)
        for slot in range(sheet.slots.shape[1]):
            one = sheet.slots[task, slot]
            takes, start = share * steady[line, one], ready
            for seat, crew in enumerate(sheet.crew[one].T):
                start = np.maximum(start, self._hands_free(one, seat, crew))
            start = self._behind_breaks(self._with_room(one, start), one, takes)
            # whoever is not in the team, or refuses, is taken only where nobody else is left
            score = start + takes + liking[line, one] + np.where(self._fits(task, one), 0.0, 1e9)
            better = (one >= 0) & (score < best)
            way, begin = np.where(better, one, way), np.where(better, start, begin)
            best = np.where(better, score, best)
        return way, begin

    def earliest(self, steady: Array) -> Array:
        """`[T, rows]`, when each task could start by whoever is expected to end it first, were its
        predecessors done; tools, zones and breaks left aside.
        """
        sheet = self.sheet
        ready = np.maximum(self.ready, self.end[sheet.before].max(axis=1))
        begin, best = ready, np.full(ready.shape, np.inf)
        for column in sheet.slots.T:
            start = ready
            for crew in sheet.crew[column].T:
                start = np.maximum(start, self.free[crew])
            end = start + self.rest.share[:, None] * steady[:, column].T
            better = ((column >= 0) & self.rest.open[column])[:, None] & (end < best)
            begin, best = np.where(better, start, begin), np.where(better, end, best)
        return begin

    def put(self, task: Array, way: Array, start: Array, end: Array) -> None:
        """The task is done in this way, from then until then."""
        self.end[task, self.line] = end
        for after, first, of_start, least in self.sheet.waits:
            moment = np.where(task == first, (start if of_start else end) + least, -np.inf)
            self.ready[after] = np.maximum(self.ready[after], moment)
        self._occupy(task, way, end)
        if self.has_teams:
            team = self.sheet.team[task]
            mine = team >= 0
            self.team[team[mine], self.line[mine]] = self.sheet.group[way[mine]]

    def _occupy(self, task: Array, way: Array, end: Array) -> None:
        sheet, line = self.sheet, self.line
        for seat, crew in enumerate(sheet.crew[way].T):
            self.free[crew, line] = end
            if self.has_swaps or self.has_walks:
                self.since[crew, line] = end
            if self.has_swaps:
                tool = sheet.tool[way, seat]
                self.hand[crew, line] = np.where(tool >= 0, tool, self.hand[crew, line])
            if self.has_walks:
                place = sheet.place[task]
                self.at[crew, line] = np.where(place >= 0, place, self.at[crew, line])
        self.free[-1] = -np.inf
        for room, count in zip(sheet.room[way].T, sheet.takes[way].T, strict=True):
            places = self.taken[room, :, line]
            fills = np.arange(places.shape[1]) < count[:, None]
            self.taken[room, :, line] = np.sort(np.where(fills, end[:, None], places), axis=1)
            self.taken[-1] = -np.inf

    def _hands_free(self, way: Array, seat: int, crew: Array) -> Array:
        """`[rows]`, when the operators `crew`, who have this seat in the way, could begin it: where
        it is done, and their tool in hand.
        """
        free = self.free[crew, self.line]
        if not self.has_swaps and not self.has_walks:
            return free
        sheet, before = self.sheet, np.zeros(len(self.line))
        if self.has_swaps:
            tool, hand = sheet.tool[way, seat], self.hand[crew, self.line]
            swaps = (tool >= 0) & (hand >= 0) & (hand != tool)
            before += np.where(swaps, sheet.change[crew, np.maximum(tool, 0)], 0.0)
        if self.has_walks:
            place, at = (
                sheet.place[sheet.task[way]],
                np.maximum(self.at[crew, self.line], -1).astype(int),
            )
            there = sheet.walk[crew, np.maximum(at, 0), np.maximum(place, 0)]
            before += np.where((place >= 0) & (at >= 0), there, 0.0)
        ready = self.since[crew, self.line] + before
        return np.maximum(free, np.where(before > 0, ready, -np.inf))

    def _with_room(self, way: Array, start: Array) -> Array:
        sheet = self.sheet
        for room, count in zip(sheet.room[way].T, sheet.takes[way].T, strict=True):
            last = np.minimum(count, sheet.capacity[room]) - 1
            start = np.maximum(start, self.taken[room, last, self.line])
        return start

    def _behind_breaks(self, start: Array, way: Array, takes: Array) -> Array:
        for operator, off in self.rest.off:
            for begin, end in off:
                mine = self.sheet.uses[way, operator]
                start = np.where(mine & (start < end) & (start + takes > begin), end, start)
        return start

    def _fits(self, task: Array, way: Array) -> Array:
        first = self.rest.begins[task]
        fits = np.where(first >= 0, way == first, self.rest.open[way])
        if self.has_teams:
            number = self.sheet.team[task]
            crew = self.team[np.maximum(number, 0), self.line]
            fits &= (number < 0) | (crew < 0) | (crew == self.sheet.group[way])
        return np.asarray(fits)


def _with_nobody(values: Array, rows: int) -> Array:
    """`[O + 1, rows]`: the value of each operator, and of nobody, who never stands in the way."""
    return np.repeat(np.append(values.astype(float), -np.inf)[:, None], rows, axis=1)
