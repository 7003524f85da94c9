"""Whether the times of a cell fit together: breaks, deadlines, and numbers that can be counted
exactly.

Times are compared in whole microseconds: seconds have at most six decimals, so nothing is lost.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise
from typing import TYPE_CHECKING

from pydantic import BaseModel

from tandem.cell.written import number
from tandem.errors import Fault

if TYPE_CHECKING:
    from tandem.cell.parts import Fields, Task

DECIMALS = 6
MICRO = 1_000_000
LARGEST = 2**40
"""The largest sum in units of the finest number: solvers add such numbers, in 64 bits, with room to
spare.
"""

Path = tuple[str | int, ...]


def breaks_are_apart(cell: Fields) -> Iterator[Fault]:
    """A break ends after it starts, and an operator's breaks do not overlap; touching ones may."""
    for who, operator in cell.operators.items():
        here: Path = ("operators", who, "breaks")
        good = []
        for place, (start, end) in enumerate(operator.breaks):
            if end > start:
                good.append((start, end, place))
                continue
            remedy = (
                f"write [{number(end)}, {number(start)}]"
                if end < start
                else "a break must last a while"
            )
            yield Fault(
                f"operator {who!r}: the break [{number(start)}, {number(end)}] ends before or when"
                f" it starts; {remedy}.",
                (*here, place),
            )
        good.sort()
        for (a, b, _), (c, d, place) in pairwise(good):
            if c < b:
                both = f"[{number(a)}, {number(b)}] and [{number(c)}, {number(d)}]"
                yield Fault(
                    f"operator {who!r}: the breaks {both} overlap. Make them one: [{number(a)},"
                    f" {number(max(b, d))}].",
                    (*here, place),
                )


@dataclass(frozen=True)
class Earliest:
    """The soonest that a task can be over, were it not for other tasks on the same operators.

    Attributes:
      end: microseconds.
      chain_end: the same without breaks.
      first: the predecessor that it waits for longest; None when it need not wait for one.
      operators: who would do it.
    """

    end: int
    chain_end: int
    first: str | None
    operators: tuple[str, ...]


def a_deadline_can_be_met(cell: Fields) -> Iterator[Fault]:
    """No task is bound to be late: its predecessors and itself, each in its quickest way, from the
    release on, around breaks, with the least waits from end to start between them.
    """
    if all(task.deadline is None for task in cell.tasks.values()):
        return
    rest = _Rests(cell)
    found: dict[str, Earliest] = {}
    for name in _in_order(cell):
        task = cell.tasks[name]
        soonest = _earliest(cell, name, found, rest)
        if soonest is None:
            continue
        found[name] = soonest
        if task.deadline is not None and soonest.end > _micro(task.deadline):
            yield Fault(_too_late(cell, name, found), ("tasks", name, "deadline"))
            deadline = _micro(task.deadline)  # what follows it is not blamed for the same delay
            found[name] = Earliest(
                deadline, min(soonest.chain_end, deadline), soonest.first, soonest.operators
            )


class _Rests:
    """When operators are off, alone and together, in whole microseconds."""

    def __init__(self, cell: Fields):
        self.of_each = {
            who: [
                (_micro(off.start), _micro(off.end))
                for off in operator.times_off
                if off.end > off.start
            ]
            for who, operator in cell.operators.items()
        }
        self._joint: dict[tuple[str, ...], list[tuple[int, int]]] = {}

    def __contains__(self, who: str) -> bool:
        return who in self.of_each

    def soonest_end(self, start: int, length: int, operators: tuple[str, ...]) -> int:
        """The soonest end of something that lasts so long, starts then or later and touches no
        break of those who do it.
        """
        rests = self._joint.get(operators)
        if rests is None:
            rests = self._joint[operators] = _apart(
                rest for who in operators for rest in self.of_each[who]
            )
        for a, b in islice(rests, bisect_right(rests, start, key=_end), None):
            if a >= start + length:
                break
            start = b
        return start + length


def _end(rest: tuple[int, int]) -> int:
    return rest[1]


def _apart(rests: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    """The same times in order, those that touch or overlap made one."""
    joined: list[tuple[int, int]] = []
    for a, b in sorted(rests):
        if joined and a <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(b, joined[-1][1]))
        else:
            joined.append((a, b))
    return joined


def _earliest(
    cell: Fields, name: str, found: Mapping[str, Earliest], rest: _Rests
) -> Earliest | None:
    task = cell.tasks[name]
    ways = [((who,), time) for who, time in task.time.items()] + [
        (joint.operators, joint.time) for joint in task.together
    ]
    ways = [(who, time) for who, time in ways if all(one in rest for one in who)]
    if not ways:
        return None
    before = [first for first in task.predecessors if first in found]
    waits = _least_waits(task)
    start = chain_start = _micro(task.release)
    first = max(before, key=lambda one: found[one].end + waits.get(one, 0), default=None)
    if first is not None and found[first].end + waits.get(first, 0) > start:
        start = found[first].end + waits.get(first, 0)
    else:
        first = None
    chain_start = max([chain_start, *(found[one].chain_end + waits.get(one, 0) for one in before)])
    end, operators = min(
        (rest.soonest_end(start, _micro(time), tuple(who)), tuple(who)) for who, time in ways
    )
    return Earliest(end, chain_start + min(_micro(time) for _, time in ways), first, operators)


def _least_waits(task: Task) -> dict[str, int]:
    """Per task that it waits for the end of, microseconds that must pass in between."""
    return {wait.after: _micro(wait.at_least) for wait in task.wait if wait.between == "end-start"}


def _too_late(cell: Fields, name: str, found: Mapping[str, Earliest]) -> str:
    chain = [name]
    while (first := found[chain[-1]].first) is not None:
        chain.append(first)
    chain.reverse()
    if len(chain) > 12:
        chain = [*chain[:5], "", *chain[-6:]]
    steps = " then ".join(_step(cell, one, found[one].first) if one else "..." for one in chain)
    deadline, end = cell.tasks[name].deadline, found[name].end
    kinds = sorted(
        {f"{off.what}s" for operator in cell.operators.values() for off in operator.times_off}
    )
    around = (
        f" around the {' and '.join(kinds)}"
        if found[name].chain_end <= _micro(deadline or 0.0)
        else ""
    )
    return (
        f"task {name!r} can never keep its deadline of {number(deadline or 0.0)} s: {steps} ends at"
        f" {number(end / MICRO)} s at the soonest{around}. Set the deadline to"
        f" {number(end / MICRO)} or later, or make what goes before it quicker."
    )


def _step(cell: Fields, name: str, first: str | None) -> str:
    task = cell.tasks[name]
    least = _least_waits(task).get(first or "", 0)
    wait = f" {number(least / MICRO)} s later" if least else ""
    quickest = min([*task.time.values(), *(joint.time for joint in task.together)])
    release = f", released at {number(task.release)} s" if task.release else ""
    return f"{name!r}{wait} ({number(quickest)} s{release})"


def _in_order(cell: Fields) -> list[str]:
    """Tasks so that predecessors come first; those on a circle or behind one are left out."""
    waiting = {
        name: len({first for first in task.predecessors if first in cell.tasks})
        for name, task in cell.tasks.items()
    }
    behind: dict[str, list[str]] = {name: [] for name in cell.tasks}
    for name, task in cell.tasks.items():
        for first in set(task.predecessors):
            if first in behind:
                behind[first].append(name)
    ready = [name for name, count in waiting.items() if count == 0]
    for name in ready:
        for after in behind[name]:
            waiting[after] -= 1
            if waiting[after] == 0:
                ready.append(after)
    return ready


def numbers_have_few_decimals(cell: Fields) -> Iterator[Fault]:
    """At most six decimals: more than any stopwatch has, and few enough to count exactly."""
    for path, value in _numbers(cell):
        if round(value, DECIMALS) != value:
            rounded = round(value, 3) or round(value, DECIMALS)
            example = f", to {rounded!r} for example" if rounded else ""
            yield Fault(f"{value!r} has more than {DECIMALS} decimals. Round it{example}.", path)


def exact_planning_can_count_it(cell: Fields) -> Iterator[Fault]:
    """All times together, and all stress together, in units of the finest of them, stay below
    2^40.
    """
    times, stresses = [], []
    longest = stressed = 0.0
    changeover = max(
        (seconds for tool in cell.tools.values() for seconds in tool.changeover.values()),
        default=0.0,
    )
    walks = [seconds for table in cell.walking.values() for seconds in table.values()]
    ready = changeover + max(walks, default=0.0)
    for task in cell.tasks.values():
        own = [*task.time.values(), *(joint.time for joint in task.together)]
        strain = [
            *_values(task.stress),
            *(
                value
                for joint in task.together
                if joint.stress is not None
                for value in _values(joint.stress)
            ),
        ]
        times += [*own, task.release, task.deadline or 0.0]
        times += [seconds for wait in task.wait for seconds in (wait.at_least, wait.at_most or 0.0)]
        longest += sum(wait.at_least for wait in task.wait)
        stresses += strain
        longest += max(own, default=0.0) + ready
        stressed += max(strain, default=0.0) * len(cell.operators)
    ends = [
        moment
        for operator in cell.operators.values()
        for off in operator.times_off
        for moment in (off.start, off.end)
    ]
    times += [
        *ends,
        *walks,
        *(seconds for tool in cell.tools.values() for seconds in tool.changeover.values()),
    ]
    longest += max((task.release for task in cell.tasks.values()), default=0.0) + sum(ends)
    table = list((cell.stress_of_set or {}).values())
    stresses += [
        *table,
        *(
            operator.stress_limit
            for operator in cell.operators.values()
            if operator.stress_limit is not None
        ),
    ]
    for what, unit, total, numbers in (
        ("times", " s", longest, times),
        ("stresses", "", max(stressed, *table, 0.0), stresses),
    ):
        scale = _scale(numbers)
        if total * scale > LARGEST:
            yield Fault(
                f"the {what} add up to {total:.6g}{unit} and the finest has a step of"
                f" {1 / scale:.6g}{unit}: too wide a range to plan exactly. Round the {what} to"
                f" {_step_that_fits(total)}{unit}.",
                ("tasks",),
            )


def _step_that_fits(total: float) -> str:
    step = 1 / MICRO
    while total / step > LARGEST:
        step *= 10
    return f"{step:.6g}"


def _scale(numbers: Sequence[float]) -> int:
    """The smallest power of ten, up to a million, that makes every number whole."""
    for decimals in range(DECIMALS):
        if all(round(number, decimals) == number for number in numbers):
            return int(10.0**decimals)
    return MICRO


def _numbers(cell: Fields) -> Iterator[tuple[Path, float]]:
    """Every number of the cell and where it stands."""
    for who, operator in cell.operators.items():
        for place, pair in enumerate(operator.breaks):
            yield from (
                (("operators", who, "breaks", place, side), value)
                for side, value in enumerate(pair)
            )
        yield from _numbers_of(operator, ("operators", who))
    for name, task in cell.tasks.items():
        yield from _numbers_of(task, ("tasks", name))
        for place, joint in enumerate(task.together):
            yield from _numbers_of(joint, ("tasks", name, "together", place))
        for place, wait in enumerate(task.wait):
            yield from _numbers_of(wait, ("tasks", name, "wait", place))
    for name, tool in cell.tools.items():
        yield from _numbers_of(tool, ("tools", name))
    for who, table in cell.walk.items():
        yield from ((("walk", who, key), value) for key, value in table.items())
    for name, metres in cell.places.items():
        yield from ((("places", name, side), value) for side, value in enumerate(metres))
    yield from (
        ((("stress_of_set", key)), value) for key, value in (cell.stress_of_set or {}).items()
    )


def _numbers_of(part: BaseModel, path: Path) -> Iterator[tuple[Path, float]]:
    """Each number that is a key's value, and each in a table of numbers by name."""
    for key, value in part:
        if isinstance(value, float):
            yield (*path, key), value
        elif isinstance(value, Mapping):
            yield from (
                ((*path, key, name), number)
                for name, number in value.items()
                if isinstance(number, float)
            )


def _values(value: float | Mapping[str, float]) -> list[float]:
    return list(value.values()) if isinstance(value, Mapping) else [value]


def _micro(seconds: float) -> int:
    return round(seconds * MICRO)
