"""Grids as people draw them: a few lines of text, checked once. Built-in ones, and random ones.

    #  obstacle          R  where the robot begins        G  the right terminal state (one or more)
    .  free square       H  where the human begins        W  a wrong terminal state (any number)

Source: Alessio, Aliev and Antonelli (2022), doi 10.1007/978-3-030-99310-8_3. Their layout, starts
and terminal states are not public: every layout here is ours (ASSUMPTION).
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from difflib import get_close_matches

from tandem.errors import UsageError

OBSTACLE, FREE, ROBOT_START, HUMAN_START, RIGHT, WRONG = "#.RHGW"


@dataclass(frozen=True)
class Layout:
    """One grid, sound once it exists.

    Attributes:
      rows: lines of equal length over `#.RHGW`, the upper edge first.
    """

    rows: tuple[str, ...]

    def __post_init__(self) -> None:
        if faults := [fault for rule in RULES for fault in rule(self)]:
            raise UsageError(
                "The grid does not hold:\n" + "\n".join(f"- {fault}" for fault in faults)
            )

    @property
    def height(self) -> int:
        """Rows."""
        return len(self.rows)

    @property
    def width(self) -> int:
        """Columns."""
        return len(self.rows[0])

    @property
    def text(self) -> str:
        """All squares, row after row: place `row * width + column`."""
        return "".join(self.rows)

    def squares(self, kind: str) -> list[int]:
        """The places of that kind, in reading order."""
        return [place for place, letter in enumerate(self.text) if letter == kind]

    def neighbours(self, place: int) -> list[int]:
        """The place itself and those above, below, left and right of it, in the order of the
        actions; -1 outside or where an obstacle stands.
        """
        row, column = divmod(place, self.width)
        found = []
        for down, right in ((0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)):
            inside = 0 <= row + down < self.height and 0 <= column + right < self.width
            there = (row + down) * self.width + column + right
            found.append(there if inside and self.text[there] != OBSTACLE else -1)
        return found

    def distances(self, target: int) -> list[int]:
        """Moves from each place to `target` when nobody stands in the way; -1 where no way leads
        there. Other terminal states are no way.
        """
        far = [-1] * len(self.text)
        far[target], edge = 0, [target]
        while edge:
            edge = [
                near
                for place in edge
                for near in self._entries(place)
                if far[near] < 0 and not far.__setitem__(near, far[place] + 1)
            ]
        return far

    def _entries(self, place: int) -> list[int]:
        """Places from which one move leads here: no obstacle, and no terminal state, where every
        way ends.
        """
        return [
            near
            for near in self.neighbours(place)[1:]
            if near >= 0 and self.text[near] not in RIGHT + WRONG
        ]


def layout(given: str | Layout) -> Layout:
    """A built-in layout by name, one drawn in text (several lines), or the layout itself.

    Raises UsageError for an unknown name and for a drawing that is not sound, every reason at once.
    """
    if isinstance(given, Layout):
        return given
    if "\n" in given.strip():
        return Layout(tuple(line.strip() for line in given.strip().splitlines()))
    if given not in LAYOUTS:
        meant = "".join(f" Did you mean {near!r}?" for near in get_close_matches(given, LAYOUTS, 1))
        raise UsageError(
            f"grid {given!r}: there is none.{meant} There are: {', '.join(LAYOUTS)}; or give the"
            " drawing, one line a row."
        )
    return Layout(tuple(LAYOUTS[given].split()))


def random_layout(seed: int, *, size: int = 8, obstacles: float = 0.35, wrong: int = 2) -> Layout:
    """A square grid with so many wrong terminal states and one right one, everything drawn with the
    seed; a way leads from both starts to each.

    Args:
      obstacles: share of the squares that are obstacles before the starts and terminal states are
        put down.
    """
    draw = random.Random(seed)
    while True:
        letters = [OBSTACLE if draw.random() < obstacles else FREE for _ in range(size * size)]
        places = draw.sample(range(size * size), 3 + wrong)
        for place, letter in zip(
            places, ROBOT_START + HUMAN_START + RIGHT + WRONG * wrong, strict=True
        ):
            letters[place] = letter
        made = Layout(tuple("".join(letters[row * size : (row + 1) * size]) for row in range(size)))
        if all(made.distances(target)[start] > 0 for target in places[2:] for start in places[:2]):
            return made


LAYOUTS = {
    "crossing": (
        """
        ......G
        .#####.
        R##W#W.
        .##.##.
        .......
        ###.##.
        H......
    """
    ),
    "crossing-12": (
        """
        ...........G
        .####.#####.
        .#########W.
        R####W#####.
        .####.#####.
        .####.#####.
        .####..####.
        ............
        #####.#####.
        #.###.#..##.
        #.###.#..##.
        H...........
    """
    ),
}
"""Name -> drawing. In both the robot's quickest way leaves the human the way to a wrong terminal
state; another one crosses and so bars it.
"""


def _one_shape(grid: Layout) -> Iterator[str]:
    if not grid.rows or not grid.rows[0]:
        yield "it has no squares."
    for number, row in enumerate(grid.rows, 1):
        if len(row) != len(grid.rows[0]):
            yield (
                f"row {number} has {len(row)} squares, row 1 has {len(grid.rows[0])}: rows are of"
                " one length."
            )
        if strange := sorted(set(row) - set("#.RHGW")):
            yield (
                f"row {number} holds {', '.join(map(repr, strange))}; a square is one of # . R H"
                " G W."
            )


def _two_starts_and_a_goal(grid: Layout) -> Iterator[str]:
    for letter, name in ((ROBOT_START, "the robot"), (HUMAN_START, "the human")):
        if (count := grid.text.count(letter)) != 1:
            yield f"{count} squares are {letter}; {name} begins on exactly one."
    if RIGHT not in grid.text:
        yield "no square is G; there is at least one right terminal state."


RULES: tuple[Callable[[Layout], Iterator[str]], ...] = (_one_shape, _two_starts_and_a_goal)
