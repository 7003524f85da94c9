"""Two yardsticks that know nothing of Tandem: they read a cell as plain data and try everything.

They share no line, no number and no rule with the package: times and stress are counted in
millionths from the decimals that stand in the cell, and what a schedule may do is said here once
more. Both are slow; a handful of tasks are many.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import gcd
from typing import Any, NamedTuple

Point = tuple[float, float]
"""Makespan in seconds, stress."""
Pair = tuple[int, int]
"""The same in millionths."""
MILLION = 1_000_000


class Way(NamedTuple):
    """One way of doing a task: who, for how long, the stress on each human who takes part, and who
    needs which tool.
    """

    who: tuple[str, ...]
    time: int
    strain: dict[str, int]
    tools: dict[str, str]


@dataclass(frozen=True)
class Step:
    """A task in the making: what is known of it in millionths of a second."""

    name: str
    way: Way
    start: int

    @property
    def end(self) -> int:
        return self.start + self.way.time


class Gap(NamedTuple):
    """What must lie between another task's end, or start, and the start of this one."""

    first: str
    of_start: bool
    least: int
    most: int | None


@dataclass(frozen=True)
class Job:
    """One task as the cell states it."""

    name: str
    ways: tuple[Way, ...]
    after: tuple[str, ...]
    release: int
    deadline: int | None
    zone: str | None
    place: str | None
    gaps: tuple[Gap, ...] = ()

    @property
    def first(self) -> set[str]:
        """Tasks without which it cannot begin."""
        return {*self.after, *(gap.first for gap in self.gaps)}


class Plain:
    """A cell read from plain data, as its file holds it."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.kind = {name: entry["kind"] for name, entry in data["operators"].items()}
        self.breaks = {
            name: sorted((_millionths(a), _millionths(b)) for a, b in entry.get("breaks") or ())
            for name, entry in data["operators"].items()
        }
        self.setup = {
            name: _millionths(entry.get("setup", 0)) for name, entry in data["operators"].items()
        }
        self.ready = {name: self._set_up(name) for name in self.kind}
        self.limit = {
            name: _millionths(entry["stress_limit"])
            for name, entry in data["operators"].items()
            if entry.get("stress_limit") is not None
        }
        self.limits = [
            (name, *named.split(":"), Fraction(repr(float(most))))
            for name, entry in data["operators"].items()
            for named, most in (entry.get("limits") or {}).items()
        ]
        self.cycles = Fraction(repr(float(data.get("cycles_per_shift") or 1)))
        self.assessed = {
            str(name): list(entry.get("ergonomics") or ()) for name, entry in data["tasks"].items()
        }
        self.holds = [
            (name, str(first), str(last))
            for name, entry in data["operators"].items()
            for first, last in entry.get("holds") or ()
        ]
        self.in_hand = {name: entry.get("tool") for name, entry in data["operators"].items()}
        self.jobs = {
            str(name): self._job(str(name), entry) for name, entry in data["tasks"].items()
        }
        tools, zones = data.get("tools") or {}, data.get("zones") or {}
        self.places = {
            kind: {name: entry.get("capacity", 1) for name, entry in table.items()}
            for kind, table in (("tool", tools), ("zone", zones))
        }
        self.apart = {name: tuple(entry.get("apart") or ()) for name, entry in zones.items()}
        self.change = {
            (name, who): _millionths(seconds)
            for name, entry in tools.items()
            for who, seconds in (entry.get("changeover") or {}).items()
        }
        self.stands = {name: entry.get("place") for name, entry in data["operators"].items()}
        self.walk = walks_of(data)
        self.pairs = [(str(a), str(b)) for a, b in data.get("same_operator") or ()]
        table = data.get("stress_of_set")
        self.table = table if table is None else {
            frozenset(filter(None, str(names).split(","))): _millionths(value) for names,
            value in table.items()
        }  # fmt: skip

    def _set_up(self, name: str) -> int:
        """The first moment at which so long a piece of time without a break lies behind the
        operator; 0 when none is needed.
        """
        long = self.setup[name]
        begins = [0, *(back for _, back in self.breaks[name])]
        fits = (
            begin
            for begin in begins
            if not any(off < begin + long and begin < back for off, back in self.breaks[name])
        )
        return min(fits) + long if long else 0

    def _job(self, name: str, entry: Mapping[str, Any]) -> Job:
        stress, tool = entry.get("stress", 0), entry.get("tool")
        ways = [
            Way((who,), _millionths(time), self._strain((who,), stress), _hands((who,), tool))
            for who, time in (entry.get("time") or {}).items()
        ]
        for joint in entry.get("together") or ():
            who = tuple(joint["operators"])
            own = stress if joint.get("stress") is None else joint["stress"]
            hands = _hands(who, tool if joint.get("tool") is None else joint["tool"])
            ways.append(Way(who, _millionths(joint["time"]), self._strain(who, own), hands))
        deadline = entry.get("deadline")
        return Job(
            name,
            tuple(ways),
            tuple(str(first) for first in entry.get("after") or ()),
            _millionths(entry.get("release", 0)),
            None if deadline is None else _millionths(deadline),
            entry.get("zone"),
            entry.get("place"),
            tuple(_gaps(entry.get("wait") or ())),
        )

    def _strain(self, who: tuple[str, ...], stress: float | Mapping[str, float]) -> dict[str, int]:
        humans = [name for name in who if self.kind[name] == "human"]
        return {
            name: _millionths(stress.get(name, 0) if isinstance(stress, Mapping) else stress)
            for name in humans
        }

    # ------------------------------------------------------------ what a schedule may do

    def stress(self, done: tuple[Step, ...]) -> int | None:
        """The cell's measure of stress; None for a set of tasks that its table does not list."""
        if self.table is None:
            return sum(sum(step.way.strain.values()) for step in done)
        return self.table.get(frozenset(step.name for step in done if step.way.strain))

    def allows_who(self, done: tuple[Step, ...]) -> bool:
        """Whether what is done so far keeps the stress limits and the pairs, whatever the times."""
        who = {step.name: set(step.way.who) for step in done}
        if any(a in who and b in who and who[a] != who[b] for a, b in self.pairs):
            return False
        if any(not self.keeps_limit(done, *limit) for limit in self.limits):
            return False
        return all(
            sum(step.way.strain.get(name, 0) for step in done) <= limit
            for name, limit in self.limit.items()
        )

    def keeps_limit(
        self, done: tuple[Step, ...], who: str, what: str, scale: str, *rest: Any
    ) -> bool:
        """Whether what is done so far keeps one of `limits`."""
        *level, most = rest
        values = [
            (self._puts_on(step, who, scale), Fraction(step.way.time, MILLION))
            for step in done
            if who in step.way.who
        ]
        if what == "peak":
            return all(value <= most for value, _ in values)
        if what == "time-above":
            above = Fraction(level[0])
            # who has no value of a task is at no level, not even at 0
            return sum(time for value, time in values if value >= above) <= most
        return sum(value for value, _ in values) * self.cycles <= most

    def _puts_on(self, step: Step, who: str, scale: str) -> Fraction:
        """What the task puts on the person; -1 for nothing that is known, but 0 of a dose."""
        if scale == "stress":
            return Fraction(step.way.strain[who], MILLION)
        method, _, hand = scale.partition("-")
        rows = [row for row in self.assessed[step.name] if row["method"] == method]
        own = [row for row in rows if who in row.get("operators", ())]
        mine = own + [
            row
            for row in rows
            if not row.get("operators")
            and row.get("side") not in [other.get("side") for other in own]
        ]
        adds = method in ("lifft", "duet")
        if not mine:
            return Fraction(0 if adds else -1)
        hands = {}
        for side in ("left", "right"):
            scores = [
                Fraction(repr(float(row["score"])))
                for row in mine
                if row.get("side") in (side, "both", None)
            ]
            hands[side] = sum(scores, Fraction(0)) if adds else max(scores, default=Fraction(0))
        return hands[hand] if hand else max(hands.values())

    def allows(self, done: tuple[Step, ...]) -> bool:
        """Whether these steps, some tasks not begun, break no rule on times."""
        return (
            all(self._in_its_time(step, done) for step in done)
            and all(self._one_at_a_time(who, done) for who in self.kind)
            and all(self._room_enough(kind, done) for kind in ("tool", "zone"))
            and self._kept_apart(done)
            and all(self._holds_its_part(*hold, done) for hold in self.holds)
        )

    def _in_its_time(self, step: Step, done: tuple[Step, ...]) -> bool:
        job = self.jobs[step.name]
        if step.start < job.release or (job.deadline is not None and step.end > job.deadline):
            return False
        return not any(
            first.name in job.after and step.start < first.end for first in done
        ) and all(
            self._keeps(gap, first, step)
            for gap in job.gaps
            for first in done
            if first.name == gap.first
        )

    def _keeps(self, gap: Gap, first: Step, step: Step) -> bool:
        past = step.start - (first.start if gap.of_start else first.end)
        return gap.least <= past and (gap.most is None or past <= gap.most)

    def _one_at_a_time(self, who: str, done: tuple[Step, ...]) -> bool:
        """Tasks, the ways to them and the changeovers right before them, and breaks, one after the
        other, when all is set up.
        """
        free = self.ready[who]
        for step, begin in self._busy(who, done):
            if begin < free or any(
                off < step.end and begin < back for off, back in self.breaks[who]
            ):
                return False
            free = step.end
        return True

    def _holds_its_part(self, machine: str, first: str, last: str, done: tuple[Step, ...]) -> bool:
        """From the start of the first to the end of the last task (of the first, while the last has
        no time yet) the machine does nothing that is not between them, and holds no other part that
        is not.
        """
        steps = {step.name: step for step in done}
        if first not in steps:
            return True
        start, end = steps[first].start, steps.get(last, steps[first]).end
        inside = self._between(first, last)
        for who, other, its_last in self.holds:
            ends = {other, its_last}
            around = {first, last} <= self._between(other, its_last)
            if who == machine and other in steps and not (ends <= inside or around):
                its_end = steps.get(its_last, steps[other]).end
                if start < its_end and steps[other].start < end:
                    return False
        busy = self._busy(machine, done)
        return not any(
            begin < end and start < step.end for step, begin in busy if step.name not in inside
        )

    def _busy(self, who: str, done: tuple[Step, ...]) -> Iterator[tuple[Step, int]]:
        """The operator's steps in order, and when it begins to walk there and to change tools."""
        hand, at = self.in_hand[who], self.stands[who]
        for step in sorted(
            (step for step in done if who in step.way.who), key=lambda step: step.start
        ):
            tool = step.way.tools.get(who)
            change = (
                self.change.get((tool, who), 0)
                if tool is not None and hand not in (None, tool)
                else 0
            )
            place = self.jobs[step.name].place
            if place is not None:
                change, at = change + self.walk.get((who, at, place), 0), place
            yield step, step.start - change
            hand = hand if tool is None else tool

    def _between(self, first: str, last: str) -> set[str]:
        def follows(name: str, other: str) -> bool:
            job = self.jobs[name]
            ended = {*job.after, *(gap.first for gap in job.gaps if not gap.of_start)}
            return other in ended or any(follows(one, other) for one in ended)

        middle = {n for n in self.jobs if follows(n, first) and follows(last, n)}
        return {first, last} | middle

    def _kept_apart(self, done: tuple[Step, ...]) -> bool:
        """Whenever a step starts in a zone, those there of the kinds that it keeps apart are of one
        kind.
        """
        for step in done:
            zone = self.jobs[step.name].zone
            kinds = {
                self.kind[who]
                for other in done
                if self.jobs[other.name].zone == zone and other.start <= step.start < other.end
                for who in other.way.who
            }
            if len(kinds & set(self.apart.get(zone, ()))) > 1:
                return False
        return True

    def _room_enough(self, kind: str, done: tuple[Step, ...]) -> bool:
        """Counted whenever a step starts: only then can it become too many."""
        for step in done:
            there = [
                thing
                for other in done
                if other.start <= step.start < other.end
                for thing in self._taken(kind, other)
            ]
            if any(there.count(thing) > self.places[kind].get(thing, 1) for thing in set(there)):
                return False
        return True

    def _taken(self, kind: str, step: Step) -> list[str]:
        """The tools, or the zone, that the step takes: once for each who takes one."""
        if kind == "tool":
            return list(step.way.tools.values())
        zone = self.jobs[step.name].zone
        return [] if zone is None else [zone] * len(step.way.who)


def front_in_order(data: Mapping[str, Any]) -> list[Point]:
    """The front over all orders and ways, each task at the first moment, not before the last start,
    at which it may begin.

    Of any schedule, its tasks taken in order of start, this gives one in which no task is later
    (but for those that another one must follow in time, which are tried at every moment).
    """
    return _seconds(_front_in_order(Plain(data)))


def front_of_all(data: Mapping[str, Any], horizon: float | None = None) -> list[Point]:
    """The front over all schedules on the grid of the cell's times that end by the horizon. Nothing
    is left out.

    Without a horizon, the time in which everything can be done one after the other, behind all
    breaks and releases.
    """
    plain = Plain(data)
    return _seconds(
        _front_of_all(plain, latest(plain) if horizon is None else _millionths(horizon))
    )


class Row(NamedTuple):
    """A task of a schedule, in seconds."""

    task: str
    start: float
    end: float
    who: tuple[str, ...]


def schedules(
    data: Mapping[str, Any], horizon: float
) -> Iterator[tuple[float, float, tuple[Row, ...]]]:
    """Makespan, stress and rows of every schedule on the grid of the cell's times that ends by the
    horizon.
    """
    plain = Plain(data)
    for done in _everywhere(
        plain, list(plain.jobs.values()), (), _millionths(horizon), _grid(plain)
    ):
        stress = plain.stress(done)
        if stress is not None:
            rows = (
                Row(step.name, step.start / MILLION, step.end / MILLION, step.way.who)
                for step in done
            )
            makespan = max(step.end for step in done)
            yield makespan / MILLION, stress / MILLION, tuple(rows)


def first_by_rule(
    data: Mapping[str, Any], point: Point
) -> list[tuple[str, float, float, tuple[str, ...]]]:
    """Of all schedules on the grid that are worth the point, the first by the rule of the last step
    of planning, as `(task, start, end, operators)`: least spread of stress over people, least sum
    of starts, then starts and operators in the cell's order.
    """
    plain = Plain(data)
    time, load = (_millionths(number) for number in point)
    names = list(plain.kind)
    people = [name for name, kind in plain.kind.items() if kind == "human"]

    def place(done: tuple[Step, ...]) -> tuple[Any, ...]:
        loads = [sum(step.way.strain.get(name, 0) for step in done) for name in people]
        spread = max(loads) - min(loads) if len(people) > 1 and plain.table is None else 0
        groups = [sorted(map(names.index, step.way.who)) for step in done]
        starts = [step.start for step in done]
        return spread, sum(starts), starts, groups

    fitting = (
        done
        for done in _everywhere(plain, list(plain.jobs.values()), (), time, _grid(plain))
        if max(step.end for step in done) == time and plain.stress(done) == load
    )
    return [
        (step.name, step.start / MILLION, step.end / MILLION, step.way.who)
        for step in min(fitting, key=place)
    ]


def moments(data: Mapping[str, Any]) -> int:
    """How many moments of its grid a cell has until `latest`: what trying them all would cost a
    task.
    """
    plain = Plain(data)
    return latest(plain) // _grid(plain) + 1


def latest(plain: Plain) -> int:
    """By when everything can be done one after the other, behind all breaks and releases."""
    work = sum(max(way.time for way in job.ways) for job in plain.jobs.values())
    changes = len(plain.jobs) * max(plain.change.values(), default=0)
    changes += len(plain.jobs) * max(plain.walk.values(), default=0)
    waits = max(job.release for job in plain.jobs.values())
    waits = max([waits, *plain.ready.values()])
    gaps = sum(gap.least for job in plain.jobs.values() for gap in job.gaps)
    return (
        work
        + changes
        + gaps
        + max([waits, *(back for breaks in plain.breaks.values() for _, back in breaks)])
    )


def worth(
    data: Mapping[str, Any], rows: list[tuple[str, float, float, tuple[str, ...]]]
) -> Point | None:
    """What a schedule of `(task, start, end, operators)` comes to; None when it breaks the cell."""
    plain = Plain(data)
    if sorted(name for name, *_ in rows) != sorted(plain.jobs):
        return None
    done = []
    for name, start, end, who in rows:
        time = _millionths(end) - _millionths(start)
        ways = [
            way for way in plain.jobs[name].ways if set(way.who) == set(who) and way.time == time
        ]
        if not ways or _millionths(start) < 0:
            return None
        done.append(Step(name, ways[0], _millionths(start)))
    steps = tuple(done)
    stress = plain.stress(steps)
    if stress is None or not plain.allows_who(steps) or not plain.allows(steps):
        return None
    return max(step.end for step in steps) / MILLION, stress / MILLION


def _front_in_order(plain: Plain) -> list[Pair]:
    found: list[Pair] = []
    late, grid = latest(plain), _grid(plain)

    def beaten(done: tuple[Step, ...]) -> bool:
        """Whether no schedule that goes on from here is wanted any more; by a table, stress may
        still fall.
        """
        if plain.table is not None:
            return False
        stress, makespan = plain.stress(done) or 0, max(step.end for step in done)
        return any(time <= makespan and load <= stress for time, load in found)

    def grow(done: tuple[Step, ...]) -> None:
        if len(done) == len(plain.jobs):
            stress = plain.stress(done)
            if stress is not None:
                found.append((max(step.end for step in done), stress))
            return
        names = {step.name for step in done}
        for job in plain.jobs.values():
            if job.name not in names and names.issuperset(job.first):
                for way in job.ways:
                    for step in _appended(plain, done, job, way, late, grid):
                        if not beaten((*done, step)):
                            grow((*done, step))

    grow(())
    return _unbeaten(found)


def _appended(
    plain: Plain, done: tuple[Step, ...], job: Job, way: Way, late: int, grid: int
) -> Iterator[Step]:
    """The task at the first moment that is allowed; moments at which something else ends are enough
    to look at. A task that another one must follow in time may have to wait for it: it is tried at
    every moment of the grid.
    """
    if not plain.allows_who((*done, Step(job.name, way, 0))):
        return
    last = max((step.start for step in done), default=0)
    there = (
        moment
        for who in way.who
        for moment in (plain.ready[who], *(back for _, back in plain.breaks[who]))
    )
    ends = {0, job.release, *(step.end for step in done), *there}
    changes = {
        0,
        *(plain.change.get((tool, who), 0) for who, tool in way.tools.items()),
    }
    ways = {0, *(seconds for (who, _, to), seconds in plain.walk.items() if to == job.place)}
    changes = {change + way for change in changes for way in ways}
    for gap in job.gaps:
        for first in done:
            if first.name == gap.first:
                ends.add((first.start if gap.of_start else first.end) + gap.least)
    is_followed = any(
        gap.first == job.name and gap.most is not None
        for other in plain.jobs.values()
        for gap in other.gaps
    )
    moments = {last, *(end + change for end in ends for change in changes)}
    if is_followed:
        moments |= set(range(last, late + 1, grid))
    for start in sorted(moments):
        if start >= last:
            step = Step(job.name, way, start)
            if plain.allows((*done, step)):
                yield step
                if not is_followed:
                    return


def walks_of(data: Mapping[str, Any]) -> dict[tuple[str, str | None, str], int]:
    """(operator, from, to) -> millionths. Names of places hold no hyphen here."""
    found: dict[tuple[str, str | None, str], int] = {}
    for who, table in (data.get("walk") or {}).items():
        spots = data.get("places") or {}
        for one in spots if "speed" in table else ():
            for other in spots:
                far = sum((b - a) ** 2 for a, b in zip(spots[one], spots[other], strict=True))
                tenths = 0
                while (tenths * Fraction(repr(table["speed"]))) ** 2 < 100 * Fraction(far):
                    tenths += 1
                found[who, one, other] = tenths * MILLION // 10
        for key, seconds in table.items():
            if key != "speed":
                one, other = key.split("-")
                found[who, one, other] = _millionths(seconds)
                if f"{other}-{one}" not in table:
                    found[who, other, one] = _millionths(seconds)
    return found


def _hands(who: tuple[str, ...], tool: str | Mapping[str, str] | None) -> dict[str, str]:
    if isinstance(tool, Mapping):
        return {name: tool[name] for name in who if name in tool}
    return {} if tool is None else dict.fromkeys(who, tool)


def _front_of_all(plain: Plain, horizon: int) -> list[Pair]:
    found = []
    for done in _everywhere(plain, list(plain.jobs.values()), (), horizon, _grid(plain)):
        stress = plain.stress(done)
        if stress is not None:
            found.append((max(step.end for step in done), stress))
    return _unbeaten(found)


def _everywhere(
    plain: Plain, left: list[Job], done: tuple[Step, ...], horizon: int, grid: int
) -> Iterator[tuple[Step, ...]]:
    if not left:
        if plain.allows(done):  # once more: the changeovers may have become others
            yield done
        return
    job = left[0]
    late = horizon if job.deadline is None else min(horizon, job.deadline)
    for way in job.ways:
        if plain.allows_who((*done, Step(job.name, way, 0))):
            for start in range(0, late - way.time + 1, grid):
                grown = (*done, Step(job.name, way, start))
                if plain.allows(grown) or plain.change or plain.walk:
                    yield from _everywhere(plain, left[1:], grown, horizon, grid)


def _grid(plain: Plain) -> int:
    times = [way.time for job in plain.jobs.values() for way in job.ways]
    times += [job.release for job in plain.jobs.values()]
    times += [moment for breaks in plain.breaks.values() for pair in breaks for moment in pair]
    for job in plain.jobs.values():
        times += [number for gap in job.gaps for number in (gap.least, gap.most or 0)]
    return gcd(*times, *plain.change.values(), *plain.walk.values(), *plain.ready.values())


def _gaps(waits: Any) -> Iterator[Gap]:
    for wait in [waits] if isinstance(waits, Mapping) else waits:
        most = wait.get("at_most")
        yield Gap(
            str(wait["after"]),
            wait.get("between", "end-start") == "start-start",
            _millionths(wait.get("at_least", 0)),
            None if most is None else _millionths(most),
        )


def _unbeaten(points: list[Pair]) -> list[Pair]:
    return sorted(
        {p for p in points if not any(q != p and q[0] <= p[0] and q[1] <= p[1] for q in points)}
    )


def _seconds(points: list[Pair]) -> list[Point]:
    return [(time / MILLION, load / MILLION) for time, load in points]


def _millionths(number: float) -> int:
    """The decimal that the number prints as, in millionths. No cell has finer numbers."""
    scaled = Fraction(repr(number)) * MILLION
    if scaled.denominator != 1:
        raise ValueError(f"{number!r} has more than six decimals.")
    return int(scaled)
