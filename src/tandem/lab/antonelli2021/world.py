"""Parts that sit rightly, wrongly or not at all; a robot that says what is done next; a human who
sometimes does something else.

Source: Antonelli, Zeng, Aliev, Liu (2021), FME Transactions 49(4), as far as its abstract and Kinat
(2023), chapter 4, tell: states of an assembly, operations that human and robot do together, others
that take apart what was mounted wrongly, shortest time. The lists of states and operations, the
times and what the human does wrongly are not public; they are ours (ASSUMPTION).

An operation is done by both, one at a time. When the robot asks for one, the human does it with
probability 1 - p. Else one of the slips that are possible in this state happens in its place, and
its time passes:

- wrong part: the part that was asked for is mounted, but wrongly;
- wrong order: another part is mounted though something below it is missing or wrong, so it sits
  wrongly;
- undo: a part that sat rightly is taken off.

Operations are numbered: `i` mounts part `i`, `T + i` takes it off, for `T` parts.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault, NothingFoundError, UsageError
from tandem.lab.antonelli2021.markov import Outcome, Process, explore
from tandem.lab.antonelli2021.product import UNMOUNT_SHARE, Product, product

ABSENT, RIGHT, WRONG = 0, 1, 2
Node = tuple[int, ...]
"""How each part sits: `ABSENT`, `RIGHT` or `WRONG`."""

MOST_STATES = 20_000
"""A table of more is no longer learned in seconds."""


@dataclass(frozen=True)
class Slips:
    """How the human's deviations divide: weights of the kinds, 0 for never. Among the slips of one
    kind each is as likely.
    """

    wrong_part: float = 1.0
    wrong_order: float = 1.0
    undo: float = 1.0

    def __post_init__(self) -> None:
        weights = (self.wrong_part, self.wrong_order, self.undo)
        if min(weights) < 0:
            raise UsageError(
                f"slips: the weights are {', '.join(f'{weight:g}' for weight in weights)}; each is"
                " 0 or more."
            )


@dataclass(frozen=True)
class Repair:
    """All states of a product that a human of these slips can bring about, as a process of any p.

    Attributes:
      nodes: state number -> how each part sits; state 0 is the empty table.
      halfway: the process at p = 1/2.
    """

    product: Product
    slips: Slips
    nodes: Sequence[Node]
    halfway: Process

    @cached_property
    def numbers(self) -> dict[Node, int]:
        """How each part sits -> state number."""
        return {node: number for number, node in enumerate(self.nodes)}

    def process(self, p: float) -> Process:
        """The process of a human who deviates with probability `p`; outcome 0 of each operation is
        the operation itself.

        Where no slip is possible the human does what was asked for.

        Raises UsageError unless 0 <= p <= 1.
        """
        if not 0 <= p <= 1:
            raise UsageError(f"p is {p!r}: a probability lies between 0 and 1.")
        shares = self.halfway.chance.copy()
        shares[:, :, 0] = 0.0
        chance = p * 2.0 * shares
        chance[:, :, 0] = np.where(self.halfway.legal, 1.0 - np.sum(chance, axis=2), 0.0)
        return self.halfway._replace(chance=chance)

    @property
    def wrong(self) -> np.ndarray:
        """`[S]` bool, True where some part sits wrongly."""
        return np.array([WRONG in node for node in self.nodes])


def repair(
    cell: Cell, slips: Slips | None = None, *, unmount_share: float = UNMOUNT_SHARE
) -> Repair:
    """The cell's product with everything that can go wrong with it.

    Raises:
      CellError: with everything that the system cannot express, or that its table cannot hold.
      UsageError: `unmount_share` is not above 0.
    """
    made, slips = product(cell, unmount_share=unmount_share), slips or Slips()
    parts, done = len(made.names), (RIGHT,) * len(made.names)
    try:
        process, nodes = explore(
            (ABSENT,) * parts,
            lambda node: {
                operation: list(_outcomes(made, slips, node, operation))
                for operation in legal(made, node)
            },
            lambda node: node == done,
            actions=2 * parts,
            limit=MOST_STATES,
        )
    except NothingFoundError as error:
        raise CellError(
            [
                Fault(
                    f"the parts can sit in more than {MOST_STATES:,} ways, too many for a table."
                    " Take a smaller cell.",
                    ("tasks",),
                )
            ]
        ) from error
    return Repair(made, slips, nodes, process)


def legal(made: Product, node: Node) -> list[int]:
    """The operations that the robot may ask for: to mount a part where it will sit rightly, to take
    off a part that nothing sits on.
    """
    parts = range(len(node))
    mounts = [
        part
        for part in parts
        if node[part] == ABSENT and _fits(made, node, part) and _uncovered(made, node, part)
    ]
    return mounts + [
        len(node) + part for part in parts if node[part] != ABSENT and _uncovered(made, node, part)
    ]


def operation_words(made: Product, operation: int) -> str:
    """An operation for people: `mount flange A`."""
    parts = len(made.names)
    return (
        f"mount {made.names[operation]}"
        if operation < parts
        else f"take off {made.names[operation - parts]}"
    )


def _outcomes(made: Product, slips: Slips, node: Node, operation: int) -> Iterator[Outcome]:
    """The operation itself first, then each slip, at p = 1/2."""
    parts = len(node)
    if operation < parts:
        asked = Outcome(_with(node, operation, RIGHT), 0.5, made.mount[operation])
    else:
        asked = Outcome(
            _with(node, operation - parts, ABSENT), 0.5, made.unmount[operation - parts]
        )
    kinds = [
        (weight, happens)
        for weight, happens in _kinds(made, slips, node, operation)
        if weight > 0 and happens
    ]
    total = sum(weight for weight, _ in kinds)
    yield asked if kinds else asked._replace(chance=1.0)
    for weight, happens in kinds:
        for part, sits, seconds in happens:
            yield Outcome(_with(node, part, sits), 0.5 * weight / total / len(happens), seconds)


def _kinds(
    made: Product, slips: Slips, node: Node, operation: int
) -> Iterator[tuple[float, list[tuple[int, int, float]]]]:
    """Per kind of slip its weight, and what can happen: (part, how it sits then, seconds)."""
    parts = range(len(node))
    yield (
        slips.wrong_part,
        [(operation, WRONG, made.mount[operation])] if operation < len(node) else [],
    )
    out_of_order = [
        part
        for part in parts
        if node[part] == ABSENT and not _fits(made, node, part) and _uncovered(made, node, part)
    ]
    yield slips.wrong_order, [(part, WRONG, made.mount[part]) for part in out_of_order]
    undone = [
        part
        for part in parts
        if node[part] == RIGHT and _uncovered(made, node, part) and operation != len(node) + part
    ]
    yield slips.undo, [(part, ABSENT, made.unmount[part]) for part in undone]


def _fits(made: Product, node: Node, part: int) -> bool:
    return all(node[other] == RIGHT for other in made.below[part])


def _uncovered(made: Product, node: Node, part: int) -> bool:
    return all(node[other] == ABSENT for other in made.above[part])


def _with(node: Node, part: int, sits: int) -> Node:
    return (*node[:part], sits, *node[part + 1 :])
