"""Robots on the grid as the exact search can follow them: one that goes the quickest way, and a
trained one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from tandem.lab.alessio2022 import exact
from tandem.lab.alessio2022.exact import Decide, Place
from tandem.lab.alessio2022.layout import RIGHT, WRONG, Layout
from tandem.lab.alessio2022.observations import OBSERVATIONS, observe
from tandem.lab.alessio2022.world import HUMAN, ROBOT, WAIT, State, grid

Pairs = tuple[tuple[int, int], ...]


def quickest(layout: Layout) -> Decide:
    """A robot that looks at nobody: the shortest open way to a right terminal state, up before down
    before left before right; else it waits.
    """
    neighbours = [layout.neighbours(place) for place in range(len(layout.text))]
    right, wrong = set(layout.squares(RIGHT)), set(layout.squares(WRONG))

    def decide(place: Place, history: Pairs) -> int:
        edge, seen = deque([(place.robot, WAIT)]), {place.robot}
        while edge:
            here, first = edge.popleft()
            for action, near in enumerate(neighbours[here][1:], 1):
                if near in right:
                    return first or action
                if (
                    near >= 0
                    and near not in seen
                    and near not in wrong
                    and not place.closed >> near & 1
                ):
                    seen.add(near)
                    edge.append((near, first or action))
        return WAIT

    return decide


def greedy(
    layout: Layout, logits: Callable[[Any], Any], *, sees: str, lawful: bool = True
) -> Decide:
    """A trained robot that takes its most probable action.

    Args:
      logits: observation `[4 S]` -> `[5]`.
      sees: a name in `OBSERVATIONS`.
      lawful: it chooses among possible actions only; else it may name an impossible one, which is a
        wait.
    """
    data = grid(layout)

    def decide(place: Place, history: Pairs) -> int:
        state = as_state(len(layout.text), place, history)
        preferred = logits(observe(data, state, OBSERVATIONS[sees]))
        if lawful:
            possible = [
                there >= 0 and not place.closed >> int(there) & 1
                for there in data.neighbour[place.robot]
            ]
            preferred = np.where([True, *possible[1:]], preferred, -np.inf)
        return int(np.argmax(preferred))

    return decide


def as_state(squares: int, place: Place, history: Pairs) -> State:
    """The state of `world.py` after such a history; `waited` is 0 or 1."""
    path = np.zeros((2, squares), bool)
    for robot, human in history:
        path[ROBOT, robot] = path[HUMAN, human] = True
    clock, nobody = np.int32(len(history) - 1), np.int32(0)
    return State(
        np.array([place.robot, place.human], np.int32),
        np.int32(place.turn),
        clock,
        path,
        nobody,
        np.int32(place.waited),
    )


def game(layout: Layout, robot: Decide, human: Decide, *, first: int = ROBOT) -> tuple[Pairs, bool]:
    """One game between two that are given: the squares (robot, human), starts first, and whether a
    right terminal state was reached.
    """
    place = exact.begin(layout, first)
    neighbours = [layout.neighbours(square) for square in range(len(layout.text))]
    history: Pairs = ((place.robot, place.human),)
    while True:
        here = place.robot if place.turn == ROBOT else place.human
        to = neighbours[here][(robot if place.turn == ROBOT else human)(place, history)]
        moves = to >= 0 and to != here and not place.closed >> to & 1
        to = to if moves else here
        pair = (to, place.human) if place.turn == ROBOT else (place.robot, to)
        over = (not moves and place.waited) or layout.text[to] in RIGHT + WRONG
        history = (*history, pair)
        if over:
            return history, layout.text[to] in RIGHT
        place = Place(place.closed | 1 << to, *pair, 1 - place.turn, not moves)


def towards(layout: Layout, goal: int) -> Decide:
    """A human that goes for one terminal state as `people.pursues` has it, without mistakes."""
    neighbours, far = (
        [layout.neighbours(place) for place in range(len(layout.text))],
        layout.distances(goal),
    )

    def decide(place: Place, history: Pairs) -> int:
        there: Sequence[int] = neighbours[place.human]
        possible = [
            action
            for action in range(5)
            if action == WAIT or (there[action] >= 0 and not place.closed >> there[action] & 1)
        ]
        return min(
            possible,
            key=lambda action: (
                far[there[action]] if far[there[action]] >= 0 else len(far),
                action,
            ),
        )

    return decide


def waits(place: Place, history: Pairs) -> int:
    """A human that does nothing."""
    return WAIT
