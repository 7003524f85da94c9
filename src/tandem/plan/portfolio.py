"""One question to one cell, worked on from two sides at once: one prover raises the bound,
improvers lower the incumbent, all share both.

The incumbent is what the dispatch rules gave, from the first moment on; nothing that comes later
may be worse. It is always a schedule that the checker has accepted (`door.py`), and so are the
values that bounds are held against.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from math import ceil, inf
from queue import Empty, SimpleQueue
from random import Random
from time import monotonic, thread_time
from typing import Any

from ortools.sat.python import cp_model

from tandem.plan import cpsat, insertion
from tandem.plan.cpsat import Decisions, formulate
from tandem.plan.door import Admitted, Door
from tandem.plan.insertion import Insertion
from tandem.plan.list_scheduling import Layout, by_start
from tandem.plan.lns import WORK as STRETCH_WORK
from tandem.plan.lns import plan_anew, take_out
from tandem.plan.lower_bound import Proof, prove_makespan
from tandem.plan.provers import Prover, Step
from tandem.plan.starts import Starts, append, appended, in_time, list_schedule, measures
from tandem.plan.weights import MOST_COUNTED


@dataclass(frozen=True)
class Goal:
    """The least `time * makespan + stress * stress` within limits; ticks and units."""

    time: int
    stress: int
    max_makespan: int | None = None
    max_stress: int | None = None

    def value(self, makespan: int, stress: int) -> int:
        """What is minimized."""
        return self.time * makespan + self.stress * stress

    def allows(self, makespan: int, stress: int) -> bool:
        """Whether the limits are kept."""
        return (self.max_makespan is None or makespan <= self.max_makespan) and (
            self.max_stress is None or stress <= self.max_stress
        )


@dataclass(frozen=True)
class GoalStatus:
    """What is known about a goal.

    Attributes:
      starts: the best schedule found, None when none was.
      bound: no schedule within the limits has a lower value; meaningless when the goal is proven
        infeasible.
      proven: the schedule is optimal or, when there is none, no schedule keeps the limits.
      steps: what each prover has added to the bound that was known before, rising.
      by: who proved last.
    """

    starts: Starts | None
    bound: int
    proven: bool
    steps: tuple[Step, ...] = ()
    by: Prover = Prover.CP_SAT


@dataclass
class Meter:
    """A limit on work, in CP-SAT's deterministic seconds, that counts down."""

    left: float

    def spend(self, work: float) -> None:
        """Takes note of work that was done."""
        self.left = max(0.0, self.left - work)


@dataclass
class Effort:
    """How hard to work, and on whose behalf.

    Attributes:
      until: `monotonic()` seconds at which to stop; None for never.
      seed, workers: of the search; one worker repeats exactly.
      offer: called in the calling thread with each schedule let in and the bound, may raise
        KeyboardInterrupt.
      work: CP-SAT's deterministic seconds after which a lone worker gives up; None to go on until
        it is proven.
      from_below: CP-SAT first tries whether the bound can be reached, which proves sooner and finds
        later than its own order of search.
      meter: how much work is left for everything, of one worker; None for no limit.
      refutes: a lone worker may also spend processor time on `refute`, which does not repeat.
    """

    until: float | None
    seed: int
    workers: int
    offer: Callable[[Admitted, int], None] = field(default=lambda schedule, bound: None)
    work: float | None = None
    from_below: bool = False
    meter: Meter | None = None
    refutes: bool = False

    @property
    def is_spent(self) -> bool:
        """Time is up, or the work is done."""
        return self.left() <= 0 or (self.meter is not None and self.meter.left <= 0)

    def left(self) -> float:
        """Seconds left."""
        return 1e9 if self.until is None else self.until - monotonic()


SMALL = 30
"""Up to so many tasks CP-SAT alone proves faster than it can be helped."""
MANY_TICKS = 10_000
"""With more ticks than these, a search that moves a bound tick by tick takes too long."""
LARGE = 150
"""From so many tasks on CP-SAT no longer proves anything whole; a relaxation gives the bound and
all cores improve.
"""
RELAXABLE = 1000
"""Beyond so many tasks the relaxation is left out: to state it takes seconds in which nobody can be
interrupted, and the prices of the operators' time, which are known by then, give the same bound.
"""
REFUTABLE = 80
"""Up to so many tasks a state-space search is tried beside the others."""
REFUTABLE_OPERATORS = 3
"""And of so many operators: with more there are too many states that none of them beats."""
REFUTE_NEAR = 0.9
"""It begins when the bound has come so near to the incumbent: far from it there is too much to
refute.
"""
REFUTE_S = 8.0
"""Processor seconds for it: it works fast or not at all."""
PATIENCE = 60
"""With one worker: so many stretches in a row without an improvement before CP-SAT has its turn."""
STRETCHES_PER_WORK = 20
"""With bounded work: so many stretches per deterministic second of CP-SAT, so that both take about
as long.
"""
LEAST_WORK = 1.0
"""Deterministic seconds below which CP-SAT does not come to search a large cell, so it is not
asked.
"""
VISITS_PER_WORK = 1e7
"""Inserting passes by so many tasks in what counts as a deterministic second of CP-SAT, and takes
about as long.
"""
FEW_CORES = 3
"""With so many workers at most, the first turn of insertion goes before the proof."""
FIRST_TURN_S = 0.3
"""Seconds that its first turn takes at most."""
FIRST_VISITS, MOST_VISITS = 50_000, 1_000_000
"""So many between two looks at what the others found: few at first, when much is found."""
VAIN_VISITS = 2e7
"""Without an improvement for so many, stretches have their turn."""
VAIN_STRETCHES = 20
"""Without an improvement for so many stretches, insertion has its turn."""
EASY_WORK = STRETCH_WORK / 2
"""With less work than this a stretch was easy, and a longer one may be tried."""
LEAST_SPENT = 0.002
"""Deterministic seconds that a question counts besides its own, for stating it."""
FIRST_TURN = 0.4
"""Deterministic seconds for a lone prover's first turn at both models; the next has twice that."""
ROWS_WORK = 0.25
"""Deterministic seconds at first for the implied rows beside a plain model: they prove soon, or
late.
"""
ROWS_SHARE = 0.25
"""Their share of the time."""
PATIENT_S = 1.0
"""Seconds for which a prover goes on when it has been overtaken; twice that the next time."""
RELAX_WORK = 2.0
"""Deterministic seconds for the question who does what."""


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


class Race:
    """The state that the workers of one question share.

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
        if self._inserts:
            insertion.load()  # it comes while the others begin
        jobs = self._alone() if self.effort.workers == 1 else self._together()
        if self.over:
            jobs = []
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
    def _is_small(self) -> bool:
        return len(self.instance.tasks) <= SMALL or self.instance.stress_of_set is not None

    @property
    def _is_fine(self) -> bool:
        """Few tasks and a great many ticks: see `_model`."""
        return self._is_small and self.instance.horizon > MANY_TICKS

    def _together(self) -> list[Callable[[], None]]:
        """One job per thread."""
        tasks, workers, seed = len(self.instance.tasks), self.effort.workers, self.effort.seed
        if self._is_small:
            return [partial(self.prove, workers, seed)]
        jobs: list[Callable[[], None]] = [
            partial(self.improve, Random(f"{seed} {i}")) for i in range(max(1, workers // 2))
        ]
        if tasks < LARGE:
            # where nothing inserts, one search more than cores: unlike ones help each other
            provers = workers if self._inserts else workers + 1
            return [*jobs, partial(self._prove_later, provers, seed), self.refute]

        def bound_then_improve() -> None:
            if workers <= FEW_CORES:
                self._await_loading()
            # without stress in it the prices of the operators' time have given the same bound
            stress = self.goal.stress or self.goal.max_stress is not None
            if tasks <= RELAXABLE and (stress or not self._inserts) and not self.over:
                self.relax(seed)
            self.improve(Random(f"{seed} -"))

        return [*jobs, bound_then_improve]

    def _prove_later(self, workers: int, seed: int) -> None:
        """Proves when insertion has had its first turn: on few cores it would come late else, and
        what it finds makes the proof shorter.
        """
        if self._inserts and self.effort.workers <= FEW_CORES:
            self._await_loading()
            until = monotonic() + FIRST_TURN_S
            while not self.inserted and monotonic() < until and not self.over:
                threading.Event().wait(0.01)
        self.prove(workers, seed)

    @property
    def _inserts(self) -> bool:
        return not self._is_small and insertion.knows(self.instance)

    def _alone(self) -> list[Callable[[], None]]:
        """Turn by turn in one thread, by counts and not by clocks, so that a run repeats."""
        return [
            self._turns if self.effort.work is None else partial(self._one_turn, self.effort.work)
        ]

    def _turns(self) -> None:
        seed, random, slice_ = self.effort.seed, Random(str(self.effort.seed)), 4.0
        if self._is_small:
            return self.prove(1, seed)
        if LARGE <= len(self.instance.tasks) <= RELAXABLE:
            self.relax(seed)
        while not self.over:
            if self.best is not None:
                self._improve_once(random, PATIENCE)
            self.prove(1, seed, work=slice_)
            slice_ *= 2
        return None

    def _one_turn(self, work: float) -> None:
        """Who does what, since it costs next to nothing; a proof, since most questions fall to one;
        then better schedules, and a search through all states if they are near the bound.
        """
        seed = self.effort.seed
        if not self._is_small and len(self.instance.tasks) <= RELAXABLE:
            self.relax(seed)
        if not self.over and (work >= LEAST_WORK or len(self.instance.tasks) < LARGE):
            self.prove(1, seed, work=work)
        if self.best is None or self._is_small:
            return
        self._improve_once(Random(str(seed)), work=work)
        refutable = (
            self.effort.refutes and not self.goal.stress and len(self.instance.tasks) <= REFUTABLE
        )
        if refutable and not self.over and self.bound >= REFUTE_NEAR * (self.value or 0):
            self._refute_for(min(REFUTE_S, work))

    def relax(self, seed: int) -> None:
        """Who does what, the order left out: a bound, and work shared out so that a list schedule
        is a good beginning.
        """
        plan = self._model(cpsat.ALLOCATION, self.best, True)
        solver = self._solver(1, seed, RELAX_WORK)
        status = self._solve(solver, plan)
        if status == cp_model.INFEASIBLE:
            return self._ruled_out(Prover.ALLOCATION)
        if status in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            self.raise_bound(ceil(solver.best_objective_bound - 1e-6), Prover.ALLOCATION)
            ways = [way for way, _ in plan.read(solver.value)]
            if (starts := list_schedule(self.layout, ways)) is not None:
                self.found(starts)
        return None

    def prove(self, workers: int, seed: int, work: float | None = None) -> None:
        """CP-SAT on the whole cell, in two models that prove unlike questions: the implied rows
        below the incumbent, and a plain one that begins with it. Side by side where there are
        `workers`, else in turns. `work` in deterministic seconds.
        """
        if self.effort.from_below or self._is_fine:
            return self._prove(not self._is_fine, workers, seed, work)
        if workers > 1:
            with ThreadPoolExecutor(1) as pool:
                beside = pool.submit(self._now_and_then, seed)
                self._prove(False, workers - 1, seed, work)
                return beside.result()
        turn = FIRST_TURN if work is None else work
        while self._may_prove:
            self._prove(True, 1, seed, turn * ROWS_SHARE)
            self._prove(False, 1, seed, turn * (1 - ROWS_SHARE))
            if work is not None:
                return None
            turn *= 2
        return None

    def _now_and_then(self, seed: int) -> None:
        """The implied rows beside a plain model: each time with twice the work, after a rest."""
        work = ROWS_WORK
        while self._may_prove:
            began = monotonic()
            self._prove(True, 1, seed, work)
            rested = monotonic() + (monotonic() - began) * (1 / ROWS_SHARE - 1)
            while self._may_prove and monotonic() < rested:
                threading.Event().wait(0.02)
            work *= 2

    def _prove(self, below: bool, workers: int, seed: int, work: float | None) -> None:
        """One of the models, begun again whenever the incumbent has moved away from under it."""
        # where ticks are fine one model does it all
        rules = self.rules if below or self._is_fine else self._plain
        patience = PATIENT_S
        while not self.over:
            with self.lock:
                incumbent, cut = self.best, self.value
            plan = self._model(rules, incumbent, below)
            solver = self._solver(workers, seed, work)
            watcher = _Watcher(self, solver, plan, cut, patience)
            solver.best_bound_callback = watcher.on_bound
            status = self._solve(solver, plan, watcher)
            if self.door.refused:
                return None
            if status == cp_model.INFEASIBLE:
                if cut is None:
                    return self._ruled_out(Prover.CP_SAT)
                return self._nothing_below(cut, below)
            if status == cp_model.OPTIMAL:
                value = self.proposed(plan.read(solver.value), round(solver.objective_value))
                return None if value is None else self.raise_bound(value, Prover.CP_SAT)
            if not watcher.outdated or work is not None:
                return None
            patience *= 2
        return None

    @property
    def _may_prove(self) -> bool:
        """What is asked of a model that was wrong counts for nothing."""
        return not self.over and not self.door.refused

    @property
    def _plain(self) -> tuple[cpsat.Rule, ...]:
        return tuple(rule for rule in self.rules if rule not in cpsat.IMPLIED)

    def refute(self) -> None:
        """State-space search for anything quicker than the incumbent; where operators have little
        choice it proves in a second what CP-SAT cannot.
        """
        if self.goal.stress or not self._is_refutable or not self._await_incumbent():
            return
        while not self.over and self.bound < REFUTE_NEAR * (self.value or 0):
            threading.Event().wait(0.05)
        self._refute_for(REFUTE_S)

    @property
    def _is_refutable(self) -> bool:
        return (
            len(self.instance.tasks) <= REFUTABLE
            and len(self.instance.operators) <= REFUTABLE_OPERATORS
        )

    def _refute_for(self, seconds: float) -> None:
        """The same for so many processor seconds."""
        if not self._is_refutable:
            return
        spent = thread_time() + seconds
        while not self.over and thread_time() < spent:
            proof = self._refuted(self.value or 0, spent)
            self.raise_bound(proof.bound * self.goal.time, Prover.STATES)
            if proof.starts is not None and not self._take(proof.starts):
                return

    def _refuted(self, value: int, spent: float) -> Proof:
        """How far the search for anything below this value came before the incumbent changed or its
        time was spent.
        """

        def stop() -> bool:
            return self.over or self.value != value or thread_time() > spent

        return prove_makespan(
            self.instance,
            value // self.goal.time,
            self.effort.left(),
            most_units=self.goal.max_stress,
            stop=stop,
        )

    def _take(self, starts: Sequence[tuple[int, int]]) -> bool:
        """Takes a schedule that knows precedence and operators only, if it can be made to keep the
        other rules too.
        """
        if self.instance.same_operator or any(
            limit is not None for limit in self.instance.stress_limit
        ):
            return False
        order = by_start(self.instance, starts)
        sound = append(self.layout, order, [way for way, _ in starts])
        return sound is not None and in_time(self.instance, sound) and self.found(sound)

    def improve(self, random: Random) -> None:
        """Inserts tasks elsewhere as long as that helps, then plans stretches anew, then inserts
        again.
        """
        if not self._await_incumbent():
            return
        self._await_loading()
        search, sizes = self._insertion(random), self._first_sizes()
        while not self.over:
            if search is not None:
                self._insert(search, VAIN_VISITS)
                self._plan_stretches(random, sizes, patience=VAIN_STRETCHES)
            else:
                self._plan_stretches(random, sizes, most=1)
                search = self._insertion(random)

    def _improve_once(self, random: Random, patience: float = inf, work: float = inf) -> None:
        """The same in one thread, with so much work for each of both, by counts alone."""
        self._await_loading()
        search = self._insertion(random)
        if search is not None:
            self._insert(search, VAIN_VISITS, work * VISITS_PER_WORK)
        if not self.over:
            most = work if work == inf else ceil(STRETCHES_PER_WORK * work)
            self._plan_stretches(random, self._first_sizes(), patience, most)

    def _await_loading(self) -> None:
        """Waits until the compiled search is there. Where a clock runs, not until it is compiled
        anew; where none does, always, so that a run repeats.
        """
        while self._inserts and insertion.is_loading() and not self.over:
            if self.effort.until is not None and insertion.is_compiling():
                return
            threading.Event().wait(0.01)

    def _insertion(self, random: Random) -> Insertion | None:
        """The compiled search, None where it does not know the cell or is not there yet."""
        moves = insertion.moves()
        if moves is None or not self._inserts:
            return None
        goal, search = self.goal, Insertion(self.layout, moves, random)
        search.aim(goal.time, goal.stress, goal.max_makespan, goal.max_stress)
        return search

    def _insert(self, search: Insertion, patience: float, visits: float = inf) -> None:
        """Inserts until so many visits were in vain in a row, or so many in all were made; takes in
        what is better on the way.
        """
        portion, vain, value = FIRST_VISITS, 0, None
        while not self.over and vain < patience and visits > 0:
            if value != self.value:  # somebody has found something better
                if self.best is None or not search.begin(self.best.starts):
                    return
                value, vain = self.value, 0
            done = search.go(min(portion, int(min(visits, MOST_VISITS))))
            self._spend(done / VISITS_PER_WORK)
            self.inserted = self.inserted or portion == MOST_VISITS
            vain, visits, portion = vain + done, visits - done, min(2 * portion, MOST_VISITS)
            if value is not None and search.value < value:
                starts = search.best()
                if starts is None or not self.found(starts):
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
        self, random: Random, sizes: dict[int, float], patience: float = inf, most: float = inf
    ) -> None:
        """Takes out stretches and plans them anew, larger ones when that is quick; ends after
        `most` in all, or `patience` of them in vain in a row.
        """
        assert self.best is not None
        current = self.best.starts
        operators, tasks = len(self.instance.operators), len(self.instance.tasks)
        failures = tried = 0
        while not self.over and failures < patience and tried < most:
            tried += 1
            if self.goal.value(*measures(self.instance, current)) > (self.value or 0):
                current = current if self.best is None else self.best.starts
            width = random.choice(list(sizes))
            movers = frozenset(random.sample(range(operators), width))
            count = min(tasks, int(sizes[width]))
            first = max(0, min(tasks - count, random.randrange(-(count // 2), tasks - count // 2)))
            better, easy = self._try_stretch(current, first, count, movers, random)
            sizes[width] = min(sizes[width] * 1.05, tasks) if easy else max(8.0, sizes[width] * 0.9)
            failures += 1
            if better is None or (admitted := self.door.admit(better)) is None:
                continue
            current = admitted.starts  # of equal worth, too: from elsewhere there may be a way on
            if self.take_in(admitted):
                failures = 0

    def _try_stretch(
        self, current: Starts, first: int, count: int, movers: frozenset[int], random: Random
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
            stretch, upper, most_stress=most, weights=weights, seed=random.randrange(1 << 30)
        )
        self._spend(work)
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

    def _await_incumbent(self) -> bool:
        while self.best is None and not self.over:
            threading.Event().wait(0.02)
        return self.best is not None and not self.over

    def _model(
        self, rules: Sequence[cpsat.Rule], incumbent: Admitted | None, below: bool
    ) -> Decisions:
        """The question as a model: anything below the incumbent, or the incumbent to begin with.

        Below, work that no longer fits is refuted at once. But to refute "better by a tick" CP-SAT
        may walk through millions of ticks one by one, on four tasks for minutes; and what a search
        learns from a schedule in its hands is lost. There it is left all of the time: with shorter
        domains it took several times as long to prove the same, or did not. Only where ticks are
        fine do they pay.
        """
        goal = self.goal
        value = None if incumbent is None else goal.value(*incumbent.point)
        upper = (
            self.instance.horizon
            if goal.max_makespan is None
            else min(goal.max_makespan, self.instance.horizon)
        )
        at_most = None if value is None or not (below or self._is_fine) else value - below
        if at_most is not None and goal.time:
            # with the least stress paid, the objective's bound is one on the time
            upper = min(upper, (at_most - goal.stress * self._least_stress) // goal.time)
        plan = formulate(self.instance, upper, rules)
        objective = goal.time * plan.makespan + goal.stress * plan.stress
        if goal.max_stress is not None:
            plan.model.add(plan.stress <= goal.max_stress)
        if at_most is not None:
            plan.model.add(objective <= at_most)
        if incumbent is not None and not below:
            plan.hint(incumbent.starts)
        plan.model.minimize(objective)
        return plan

    @property
    def _least_stress(self) -> int:
        if self.instance.stress_of_set is not None:
            return 0
        return sum(min(way.stress for way in ways) for ways in self.instance.ways)

    def _solver(self, workers: int, seed: int, work: float | None) -> cp_model.CpSolver:
        solver = cp_model.CpSolver()
        solver.parameters.num_workers = workers
        solver.parameters.random_seed = seed % (1 << 31)
        solver.parameters.catch_sigint_signal = False
        solver.parameters.use_objective_lb_search = self.effort.from_below and not self._is_fine
        if self.effort.until is not None:
            solver.parameters.max_time_in_seconds = max(0.01, self.effort.left())
        if work is not None:
            solver.parameters.max_deterministic_time = work
        if self.effort.meter is not None:
            solver.parameters.max_deterministic_time = min(
                solver.parameters.max_deterministic_time, self.effort.meter.left
            )
        solver.parameters.use_strong_propagation_in_disjunctive = self._is_fine
        return solver

    def _solve(
        self, solver: cp_model.CpSolver, plan: Decisions, watcher: _Watcher | None = None
    ) -> Any:
        with self.lock:
            self.running.append(solver)
        try:
            if self.stopped:
                return cp_model.UNKNOWN
            status: int = int(solver.solve(plan.model, watcher))  # type: ignore[call-overload]
            if status == cp_model.MODEL_INVALID:
                raise RuntimeError(
                    f"the constraint solver refuses the model: {plan.model.validate()}"
                )
            if status in (cp_model.UNKNOWN, cp_model.FEASIBLE) and watcher is not None:
                watcher.on_bound(solver.best_objective_bound)
            self._spend(solver.response_proto.deterministic_time)
            return status
        finally:
            with self.lock:
                self.running.remove(solver)

    def _spend(self, work: float) -> None:
        """Takes note of work that was done; whatever is asked costs something, so that it ends."""
        if self.effort.meter is not None:
            self.effort.meter.spend(work + LEAST_SPENT)

    def _nothing_below(self, value: int, below: bool) -> None:
        """The model has no solution although the incumbent's value is given; unless it asked for
        what is `below`, the incumbent itself was in it.
        """
        if not below:
            self.door.refuse(["the model leaves out a schedule that the checker has accepted."])
        else:
            self.raise_bound(value, Prover.CP_SAT)

    def _ruled_out(self, by: Prover) -> None:
        if self.value is None:
            self.infeasible, self.by = True, by
        else:
            self.raise_bound(self.value, by)


class _Watcher(cp_model.CpSolverSolutionCallback):
    """Hands on what the prover finds, and stops it when an improver has overtaken it for long."""

    def __init__(
        self,
        race: Race,
        solver: cp_model.CpSolver,
        plan: Decisions,
        cut: int | None,
        patience: float,
    ) -> None:
        super().__init__()
        self.race, self.solver, self.plan, self.cut, self.patience = (
            race,
            solver,
            plan,
            cut,
            patience,
        )
        self.began, self.mine, self.outdated = monotonic(), cut, False

    def on_solution_callback(self) -> None:
        starts = self.plan.read(self.value)
        self.mine = self.race.proposed(starts, round(self.objective_value))
        self._look()

    def on_bound(self, bound: float) -> None:
        known = ceil(bound - 1e-6)
        least = known if self.cut is None else min(known, self.cut)
        self.race.raise_bound(least, Prover.CP_SAT)
        self._look()

    def _look(self) -> None:
        race = self.race
        overtaken = race.value is not None and (self.mine is None or race.value < self.mine)
        if (
            race.over
            or race.door.refused
            or (overtaken and monotonic() - self.began > self.patience)
        ):
            self.outdated = not race.over
            self.solver.stop_search()
