"""`learned` as a method of planning: schedules by the policy for any cell, one greedy and the
others drawn, and never worse than the best dispatch rule.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from random import Random
from time import perf_counter

import numpy as np

from tandem.cell.model import Cell
from tandem.learn.graph.drawing import Drawing, Known
from tandem.learn.graph.familiar import confidence
from tandem.learn.graph.making import Maker, temperature_of
from tandem.learn.graph.network import Weights
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.trained import weights_of
from tandem.learn.graph.weights import shipped
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, PartialSchedule
from tandem.plan.method import Hint, Progress
from tandem.plan.question import Question
from tandem.plan.result import Front
from tandem.plan.rules import SPECS, SWEEP, Attempts, attempts, best_of, drawn_together, exchange_of
from tandem.plan.starts import Starts

NAME = "learned"
SAMPLES = 64
"""Schedules in all, unless another number is asked for."""
WARMER = 4.5
"""What temperature is multiplied by for a front: points between two weights are met by chance.
Tuned on cells of ten tasks with seeds from 500,000 on.
"""
UNLIKE = ("random",)
"""Rules that are no yardstick: one schedule that is drawn."""


def learned(
    cell: Cell,
    question: Question = Question(),
    *,
    time_limit: float | None = None,
    work: float | None = None,
    seed: int = 0,
    workers: int | None = None,
    samples: int = SAMPLES,
    policy: Path | None = None,
    hint: Hint = None,
    on_solution: Callable[[Progress], None] | None = None,
) -> Front:
    """the best of 64 schedules by one network for all cells, or what the best dispatch rule finds

    `policy` is a file of weights that were tuned (`tandem train --recipe graph`); else those that
    come with Tandem decide. With `samples` of so many, one of them greedy; for a front they are
    shared out over the weights of stress, with a greedy one for each. No schedule is drawn twice,
    and what can be no better than what is known is given up; it takes no more decisions than so
    many schedules have.

    Every rule is asked too, so that no answer is worse than theirs; `solver` names those that gave
    a point of the front. Nothing is proven but simple bounds. `work`, `workers` and `hint` play no
    part: the same number of schedules is made each time.

    Raises NothingFoundError when neither found a schedule that keeps the limits.
    """

    began, weights, chances = perf_counter(), weights_of(policy), list[float]()

    def is_late() -> bool:
        return time_limit is not None and perf_counter() - began > time_limit

    def made(layout: Layout, enough: Callable[[], bool]) -> Attempts:
        # the policy comes first: a rule is named only where it found something better
        if _can_take(layout):
            asked = weights_of_stress(layout, question)
            each = samples // len(asked)
            for state in by_weights(layout, weights, asked, each, seed, is_late, chances.append):
                yield NAME, drawn_together(layout, state)
        for name, rule in SPECS.items():
            if name not in UNLIKE:
                for state in attempts(layout, rule, Random(seed), question, enough):
                    yield name, state

    by = "the policy or by a rule"
    front = best_of(cell, question, made, NAME, by, seed, time_limit, on_solution)
    layout = Layout.of(Instance.of(cell))
    return replace(front, confidence=confidence(layout, chances)) if _can_take(layout) else front


def opening(layout: Layout, question: Question, is_late: Callable[[], bool]) -> Iterator[Starts]:
    """Greedy schedules by the shipped weights, for the exact planner to begin from: one, or for a
    front one at each weight of stress, so that the first few are far from each other. None for one
    schedule whose limits leave the weight open.
    """
    asked = weights_of_stress(layout, question)
    if not _can_take(layout) or (len(asked) > 1 and question.minimize != "front"):
        return
    # the first, then the middle one, then those between, and so on
    order = sorted(range(len(asked)), key=lambda at: at & -at or len(asked), reverse=True)
    for state in by_weights(layout, shipped(), [asked[at] for at in order], 1, 0, is_late):
        if (whole := drawn_together(layout, state)) is not None:
            yield tuple(whole.starts())


def _can_take(layout: Layout) -> bool:
    """Stress that is listed by sets of tasks says nothing of a single one: only rules can take
    it.
    """
    return not layout.impossible() and layout.instance.stress_of_set is None


def by_weights(
    layout: Layout,
    network: Weights,
    weights: Sequence[float],
    each: int,
    seed: int,
    is_late: Callable[[], bool] = lambda: False,
    hear: Callable[[float], None] = lambda _: None,
) -> Iterator[PartialSchedule | None]:
    """Schedules by the policy: of each weight of stress one greedy, then drawn ones up to `each`,
    until it `is_late`; none twice at a weight, and none that what is known beats. Where there are
    several weights, the drawn ones differ more.

    Args:
      hear: hears the chance that the network gives its choices in each greedy schedule.
    """
    random, known = np.random.default_rng(seed), Known(whole=len(weights) > 1)
    heat = temperature_of(len(layout.steps)) * (WARMER if known.whole else 1.0)
    for weight in weights:
        if is_late():
            return
        drawing = Drawing(Maker.of(network, Outlook.of(layout, weight)), random, heat, known)
        state, chance = drawing.greedy(is_late)
        if chance is not None:
            hear(chance)
        yield state
        yield from drawing.drawn(each - 1, is_late)


def weights_of_stress(layout: Layout, question: Question) -> Sequence[float]:
    """What a unit of stress is worth in ticks, of each policy that is asked."""
    instance, most = layout.instance, SWEEP[-2]
    is_given = all(step.stress == row[0].stress for row in layout.steps for step in row)
    if is_given or (question.minimize == "makespan" and question.max_stress is None):
        return (0.0,)
    if question.minimize == "weighted" and question.max_stress is None:
        time, stress = question.weights
        own = stress / time * instance.per_second / instance.per_stress if time else float("inf")
        return (min(own, most * exchange_of(layout)),)
    return [weight * exchange_of(layout) for weight in SWEEP[:-1]]
