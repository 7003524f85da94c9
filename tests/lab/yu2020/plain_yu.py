"""The search of Yu, Huang and Chang (2020) in straightforward Python: dictionaries for the tree,
lists for the board, NumPy for the networks.

An independent telling of the rules, the networks' input and the search, against which the batched
one is held (`test_alphazero_plain.py`), and its peer in `benchmarks/search.py`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from tandem.lab.yu2020.board import Board, Who
from tandem.lab.yu2020.config import YuSearch

ROBOT, HUMAN = 0, 1


@dataclass(frozen=True)
class Play:
    """Pieces left on the board (by number), what each agent is doing (a number or None), how long
    it still takes, and the clock.
    """

    left: frozenset[int]
    doing: tuple[int | None, int | None]
    busy: tuple[int, int]
    clock: int


class PlainGame:
    """The game on one board."""

    def __init__(self, board: Board) -> None:
        self.board, self.pieces = board, board.pieces

    def start(self) -> Play:
        return Play(frozenset(range(len(self.pieces))), (None, None), (0, 0), 0)

    def rows(self, play: Play) -> dict[int, int]:
        """The row in which each piece that is left lies, 1 at the bottom: it rests on the highest
        one below its span.
        """
        found: dict[int, int] = {}
        for number in sorted(play.left, key=lambda number: self.pieces[number].row):
            piece = self.pieces[number]
            below = [
                found[other]
                for other in found
                if self.pieces[other].first <= piece.last and piece.first <= self.pieces[other].last
            ]
            found[number] = 1 + max(below, default=0)
        return found

    def eligible(self, play: Play, agent: int) -> list[int]:
        if play.doing[agent] is not None:
            return []
        fits = (Who.ROBOT, Who.EITHER) if agent == ROBOT else (Who.HUMAN, Who.EITHER)
        return [
            number
            for number, row in self.rows(play).items()
            if row == 1 and number not in play.doing and self.pieces[number].who in fits
        ]

    def turn(self, play: Play) -> int:
        return -1 if not play.left else HUMAN if self.eligible(play, HUMAN) else ROBOT

    def legal(self, play: Play) -> dict[int, int]:
        """Column (from 0) -> piece."""
        return (
            {
                self.pieces[number].first - 1: number
                for number in self.eligible(play, self.turn(play))
            }
            if play.left
            else {}
        )

    def step(self, play: Play, column: int) -> Play:
        agent, number = self.turn(play), self.legal(play)[column]
        doing, busy = list(play.doing), list(play.busy)
        doing[agent], busy[agent] = number, self.pieces[number].time
        play = Play(play.left, (doing[0], doing[1]), (busy[0], busy[1]), play.clock)
        while play.left and not self.eligible(play, HUMAN) and not self.eligible(play, ROBOT):
            passed = min(
                time for time, what in zip(play.busy, play.doing, strict=True) if what is not None
            )
            busy = [max(time - passed, 0) for time in play.busy]
            gone = {
                what
                for time, what in zip(busy, play.doing, strict=True)
                if what is not None and time == 0
            }
            still = [None if what in gone else what for what in play.doing]
            play = Play(
                play.left - gone, (still[0], still[1]), (busy[0], busy[1]), play.clock + passed
            )
        return play

    def tensor(self, play: Play) -> Any:
        """`[h, w, 3]`."""
        seen = np.zeros((self.board.height, self.board.width, 3), np.float32)
        seen[..., 1] = -2
        for number, row in self.rows(play).items():
            piece = self.pieces[number]
            seen[row - 1, piece.first - 1 : piece.last, 1] = -1
            executing = number in play.doing
            agent = play.doing.index(number) if executing else None
            code = piece.who if agent is None else agent
            seen[row - 1, piece.first - 1] = (
                piece.time if agent is None else play.busy[agent],
                code,
                piece.last - piece.first + 1,
            )
        return seen


def outputs(parameters: Any, agent: int, board: Any) -> tuple[Any, float]:
    """Softmax over the columns and the value of one agent's network."""
    own = {
        name: {part: array[agent] for part, array in layer["0"].items()}
        for name, layer in parameters.items()
    }
    flow = board
    for name in ("first", "second"):
        padded = np.pad(flow, ((0, 1), (0, 1), (0, 0)))
        patches = np.concatenate(
            [padded[:-1, :-1], padded[:-1, 1:], padded[1:, :-1], padded[1:, 1:]], -1
        )
        flow = np.maximum(patches @ own[name]["weight"] + own[name]["bias"], 0)
        height, width, filters = flow.shape
        flow = (
            flow[: height // 2 * 2, : width // 2 * 2]
            .reshape(height // 2, 2, width // 2, 2, filters)
            .max((1, 3))
        )
    flow = np.maximum(flow.reshape(-1) @ own["dense"]["weight"] + own["dense"]["bias"], 0)
    logits = flow @ own["policy"]["weight"] + own["policy"]["bias"]
    odds = np.exp(logits - logits.max())
    return odds / odds.sum(), float((flow @ own["value"]["weight"] + own["value"]["bias"])[0])


class PlainSearch:
    """Their search for one agent, from one position."""

    def __init__(
        self, game: PlainGame, parameters: Any, norms: tuple[float, float], config: YuSearch
    ) -> None:
        self.game, self.parameters, self.norms, self.config = game, parameters, norms, config

    def visits(self, play: Play) -> tuple[dict[int, int], dict[int, float]]:
        """How often each column was looked at, and the least that was found under it."""
        self.me = self.game.turn(play)
        self.number: dict[Play, dict[int, int]] = {}
        self.least: dict[Play, dict[int, float]] = {}
        self.prior: dict[Play, Any] = {}
        self.next: dict[tuple[Play, int], tuple[Play, int]] = {}
        self.value: dict[Play, float] = {}
        self.add(play)
        for _ in range(self.config.simulations):
            self.simulate(play)
        return self.number[play], self.least[play]

    def add(self, play: Play) -> None:
        columns = self.game.legal(play)
        self.number[play], self.least[play] = dict.fromkeys(columns, 0), dict.fromkeys(columns, 0.0)
        self.prior[play], value = outputs(self.parameters, self.me, self.game.tensor(play))
        self.value[play] = value * self.norms[self.me] if play.left else 0.0

    def simulate(self, root: Play) -> None:
        path, play = [], root
        for _ in range(self.config.depth):
            number, least, total = (
                self.number[play],
                self.least[play],
                sum(self.number[play].values()),
            )
            if not number:
                break
            c = self.config.exploration
            explored = {
                column: c
                * float(self.prior[play][column])
                * math.sqrt(total)
                / (1 + number[column])
                for column in number
            }
            first = {
                column: self.config.unvisited == "first" and not number[column] for column in number
            }
            column = min(
                sorted(number),
                key=lambda column: -math.inf if first[column] else least[column] - explored[column],
            )
            new = (play, column) not in self.next
            if new:
                self.next[play, column] = self.mine(play, column)
            after, passed = self.next[play, column]
            path.append((play, column, passed))
            if new and after not in self.number:
                self.add(after)
            play = after
            if new:
                break
        value = self.value[play]
        for play, column, passed in reversed(path):
            self.least[play][column] = (
                value if self.number[play][column] == 0 else min(self.least[play][column], value)
            )
            self.number[play][column] += 1
            value += passed

    def mine(self, play: Play, column: int) -> tuple[Play, int]:
        """My move, then what the other's network likes best until it is my turn again."""
        after = self.game.step(play, column)
        while after.left and (other := self.game.turn(after)) != self.me:
            odds, _ = outputs(self.parameters, other, self.game.tensor(after))
            after = self.game.step(
                after, max(sorted(self.game.legal(after)), key=lambda column: odds[column])
            )
        return after, after.clock - play.clock
