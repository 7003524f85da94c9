"""`explain`: for each task why it stands where it stands and what every other way of doing it would
cost; and why nothing is quicker.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from time import monotonic
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.cell.names import Known, clean
from tandem.draw.imprint import imprint
from tandem.errors import UsageError
from tandem.explain.alternatives import EVERYTHING, Alternative, alternative, sentence
from tandem.explain.bottleneck import Bottleneck, floor
from tandem.explain.language import listed, words
from tandem.explain.variant import ways_not_taken
from tandem.explain.waiting import Waiting, waiting
from tandem.plan.choice import point_of
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.plan.result import Front, Result, Status
from tandem.schedule.model import Assignment

SHARE_FOR_FRONT = 0.3
SHARE_FOR_FLOOR = 0.2
SHARE_TO_END = 0.08
"""Of the time limit; the last is for the questions that are open when no new ones are begun, the
rest for the alternatives.
"""
QUESTIONS_EACH = 3


@dataclass(frozen=True)
class TaskAnswer:
    """One task in the chosen schedule.

    Attributes:
      waiting: what it waits for, and how far it could slip.
      alternatives: every way of doing it that the schedule does not take.
    """

    cell: Cell
    assignment: Assignment
    waiting: Waiting
    alternatives: tuple[Alternative, ...]

    def sentences(self, language: str = "en") -> list[str]:
        """Who and when, why then, and each alternative."""
        t = words(language)
        a = self.assignment
        label = self.cell.tasks[a.task].label
        head = t(
            "explain.task.label" if label else "explain.task",
            task=a.task,
            label=label,
            who=" + ".join(a.operators),
            span=t("span", start=t.number(a.start), end=t.number(a.end)),
            waiting=self.waiting.sentence(language),
        )
        others = [
            t("explain.instead", sentence=sentence(other, language)) for other in self.alternatives
        ]
        return [head, *(f"  {other}" for other in others or [t("explain.nobody")])]

    def to_dict(self, language: str = "en") -> dict[str, Any]:
        """One entry of `tasks` in an explanation's document; its sentences in this language."""
        a = self.assignment
        place = {
            "task": a.task,
            "operators": list(a.operators),
            "start": plain(a.start),
            "end": plain(a.end),
        }
        return {
            **place,
            **self.waiting.to_dict(),
            "alternatives": [other.to_dict() for other in self.alternatives],
            "sentences": self.sentences(language),
        }


@dataclass(frozen=True)
class Explanation:
    """Answers about one point of a front.

    Attributes:
      point: its number, counted from 1 in order of makespan.
      floor: None when one task was asked for.
    """

    front: Front
    point: int
    tasks: tuple[TaskAnswer, ...]
    floor: Bottleneck | None
    wall_s: float

    @property
    def result(self) -> Result:
        return self.front[self.point - 1]

    def to_dict(self, language: str = "en") -> dict[str, Any]:
        """The document of `tandem explain --json`; its sentences in this language."""
        return {
            "schema_version": 1,
            "cell": self.front.cell.name,
            "cell_digest": self.front.cell.digest,
            "point": self.point,
            "digest": self.result.schedule.digest,
            "canonical": self.result.canonical,
            "makespan": plain(self.result.makespan),
            "stress": plain(self.result.stress),
            "status": str(self.result.status),
            "complete": self.front.complete,
            "front": [[plain(time), plain(load)] for time, load in self.front.points],
            "floor": self.floor.to_dict(language) if self.floor else None,
            "tasks": [answer.to_dict(language) for answer in self.tasks],
            "solver": self.front.solver,
            "seed": self.front.seed,
            "wall_s": round(self.wall_s, 3),
        }


def explain(
    cell: Cell,
    *,
    front: Front | None = None,
    task: str | None = None,
    point: int | None = None,
    makespan: float | None = None,
    stress: float | None = None,
    time_limit: float = 17.0,
    seed: int = 0,
    workers: int | None = None,
    on_answer: Callable[[Front | Bottleneck | TaskAnswer], None] | None = None,
) -> Explanation:
    """Why the schedule of one point is as it is; every cost is that of a schedule found by planning
    anew, and says whether it is proven.

    Args:
      front: whose points are explained, as they are; planned when not given.
      task: only this one; without the floor.
      point: of the front, counted from 1 in order of makespan; the recommended compromise when not
        given.
      makespan, stress: instead, as `plan.choice.point_of` takes them.
      time_limit: seconds for everything. Costs that are not proven by then come with their bounds,
        or as not known.
      workers: threads that plan at the same time; one a core when not given.
      on_answer: called with the front, the floor and each task's answer as soon as it stands.

    Raises:
      UsageError: there is no such task or point.
      InfeasibleError: the cell has no schedule.
      NothingFoundError: none was found in the time.
    """
    began = monotonic()
    task = None if task is None else clean(task)
    if task is not None and task not in cell.tasks:
        raise UsageError(f"there is no task {task!r}. {Known(cell.tasks).hint(task)}")
    threads = workers or os.cpu_count() or 1
    if front is None:
        front = plan(
            cell,
            Question(),
            time_limit=max(time_limit * SHARE_FOR_FRONT, 0.2),
            seed=seed,
            workers=workers,
            confirm=False,
        )
    place = point_of(front, point, makespan, stress) + 1
    tell = on_answer or (lambda answer: None)
    tell(front)
    held = None
    if task is None:
        named = any(given is not None for given in (point, makespan, stress))
        quickest, cap = _quickest(front, place if named else 1)
        held = floor(
            cell,
            quickest,
            max_stress=cap,
            time_limit=max(time_limit * SHARE_FOR_FLOOR, 0.2),
            seed=seed,
            workers=threads,
        )
        tell(held)
    until = began + time_limit * (1 - SHARE_TO_END)
    answers = []
    for answer in _answers(
        front[place - 1], [task] if task is not None else None, until, seed, threads
    ):
        tell(answer)
        answers.append(answer)
    return Explanation(front, place, tuple(answers), held, monotonic() - began)


def _quickest(front: Front, place: int) -> tuple[Result, float | None]:
    """The point of this number as the quickest of all schedules with at most so much stress; None
    where the stress is no matter.
    """
    result, asked = front[place - 1], front.question
    if result.bound.makespan < result.makespan:  # whatever was asked, that is not proven
        result = replace(result, status=Status.FEASIBLE)
    no_matter = asked.max_stress is None and asked.minimize in ("front", "makespan") and place == 1
    return result, None if no_matter else result.stress


def _answers(
    result: Result, only: list[str] | None, until: float, seed: int, threads: int
) -> Iterator[TaskAnswer]:
    """In order of start; the alternatives of later tasks are planned while earlier answers are
    given.
    """
    cell = result.cell
    why = waiting(cell, result.schedule)
    rows = [a for a in result.schedule if only is None or a.task in only]
    questions = [(a.task, mode) for a in rows for mode in ways_not_taken(cell, a.task, a.operators)]
    pool = ThreadPoolExecutor(max_workers=min(threads, max(len(questions), 1)))
    left = len(questions)

    def find(name: str, mode: Any) -> Alternative:
        nonlocal left
        if monotonic() > until:
            return Alternative(name, mode.operators, mode.time, open=EVERYTHING)
        share = max(until - monotonic(), 0.2) * pool._max_workers / max(left, 1) / QUESTIONS_EACH
        left -= 1
        return alternative(cell, result, name, mode, time_limit=max(share, 0.1), seed=seed)

    found: dict[str, list[Future[Alternative]]] = {a.task: [] for a in rows}
    try:
        for name, mode in questions:
            found[name].append(pool.submit(find, name, mode))
        for a in rows:
            yield TaskAnswer(
                cell, a, why[a.task], tuple(future.result() for future in found[a.task])
            )
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def heading(front: Front, place: int, language: str = "en", *, stale: bool = False) -> str:
    """One sentence about the point that is explained; `stale`: its cell has changed since."""
    result, t = front[place - 1], words(language)
    who = "; ".join(
        t("explain.does", who=name, tasks=listed(t, [a.task for a in rows], word=False))
        for name in front.cell.operators
        if (rows := result.schedule.of(name))
    )
    return t(
        "explain.point",
        n=place,
        of=len(front),
        makespan=t.seconds(result.makespan),
        stress=t.number(result.stress),
        status=t(f"status.{result.status}"),
        plan=imprint(result, t, stale=stale),
        who=who,
    )
