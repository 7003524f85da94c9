"""The grid's rules, and that the exact search, the rules and the standard faces agree on them."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test
from pettingzoo.utils import parallel_to_aec

import tandem.envs
from tandem.errors import UsageError
from tandem.lab.alessio2022 import (
    LAYOUTS,
    Layout,
    Rewards,
    coverage,
    grid,
    is_over,
    is_success,
    layout,
    legal,
    observe,
    random_layout,
    reset,
    step,
)
from tandem.lab.alessio2022.people import goals, pursues, wanders
from tandem.lab.alessio2022.world import (
    DOWN,
    HUMAN,
    LEFT,
    REACHED_RIGHT,
    REACHED_WRONG,
    RIGHTWARDS,
    ROBOT,
    UP,
    WAIT,
)

ROOM = """
    R.G
    .#.
    H.W
"""
PAID = Rewards(right=10.0, wrong=7.0, step=-0.1, idle=-0.2, illegal=-1.0)


def played(data, actions):
    """The state after these moves, taken in turns, and the rewards of each."""
    state, paid = reset(data), []
    for action in actions:
        state, reward, _, _ = step(data, PAID, state, np.array([action, action]))
        paid.append(reward)
    return state, paid


@pytest.fixture
def room():
    return grid(layout(ROOM))


def test_agents_take_turns_and_who_is_not_on_turn_can_only_wait(room):
    state = reset(room)
    assert legal(room, state)[HUMAN].tolist() == [True, False, False, False, False]
    assert legal(room, state)[ROBOT].tolist() == [True, False, True, False, True]
    state, *_ = step(room, PAID, state, np.array([WAIT, UP]))
    assert state.position.tolist() == [0, 6]  # the human's action was not looked at
    assert (int(state.turn), legal(room, state)[ROBOT].tolist()) == (
        HUMAN,
        [True, False, False, False, False],
    )


def test_no_two_agents_stand_on_one_square(room):
    state, _ = played(room, [DOWN])
    assert not legal(room, state)[HUMAN, UP]
    after, reward, _, illegal = step(room, PAID, state, np.array([WAIT, UP]))
    assert after.position.tolist() == state.position.tolist()
    assert (illegal.tolist(), reward.tolist()) == ([0, 1], [0.0, pytest.approx(-1.1)])


def test_leaving_the_grid_and_walking_into_an_obstacle_are_punished_and_move_nobody(room):
    for action in (UP, LEFT):
        state, paid = played(room, [action])
        assert state.position.tolist() == [0, 6]
        assert paid[0].tolist() == [pytest.approx(-1.1), 0.0]


def test_waiting_is_punished_on_top_of_the_step(room):
    assert played(room, [WAIT])[1][0].tolist() == [pytest.approx(-0.3), 0.0]


@pytest.mark.parametrize(
    ("actions", "reached", "paid"),
    [
        ([RIGHTWARDS, WAIT, RIGHTWARDS], REACHED_RIGHT, [9.9, 0.0]),
        ([WAIT, RIGHTWARDS] * 2, REACHED_WRONG, [0.0, 6.9]),
    ],
)
def test_the_first_terminal_state_ends_the_game_and_says_who_is_paid(room, actions, reached, paid):
    state, rewards = played(room, actions)
    assert (int(state.reached), bool(is_over(room, state)), bool(is_success(state))) == (
        reached,
        True,
        reached == REACHED_RIGHT,
    )
    assert rewards[-1].tolist() == pytest.approx(paid)


def test_visited_squares_close_and_two_waits_in_a_row_end_the_game(room):
    state, _ = played(room, [RIGHTWARDS, WAIT])
    assert not legal(room, state)[ROBOT, LEFT]  # its own first square
    assert not is_over(room, state)
    assert is_over(room, played(room, [RIGHTWARDS, WAIT, WAIT])[0])


def test_open_paths_can_be_walked_back_and_only_the_clock_ends_waiting():
    data = grid(layout(ROOM), closing=False, limit=4)
    state, _ = played(data, [RIGHTWARDS, WAIT, WAIT])
    assert legal(data, played(data, [RIGHTWARDS, WAIT])[0])[ROBOT, LEFT]
    assert not is_over(data, state)
    assert is_over(data, played(data, [WAIT] * 4)[0])


def test_the_four_channels_are_obstacles_paths_and_the_terminal_state_that_was_reached(room):
    state, _ = played(room, [RIGHTWARDS, WAIT, RIGHTWARDS])
    obstacles, robot, human, reached = observe(room, state).reshape(4, 3, 3)
    assert np.argwhere(obstacles).tolist() == [[1, 1]]
    assert robot[0].tolist() == [0.5, 0.5, 1.0]
    assert (human[2].tolist(), float(human.sum())) == ([1.0, 0.0, 0.0], 1.0)
    assert (reached[0, 2], float(np.abs(reached).sum())) == (1.0, 1.0)
    hidden, marked = (observe(room, reset(room), marks).reshape(4, 3, 3)[3] for marks in (0.0, 0.5))
    assert float(np.abs(hidden).sum()) == 0
    assert (marked[0, 2], marked[2, 2]) == (0.5, -0.5)


def test_jax_and_numpy_play_the_same_game():
    jax = pytest.importorskip("jax", reason="needs tandem[learn]")
    data = grid(layout("crossing"))
    traced, generator = (
        jax.jit(jax.vmap(step, in_axes=(None, None, 0, 0))),
        np.random.default_rng(0),
    )
    states = [reset(data) for _ in range(8)]
    for _ in range(12):
        actions = generator.integers(0, 5, (8, 2))
        batch = traced(
            jax.tree.map(jax.numpy.asarray, data),
            PAID,
            jax.tree.map(lambda *leaves: np.stack(leaves), *states),
            actions,
        )
        single = [
            step(data, PAID, state, action) for state, action in zip(states, actions, strict=True)
        ]
        jax.tree.map(
            lambda ours, theirs: np.testing.assert_allclose(ours, theirs, rtol=1e-6),
            jax.tree.map(lambda *leaves: np.stack(leaves), *single),
            batch,
        )
        states = [outcome[0] if not outcome[2] else reset(data) for outcome in single]


def test_a_drawing_that_does_not_hold_is_refused_with_every_reason():
    with pytest.raises(
        UsageError,
        match=(
            r"row 2 has 2 squares.*\n.*row 2 holds 'x'.*\n.*2 squares are R.*\n.*0 squares are"
            r" H.*\n.*no square is G"
        ),
    ):
        layout("RR.\nx.")
    with pytest.raises(
        UsageError, match=r"grid 'crosing': there is none. Did you mean 'crossing'\?"
    ):
        layout("crosing")


def test_random_grids_repeat_for_their_seed_and_let_both_reach_every_terminal_state():
    for seed in range(5):
        drawn = random_layout(seed, size=6)
        assert drawn == random_layout(seed, size=6)
        for kind in "GW":
            for place in drawn.squares(kind):
                far = drawn.distances(place)
                assert min(far[drawn.squares("R")[0]], far[drawn.squares("H")[0]]) > 0


def test_random_play_that_may_try_impossible_moves_ends_before_it_arrives_anywhere():
    """Why nothing is learned as described: two moves that are none end a game, and of five actions
    most are impossible. Masks double its length.
    """
    data, generator = grid(layout("crossing")), np.random.default_rng(0)
    moves, arrived = {}, {}
    for lawful in (True, False):
        ends = []
        for _ in range(300):
            state = reset(data)
            while not is_over(data, state):
                action = (
                    generator.choice(np.flatnonzero(legal(data, state)[state.turn]))
                    if lawful
                    else generator.integers(5)
                )
                state, *_ = step(data, PAID, state, np.array([action, action]))
            ends.append(state)
        moves[lawful], arrived[lawful] = (
            np.mean([state.clock for state in ends]),
            sum(int(state.reached) > 0 for state in ends),
        )
    assert 2.5 < moves[False] < 3.7
    assert moves[True] > 1.8 * moves[False]
    assert arrived[False] < arrived[True]


def test_a_random_human_takes_every_legal_action_equally_often():
    mask = np.array([True, False, True, True, False])
    chosen = [int(wanders(mask, np.float64(moment))) for moment in (np.arange(300) + 0.5) / 300]
    assert {action: chosen.count(action) for action in set(chosen)} == {0: 100, 2: 100, 3: 100}


@pytest.mark.parametrize(("goal", "action"), [(0.0, RIGHTWARDS), (0.99, UP)])
def test_a_human_with_a_goal_takes_the_shortest_way_to_the_one_that_was_drawn(goal, action):
    drawn = layout(ROOM)
    data, mask = grid(drawn), np.array([True, True, False, False, True])
    assert (
        int(
            pursues(
                data.neighbour,
                goals(drawn),
                data.start,
                mask,
                np.float64(goal),
                np.float64(0.5),
                np.float64(0.0),
            )
        )
        == action
    )


# --- Area coverage ---


def test_coverage_pays_as_mathworks_does_and_ends_when_all_is_covered():
    data = grid(Layout(("RG", "H.")), closing=False)
    state, paid = coverage.reset(data), []
    for action in (WAIT, WAIT, RIGHTWARDS, RIGHTWARDS):
        state, reward, over, _ = coverage.step(
            data, coverage.Rewards(), state, np.array([action, action])
        )
        paid.append(reward.tolist())
    assert paid == [[-1.0, 0.0], [0.0, -1.0], [2.0, 0.0], [100.0, 102.0]]
    assert over
    assert float(coverage.share(data, state)) == 1.0
    again, reward, _, _ = coverage.step(
        data, coverage.Rewards(full=0.0), state, np.array([LEFT, WAIT])
    )
    assert (again.position.tolist(), reward.tolist()) == ([0, 3], [-0.5, 0.0])
    # impossible, and still
    assert coverage.step(data, coverage.Rewards(full=0.0), again, np.array([WAIT, DOWN]))[
        1
    ].tolist() == [0.0, -2.0]


# --- PettingZoo ---


@pytest.mark.parametrize("drawn", LAYOUTS)
def test_pettingzoos_own_suites_are_green(drawn, capsys):
    def make():
        return tandem.envs.parallel_env("grid", drawn, observation="marked")

    with warnings.catch_warnings():
        warnings.filterwarnings("error", message=".*action_mask.*")
        warnings.filterwarnings("ignore", message="Observation")
        parallel_api_test(make(), num_cycles=200)
        parallel_seed_test(make, num_cycles=40)
        api_test(parallel_to_aec(make()), num_cycles=100)
    assert "Passed" in capsys.readouterr().out


def test_the_face_says_what_was_reached_and_draws_it():
    env = tandem.envs.parallel_env("grid", ROOM, render_mode="ansi")
    env.reset(seed=0)
    for action in (RIGHTWARDS, WAIT, RIGHTWARDS):
        _, rewards, ended, cut, infos = env.step({"robot_0": action, "human_0": action})
    assert (
        infos["robot_0"]["reached"],
        infos["human_0"]["is_success"],
        ended["robot_0"],
        cut["robot_0"],
    ) == ("right", True, True, False)
    assert rewards["robot_0"] == pytest.approx(9.9)
    assert env.render() == "rrR\n.#.\nH.W"


@pytest.mark.parametrize("none", [-1, -2, 5, 10**6])
def test_what_is_no_action_moves_nobody_and_costs_whoever_names_it(none):
    jax = pytest.importorskip("jax")
    data = grid(layout(ROOM))
    for xp in (np, jax.numpy):
        _, reward, _, illegal = step(
            jax.tree.map(xp.asarray, data),
            Rewards(),
            jax.tree.map(xp.asarray, reset(data)),
            xp.array([none, WAIT]),
        )
        np.testing.assert_allclose(reward, [-0.1 - 1.0, 0.0], rtol=1e-6)
        assert illegal.tolist() == [1, 0]
        after, reward, _, illegal = step(
            jax.tree.map(xp.asarray, data),
            Rewards(),
            jax.tree.map(xp.asarray, reset(data)),
            xp.array([WAIT, none]),
        )
        np.testing.assert_allclose(reward, [-0.1 - 0.2, -1.0], rtol=1e-6)
        assert (illegal.tolist(), after.position.tolist()) == ([0, 1], data.start.tolist())


def test_impossible_moves_raise_only_when_strict_and_wrong_options_are_named_together():
    env = tandem.envs.parallel_env("grid", ROOM, strict=True)
    env.reset()
    with pytest.raises(UsageError, match="robot_0 cannot go up from square 0"):
        env.step({"robot_0": UP, "human_0": WAIT})
    with pytest.raises(UsageError, match=r"observation 'all'.*\n.*first 'dog'"):
        tandem.envs.parallel_env("grid", ROOM, observation="all", first="dog")


def test_who_is_shut_in_does_not_idle():
    """A robot with nowhere to go waits for nothing; one that could go pays for waiting."""
    shut, free = (grid(layout(drawn)) for drawn in ("RH.G\n##.W", "R.HG\n##.W"))
    paid = [
        step(data, PAID, reset(data), np.array([WAIT, WAIT]))[1][0].item() for data in (shut, free)
    ]
    assert paid == [pytest.approx(-0.1), pytest.approx(-0.3)]
