"""Which task time, made shorter or longer, moves the front most: each variant planned anew, in
parallel processes.
"""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from time import monotonic
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.cell.parts import Table
from tandem.errors import CellError, InfeasibleError, NothingFoundError, UsageError
from tandem.explain.alternatives import rearranged
from tandem.explain.fronts import Point, area, reference
from tandem.plan import exact
from tandem.plan.question import Question
from tandem.plan.result import Front
from tandem.schedule.checker import faults
from tandem.schedule.measures import exact as decimal
from tandem.schedule.measures import makespan, stress
from tandem.schedule.model import Schedule

FINEST = 3
"""Decimals to which a changed time is rounded, seconds."""


@dataclass(frozen=True)
class Effect:
    """What one changed time does to the front.

    Attributes:
      task: whose time; `operators` is empty when all its times were changed together.
      share: -0.1 for a tenth shorter.
      floor: the least makespan then, seconds; None when there is no schedule, or none was found.
      seconds: by which the least makespan grows; negative for quicker.
      gain: by which the area that the front dominates grows, as a share of the base's area.
      proven: the variant's front is complete.
    """

    task: str
    operators: tuple[str, ...]
    share: float
    points: tuple[Point, ...]
    floor: float | None
    seconds: float | None
    gain: float | None
    proven: bool

    def to_dict(self) -> dict[str, Any]:
        return {
            "task": self.task,
            "operators": list(self.operators),
            "change": self.share,
            "front": [[plain(time), plain(load)] for time, load in self.points],
            "floor": plain(self.floor),
            "seconds": plain(self.seconds),
            "gain": None if self.gain is None else round(self.gain, 6),
            "proven": self.proven,
        }


@dataclass(frozen=True)
class Sensitivity:
    """Every effect, the largest first.

    Attributes:
      corner: (makespan, stress) against which areas are taken.
      interrupted: stopped from outside; some effects are missing.
    """

    front: Front
    corner: Point
    effects: tuple[Effect, ...]
    wall_s: float
    interrupted: bool = False

    def to_dict(self) -> dict[str, Any]:
        """The document of `tandem sensitivity --json`."""
        return {
            "schema_version": 1,
            "cell": self.front.cell.name,
            "cell_digest": self.front.cell.digest,
            "front": [[plain(time), plain(load)] for time, load in self.front.points],
            "complete": self.front.complete,
            "corner": list(map(plain, self.corner)),
            "effects": [effect.to_dict() for effect in self.effects],
            "solver": self.front.solver,
            "seed": self.front.seed,
            "interrupted": self.interrupted,
            "wall_s": round(self.wall_s, 3),
        }


def sensitivity(
    cell: Cell,
    shares: Sequence[float] = (-0.1,),
    *,
    each: bool = False,
    time_limit: float = 60.0,
    seed: int = 0,
    workers: int | None = None,
    on_done: Callable[[int, int], None] | None = None,
) -> Sensitivity:
    """Plans the cell once for each task and share, with that task's times changed, and ranks what
    that does.

    Args:
      shares: -0.1 makes a time a tenth shorter, 0.1 a tenth longer.
      each: change the time of one operator or group at a time, instead of all times of the task
        together.
      time_limit: seconds for everything. A front that is not complete by its share of it is marked
        so.
      workers: processes; one a core when not given.
      on_done: called with how many are done, and of how many.

    Raises:
      UsageError: a share that leaves no time.
      InfeasibleError: the cell itself has no schedule.
      NothingFoundError: none was found in the time, or a process that planned was killed.
    """
    began = monotonic()
    for share in shares:
        if not -1 < share <= 10 or share == 0:
            raise UsageError(f"change {share:+.0%}: must be above -100 % and not 0 %.")
    many = workers or os.cpu_count() or 1
    base = exact.solve(cell, Question(), time_limit=time_limit / 4, seed=seed, workers=many)
    corner = reference(base.points)
    jobs = [(task, who, share) for share in shares for task, who in _times(cell, each)]
    left = max(time_limit - (monotonic() - began), 1.0)
    seconds_each = max(left * many / max(len(jobs), 1), 0.2)
    effects, interrupted = _run(base, corner, jobs, seconds_each, seed, many, on_done)
    effects.sort(
        key=lambda effect: (
            -abs(effect.gain or 0.0),
            -abs(effect.seconds or 0.0),
            list(cell.tasks).index(effect.task),
        )
    )
    return Sensitivity(base, corner, tuple(effects), monotonic() - began, interrupted)


def _times(cell: Cell, each: bool) -> list[tuple[str, tuple[str, ...]]]:
    if not each:
        return [(task, ()) for task in cell.tasks]
    return [(task, mode.operators) for task in cell.tasks for mode in cell.modes(task)]


def scaled(cell: Cell, task: str, share: float, operators: tuple[str, ...] = ()) -> Cell:
    """The cell with the task's times longer by the share, to the millisecond; only the time of
    these operators when they are given.

    Raises:
      CellError: the cell with these times is not sound, such as one with a deadline that can no
        longer be met.
    """

    def new(seconds: float, who: tuple[str, ...]) -> float:
        if operators and set(who) != set(operators):
            return seconds
        return max(float(round(decimal(seconds) * (1 + decimal(share)), FINEST)), 10.0**-FINEST)

    old = cell.tasks[task]
    time = Table({who: new(seconds, (who,)) for who, seconds in old.time.items()})
    together = tuple(
        way.model_copy(update={"time": new(way.time, way.operators)}) for way in old.together
    )
    return cell.replace(
        tasks={**cell.tasks, task: old.model_copy(update={"time": time, "together": together})}
    )


def _run(
    base: Front,
    corner: Point,
    jobs: list[tuple[str, tuple[str, ...], float]],
    seconds: float,
    seed: int,
    workers: int,
    on_done: Callable[[int, int], None] | None,
) -> tuple[list[Effect], bool]:
    """Fresh processes, so that nothing of the caller's threads and libraries is inherited."""
    effects: list[Effect] = []
    pool = ProcessPoolExecutor(
        max_workers=min(workers, max(len(jobs), 1)), mp_context=multiprocessing.get_context("spawn")
    )
    try:
        futures: dict[Future[tuple[list[Point], bool]], tuple[str, tuple[str, ...], float]] = {}
        schedules = [result.schedule for result in base]
        for task, who, share in jobs:
            futures[
                pool.submit(_front_of, base.cell, schedules, task, share, who, seconds, seed)
            ] = (task, who, share)
        for done, future in enumerate(as_completed(futures), 1):
            points, proven = future.result()
            effects.append(_effect(base, corner, *futures[future], points, proven))
            if on_done:
                on_done(done, len(jobs))
    except KeyboardInterrupt:
        return effects, True
    except BrokenProcessPool as error:
        raise NothingFoundError(
            "a process that planned anew was ended from outside, perhaps for want of memory, with"
            f" {len(effects)} of {len(jobs)} planned. Run the command again, with fewer --workers."
        ) from error
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
    return effects, False


def _front_of(
    cell: Cell,
    known: Sequence[Schedule],
    task: str,
    share: float,
    who: tuple[str, ...],
    seconds: float,
    seed: int,
) -> tuple[list[Point], bool]:
    """The points of the variant's front, and whether it is complete; none when there is no schedule
    or none was found.

    A front that is not complete is joined with what the base's schedules give with the new times:
    else chance in the search, not the times, would decide the order of the tasks.
    """
    try:
        changed = scaled(cell, task, share, who)
        front = exact.solve(changed, Question(), time_limit=seconds, seed=seed, workers=1)
    except (InfeasibleError, CellError):
        return [], True
    except NothingFoundError:
        points = carried_over(changed, known)
        return points, False
    return (
        (front.points, True)
        if front.complete
        else (nondominated([*front.points, *carried_over(changed, known)]), False)
    )


def carried_over(cell: Cell, schedules: Sequence[Schedule]) -> list[Point]:
    """The points of the schedules of another cell with the same tasks, put together anew in their
    order with this cell's times; of the sound ones.
    """
    moved = [
        schedule
        for old in schedules
        if (schedule := rearranged(cell, old)) is not None and not faults(cell, schedule)
    ]
    return nondominated([(makespan(schedule), stress(cell, schedule)) for schedule in moved])


def nondominated(points: Sequence[Point]) -> list[Point]:
    """The points that no other beats, sorted by the first."""
    kept: list[Point] = []
    for point in sorted(set(points)):
        if not kept or point[1] < kept[-1][1]:
            kept.append(point)
    return kept


def _effect(
    base: Front,
    corner: Point,
    task: str,
    who: tuple[str, ...],
    share: float,
    points: list[Point],
    proven: bool,
) -> Effect:
    if not points:
        return Effect(task, who, share, (), None, None, None, proven)
    quickest = points[0][0]
    before = area(base.points, corner)
    gain = (area(points, corner) - before) / before
    return Effect(
        task,
        who,
        share,
        tuple(points),
        quickest,
        float(decimal(quickest) - decimal(base.points[0][0])),
        gain,
        proven,
    )
