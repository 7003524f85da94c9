"""The proven optimum of a board, by best-first search over the states of the game itself. No
solver, no arrays; a judge of all players.

States that are reached in several ways are merged, boards that are mirror images or swapped halves
of each other are folded into one, and of pieces that nothing tells apart only the first is tried. A
state is opened in order of the least makespan that it can still lead to (A*; Hart, Nilsson and
Raphael 1968), so the first finished game that is opened is the best there is.

With `waiting` the same search answers another question: what could be reached if an agent might
wait for the other's next completion? Every schedule in which nothing can start earlier is played
that way, so this is the optimum of the cell, and the planner must agree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from heapq import heappop, heappush
from typing import NamedTuple

from tandem.errors import NothingFoundError
from tandem.lab.yu2020.board import Board, Piece, Who
from tandem.lab.yu2020.layout import tails, waits
from tandem.lab.yu2020.play import NAMES
from tandem.lab.yu2020.world import HUMAN, ROBOT, Layout, State
from tandem.schedule.model import Assignment, Schedule

NOBODY = -1
WAIT = -1

CAN = {Who.ROBOT: (ROBOT,), Who.EITHER: (ROBOT, HUMAN), Who.HUMAN: (HUMAN,)}


@dataclass(frozen=True)
class Optimum:
    """The least makespan of a board.

    Attributes:
      makespan: seconds; proven.
      schedule: one that takes it.
      columns: the columns that play it, from 0, in the order of the moves.
      states: how many states of the game were kept for the proof, after merging and folding.
    """

    board: Board
    makespan: int
    schedule: Schedule
    columns: tuple[int, ...]
    states: int


def optimum(board: Board, *, waiting: bool = False, limit: int = 2_000_000) -> Optimum:
    """The optimum of the game, or with `waiting` of the same board when agents may wait (then
    `columns` leave the waiting out).

    Raises NothingFoundError when the proof needs more than `limit` states.
    """
    rules = _Rules(board, waiting)
    fold = _folding(board, rules.pieces)
    path, makespan, states = _search(
        rules, fold, _State(0, (NOBODY, NOBODY), (0, 0), NOBODY), limit
    )
    schedule, columns = _played(rules, fold, path)
    return Optimum(board, makespan, schedule, columns, states)


def replanning(board: Board, *, limit: int = 2_000_000) -> Callable[[Layout, State], int]:
    """Somebody who plays the board's optimum, and proves a new one whenever something has gone
    wrong. For `play`.

    Raises NothingFoundError, when it plays, as `optimum` does.
    """
    rules = _Rules(board, waiting=False)
    places = [(piece.row - 1, piece.first - 1) for piece in rules.pieces]
    plan: dict[_State, int] = {}

    def unfolded(state: _State) -> _State:
        return state

    def choose(_: Layout, state: State) -> int:
        gone = sum(1 << number for number, place in enumerate(places) if not state.on[place])
        robot, human = (
            next((number for number, place in enumerate(places) if doing[place]), NOBODY)
            for doing in state.doing
        )
        here = _State(
            gone, (robot, human), (int(state.left[ROBOT]), int(state.left[HUMAN])), NOBODY
        )
        if here not in plan:
            path = _search(rules, unfolded, here, limit)[0]
            plan.update(zip(path, _played(rules, unfolded, path)[1], strict=False))
        return plan[here]

    return choose


class _State(NamedTuple):
    """A state without its clock.

    gone: pieces that have left the board, as bits.
    doing, left: per agent the piece in hand (-1 = none) and the seconds left of it.
    waits: the agent that has chosen to wait for the next completion, -1 = none.
    """

    gone: int
    doing: tuple[int, int]
    left: tuple[int, int]
    waits: int


class _Rules:
    """The game with pieces as bits."""

    def __init__(self, board: Board, waiting: bool):
        self.name, self.waiting = board.name, waiting
        self.pieces = sorted(board.pieces, key=lambda piece: (piece.row, piece.first))
        chains = tails(board)
        self.time = [piece.time for piece in self.pieces]
        self.behind = [chains[piece.name] - piece.time for piece in self.pieces]
        self.needs = [
            sum(1 << i for i, low in enumerate(self.pieces) if waits(high, low))
            for high in self.pieces
        ]
        self.can = [
            tuple(agent in CAN[piece.who] for piece in self.pieces) for agent in (ROBOT, HUMAN)
        ]
        self.all = (1 << len(self.pieces)) - 1
        above = [
            sum(1 << i for i, high in enumerate(self.pieces) if waits(high, low))
            for low in self.pieces
        ]
        self.alike = [
            (piece.who, piece.time, above[index]) for index, piece in enumerate(self.pieces)
        ]
        order = sorted(range(len(self.pieces)), key=lambda i: -self.behind[i])
        own = [
            [i for i in order if CAN[self.pieces[i].who] == (agent,)] for agent in (ROBOT, HUMAN)
        ]
        self.falling = [
            [(1 << i, self.time[i], self.behind[i]) for i in row] for row in (*own, order)
        ]
        self._loads: dict[int, tuple[int, int, int]] = {}

    def children(self, state: _State) -> Iterator[tuple[int, int, _State, int]]:
        """Agent, piece (or `WAIT`), the next state in which someone has to choose, the seconds in
        between.
        """
        open_to = self.open_to(state)
        agent = HUMAN if open_to[HUMAN] else ROBOT
        tried = set()
        for piece in open_to[agent]:
            if self.alike[piece] not in tried:
                tried.add(self.alike[piece])
                doing, left = list(state.doing), list(state.left)
                doing[agent], left[agent] = piece, self.time[piece]
                yield (
                    agent,
                    piece,
                    *self._run_on(
                        state._replace(doing=(doing[0], doing[1]), left=(left[0], left[1]))
                    ),
                )
        other = 1 - agent
        if (
            self.waiting
            and open_to[agent]
            and (state.doing[other] != NOBODY or open_to[other])
            and state.waits == NOBODY
        ):
            yield agent, WAIT, *self._run_on(state._replace(waits=agent))

    def open_to(self, state: _State) -> list[list[int]]:
        """Per agent the pieces that it may take now; none while it works or waits."""
        begun = state.gone | self._in_hand(state)
        ready = [
            i
            for i, needs in enumerate(self.needs)
            if not begun >> i & 1 and not needs & ~state.gone
        ]
        return [
            (
                [i for i in ready if self.can[agent][i]]
                if state.doing[agent] == NOBODY and state.waits != agent
                else []
            )
            for agent in (ROBOT, HUMAN)
        ]

    def _run_on(self, state: _State) -> tuple[_State, int]:
        passed = 0
        while not any(self.open_to(state)) and state.doing != (NOBODY, NOBODY):
            first = min(left for left in state.left if left)
            gone, doing, left = state.gone, list(state.doing), list(state.left)
            for agent in (ROBOT, HUMAN):
                if state.doing[agent] != NOBODY:
                    left[agent] -= first
                    if not left[agent]:
                        gone |= 1 << state.doing[agent]
                        doing[agent] = NOBODY
            state, passed = (
                _State(gone, (doing[0], doing[1]), (left[0], left[1]), NOBODY),
                passed + first,
            )
        return state, passed

    def _in_hand(self, state: _State) -> int:
        return sum(1 << piece for piece in state.doing if piece != NOBODY)

    def floor(self, state: _State) -> int:
        """No way on takes fewer seconds: each agent's own work with what comes behind it, both
        agents' together, and the chain of what is in hand.
        """
        loads = self._loads_of(state.gone | self._in_hand(state))
        robot, human = state.left
        floors = [loads[agent] + state.left[agent] for agent in (ROBOT, HUMAN) if loads[agent]]
        floors += [
            left + self.behind[piece]
            for piece, left in zip(state.doing, state.left, strict=True)
            if piece != NOBODY
        ]
        return max([0, *floors, -(-(robot + human + loads[2]) // 2) if loads[2] else 0])

    def _loads_of(self, begun: int) -> tuple[int, int, int]:
        """Of what has not begun, per agent what only it can do and for both together: the largest
        work with at least so much behind it, plus that.

        Behind the pieces of both come `behind` seconds for both agents, hence twice.
        """
        if begun not in self._loads:
            found = []
            for row, times in zip(self.falling, (1, 1, 2), strict=True):
                work = most = 0
                for bit, time, behind in row:
                    if not begun & bit:
                        work += time
                        most = max(most, work + times * behind)
                found.append(most)
            self._loads[begun] = (found[0], found[1], found[2])
        return self._loads[begun]


def _search(
    rules: _Rules, fold: Callable[[_State], _State], start: _State, limit: int
) -> tuple[list[_State], int, int]:
    """The folded states of a best game from `start` on, the seconds that it takes, and how many
    states were kept.
    """
    clock, parent = {start: 0}, {start: start}
    heap = [(rules.floor(start), 0, start)]
    while heap and len(clock) <= limit:
        least, minus_now, state = heappop(heap)
        now = -minus_now
        if clock[state] < now:
            continue
        if state.gone == rules.all:
            return _path(parent, state), now, len(clock)
        for _, _, after, passed in rules.children(state):
            folded, then = fold(after), now + passed
            if clock.get(folded, then + 1) > then:
                clock[folded], parent[folded] = then, state
                heappush(heap, (max(least, then + rules.floor(folded)), -then, folded))
    raise NothingFoundError(
        f"{rules.name}: the proof needs more than {limit:,} states. Raise the limit, or let the"
        " planner answer."
    )


def _folding(board: Board, pieces: list[Piece]) -> Callable[[_State], _State]:
    """A function that gives all states that a symmetry of the board turns into each other as one of
    them.
    """
    place = {
        (piece.row, piece.first, piece.last, piece.who, piece.time): i
        for i, piece in enumerate(pieces)
    }
    width, half = board.width, board.width // 2

    def mirrored(piece: Piece) -> tuple[int, int]:
        return width + 1 - piece.last, width + 1 - piece.first

    def swapped(piece: Piece) -> tuple[int, int]:
        # a piece over both halves stays where it is if it is as wide as the board
        if width % 2 or piece.first <= half < piece.last:
            return (
                (piece.first, piece.last)
                if (piece.first, piece.last) == (1, width) and not width % 2
                else (0, 0)
            )
        by = half if piece.last <= half else -half
        return piece.first + by, piece.last + by

    symmetries = []
    for turned in (mirrored, swapped):
        images = [place.get((piece.row, *turned(piece), piece.who, piece.time)) for piece in pieces]
        if None not in images:
            symmetries.append([image for image in images if image is not None])
    if len(symmetries) == 2:
        symmetries.append([symmetries[1][image] for image in symmetries[0]])

    def fold(state: _State) -> _State:
        return min([state, *(_turned(state, images) for images in symmetries)])

    return fold if symmetries else lambda state: state


def _turned(state: _State, images: list[int]) -> _State:
    gone = sum(1 << image for index, image in enumerate(images) if state.gone >> index & 1)
    robot, human = (piece if piece == NOBODY else images[piece] for piece in state.doing)
    return state._replace(gone=gone, doing=(robot, human))


def _path(parent: dict[_State, _State], state: _State) -> list[_State]:
    """The folded states from the first to this one."""
    path = [state]
    while parent[path[-1]] != path[-1]:
        path.append(parent[path[-1]])
    return path[::-1]


def _played(
    rules: _Rules, fold: Callable[[_State], _State], path: list[_State]
) -> tuple[Schedule, tuple[int, ...]]:
    """The game along these folded states: its schedule and its columns."""
    state, now, rows, columns = path[0], 0, [], []
    for wanted in path[1:]:
        agent, piece, after, passed = min(
            (child for child in rules.children(state) if fold(child[2]) == wanted),
            key=lambda child: (child[3], child[1]),
        )
        if piece != WAIT:
            rows.append(
                Assignment(
                    float(now),
                    float(now + rules.time[piece]),
                    rules.pieces[piece].name,
                    (NAMES[agent],),
                )
            )
            columns.append(rules.pieces[piece].first - 1)
        state, now = after, now + passed
    return Schedule(tuple(rows)), tuple(columns)
