"""Finite processes: values by hand, by another method and by trying every policy; what is reached,
and what is refused.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tandem.errors import NothingFoundError
from tandem.lab.antonelli2021.markov import (
    Outcome,
    Process,
    explore,
    policy_values,
    reaching_states,
    sure_states,
    value_iteration,
)


def made(options, actions=2, limit=100):
    """A process whose start is 0 and whose goal is "end"."""
    return explore(
        0, lambda node: options[node], lambda node: node == "end", actions=actions, limit=limit
    )


def retry(chance):
    """One state, one action that succeeds with this chance and costs 3 s."""
    return made({0: {0: [Outcome("end", chance, 3.0), Outcome(0, 1 - chance, 3.0)]}}, actions=1)[0]


@pytest.mark.parametrize("chance", [1.0, 0.5, 0.1])
def test_trying_until_it_works_costs_the_cost_over_the_chance(chance):
    found = value_iteration(retry(chance))
    assert found.values[0] == pytest.approx(3 / chance, rel=1e-8)
    assert policy_values(retry(chance), found.policy)[0] == pytest.approx(3 / chance, rel=1e-12)


def test_the_stated_error_holds_when_it_is_large():
    """Stopped early, a value lies below the truth, and not further than was said."""
    process = retry(0.1)
    for error in (0.5, 0.1, 0.01):
        found = value_iteration(process, error=error)
        assert (1 - found.error) * 30 <= found.values[0] <= 30
        assert found.error <= error


def test_a_detour_is_taken_when_it_is_cheaper():
    options = {
        0: {0: [Outcome("end", 1.0, 10.0)], 1: [Outcome("side", 1.0, 4.0)]},
        "side": {0: [Outcome("end", 1.0, 5.0)]},
    }
    process, nodes = made(options)
    found = value_iteration(process)
    assert dict(zip(nodes, found.values, strict=True)) == {0: 9.0, "end": 0.0, "side": 5.0}
    assert found.policy[0] == 1


def test_a_policy_that_may_go_on_for_ever_costs_without_end():
    options = {
        0: {0: [Outcome("end", 0.5, 1.0), Outcome("loop", 0.5, 1.0)]},
        "loop": {0: [Outcome("loop", 1.0, 1.0)], 1: [Outcome("end", 1.0, 1.0)]},
    }
    process, nodes = made(options)
    stays, leaves = np.array([0, 0, 0]), np.array([0, 0, 1])
    assert nodes == [0, "end", "loop"]
    assert policy_values(process, stays).tolist() == [np.inf, 0.0, np.inf]
    assert policy_values(process, leaves).tolist() == [1.5, 0.0, 1.0]
    assert sure_states(process, stays).tolist() == [False, True, False]
    # as asked, the first outcome leads to the end
    assert reaching_states(process, stays).tolist() == [True, True, False]
    assert reaching_states(process).all()


def test_a_goal_out_of_reach_is_said_at_once():
    process, _ = made(
        {
            0: {0: [Outcome("pit", 1.0, 1.0), Outcome("end", 0.0, 1.0)]},
            "pit": {0: [Outcome("pit", 1.0, 1.0)]},
        }
    )
    with pytest.raises(NothingFoundError, match="no goal can be reached"):
        value_iteration(process)


def test_outcomes_without_chance_are_numbered_too_and_too_many_states_are_refused():
    process, nodes = made(
        {
            0: {0: [Outcome("end", 1.0, 1.0), Outcome("rare", 0.0, 1.0)]},
            "rare": {1: [Outcome("end", 1.0, 1.0)]},
        }
    )
    assert nodes == [0, "end", "rare"]
    assert process.legal.tolist() == [[True, False], [False, False], [False, True]]
    with pytest.raises(NothingFoundError, match="more than 50 states"):
        explore(
            0,
            lambda node: {0: [Outcome(node + 1, 1.0, 1.0)]},
            lambda node: node < 0,
            actions=1,
            limit=50,
        )


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_no_policy_is_better_than_the_exact_one(seed):
    """All policies of small random processes, each valued by linear equations."""
    random = np.random.default_rng(seed)
    states, actions = 4, 2
    after = random.integers(states, size=(states, actions, 3)).astype(np.int32)
    after[:, 0, 0] = states - 1  # the goal can always be reached
    chance = random.dirichlet(np.ones(3), size=(states, actions))
    goal = np.arange(states) == states - 1
    process = Process(
        after,
        chance,
        random.uniform(1, 9, after.shape),
        ~goal[:, None] & np.ones(actions, bool),
        goal,
    )
    found = value_iteration(process, error=1e-11)
    every = [
        policy_values(process, np.array([*choice, 0]))
        for choice in product(range(actions), repeat=states - 1)
    ]
    assert np.min(every, axis=0) == pytest.approx(found.values, rel=1e-7)
    assert policy_values(process, found.policy) == pytest.approx(found.values, rel=1e-7)
