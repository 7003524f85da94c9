"""A cell as arrays, and the rest of a product played many times at once by list scheduling.

The serial scheme (Kolisch 1996): tasks are looked at in one order, each by whoever is expected to
end it first. `rows` plays go side by side, each with its own order, paces and times. In NumPy.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import AWAY_S, awaited
from tandem.dispatch.deciders.policy import Start
from tandem.dispatch.situation.model import Situation

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Sheet:
    """A cell as arrays. `T` tasks, `W` ways, `O` operators, `R` tools and zones, `P` predecessors.

    Attributes:
      tasks, operators: names. `ways`: (task, operators) of each way.
      task: `[W]`, of each way. `slots`: `[T, S]`, the ways of each task, -1 where it has fewer.
      uses: `[W, O]` bool. `seconds`: `[W]`, stated; `sigma`: `[W]`, of the logarithm of the time.
      before: `[T, P]`, predecessors, T where it has fewer. `chain`: tasks, each before its
        predecessors. `quickest`: `[T]` s. `release`: `[T]` s.
      room: `[T, 2]`, its tool and zone as numbers, -1 for none; `places`: how many each has.
      tool: `[T]`, number of the tool that changeovers look at, -1 for none; `change`: `[O, tools]`.
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
    seconds: Array
    sigma: Array
    before: Array
    chain: tuple[int, ...]
    quickest: Array
    release: Array
    room: Array
    places: tuple[int, ...]
    tool: Array
    change: Array
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
    ways = [(task, way) for task in tasks for way in facts.ways[task]]
    number = {task: t for t, task in enumerate(tasks)}
    rows = [[w for w, (task, _) in enumerate(ways) if task == name] for name in tasks]
    slots = np.full((len(tasks), max(map(len, rows))), -1)
    for t, row in enumerate(rows):
        slots[t, : len(row)] = row
    needs = [[number[first] for first in task.after] for task in cell.tasks.values()]
    before = np.full((len(tasks), max(1, *map(len, needs))), len(tasks))
    for t, row in enumerate(needs):
        before[t, : len(row)] = row
    rooms: dict[tuple[str, str], int] = {}
    room = np.full((len(tasks), 2), -1)
    for t, task in enumerate(cell.tasks.values()):
        for column, (kind, name) in enumerate((("tool", task.tool), ("zone", task.zone))):
            if name is not None:
                room[t, column] = rooms.setdefault((kind, name), len(rooms))
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
    return Sheet(
        cell,
        tasks,
        operators,
        tuple((task, way.operators) for task, way in ways),
        np.array([number[task] for task, _ in ways]),
        slots,
        np.array([[who in way.operators for who in operators] for _, way in ways]),
        np.array([float(way.time) for _, way in ways]),
        np.array([sigma_of(cell, task, way.operators) for task, way in ways]),
        before,
        _chain(needs),
        np.array([min(float(way.time) for way in facts.ways[task]) for task in tasks]),
        np.array([float(task.release) for task in cell.tasks.values()]),
        room,
        tuple(places),
        np.array(
            [timed.index(task.tool) if task.tool in timed else -1 for task in cell.tasks.values()]
        ),
        np.array(
            [
                [float(cell.tools[tool].changeover.get(who, 0.0)) for tool in timed]
                for who in operators
            ]
        ).reshape(len(operators), len(timed)),
        np.array(team),
        tuple(
            tuple((off.start, off.end) for off in operator.times_off)
            for operator in cell.operators.values()
        ),
    )


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


def sigma_of(cell: Cell, task: str, operators: Sequence[str]) -> float:
    stated = cell.tasks[task].spread
    cv = max(stated.get(who, 0.0) for who in operators) if isinstance(stated, Mapping) else stated
    return math.sqrt(math.log1p(cv**2))


@dataclass(frozen=True)
class Rest:
    """What is left, seconds from now.

    Attributes:
      tasks: numbers of the tasks that have to begin still. `begins`: `[T]`, the way in which each
        begins now, -1 where it does not.
      busy: task under way -> `[O]` bool, who is at it.
      open: `[W]` bool, ways that are open. `share`: `[T]`, the share of its time that it takes,
        more than 1 where it comes apart before.
      release: `[T]`. `free`: `[O]`, when those who are away are back.
      hand: `[O]`, the timed tool in hand, -1 for none. `since`: `[O]`, when they have been able to
        take up another one.
      team: team -> the operators who do it, as `[O]` bool.
      off: operator and their breaks, where there are any.
    """

    tasks: tuple[int, ...]
    begins: Array
    busy: Mapping[str, Array]
    open: Array
    share: Array
    release: Array
    free: Array
    hand: Array
    since: Array
    team: Mapping[int, Array]
    off: tuple[tuple[int, tuple[tuple[float, float], ...]], ...]

    @classmethod
    def of(cls, sheet: Sheet, situation: Situation, begins: Sequence[Start]) -> Rest:
        """Reads the situation; `begins`: what was just decided to begin."""
        number = {task: t for t, task in enumerate(sheet.tasks)}
        left = [t for t, task in enumerate(sheet.tasks) if task not in situation.done]
        left = [
            t
            for t in left
            if sheet.tasks[t] not in situation.running or situation.running[sheet.tasks[t]].undoing
        ]
        refused = {pair for pair in situation.refused if situation.is_refused(*pair)}
        open_ = np.array(
            [not any((who, task) in refused for who in group) for task, group in sheet.ways]
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
        now = np.full(len(sheet.tasks), -1)
        for task, group in begins:
            now[number[task]] = sheet.ways.index((task, group))
        gone = situation.absent | situation.failed
        timed = [name for name, tool in sheet.cell.tools.items() if any(tool.changeover.values())]
        held = [situation.in_hand.get(who) for who in sheet.operators]
        begun = {task: one.operators for task, one in situation.done.items()}
        begun |= {task: one.operators for task, one in situation.running.items()}
        return cls(
            tuple(left),
            now,
            {task: _bits(sheet, at.operators) for task, at in situation.running.items()},
            open_,
            share,
            release,
            np.array([AWAY_S if who in gone else 0.0 for who in sheet.operators]),
            np.array([timed.index(tool) if tool in timed else -1 for tool in held]),
            np.array([situation.since.get(who, 0.0) - situation.now for who in sheet.operators]),
            {
                int(sheet.team[number[task]]): _bits(sheet, group)
                for task, group in begun.items()
                if sheet.team[number[task]] >= 0
            },
            tuple(
                (number, tuple((a - situation.now, b - situation.now) for a, b in row))
                for number, row in enumerate(sheet.off)
                if row
            ),
        )


def _bits(sheet: Sheet, operators: Sequence[str]) -> Array:
    return np.array([who in operators for who in sheet.operators])


def played(
    sheet: Sheet,
    rest: Rest,
    orders: Array,
    liking: Array,
    steady: Array,
    real: Array,
    running: Mapping[str, Array],
) -> Array:
    """`[rows]` s from now until everything has ended, in each play.

    Args:
      orders: `[rows, n]`, the tasks in the order in which they are looked at.
      liking, steady, real: `[rows, W]`, s: what each way counts as longer, and takes, expected and
        really.
      running: task under way -> `[rows]`, when it ends.
    """
    play = _Play(sheet, rest, len(real))
    for name, ends in running.items():
        play.going(name, ends)
    for task in orders.T:
        way, start = play.chosen(task, liking, steady)
        play.put(task, way, start + rest.share[task] * real[play.line, way])
    return play.end.max(axis=1)


class _Play:
    """Plays under way.

    Attributes:
      end: `[rows, T + 1]`, when each task ends. `ready`: `[rows, T]`, before which it cannot begin.
      free: `[rows, O]`, when each operator is free. `taken`: per tool or zone, `[rows, places]`,
        until when each place is taken, sorted.
      hand, since: `[rows, O]`. `team`: `[rows, teams, O]` bool.
    """

    def __init__(self, sheet: Sheet, rest: Rest, rows: int) -> None:
        self.sheet, self.rest, self.line = sheet, rest, np.arange(rows)
        self.end = np.zeros((rows, len(sheet.tasks) + 1))
        self.ready = np.tile(rest.release, (rows, 1))
        self.free = np.tile(rest.free, (rows, 1))
        self.taken = [np.zeros((rows, places)) for places in sheet.places]
        self.hand, self.since = np.tile(rest.hand, (rows, 1)), np.tile(rest.since, (rows, 1))
        teams = np.zeros((int(sheet.team.max()) + 1, len(sheet.operators)), bool)
        for number, who in rest.team.items():
            teams[number] = who
        self.team = np.tile(teams, (rows, 1, 1))

    def going(self, name: str, ends: Array) -> None:
        """The task is under way and ends then; where it is being taken apart, it is open then."""
        task, uses = self.sheet.tasks.index(name), self.rest.busy[name]
        if task in self.rest.tasks:
            self.ready[:, task] = np.maximum(self.ready[:, task], ends)
        else:
            self.end[:, task] = ends
        self._occupy(np.full(len(ends), task), np.tile(uses, (len(ends), 1)), ends)

    def chosen(self, task: Array, liking: Array, steady: Array) -> tuple[Array, Array]:
        """`[rows]` each: the way in which the task (`[rows]`) is done, and when it starts."""
        sheet, rest, line = self.sheet, self.rest, self.line
        ready = np.maximum(
            self.ready[line, task], self.end[line[:, None], sheet.before[task]].max(axis=1)
        )
        hands = self._hands_free(task)
        way, begin = np.full(len(line), -1), np.zeros(len(line))
        best = np.full(len(line), np.inf)
        for slot in range(sheet.slots.shape[1]):
            one = sheet.slots[task, slot]
            uses, takes = sheet.uses[one], rest.share[task] * steady[line, one]
            start = np.maximum(ready, np.where(uses, hands, 0.0).max(axis=1))
            start = self._behind_breaks(self._with_room(task, uses, start), uses, takes)
            # whoever is not in the team, or refuses, is taken only where nobody else is left
            score = start + takes + liking[line, one]
            score = np.where(self._fits(task, one, uses), score, score + 1e9)
            better = (one >= 0) & (score < best)
            way, begin = np.where(better, one, way), np.where(better, start, begin)
            best = np.where(better, score, best)
        return way, begin

    def put(self, task: Array, way: Array, end: Array) -> None:
        """The task is done in this way, until then."""
        sheet, uses = self.sheet, self.sheet.uses[way]
        self.end[self.line, task] = end
        self._occupy(task, uses, end)
        team = sheet.team[task]
        mine = team >= 0
        if mine.any():
            self.team[self.line[mine], team[mine]] = uses[mine]

    def _occupy(self, task: Array, uses: Array, end: Array) -> None:
        self.free = np.where(uses, end[:, None], self.free)
        self.since = np.where(uses, end[:, None], self.since)
        tool = self.sheet.tool[task]
        if (tool >= 0).any():
            self.hand = np.where(uses & (tool >= 0)[:, None], tool[:, None], self.hand)
        count = uses.sum(axis=1)
        for number, places in enumerate(self.taken):
            wants = (self.sheet.room[task] == number).any(axis=1)
            if wants.any():
                takes = wants[:, None] & (np.arange(places.shape[1]) < count[:, None])
                self.taken[number] = np.sort(np.where(takes, end[:, None], places), axis=1)

    def _hands_free(self, task: Array) -> Array:
        """`[rows, O]`, when each could begin the task, its tool in hand."""
        tool = self.sheet.tool[task][:, None]
        if (tool < 0).all():
            return self.free
        swaps = (tool >= 0) & (self.hand >= 0) & (self.hand != tool)
        change = self.sheet.change.T[np.maximum(tool[:, 0], 0)]
        return np.maximum(self.free, np.where(swaps, self.since + change, 0.0))

    def _with_room(self, task: Array, uses: Array, start: Array) -> Array:
        count = uses.sum(axis=1)
        for number, places in enumerate(self.taken):
            wants = (self.sheet.room[task] == number).any(axis=1)
            if wants.any():
                last = np.clip(count, 1, places.shape[1]) - 1
                start = np.where(wants, np.maximum(start, places[self.line, last]), start)
        return start

    def _behind_breaks(self, start: Array, uses: Array, takes: Array) -> Array:
        for operator, off in self.rest.off:
            for begin, end in off:
                runs_in = uses[:, operator] & (start < end) & (start + takes > begin)
                start = np.where(runs_in, end, start)
        return start

    def _fits(self, task: Array, way: Array, uses: Array) -> Array:
        first, team = self.rest.begins[task], self.sheet.team[task]
        fits = np.where(first >= 0, way == first, self.rest.open[way])
        if (team >= 0).any():
            who = self.team[self.line, np.maximum(team, 0)]
            bound = (team >= 0) & who.any(axis=1)
            fits &= ~bound | (who == uses).all(axis=1)
        return np.asarray(fits)
