"""What each other way of doing a task would cost: the cell with only that way, planned anew."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.cell.parts import Mode
from tandem.errors import CellError, InfeasibleError, NothingFoundError
from tandem.explain.language import Words, words
from tandem.explain.variant import force_modes
from tandem.plan import exact
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, append_in_order
from tandem.plan.question import Question
from tandem.plan.result import Result, Status
from tandem.schedule.measures import exact as decimal
from tandem.schedule.model import Schedule

TIME, STRESS, ANY = "time at the same stress", "stress in the same time", "any schedule"
EVERYTHING = (TIME, STRESS, ANY)
UNKNOWN = {TIME: "time", STRESS: "stress", ANY: "any"}
"""Question -> the last part of its words' key."""


@dataclass(frozen=True)
class Cost:
    """One schedule that does the task the other way, best in what was asked.

    Attributes:
      makespan, stress: of that schedule, seconds and the cell's measure.
      seconds, more_stress: more than the chosen point has; negative for less.
      proven: nothing better answers the same question.
      bound: the least makespan, or stress, that is not excluded.
    """

    makespan: float
    stress: float
    seconds: float
    more_stress: float
    proven: bool
    bound: float

    def to_dict(self) -> dict[str, Any]:
        return {
            key: plain(getattr(self, key))
            for key in ("makespan", "stress", "seconds", "more_stress", "proven", "bound")
        }


@dataclass(frozen=True)
class Alternative:
    """One way of doing a task that the schedule does not take.

    Attributes:
      operators, time: who, and seconds.
      at_same_stress: the quickest schedule with no more stress than the chosen point; None when
        there is none.
      in_same_time: the least stressful schedule that takes no longer; None when there is none.
      otherwise: the quickest schedule of all, when neither of the two exists.
      open: questions that time did not suffice to answer.
    """

    task: str
    operators: tuple[str, ...]
    time: float
    at_same_stress: Cost | None = None
    in_same_time: Cost | None = None
    otherwise: Cost | None = None
    open: tuple[str, ...] = ()

    @property
    def possible(self) -> bool:
        """Some schedule does the task this way, or it is not known that none does."""
        return bool(self.at_same_stress or self.in_same_time or self.otherwise or self.open)

    @property
    def costs_nothing(self) -> bool:
        """There is a schedule as good as the chosen one that does it this way."""
        return any(
            cost is not None and cost.seconds <= 0 and cost.more_stress <= 0
            for cost in (self.at_same_stress, self.in_same_time)
        )

    @property
    def better(self) -> Cost | None:
        """A schedule that beats the chosen one and does it this way: there is none when the chosen
        point is proven.
        """
        costs = [
            cost
            for cost in (self.at_same_stress, self.in_same_time)
            if cost is not None and cost.seconds <= 0 and cost.more_stress <= 0
        ]
        return next((cost for cost in costs if cost.seconds < 0 or cost.more_stress < 0), None)

    def to_dict(self) -> dict[str, Any]:
        costs = {
            key: cost.to_dict() if (cost := getattr(self, key)) else None
            for key in ("at_same_stress", "in_same_time", "otherwise")
        }
        return {
            "operators": list(self.operators),
            "time": plain(self.time),
            "possible": self.possible,
            **costs,
            "open": list(self.open),
        }


def alternative(
    cell: Cell,
    point: Result,
    task: str,
    mode: Mode,
    *,
    time_limit: float = 5.0,
    seed: int = 0,
    workers: int = 1,
) -> Alternative:
    """What doing the task in this mode would cost, compared with the point; at most three questions
    of `time_limit` seconds each.

    Every number is the answer of the exact planner to the cell without the task's other modes.
    """
    try:
        forced = force_modes(cell, {task: mode})
    except CellError:
        return Alternative(task, mode.operators, mode.time)
    begin = rearranged(forced, point.schedule)
    open_questions: list[str] = []

    def ask(question: Question, words: str) -> Cost | None:
        try:
            found = exact.solve(
                forced, question, time_limit=time_limit, seed=seed, workers=workers, hint=begin
            )[0]
        except InfeasibleError:
            return None
        except NothingFoundError:
            open_questions.append(words)
            return None
        bound = _bound(found, point, question)
        more = (
            float(decimal(found.makespan) - decimal(point.makespan)),
            float(decimal(found.stress) - decimal(point.stress)),
        )
        return Cost(found.makespan, found.stress, *more, found.status is Status.OPTIMAL, bound)

    same_stress = ask(Question("makespan", max_stress=point.stress), TIME)
    free = same_stress is not None and same_stress.seconds <= 0
    same_time = (
        same_stress if free else ask(Question("stress", max_makespan=point.makespan), STRESS)
    )
    otherwise = None if same_stress or same_time else ask(Question("makespan"), ANY)
    return Alternative(
        task, mode.operators, mode.time, same_stress, same_time, otherwise, tuple(open_questions)
    )


def _bound(found: Result, point: Result, question: Question) -> float:
    """What is excluded for the whole cell is excluded for each way of doing a task: the point's own
    bound counts too under its own limits.
    """
    if question.minimize == "stress":
        return max(found.bound.stress, point.bound.stress)
    return (
        max(found.bound.makespan, point.bound.makespan)
        if question.max_stress is not None
        else found.bound.makespan
    )


def rearranged(cell: Cell, schedule: Schedule) -> Schedule | None:
    """The schedule's tasks in the same order, as early as the cell allows, each in the way it was
    done where it still can be, else in its quickest way: something to begin the search with. It may
    break a limit of the cell; None when it cannot be built.
    """
    instance = Instance.of(cell)
    layout = Layout.of(instance)
    at = {name: place for place, name in enumerate(instance.tasks)}
    steps = []
    for task, name in enumerate(instance.tasks):
        who = next(a.operators for a in schedule if a.task == name)
        same = [
            step
            for step in layout.steps[task]
            if {instance.operators[i] for i in step.operators} == set(who)
        ]
        options = same or sorted(layout.steps[task], key=lambda step: step.ticks)
        if not options:
            return None
        steps.append(options[0])
    place = {task: index for index, task in enumerate(instance.order)}
    rows = sorted(schedule, key=lambda a: (a.start, place[at[a.task]]))
    state = append_in_order(layout, [at[a.task] for a in rows], steps)
    return None if state is None else instance.schedule(state.starts())


def sentence(found: Alternative, language: str = "en") -> str:
    """What a person wants to know about the alternative."""
    t = words(language)
    way = {"who": " + ".join(found.operators), "time": t.seconds(found.time)}
    if not found.possible:
        return t("other.impossible", **way)
    if found.open == EVERYTHING:
        return t("other.open", **way)
    if better := found.better:
        values = {"makespan": t.seconds(better.makespan), "stress": t.number(better.stress)}
        return t("other.better", **way, **values)
    if found.costs_nothing:
        return t("other.free", **way)
    said = ""
    for part in _costs(found, t):
        said = t("or", first=said, last=part) if said else part
    return t("other.costs", **way, costs=said)


def _costs(found: Alternative, t: Words) -> list[str]:
    parts = []
    if cost := found.at_same_stress:
        parts.append(t("other.time", more=t.signed(cost.seconds), size=_size(cost, "makespan", t)))
    if cost := found.in_same_time:
        size = _size(cost, "stress", t)
        parts.append(t("other.stress", more=t.signed(cost.more_stress), size=size))
    if cost := found.otherwise:
        values = {"makespan": t.seconds(cost.makespan), "stress": t.number(cost.stress)}
        more = {"seconds": t.signed(cost.seconds), "more": t.signed(cost.more_stress)}
        parts.append(t("other.any", **values, **more))
    if not found.at_same_stress and TIME not in found.open and found.in_same_time:
        parts[-1] = t("other.no_stress", cost=parts[-1])
    if not found.in_same_time and STRESS not in found.open and found.at_same_stress:
        parts[-1] = t("other.no_time", cost=parts[-1])
    return parts + [t(f"other.unknown.{UNKNOWN[question]}") for question in found.open]


def _size(cost: Cost, what: str, t: Words) -> str:
    value: float = getattr(cost, what)
    if cost.proven or cost.bound >= value:
        return t.number(value)
    return t("other.range", low=t.number(cost.bound), high=t.number(value))
