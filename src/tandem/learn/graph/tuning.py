"""Tuning the policy for any cell to a few cells: it draws schedules, and learns the decisions of
the best that was ever found, again and again (self-labelling: Corsini et al. 2024, "Self-Labeling
the Job Shop Scheduling Problem"). The first ones come from a little exact planning, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault, NothingFoundError
from tandem.learn.graph.candidates import ABOUT, FEATURES
from tandem.learn.graph.labels import Decided
from tandem.learn.graph.making import Maker, retold
from tandem.learn.graph.network import Weights
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.training import adam, likely, per_decision, stepping
from tandem.learn.graph.weights import packed, shipped, unpacked
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, PartialSchedule
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.plan.rules import drawn_together, exchange_of
from tandem.plan.starts import Starts

Leaves = dict[str, Any]

PLANNED = 0.3
"""Of the exact planner for each problem, in its deterministic seconds; one takes about three."""
ROOM = 256
"""Choices are padded to a multiple of so many, so that few shapes are compiled."""


@dataclass(frozen=True)
class Problem:
    """A cell and a weight of stress, and how the network sees them."""

    cell: Cell
    outlook: Outlook

    @property
    def layout(self) -> Layout:
        """The cell as list scheduling wants it."""
        return self.outlook.layout

    def cost(self, state: PartialSchedule) -> float:
        """Ticks: the makespan, and what the stress is worth."""
        return state.makespan + self.outlook.exchange * state.stress

    def planned(self) -> tuple[float, Starts] | None:
        """What a little exact planning finds, and what it costs; None where it finds nothing. The
        same again each time, for its work is counted.
        """
        instance = self.layout.instance
        stress = self.outlook.exchange * instance.per_stress / instance.per_second
        question = Question("weighted", (1.0, stress))
        try:
            front = plan(self.cell, question, work=PLANNED, workers=1, settle=False, confirm=False)
        except NothingFoundError:
            return None
        (best,) = front
        cost = (best.makespan + stress * best.stress) * instance.per_second
        return cost, instance.starts(best.schedule)


def layout_of(cell: Cell) -> Layout:
    """The cell as list scheduling wants it. Raises CellError for one that the policy cannot take:
    what listed sets of tasks cost says nothing of a single one.
    """
    layout = Layout.of(Instance.of(cell))
    if layout.instance.stress_of_set is not None:
        what = "the network for all cells needs a stress that adds up; this cell lists it by sets."
        raise CellError([Fault(what, ("stress_of_set",))])
    if layout.impossible():
        raise CellError([Fault("its limits leave a task that nobody can do.", ("tasks",))])
    return layout


def problems(cell: Cell, exchange: float, weights: Sequence[float]) -> list[Problem]:
    """The cell with a unit of stress worth `exchange` seconds, then with each of the other weights
    (in the cell's own mean time per mean stress) where it has any stress.
    """
    layout = layout_of(cell)
    instance = layout.instance
    asked = exchange * instance.per_second / instance.per_stress
    has_stress = any(step.stress for row in layout.steps for step in row)
    others = [weight * exchange_of(layout) for weight in weights if has_stress]
    return [Problem(cell, Outlook.of(layout, ticks)) for ticks in dict.fromkeys([asked, *others])]


class Learner(NamedTuple):
    """All that a tuning needs to go on. `P` problems of at most `T` tasks.

    weights: of the network; adam: of the optimiser. rounds, drawn: `[]` int32, rounds done and
    schedules drawn. way, start: `[P, T]` int32, the best schedule of each problem; cost: `[P]`
    float32, what it costs, infinite before there is one.
    """

    weights: Leaves
    adam: Any
    rounds: Any
    drawn: Any
    way: Any
    start: Any
    cost: Any


class Report(NamedTuple):
    """On a round. finite: `[]` bool. loss: `[]`, mean. above: `[]`, how far the greedy schedules
    cost more than the best ever found, mean over the problems, as a share.
    """

    finite: Any
    loss: Any
    above: Any


def begun(problems: Sequence[Problem]) -> Learner:
    """The shipped weights, and no schedule yet."""
    leaves = packed(shipped())
    most = max(len(one.outlook.tasks) for one in problems)
    shape = (len(problems), most)
    zero = np.zeros((), np.int32)
    return Learner(
        leaves,
        adam().init(leaves),
        zero,
        zero,
        np.zeros(shape, np.int32),
        np.zeros(shape, np.int32),
        np.full(len(problems), np.inf, np.float32),
    )


def one_round(
    learner: Learner,
    problems: Sequence[Problem],
    *,
    samples: int,
    steps: int,
    rate: float,
    seed: int,
) -> tuple[Learner, Report]:
    """Draws schedules, keeps the best of each problem, and learns how they are made. The same again
    for the same learner and seed.
    """
    weights = unpacked({name: np.asarray(part) for name, part in learner.weights.items()})
    way, start = np.array(learner.way), np.array(learner.start)
    cost, greedy = np.array(learner.cost), list[float]()
    rng = np.random.default_rng((seed, int(learner.rounds)))
    for at, problem in enumerate(problems):
        found = _drawn(problem, weights, samples, rng)
        greedy.append(found[0][0])
        if not learner.rounds and (exact := problem.planned()) is not None:
            found.append(exact)
        least, best = min(found, key=lambda one: one[0])
        if least < cost[at]:
            cost[at] = least
            way[at, : len(best)], start[at, : len(best)] = np.array(best).T
    told = [
        shown(problem.outlook, tuple(zip(way[at].tolist(), start[at].tolist(), strict=True)))
        for at, problem in enumerate(problems)
        if np.isfinite(cost[at])
    ]
    leaves, state, losses = learner.weights, learner.adam, list[float]()
    for number in range(steps if told else 0):
        leaves, state, loss = _step()(leaves, state, told[number % len(told)], np.float32(rate))
        losses.append(float(loss))
    loss = float(np.mean(losses)) if losses else 0.0
    above = np.array(greedy) / np.maximum(cost, 1e-9) - 1
    report = Report(
        np.isfinite(loss), np.float32(loss), np.float32(above[np.isfinite(above)].mean())
    )
    drawn = np.int32(learner.drawn + samples * len(problems))
    rounds = np.int32(learner.rounds + 1)
    return Learner(leaves, state, rounds, drawn, way, start, cost), report


def _drawn(
    problem: Problem, weights: Weights, samples: int, rng: np.random.Generator
) -> list[tuple[float, Starts]]:
    """So many schedules, the greedy one first, and what each costs: infinite where it ran into a
    limit.
    """
    maker, found = Maker.of(weights, problem.outlook), list[tuple[float, Starts]]()
    for sample in range(samples):
        state = drawn_together(problem.layout, maker.build(rng if sample else None))
        starts = () if state is None else tuple(state.starts())
        found.append((np.inf if state is None else problem.cost(state), starts))
    return found


def shown(outlook: Outlook, starts: Starts) -> Leaves:
    """The decisions that lead to a schedule, and the cell they stand in: arrays for `likely`, a
    batch of one cell; `right` `[R]` says what share of each decision is right.
    """
    steps, tasks = outlook.steps, len(outlook.tasks)
    decisions = list[Decided]()
    for making, choices, which in retold(outlook, starts[:tasks]):
        if len(choices.rows) > 1:
            share = np.zeros(len(choices.rows), np.float32)
            share[which] = 1 / len(which)
            decisions.append(Decided.of(making, choices, share))
    sizes = [len(one.rows) for one in decisions]
    count = sum(sizes)
    room = -(-max(count, 1) // ROOM) * ROOM
    turns = np.repeat(np.arange(len(sizes), dtype=np.int32), sizes)
    found: Leaves = {
        "tasks": outlook.tasks[None],
        "operators": outlook.operators[None],
        "pairs": outlook.pairs[None],
        "before": outlook.before[None],
        "step task": steps.task.astype(np.int32)[None],
        "step share": outlook.share.astype(np.float32)[None],
        "step fixed": steps.fixed[None],
        "unplaced": np.zeros((1, tasks, tasks), np.float32),
        "cell": np.zeros(room, np.int32),
        "turn": np.zeros(room, np.int32),
        "row": np.zeros(room, np.int32),
        # padding is of a decision behind the last, in which nothing is right
        "decision": np.full(room, tasks, np.int32),
        "right": np.zeros(room, np.float32),
        "seen": np.zeros((room, FEATURES), np.float32),
        "about": np.zeros((room, len(outlook.operators), ABOUT), np.float32),
    }
    if decisions:
        found["unplaced"][0, : len(decisions)] = [one.unplaced for one in decisions]
        found["turn"][:count] = found["decision"][:count] = turns
        found["row"][:count] = np.concatenate([one.rows for one in decisions])
        found["right"][:count] = np.concatenate([one.losses for one in decisions])
        found["seen"][:count] = np.concatenate([one.seen.features for one in decisions])
        found["about"][:count] = np.concatenate([one.seen.about for one in decisions])
    return found


def _loss(leaves: Leaves, told: Leaves) -> Any:
    """Cross-entropy of the choices with the right ones, per decision."""
    count = told["unplaced"].shape[1]
    return -per_decision(told["right"] * likely(leaves, told, count), told["decision"], count)


@cache
def _step() -> Any:
    return stepping(_loss)
