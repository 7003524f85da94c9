"""A yardstick for stations that repeat that knows nothing of Tandem: it reads a cell as plain data
and tries every tick of the cycle for every task.

For cells of a handful of tasks and cycles of a few ticks.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal
from itertools import product
from math import prod
from typing import Any, NamedTuple

import numpy as np

MOST_TRIED = 400_000
"""Ways to lay out one allocation in one cycle; larger cells are not for brute force."""


class TooLarge(Exception):
    """The cell has too many tasks, or too many ticks, to try everything."""


class Way(NamedTuple):
    """Who does a task, for how many ticks, and the stress on each human who takes part."""

    who: tuple[str, ...]
    ticks: int
    stress: dict[str, Decimal]


class Repeating:
    """A cell that is made again and again, from plain data.

    Attributes:
      per_second: ticks.
    """

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.data = data
        self.names = list(data["tasks"])
        self.per_second = self._scale()
        self.ways = [list(self._ways(task)) for task in data["tasks"].values()]

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
        fixed = laps is None and not whole
        spans = [range(1) if fixed and not task else range(length) for task in range(len(chosen))]
        places = np.array(np.meshgrid(*spans, indexing="ij")).reshape(len(chosen), -1)
        places = places[:, self._sound(places, chosen, length)]
        if not places.size:
            return None
        if fixed:
            return 0
        stays = self._lifted(places, chosen, length)
        if laps is not None:
            stays = stays[stays <= laps * length]
        return int(stays.min()) if stays.size else None

    def _lifted(self, places: np.ndarray, chosen: tuple[Way, ...], length: int) -> np.ndarray:
        """Per layout, when the last task ends if each starts in the first cycle that it can."""
        starts = np.zeros_like(places)
        for task in self._order():
            ready = np.zeros(places.shape[1], dtype=int)
            for first in self._before(task):
                ready = np.maximum(ready, starts[first] + chosen[first].ticks)
            starts[task] = ready + (places[task] - ready) % length
        ticks = np.array([way.ticks for way in chosen])
        ends: np.ndarray = (starts + ticks[:, None]).max(axis=0)
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
        for kind in ("tool", "zone"):
            for name in {task.get(kind) for task in self.data["tasks"].values()} - {None}:
                users = [t for t in tasks if self._task(t).get(kind) == name]
                room = self.data.get(f"{kind}s", {}).get(name, {}).get("capacity", 1)
                for b in users:
                    used = np.full(places.shape[1], len(chosen[b].who))
                    for a in users:
                        if a != b:
                            used += len(chosen[a].who) * (behind[a, b] < chosen[a].ticks)
                    good &= used <= room
        for who in self.data["operators"]:
            good &= self._taken_up(who, behind, chosen, length, places.shape[1])
        return good

    def _taken_up(
        self,
        who: str,
        behind: dict[tuple[int, int], np.ndarray],
        chosen: tuple[Way, ...],
        length: int,
        count: int,
    ) -> np.ndarray:
        """In which layouts the operator has the time to take up tools, around the cycle."""
        good = np.ones(count, dtype=bool)
        mine = [task for task in range(len(chosen)) if who in chosen[task].who]
        for task in mine:
            tool = self._task(task).get("tool")
            needed = self.data.get("tools", {}).get(tool, {}).get("changeover", {}).get(who, 0)
            others = [other for other in mine if other != task]
            if not needed or not others:
                continue
            free = np.min([behind[a, task] - chosen[a].ticks for a in others], axis=0)
            holding = [other for other in others if self._task(other).get("tool") is not None]
            if not holding:
                continue
            latest = np.argmin([behind[a, task] for a in holding], axis=0)
            other = np.array([self._task(a)["tool"] != tool for a in holding])[latest]
            good &= ~other | (free >= self._ticks(needed))
        return good

    # ------------------------------------------------------------ the cell as data

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

    def _ways(self, task: Mapping[str, Any]) -> Iterator[Way]:
        for who, seconds in task.get("time", {}).items():
            yield Way((who,), self._ticks(seconds), self._stress((who,), task.get("stress", 0)))
        for joint in task.get("together", []):
            stress = joint.get("stress", task.get("stress", 0))
            group = tuple(joint["operators"])
            yield Way(group, self._ticks(joint["time"]), self._stress(group, stress))

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
        return sum(max(way.ticks for way in ways) + swaps for ways in self.ways)

    def _task(self, task: int) -> Mapping[str, Any]:
        found: Mapping[str, Any] = self.data["tasks"][self.names[task]]
        return found

    def _before(self, task: int) -> list[int]:
        return [self.names.index(first) for first in self._task(task).get("after", [])]

    def _order(self) -> list[int]:
        done: list[int] = []
        while len(done) < len(self.names):
            done += [
                task
                for task in range(len(self.names))
                if task not in done and all(first in done for first in self._before(task))
            ]
        return done

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
        for tool in self.data.get("tools", {}).values():
            numbers += [Decimal(str(seconds)) for seconds in tool.get("changeover", {}).values()]
        digits = [-int(number.normalize().as_tuple().exponent) for number in numbers if number]
        return int(10 ** max([0, *digits]))
