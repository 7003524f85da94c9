"""Local search for large cells: tasks are taken out of a schedule and inserted elsewhere, by
compiled code.

What is compiled knows precedence, eligibility, own times, joint ways, releases, least waits after
an end, limits of people, `same_operator`, and zones and tools that exist once and cost no changes.
Cells that ask for more are left to stretches (`lns.py`). What comes out is an order and ways, from
which list scheduling makes the schedule, and the door judges it.

The compiler is Numba, which takes a while to import and, once for each installation, several
seconds to compile. So it is loaded when a cell is large enough to need it, in the background, and
compiled by a process of its own, which outlives a command that is over sooner.
"""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Sequence
from itertools import accumulate, chain
from random import Random
from types import ModuleType
from typing import Any

from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, Step, by_start
from tandem.plan.starts import Starts, append

WARMTH_OF_FEW, WARMTH_OF_MANY, FEW = 0.06, 0.03, 100
"""The loss accepted with probability 1/e, in mean ticks (and mean stress) of a task: up to `FEW`
tasks, and from twice as many on.
"""
LEVELS: tuple[tuple[float, int], ...] = ((1, 3), (2, 3), (4, 3), (8, 3), (16, 3))
"""How much warmer than that, and how many tasks are taken out at once at most: a search that finds
nothing better goes on at the next level, and behind the last at the first, from the best plan.
Cells of many operators with little choice, job shops, need the warm ones, most others the first.
"""
LEVEL_VISITS = 2_500_000
"""Without an improvement for so many visits the next level has its turn."""
MOST_OUT = max(out for _, out in LEVELS)


def knows(instance: Instance) -> bool:
    """Whether what is compiled holds every rule of the cell."""
    return not (
        instance.stress_of_set is not None
        or instance.has_most_lags
        or any(lag.from_start for lag in instance.lags)
        or any(deadline is not None for deadline in instance.deadline)
        or instance.has_breaks
        or instance.has_preparations
        or instance.has_apart
        or instance.has_holds
        or max((instance.zone_room[zone] for zone in instance.timed_zone if zone >= 0), default=0)
        > 1
        or any(instance.tool_room[tool] > 1 for tool in _used_tools(instance))
    )


def _used_tools(instance: Instance) -> set[int]:
    return {tool for ways in instance.ways for way in ways for tool, _ in instance.scarce(way)}


class Insertion:
    """A search from schedule to schedule towards one aim.

    Assumes that `knows(layout.instance)`, and that every task has a step.
    """

    def __init__(self, layout: Layout, moves: ModuleType, random: Random) -> None:
        """`moves` is the compiled code, see `moves`."""
        import numpy as np

        self.layout, self.moves = layout, moves
        self.parts = parts(layout, moves)
        tasks, ways = len(layout.steps), len(self.parts.ticks)
        resources, allowances = count_of_resources(layout.instance), len(self.parts.most)

        def plan() -> Any:
            return moves.Plan(*(np.full(tasks, -1, np.int64) for _ in range(4)))

        self.walk = moves.Walk(
            now=plan(),
            trial=plan(),
            best_order=np.zeros(tasks, np.int64),
            best_way=np.zeros(tasks, np.int64),
            worth=np.zeros(4, np.int64),
            draws=np.array([random.getrandbits(63) | 1], np.uint64),
            place=np.zeros(tasks, np.int64),
            out=np.zeros(MOST_OUT, np.int64),
            is_out=np.zeros(tasks, np.bool_),
            may=np.zeros(ways, np.bool_),
            free=np.zeros(resources, np.int64),
            behind=np.zeros((tasks + 1, resources), np.int64),
            carried=np.zeros(allowances, np.int64),
        )

    def aim(self, time: int, stress: int, most_ticks: int | None, most_units: int | None) -> None:
        """What is sought from now on: the least `time * makespan + stress * stress` within
        limits, None for no limit.
        """
        self.level = self.vain = 0
        spread = [
            max(step.stress for step in row) - min(step.stress for step in row)
            for row in self.layout.steps
        ]
        mean_ticks = sum(self.layout.quickest) / len(spread)
        warmth = min(WARMTH_OF_FEW, max(WARMTH_OF_MANY, WARMTH_OF_FEW * FEW / len(spread)))
        self.sought = self.moves.Aim(
            time,
            stress,
            self.moves.INFINITE if most_ticks is None else most_ticks,
            self.moves.INFINITE if most_units is None else most_units,
            max(1e-9, warmth * (time * mean_ticks + stress * sum(spread) / len(spread))),
            LEVELS[0][1],
        )

    def begin(self, starts: Starts) -> bool:
        """Goes on from this schedule; says whether it could: its ways must be those of steps."""
        import numpy as np

        numbers = [self._number(task, way) for task, (way, _) in enumerate(starts)]
        if any(number is None for number in numbers):
            return False
        order = np.array(by_start(self.layout.instance, starts), np.int64)
        way = np.array(numbers, np.int64)
        units = int(self.parts.stress[way].sum())
        source = self.moves.Plan(order, way, self.walk.now.head, self.walk.now.tail)
        self.moves.take(self.parts, self.walk, source, units, 0)
        self.moves.recount(self.parts, self.walk)
        self.walk.best_order[:], self.walk.best_way[:] = order, way
        value = self.sought.time * int(self.walk.worth[2]) + self.sought.stress * units
        self.walk.worth[:2] = value
        return True

    def _number(self, task: int, way: int) -> int | None:
        """The index among all ways of the step that does the task like this."""
        wanted = self.layout.instance.ways[task][way]
        for place, step in enumerate(self.layout.steps[task]):
            if step.operators == wanted.operators and step.ticks == wanted.ticks:
                return int(self.parts.way_of[task]) + place
        return None

    def go(self, visits: int) -> int:
        """Searches until so many tasks have been passed by; says how many."""
        factor, most_out = LEVELS[self.level]
        sought = self.sought._replace(warmth=factor * self.sought.warmth, most_out=most_out)
        before = self.value
        done = int(self.moves.rounds(self.parts, self.walk, sought, visits))
        self.vain = 0 if self.value < before else self.vain + done
        if self.vain >= LEVEL_VISITS:
            self.vain, self.level = 0, (self.level + 1) % len(LEVELS)
            if self.level == 0:
                self._go_back()
        return done

    def _go_back(self) -> None:
        """Goes on from the best plan, if the search is warm enough to have left it."""
        walk, now = self.walk, self.walk.now
        source = self.moves.Plan(walk.best_order, walk.best_way, now.head, now.tail)
        units = int(self.parts.stress[walk.best_way].sum())
        self.moves.take(self.parts, walk, source, units, 0)
        self.moves.recount(self.parts, walk)
        walk.worth[0] = walk.worth[1]

    @property
    def value(self) -> int:
        """Of the best schedule since the search began from one."""
        return int(self.walk.worth[1])

    def best(self) -> Starts | None:
        """That schedule, by list scheduling."""
        way_of, steps = self.parts.way_of, self.layout.steps
        ways = [
            steps[task][int(number - way_of[task])].way
            for task, number in enumerate(self.walk.best_way)
        ]
        return append(self.layout, self.walk.best_order.tolist(), ways)


def parts(layout: Layout, moves: ModuleType) -> Any:
    """The layout as arrays; a zone or a tool that exists once is one more resource."""
    import numpy as np

    instance, steps = layout.instance, list(chain.from_iterable(layout.steps))
    waits: dict[tuple[int, int], int] = {}
    for lag in instance.lags:
        pair = (lag.before, lag.task)
        waits[pair] = max(waits.get(pair, 0), lag.least)
    resources = [
        _resources(instance, task, step) for task, row in enumerate(layout.steps) for step in row
    ]
    dues = [step.dues for step in steps]
    groups = {group: number for number, group in enumerate({s.operators: 0 for s in steps})}
    behind = instance.behind

    def numbers(row: Sequence[int]) -> Any:
        return np.array(row, np.int64)

    return moves.Parts(
        first_of=_offsets(instance.before),
        firsts=numbers(list(chain.from_iterable(instance.before))),
        wait_of=numbers(
            [waits.get((first, t), 0) for t, row in enumerate(instance.before) for first in row]
        ),
        after_of=_offsets(behind),
        afters=numbers(list(chain.from_iterable(behind))),
        wait_after=numbers(
            [waits.get((t, after), 0) for t, row in enumerate(behind) for after in row]
        ),
        release=numbers(instance.release),
        way_of=_offsets(layout.steps),
        ticks=numbers([step.ticks for step in steps]),
        stress=numbers([step.stress for step in steps]),
        who_of=_offsets(resources),
        who=numbers(list(chain.from_iterable(resources))),
        due_of=_offsets(dues),
        owed=numbers([number for row in dues for number, _ in row]),
        due=numbers([due for row in dues for _, due in row]),
        team=numbers([groups[step.operators] for step in steps]),
        stays=np.array([team >= 0 for team in instance.team], np.bool_),
        most=numbers([allowance.most for allowance in instance.allowances]),
        limited=instance.has_limits,
    )


def _offsets(rows: Sequence[Sequence[Any]]) -> Any:
    import numpy as np

    return np.array([0, *accumulate(map(len, rows))], np.int64)


def count_of_resources(instance: Instance) -> int:
    """How many resources there are at most, see `_resources`."""
    return len(instance.operators) + len(instance.zones) + len(instance.tools)


def _resources(instance: Instance, task: int, step: Step) -> tuple[int, ...]:
    """The operators, and the zone and tools that only one can have."""
    operators, zone = len(instance.operators), instance.timed_zone[task]
    return (
        *step.operators,
        *((operators + zone,) if zone >= 0 else ()),
        *(operators + len(instance.zones) + tool for tool, _ in step.scarce),
    )


_lock, _compiling = threading.Lock(), threading.Event()
_loaded: list[ModuleType | None] = []
_loading: list[threading.Thread] = []


def load() -> None:
    """Begins to load the compiled code in the background, if nobody has begun yet."""
    with _lock:
        if not _loading:
            _loading.append(threading.Thread(target=_load, daemon=True))
            _loading[0].start()


def is_loading() -> bool:
    """Whether the compiled code may still come."""
    load()
    return not _loaded


def is_compiling() -> bool:
    """Whether nothing was kept from an earlier process, so that it takes long to come."""
    return _compiling.is_set() and not _loaded


def moves() -> ModuleType | None:
    """The compiled code, `insertion_moves`; None while it is loading and where Numba is not
    installed.
    """
    return _loaded[0] if _loaded else None


COMPILE = "from tandem.plan import insertion_moves; insertion_moves.warm()"


def _compile() -> None:
    """Has the code compiled by another process, and waits for it. Neither Ctrl-C nor the end of
    this one ends it, so that the next command finds the code.
    """
    nothing = subprocess.DEVNULL
    subprocess.run(
        [sys.executable, "-P", "-c", COMPILE],
        stdin=nothing,
        stdout=nothing,
        stderr=nothing,
        start_new_session=True,
        check=False,
    )


def _load() -> None:
    found: ModuleType | None = None
    try:
        from tandem.plan import insertion_moves

        if not insertion_moves.is_kept():
            _compiling.set()
            if insertion_moves.can_be_kept() and sys.executable:
                _compile()
        insertion_moves.warm()
        found = insertion_moves
    except ImportError:
        pass  # without Numba stretches do all the work
    finally:
        _loaded.append(found)
