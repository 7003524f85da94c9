"""Plain data with one value changed, somewhere: what a hand, a disk or an attacker does to a
file.
"""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

REPLACED: dict[str, Callable[[Any], Any]] = {
    "null": lambda _: None,
    "text": lambda _: "seven",
    "empty text": lambda _: "",
    "a list": lambda _: [],
    "a list of lists": lambda _: [[], {"a": None}],
    "a table": lambda _: {},
    "true": lambda _: True,
    "NaN": lambda _: float("nan"),
    "infinity": lambda _: float("inf"),
    "huge": lambda _: 10**400,
    "beyond floats": lambda _: 1e308,
    "negative": lambda _: -1,
    "half": lambda _: 0.5,
    "a surrogate": lambda _: "\ud800",
    "deep": lambda _: nested(500),
}
"""What may stand where something else should."""


@dataclass(frozen=True)
class Mutant:
    """A document with one value changed.

    Attributes:
      what: the place, dotted, and what stands there now.
      document: plain data.
    """

    what: str
    document: Any

    @property
    def text(self) -> str:
        """As JSON; NaN and infinity as Python writes them."""
        return json.dumps(self.document)


def mutants(document: Any, seed: int, count: int) -> Iterator[Mutant]:
    """So many changes of the document, each of one place drawn alike from all depths: another
    value, or no key at all.
    """
    rng = random.Random(seed)
    depths = by_depth(places(document))
    kinds = ["missing", *REPLACED]
    for number in range(count):
        place = rng.choice(depths[number % len(depths)])
        kind = rng.choice(kinds if place else kinds[1:])
        yield Mutant(
            f"{'.'.join(map(str, place)) or 'all'}: {kind}", changed(document, place, kind)
        )


def places(document: Any, place: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """The ways to all values, the whole first."""
    yield place
    if isinstance(document, dict):
        for key, value in document.items():
            yield from places(value, (*place, key))
    elif isinstance(document, list):
        for index, value in enumerate(document):
            yield from places(value, (*place, index))


def by_depth(ways: Iterator[tuple[str | int, ...]]) -> list[list[tuple[str | int, ...]]]:
    """The ways by how long they are."""
    sorted_ways: dict[int, list[tuple[str | int, ...]]] = {}
    for way in ways:
        sorted_ways.setdefault(len(way), []).append(way)
    return list(sorted_ways.values())


def changed(document: Any, place: tuple[str | int, ...], kind: str) -> Any:
    """The document with another value at the place, or without it."""
    if not place:
        return REPLACED[kind](document)
    made = copy.deepcopy(document)
    parent = made
    for key in place[:-1]:
        parent = parent[key]
    if kind == "missing":
        del parent[place[-1]]
    else:
        parent[place[-1]] = REPLACED[kind](parent[place[-1]])
    return made


def nested(depth: int) -> Any:
    """Lists in lists."""
    inner: Any = []
    for _ in range(depth):
        inner = [inner]
    return inner
