"""What the thesis's encoding holds, and what it refuses with which words."""

from __future__ import annotations

import numpy as np
import pytest
from tests.lab.conftest import cell_of

from tandem.cell.model import Cell
from tandem.errors import CellError, UsageError
from tandem.lab.kinat2023 import REWARDS, reward_set, station, whole_ticks


def test_the_thesis_cell_is_the_thesis_arrays(thesis):
    data = station(thesis)
    np.testing.assert_array_equal(data.time, [[9, 7, 0, 2, 4, 10, 2], [10, 8, 10, 0, 2, 3, 4]])
    np.testing.assert_array_equal(data.stress, [10, 11, 2, 0, 4, 1, 5])
    assert {(i + 1, j + 1) for i, j in np.argwhere(data.needs)} == (
        {(4, 1), (4, 2), (5, 3), (6, 1), (6, 2), (6, 4)} | {(7, task) for task in range(1, 7)}
    )


def test_the_robot_is_row_0_whatever_the_cell_lists_first():
    cell = Cell.model_validate(
        {
            "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
            "tasks": {"press": {"time": {"anna": 3.0, "cobot": 5.0}}},
        }
    )
    assert station(cell).time.tolist() == [[5], [3]]


def test_stress_per_human_is_that_of_the_one_human():
    cell = Cell.model_validate(
        {
            "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
            "tasks": {"press": {"time": {"anna": 3.0}, "stress": {"anna": 2.5}}},
        }
    )
    assert station(cell).stress.tolist() == [2.5]


def test_a_task_of_one_second_is_refused_for_either_agent():
    with pytest.raises(
        CellError, match=r"tasks\.a\.time\.robot: 1 s is one tick.*vanish.*per_second=2"
    ):
        station(cell_of({"a": ({"robot": 1, "human": 4}, 0, [])}))


def test_a_time_that_is_no_whole_second_is_refused_with_the_scale_that_fits():
    cell = cell_of({"a": ({"robot": 2.5}, 0, []), "b": ({"human": 0.2}, 0, [])})
    with pytest.raises(CellError, match=r"2\.5 ticks.*per_second=10 every") as refused:
        station(cell)
    assert len(refused.value.faults) == 2
    assert station(cell, per_second=10).time.tolist() == [[25, 0], [0, 2]]


@pytest.mark.parametrize(
    ("times", "expected"),
    [((2, 7), 1), ((1,), 2), ((0.5,), 10), ((0.4,), 5), ((2.5,), 2), ((0.372, 1.1), 500)],
)
def test_whole_ticks_is_the_fewest(times, expected):
    cell = cell_of({f"t{i}": ({"robot": time}, 0, []) for i, time in enumerate(times)})
    assert whole_ticks(cell) == expected
    station(cell, per_second=expected)


def test_a_time_beyond_the_worlds_count_is_refused():
    with pytest.raises(CellError, match="counts to 30000"):
        station(cell_of({"a": ({"robot": 40_000}, 0, [])}))


def test_other_teams_are_refused():
    operators = {
        "robot": {"kind": "robot"},
        "human": {"kind": "human"},
        "second": {"kind": "human"},
    }
    with pytest.raises(CellError, match="1 robot and 2 humans"):
        station(cell_of({"a": ({"robot": 2}, 0, [])}).replace(operators=operators))
    operators["second"]["kind"] = "machine"
    with pytest.raises(CellError, match="1 robot, 1 human and 1 machine; the thesis's world has"):
        station(cell_of({"a": ({"robot": 2}, 0, [])}).replace(operators=operators))
    with pytest.raises(CellError, match="0 robots and 1 human;"):
        station(
            Cell.model_validate(
                {
                    "operators": {"human": {"kind": "human"}},
                    "tasks": {"a": {"time": {"human": 2.0}}},
                }
            )
        )


TASK = {"time": {"robot": 2.0, "human": 2.0}}
BEYOND = {
    "tasks.a.together": {
        "tasks": {"a": {**TASK, "together": [{"operators": ["robot", "human"], "time": 2.0}]}}
    },
    "tasks.a.tool": {"tasks": {"a": {**TASK, "tool": "wrench"}}},
    "tasks.a.zone": {"tasks": {"a": {**TASK, "zone": "bench"}}},
    "tasks.a.release": {"tasks": {"a": {**TASK, "release": 3.0}}},
    "tasks.a.deadline": {"tasks": {"a": {**TASK, "deadline": 30.0}}},
    "tasks.a.wait": {"tasks": {"a": {**TASK, "wait": {"after": "b"}}, "b": TASK}},
    "operators.human.breaks": {
        "operators": {
            "robot": {"kind": "robot"},
            "human": {"kind": "human", "breaks": [[5.0, 6.0]]},
        }
    },
    "operators.robot.setup": {
        "operators": {"robot": {"kind": "robot", "setup": 4.0}, "human": {"kind": "human"}}
    },
    "operators.human.stress_limit": {
        "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human", "stress_limit": 5.0}}
    },
    "same_operator": {"same_operator": [["a", "b"]], "tasks": {"a": TASK, "b": TASK}},
    "stress_of_set": {"stress_of_set": {"": 0.0, "a": 2.0}},
}


@pytest.mark.parametrize("path", BEYOND)
def test_what_the_world_does_not_know_is_refused_by_name(path):
    base = {
        "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
        "tasks": {"a": TASK},
    }
    with pytest.raises(CellError, match=f"^- {path}: the thesis's world knows no") as refused:
        station(Cell.model_validate({**base, **BEYOND[path]}))
    assert len(refused.value.faults) == 1


def test_a_task_that_nobody_can_do_alone_is_refused():
    joint = {"time": {}, "together": [{"operators": ["robot", "human"], "time": 2.0}]}
    cell = Cell.model_validate(
        {
            "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
            "tasks": {"a": joint},
        }
    )
    with pytest.raises(CellError, match=r"nobody can do it alone.*counts as done from the start"):
        station(cell)


@pytest.mark.parametrize("per_second", [0, -1, 2.5, True, "2"])
def test_ticks_per_second_are_a_whole_number(per_second):
    with pytest.raises(UsageError, match="whole number from 1"):
        station(cell_of({"a": ({"robot": 2}, 0, [])}), per_second=per_second)


def test_reward_sets_are_the_thesis_s():
    assert REWARDS["appendix"]._asdict() == {
        "step": -10,
        "task_done": 0,
        "illegal": -10,
        "idle": -10,
        "all_done": 50,
        "stress_factor": 0,
    }
    assert REWARDS["table_5_2"]._asdict() == {
        "step": -1,
        "task_done": 1,
        "illegal": -10,
        "idle": -11,
        "all_done": 50,
        "stress_factor": 0,
    }


def test_only_stage_1_punishes_idling():
    assert reward_set("table_5_2", stage=1).idle == -11
    assert reward_set("table_5_2", stress_factor=5).idle == 0
    assert reward_set("table_5_2", stress_factor=5).stress_factor == 5


def test_an_unknown_reward_set_is_met_with_the_nearest():
    with pytest.raises(UsageError, match="Did you mean 'appendix'"):
        reward_set("apendix")
