"""Who works on a question, on how many cores: some raise the bound, others lower the incumbent, all
share both.
"""

from __future__ import annotations

import threading
from functools import partial
from random import Random
from time import monotonic

from tandem.plan import insertion
from tandem.plan.improving import Improver, await_loading, inserts
from tandem.plan.proving import PROVED_AT_ONCE, CpSat, States
from tandem.plan.race import Job, Race

LARGE = 150
"""From so many tasks on CP-SAT no longer proves anything whole; a relaxation gives the bound and
all cores improve.
"""
LARGE_JOB_SHOP = 200
"""The same where tasks have little choice: a plain model finds there what improvers do not."""
LITTLE_CHOICE = 1.5
"""Ways of a task, on the mean, that are little choice."""
MACHINES, SEARCHED = 10, 300
"""Operators at least of what is called a job shop then: with fewer the load decides, and rows that
say so. With so many tasks CP-SAT's own search takes too long to begin.
"""
RELAXABLE = 1000
"""Beyond so many tasks the relaxation is left out: to state it takes seconds in which nobody can be
interrupted, and the prices of the operators' time, which are known by then, give the same bound.
"""
PATIENCE = 60
"""With one worker: so many stretches in a row without an improvement before CP-SAT has its turn."""
LEAST_WORK = 1.0
"""Deterministic seconds below which CP-SAT does not come to search a large cell, so it is not
asked.
"""
FIRST_PROVED = 40
"""With one worker and up to so many tasks a proof is tried soon; beyond, a search that has the core
to itself finds more meanwhile.
"""
SHORT_WORK, FIRST_PROOF = 0.1, 0.4
"""Deterministic seconds of improving before that, and for it."""
FEW_CORES = 3
"""With so many workers at most, the first turn of insertion goes before the proof."""
FIRST_TURN_S = 0.3
"""Seconds that its first turn takes at most."""


class Portfolio(Race):
    """A race of all who can help."""

    def jobs(self) -> list[Job]:
        """One for each thread."""
        self.prover, self.states = CpSat(self), States(self)
        if inserts(self):
            insertion.load()  # it comes while the others begin
        if self.effort.workers > 1:
            return self._together()
        # turn by turn, by counts and not by clocks, so that a run repeats
        work = self.effort.work
        return [self._turns if work is None else partial(self._one_turn, work)]

    def _together(self) -> list[Job]:
        workers, seed = self.effort.workers, self.effort.seed
        if self.is_small:
            return [partial(self.prover.prove, workers, seed)]
        helpers = [Improver(self, Random(f"{seed} {i}")) for i in range(max(1, workers // 2))]
        if self._is_job_shop:
            polishers = [helper.polish for helper in helpers]
            return [*polishers, partial(self.prover.search, workers, seed)]
        improvers = [helper.run for helper in helpers]
        if not self._is_large:
            # where nothing inserts, one search more than cores: unlike ones help each other
            provers = workers if inserts(self) else workers + 1
            return [*improvers, partial(self._prove_later, provers, seed), self.states.run]
        return [*improvers, self._relax_and_improve]

    def _prove_later(self, workers: int, seed: int) -> None:
        """Proves when insertion has had its first turn, where the cell is not small: on few cores
        it would come late else, and what it finds makes the proof shorter.
        """
        is_large = len(self.instance.tasks) > PROVED_AT_ONCE
        if is_large and inserts(self) and self.effort.workers <= FEW_CORES:
            await_loading(self)
            until = monotonic() + FIRST_TURN_S
            while not self.inserted and monotonic() < until and not self.over:
                threading.Event().wait(0.01)
        self.prover.prove(workers, seed)

    def _relax_and_improve(self) -> None:
        """A bound without a proof, then one improver more."""
        seed = self.effort.seed
        if self.effort.workers <= FEW_CORES:
            await_loading(self)
        # without stress in it the prices of the operators' time have given the same bound
        stress = self.goal.stress or self.goal.max_stress is not None
        if self._is_relaxable and (stress or not inserts(self)) and not self.over:
            self.prover.relax(seed)
        Improver(self, Random(f"{seed} -")).run()

    @property
    def _is_large(self) -> bool:
        """Too large for a proof of the whole."""
        return len(self.instance.tasks) >= (LARGE_JOB_SHOP if self._has_little_choice else LARGE)

    @property
    def _has_little_choice(self) -> bool:
        ways = sum(map(len, self.instance.ways))
        return ways <= LITTLE_CHOICE * len(self.instance.tasks)

    @property
    def _is_job_shop(self) -> bool:
        """The order on many machines is nearly all there is to choose, and CP-SAT's own search is
        the best at that.
        """
        tasks, operators = len(self.instance.tasks), len(self.instance.operators)
        is_open = self._has_little_choice and operators >= MACHINES and tasks < SEARCHED
        is_timed = inserts(self) and not self.goal.stress
        return is_open and is_timed and not (self.is_fine or self.effort.from_below)

    @property
    def _is_relaxable(self) -> bool:
        return len(self.instance.tasks) <= RELAXABLE

    def _turns(self) -> None:
        """Better schedules and proofs by turns, each time with more work."""
        seed, slice_ = self.effort.seed, 4.0
        if self.is_small:
            return self.prover.prove(1, seed)
        if self._is_large and self._is_relaxable:
            self.prover.relax(seed)
        improver = Improver(self, Random(str(seed)))
        if len(self.instance.tasks) <= FIRST_PROVED and self.best is not None:
            improver.run_once(work=SHORT_WORK)
            if not self.over:
                self.prover.prove(1, seed, work=FIRST_PROOF)
        while not self.over:
            if self.best is not None:
                improver.run_once(PATIENCE)
            self.prover.prove(1, seed, work=slice_)
            slice_ *= 2
        return None

    def _one_turn(self, work: float) -> None:
        """Who does what, since it costs next to nothing; a proof, since most questions fall to one;
        then better schedules, and a search through all states if they are near the bound.
        """
        seed = self.effort.seed
        if not self.is_small and self._is_relaxable:
            self.prover.relax(seed)
        if not self.over and (work >= LEAST_WORK or not self._is_large):
            self.prover.prove(1, seed, work=work)
        if self.best is None or self.is_small:
            return
        Improver(self, Random(str(seed))).run_once(work=work)
        if self.effort.refutes and not self.over:
            self.states.run_near(work)
