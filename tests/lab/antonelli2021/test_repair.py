"""Parts that sit wrongly and are taken off again: values by hand, rules that always hold, and what
a cell may not have.
"""

from __future__ import annotations

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from tests.lab.conftest import THESIS, cell_of

import tandem
import tandem.envs
from tandem.errors import CellError, UsageError
from tandem.files.generators import layered
from tandem.lab.antonelli2021 import ABSENT, RIGHT, WRONG, Slips, product, repair
from tandem.lab.antonelli2021.markov import reaching_states, sure_states, value_iteration
from tandem.lab.antonelli2021.world import legal, operation_words

ONE = cell_of({"lid": ({"robot": 10}, 0, [])})
TWO = cell_of({"base": ({"robot": 10}, 0, []), "lid": ({"robot": 10}, 0, ["base"])})
TOWER = cell_of(
    {
        "base": ({"robot": 4, "human": 6}, 0, []),
        "body": ({"human": 8}, 0, ["base"]),
        "lid": ({"robot": 2}, 0, ["body"]),
    }
)


@pytest.mark.parametrize("p", [0.0, 0.1, 0.5, 0.9])
def test_one_part_costs_what_a_person_can_work_out(p):
    """Mounting takes 10 s and goes wrong with p; taking off takes 5 s: V = 10 + p (5 + V)."""
    world = repair(ONE)
    assert sorted(world.nodes) == [(ABSENT,), (RIGHT,), (WRONG,)]
    assert value_iteration(world.process(p)).values[0] == pytest.approx(
        (10 + 5 * p) / (1 - p), rel=1e-7
    )


def test_the_slips_of_a_state_are_the_ones_that_are_possible():
    """Base right, lid absent, the lid is asked for: it can sit wrongly, or the base can be taken
    off. Out of order there is nothing left.
    """
    world = repair(TWO)
    state = world.numbers[RIGHT, ABSENT]
    process = world.process(0.2)
    comes = {
        world.nodes[after]: (round(chance, 9), seconds)
        for after, chance, seconds in zip(
            process.after[state, 1], process.chance[state, 1], process.cost[state, 1], strict=True
        )
        if chance
    }
    assert comes == {
        (RIGHT, RIGHT): (0.8, 10),
        (RIGHT, WRONG): (0.1, 10),
        (ABSENT, ABSENT): (0.1, 5),
    }
    start = world.process(0.2)
    # wrong order: the lid before the base
    assert world.nodes[start.after[0, 0, 2]] == (ABSENT, WRONG)


def test_a_part_in_the_way_must_be_taken_off_first():
    made = product(TOWER)
    assert made.mount == (4, 8, 2)
    assert made.unmount == (2, 4, 1)
    # the lid sits on the base too, though the cell does not say so
    assert made.below == (frozenset(), {0}, {0, 1})
    assert [
        operation_words(made, operation) for operation in legal(made, (ABSENT, ABSENT, WRONG))
    ] == ["take off lid"]
    assert [
        operation_words(made, operation) for operation in legal(made, (WRONG, ABSENT, ABSENT))
    ] == ["take off base"]
    assert [
        operation_words(made, operation) for operation in legal(made, (RIGHT, RIGHT, WRONG))
    ] == ["take off lid"]


def test_a_precedence_that_says_more_than_it_must_changes_nothing():
    more = cell_of(
        {
            "base": ({"robot": 4, "human": 6}, 0, []),
            "body": ({"human": 8}, 0, ["base"]),
            "lid": ({"robot": 2}, 0, ["body", "base"]),
        }
    )
    first, again = repair(TOWER).halfway, repair(more).halfway
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))


@pytest.mark.parametrize(
    "cell",
    [TOWER, cell_of(THESIS), *(layered(6, seed=seed) for seed in range(4))],
    ids=lambda cell: cell.name or len(cell.tasks),
)
def test_from_every_reachable_state_the_goal_is_reached(cell):
    world = repair(cell)
    made = world.product
    for node in world.nodes:
        for part, sits in enumerate(node):
            assert sits != RIGHT or all(node[other] == RIGHT for other in made.below[part])
        assert set(node) == {RIGHT} or legal(made, node)
    assert world.wrong.sum() > 0
    process = world.process(0.3)
    assert np.allclose(process.chance.sum(2)[process.legal], 1)
    assert reaching_states(process).all()
    exact = value_iteration(process)
    assert reaching_states(process, exact.policy).all()
    assert sure_states(process, exact.policy).all()


def test_without_slips_it_takes_the_sum_of_the_quickest_ways():
    world = repair(cell_of(THESIS))
    assert value_iteration(world.process(0.0)).values[0] == 9 + 7 + 10 + 2 + 2 + 3 + 2
    assert [value_iteration(world.process(p)).values[0] for p in (0.0, 0.1, 0.3)] == sorted(
        value_iteration(world.process(p)).values[0] for p in (0, 0.1, 0.3)
    )


def test_a_human_who_never_slips_so_brings_no_such_state_about():
    careful = repair(TWO, Slips(wrong_part=1, wrong_order=0, undo=0))
    assert (ABSENT, WRONG) not in careful.numbers
    assert (RIGHT, WRONG) in careful.numbers
    steady = repair(TWO, Slips(0, 0, 0))
    assert not steady.wrong.any()
    assert value_iteration(steady.process(1.0)).values[0] == 20


def test_a_quicker_way_of_taking_off_counts():
    assert value_iteration(repair(ONE, unmount_share=0.1).process(0.5)).values[0] == pytest.approx(
        (10 + 0.5) / 0.5, rel=1e-7
    )


@pytest.mark.parametrize(
    ("more", "names"),
    [
        ({"operators": {"robot": {"kind": "robot", "breaks": [[1, 2]]}}}, "breaks"),
        (
            {
                "operators": {
                    "robot": {"kind": "robot"},
                    "human": {"kind": "human", "stress_limit": 3},
                }
            },
            "stress limit",
        ),
        ({"tasks": {"a": {"time": {"robot": 3}, "release": 4}}}, "release"),
        ({"tasks": {"a": {"time": {"robot": 3}, "deadline": 4}}}, "deadline"),
        (
            {
                "tasks": {
                    "a": {"time": {"robot": 3}},
                    "b": {"time": {"robot": 3}, "wait": {"after": "a", "at_least": 4}},
                }
            },
            "wait",
        ),
        ({"tasks": {"a": {"time": {"robot": 3}, "tool": "driver"}}}, "tool"),
        (
            {
                "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
                "tasks": {
                    "a": {
                        "together": [
                            {
                                "operators": ["robot", "human"],
                                "time": 3,
                                "tool": {"robot": "driver"},
                            }
                        ]
                    }
                },
            },
            "tool",
        ),
        ({"tasks": {"a": {"time": {"robot": 3}, "place": "bench"}}}, "place"),
        ({"places": {"bench": [0, 0]}}, "places"),
        (
            {
                "tasks": {
                    "a": {"time": {"robot": 3}, "place": "bench"},
                    "b": {"time": {"robot": 3}, "place": "press"},
                },
                "walk": {"robot": {"bench-press": 3}},
            },
            "walk",
        ),
        (
            {
                "tasks": {"a": {"time": {"robot": 3}}, "b": {"time": {"robot": 3}}},
                "same_operator": [["a", "b"]],
            },
            "same operator",
        ),
        (
            {
                "operators": {"human": {"kind": "human"}},
                "tasks": {"a": {"time": {"human": 3}}},
                "stress_of_set": {"a": 1},
            },
            "stress of set",
        ),
        (
            {
                "operators": {"robot": {"kind": "machine", "holds": [["a", "b"]]}},
                "tasks": {
                    "a": {"time": {"robot": 3}},
                    "b": {"time": {"robot": 3}, "after": ["a"]},
                },
            },
            "holds",
        ),
        ({"zones": {"jig": {"apart": ["human", "robot"]}}}, "zone that keeps kinds apart"),
    ],
)
def test_what_it_cannot_express_is_refused_by_name(more, names):
    with pytest.raises(CellError, match=f"knows no {names}"):
        repair(
            tandem.load(
                {
                    "operators": {"robot": {"kind": "robot"}},
                    "tasks": {"a": {"time": {"robot": 3}}},
                    **more,
                }
            )
        )


def test_everything_that_does_not_fit_is_said_at_once():
    with pytest.raises(CellError) as caught:
        repair(
            tandem.load(
                {
                    "operators": {"robot": {"kind": "robot"}},
                    "tasks": {
                        "a": {"time": {"robot": 3}, "tool": "driver", "release": 1, "deadline": 9}
                    },
                }
            )
        )
    assert len(caught.value.faults) == 3


def test_what_makes_no_difference_one_at_a_time_is_let_through():
    cell = tandem.load({
        "operators": {"r": {"kind": "robot"}, "h": {"kind": "human"}, "i": {"kind": "human"}},
        "tasks": {"a": {"time": {"r": 3, "h": 2, "i": 4}, "zone": "table", "stress": 3},
        "b": {"together": [{"operators": ["r", "h"], "time": 5}]}},
    })  # fmt: skip
    assert value_iteration(repair(cell).process(0.0)).values[0] == 7


def test_too_many_parts_and_numbers_that_are_none_are_refused():
    with pytest.raises(CellError, match="too many for a table"):
        repair(cell_of({str(number): ({"robot": 1 + number}, 0, []) for number in range(12)}))
    with pytest.raises(UsageError, match="between 0 and 1"):
        repair(ONE).process(1.2)
    with pytest.raises(UsageError, match="above 0"):
        repair(ONE, unmount_share=0)
    with pytest.raises(UsageError, match="0 or more"):
        Slips(wrong_part=-1)


def test_gymnasiums_own_checker_is_green():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make("tandem/Repair-v0", cell=TWO, p=0.3, render_mode="ansi").unwrapped)


def test_following_the_exact_policy_in_gymnasium_costs_its_value_on_average():
    env = gymnasium.make("tandem/Repair-v0", cell=TWO, p=0.2).unwrapped
    exact = value_iteration(env.process)
    returns, slipped = [], 0
    for seed in range(400):
        env.reset(seed=seed)
        total, over = 0.0, False
        while not over:
            _, reward, over, truncated, info = env.step(int(exact.policy[env.state]))
            total, slipped = total + reward, slipped + info["deviated"]
            assert not truncated
        returns.append(-total)
    assert abs(np.mean(returns) - exact.values[0]) < 4 * np.std(returns) / len(returns) ** 0.5
    assert slipped > 0


def test_an_illegal_operation_changes_nothing_costs_the_longest_time_and_is_refused_when_strict():
    env = gymnasium.make("tandem/Repair-v0", cell=TWO, p=0.0, render_mode="ansi").unwrapped
    env.reset(seed=0)
    seen, reward, done, truncated, info = env.step(1)
    assert (reward, done, truncated, env.state) == (-10.0, False, False, 0)
    assert env.render() == "base absent, lid absent"
    assert info["illegal"]
    assert info["action_mask"].tolist() == seen["action_mask"].tolist() == [1, 0, 0, 0]
    strict = gymnasium.make("tandem/Repair-v0", cell=TWO, strict=True).unwrapped
    strict.reset(seed=0)
    with pytest.raises(UsageError, match="mount lid is not possible now; legal are 0"):
        strict.step(1)
    wrong = env.world.numbers[RIGHT, WRONG]
    assert env.reset(options={"state": wrong})[0]["observation"].tolist() == [1, 0, 0, 1]
    with pytest.raises(UsageError, match="has the states 0 to"):
        env.reset(options={"state": 99})
