"""The chessboard game told without a board: a piece waits for every piece of a lower row that
shares a column with it.

It shares no line with `tandem.lab.yu2020`: nothing falls here, nothing is an array, and who waits
for whom is settled before the game begins. So the two can judge each other.
"""

from __future__ import annotations


class OverlapGame:
    """`columns()`, then `take(column)` until `columns()` is empty; columns count from 0."""

    def __init__(self, board):
        self.board = board
        self.pieces = {piece.name: piece for piece in board.pieces}
        self.waits_for = {
            high.name: {
                low.name
                for low in board.pieces
                if low.row < high.row
                and set(range(low.first, low.last + 1)) & set(range(high.first, high.last + 1))
            }
            for high in board.pieces
        }
        self.waiting = set(self.pieces)
        self.ended = set()
        self.hands = {"human": None, "robot": None}  # (piece, when it ends)
        self.now = 0

    def open_to(self, who):
        if self.hands[who] is not None:
            return []
        codes = (3, 4) if who == "human" else (2, 3)
        return [
            name
            for name in self.waiting
            if self.waits_for[name] <= self.ended and self.pieces[name].who in codes
        ]

    def player(self):
        return "human" if self.open_to("human") else "robot"

    def columns(self):
        return sorted(self.pieces[name].first - 1 for name in self.open_to(self.player()))

    def take(self, column):
        who = self.player()
        (name,) = [name for name in self.open_to(who) if self.pieces[name].first - 1 == column]
        self.waiting.remove(name)
        self.hands[who] = (name, self.now + self.pieces[name].time)
        while not self.open_to("human") and not self.open_to("robot") and any(self.hands.values()):
            self.now = min(hand[1] for hand in self.hands.values() if hand)
            for agent, hand in self.hands.items():
                if hand and hand[1] == self.now:
                    self.ended.add(hand[0])
                    self.hands[agent] = None
        return name
