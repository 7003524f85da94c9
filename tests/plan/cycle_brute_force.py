"""A yardstick for stations that repeat that knows nothing of Tandem: it reads a cell as plain data
and tries every tick of the cycle for every task.

For cells of a handful of tasks and cycles of a few ticks.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal
from itertools import combinations, product
from math import prod
from typing import Any, NamedTuple

import numpy as np
from tests.plan.brute_force import MILLION, Plain, Step, walks_of

MOST_TRIED = 400_000
"""Ways to lay out one allocation in one cycle; larger cells are not for brute force."""


class TooLarge(Exception):
    """The cell has too many tasks, or too many ticks, to try everything."""


class Way(NamedTuple):
    """Who does a task, for how many ticks, the stress on each human who takes part, and the tool
    that each of them needs.
    """

    who: tuple[str, ...]
    ticks: int
    stress: dict[str, Decimal]
    tools: dict[str, str]


class Gap(NamedTuple):
    """`task` starts `least` to `most` ticks (None: any) after the end or start of `first`."""

    first: int
    task: int
    of_start: bool
    least: int
    most: int | None


class Repeating:
    """A cell that is made again and again, from plain data.

    Attributes:
      per_second: ticks.
    """

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.data, self.plain = data, Plain(data)
        self.names = list(data["tasks"])
        self.per_second = self._scale()
        self.ways = [list(self._ways(task)) for task in data["tasks"].values()]
        self.gaps = list(self._gaps())
        self.holds = list(self._holds())
        self.is_bound = bool(self.holds) or any(gap.most is not None for gap in self.gaps)
        self.walk = self._walks()

    # ------------------------------------------------------------ questions

    def front(self, laps: int | None = None) -> dict[int, Decimal]:
        """Cycle time in ticks -> stress, of every pattern that none beats; at most so many products
        in process.
        """
        best: dict[Decimal, int] = {}
        for chosen, stress in self._allocations():
            longest = min(
                (length for known, length in best.items() if known <= stress),
                default=self._sequential() + 1,
            )
            for length in range(self._load(chosen), longest):
                if self.stay(chosen, length, laps) is not None:
                    best[stress] = length
                    break
        points: dict[int, Decimal] = {}
        for length, stress in sorted((length, stress) for stress, length in best.items()):
            if all(stress < other for other in points.values()):
                points[length] = stress
        return points

    def fewest(self, length: int, stress: Decimal) -> int:
        """The fewest products in process of this cycle time and at most this stress."""
        stays = [
            self.stay(chosen, length, None, whole=True)
            for chosen, load in self._allocations()
            if load <= stress
        ]
        return min(-(-stay // length) for stay in stays if stay is not None)

    # ------------------------------------------------------------ one allocation, one cycle time

    def stay(
        self, chosen: tuple[Way, ...], length: int, laps: int | None, whole: bool = False
    ) -> int | None:
        """The shortest time that a product can be in the station, ticks; None when it cannot.

        Without a limit on laps, and not `whole`, any number says that it can.
        """
        if any(way.ticks > length for way in chosen):
            return None
        if length ** len(chosen) > MOST_TRIED:
            raise TooLarge
        fixed = laps is None and not whole and not self.is_bound
        spans = [range(1) if fixed and not task else range(length) for task in range(len(chosen))]
        places = np.array(np.meshgrid(*spans, indexing="ij")).reshape(len(chosen), -1)
        places = places[:, self._sound(places, chosen, length)]
        if not places.size:
            return None
        if fixed:
            return 0
        most = self._sequential() + length * (len(chosen) + len(self.gaps) + 1)
        stays = self._lifted(places, chosen, length, most)
        stays = stays[stays <= (most if laps is None else laps * length)]
        return int(stays.min()) if stays.size else None

    def _lifted(
        self, places: np.ndarray, chosen: tuple[Way, ...], length: int, most: int
    ) -> np.ndarray:
        """Per layout, when the last task ends if each starts in the first cycle that it can; more
        than `most` where it never can.
        """
        ticks = [way.ticks for way in chosen]
        edges = [
            (first, task, ticks[first])
            for task in range(len(chosen))
            for first in self._before(task)
        ]
        for gap in self.gaps:
            own = 0 if gap.of_start else ticks[gap.first]
            edges.append((gap.first, gap.task, own + gap.least))
            if gap.most is not None:
                edges.append((gap.task, gap.first, -own - gap.most))
        edges += [(last, first, ticks[last] - length) for _, first, last, _ in self.holds]
        starts, grown = places.copy(), True
        while grown:
            grown = False
            for one, other, apart in edges:
                ready = np.minimum(starts[one], most) + apart
                late = ready > starts[other]
                if late.any():
                    starts[other] += (
                        np.where(late, -(-(ready - starts[other]) // length), 0) * length
                    )
                    grown = bool((late & (starts[other] <= most)).any()) or grown
        ends: np.ndarray = (starts + np.array(ticks)[:, None]).max(axis=0)
        return ends

    def _sound(self, places: np.ndarray, chosen: tuple[Way, ...], length: int) -> np.ndarray:
        """Which layouts nobody and nothing is asked for twice at once in."""
        good = np.ones(places.shape[1], dtype=bool)
        tasks = range(len(chosen))
        behind = {
            (a, b): (places[b] - places[a]) % length for a, b in product(tasks, tasks) if a != b
        }
        for (a, b), ticks in behind.items():
            if set(chosen[a].who) & set(chosen[b].who):
                good &= ticks >= chosen[a].ticks
        for kind in ("tools", "zones"):
            taken = [self._taken(kind, t, chosen[t]) for t in tasks]
            for name in {name for names in taken for name in names}:
                counts = [names.count(name) for names in taken]
                room = self.data.get(kind, {}).get(name, {}).get("capacity", 1)
                for b in tasks:
                    used = np.full(places.shape[1], counts[b])
                    for a in tasks:
                        if a != b:
                            used += counts[a] * (behind[a, b] < chosen[a].ticks)
                    good &= (used <= room) | (counts[b] == 0)
        for (one, two), ticks in behind.items():
            if self._mind(one, two, chosen):
                good &= ticks >= chosen[one].ticks
        for who in self.data["operators"]:
            ready = self._readying(who, behind, chosen, places.shape[1])
            for task, needed in ready.items():
                others = [other for other in ready if other != task]
                free = [behind[a, task] - chosen[a].ticks for a in others]
                good &= (needed == 0) | (np.min(free, axis=0) >= needed if free else True)
            good &= self._holds_nothing_else(who, places, chosen, ready, length)
        return good

    def _mind(self, one: int, two: int, chosen: tuple[Way, ...]) -> bool:
        """Whether the zone of both keeps their operators apart."""
        zone = self._task(one).get("zone")
        apart = set(self.data.get("zones", {}).get(zone, {}).get("apart", ()))
        kinds = [{self.data["operators"][who]["kind"] for who in chosen[t].who} for t in (one, two)]
        same = zone is not None and zone == self._task(two).get("zone")
        return same and any(a != b for a in kinds[0] & apart for b in kinds[1] & apart)

    def _holds_nothing_else(
        self,
        who: str,
        places: np.ndarray,
        chosen: tuple[Way, ...],
        ready: dict[int, np.ndarray],
        length: int,
    ) -> np.ndarray:
        """In which layouts the machine does nothing else while it holds a part. A hold is no longer
        than a cycle, so that the places say how long it is.
        """
        good = np.ones(places.shape[1], dtype=bool)
        spans = []
        for machine, first, last, within in self.holds:
            if machine != who:
                continue
            span = (places[last] + chosen[last].ticks - places[first] - 1) % length + 1
            spans.append((first, last, within, span))
            for task, needed in ready.items():
                offset = (places[task] - places[first]) % length
                if task in within:
                    good &= offset - needed >= span - length
                    continue
                begun = (offset - needed) % length
                good &= (begun >= span) & ((-begun) % length >= chosen[task].ticks + needed)
        for (one, its_last, inside, span), (two, last, within, other) in combinations(spans, 2):
            if {one, its_last} <= within or {two, last} <= inside:
                continue
            begun = (places[two] - places[one]) % length
            good &= (begun >= span) & ((-begun) % length >= other)
        return good

    def _taken(self, kind: str, task: int, way: Way) -> list[str]:
        """The tools that its operators need, or the zone once for each of them."""
        if kind == "tools":
            return list(way.tools.values())
        zone = self._task(task).get("zone")
        return [] if zone is None else [zone] * len(way.who)

    def _readying(
        self,
        who: str,
        behind: dict[tuple[int, int], np.ndarray],
        chosen: tuple[Way, ...],
        count: int,
    ) -> dict[int, np.ndarray]:
        """Task of the operator -> per layout, ticks that it needs before it to walk there and to
        take up its tool, around the cycle.
        """
        mine = [task for task in range(len(chosen)) if who in chosen[task].who]
        ready = {}
        for task in mine:
            others = [other for other in mine if other != task]
            needed = np.zeros(count, dtype=int)
            tool, place = chosen[task].tools.get(who), self._task(task).get("place")
            change = self.data.get("tools", {}).get(tool, {}).get("changeover", {}).get(who, 0)
            tools = [(other, chosen[other].tools.get(who)) for other in others]
            if tool is not None and change:
                for other, is_last in self._last(task, tools, behind):
                    needed += is_last * (other != tool) * self._ticks(change)
            stops = [(other, self._task(other).get("place")) for other in others]
            if place is not None:
                for at, is_last in self._last(task, stops, behind):
                    needed += is_last * self.walk.get((who, at, place), 0)
            ready[task] = needed
        return ready

    @staticmethod
    def _last(
        task: int,
        others: list[tuple[int, str | None]],
        behind: dict[tuple[int, int], np.ndarray],
    ) -> Iterator[tuple[str, np.ndarray]]:
        """What the latest task before this one that has any has, and in which layouts."""
        having = [(other, value) for other, value in others if value is not None]
        if having:
            latest = np.argmin([behind[other, task] for other, _ in having], axis=0)
            for number, (_, value) in enumerate(having):
                yield value, latest == number

    # ------------------------------------------------------------ the cell as data

    def _keeps_limits(self, chosen: tuple[Way, ...]) -> bool:
        """Whether people's `limits` are kept, as the brute force of schedules reads them."""
        steps = []
        for name, mine in zip(self.names, chosen, strict=True):
            ways = self.plain.jobs[name].ways
            steps.append(Step(name, next(w for w in ways if set(w.who) == set(mine.who)), 0))
        return all(self.plain.keeps_limit(tuple(steps), *limit) for limit in self.plain.limits)

    def _allocations(self) -> Iterator[tuple[tuple[Way, ...], Decimal]]:
        if prod(map(len, self.ways)) > 2_000:
            raise TooLarge
        for chosen in product(*self.ways):
            pairs = self.data.get("same_operator", [])
            if any(
                set(chosen[self.names.index(a)].who) != set(chosen[self.names.index(b)].who)
                for a, b in pairs
            ):
                continue
            if any(self._mixes(task, way) for task, way in enumerate(chosen)):
                continue
            loads = {
                who: sum((way.stress.get(who, Decimal(0)) for way in chosen), Decimal(0))
                for who in self.data["operators"]
            }
            if any(
                loads[who] > Decimal(str(operator["stress_limit"]))
                for who, operator in self.data["operators"].items()
                if "stress_limit" in operator
            ):
                continue
            if not self._keeps_limits(chosen):
                continue
            table = self.data.get("stress_of_set")
            if table is None:
                yield chosen, sum(loads.values(), Decimal(0))
                continue
            done = {
                name
                for name, way in zip(self.names, chosen, strict=True)
                if any(self.data["operators"][who]["kind"] == "human" for who in way.who)
            }
            for key, value in table.items():
                if set(filter(None, key.split(","))) == done:
                    yield chosen, Decimal(str(value))

    def _mixes(self, task: int, way: Way) -> bool:
        """Whether the zone keeps those who do it together apart."""
        zone = self.data.get("zones", {}).get(self._task(task).get("zone"), {})
        kinds = {self.data["operators"][who]["kind"] for who in way.who}
        return len(kinds & set(zone.get("apart", ()))) > 1

    def _ways(self, task: Mapping[str, Any]) -> Iterator[Way]:
        for who, seconds in task.get("time", {}).items():
            yield Way(
                (who,),
                self._ticks(seconds),
                self._stress((who,), task.get("stress", 0)),
                self._tools((who,), task.get("tool")),
            )
        for joint in task.get("together", []):
            stress = joint.get("stress", task.get("stress", 0))
            group = tuple(joint["operators"])
            yield Way(
                group,
                self._ticks(joint["time"]),
                self._stress(group, stress),
                self._tools(group, joint.get("tool", task.get("tool"))),
            )

    @staticmethod
    def _tools(group: tuple[str, ...], tool: Any) -> dict[str, str]:
        stated = tool if isinstance(tool, Mapping) else {who: tool for who in group if tool}
        return {who: stated[who] for who in group if who in stated}

    def _holds(self) -> Iterator[tuple[str, int, int, set[int]]]:
        """(machine, first task, last task, tasks on the way from the one to the other)."""
        for who, operator in self.data["operators"].items():
            for pair in operator.get("holds", ()):
                first, last = map(self.names.index, pair)
                yield who, first, last, self._way(first, last)

    def _way(self, first: int, last: int) -> set[int]:
        if first == last:
            return {last}
        found = set().union(*(self._way(first, before) for before in self._before(last)), set())
        return found | {last} if found else set()

    def _gaps(self) -> Iterator[Gap]:
        for task, entry in enumerate(self.data["tasks"].values()):
            waits = entry.get("wait") or []
            for wait in [waits] if isinstance(waits, Mapping) else waits:
                most = wait.get("at_most")
                yield Gap(
                    self.names.index(wait["after"]),
                    task,
                    wait.get("between") == "start-start",
                    self._ticks(wait.get("at_least", 0)),
                    None if most is None else self._ticks(most),
                )

    def _walks(self) -> dict[tuple[str, str, str], int]:
        """(operator, from, to) -> ticks; by the other brute force, which reads them as data too."""
        return {
            (who, one, other): seconds * self.per_second // MILLION
            for (who, one, other), seconds in walks_of(self.data).items()
            if one is not None
        }

    def _stress(self, group: tuple[str, ...], stress: Any) -> dict[str, Decimal]:
        return {
            who: Decimal(str(stress.get(who, 0) if isinstance(stress, Mapping) else stress))
            for who in group
            if self.data["operators"][who]["kind"] == "human"
        }

    def _load(self, chosen: tuple[Way, ...]) -> int:
        return max(
            sum(way.ticks for way in chosen if who in way.who) for who in self.data["operators"]
        )

    def _sequential(self) -> int:
        """Ticks in which everything can be done one after the other, and so the longest cycle."""
        swaps = max(
            (
                self._ticks(seconds)
                for tool in self.data.get("tools", {}).values()
                for seconds in tool.get("changeover", {}).values()
            ),
            default=0,
        )
        ways = max(self.walk.values(), default=0)
        waits = sum(gap.least for gap in self.gaps)
        return waits + sum(max(way.ticks for way in row) + swaps + ways for row in self.ways)

    def _task(self, task: int) -> Mapping[str, Any]:
        found: Mapping[str, Any] = self.data["tasks"][self.names[task]]
        return found

    def _before(self, task: int) -> list[int]:
        ended = [gap.first for gap in self.gaps if gap.task == task and not gap.of_start]
        return ended + [self.names.index(first) for first in self._task(task).get("after", [])]

    def _ticks(self, seconds: float) -> int:
        return int(Decimal(str(seconds)) * self.per_second)

    def _scale(self) -> int:
        numbers = [
            Decimal(str(seconds))
            for task in self.data["tasks"].values()
            for seconds in (
                *task.get("time", {}).values(),
                *(joint["time"] for joint in task.get("together", [])),
            )
        ]
        for entry in self.data["tasks"].values():
            waits = entry.get("wait") or []
            for wait in [waits] if isinstance(waits, Mapping) else waits:
                numbers += [Decimal(str(wait.get(key) or 0)) for key in ("at_least", "at_most")]
        numbers += [Decimal(seconds) / MILLION for seconds in walks_of(self.data).values()]
        for tool in self.data.get("tools", {}).values():
            numbers += [Decimal(str(seconds)) for seconds in tool.get("changeover", {}).values()]
        digits = [-int(number.normalize().as_tuple().exponent) for number in numbers if number]
        return int(10 ** max([0, *digits]))
