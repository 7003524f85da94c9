"""What each other way of doing a task would cost: the cell with only that way, planned anew."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.cell.parts import Mode
from tandem.cell.written import number, signed
from tandem.errors import CellError, InfeasibleError, NothingFoundError
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
    state = append_in_order(layout, [at[a.task] for a in schedule], steps)
    return instance.schedule(state.starts())


def sentence(cell: Cell, found: Alternative) -> str:
    """What a person wants to know about the alternative."""
    who = " + ".join(found.operators)
    if not found.possible:
        return f"{who} ({number(found.time)} s): no schedule allows it."
    if found.open == EVERYTHING:
        return f"{who} ({number(found.time)} s): not looked at, time was short."
    if better := found.better:
        size = f"{number(better.makespan)} s, stress {number(better.stress)}"
        return (
            f"{who} ({number(found.time)} s): a better schedule, found only now, does it so:"
            f" {size}."
        )
    if found.costs_nothing:
        return (
            f"{who} ({number(found.time)} s): costs nothing, another schedule of the same makespan"
            " and stress does it so."
        )
    parts = []
    if found.at_same_stress:
        parts.append(
            f"{_more(found.at_same_stress.seconds, ' s')}"
            f" ({_size(found.at_same_stress, 'makespan')} s) at no more stress"
        )
    if found.in_same_time:
        parts.append(
            f"{_more(found.in_same_time.more_stress, ' stress')}"
            f" ({_size(found.in_same_time, 'stress')}) in no more time"
        )
    if found.otherwise:
        cost = found.otherwise
        parts.append(
            f"at best {number(cost.makespan)} s and stress {number(cost.stress)}"
            f" ({_more(cost.seconds, ' s')}, {_more(cost.more_stress, ' stress')})"
        )
    if not found.at_same_stress and TIME not in found.open and found.in_same_time:
        parts[-1] += "; no schedule keeps the stress"
    if not found.in_same_time and STRESS not in found.open and found.at_same_stress:
        parts[-1] += "; no schedule keeps the time"
    parts += [f"{question}: not known yet" for question in found.open]
    return f"{who} ({number(found.time)} s): {', or '.join(parts)}."


def _size(cost: Cost, what: str) -> str:
    value: float = getattr(cost, what)
    return (
        f"{number(value)}"
        if cost.proven or cost.bound >= value
        else f"{number(cost.bound)} to {number(value)}"
    )


def _more(value: float, unit: str) -> str:
    return f"{signed(value)}{unit}"
