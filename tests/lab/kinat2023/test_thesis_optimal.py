"""What is optimal under the rewards: the table that explains the thesis's results, and a second
method that confirms it.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from tests.lab.conftest import cell_of, random_cell

from tandem.errors import CellError, NothingFoundError, UsageError
from tandem.lab.kinat2023 import Rewards, reset, reward_set, station, step
from tandem.lab.kinat2023.episode import follow, play
from tandem.lab.kinat2023.optimal import return_optimal

TABLE = [
    # rewards, stage, ergonomic factor, return-optimal (makespan, stress)
    ("appendix", 2, 0, [(23, 7), (23, 17)]),
    ("appendix", 2, 1, [(23, 7)]),
    ("appendix", 2, 5, [(24, 3)]),
    ("appendix", 1, 0, [(23, 17)]),
    ("table_5_2", 2, 0, [(23, 7), (23, 17)]),
    ("table_5_2", 2, 1, [(24, 3)]),
    ("table_5_2", 2, 5, [(24, 3)]),
]


@pytest.mark.parametrize(("name", "stage", "factor", "pairs"), TABLE)
def test_the_return_optimal_pairs_of_the_thesis(thesis, name, stage, factor, pairs):
    assert (
        return_optimal(thesis, reward_set(name, stress_factor=factor, stage=stage)).pairs == pairs
    )


@pytest.mark.parametrize(("name", "step_paid"), [("appendix", 10), ("table_5_2", 1)])
def test_where_the_optimum_changes(thesis, name, step_paid):
    """(23, 7) gives way to (24, 3) at a factor of |step| / 4, and (24, 3) to (34, 2) at 10 |step|;
    both tie in between.
    """

    def pairs(factor):
        return return_optimal(thesis, reward_set(name, stress_factor=factor)).pairs

    assert pairs(step_paid / 4) == [(23, 7), (24, 3)]
    assert pairs(step_paid * 10) == [(24, 3), (34, 2)]
    assert pairs(step_paid * 10 + 1) == [(34, 2)]


@pytest.mark.parametrize("factor", [0, 1, 5])
def test_with_table_5_2_and_its_idle_penalty_the_best_policies_break_rules_on_purpose(
    thesis, factor
):
    """An illegal action costs 10, idling 11: who has nothing to do names a task that is not
    allowed.
    """
    optimum = return_optimal(thesis, reward_set("table_5_2", stress_factor=factor, stage=1))
    assert min(way.illegal for way in optimum.ways) > 0


def test_without_an_idle_penalty_no_optimal_policy_needs_an_illegal_action(thesis):
    assert all(
        way.illegal == 0
        for way in return_optimal(thesis, reward_set("appendix", stress_factor=5.0)).ways
    )


@pytest.mark.parametrize("stage", [1, 2])
@pytest.mark.parametrize("name", ["appendix", "table_5_2"])
@pytest.mark.parametrize("factor", [0, 1, 5])
def test_the_world_pays_what_dynamic_programming_promises(thesis, name, stage, factor):
    paid = reward_set(name, stress_factor=factor, stage=stage)
    optimum = return_optimal(thesis, paid)
    for way, actions in optimum.actions.items():
        episode = play(thesis, paid, follow(actions), by="ticks")
        assert (episode.ticks, episode.stress, episode.illegal, episode.done) == (
            way.makespan,
            way.stress,
            way.illegal,
            True,
        )
        assert sum(episode.returns) == optimum.value


def largest_return(cell, paid):
    """The value of the first state by trying every joint action in `world.step`, down to the end;
    loops that change nothing left out.
    """
    data, known = station(cell), {}
    actions = [np.array(pair) for pair in product(range(len(cell.tasks) + 1), repeat=2)]

    def value(state):
        key = (state.time.tobytes(), state.doing.tobytes(), state.ended.tobytes())
        if key not in known:
            worth = []
            for action in actions:
                after, reward, done, _ = step(data, paid, state, action)
                if (after.time.tobytes(), after.doing.tobytes(), after.ended.tobytes()) != key:
                    worth.append(float(reward.sum()) + (0.0 if done else value(after)))
            known[key] = max(worth)
        return known[key]

    return value(reset(data))


@pytest.mark.parametrize(
    ("name", "stage", "factor"),
    [("appendix", 2, 1), ("appendix", 1, 5), ("table_5_2", 1, 1), ("table_5_2", 2, 0)],
)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_trying_every_joint_action_in_the_world_finds_the_same_value(seed, name, stage, factor):
    cell, paid = random_cell(seed, 3, 4), reward_set(name, stress_factor=factor, stage=stage)
    assert return_optimal(cell, paid).value == largest_return(cell, paid)


def test_decimals_of_stress_are_exact():
    """Three times 0.1 against 0.3: a tie that floats would miss."""
    tasks = {name: ({"robot": 2, "human": 2}, 0.1, []) for name in "abc"}
    tasks["d"] = ({"robot": 6, "human": 6}, 0.3, [])
    assert (
        return_optimal(cell_of(tasks), reward_set("appendix", stress_factor=1.0)).ways[0].stress
        == 0.3
    )


def test_times_that_are_no_whole_seconds_keep_their_seconds():
    cell = cell_of({"a": ({"robot": 0.5, "human": 0.4}, 1, [])})
    optimum = return_optimal(cell, reward_set("appendix", stress_factor=100.0), per_second=10)
    assert optimum.pairs == [(0.5, 0)]


def test_too_many_states_are_said_so(thesis):
    with pytest.raises(NothingFoundError, match="more than 100 states"):
        return_optimal(thesis, reward_set(), limit=100)


def test_rewards_that_pay_for_doing_nothing_are_refused(thesis):
    with pytest.raises(UsageError, match="pay for doing nothing"):
        return_optimal(
            thesis,
            Rewards(
                step=0.0, task_done=1.0, illegal=-1.0, idle=0.0, all_done=1.0, stress_factor=0.0
            ),
        )


def test_a_cell_that_does_not_fit_is_refused():
    with pytest.raises(CellError, match="one tick"):
        return_optimal(cell_of({"a": ({"robot": 1}, 0, [])}), reward_set())


def test_fines_of_their_own_change_the_optimum_only_where_breaking_a_rule_pays():
    """One fine thrice is three equal fines; with idling at -11 and a fine of -1 for an open
    dependency, naming a blocked task is the cheap way to wait.
    """
    cell = cell_of({"a": ({"robot": 3, "human": 3}, 0, []), "b": ({"human": 2}, 0, ["a"])})
    one = reward_set("table_5_2", stage=1)
    apart = one._replace(illegal=(one.illegal,) * 3)
    assert return_optimal(cell, apart) == return_optimal(cell, one)
    cheap = one._replace(illegal=(-10.0, -1.0, -10.0))
    assert return_optimal(cell, cheap).value > return_optimal(cell, one).value
    assert return_optimal(cell, cheap).ways[0].illegal > 0
