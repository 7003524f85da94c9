"""Those who lower the incumbent of a race: insertion by compiled code, and stretches that CP-SAT
plans anew, in turns.
"""

from __future__ import annotations

import threading
from math import ceil, inf
from random import Random

from tandem.plan import insertion
from tandem.plan.insertion import LEVEL_VISITS, Insertion
from tandem.plan.list_scheduling import by_start
from tandem.plan.lns import WORK as STRETCH_WORK
from tandem.plan.lns import plan_anew, take_out
from tandem.plan.race import Race
from tandem.plan.starts import Starts, append, in_time, measures
from tandem.plan.weights import MOST_COUNTED

STRETCHES_PER_WORK = 20
"""With bounded work: so many stretches per deterministic second of CP-SAT, so that both take about
as long.
"""
VISITS_PER_WORK = 1e7
"""Inserting passes by so many tasks in what counts as a deterministic second of CP-SAT, and takes
about as long.
"""
FIRST_VISITS, MOST_VISITS = 50_000, 1_000_000
"""So many between two looks at what the others found: few at first, when much is found."""
VAIN_VISITS = 2e7
"""Without an improvement for so many, stretches have their turn."""
REST_S = 0.02
"""Seconds between two looks at whether there is something to polish."""
VAIN_STRETCHES = 20
"""Without an improvement for so many stretches, insertion has its turn."""
EASY_WORK = STRETCH_WORK / 2
"""With less work than this a stretch was easy, and a longer one may be tried."""


def inserts(race: Race) -> bool:
    """Whether the compiled search knows the cell, and the cell is large enough."""
    return not race.is_small and insertion.knows(race.instance)


def await_loading(race: Race) -> None:
    """Waits until the compiled search is there. Where a clock runs, not until it is compiled
    anew; where none does, always, so that a run repeats.
    """
    while inserts(race) and insertion.is_loading() and not race.over:
        if race.effort.until is not None and insertion.is_compiling():
            return
        threading.Event().wait(0.01)


class Improver:
    """A worker of a race that draws from `random`."""

    def __init__(self, race: Race, random: Random) -> None:
        self.race, self.door, self.goal, self.random = race, race.door, race.goal, random
        self.instance, self.layout = race.instance, race.layout

    def run(self) -> None:
        """Inserts tasks elsewhere as long as that helps, then plans stretches anew, then inserts
        again.
        """
        if not self.race.await_incumbent():
            return
        await_loading(self.race)
        search, sizes = self._insertion(), self._first_sizes()
        while not self.race.over:
            if search is not None:
                self._insert(search, VAIN_VISITS)
                self._plan_stretches(sizes, patience=VAIN_STRETCHES)
            else:
                self._plan_stretches(sizes, most=1)
                search = self._insertion()

    def polish(self) -> None:
        """Inserts until that is in vain at one level of warmth, and again behind each schedule that
        others find; the rest of the time the core is theirs.
        """
        if not self.race.await_incumbent():
            return
        await_loading(self.race)
        while (search := self._insertion()) is None and not self.race.over:
            threading.Event().wait(REST_S)
        while search is not None and not self.race.over:
            self._insert(search, LEVEL_VISITS)
            known = self.race.value
            while self.race.value == known and not self.race.over:
                threading.Event().wait(REST_S)

    def run_once(self, patience: float = inf, work: float = inf) -> None:
        """The same in one thread, with so much work for each of both, by counts alone."""
        await_loading(self.race)
        search = self._insertion()
        if search is not None:
            self._insert(search, VAIN_VISITS, work * VISITS_PER_WORK)
        if not self.race.over:
            most = work if work == inf else ceil(STRETCHES_PER_WORK * work)
            self._plan_stretches(self._first_sizes(), patience, most)

    def _insertion(self) -> Insertion | None:
        """The compiled search, None where it does not know the cell or is not there yet."""
        moves = insertion.moves()
        if moves is None or not inserts(self.race):
            return None
        goal, search = self.goal, Insertion(self.layout, moves, self.random)
        search.aim(goal.time, goal.stress, goal.max_makespan, goal.max_stress)
        return search

    def _insert(self, search: Insertion, patience: float, visits: float = inf) -> None:
        """Inserts until so many visits were in vain in a row, or so many in all were made; takes in
        what is better on the way.
        """
        portion, vain, value = FIRST_VISITS, 0, None
        while not self.race.over and vain < patience and visits > 0:
            if value != self.race.value:  # somebody has found something better
                if self.race.best is None or not search.begin(self.race.best.starts):
                    return
                value, vain = self.race.value, 0
            done = search.go(min(portion, int(min(visits, MOST_VISITS))))
            self.race.spend(done / VISITS_PER_WORK)
            self.race.inserted = self.race.inserted or portion == MOST_VISITS
            vain, visits, portion = vain + done, visits - done, min(2 * portion, MOST_VISITS)
            if value is not None and search.value < value:
                starts = search.best()
                if starts is None or not self.race.found(starts):
                    value = None
                    vain += MOST_VISITS
                else:
                    value, vain = search.value, 0

    def _first_sizes(self) -> dict[int, float]:
        """Tasks in a stretch by how many operators are free in it, to begin with."""
        operators = len(self.instance.operators)
        some = (operators + 2) // 2 if operators > 2 else operators
        return dict.fromkeys({operators, min(operators, 2), some}, 24.0)

    def _plan_stretches(
        self, sizes: dict[int, float], patience: float = inf, most: float = inf
    ) -> None:
        """Takes out stretches and plans them anew, larger ones when that is quick; ends after
        `most` in all, or `patience` of them in vain in a row.
        """
        assert self.race.best is not None
        current = self.race.best.starts
        operators, tasks = len(self.instance.operators), len(self.instance.tasks)
        failures = tried = 0
        while not self.race.over and failures < patience and tried < most:
            tried += 1
            if self.goal.value(*measures(self.instance, current)) > (self.race.value or 0):
                current = current if self.race.best is None else self.race.best.starts
            width = self.random.choice(list(sizes))
            movers = frozenset(self.random.sample(range(operators), width))
            count = min(tasks, int(sizes[width]))
            first = max(
                0, min(tasks - count, self.random.randrange(-(count // 2), tasks - count // 2))
            )
            better, easy = self._try_stretch(current, first, count, movers)
            sizes[width] = min(sizes[width] * 1.05, tasks) if easy else max(8.0, sizes[width] * 0.9)
            failures += 1
            if better is None or (admitted := self.door.admit(better)) is None:
                continue
            current = admitted.starts  # of equal worth, too: from elsewhere there may be a way on
            if self.race.take_in(admitted):
                failures = 0

    def _try_stretch(
        self, current: Starts, first: int, count: int, movers: frozenset[int]
    ) -> tuple[Starts | None, bool]:
        """The schedule with one stretch planned anew, None when it is worse or breaks a limit; and
        whether that was easy.
        """
        instance, goal = self.instance, self.goal
        makespan, stress = measures(instance, current)
        order = by_start(instance, current)
        # the rest keeps its order and its ways, so limits are what the rest leaves of them
        stretch = take_out(instance, current, order, first, count, movers)
        rest = stress - sum(instance.ways[task][current[task][0]].stress for task in stretch.tasks)
        upper = makespan if goal.stress == 0 else goal.max_makespan or 2 * makespan
        most = None if goal.max_stress is None else goal.max_stress - rest
        weights = (goal.time, goal.stress)
        # where stress only has a limit it still breaks ties, as long as the sums stay countable
        if goal.stress == 0 and most is not None:
            hardest = sum(max(way.stress for way in ways) for ways in stretch.instance.ways)
            if (hardest + 1) * upper + hardest <= MOST_COUNTED:
                weights = (hardest + 1, 1)
        fresh, work = plan_anew(
            stretch, upper, most_stress=most, weights=weights, seed=self.random.randrange(1 << 30)
        )
        self.race.spend(work)
        easy = work < EASY_WORK
        if fresh is None:
            return None, easy
        # the stretch goes back by its order, not by its moments: list scheduling closes the gaps
        ways = [way for way, _ in current]
        for index, task in enumerate(stretch.tasks):
            ways[task] = stretch.ways[index][fresh[index][0]]
        middle = by_start(stretch.instance, fresh)
        order[first : first + count] = [stretch.tasks[index] for index in middle]
        # the tasks behind the stretch may begin at other moments now, so limits and deadlines are
        # asked again
        starts = append(self.layout, order, ways)
        if (
            starts is None
            or not goal.allows(*measures(instance, starts))
            or not in_time(instance, starts)
        ):
            return None, easy
        return (
            starts
            if goal.value(*measures(instance, starts)) <= goal.value(makespan, stress)
            else None
        ), easy
