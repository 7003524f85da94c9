"""Limits of people where work begins: legal play at random, in the world and in the look-ahead,
never exceeds one by a formula that reads plain data; both and the journal's rules agree.
"""

from __future__ import annotations

from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests import limited
from tests.dispatch import test_situation_and_world as both
from tests.fuzz.judges import drawn
from tests.plan.brute_force import Plain, Step
from tests.world.test_parts_held import looked_ahead, played, random_cell

from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule
from tandem.world import state
from tandem.world.arrays import Names


@pytest.mark.parametrize("seed", range(12))
def test_legal_play_keeps_every_limit(seed: int) -> None:
    cell = random_cell(seed, "limits")
    if cell is None:
        return
    _, data = drawn(seed, "limits")
    random = Random(seed)
    for play in (played,) if cell.stress_of_set is not None else (played, looked_ahead):
        for _ in range(4):
            schedule = play(cell, random)
            assert schedule is None or faults(cell, schedule) == []
            assert schedule is None or kept(data, schedule)


@settings(max_examples=25)
@given(st.data(), st.integers(0, 60), st.booleans())
def test_the_journals_rules_agree_wherever_a_shift_comes(
    data: st.DataObject, seed: int, mistakes: bool
) -> None:
    agree = both.test_both_agree_on_what_may_begin_wherever_a_shift_comes
    cell = random_cell(seed, "limits")
    if cell is not None:
        agree.hypothesis.inner_test(data, cell, mistakes)


def kept(data: dict[str, Any], schedule: Schedule) -> bool:
    plain = Plain(data)
    steps = [
        Step(a.task, next(w for w in plain.jobs[a.task].ways if set(w.who) == set(a.operators)), 0)
        for a in schedule
    ]
    return plain.allows_who(tuple(steps))


def test_what_would_exceed_a_limit_with_what_is_left_is_not_legal() -> None:
    """Base and cover would be 0.3 together, and cover is anna's alone: she may not begin base."""
    data = limited.data(dose_lifft=0.25)
    data["tasks"]["cover"]["time"] = {"anna": 2}
    names = Names.of(limited.cell_of(data))
    arrays = names.arrays()
    ways = [names.ways[way] for way in np.flatnonzero(state.legal(arrays, state.reset(arrays)))]
    assert {(task, way.operators) for task, way in ways} == {
        ("base", ("ben",)), ("base", ("cobot",)), ("close", ("cobot",)),
    }  # fmt: skip
