"""One question to one cell, worked on by several workers at once: what they share, and how they are
started, heard and halted.

The incumbent is what the dispatch rules gave, from the first moment on; nothing that comes later
may be worse. It is always a schedule that the checker has accepted (`door.py`), and so are the
values that bounds are held against.
"""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from queue import Empty, SimpleQueue

from ortools.sat.python import cp_model

from tandem.plan import cpsat
from tandem.plan.door import Admitted, Door
from tandem.plan.goal import Effort, Goal, GoalStatus
from tandem.plan.list_scheduling import Layout
from tandem.plan.provers import Prover, Step
from tandem.plan.starts import Starts, appended, measures

SMALL = 30
"""Up to so many tasks CP-SAT alone proves faster than it can be helped."""
MANY_TICKS = 10_000
"""With more ticks than these, a search that moves a bound tick by tick takes too long."""
LEAST_SPENT = 0.002
"""Deterministic seconds that a question counts besides its own, for stating it."""

Job = Callable[[], None]
"""What one worker does."""
Inbox = SimpleQueue[tuple["Race", Admitted | BaseException | None]]
"""What the workers of one or several races send: a schedule, what they stumbled over, or None when
one of them is done.
"""


def hear(inbox: Inbox, seconds: float) -> None:
    """Passes on what workers found, in the calling thread, waiting so long for the first of it;
    re-raises what they stumbled over.
    """
    try:
        while True:
            race, news = inbox.get(timeout=seconds) if seconds else inbox.get_nowait()
            seconds = 0
            if isinstance(news, BaseException):
                raise news
            if news is None:
                race.at_work -= 1
            else:
                race.effort.offer(news, race.bound)
    except Empty:
        return


class Race(ABC):
    """The state that the workers of one question share; `jobs` says who they are.

    Several races can go on at once: they are started with a common inbox, which their caller hears,
    and halted by it. `rules` are what the prover keeps, the cell's own when None; where they are
    more, the door has to know of them too.
    """

    def __init__(
        self,
        door: Door,
        layout: Layout,
        goal: Goal,
        effort: Effort,
        incumbent: Admitted | None,
        bound: int,
        inbox: Inbox | None = None,
        rules: Sequence[cpsat.Rule] | None = None,
    ) -> None:
        self.door, self.instance, self.layout, self.goal, self.effort = (
            door,
            door.instance,
            layout,
            goal,
            effort,
        )
        self.rules = cpsat.RULES if rules is None else rules
        self.lock = threading.Lock()
        self.best = incumbent
        self.value = None if incumbent is None else goal.value(*incumbent.point)
        self.known = self.bound = bound
        self.raised: dict[Prover, int] = {}
        self.by = Prover.CP_SAT
        self.infeasible = False
        self.stopped = False
        self.inserted = False
        self.inbox: Inbox = SimpleQueue() if inbox is None else inbox
        self.at_work = 0
        self.threads: list[threading.Thread] = []
        self.running: list[cp_model.CpSolver] = []

    @abstractmethod
    def jobs(self) -> list[Job]:
        """What each worker does."""

    @property
    def over(self) -> bool:
        """Nothing is left to do. A model that was wrong proves nothing any more: without a limit
        the others would go on for ever.
        """
        if self.door.refused and self.effort.until is None and self.effort.meter is None:
            return True
        return (
            self.stopped
            or self.infeasible
            or (self.value is not None and self.bound >= self.value)
            or self.effort.is_spent
        )

    def found(self, starts: Starts) -> bool:
        """Takes a schedule from a worker; says whether it is sound and the best so far."""
        makespan, stress = measures(self.instance, starts)
        if not self.goal.allows(makespan, stress) or (
            self.value is not None and self.goal.value(makespan, stress) >= self.value
        ):
            return False  # before the checker, which takes longer
        schedule = self.door.admit(starts)
        return schedule is not None and self.take_in(schedule)

    def proposed(self, starts: Starts, at_most: int) -> int | None:
        """Takes a schedule that the prover's model holds for sound and no dearer than `at_most`;
        its value, or None when it is not so.

        Then the model is wrong, which the door remembers, and nothing that is concluded from it
        counts.
        """
        schedule = self.door.vouched(starts)
        if schedule is None:
            return None
        value = self.goal.value(*schedule.point)
        if value > at_most or not self.goal.allows(*schedule.point):
            self.door.refuse([f"it is worth {value} instead of {at_most}, or over a limit."])
            return None
        # CP-SAT puts tasks off where that costs nothing; nobody shall wait for nothing
        taken = self.door.admit(appended(self.layout, schedule.starts)) or schedule
        self.take_in(taken)
        return min(value, self.goal.value(*taken.point))

    def take_in(self, schedule: Admitted) -> bool:
        """Takes a schedule that was let in; says whether it is the best so far."""
        value = self.goal.value(*schedule.point)
        with self.lock:
            if not self.goal.allows(*schedule.point) or (
                self.value is not None and value >= self.value
            ):
                return False
            self.best, self.value = schedule, value
        self.inbox.put((self, schedule))
        return True

    def raise_bound(self, bound: int, by: Prover | None = None) -> None:
        """Takes a bound from a worker, who says who proved it; or from elsewhere, where that is
        known already.
        """
        with self.lock:
            if bound > self.bound:
                self.bound = bound
                if by is not None:
                    self.raised[by], self.by = bound, by

    def run(self) -> GoalStatus:
        """Works until it is proven, time is up or someone interrupts."""
        try:
            self.start()
            while self.at_work:
                hear(self.inbox, 0.05)
                if self.over:
                    self.stop()
        finally:
            self.halt()
        return self.answer

    @property
    def answer(self) -> GoalStatus:
        """What is known so far."""
        starts = None if self.best is None else self.best.starts
        if self.door.refused:
            return GoalStatus(starts, self.known, False)
        return GoalStatus(
            starts,
            self.bound,
            self.infeasible or (self.value is not None and self.bound >= self.value),
            tuple(sorted(Step(bound, by) for by, bound in self.raised.items())),
            self.by,
        )

    def start(self) -> None:
        """Sets the workers to work; `at_work` of them have not yet been heard to be done."""
        jobs = [] if self.over else self.jobs()
        self.threads = [
            threading.Thread(target=self._guarded, args=(job,), daemon=True) for job in jobs
        ]
        self.at_work = len(self.threads)
        for thread in self.threads:
            thread.start()

    def stop(self) -> None:
        """Asks the workers to end."""
        self.stopped = True
        with self.lock:
            for solver in self.running:
                solver.stop_search()

    def halt(self) -> None:
        """Ends the workers and waits for them."""
        while any(thread.is_alive() for thread in self.threads):
            self.stop()  # again and again: a solver that has not begun yet does not hear it
            for thread in self.threads:
                thread.join(0.02)
        if self.door.refused:
            self.bound = self.known
            self.raised.clear()

    def _guarded(self, job: Callable[[], None]) -> None:
        try:
            job()
        except BaseException as error:  # noqa: BLE001  it is raised again in the calling thread
            self.inbox.put((self, error))
        self.inbox.put((self, None))

    @property
    def is_small(self) -> bool:
        return len(self.instance.tasks) <= SMALL or self.instance.stress_of_set is not None

    @property
    def is_fine(self) -> bool:
        """Few tasks and a great many ticks: see `CpSat`."""
        return self.is_small and self.instance.horizon > MANY_TICKS

    def await_incumbent(self) -> bool:
        while self.best is None and not self.over:
            threading.Event().wait(0.02)
        return self.best is not None and not self.over

    def spend(self, work: float) -> None:
        """Takes note of work that was done; whatever is asked costs something, so that it ends."""
        if self.effort.meter is not None:
            self.effort.meter.spend(work + LEAST_SPENT)

    def rule_out(self, by: Prover) -> None:
        if self.value is None:
            self.infeasible, self.by = True, by
        else:
            self.raise_bound(self.value, by)
