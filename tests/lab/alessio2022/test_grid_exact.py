"""The exact values of grids: worked out by hand, by a second method, and against what happens when
games are played.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tandem.errors import NothingFoundError
from tandem.lab.alessio2022 import (
    exact,
    grid,
    layout,
    legal,
    random_layout,
    reset,
    robots,
    step,
    tables,
)
from tandem.lab.alessio2022.exact import Place
from tandem.lab.alessio2022.world import (
    HUMAN,
    NOWHERE,
    REACHED_RIGHT,
    ROBOT,
    WAIT,
    Rewards,
    is_over,
)

RACE = "R.G\n###\nH.W"
"""The robot moves first and needs two moves, as the human does."""
LOST = "R..G\n####\nH.W."
GUARDED = "R.G\n.##\nH.W"
FREE = Rewards(0.0, 0.0, 0.0, 0.0, 0.0)


def test_a_race_is_won_by_who_is_nearer_and_the_robot_moves_first():
    assert exact.minimax(layout(RACE)).moves == 3
    assert not exact.minimax(layout(LOST)).success
    assert not exact.minimax(layout(RACE), first=HUMAN).success


def test_on_the_built_in_grids_the_quickest_way_loses_and_another_one_is_safe():
    """The story of the publication: the wrong terminal state is blocked, the right one is reached,
    at the price of a longer way.
    """
    for name, moves, quick in (("crossing", 23, 15), ("crossing-12", 43, 27)):
        drawn = layout(name)
        best = exact.minimax(drawn)
        assert best.moves == moves
        assert drawn.text[best.line[-1][ROBOT]] == "G"
        robot = robots.quickest(drawn)
        idle, reached = robots.game(drawn, robot, robots.waits)
        assert (len(idle) - 1, reached) == (quick, True)
        worst = exact.worst_case(drawn, robot)
        assert not worst.success
        assert drawn.text[worst.line[-1][HUMAN]] == "W"


def brute(data, state) -> bool:
    """Whether the robot can be sure of success, by the rules of `world.py` themselves, every game
    played.
    """
    mover = int(state.turn)
    results = []
    for action in np.flatnonzero(legal(data, state)[mover]):
        after, _, over, _ = step(data, FREE, state, np.array([action, action]))
        results.append(int(after.reached) == REACHED_RIGHT if over else brute(data, after))
    return any(results) if mover == ROBOT else all(results)


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 6, 7, 8, 9, 10])
def test_searching_places_and_playing_the_rules_give_the_same_value(seed):
    drawn = random_layout(seed, size=4, obstacles=0.45, wrong=1)
    assert exact.minimax(drawn).success == brute(grid(drawn), reset(grid(drawn)))


def expected(data, state) -> float:
    """The most that can be reached beside a random human, by the rules themselves."""
    mover = int(state.turn)
    values = []
    for action in np.flatnonzero(legal(data, state)[mover]):
        after, _, over, _ = step(data, FREE, state, np.array([action, action]))
        values.append(float(int(after.reached) == REACHED_RIGHT) if over else expected(data, after))
    return max(values) if mover == ROBOT else sum(values) / len(values)


@pytest.mark.parametrize("seed", range(4))
def test_the_value_beside_a_random_human_agrees_too(seed):
    drawn = random_layout(seed, size=4, obstacles=0.45, wrong=1)
    assert exact.chance_value(drawn) == pytest.approx(expected(grid(drawn), reset(grid(drawn))))


def test_the_worst_human_is_as_bad_as_the_worst_that_can_be_played():
    """The exact worst case of a given robot against every human there is, played by the rules."""
    drawn = random_layout(5, size=4, obstacles=0.4, wrong=1)
    data, robot = grid(drawn), robots.quickest(drawn)

    def worst(state, history):
        if int(state.turn) == ROBOT:
            closed = sum(1 << int(place) for place in np.flatnonzero(state.path.any(0)))
            actions = [
                robot(Place(closed, *map(int, state.position), ROBOT, bool(state.waited)), history)
            ]
        else:
            actions = np.flatnonzero(legal(data, state)[HUMAN])
        results = []
        for action in actions:
            after, _, over, _ = step(data, FREE, state, np.array([action, action]))
            results.append(
                int(after.reached) == REACHED_RIGHT
                if over
                else worst(after, (*history, tuple(map(int, after.position))))
            )
        return all(results)

    start = reset(data)
    assert exact.worst_case(drawn, robot).success == worst(
        start, (tuple(map(int, start.position)),)
    )


def test_a_state_rebuilt_from_its_history_is_the_state_that_was_played():
    drawn = layout("crossing")
    data, state, generator = grid(drawn), reset(grid(drawn)), np.random.default_rng(3)
    history = (tuple(map(int, state.position)),)
    while not is_over(data, state):
        closed = sum(1 << int(place) for place in np.flatnonzero(state.path.any(0)))
        place = Place(closed, *map(int, state.position), int(state.turn), bool(state.waited))
        rebuilt = robots.as_state(len(drawn.text), place, history)
        assert all(
            np.array_equal(ours, theirs) for ours, theirs in zip(rebuilt, state, strict=True)
        )
        action = generator.choice(np.flatnonzero(legal(data, state)[state.turn]))
        state, *_ = step(data, FREE, state, np.array([action, action]))
        history = (*history, tuple(map(int, state.position)))


def test_a_grid_that_is_too_large_is_said_to_be_so():
    with pytest.raises(NothingFoundError, match="more than 50 states"):
        exact.minimax(layout("crossing"), limit=50)


# --- Open paths ---


def open_brute(data):
    """The minimax value of a grid with open paths by plain recursion over positions, turn and
    clock.
    """

    @cache
    def value(robot, human, turn, clock):
        if clock == int(data.limit):
            return False
        here, other = (robot, human) if turn == ROBOT else (human, robot)
        results = []
        for action, there in enumerate(data.neighbour[here]):
            if there >= 0 and (there != other or action == WAIT):
                kind = int(data.kind[there])
                pair = (int(there), human) if turn == ROBOT else (robot, int(there))
                results.append(
                    kind == REACHED_RIGHT if kind != NOWHERE else value(*pair, 1 - turn, clock + 1)
                )
        return any(results) if turn == ROBOT else all(results)

    return value(*map(int, data.start), int(data.first), 0)


@pytest.mark.parametrize("seed", range(10))
def test_tables_and_recursion_agree_on_open_paths(seed):
    data = grid(random_layout(seed, size=4, obstacles=0.3, wrong=1), closing=False, limit=14)
    found = tables.minimax(data)
    assert found.success == open_brute(data)
    assert (found.bound(data) is not None) == found.success


def test_with_open_paths_a_human_that_stands_in_the_only_way_bars_it_for_ever():
    """Why paths close by default: here nobody can be passed, and a human that waits in front of the
    goal is never punished for it.
    """
    drawn = layout("R.H.G\n#####")
    assert not tables.minimax(grid(drawn, closing=False, limit=40)).success
    assert (
        tables.value(grid(drawn, closing=False, limit=40), tables.best, tables.by_chance).success
        > 0.9
    )


def test_a_policy_is_worth_between_the_minimax_value_and_the_best_beside_the_same_human():
    data = grid(random_layout(2, size=5), closing=False, limit=30)
    quick = tables.following(tables.quickest(data))
    assert tables.value(data, quick, tables.worst).success <= tables.minimax(data).success
    assert (
        tables.value(data, quick, tables.by_chance).success
        <= tables.value(data, tables.best, tables.by_chance).success + 1e-12
    )
