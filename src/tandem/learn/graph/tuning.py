"""Tuning the policy for any cell to a few cells: it draws schedules, and learns the decisions of
the best that was ever found, again and again (self-labelling: Corsini et al. 2024, "Self-Labeling
the Job Shop Scheduling Problem"). The first ones come from a little exact planning, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault, NothingFoundError
from tandem.learn.graph.candidates import FEATURES, features
from tandem.learn.graph.making import Maker, retold
from tandem.learn.graph.network import Weights, lasting, nodes, scores
from tandem.learn.graph.outlook import Outlook
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
        _adam().init(leaves),
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
    leaves, adam, losses = learner.weights, learner.adam, list[float]()
    for number in range(steps if told else 0):
        leaves, adam, loss = _step()(leaves, adam, told[number % len(told)], np.float32(rate))
        losses.append(float(loss))
    loss = float(np.mean(losses)) if losses else 0.0
    above = np.array(greedy) / np.maximum(cost, 1e-9) - 1
    report = Report(
        np.isfinite(loss), np.float32(loss), np.float32(above[np.isfinite(above)].mean())
    )
    drawn = np.int32(learner.drawn + samples * len(problems))
    rounds = np.int32(learner.rounds + 1)
    return Learner(leaves, adam, rounds, drawn, way, start, cost), report


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
    """The decisions that lead to a schedule, and the cell they stand in: arrays for `_loss`."""
    seen, rows, decision, right = [], list[int](), list[int](), list[float]()
    count = 0
    for making, choices, which in retold(outlook, starts[: len(outlook.tasks)]):
        if len(choices.rows) > 1:
            seen.append(features(making, choices))
            rows += choices.rows.tolist()
            decision += [count] * len(choices.rows)
            share = np.zeros(len(choices.rows))
            share[which] = 1 / len(which)
            right += share.tolist()
            count += 1
    room = -(-max(len(rows), 1) // ROOM) * ROOM
    steps = outlook.steps
    found: Leaves = {
        "tasks": outlook.tasks,
        "operators": outlook.operators,
        "pairs": outlook.pairs,
        "before": outlook.before,
        "step task": steps.task.astype(np.int32),
        "step share": outlook.share.astype(np.float32),
        "step fixed": steps.fixed,
        "row": np.zeros(room, np.int32),
        # padding is one decision more, in which nothing is right
        "decision": np.full(room, room - 1, np.int32),
        "right": np.zeros(room, np.float32),
    }
    found["seen"] = np.zeros((room, FEATURES), np.float32)
    found["seen"][: len(rows)] = np.concatenate(seen) if seen else 0
    found["row"][: len(rows)] = rows
    found["decision"][: len(rows)] = decision
    found["right"][: len(rows)] = right
    return found


def _loss(leaves: Leaves, told: Leaves) -> Any:
    """Cross-entropy of the choices with the right ones, per decision."""
    weights: Weights = unpacked(leaves)
    task, operator = nodes(
        jnp, weights, told["tasks"], told["operators"], told["pairs"], told["before"]
    )
    group = told["step share"] @ operator
    steps = lasting(jnp, weights, task[told["step task"]], group, told["step fixed"])
    logits = scores(jnp, weights, told["seen"], steps[told["row"]])
    decision, count = told["decision"], len(told["decision"])
    most = jax.ops.segment_max(logits, decision, count, indices_are_sorted=True)
    shifted = logits - jax.lax.stop_gradient(most)[decision]
    sums = jax.ops.segment_sum(jnp.exp(shifted), decision, count, indices_are_sorted=True)
    likely = shifted - jnp.log(sums)[decision]
    decisions = jnp.maximum(told["right"].sum(), 1.0)
    return -jnp.sum(told["right"] * likely) / decisions


def _adam() -> optax.GradientTransformation:
    return optax.chain(optax.clip_by_global_norm(1.0), optax.scale_by_adam())


@cache
def _step() -> Any:
    adam = _adam()

    @jax.jit
    def step(leaves: Leaves, state: Any, told: Leaves, rate: Any) -> Any:
        loss, gradient = jax.value_and_grad(_loss)(leaves, told)
        change, state = adam.update(gradient, state, leaves)
        moved = {name: part - rate * change[name] for name, part in leaves.items()}
        return moved, state, loss

    return step
