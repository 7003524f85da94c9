"""Dispatch rules: a schedule in milliseconds, without a promise. The best of them is what every
other method begins with.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice
from random import Random
from time import perf_counter

from tandem.cell.model import Cell
from tandem.errors import NothingFoundError
from tandem.plan.bounds import load_prices, reckoned
from tandem.plan.door import Door
from tandem.plan.greedy import Score, by_rank, by_score, clockwise
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, PartialSchedule, Step, append_in_order, by_start
from tandem.plan.method import Hint, Method, Progress
from tandem.plan.question import Question
from tandem.plan.result import Bound, Front, Result, Status

Priority = Callable[[Layout, Random], list[float]]


@dataclass(frozen=True)
class Rule:
    """How a rule builds a schedule.

    Attributes:
      what: it does, in a line.
      build: the order of building: along the clock, down a list, or by score.
      priority: per task, least first.
      time, stress: what a step's end (ticks) and its stress (units) weigh when the step is chosen.
      prices: what a step's ticks weigh besides, each operator's time at its price
        (`bounds.load_prices`): work goes to whom it suits, so that a task rather waits for that
        operator than keeps another one busy for long.
      sweeps: the weight of stress is varied, so that the rule gives several compromises.
      samples: so many schedules are drawn, the priorities shaken by `temperature`; the first one is
        not shaken.
    """

    what: str
    build: Callable[[Layout, Sequence[float], Score], PartialSchedule | None]
    priority: Priority
    time: float = 1.0
    stress: float = 0.0
    prices: float = 0.0
    sweeps: bool = False
    samples: int = 1
    temperature: float = 0.0


def _shuffled(layout: Layout, random: Random) -> list[float]:
    return [random.random() for _ in layout.steps]


def _shortest(layout: Layout, _: Random) -> list[float]:
    return list(map(float, layout.quickest))


def _longest(layout: Layout, _: Random) -> list[float]:
    return [-float(ticks) for ticks in layout.quickest]


def _longest_tail(layout: Layout, _: Random) -> list[float]:
    return [-tail for tail in layout.tail]


def _upward_rank(layout: Layout, _: Random) -> list[float]:
    """Minus the longest chain from each task to the end over mean times (Topcuoglu et al. 2002,
    IEEE TPDS 13(3), equation 4).
    """
    rank = [0.0] * len(layout.steps)
    for task in reversed(layout.instance.order):
        mean = sum(step.ticks for step in layout.steps[task]) / len(layout.steps[task])
        rank[task] = mean + max(
            (rank[after] for after in layout.instance.behind[task]), default=0.0
        )
    return [-r for r in rank]


def latest_start(layout: Layout, _: Random) -> list[float]:
    """The tick by which each task must have started if it and all behind it are to keep their
    deadlines; what has none counts from the horizon. Waits are not looked at.
    """
    instance = layout.instance
    latest = [float(instance.horizon)] * len(layout.steps)
    for task in reversed(instance.order):
        deadline = instance.deadline[task]
        end = min(
            [
                instance.horizon if deadline is None else deadline,
                *(latest[after] for after in instance.behind[task]),
            ]
        )
        latest[task] = end - layout.quickest[task]
    return latest


SPECS: dict[str, Rule] = {
    "random": Rule("tasks in random order", clockwise, _shuffled),
    "spt": Rule("shortest task first", clockwise, _shortest),
    "lpt": Rule("longest task first", clockwise, _longest),
    "longest-tail": Rule(
        "the task with the longest chain behind it first", clockwise, _longest_tail
    ),
    "earliest-completion": Rule("whatever can be finished first", by_score, _longest_tail),
    "heft": Rule("by upward rank over mean times (Topcuoglu et al. 2002)", by_rank, _upward_rank),
    "least-stress": Rule(
        "the way with the least stress, then the longest tail",
        clockwise,
        _longest_tail,
        time=1e-6,
        stress=1.0,
    ),
    "balanced": Rule(
        "longest tail, work to whom it suits at the price of each operator's time",
        clockwise,
        _longest_tail,
        prices=8.0,
    ),
    "weighted": Rule(
        "longest tail, stress weighed against time",
        clockwise,
        _longest_tail,
        stress=1.0,
        sweeps=True,
    ),
    "best-of-n": Rule(
        "the best of 100 randomised schedules of the rule 'balanced'",
        clockwise,
        _longest_tail,
        prices=8.0,
        sweeps=True,
        samples=100,
        temperature=0.3,
    ),
}
"""Every rule by its name. A new one is a line here: it is then a method of planning and decides
live, too.
"""

SWEEP = (0.0, 0.03, 0.07, 0.12, 0.2, 0.3, 0.45, 0.65, 1.0, 1.5, 2.2, 3.3, 5.0, 10.0, 1e6)
"""Weights of stress against time that a sweep tries, in the cell's own mean time per mean stress of
a task.
"""

REPAIRS = 60
"""So many further schedules are tried when those of the rule break a limit or a deadline."""


def build(
    layout: Layout,
    rule: Rule,
    random: Random,
    *,
    stress: float | None = None,
    temperature: float | None = None,
    prices: Sequence[float] | None = None,
) -> PartialSchedule | None:
    """One schedule by the rule; None when it runs into a limit that leaves a task without a way.

    `stress` overrides the rule's weight of stress (per unit, against a weight of 1 per tick),
    `temperature` how far priorities are shaken: each is multiplied by a factor whose logarithm has
    this standard deviation. `prices` are those of `load_prices`; given, they need not be reckoned
    again.
    """
    time, weight = (rule.time, rule.stress) if stress is None else (1.0, stress)
    priority = rule.priority(layout, random)
    shake = rule.temperature if temperature is None else temperature
    if shake:
        priority = [p * random.lognormvariate(0.0, shake) for p in priority]
    if layout.instance.has_most_lags:
        priority = _urgent_first(layout, priority)

    def score(end: int, step: Step) -> float:
        return time * end + weight * step.stress

    if not rule.prices:
        return drawn_together(layout, rule.build(layout, priority, score))
    dear = rule.prices * (random.lognormvariate(0.0, 3 * shake) if shake else 1.0)
    price = [dear * price for price in (load_prices(layout)[1] if prices is None else prices)]

    def priced(end: int, step: Step) -> float:
        return score(end, step) + step.ticks * sum(price[operator] for operator in step.operators)

    return drawn_together(layout, rule.build(layout, priority, priced))


def _urgent_first(layout: Layout, priority: Sequence[float]) -> list[float]:
    """The priorities with the tasks first that must start within a time after another one."""
    urgent = {lag.task for lag, _ in layout.instance.most_lags}
    ahead = max(priority) - min(priority) + 1
    return [p - ahead if task in urgent else p for task, p in enumerate(priority)]


def drawn_together(layout: Layout, state: PartialSchedule | None) -> PartialSchedule | None:
    """The schedule with every task put off that another one would else follow too late, if its
    order lets it be.
    """
    if state is None or not layout.instance.has_most_lags:
        return state
    starts = state.starts()
    steps = [
        next(step for step in row if step.way == way)
        for row, (way, _) in zip(layout.steps, starts, strict=True)
    ]
    return append_in_order(layout, by_start(layout.instance, starts), steps)


def method(
    name: str,
    cell: Cell,
    question: Question = Question(),
    *,
    time_limit: float | None = None,
    work: float | None = None,
    seed: int = 0,
    workers: int | None = None,
    hint: Hint = None,
    on_solution: Callable[[Progress], None] | None = None,
) -> Front:
    """Schedules by the rule of this name, as every planning method gives them; see
    `plan.question.Method`. Nothing is proven but simple bounds.

    Rules that know only time give one point. "weighted" and "best-of-n" vary the weight of stress
    and give every compromise met. Where limits or deadlines are broken, schedules of least stress
    and by the latest start are tried before giving up. `work`, `workers` and `hint` play no part: a
    rule does the same work each time.

    Raises:
      NothingFoundError: no schedule was found that keeps the limits; whether there is one is open.
    """
    spec, random = SPECS[name], Random(seed)

    def made(layout: Layout, enough: Callable[[], bool]) -> Attempts:
        return ((name, state) for state in attempts(layout, spec, random, question, enough))

    return best_of(cell, question, made, name, "this rule", seed, time_limit, on_solution)


Attempts = Iterator[tuple[str, PartialSchedule | None]]
"""Who made it, and the schedule; None for an attempt that ran into a limit."""


def best_of(
    cell: Cell,
    question: Question,
    made: Callable[[Layout, Callable[[], bool]], Attempts],
    name: str,
    by: str,
    seed: int,
    time_limit: float | None,
    on_solution: Callable[[Progress], None] | None,
) -> Front:
    """The front of the schedules that are made one after the other, each judged by the checker.
    Nothing is proven but simple bounds.

    Args:
      made: of the layout, and of what says whether anything was found, the schedules.
      name: of the method; `solver` of the front names those who made what is left of it.
      by: who found nothing, in a message.

    Raises NothingFoundError when none of them keeps the limits.
    """
    began = perf_counter()
    layout = Layout.of(Instance.of(cell))
    bound = reckoned(layout)
    keeper = Keeper(Door(cell, layout.instance, question), bound)
    makers: dict[int, str] = {}
    interrupted = late = False
    # what was found so far is an answer, also when time runs out or the user interrupts
    try:
        for maker, state in made(layout, lambda: bool(keeper.found)):
            if state is not None and keeper.offer(state.starts()):
                makers[id(keeper.found[-1])] = maker
                if on_solution is not None:
                    on_solution(Progress(keeper.results(), bound.makespan, perf_counter() - began))
            late = time_limit is not None and perf_counter() - began > time_limit
            if late and keeper.found:
                break
    except KeyboardInterrupt:
        interrupted = True
    if not keeper.found:
        raise NothingFoundError(
            f"{name}: no schedule that keeps {keeper.limits()} was found by {by}; another"
            " method may find one."
        )
    who = {makers[id(result)] for result in keeper.found}
    return Front(
        cell,
        keeper.results(),
        False,
        name,
        ", ".join(sorted(who, key=lambda maker: (maker != name, maker))),
        seed,
        perf_counter() - began,
        interrupted,
        question,
        out_of_time=late,
    )


RULES: dict[str, Method] = {name: partial(method, name) for name in SPECS}
"""Every rule as a planning method."""


class Keeper:
    """Keeps the schedules that answer a question and that none of the others beats."""

    def __init__(self, door: Door, bound: Bound) -> None:
        self.door, self.question, self.bound = door, door.question, bound
        self.found: list[Result] = []

    def offer(self, starts: Sequence[tuple[int, int]]) -> bool:
        """Takes the schedule when it is sound, within the limits and better than what is there;
        says whether it did.
        """
        admitted = self.door.admit(starts)
        if admitted is None:
            return False
        result = Result(self.door.cell, admitted.schedule, Status.FEASIBLE, self.bound)
        point = self._rank(result)
        if self.question.minimize == "front":
            if any(
                other.makespan <= result.makespan and other.stress <= result.stress
                for other in self.found
            ):
                return False
            self.found = [
                other
                for other in self.found
                if other.makespan < result.makespan or other.stress < result.stress
            ]
        else:
            if any(self._rank(other) <= point for other in self.found):
                return False
            self.found = []
        self.found.append(result)
        return True

    def results(self) -> tuple[Result, ...]:
        """What is kept, by makespan."""
        return tuple(sorted(self.found, key=lambda result: result.makespan))

    def limits(self) -> str:
        """The limits in words."""
        return " and ".join([*self.question.limits, "the cell's own limits"])

    def _rank(self, result: Result) -> tuple[float, float]:
        if self.question.minimize == "weighted":
            time, stress = self.question.weights
            return (time * result.makespan + stress * result.stress, result.makespan)
        return (
            (result.stress, result.makespan)
            if self.question.minimize == "stress"
            else (result.makespan, result.stress)
        )


def attempts(
    layout: Layout, rule: Rule, random: Random, question: Question, enough: Callable[[], bool]
) -> Iterator[PartialSchedule | None]:
    """Schedules by the rule, then repairs until it is enough. None stands for an attempt that ran
    into a limit.
    """
    if layout.impossible():
        return
    # a rule would hardly meet a listed set by itself, so the sets are taken one by one
    if layout.instance.stress_of_set is not None:
        yield from _by_listed_sets(layout, rule, random)
        return
    prices = load_prices(layout)[1]
    # the first is the rule itself, without noise; the others draw around it
    for sample in range(rule.samples):
        for weight in _weights(layout, rule, question, sample, random):
            yield build(
                layout,
                rule,
                random,
                stress=weight,
                temperature=rule.temperature if sample else 0.0,
                prices=prices,
            )
    # while nothing keeps limits and deadlines: ever more weight on stress, or on what is due first
    for attempt in range(REPAIRS):
        if enough():
            return
        repair = Rule(
            "a repair",
            by_rank if attempt % 3 == 2 else clockwise,
            latest_start if attempt % 2 else _longest_tail,
        )
        yield build(
            layout,
            repair,
            random,
            stress=SWEEP[-1 - attempt // 2 % len(SWEEP)] * exchange_of(layout),
            temperature=0.02 * attempt,
        )


def _weights(
    layout: Layout, rule: Rule, question: Question, sample: int, random: Random
) -> Sequence[float | None]:
    """The weights of stress to build with: one drawn for a further sample, all for a rule that
    sweeps, the rule's own otherwise.
    """
    if not rule.sweeps:
        return (None,)
    if question.minimize == "makespan" and question.max_stress is None:
        own: tuple[float, ...] = (0.0,)
    elif question.minimize == "weighted" and question.weights[0]:
        own = (
            question.weights[1]
            / question.weights[0]
            * layout.instance.per_second
            / layout.instance.per_stress,
            0.0,
        )
    else:
        own = ()
    if sample:
        return (random.choice(own or SWEEP) * (1.0 if own else exchange_of(layout)),)
    return (*own, *(weight * exchange_of(layout) for weight in SWEEP))


def exchange_of(layout: Layout) -> float:
    """Ticks that one unit of stress is worth when the cell's time and its stress count the same."""
    steps = [step for row in layout.steps for step in row]
    stress = sum(step.stress for step in steps)
    return sum(step.ticks for step in steps) / stress if stress else 1.0


def _by_listed_sets(layout: Layout, rule: Rule, random: Random) -> Iterator[PartialSchedule | None]:
    """Schedules for the sets of human tasks that `stress_of_set` lists, least stress first; at most
    a few hundred sets.
    """
    table = layout.instance.stress_of_set or {}
    for tasks in islice(sorted(table, key=lambda tasks: (table[tasks], sorted(tasks))), 400):
        narrow = layout.with_humans_at(tasks)
        if not narrow.impossible():
            yield build(narrow, rule, random, temperature=0.0)
