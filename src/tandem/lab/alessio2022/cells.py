"""The successor's claim on precedence graphs: done within a bounded time whatever the human does.
What that costs, exactly, and what is learned.

Source: the abstract of the same group's later paper (Applied Sciences 2026, 16(7), 3244): bounded
time under an adversary, slower than optimisers. Two numbers are held against each other for every
robot: its *nominal* time, when the human does what is best for the team, and its *guaranteed* time,
when the human does the worst that is legal, waiting while the robot works included. Values by
`tandem.dispatch.lookahead.dynamic_programming`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.lookahead.dynamic_programming import COMPLIANT, Human, Values, values
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.files.generators import layered
from tandem.lab.kinat2023 import decisions
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.kinat2023.observations import observe_normalised
from tandem.lab.kinat2023.recipe import STATION, StationRecipe
from tandem.lab.kinat2023.station import station, whole_ticks
from tandem.lab.kinat2023.world import HUMAN, ROBOT, State, Station, reset
from tandem.learn.networks import Perceptron, forward, init
from tandem.learn.ppo.recipes import longer

HOSTILE = Human(spoils=True)
RANDOM_TASKS, RANDOM_SEEDS = 7, (1, 3, 14)
"""The random cells that robots learn on; of seed 14 a human who never waits makes robustness cost
nominal time.
"""
PRICED_TASKS = (5, 6, 7)
QUICK = 0.1
Robots = Callable[[Position], tuple[int, ...]]
"""A robot: the position, in which idle humans have moved already -> the ways that it begins; empty
to wait.
"""


@dataclass
class Diligent(Values):
    """The values beside a human who spoils by the choice of the task alone: it never waits when it
    could work.
    """

    def of_human(self, position: Position, turn: int) -> float:
        """The most that the humans from number `turn` on can make of it."""
        moves = self.moves
        if turn == len(self.humans):
            return self.of_robots(position)
        legal = (
            []
            if moves.busy(position) >> self.humans[turn] & 1
            else moves.legal(position, 1 << self.humans[turn])
        )
        return (
            max((self.if_human(position, turn, way) for way in legal), default=-1)
            if legal
            else self.of_human(position, turn + 1)
        )


@dataclass
class Following(Values):
    """The values of a cell whose robot is given: what the best, or the worst, human makes of it."""

    robot: Robots = field(default=lambda position: ())

    def of_robots(self, position: Position) -> float:
        """The value of what the given robot does."""
        chosen, after = self.robot(position), position
        for way in chosen:
            after = self.moves.begin(after, way)
        return self.run(after)


def times(cell: Cell, robot: Robots) -> tuple[float, float]:
    """(nominal, guaranteed) seconds of a robot: beside the human that helps it most, and beside the
    one that spoils most.
    """
    helped, spoiled = (_following(cell, robot, human) for human in (COMPLIANT, HOSTILE))
    return _seconds(helped.value(helped.moves.root())), _seconds(
        spoiled.value(spoiled.moves.root())
    )


def _following(cell: Cell, robot: Robots, human: Human) -> Following:
    base = values(cell, human)
    return Following(base.moves, human, base.weights, base.most, robot=robot)


@dataclass(frozen=True)
class Game:
    """One assembly of a given robot and a human.

    Attributes:
      makespan: seconds. asked_ms: how long each decision of the robot took. spoiled: how often the
        human did something else than what helps most.
    """

    makespan: float
    asked_ms: tuple[float, ...]
    spoiled: int


def play(cell: Cell, robot: Robots, *, hostile: bool) -> Game:
    """The robot beside the human that helps it most, or beside the one that spoils most."""
    helpful, human = (
        _following(cell, robot, COMPLIANT),
        _following(cell, robot, HOSTILE if hostile else COMPLIANT),
    )
    moves, position, ticks_so_far, spoiled, asked = human.moves, human.moves.root(), 0, 0, []
    while not moves.is_over(position):
        for turn in range(len(human.humans)):
            if moves.busy(position) >> human.humans[turn] & 1:
                continue
            worth = _options(human, position, turn)
            way = (max if hostile else min)(worth, key=lambda choice: worth[choice])
            best = _options(helpful, position, turn)
            spoiled += best[way] > min(best.values())
            position = position if way is None else moves.begin(position, way)
        began = time.perf_counter()
        chosen = robot(position)
        asked.append(1000 * (time.perf_counter() - began))
        for way in chosen:
            position = moves.begin(position, way)
        ticks = moves.next_event(position)
        # both waiting for ever is worth infinity, and no option of that worth is taken
        assert ticks is not None
        position, ticks_so_far = moves.after(position, ticks), ticks_so_far + ticks
    return Game(_seconds(ticks_so_far / moves.instance.per_second), tuple(asked), spoiled)


def _options(values: Values, position: Position, turn: int) -> dict[int | None, float]:
    """What the human of that turn can do, None for waiting, with the value then; nothing that would
    never end.
    """
    legal = values.moves.legal(position, 1 << values.humans[turn])
    found: dict[int | None, float] = {way: values.if_human(position, turn, way) for way in legal}
    found[None] = values.of_human(position, turn + 1)
    return {way: value for way, value in found.items() if value < inf}


def nominal_robot(cell: Cell) -> Robots:
    """The robot of an optimiser: whatever has happened, it begins what is best if the human does
    its best from now on; the first of equals.
    """
    found = values(cell)
    return lambda position: min(
        found.robot_choices(position), key=lambda choice: (choice[1], choice[0])
    )[0]


RULES: dict[str, Callable[[float], float]] = {
    "in the cell's order": lambda _: 0.0,
    "shortest first": lambda ticks: ticks,
    "longest first": lambda ticks: -ticks,
}
"""Robots that learn nothing: they never wait when they could work, and begin the task that is least
by one of these.
"""


def rule_robot(cell: Cell, rank: Callable[[float], float]) -> Robots:
    """The robot that begins the least of what it may, at once."""
    moves = values(cell).moves
    robot = _robot(moves)

    def decide(position: Position) -> tuple[int, ...]:
        if moves.busy(position) & robot:
            return ()
        legal = moves.legal(position, robot)
        return (min(legal, key=lambda way: (rank(moves.ticks[way]), way)),) if legal else ()

    return decide


def best_rule_robot(cell: Cell) -> tuple[str, tuple[float, float]]:
    """The rule whose robot is quickest beside a human that helps, of equals the one that guarantees
    most; its (nominal, guaranteed) seconds.
    """
    found = {name: times(cell, rule_robot(cell, rank)) for name, rank in RULES.items()}
    name = min(found, key=lambda one: found[one])
    return name, found[name]


def trade(cell: Cell, hostile: Values | None = None) -> list[tuple[float, float]]:
    """The exact front of (guaranteed, nominal) seconds over all robots, the smallest guarantee
    first.

    Its first point is the price of robustness: the least guarantee that any robot can give, and the
    best nominal time with that guarantee. Its last point has the optimum of the cell as nominal
    time, with the best guarantee that goes with it.
    """
    hostile, best = hostile or values(cell, HOSTILE), values(cell)
    moves = hostile.moves
    root, second = moves.root(), moves.instance.per_second
    ticks = lambda seconds: round(seconds * second)  # noqa: E731
    least, optimum = ticks(hostile.value(root)), ticks(best.value(root))
    guarded = _Guarded(hostile)
    points, guarantee = [], least
    while True:
        nominal = guarded.value(root, guarantee)
        points.append((_seconds(guarantee / second), _seconds(nominal / second)))
        if nominal <= optimum:
            return points
        low, high = guarantee, guarantee + 1
        while guarded.value(root, high) >= nominal:  # the next guarantee that buys nominal time
            low, high = high, 2 * high - guarantee
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if guarded.value(root, middle) >= nominal else (low, middle)
        guarantee = high


class _Guarded:
    """Nominal ticks still to come when the robot takes no decision after which the worst human
    could make it miss `left`, ticks from now.
    """

    def __init__(self, hostile: Values):
        self.hostile, self.moves, self.second = (
            hostile,
            hostile.moves,
            hostile.moves.instance.per_second,
        )
        self.known: dict[tuple[Position, int], float] = {}

    def value(self, position: Position, left: int) -> float:
        if self.moves.is_over(position):
            return 0
        key = (position, left)
        if key not in self.known:
            self.known[key] = self.of_human(position, left, 0)
        return self.known[key]

    def of_human(self, position: Position, left: int, turn: int) -> float:
        humans = self.hostile.humans
        if turn == len(humans):
            return self.of_robots(position, left)
        legal = (
            []
            if self.moves.busy(position) >> humans[turn] & 1
            else self.moves.legal(position, 1 << humans[turn])
        )
        begun = [self.of_human(self.moves.begin(position, way), left, turn + 1) for way in legal]
        return min([*begun, self.of_human(position, left, turn + 1)])

    def of_robots(self, position: Position, left: int) -> float:
        least = inf
        for chosen, worst in self.hostile.robot_choices(position):
            if worst * self.second <= left + 0.5:
                after = position
                for way in chosen:
                    after = self.moves.begin(after, way)
                ticks = self.moves.next_event(after)
                assert ticks is not None  # else the worst would be infinite
                least = min(least, ticks + self.value(self.moves.after(after, ticks), left - ticks))
        return least


def prices(number: int) -> dict[str, Any]:
    """On so many random cells: how often one robot has both the least guaranteed and the least
    nominal time; and where the optimiser's robot stands.

    `free`: cells in which robustness costs no nominal time. `free_if_diligent`: the same when the
    human chooses badly but never waits (`Diligent`). `optimiser_misses`: cells in which the
    optimiser's robot guarantees less than can be guaranteed. `costs`: what it costs in the others,
    (least guarantee, nominal time with it, least nominal time) in seconds.
    """
    found: dict[str, Any] = {
        "cells": number,
        "tasks": list(PRICED_TASKS),
        "free": 0,
        "free_if_diligent": 0,
        "optimiser_misses": 0,
        "costs": [],
    }
    for index in range(number):
        cell = layered(PRICED_TASKS[index % len(PRICED_TASKS)], seed=index)
        hostile = values(cell, HOSTILE)
        points = trade(cell, hostile)
        diligent = trade(cell, _diligent(cell))
        found["free"] += len(points) == 1
        found["free_if_diligent"] += len(diligent) == 1
        found["optimiser_misses"] += times(cell, nominal_robot(cell))[1] > points[0][0]
        if len(points) > 1:
            found["costs"].append({"seed": index, "tasks": len(cell.tasks), "front": points})
    return found


# --- Learned robots ---


def cells() -> dict[str, Cell]:
    """The thesis's cell and random ones, by name. All have seven tasks, so that one compiled
    training serves them.
    """
    return {
        "thesis": thesis_cell(),
        **{
            f"random, {RANDOM_TASKS} tasks, seed {seed}": layered(RANDOM_TASKS, seed=seed)
            for seed in RANDOM_SEEDS
        },
    }


def compare(cell: Cell, name: str, *, seeds: int, quick: bool = False) -> dict[str, Any]:
    """The exact trade, the optimiser's robot, and per seed the (nominal, guaranteed) seconds of
    robots learned with and without an adversary.
    """
    recipe = longer(STATION, QUICK) if quick else STATION
    learned = {
        kind: [
            times(cell, learned_robot(cell, actor))
            for actor in learn(
                cell, adversary=kind == "adversarial", seeds=range(seeds), recipe=recipe
            )
        ]
        for kind in ("plain", "adversarial")
    }
    return {
        "cell": name,
        "digest": cell.digest,
        "trade": trade(cell),
        "trade_if_diligent": trade(cell, _diligent(cell)),
        "optimiser": times(cell, nominal_robot(cell)),
        **learned,
    }


def untrained(cell: Cell, *, seeds: int) -> list[tuple[float, float]]:
    """(nominal, guaranteed) seconds of robots whose networks know nothing: what comes of itself,
    one a seed.
    """
    tasks, hidden = len(cell.tasks), STATION.config.hidden
    data = station(cell, per_second=whole_ticks(cell))
    inputs = observe_normalised(data, reset(data)).shape[1]
    draws = (partial(np.random.default_rng(seed).uniform, -1.0, 1.0) for seed in range(seeds))
    actors = (init(draw, (inputs, *hidden, tasks + 1)) for draw in draws)
    return [times(cell, learned_robot(cell, actor)) for actor in actors]


def _diligent(cell: Cell) -> Values:
    hostile = values(cell, HOSTILE)
    return Diligent(hostile.moves, HOSTILE, hostile.weights, hostile.most)


def learn(
    cell: Cell, *, adversary: bool, seeds: Sequence[int], recipe: StationRecipe = STATION
) -> list[Perceptron]:
    """The robot's actor of each seed, trained by decisions for time alone, side by side.

    Args:
      adversary: the human is paid minus the robot's reward; else both are paid for the time.

    Raises:
      CellError: the thesis's station cannot hold the cell.
    """
    import jax

    from tandem.lab.alessio2022 import training as compiled
    from tandem.lab.alessio2022.adversarial import Envious
    from tandem.lab.kinat2023.learn_env import StationWorld

    made, config = StationWorld.of(cell, recipe), recipe.config
    world = replace(made, station=_without_stress(made.station))
    paid = Envious(world, jax.numpy.array([[1.0, 0.0], [-1.0, 0.0] if adversary else [0.0, 1.0]]))
    updates = sum(
        (stage.steps or 0) // (config.environments * config.horizon) for stage in config.stages
    )
    actors = jax.device_get(compiled.together(compiled.keys(seeds, 1)[0], paid, config, updates)[0])
    return [
        jax.tree.map(lambda leaf, seed=seed: np.asarray(leaf[seed]), actors)
        for seed in range(len(seeds))
    ]


def learned_robot(
    cell: Cell, actor: Perceptron, activation: str = STATION.config.activation
) -> Robots:
    """The greedy robot of an actor from `learn`, as the exact values can follow it."""
    data = _without_stress(station(cell, per_second=whole_ticks(cell)))
    moves = Moves.of(cell)
    known: dict[Position, tuple[int, ...]] = {}

    def decide(position: Position) -> tuple[int, ...]:
        if position not in known:
            state, named = as_state(moves, data, position, whole_ticks(cell))
            mask = decisions.after_human(state, decisions.choices(data, state), np.int32(named))
            logits = forward(np, actor, observe_normalised(data, state)[ROBOT], activation)
            action = int(np.argmax(np.where(mask, logits, -np.inf)))
            known[position] = (_way(moves, action - 1, _robot(moves)),) if action else ()
        return known[position]

    return decide


def as_state(moves: Moves, data: Station, position: Position, per_second: int) -> tuple[State, int]:
    """The position as the thesis's station holds it before the human's move of this moment, and the
    task that this move named, 0 for none.

    Stress is left at 0: the worlds here have none.
    """
    time, doing, named = np.array(data.time - (data.time > 0)), np.zeros(2, np.int32), 0
    ended = np.array([bool(position.done >> task & 1) for task in range(len(moves.ways))])
    time[:, ended] = 0
    for way, left in position.running:
        task, agent = moves.task[way], HUMAN if moves.who[way] & moves.instance.humans else ROBOT
        if left == moves.ticks[way]:
            named = task + 1
            continue
        time[:, task] = 0
        time[agent, task] = round(left * per_second / moves.instance.per_second)
        doing[agent] = task + 1
    return State(time, doing, ended, np.zeros((), np.int32), np.zeros((), np.float32)), named


def _without_stress(data: Station) -> Station:
    return data._replace(stress=data.stress * 0)


def _robot(moves: Moves) -> int:
    return moves.instance.everybody & ~moves.instance.humans


def _way(moves: Moves, task: int, who: int) -> int:
    return next(way for way in moves.ways[task] if moves.who[way] == who)


def _seconds(value: float) -> float:
    return round(value, 6)
