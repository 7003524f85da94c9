"""The thesis's station, quirk by quirk. Each test is one line of `docs/environments.md`."""

from __future__ import annotations

import numpy as np
import pytest

from tandem.lab.kinat2023 import HUMAN, ROBOT, Rewards, legal, reset, reward_set, station, step
from tandem.lab.kinat2023.episode import actions_of, follow, play
from tandem.schedule.checker import faults
from tandem.schedule.model import Assignment, Schedule

PAID = Rewards(
    step=-1.0, task_done=3.0, illegal=-10.0, idle=-100.0, all_done=1000.0, stress_factor=0.0
)


def after(cell, *actions, paid=PAID):
    """The station after these joint actions: data, state, reward of the last tick, done, info."""
    data = station(cell)
    state = reset(data)
    for action in actions:
        state, reward, done, info = step(data, paid, state, np.array(action))
    return data, state, reward.tolist(), bool(done), info


def test_every_time_shrinks_by_one_at_the_reset(pair):
    """The tick of the assignment counts as the first second of the task; 0 stays 0, "cannot"."""
    np.testing.assert_array_equal(reset(station(pair)).time, [[2, 1, 0], [3, 1, 1]])


def test_a_duration_of_three_occupies_three_ticks(pair):
    _, state, _, _, _ = after(pair, (1, 0), (0, 0))
    assert state.doing[ROBOT] == 1
    _, state, _, _, info = after(pair, (1, 0), (0, 0), (0, 0))
    assert (state.doing[ROBOT], info.finished[ROBOT], info.finished_at[ROBOT]) == (0, 1, 3)


def test_a_free_agent_that_names_nothing_pays_idle(pair):
    assert after(pair, (1, 0))[2] == [-1, -101]


def test_a_busy_agent_that_names_nothing_does_not_pay_idle(pair):
    assert after(pair, (1, 2), (0, 0))[2][ROBOT] == -1


def test_naming_a_task_while_busy_is_illegal_once(pair):
    assert after(pair, (1, 0), (2, 2))[2][ROBOT] == -11


def test_naming_a_task_with_an_open_dependency_is_illegal_once(pair):
    assert after(pair, (0, 3))[2][HUMAN] == -11


def test_naming_a_task_whose_own_time_is_zero_is_illegal_once(pair):
    assert after(pair, (1, 0), (0, 1))[2][HUMAN] == -11


def test_the_three_penalties_add_up(pair):
    """Busy, dependent and not able: the robot names `c` while it does `a`."""
    _, _, reward, _, info = after(pair, (1, 0), (3, 0))
    assert reward[ROBOT] == -31
    assert info.illegal.tolist() == [3, 0]


def test_an_illegal_action_of_a_free_agent_does_not_count_as_idle(pair):
    _, _, reward, _, info = after(pair, (0, 3))
    assert reward[HUMAN] == -11
    assert info.idle.tolist() == [1, 0]


def test_an_illegal_action_freezes_the_own_running_task_only(pair):
    data, state, _, _, _ = after(pair, (1, 2))
    frozen, _, _, info = step(data, PAID, state, np.array((1, 0)))
    assert frozen.time[ROBOT, 0] == state.time[ROBOT, 0] == 2
    assert info.finished.tolist() == [0, 2]
    _, _, _, thawed = step(data, PAID, frozen, np.array((0, 0)))
    assert thawed.finished.tolist() == [0, 0]


def test_the_robot_yields_for_free_when_both_name_the_same_task(pair):
    _, state, reward, _, info = after(pair, (1, 1))
    assert state.doing.tolist() == [0, 1]
    assert reward == [-1, -1]
    assert info.illegal.tolist() == [0, 0]
    assert info.started.tolist() == [0, 1]


def test_a_busy_human_who_names_it_too_does_not_make_the_robot_yield(pair):
    """An illegal action is 0 before the two are compared."""
    _, state, _, _, _ = after(pair, (0, 2), (1, 1))
    assert state.doing.tolist() == [1, 2]


def test_a_task_is_legal_only_in_the_tick_after_its_need_ended(pair):
    """Both are judged before either's time runs: `c` is still blocked in the tick in which `a`
    ends.
    """
    assert after(pair, (1, 0), (0, 0), (0, 3))[2][HUMAN] == -11
    assert after(pair, (1, 0), (0, 0), (0, 0), (0, 3))[1].doing[HUMAN] == 3


def test_beginning_a_task_takes_it_from_the_other(pair):
    _, state, _, _, _ = after(pair, (1, 2))
    np.testing.assert_array_equal(state.time, [[2, 0, 0], [0, 1, 1]])


def test_stress_is_paid_when_a_task_begins(pair):
    paid = PAID._replace(stress_factor=5.0)
    assert after(pair, (1, 2), paid=paid)[2] == [-1 + 5 * 1, -1 - 5 * 2]
    assert after(pair, (1, 2), (0, 0), paid=paid)[2] == [-1, -1 + 3]


def test_only_the_human_collects_stress(pair):
    assert after(pair, (1, 2))[1].stress == 2


def test_who_ends_a_task_is_paid_for_it(pair):
    assert after(pair, (1, 2), (0, 0))[2] == [-1, 2]


def test_done_pays_both_in_the_tick_that_ends_the_last_task(pair):
    _, state, reward, done, _ = after(pair, (1, 2), (0, 0), (0, 0), (0, 3), (0, 0))
    assert done
    assert state.clock == 5
    assert reward == [-1 - 100 + 1000, -1 + 3 + 1000]


def test_the_mask_is_exactly_what_costs_nothing(thesis):
    """On random play: a legal action breaks no rule, an illegal one breaks at least one."""
    data, rng = station(thesis), np.random.default_rng(0)
    for _ in range(30):
        state, done = reset(data), False
        while not done and state.clock < 80:
            mask = legal(data, state)
            for agent in (ROBOT, HUMAN):
                for number in range(8):
                    action = np.zeros(2, int)
                    action[agent] = number
                    broken = step(data, PAID, state, action)[3].illegal[agent]
                    assert (broken == 0) == mask[agent, number]
            choice = (mask * rng.random(mask.shape)).argmax(axis=1)
            state, _, done, _ = step(data, PAID, state, choice)


def plan_of(*rows):
    return Schedule(tuple(Assignment(float(a), float(b), task, (who,)) for who, task, a, b in rows))


PUBLISHED = {
    (0, 23, 17): plan_of(
        *[
            ("robot", "1", 0, 9),
            ("robot", "4", 9, 11),
            ("robot", "6", 11, 21),
            ("robot", "7", 21, 23),
        ],
        *[("human", "2", 0, 8), ("human", "3", 8, 18), ("human", "5", 18, 20)],
    ),
    (1, 23, 7): plan_of(
        *[
            ("robot", "1", 0, 9),
            ("robot", "2", 9, 16),
            ("robot", "4", 16, 18),
            ("robot", "7", 21, 23),
        ],
        *[("human", "3", 0, 10), ("human", "5", 10, 12), ("human", "6", 18, 21)],
    ),
    (5, 24, 3): plan_of(
        *[
            ("robot", "1", 0, 9),
            ("robot", "2", 9, 16),
            ("robot", "4", 16, 18),
            ("robot", "5", 18, 22),
            ("robot", "7", 22, 24),
        ],
        *[("human", "3", 0, 10), ("human", "6", 18, 21)],
    ),
}
"""(ergonomic factor, makespan, stress) of table 6-1 -> a schedule with the published allocation
(the thesis prints who does what).
"""


@pytest.mark.parametrize(("factor", "makespan", "stress"), PUBLISHED)
def test_the_published_solutions_take_their_published_ticks_and_stress(
    thesis, factor, makespan, stress
):
    schedule = PUBLISHED[factor, makespan, stress]
    assert faults(thesis, schedule) == []
    episode = play(
        thesis,
        reward_set("appendix", stress_factor=factor),
        follow(actions_of(thesis, schedule)),
        by="ticks",
    )
    assert (episode.done, episode.ticks, episode.stress, episode.illegal) == (
        True,
        makespan,
        stress,
        0,
    )
    assert episode.schedule == schedule
    assert sum(episode.returns) == 2 * (-10 * makespan + 50) + factor * (33 - 2 * stress)


def test_each_rule_can_have_a_fine_of_its_own(thesis):
    """Busy, dependent and unavailable add up, as one fine for all does."""
    data = station(thesis)
    apart = PAID._replace(illegal=(-1.0, -20.0, -300.0))
    busy = reset(data, np.array([1, 0]))
    for task, fine, rules in ((2, -1, 1), (4, -21, 2), (3, -301, 2)):
        own, same = (step(data, paid, busy, np.array((task, 0)))[1] for paid in (apart, PAID))
        assert own[ROBOT] == PAID.step + fine
        assert same[ROBOT] == PAID.step + rules * PAID.illegal


def test_a_task_can_be_in_hand_at_the_reset(thesis):
    """The robot has task 1 (9 s) in hand: eight ticks are left, and the human cannot take it."""
    data = station(thesis)
    state = reset(data, np.array([1, 0]))
    assert (state.doing.tolist(), state.time[HUMAN][0], float(state.stress)) == ([1, 0], 0, 0.0)
    for _ in range(8):
        assert state.doing[ROBOT] == 1
        state, *_ = step(data, PAID, state, np.array((0, 0)))
    assert (state.doing[ROBOT], bool(state.ended[0])) == (0, True)
    assert float(reset(data, np.array([0, 2])).stress) == 11.0
