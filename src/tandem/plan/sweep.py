"""How a front is worked through: which question is asked next, by whom and for how long, until
every gap is closed or time is up.

Every question is one to the whole cell within the limits of what the user asked, and its bound is
true of the cell whether or not the question was answered to the end. What a bound says about the
points:

- "The least makespan among schedules of at most `cap` stress" (the epsilon constraint; Haimes,
  Lasdon, Wismer 1971, IEEE Transactions on Systems, Man, and Cybernetics 1(3), 296-297). A bound of
  `b` ticks: no schedule of at most `cap` stress ends before `b`. It bounds the makespan of each
  point of at most `cap` stress, and of no other; the point that ends at `b` is the quickest for its
  stress.
- "The least stress among schedules that end by `latest`". A bound of `u` units: whatever has less
  than `u` stress ends after `latest`. It bounds the stress of each point that ends by `latest`, and
  of no other.

Both are facts of the `Archive`, and what a point is proven to be is read from all facts together.

Time is spent in rounds. A round asks about every gap that is open, where most is uncertain first,
with the same small work for each question; so what is cheap to prove is proven first, and all of
the front is seen early. A question that is proven leads to the gap behind its point in the same
round; one that is not rests until the next, which allows `GROWTH` times the work. Each worker has a
question of its own; when there are fewer questions than workers, the others go at the same ones in
another way. So nobody is idle while anything is open. Towards the end of a limit no question gets
more work than its share of what is left, so that the last of it does not go to a single one. With
one worker and no limit on time nothing depends on the clock, and a run repeats.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf
from queue import SimpleQueue
from time import monotonic

from tandem.plan.archive import Archive, Gap
from tandem.plan.door import Door
from tandem.plan.goal import Effort, Goal
from tandem.plan.portfolio import Portfolio
from tandem.plan.race import Inbox, Race, hear

FIRST_WORK = 0.25
"""CP-SAT's deterministic seconds for each question of the first round."""
GROWTH = 3
"""So many times the work of the round before: what was spent in vain in all earlier rounds is at
most half of the work of this one.
"""
PARTS = 8
"""The first round enters a front at the levels of stress that part it into so many equal parts, so
that all of it is seen.
"""


class Sweep:
    """Works on the gaps of an archive. `effort` says until when, with how many workers, from which
    seed, and to whom schedules are offered; `learned` is called when a question has been worked on.
    """

    def __init__(
        self, archive: Archive, door: Door, effort: Effort, learned: Callable[[], None]
    ) -> None:
        self.archive, self.door, self.effort, self.learned = archive, door, effort, learned
        self.limits = archive.limits
        self.round = -1
        self.asked = 0
        self.agenda: list[Goal] = []
        self.tried: set[Goal] = set()
        self.levels: list[int] = []
        self.running: dict[Race, Goal] = {}
        self.given: dict[Race, tuple[float, float]] = {}
        self.pace: float | None = None
        self.inbox: Inbox = SimpleQueue()

    def run(self) -> None:
        """Until nothing is open, time is up, or `effort.offer` raises; what was proven by then is
        in the archive.
        """
        try:
            while self._deal() or self.running:
                hear(self.inbox, 0.05)
                self._share()
                self._collect()
        finally:
            for race in self.running:
                race.stop()
            for race, goal in self.running.items():
                race.halt()
                self._learn(race, goal)

    def _deal(self) -> bool:
        """Gives every free worker something to do; says whether anybody got any."""
        dealt = False
        while len(self.running) < self.effort.workers and not self._is_over:
            goal = self._next()
            if goal is None:
                break
            self._ask(goal)
            dealt = True
        return dealt

    @property
    def _is_over(self) -> bool:
        """Time or work is up, or a model was wrong: then no question can be answered any more."""
        return self.effort.is_spent or bool(self.door.refused)

    def _next(self) -> Goal | None:
        """The next question of the round, or of the next round; one that is being worked on when
        there is no other; None when all is closed.
        """
        waiting = self._waiting()
        if not waiting:
            self._begin_round()
            waiting = self._waiting()
        if not waiting:
            return self._least_worked_on()
        goal = max(waiting, key=self._area)
        self.agenda.remove(goal)
        return goal

    def _waiting(self) -> list[Goal]:
        """What is on the agenda, still open, and not being worked on."""
        self.agenda = [goal for goal in self.agenda if self._is_open(goal)]
        return [goal for goal in self.agenda if goal not in self.running.values()]

    def _begin_round(self) -> None:
        """Puts a question to every open gap that nobody is working on; it is a new round only if
        there is one.
        """
        self.levels = self._spread_levels()
        questions = [
            goal for gap in self.archive.gaps for goal in self._questions(gap, self.round + 1)
        ]
        fresh = [goal for goal in questions if goal not in self.running.values()]
        if fresh:
            self.round += 1
            self.agenda = fresh
            self.tried.clear()

    def _spread_levels(self) -> list[int]:
        """Levels of stress that part the front, as far as it is known, into `PARTS` equal parts."""
        stresses = [stress for _, stress in self.archive.points]
        low, high = self.archive.least_stress, max(stresses, default=self.archive.least_stress)
        return sorted({low + (high - low) * part // PARTS for part in range(1, PARTS)})

    def _questions(self, gap: Gap, round_: int) -> list[Goal]:
        """How the gap is entered: at the levels that it spans, and from the second round on, or if
        it spans none, from its quick end; the last one is asked for the least stress.
        """
        if gap.end == self._after_limit and self.archive.found:
            return [self._gentlest(self.limits.max_makespan)]
        closing = self._quickest(gap.cap)
        if gap.cap == self._top:
            return [closing]
        inside = [self._quickest(level) for level in self.levels if gap.low <= level < gap.cap]
        halving = [goal for goal in inside if self._is_open(goal)]
        return halving if halving and round_ == 0 else [*halving, closing]

    @property
    def _top(self) -> float:
        return inf if self.limits.max_stress is None else self.limits.max_stress

    @property
    def _after_limit(self) -> float:
        return inf if self.limits.max_makespan is None else self.limits.max_makespan + 1

    def _quickest(self, cap: float) -> Goal:
        return Goal(1, 0, self.limits.max_makespan, None if cap == inf else int(cap))

    def _gentlest(self, latest: int | None) -> Goal:
        return Goal(0, 1, latest, self.limits.max_stress)

    def _is_open(self, goal: Goal) -> bool:
        """Whether the best schedule kept is not yet known to be best for this goal."""
        best = min(
            (goal.value(*point) for point in self.archive.points if goal.allows(*point)),
            default=inf,
        )
        return self._known(goal) < best

    def _known(self, goal: Goal) -> float:
        """What the facts say: no schedule has a lower value."""
        if goal.time:
            floor = self.archive.least_makespan(inf if goal.max_stress is None else goal.max_stress)
            return inf if floor >= self._after_limit else floor
        return self.archive.least_stress_within(
            inf if goal.max_makespan is None else goal.max_makespan
        )

    def _area(self, goal: Goal) -> float:
        """How much the answer may settle: of the gap that the question is about, open makespan
        times the stress on the lesser side of where it is entered. The front's two ends come first.
        """
        if goal.time and goal.max_stress == self.limits.max_stress:
            return inf
        gap = next((gap for gap in self.archive.gaps if self._is_about(goal, gap)), None)
        if gap is None or gap.end == self._after_limit:
            return inf
        entry = gap.cap if goal.max_stress is None or goal.stress else goal.max_stress
        width = entry - gap.low + 1
        return (gap.end - self.archive.least_makespan(entry)) * (
            width if entry == gap.cap else min(width, gap.cap - entry)
        )

    def _is_about(self, goal: Goal, gap: Gap) -> bool:
        """Whether the gap is entered by the question, or lies behind the point that it is about."""
        if goal.time:
            return goal.max_stress is not None and gap.low <= goal.max_stress <= gap.cap
        return goal.max_makespan is not None and gap.end > goal.max_makespan

    def _least_worked_on(self) -> Goal | None:
        """Of the questions that are being worked on and still open the one that has the fewest
        workers.
        """
        goals = [goal for goal in self.running.values() if self._is_open(goal)]
        return min(goals, key=goals.count, default=None)

    def _ask(self, goal: Goal) -> None:
        """Sets one worker to the question, from the best schedule and the best bound known; no two
        go at the same one in the same way.
        """
        company = list(self.running.values()).count(goal)
        effort = replace(
            self.effort,
            seed=self.effort.seed + self.asked,
            workers=1,
            work=self._work(),
            from_below=(self.round + company) % 2 == 0,
            refutes=self.effort.workers > 1,
        )
        self.asked += 1
        self.tried.add(goal)
        layout, known = self.archive.layout, self._known(goal)
        race = Portfolio(
            self.door, layout, goal, effort, self.archive.best(goal), int(known), self.inbox
        )
        self.running[race], self.given[race] = goal, (monotonic(), effort.work or FIRST_WORK)
        race.start()

    def _work(self) -> float:
        """CP-SAT's deterministic seconds for the next question: what the round allows, but no more
        than its share of what is left of the limit.
        """
        share = self._work_left() / (len(self.agenda) + 1)
        allowed: float = FIRST_WORK * GROWTH**self.round
        return min(allowed, max(FIRST_WORK, share))

    def _work_left(self) -> float:
        """What is left for all workers, at the pace that was seen; infinite when there is no
        limit.
        """
        if self.effort.meter is not None:
            return self.effort.meter.left
        if self.effort.until is None or not self.pace:
            return inf
        return max(0.0, self.effort.left()) * self.effort.workers / self.pace

    def _share(self) -> None:
        """Each race learns what the others found and proved; a lone one has nobody to learn
        from.
        """
        if len(self.running) < 2:
            return
        for race, goal in self.running.items():
            self._learn(race, goal)
        for race, goal in self.running.items():
            best = self.archive.best(goal)
            if best is not None:
                race.take_in(best)
            known = self._known(goal)
            if known == inf:
                race.stop()
            else:
                race.raise_bound(int(known))

    def _collect(self) -> None:
        """Ends the races that are over, and puts the questions that their proofs lead to on the
        agenda.
        """
        for race, goal in list(self.running.items()):
            if race.over:
                race.stop()
            if not race.at_work:
                race.halt()
                del self.running[race]
                self._keep_pace(race)
                self._learn(race, goal)
                self._follow(race, goal)
                self.learned()

    def _keep_pace(self, race: Race) -> None:
        """How many seconds a unit of work takes, by a question that used up what it was given; the
        latest ones count most, since others may come to use the machine.
        """
        began, work = self.given.pop(race)
        if not race.answer.proven and not race.over:
            pace = (monotonic() - began) / work
            self.pace = pace if self.pace is None else (self.pace + pace) / 2

    def _learn(self, race: Race, goal: Goal) -> None:
        """Makes facts of what the race has proven; the module's docstring says why they hold."""
        answer = race.answer
        none = answer.proven and answer.starts is None
        if goal.time:
            cap = inf if goal.max_stress is None else goal.max_stress
            for bound, by in answer.steps:
                self.archive.learn(cap, bound, by)
            if none:
                self.archive.learn(cap, inf, answer.by)
        else:
            latest = (
                inf
                if goal.max_makespan == self.limits.max_makespan
                else (goal.max_makespan or 0) + 1
            )
            cap = inf if goal.max_stress is None else goal.max_stress
            for bound, by in answer.steps:
                self.archive.learn(bound - 1, latest, by)
            if none:
                self.archive.learn(cap, latest, answer.by)

    def _follow(self, race: Race, goal: Goal) -> None:
        """Goes on along the front in the same round: from a proven point first to the least stress
        at its makespan, then to the gap behind it.
        """
        answer = race.answer
        is_at_the_end = goal.stress and goal.max_makespan == self.limits.max_makespan
        if answer.starts is None or is_at_the_end or (goal.time and not answer.proven):
            return
        allowed = [point for point in self.archive.points if goal.allows(*point)]
        if not allowed:
            return
        makespan, stress = min(allowed, key=lambda point: goal.value(*point))
        behind = [gap for gap in self.archive.gaps if gap.cap == stress - 1]
        if goal.time and self._is_open(gentlest := self._gentlest(makespan)):
            self._note([gentlest])
        else:
            self._note([step for gap in behind for step in self._questions(gap, self.round)])

    def _note(self, goals: list[Goal]) -> None:
        """Puts on the agenda what has not been asked in this round."""
        self.agenda += [
            goal for goal in goals if goal not in self.tried and goal not in self.agenda
        ]
