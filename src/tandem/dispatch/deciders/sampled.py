"""What plans of the rest come to when people are slower or quicker than is expected, and times
scatter: the same plans under sampled durations, and the choice of what begins now that is best on
average.

After each choice the best of the plans that begin with it counts, sample by sample: who plans anew
at each event will know more by then (a hindsight optimum among a few plans: Littman et al. 1995
call it QMDP, Chong, Givan and Chang 2000 *hindsight optimization*).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from random import Random

from tandem.dispatch.deciders.beliefs import position
from tandem.dispatch.lookahead.residual import Plan, Rest, appended, rest
from tandem.dispatch.lookahead.transitions import Moves
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.pace import NORMAL, outlook, sigma_of
from tandem.plan.instance import Way
from tandem.plan.list_scheduling import Layout

SAMPLES = 8
"""Of the durations of what is left, at the most."""
READ, TRIED = 3.0, 0.2
"""Steps that are counted for each task of a sample, and for each task of a plan under it."""
SLOWEST = 20.0
"""A sampled time is at most so many times the expected one."""


@dataclass(frozen=True)
class Sample:
    """The rest under one draw of durations.

    Attributes:
      going: ticks until all that runs has ended.
    """

    left: Rest
    layout: Layout
    going: int

    def cost(self, plan: Plan, weights: tuple[float, float]) -> float:
        """Of the plan's ways in its order, in these durations; inf where a limit is broken."""
        state = appended(self.left, self.layout, plan)
        if state is None:
            return math.inf
        return weights[0] * max(state.makespan, self.going) + weights[1] * plan.units


def samples_of(
    moves: Moves,
    situation: Situation,
    expected: Mapping[str, float],
    prior: Mapping[float, float],
    due: Mapping[int, int] | None,
    count: int,
    seed: int,
) -> Iterator[Sample]:
    """`count` draws of how long the rest takes, evenly spread over each person's believed pace;
    the same for the same situation and seed.

    Args:
      moves: of the expected paces, `expected`: human -> factor on the stated times.
    """
    random = Random(f"sampled {seed} {situation.now!r}")
    drawn = {}
    for human in sorted(situation.cell.humans):
        even, other = ([(at + 0.5) / count for at in range(count)] for _ in range(2))
        random.shuffle(even)
        random.shuffle(other)
        drawn[human], _ = outlook(situation, human, prior, even, other)
    for at in range(count):
        paces = {human: found[at] for human, found in drawn.items()}
        here = position(moves, situation, paces)
        left = rest(moves, here, with_running=False, due=due)
        if left is None:
            return
        ways = tuple(
            tuple(_drawn(moves, situation, left, task, way, paces, expected, random) for way in row)
            for task, row in enumerate(left.instance.ways)
        )
        left = replace(left, instance=replace(left.instance, ways=ways))
        yield Sample(
            left, Layout.of(left.instance), max((ticks for _, ticks in here.running), default=0)
        )


def _drawn(
    moves: Moves,
    situation: Situation,
    left: Rest,
    task: int,
    way: Way,
    paces: Mapping[str, float],
    expected: Mapping[str, float],
    random: Random,
) -> Way:
    """The way with a drawn duration instead of the expected one."""
    names = moves.instance.operators
    people = [names[who] for who in way.operators if names[who] in paces]
    factor = 1.0
    if people:
        factor = max(paces[who] for who in people) / max(expected.get(who, 1.0) for who in people)
    scatter = sigma_of(
        situation.cell, left.instance.tasks[task], [names[who] for who in way.operators]
    )
    if scatter:
        factor *= math.exp(scatter * NORMAL.inv_cdf(random.random() or 0.5) - scatter**2 / 2)
    factor = min(factor, SLOWEST)
    return way if factor == 1.0 else replace(way, ticks=max(1, round(way.ticks * factor)))


def best_on_average(
    plans: Sequence[tuple[tuple[int, ...], Plan]],
    samples: Sequence[Sample],
    weights: tuple[float, float],
) -> Plan:
    """Of plans, each with the ways that it begins now, the one whose beginning is best on average;
    of those that begin so the best on average itself, the first of equals.
    """
    costs = [[sample.cost(plan, weights) for sample in samples] for _, plan in plans]
    value: dict[tuple[int, ...], float] = {}
    for choice in dict.fromkeys(choice for choice, _ in plans):
        rows = [row for (mine, _), row in zip(plans, costs, strict=True) if mine == choice]
        value[choice] = sum(map(min, zip(*rows, strict=True)))
    first = min(range(len(plans)), key=lambda at: (value[plans[at][0]], sum(costs[at])))
    return plans[first][1]
