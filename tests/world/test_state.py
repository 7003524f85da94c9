"""The world's rules are the checker's: what is sound replays, what is played legally is sound, and
nothing beats the exact bound.
"""

from __future__ import annotations

from random import Random

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.plan.bounds import least_makespan
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.methods import plan
from tandem.schedule.checker import faults
from tandem.schedule.measures import stress as measured_stress
from tandem.world.arrays import Names
from tandem.world.replay import replay
from tandem.world.state import (
    State,
    advance,
    assign,
    is_done,
    is_stuck,
    late,
    legal,
    legal_of,
    makespan,
    may_wait,
    reset,
    stress,
    turn,
    wait,
)


def random_play(cell: Cell, random: Random, waits: float = 0.2) -> tuple[Names, State, bool]:
    """Legal ways at random, turns passed at random; True when it ended with all done."""
    names = Names.of(cell)
    arrays = names.arrays()
    state = reset(arrays)
    for _ in range(500):
        mask = legal(arrays, state)
        who = turn(arrays, mask)
        if who < 0:
            if is_done(state):
                return names, state, True
            if is_stuck(arrays, state, mask):
                return names, state, False
            state = advance(arrays, state)
        elif random.random() < waits and may_wait(arrays, state, mask, who):
            state = wait(state, who)
        else:
            state = assign(
                arrays,
                state,
                np.int32(random.choice(np.flatnonzero(legal_of(arrays, mask, who)).tolist())),
            )
    raise AssertionError("the play does not end")


@settings(max_examples=120)
@given(cells(), st.randoms(use_true_random=False))
def test_random_legal_play_is_sound_replays_and_beats_no_bound(cell: Cell, random: Random) -> None:
    """No operator, tool or zone is used twice at once, no break, limit or pair is broken; only
    deadlines may be missed, and the most that a task may wait, and both are reported.
    """
    names, state, done = random_play(cell, random)
    arrays = names.arrays()
    schedule = names.schedule(state.way, state.start_at, state.end_at)
    wrong = faults(cell, schedule)
    late_ones = [s for s in wrong if "deadline" in s or "must start within" in s]
    said = [sentence for sentence in wrong if sentence not in late_ones]
    if not done:
        said = [
            sentence
            for sentence in said
            if "is missing" not in sentence and "stress_of_set" not in sentence
        ]
    assert said == []
    assert (late(arrays, state).max() > 0) == bool(late_ones)
    if done:
        took, instance = names.seconds(int(makespan(state))), Instance.of(cell)
        assert names.stress(int(stress(arrays, state))) == measured_stress(cell, schedule)
        assert took >= instance.seconds(least_makespan(Layout.of(instance)))
        assert wrong or replay(cell, schedule) == took


@settings(max_examples=60)
@given(cells(), st.sampled_from(("random", "best-of-n")), st.integers(0, 1000))
def test_every_sound_schedule_replays_to_its_makespan(cell: Cell, method: str, seed: int) -> None:
    try:
        front = plan(cell, method=method, seed=seed)
    except (NothingFoundError, InfeasibleError):
        return
    for result in front:
        assert replay(cell, result.schedule) == result.makespan


@settings(max_examples=15)
@given(cells(max_tasks=5))
def test_exact_schedules_replay_and_no_play_is_shorter(cell: Cell) -> None:
    try:
        best = plan(cell, method="exhaustive", minimize="makespan")[0]
    except InfeasibleError:
        return
    assert replay(cell, best.schedule) == best.makespan
    for seed in range(5):
        names, state, done = random_play(cell, Random(seed), waits=0.0)
        sound = done and not faults(cell, names.schedule(state.way, state.start_at, state.end_at))
        assert not sound or names.seconds(int(makespan(state))) >= best.makespan
