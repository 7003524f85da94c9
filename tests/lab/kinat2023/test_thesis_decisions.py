"""The station by decisions tells the same story as by ticks."""

from __future__ import annotations

import jax
import numpy as np
import pytest
from tests.lab.conftest import THESIS, cell_of, random_cell

from tandem.lab.kinat2023 import (
    HUMAN,
    ROBOT,
    after_human,
    choices,
    decide_step,
    deciding,
    legal,
    reset,
    reward_set,
    station,
    step,
)
from tandem.lab.kinat2023.episode import play
from tandem.schedule.checker import faults
from tandem.schedule.measures import makespan, stress

CELLS = {
    "thesis": cell_of(THESIS),
    **{f"random {n}": random_cell(n, n, 6) for n in (2, 3, 5, 8, 12)},
}
PAID = {
    f"{name} {stage}": reward_set(name, stress_factor=2.0, stage=stage)
    for name in ("appendix", "table_5_2")
    for stage in (1, 2)
}


def drawn(rng, data, state):
    """A random joint decision the masks allow: the human first, then the robot."""
    mask = choices(data, state)
    human = int((mask[HUMAN] * rng.random(mask.shape[1])).argmax())
    row = after_human(state, mask, np.int32(human))
    assert mask[HUMAN].any()
    assert row.any()
    return np.array([(row * rng.random(row.shape)).argmax(), human])


@pytest.mark.parametrize("kind", PAID)
@pytest.mark.parametrize("name", CELLS)
def test_a_decision_is_its_ticks(name, kind):
    """Same state, same rewards, same happenings as that action followed by ticks of naming nothing;
    and no tick too many.
    """
    data, rng, paid = station(CELLS[name]), np.random.default_rng(0), PAID[kind]
    for _ in range(20):
        state, done = reset(data), False
        while not done:
            action = drawn(rng, data, state)
            after, reward, done, info = decide_step(data, paid, state, action)
            ticked, total, idle, seen = state, np.zeros(2), np.zeros(2, int), []
            for tick in range(info.ticks):
                if tick and any(who.finished.any() for who in seen):
                    assert not deciding(data, ticked).any()
                ticked, paid_now, ticked_done, what = step(
                    data, paid, ticked, action if tick == 0 else np.zeros(2, int)
                )
                total, idle = total + paid_now, idle + what.idle
                seen.append(what)
            jax.tree.map(np.testing.assert_array_equal, after, ticked)
            np.testing.assert_array_equal(reward, total)
            np.testing.assert_array_equal(info.idle, idle)
            np.testing.assert_array_equal(
                info.finished, np.sum([what.finished for what in seen], axis=0)
            )
            np.testing.assert_array_equal(
                info.finished_at, np.sum([what.finished_at for what in seen], axis=0)
            )
            np.testing.assert_array_equal(info.started, seen[0].started)
            assert done == ticked_done
            assert info.illegal.sum() == 0
            assert done or deciding(data, after).any()
            state = after


@pytest.mark.parametrize("name", CELLS)
def test_every_play_ends_and_makes_a_sound_schedule(name):
    cell, rng = CELLS[name], np.random.default_rng(1)
    for _ in range(30):
        episode = play(cell, PAID["appendix 2"], lambda data, state: drawn(rng, data, state))
        assert episode.done
        assert faults(cell, episode.schedule) == []
        assert (makespan(episode.schedule), stress(cell, episode.schedule)) == (
            episode.ticks,
            episode.stress,
        )
        assert len(episode.actions) <= 2 * len(cell.tasks)


def test_masks_of_an_agent_with_nothing_to_decide_hold_only_waiting(thesis):
    data, rng = station(thesis), np.random.default_rng(2)
    for _ in range(30):
        state, done = reset(data), False
        while not done:
            mask, some = choices(data, state), deciding(data, state)
            for agent in (ROBOT, HUMAN):
                assert mask[agent, 1:].any() == some[agent]
                assert mask[agent].any()
                np.testing.assert_array_equal(mask[agent, 1:], legal(data, state)[agent, 1:])
                if not some[agent]:
                    np.testing.assert_array_equal(mask[agent], [True] + [False] * 7)
            state, _, done, _ = decide_step(
                data, PAID["appendix 2"], state, drawn(rng, data, state)
            )


def test_when_all_is_done_both_may_only_wait(thesis):
    data = station(thesis)
    state = reset(data)._replace(time=np.zeros((2, 7), np.int32), ended=np.ones(7, bool))
    np.testing.assert_array_equal(choices(data, state), [[True] + [False] * 7] * 2)


def test_the_robot_sees_what_the_human_leaves(pair):
    data = station(pair)
    state = reset(data)
    mask = choices(data, state)
    np.testing.assert_array_equal(mask[ROBOT], [1, 1, 1, 0])
    np.testing.assert_array_equal(after_human(state, mask, np.int32(1)), [1, 0, 1, 0])
    np.testing.assert_array_equal(after_human(state, mask, np.int32(0)), [0, 1, 1, 0])


def test_who_alone_can_go_on_may_not_wait():
    """Nobody works and the robot can do nothing now: the human must begin."""
    cell = cell_of({"a": ({"human": 2}, 1, []), "b": ({"robot": 2}, 0, ["a"])})
    np.testing.assert_array_equal(
        choices(station(cell), reset(station(cell))), [[1, 0, 0], [0, 1, 0]]
    )


def test_the_human_who_must_wait_eight_seconds_decides_to_once_an_event(thesis):
    """Table 6-1 at factor 5. At 10 s and 16 s task 5 is legal for the human and must be left to the
    robot, until 6 can begin at 18 s.
    """
    script = iter([(1, 3), (2, 0), (0, 0), (4, 0), (5, 6), (7, 0)])
    seen = []

    def choose(data, state):
        seen.append((int(state.clock), bool(choices(data, state)[HUMAN, 5])))
        return next(script)

    episode = play(thesis, reward_set("appendix", stress_factor=5.0), choose)
    assert (episode.ticks, episode.stress, episode.illegal) == (24, 3, 0)
    assert seen == [(0, False), (9, False), (10, True), (16, True), (18, True), (22, False)]


def test_decisions_trace_under_jit_and_vmap_and_compile_once(thesis):
    data, paid, traced = station(thesis), PAID["appendix 1"], []

    @jax.jit
    @jax.vmap
    def go(state, action):
        traced.append(1)
        return decide_step(data, paid, state, action)

    first = reset(data)
    states = jax.tree.map(lambda part: np.repeat(np.asarray(part)[None], 4, axis=0), first)
    rng = np.random.default_rng(3)
    for _ in range(6):
        actions = np.stack(
            [
                drawn(rng, data, jax.tree.map(lambda part, i=i: np.asarray(part)[i], states))
                for i in range(4)
            ]
        ).astype(np.int32)
        batch = go(states, actions)
        for i in range(4):
            alone = decide_step(
                data, paid, jax.tree.map(lambda part, i=i: np.asarray(part)[i], states), actions[i]
            )
            jax.tree.map(
                lambda whole, one, i=i: np.testing.assert_array_equal(np.asarray(whole)[i], one),
                batch,
                alone,
            )
        states = jax.tree.map(np.asarray, batch[0])
    assert len(traced) == 1
