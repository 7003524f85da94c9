"""What the best robot reaches against the worst human on a grid whose paths close: the exact value,
by searching every game once.

A state is (the closed squares, both positions, whose turn, whether the last move was a wait). A
move closes a square and two waits in a row end the game, so no state comes back and each is valued
once, in plain whole numbers. Written on layouts, apart from `world.step`: a judge of learners, not
their world. `tables.py` is the same for paths that do not close.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple

from tandem.errors import NothingFoundError
from tandem.lab.alessio2022.layout import HUMAN_START, RIGHT, ROBOT_START, WRONG, Layout
from tandem.lab.alessio2022.world import HUMAN, ROBOT, WAIT

NEVER = 1 << 30
"""Moves until success where the human can prevent it."""


class Place(NamedTuple):
    """A state of the game.

    closed: squares that nobody can enter, as bits. robot, human: squares. turn: whose move. waited:
    the last move was a wait.
    """

    closed: int
    robot: int
    human: int
    turn: int
    waited: bool


@dataclass(frozen=True)
class Worst:
    """What the worst human can do to a robot.

    Attributes:
      moves: moves of both together until a right terminal state, however the human moves; None when
        the human can prevent it.
      line: squares (robot, human) after each move of the longest such game, or of one that the
        human wins.
      states: how many were valued.
    """

    moves: int | None
    line: tuple[tuple[int, int], ...]
    states: int

    @property
    def success(self) -> bool:
        """Whether the right terminal state is reached whatever the human does."""
        return self.moves is not None


def minimax(layout: Layout, *, first: int = ROBOT, limit: int = 2_000_000) -> Worst:
    """The best robot against the worst human: the fewest moves within which success is certain.

    Raises NothingFoundError when more than `limit` states would have to be valued.
    """
    return _Search(layout, first, limit, None).worst()


Decide = Callable[[Place, tuple[tuple[int, int], ...]], int]
"""A robot: the state and the squares (robot, human) so far, the starts first -> the action it
takes.
"""


def worst_case(
    layout: Layout, robot: Decide, *, first: int = ROBOT, limit: int = 2_000_000
) -> Worst:
    """That robot against the worst human for it, who knows what it will do: every game it can be
    drawn into is played.

    An action that is not possible counts as a wait. The robot may look at the paths, so here a
    state is a whole history.
    """
    return _Search(layout, first, limit, robot).worst()


def chance_value(layout: Layout, *, first: int = ROBOT, limit: int = 2_000_000) -> float:
    """The largest probability of success against a human who takes every possible action with the
    same probability.

    Raises NothingFoundError as `minimax`.
    """
    return _Search(layout, first, limit, None).chance(begin(layout, first), {})


def begin(layout: Layout, first: int = ROBOT) -> Place:
    """The state before the first move."""
    robot, human = layout.squares(ROBOT_START)[0], layout.squares(HUMAN_START)[0]
    return Place(1 << robot | 1 << human, robot, human, first, False)


class _Search:
    def __init__(self, layout: Layout, first: int, limit: int, robot: Decide | None):
        self.neighbours = [layout.neighbours(place) for place in range(len(layout.text))]
        self.right, self.wrong = set(layout.squares(RIGHT)), set(layout.squares(WRONG))
        self.layout, self.first, self.limit, self.robot = layout, first, limit, robot
        self.known: dict[Any, int] = {}

    def worst(self) -> Worst:
        start = begin(self.layout, self.first)
        history = ((start.robot, start.human),)
        with _deep(6 * len(self.neighbours)):
            moves = self.moves(start, history)
            line = self.line(start, history)
        return Worst(moves if moves < NEVER else None, tuple(line), len(self.known))

    def moves(self, place: Place, history: tuple[tuple[int, int], ...]) -> int:
        """Moves until success at the worst, from here."""
        key = place if self.robot is None else (place, history)
        if key not in self.known:
            if len(self.known) >= self.limit:
                raise NothingFoundError(
                    f"the grid has more than {self.limit:,} states; take a smaller one or one with"
                    " more obstacles."
                )
            self.known[key] = self.search(place, history)
        return self.known[key]

    def search(self, place: Place, history: tuple[tuple[int, int], ...]) -> int:
        if place.turn == ROBOT:
            if self.robot is None and not self.can_arrive(place):
                return NEVER
            return min(
                self.after(place, action, history) for action in self.choices(place, history)
            )
        most = 0
        for action in self.choices(place, history):
            most = max(most, self.after(place, action, history))
            if most >= NEVER:
                break
        return most

    def choices(self, place: Place, history: tuple[tuple[int, int], ...]) -> list[int]:
        possible = self.possible(place)
        if place.turn == HUMAN or self.robot is None:
            return possible
        action = self.robot(place, history)
        return [action if action in possible else WAIT]

    def possible(self, place: Place) -> list[int]:
        """The actions of the agent on turn, moves before waiting."""
        here = self.neighbours[place.robot if place.turn == ROBOT else place.human]
        return [
            *(
                action
                for action in range(1, 5)
                if here[action] >= 0 and not place.closed >> here[action] & 1
            ),
            WAIT,
        ]

    def after(self, place: Place, action: int, history: tuple[tuple[int, int], ...]) -> int:
        moved = self.move(place, action)
        to = moved.robot if place.turn == ROBOT else moved.human
        if to in self.right:
            return 1
        if to in self.wrong or (action == WAIT and place.waited):
            return NEVER
        follows = history if self.robot is None else (*history, (moved.robot, moved.human))
        return min(1 + self.moves(moved, follows), NEVER)

    def move(self, place: Place, action: int) -> Place:
        if action == WAIT:
            return place._replace(turn=1 - place.turn, waited=True)
        to = self.neighbours[place.robot if place.turn == ROBOT else place.human][action]
        pair = (to, place.human) if place.turn == ROBOT else (place.robot, to)
        return Place(place.closed | 1 << to, *pair, 1 - place.turn, False)

    def can_arrive(self, place: Place) -> bool:
        """Whether open squares lead the robot to a right terminal state, if the human stood still:
        else the worst human prevents it.
        """
        seen, edge = {place.robot}, [place.robot]
        while edge:
            for near in self.neighbours[edge.pop()][1:]:
                if near in self.right:
                    return True
                if (
                    near >= 0
                    and near not in seen
                    and near not in self.wrong
                    and not place.closed >> near & 1
                ):
                    seen.add(near)
                    edge.append(near)
        return False

    def line(self, place: Place, history: tuple[tuple[int, int], ...]) -> list[tuple[int, int]]:
        """The squares after each move when both do what `moves` values."""
        pick = min if place.turn == ROBOT else max
        action = pick(
            self.choices(place, history), key=lambda action: self.after(place, action, history)
        )
        moved = self.move(place, action)
        pair = (moved.robot, moved.human)
        if (
            self.after(place, action, history) == 1
            or pair[place.turn] in self.wrong
            or (action == WAIT and place.waited)
        ):
            return [pair]
        return [pair, *self.line(moved, history if self.robot is None else (*history, pair))]

    def chance(self, place: Place, known: dict[Place, float]) -> float:
        if place not in known:
            if len(known) >= self.limit:
                raise NothingFoundError(
                    f"the grid has more than {self.limit:,} states; take a smaller one or one with"
                    " more obstacles."
                )
            values = [self.chance_after(place, action, known) for action in self.possible(place)]
            known[place] = max(values) if place.turn == ROBOT else sum(values) / len(values)
        return known[place]

    def chance_after(self, place: Place, action: int, known: dict[Place, float]) -> float:
        moved = self.move(place, action)
        to = moved.robot if place.turn == ROBOT else moved.human
        if to in self.right:
            return 1.0
        if to in self.wrong or (action == WAIT and place.waited):
            return 0.0
        return self.chance(moved, known)


@contextmanager
def _deep(levels: int) -> Any:
    """Room for recursion: one level a move, a few frames each."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(before, 6 * levels + 1000))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)
