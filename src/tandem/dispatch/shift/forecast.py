"""When the product under way will be done: its median and its 90 % quantile, from what is believed
of people's paces and from the spread of times.

The rest is played many times at once, in NumPy: each time with other paces, drawn from the beliefs,
and other times, drawn from the spread that the cell states. Who does what is decided in the play by
list scheduling (Kolisch 1996, serial scheme): tasks in one order, each by whoever is expected to
end it first. Where the decider plans, the order is the best of many that were drawn, by the times
believed; where it is a rule, it is the one of the longest tail. What the decision begins comes
first. All draws are fixed, so that the same situation has the same forecast.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np

from tandem.dispatch.deciders.beliefs import AWAY_S, OVERDUE, cost_so_far
from tandem.dispatch.deciders.policy import Decision, Start
from tandem.dispatch.lookahead.objective import SECONDS, Objective
from tandem.dispatch.shift.plays import (
    Array,
    Rest,
    Sheet,
    along_the_clock,
    played,
    sheet_of,
)
from tandem.dispatch.situation.model import Running, Situation
from tandem.dispatch.situation.pace import NORMAL, outlook, sigma_of

PLAYS = 320
"""So many times the rest is played."""
DRAWN, FEWEST, TASKS = 64, 8, 1_000
"""So many orders are tried before: fewer, down to the second number, where they would be of more
tasks together than the third.
"""
SHAKEN = (0.6, 0.3)
"""Standard deviations (of the logarithm) of the factors on times by which orders are drawn: far and
wide, then around the best.
"""
GROUPS, WIDE = 5, 0.1
"""Plays are put into so many groups of like paces where these differ by more (of the logarithm)."""
LENIENT = 1e6
"""Seconds that a unit of stress weighs where time counts nothing."""
SEED = 14
"""Of all draws."""


def forecast(
    situation: Situation,
    decision: Decision,
    prior: Mapping[float, float],
    objective: Objective = SECONDS,
    *,
    plans: bool = True,
    order: Sequence[Start] = (),
) -> dict[str, float] | None:
    """When the product under way is expected to be done, s of the shift's clock: `p50` and `p90`
    are not exceeded with these probabilities; `plan`: by the stated times. None where nothing is
    under way.

    It knows operators, precedence, releases, breaks, tools, zones, changeovers, walking and
    `same_operator`; it does not foresee mistakes, refusals and absences to come, and knows no limit
    of stress, no part that a machine holds and no zone that keeps kinds apart: where these make
    somebody wait, it says too early a time. ASSUMPTIONS are those of `deciders/beliefs.py`.

    Args:
      decision: what has just been decided.
      prior: of people's paces.
      objective: what the decider makes small.
      plans: the decider looks ahead; a rule does not.
      order: of the plan that the decider carries out whatever happens; empty where it carries out
        none.
    """
    if situation.is_over:
        return None
    sheet = sheet_of(situation.cell)
    begins = [*decision.asks, *decision.starts]
    rest = Rest.of(sheet, situation, begins, order)
    drawn, going = _drawn_paces(sheet, situation, prior)
    # the last play is by the stated times
    paces = np.vstack([drawn, np.ones(len(sheet.operators))])
    running = _left(sheet, situation, drawn, going)
    expected = _stretch(sheet, paces) * sheet.seconds
    scatter = np.vstack([_scatter(sheet), np.ones(len(sheet.ways))])
    looks_ahead = plans and not order
    if looks_ahead:
        orders, liking, cost = _lines(sheet, rest, paces, running, objective)
        believed, gain = expected, _gain(situation, decision, objective, cost)
    else:
        orders, gain = _ruled(sheet, rest, paces, running), 0.0
        # a rule goes by the stated times, whoever works there
        liking, believed = np.zeros(expected.shape), np.tile(sheet.seconds, (len(paces), 1))
    ends, _ = played(sheet, rest, orders, liking, believed, expected * scatter, running)
    ends[:-1] *= 1 - gain / max(gain, ends[:-1].mean())
    p50, p90 = np.quantile(ends[:-1], (0.5, 0.9), method="median_unbiased")
    return {
        "p50": _rounded(situation, p50),
        "p90": _rounded(situation, p90),
        "plan": _rounded(situation, ends[-1]),
    }


def _gain(situation: Situation, decision: Decision, objective: Objective, cost: float) -> float:
    """Seconds by which the decider knows the rest to be shorter than the plays have it, which are
    expected to cost `cost`; 0 where it does not say so.
    """
    if decision.expected_cost is None or not objective.time:
        return 0.0
    ahead = decision.expected_cost - cost_so_far(objective, situation)
    return max(0.0, cost - ahead) / objective.time


def _rounded(situation: Situation, seconds: float) -> float:
    return round(situation.on_clock(situation.now + float(seconds)), 3)


def _drawn_paces(
    sheet: Sheet, situation: Situation, prior: Mapping[float, float]
) -> tuple[Array, dict[str, Array]]:
    """`[PLAYS, O]` paces, drawn from the beliefs; and, per human who is at something, `[PLAYS]` the
    normal deviate of how long it takes, given that it has not ended yet.
    """
    paces = np.ones((PLAYS, len(sheet.operators)))
    going: dict[str, Array] = {}
    for number, who in enumerate(sheet.operators):
        if sheet.cell.operators[who].kind == "human":
            factors, ahead = outlook(situation, who, prior, *_draws(number))
            paces[:, number] = factors
            if ahead is not None:
                going[who] = np.array(ahead)
    return paces, going


@lru_cache(maxsize=64)
def _draws(number: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Two independent, evenly spread rows of `PLAYS` shares between 0 and 1."""
    rng = np.random.default_rng((SEED, number))
    even = (np.arange(PLAYS) + 0.5) / PLAYS
    return tuple(rng.permutation(even).tolist()), tuple(rng.permutation(even).tolist())


@lru_cache(maxsize=256)
def _normal(rows: int, columns: int, which: int) -> Array:
    """Fixed normal numbers: a Latin hypercube (McKay, Beckman and Conover 1979), so that few rows
    tell the quantiles of what is nearly a sum.
    """
    rng = np.random.default_rng((SEED, rows, columns, which))
    even = np.array([NORMAL.inv_cdf((row + 0.5) / rows) for row in range(rows)])
    return rng.permuted(np.tile(even, (columns, 1)), axis=1).T


def _scatter(sheet: Sheet) -> Array:
    """`[PLAYS, W]`, real times divided by the expected ones; lognormal with mean 1."""
    normal = _normal(PLAYS, len(sheet.tasks), 0)[:, sheet.task]
    return np.exp(sheet.sigma * normal - sheet.sigma**2 / 2)


def _stretch(sheet: Sheet, paces: Array) -> Array:
    """`[rows, W]`: the pace of each way's slowest operator."""
    return np.where(sheet.uses[None], paces[:, None, :], 0.0).max(axis=2)


def _left(
    sheet: Sheet, situation: Situation, paces: Array, going: Mapping[str, Array]
) -> dict[str, Array]:
    """Task under way -> `[PLAYS + 1]` s until it ends; the last one by the stated time."""
    number = {who: o for o, who in enumerate(sheet.operators)}
    found = {}
    for task, at in situation.running.items():
        worked = _worked(situation, at)
        slowest = paces[:, [number[who] for who in at.operators]].max(axis=1)
        sigma = sigma_of(sheet.cell, task, at.operators)
        ahead = next((going[who] for who in at.operators if who in going), None)
        if ahead is None:
            ahead = _normal(PLAYS, len(sheet.tasks), 1)[:, sheet.tasks.index(task)]
        takes = at.stated * np.append(slowest * np.exp(sigma * ahead - sigma**2 / 2), 1.0)
        overdue = OVERDUE * at.stated
        rests = AWAY_S if at.rests_since is not None else 0.0
        found[task] = np.where(takes > worked, takes - worked, overdue) + rests
    return found


def _worked(situation: Situation, at: Running) -> float:
    until = situation.now if at.rests_since is None else at.rests_since
    return until - at.start - at.rested


def _ruled(sheet: Sheet, rest: Rest, paces: Array, running: Mapping[str, Array]) -> Array:
    """For each play, `[rows, n]`, the order in which a rule looks at the open tasks; plays of like
    paces have the same.
    """
    alike = _alike(sheet, paces)
    centres = np.array([paces[group].mean(axis=0) for group in alike])
    going = {
        task: np.array([ends[group].mean() for group in alike]) for task, ends in running.items()
    }
    stated = np.tile(sheet.seconds, (len(alike), 1))
    expected = _stretch(sheet, centres) * sheet.seconds
    rank = _ranks(sheet, np.zeros((1, len(sheet.tasks))))[0]
    orders = along_the_clock(sheet, rest, rank, stated, expected, going)
    of_play = np.empty(len(paces), int)
    for number, group in enumerate(alike):
        of_play[group] = number
    return orders[of_play]


def _lines(
    sheet: Sheet, rest: Rest, paces: Array, running: Mapping[str, Array], objective: Objective
) -> tuple[Array, Array, float]:
    """For each play, `[rows, n]`, the order in which the open tasks are looked at, and `[rows, W]`,
    how many seconds each way counts as longer than it is; and what they are expected to cost.

    Plays of like paces have the same, the best that was drawn for these paces, far and wide and
    then around the best: who looks ahead learns the paces, and goes by them.
    """
    tasks, ways = len(sheet.tasks), len(sheet.ways)
    alike = _alike(sheet, paces)
    count = max(FEWEST, min(DRAWN, TASKS // max(1, len(rest.tasks))))
    centres = np.array([paces[group].mean(axis=0) for group in alike])
    expected = np.repeat(_stretch(sheet, centres) * sheet.seconds, count, axis=0)
    going = {
        task: np.repeat([ends[group].mean() for group in alike], count)
        for task, ends in running.items()
    }
    dear = sheet.stress * (objective.stress / objective.time if objective.time else LENIENT)
    best, least = np.zeros((len(alike), tasks + ways)), np.zeros(len(alike))
    for number, far in enumerate(SHAKEN):
        shake = far * _normal(count, tasks + ways, 2 + number)
        shake[0] = 0.0
        tried = (best[:, None] + shake).reshape(len(alike) * count, -1)
        orders = _orders(sheet, rest, tried[:, :tasks])
        liked = tried[:, tasks:] * expected + dear
        ends, stress = played(sheet, rest, orders, liked, expected, expected, going)
        cost = (objective.time * ends + objective.stress * stress).reshape(len(alike), count)
        best = tried[np.argmin(cost, axis=1) + count * np.arange(len(alike))]
        least = cost.min(axis=1)
    of_play = np.empty(len(paces), int)
    for number, group in enumerate(alike):
        of_play[group] = number
    orders = _orders(sheet, rest, best[:, :tasks])
    liked = best[:, tasks:] * expected[::count] + dear
    shares = [len(group) / PLAYS for group in alike[:-1]]
    return orders[of_play], liked[of_play], float(np.dot(shares, least[:-1]))


def _alike(sheet: Sheet, paces: Array) -> list[Array]:
    """The plays in groups of like paces; the last play, which is by the stated times, alone."""
    humans = [
        o for o, who in enumerate(sheet.operators) if sheet.cell.operators[who].kind == "human"
    ]
    mean = np.log(paces[:-1, humans]).mean(axis=1) if humans else np.zeros(PLAYS)
    by_pace = np.argsort(mean, kind="stable")
    is_wide = mean[by_pace[-1]] - mean[by_pace[0]] > WIDE
    groups = np.array_split(by_pace, GROUPS) if is_wide else [by_pace]
    return [*groups, np.array([PLAYS])]


def _orders(sheet: Sheet, rest: Rest, shake: Array) -> Array:
    """`[rows, n]`: the open tasks, each behind its predecessors, those with the longest chain
    behind them first when the times of tasks are multiplied by `exp(shake)`, `[rows, T]`.
    """
    left = np.array(rest.tasks, dtype=int)
    rank = _ranks(sheet, shake) + rest.first
    return left[np.argsort(-rank[:, left], axis=1, kind="stable")]


def _ranks(sheet: Sheet, shake: Array) -> Array:
    """`[rows, T]`: the longest chain of quickest times from each task on, itself included."""
    rank, tail = np.zeros(shake.shape), np.zeros(shake.shape)
    weight = sheet.quickest * np.exp(shake)
    for t in sheet.chain:
        rank[:, t] = tail[:, t] + weight[:, t]
        for first in sheet.firsts[t]:
            if first < len(sheet.tasks):
                tail[:, first] = np.maximum(tail[:, first], rank[:, t])
    return rank
