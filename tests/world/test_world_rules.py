"""Single rules of the world, in cells that a person can work out."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np
import pytest

from tandem.cell.model import Cell
from tandem.errors import CellError, UnsoundScheduleError, UsageError
from tandem.files.validate import cell_of
from tandem.schedule.model import Assignment, Schedule
from tandem.world.arrays import Arrays, Names
from tandem.world.replay import replay
from tandem.world.state import (
    State,
    advance,
    assign,
    is_stuck,
    legal,
    legal_of,
    may_wait,
    refuse,
    reset,
    starts,
    stress,
    turn,
    wait,
)


def cell(tasks: dict[str, Any], operators: dict[str, Any] | None = None, **more: Any) -> Cell:
    return cell_of(
        {
            "operators": operators or {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
            "tasks": tasks,
            **more,
        }
    )


def at_start(of: Cell) -> tuple[Names, Arrays, State]:
    names = Names.of(of, per_second=1)
    arrays = names.arrays()
    return names, arrays, reset(arrays)


def begun(names: Names, arrays: Arrays, state: State, task: str, *who: str) -> State:
    way = names.way(task, who)
    assert legal(arrays, state)[way]
    return assign(arrays, state, np.int32(way))


def test_the_human_decides_first_and_the_robot_sees_what_is_left() -> None:
    names, arrays, state = at_start(
        cell({"1": {"time": {"robot": 3.0, "human": 4.0}}, "2": {"time": {"robot": 2.0}}})
    )
    assert names.operators[turn(arrays, legal(arrays, state))] == "human"
    state = begun(names, arrays, state, "1", "human")
    assert names.operators[turn(arrays, legal(arrays, state))] == "robot"
    assert [names.ways[way][0] for way in np.flatnonzero(legal(arrays, state))] == ["2"]


def test_all_cannot_wait_when_nothing_else_will_happen() -> None:
    names, arrays, state = at_start(cell({"1": {"time": {"robot": 3.0, "human": 4.0}}}))
    human, robot = names.operators.index("human"), names.operators.index("robot")
    assert may_wait(arrays, state, legal(arrays, state), human), "the robot can begin something"
    state = wait(state, np.int32(human))
    mask = legal(arrays, state)
    assert turn(arrays, mask) == robot
    assert not may_wait(arrays, state, mask, robot)
    state = advance(arrays, begun(names, arrays, state, "1", "robot"))
    assert not state.waits.any(), "an event asks everybody anew"


def test_a_tool_is_taken_up_in_idle_time() -> None:
    """The human ends with the wrench at 2 and waits until 5: of the 4 s of changeover 1 is left;
    had it been idle longer, none.
    """
    tools = {"driver": {"changeover": {"human": 4.0}}, "wrench": {}}
    tasks = {
        "1": {"time": {"human": 2.0}, "tool": "wrench"},
        "2": {"time": {"robot": 5.0}},
        "3": {"time": {"human": 3.0}, "tool": "driver", "after": ["2"]},
    }
    names, arrays, state = at_start(cell(tasks, tools=tools))
    state = begun(names, arrays, begun(names, arrays, state, "1", "human"), "2", "robot")
    state = advance(arrays, advance(arrays, state))
    assert int(state.clock) == 5
    assert starts(arrays, state)[names.way("3", ["human"])] == 6
    state = begun(names, arrays, state, "3", "human")
    assert int(state.end_at[2]) == 9


def test_a_break_is_kept_and_asked_after() -> None:
    operators = {"robot": {"kind": "robot"}, "human": {"kind": "human", "breaks": [[3.0, 5.0]]}}
    _names, arrays, state = at_start(cell({"1": {"time": {"human": 4.0}}}, operators))
    assert not legal(arrays, state).any(), "4 s do not fit before the break"
    state = advance(arrays, state)
    assert int(state.clock) == 5
    assert legal(arrays, state).all()


def test_places_hold_as_many_as_they_do() -> None:
    tasks = {
        str(number): {"time": {"robot": 3.0, "human": 3.0}, "zone": "jig"} for number in (1, 2)
    }
    names, arrays, state = at_start(cell(tasks))
    assert not legal(arrays, begun(names, arrays, state, "1", "robot")).any()
    roomy, arrays, state = at_start(cell(tasks, zones={"jig": {"capacity": 2}}))
    assert legal(arrays, begun(roomy, arrays, state, "1", "robot"))[roomy.way("2", ["human"])]


def test_a_joint_way_needs_all_and_occupies_all() -> None:
    tasks = {
        "1": {"together": [{"operators": ["robot", "human"], "time": 4.0}]},
        "2": {"time": {"robot": 2.0, "human": 2.0}},
    }
    names, arrays, state = at_start(cell(tasks))
    assert not legal(arrays, begun(names, arrays, state, "2", "human"))[
        names.way("1", ["robot", "human"])
    ]
    state = begun(names, arrays, state, "1", "robot", "human")
    assert not legal(arrays, state).any()
    assert state.free_at.tolist() == [4, 4]


def test_a_stress_limit_looks_ahead() -> None:
    """The human must do task 2 (stress 5) in the end, so that task 1 (stress 3) is too much for a
    limit of 7.
    """
    operators = {"robot": {"kind": "robot"}, "human": {"kind": "human", "stress_limit": 7.0}}
    tasks = {
        "1": {"time": {"robot": 3.0, "human": 3.0}, "stress": 3.0},
        "2": {"time": {"human": 3.0}, "stress": 5.0},
    }
    names, arrays, state = at_start(cell(tasks, operators))
    assert [names.ways[way][1].operators for way in np.flatnonzero(legal(arrays, state))] == [
        ("robot",),
        ("human",),
    ]
    assert not legal(arrays, state)[names.way("1", ["human"])]


def test_partners_stay_together() -> None:
    tasks = {
        "1": {"time": {"robot": 3.0, "human": 3.0}},
        "2": {"time": {"robot": 3.0, "human": 3.0}},
        "3": {"time": {"robot": 1.0}},
    }
    names, arrays, state = at_start(cell(tasks, same_operator=[["1", "2"]]))
    state = begun(names, arrays, state, "1", "robot")
    assert not legal(arrays, state)[names.way("2", ["human"])]


def test_a_refusal_takes_the_way_out_and_can_leave_nothing() -> None:
    _names, arrays, state = at_start(cell({"1": {"time": {"human": 3.0}}}))
    state = refuse(arrays, state, np.int32(1), np.int32(0))
    mask = legal(arrays, state)
    assert not mask.any()
    assert is_stuck(arrays, state, mask)


def test_replay_takes_no_unsound_schedule() -> None:
    of = cell({"1": {"time": {"robot": 3.0}}, "2": {"time": {"robot": 3.0}, "after": ["1"]}})
    with pytest.raises(UnsoundScheduleError, match="before task '1' has ended"):
        replay(
            of,
            Schedule(
                (Assignment(0.0, 3.0, "1", ("robot",)), Assignment(2.0, 5.0, "2", ("robot",)))
            ),
        )


def test_times_that_do_not_fit_are_refused() -> None:
    of = cell({"1": {"time": {"robot": 0.25}}})
    with pytest.raises(UsageError, match=r"per_second is 10: .* 1/100 s"):
        Names.of(of, per_second=10)
    with pytest.raises(CellError, match="more ticks than the simulation can count"):
        Names.of(cell({"1": {"time": {"robot": 9_000_000.25}}}))
    with pytest.raises(UsageError, match="undo is 0"):
        Names.of(of).arrays(undo=0)


def test_legal_of_is_the_operators_share() -> None:
    names, arrays, state = at_start(
        cell({"1": {"time": {"robot": 3.0, "human": 4.0}}, "2": {"time": {"robot": 2.0}}})
    )
    mine = legal_of(arrays, legal(arrays, state), np.int32(names.operators.index("robot")))
    assert [names.ways[way][0] for way in np.flatnonzero(mine)] == ["1", "2"]


def test_stress_by_set_is_kept_under_jit_as_in_numpy() -> None:
    """Listed are the sets {1} and {1, 2}: task 1 is the human's, and a robot that has taken task 2
    leaves only {1}.
    """
    tasks = {
        "1": {"time": {"robot": 3.0, "human": 3.0}},
        "2": {"time": {"robot": 3.0, "human": 3.0}},
    }
    names, arrays, state = at_start(cell(tasks, stress_of_set={"1": 2.0, "1,2": 5.0}))
    jitted = jax.jit(lambda state: (legal(arrays, state), stress(arrays, state)))
    by_robot, by_human = (begun(names, arrays, state, "2", who) for who in ("robot", "human"))
    for which, ways, least in (
        (state, ["1", "2", "2"], 2),
        (by_robot, ["1"], 2),
        (by_human, [], 5),
    ):
        mask, units = jitted(which)
        np.testing.assert_array_equal(mask, legal(arrays, which))
        assert [names.ways[way][0] for way in np.flatnonzero(mask)] == ways
        assert int(units) == int(stress(arrays, which)) == least
