"""What a front's makespans become on the floor, where times scatter: each plan carried out as it
stands, and with the rest planned anew at every event.

People comply; a task takes its stated time on average, and scatters by the `spread` that the cell
states for it, else by a common coefficient of variation (lognormal). All points, and both ways of
carrying a plan out, meet the same durations (common random numbers).

The assemblies come in parts. All points are carried out in one part before the next one begins, so
that they rest on the same assemblies when time is up.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf
from time import monotonic
from typing import Any, TypeVar

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.deciders.memory import settled_memory
from tandem.dispatch.deciders.policy import Basis, Chosen, Options, Policy
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.evaluation.as_planned import carried_out
from tandem.dispatch.evaluation.batch import EpisodeBatch
from tandem.dispatch.lookahead.objective import Objective
from tandem.errors import CellError, UsageError
from tandem.plan.result import Front, Quantiles, Risk, Status
from tandem.world.arrays import Names
from tandem.world.carried_out import Plan
from tandem.world.people import Person, compliant
from tandem.world.randomness import Chance, Draw

T = TypeVar("T")
Makespans = np.ndarray[Any, Any]
"""`[E]` seconds."""

EPISODES = 2_000
"""Assemblies in which each plan is carried out as it stands."""
PART, SMALLEST_PART = 100, 20
"""So many of them at once, and where tasks are many. Both divide `EPISODES`: a last part of another
size would be compiled anew.
"""
MOST_REPLANNED, FEWEST_REPLANNED = 100, 20
"""Assemblies in which each plan is planned anew at every event; the fewest are a part."""
DECISIONS = 4_000
"""So many decisions, about, for all points of a front; larger cells and fronts get fewer
assemblies, down to `FEWEST_REPLANNED`.
"""
REPLANNED_BY, OF_ANY_LIVE_CELL = "replan-robust", "longest-tail"
"""Who plans anew; and who is made at once and refuses the same cells."""

SHARE, LEAST_ASIDE_S = 1 / 3, 4.5
"""Of a time limit, what is set aside for the risk when it is asked for: this share, and at least so
many seconds, a second more than the beginning takes, since a search ends a little late.
"""
BEGINNING_S, BEGINNING_ANEW_S, WARMING_S = 3.5, 5.0, 2.0
"""Seconds of one core, about: of loading and compiling before the first assembly is carried out;
of compiling before the first one is planned anew; and in which each point's decider values its
first choices. None of it can be broken off, so where less is left it is not begun.
"""
STEPS_A_SECOND = 2e8
"""An assembly of `T` tasks is about `T ** 3` of them: each beginning and each end looks at every
pair of tasks.
"""


def searching(time_limit: float) -> float:
    """Seconds of a time limit that the search gets where a risk is asked for; all of them where
    more than half would have to be set aside.
    """
    aside = max(SHARE * time_limit, LEAST_ASIDE_S)
    return time_limit - aside if aside <= time_limit / 2 < inf else time_limit


def check_scatter(cell: Cell, cv: float) -> None:
    """Raises UsageError when no time scatters, neither by the cell nor by the cv."""
    if not cv and not any(task.scatters for task in cell.tasks.values()):
        raise UsageError(
            "no time of this cell scatters, so that no risk can be told: give --cv 0.2, or a"
            " `spread` in the cell."
        )


def has_time(front: Front, until: float | None, now: Callable[[], float] = monotonic) -> bool:
    """Whether a first part of the assemblies can be told by then; JAX need not be loaded to ask."""
    _, first_s = _part(front)
    return _Clock(until, now).leaves(BEGINNING_S + first_s)


def with_risk(
    front: Front,
    *,
    cv: float = 0.0,
    robust: bool = False,
    replanned: bool = True,
    seed: int = 0,
    until: float | None = None,
    now: Callable[[], float] = monotonic,
    tell: Callable[[str], None] = lambda _: None,
    missed: Callable[[str], None] = lambda _: None,
) -> Front:
    """The front, each point with its risk.

    Args:
      cv: coefficient of variation of the times for which the cell states no spread.
      robust: recommend by the P95 of the makespan as carried out.
      replanned: tell too what comes of re-planning, which takes many decisions.
      seed: of chance.
      until: `now()` seconds at which to stop. Fewer assemblies are then carried out, the same for
        all points; where there is not time for a part of them, the front comes back as it is, or
        nothing is told of re-planning. None for all assemblies: no clock is asked, and a seed gives
        the same numbers.
      tell: hears how far the work has come.
      missed: hears what there was no time for, "fixed" or "replanned" (`Risk`).

    Raises:
      UsageError: no time scatters; or a cv out of range.
      CellError: the cell is too large to be simulated.
    """
    check_scatter(front.cell, cv)
    if not has_time(front, until, now):
        missed("fixed")
        return front
    floor, clock = _Floor.of(front, cv, seed), _Clock(until, now)
    tell(f"carrying out {len(front)} plan{'s' * (len(front) != 1)}")
    try:
        fixed = floor.as_planned(clock)
    except _OutOfTimeError:
        missed("fixed")
        return front
    # second, so that it costs none of the assemblies that every point is judged by
    anew: list[Makespans] | None = None
    try:
        anew = floor.planned_anew(clock, tell) if replanned else None
    except _OutOfTimeError:
        missed("replanned")
    risks = [
        Risk(_quantiles(makespans), None if anew is None else _quantiles(anew[place]))
        for place, makespans in enumerate(fixed)
    ]
    found = (replace(result, risk=risk) for result, risk in zip(front, risks, strict=True))
    return replace(front, results=tuple(found), robust=robust)


def _part(front: Front) -> tuple[int, float]:
    """How many assemblies are carried out at once, and about how many seconds the first part takes
    for all points.
    """
    steps = len(front.cell.tasks) ** 3
    size = PART if PART * steps < STEPS_A_SECOND / 2 else SMALLEST_PART
    return size, len(front) * size * steps / STEPS_A_SECOND


class _OutOfTimeError(Exception):
    """Time is up: what is under way counts for nothing."""


@dataclass(frozen=True)
class _Clock:
    """What is asked for the time; it never is up without an `until`."""

    until: float | None
    now: Callable[[], float]

    def leaves(self, seconds: float) -> bool:
        """Whether so many are left."""
        return self.until is None or self.until - self.now() >= seconds

    def need(self, seconds: float = 0.0) -> None:
        """Raises _OutOfTimeError where fewer are left."""
        if not self.leaves(seconds):
            raise _OutOfTimeError


@dataclass(frozen=True)
class _Floor:
    """Where the points of a front are carried out: the chances of all assemblies, drawn once."""

    front: Front
    stage: EpisodeBatch
    seed: int

    @classmethod
    def of(cls, front: Front, cv: float, seed: int) -> _Floor:
        names = Names.of(front.cell)
        arrays = names.arrays()
        # people comply, so that no mood plays a part: one is drawn where each decision would have
        # its own, most of all numbers
        draw = replace(Draw.of(names, arrays, Chance("lognormal", cv)), decisions=1)
        people = Person(*(np.stack([np.asarray(part)] * EPISODES) for part in compliant(arrays)))
        return cls(front, EpisodeBatch.of(names, arrays, draw, people, seed), seed)

    def as_planned(self, clock: _Clock) -> list[Makespans]:
        """Of each point the makespans in seconds, of as many of `EPISODES` as there was time for;
        raises _OutOfTimeError as `_in_parts` does.
        """
        stage = self.stage
        plans = [Plan.of(stage.names, result.schedule) for result in self.front]

        def play(plan: Plan, part: slice) -> Makespans:
            clock.need()
            factor = stage.scenarios.factor[part, :, 0]
            return carried_out(stage.arrays, plan, factor) / stage.names.per_second

        return _in_parts(plans, EPISODES, _part(self.front)[0], play)

    def planned_anew(self, clock: _Clock, tell: Callable[[str], None]) -> list[Makespans] | None:
        """The same under a decider that follows the plan while it is good; None when the cell has a
        rule that cannot be kept live.
        """
        front = self.front
        try:
            policy(OF_ANY_LIVE_CELL, front.cell, Objective.of_point(front, 0))
        except CellError:
            return None
        count = DECISIONS // (2 * len(front.cell.tasks) * max(len(front), 1))
        count = min(MOST_REPLANNED, max(FEWEST_REPLANNED, count))
        clock.need(BEGINNING_ANEW_S + len(front) * WARMING_S)
        tell("planning anew at every event")
        deciders = [_decider(front, place, self.seed) for place in range(len(front))]
        clock.need(BEGINNING_ANEW_S)
        with settled_memory() as settle:

            def between() -> None:
                clock.need()
                settle()

            def play(decider: Policy, part: slice) -> Makespans:
                clock.need()
                # of one size, also where the last part is smaller: nothing is compiled anew
                some = self.stage.some(part.start, FEWEST_REPLANNED)
                return some.play(decider, part.stop - part.start, between=between).makespan

            return _in_parts(deciders, count, FEWEST_REPLANNED, play)


def _decider(front: Front, place: int, seed: int) -> Policy:
    """Who follows the plan of a point and leaves it where that gains."""
    result = front[place]
    basis = Basis.of(result, proven=result.status == Status.OPTIMAL)
    options = Options(seed=seed, plan=Chosen(result.schedule, basis))
    return policy(REPLANNED_BY, result.cell, Objective.of_point(front, place), options)


def _in_parts(
    points: Sequence[T], count: int, size: int, play: Callable[[T, slice], Makespans]
) -> list[Makespans]:
    """Of each point what `play` gives of the first `count` assemblies, part by part until it raises
    _OutOfTimeError: what came of that part then counts for no point. Without a whole part it is
    raised here, too.
    """
    found: list[list[Makespans]] = []
    for first in range(0, count, size):
        part = slice(first, min(first + size, count))
        try:
            found.append([play(point, part) for point in points])
        except _OutOfTimeError:
            if not found:
                raise
            break
    return [np.concatenate(mine) for mine in zip(*found, strict=True)]


def _quantiles(makespans: Makespans) -> Quantiles:
    p50, p95 = (round(float(np.quantile(makespans, share)), 4) for share in (0.5, 0.95))
    return Quantiles(p50, p95, len(makespans))
