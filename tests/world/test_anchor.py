"""Exact expected values of the thesis's cell, robot controlled, the human a random chooser: dynamic
programming over the world's own functions.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from tandem.cell.model import Cell
from tandem.world.arrays import NEVER, Names
from tandem.world.state import (
    State,
    advance,
    assign,
    is_done,
    legal,
    legal_of,
    may_wait,
    reset,
    turn,
    wait,
)


def expected_makespan(cell: Cell, p: Fraction) -> Fraction:
    """Ticks of 1 s. At its turn the human picks uniformly among its legal tasks with probability p;
    else, and the robot always, what is best.
    """
    arrays = Names.of(cell, per_second=1).arrays()

    def from_now(state: State) -> State:
        """The same situation with the clock at 0, so that equal situations are equal."""
        ends = np.where(state.way < 0, NEVER, np.maximum(state.end_at - state.clock, 0)).astype(
            np.int32
        )
        free = np.maximum(state.free_at - state.clock, 0).astype(np.int32)
        return reset(arrays)._replace(
            way=state.way, end_at=ends, start_at=ends * 0, free_at=free, waits=state.waits
        )

    seen: dict[bytes, Fraction] = {}

    def value(state: State) -> Fraction:
        key = b"".join(
            part.tobytes() for part in (state.way, state.end_at, state.free_at, state.waits)
        )
        if key not in seen:
            seen[key] = _value(state)
        return seen[key]

    def _value(state: State) -> Fraction:
        if is_done(state):
            return Fraction(0)
        mask = legal(arrays, state)
        who = turn(arrays, mask)
        if who < 0:
            later = advance(arrays, state)
            return int(later.clock) + value(from_now(later))
        tasks = [
            value(assign(arrays, state, np.int32(way)))
            for way in np.flatnonzero(legal_of(arrays, mask, who))
        ]
        best = min(
            [*tasks, *([value(wait(state, who))] if may_wait(arrays, state, mask, who) else [])]
        )
        return p * sum(tasks) / len(tasks) + (1 - p) * best if arrays.human[who] else best

    return value(reset(arrays))


@cache
def thesis() -> Cell:
    from tandem.files.load import load

    return load("examples/thesis.yaml")


@pytest.mark.parametrize(
    ("p", "seconds"), [("0", "23.000"), ("1/10", "23.233"), ("1/2", "24.167"), ("1", "25.333")]
)
def test_the_random_chooser_costs_what_the_prototype_found(p: str, seconds: str) -> None:
    """Humans decide first at a moment, then robots; were robots first, the expected makespan would
    be 23 at every p.
    """
    assert f"{float(expected_makespan(thesis(), Fraction(p))):.3f}" == seconds
