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

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from tandem.dispatch.deciders.beliefs import AWAY_S, OVERDUE
from tandem.dispatch.deciders.policy import Decision
from tandem.dispatch.shift.plays import Array, Rest, Sheet, played, sheet_of, sigma_of
from tandem.dispatch.situation.model import Running, Situation
from tandem.dispatch.situation.pace import outlook

PLAYS = 128
"""So many times the rest is played."""
DRAWN = 64
"""So many orders are tried before."""
SHAKEN = 0.5
"""Standard deviation (of the logarithm) of the factors on times by which orders are drawn."""
LARGE = 100
"""Cells with more tasks keep the order of the longest tail."""
SEED = 14
"""Of all draws."""


def forecast(
    situation: Situation, decision: Decision, prior: Mapping[float, float], *, plans: bool = True
) -> dict[str, float] | None:
    """When the product under way is expected to be done, s of the shift's clock: `p50` and `p90`
    are not exceeded with these probabilities; `plan`: by the stated times. None where nothing is
    under way.

    It knows operators, precedence, releases, breaks, tools, zones, changeovers and
    `same_operator`; it does not foresee mistakes, refusals and absences to come, and knows no limit
    of stress. ASSUMPTIONS are those of `deciders/beliefs.py`.

    Args:
      decision: what has just been decided.
      prior: of people's paces.
      plans: the decider looks ahead; a rule does not.
    """
    if situation.is_over:
        return None
    sheet = sheet_of(situation.cell)
    rest = Rest.of(sheet, situation, [*decision.asks, *decision.starts])
    paces, going = _drawn_paces(sheet, situation, prior)
    running = _left(sheet, situation, paces, going)
    order, liking = _order(sheet, rest, paces.mean(axis=0), running, plans)
    # the last play is by the stated times
    stretch = _stretch(sheet, paces)
    steady = np.vstack([stretch, np.ones(stretch.shape[1])]) * sheet.seconds
    scatter = np.vstack([_scatter(sheet), np.ones(stretch.shape[1])])
    rows = PLAYS + 1
    ends = played(
        sheet,
        rest,
        np.broadcast_to(order, (rows, len(order))),
        np.broadcast_to(liking, (rows, len(liking))),
        steady,
        steady * scatter,
        running,
    )
    p50, p90 = np.quantile(ends[:-1], (0.5, 0.9), method="median_unbiased")
    return {
        "p50": _rounded(situation, p50),
        "p90": _rounded(situation, p90),
        "plan": _rounded(situation, ends[-1]),
    }


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


@lru_cache(maxsize=16)
def _normal(rows: int, columns: int, which: int) -> Array:
    """Fixed normal numbers, rows in pairs of opposite signs."""
    half = np.random.default_rng((SEED, rows, columns, which)).standard_normal(
        ((rows + 1) // 2, columns)
    )
    return np.concatenate([half, -half])[:rows]


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


def _order(
    sheet: Sheet, rest: Rest, paces: Array, running: Mapping[str, Array], plans: bool
) -> tuple[Array, Array]:
    """The order in which the open tasks are looked at, and `[W]`, how many seconds each way counts
    as longer than it is: the best that was drawn, by the expected times.
    """
    rows = DRAWN if plans and len(sheet.tasks) <= LARGE else 1
    tasks, ways = len(sheet.tasks), len(sheet.ways)
    shake = SHAKEN * _normal(rows, tasks, 2)
    liking = SHAKEN * _normal(rows, ways, 3)
    shake[0], liking[0] = 0.0, 0.0
    rank = np.zeros((rows, tasks + 1))
    weight = sheet.quickest * np.exp(shake)
    tail = np.zeros((rows, tasks))
    for t in sheet.chain:
        rank[:, t] = tail[:, t] + weight[:, t]
        for first in sheet.before[t]:
            if first < tasks:
                tail[:, first] = np.maximum(tail[:, first], rank[:, t])
    rank[:, :tasks] += 1e9 * (rest.begins >= 0)
    left = np.array(rest.tasks, dtype=int)
    orders = left[np.argsort(-rank[:, left], axis=1, kind="stable")]
    steady = _stretch(sheet, paces[None]) * sheet.seconds
    liking = liking * steady
    if rows == 1:
        return orders[0], liking[0]
    steady = np.broadcast_to(steady, liking.shape)
    expected = {task: np.full(rows, ends[:-1].mean()) for task, ends in running.items()}
    ends = played(sheet, rest, orders, liking, steady, steady, expected)
    best = int(np.argmin(ends))
    return orders[best], liking[best]
