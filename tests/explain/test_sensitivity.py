"""Which task time moves the front most: each effect equals a re-solve of the cell with that time
changed by hand.
"""

from __future__ import annotations

import copy
import multiprocessing

import pytest

from tandem.cell.model import Cell
from tandem.draw.tornado import plot_tornado
from tandem.errors import NothingFoundError, UsageError
from tandem.explain.fronts import area
from tandem.explain.sensitivity import carried_over, nondominated, scaled, sensitivity
from tandem.files.generators import layered
from tandem.plan.methods import METHODS, plan
from tandem.plan.question import Question


def by_hand(cell: Cell, task: str, factor: float) -> list[tuple[float, float]]:
    data = copy.deepcopy(cell.to_dict())
    data["tasks"][task]["time"] = {
        who: round(seconds * factor, 3) for who, seconds in data["tasks"][task]["time"].items()
    }
    return METHODS["exhaustive"](Cell.model_validate(data), Question()).points


def test_every_effect_equals_an_independent_solve(thesis: Cell) -> None:
    told: list[tuple[int, int]] = []
    found = sensitivity(
        thesis, (-0.1,), workers=2, on_done=lambda done, of: told.append((done, of))
    )
    assert {effect.task for effect in found.effects} == set(thesis.tasks)
    base = area(found.front.points, found.corner)
    for effect in found.effects:
        points = by_hand(thesis, effect.task, 0.9)
        assert list(effect.points) == points
        assert effect.proven
        assert effect.seconds == pytest.approx(points[0][0] - 23)
        assert effect.gain == pytest.approx((area(points, found.corner) - base) / base)
    gains = [abs(effect.gain or 0) for effect in found.effects]
    assert gains == sorted(gains, reverse=True)
    assert found.effects[0].task == "1"
    assert told[-1] == (7, 7)


def test_one_time_of_one_operator(thesis: Cell) -> None:
    changed = scaled(thesis, "6", 0.5, ("robot",))
    assert dict(changed.tasks["6"].time) == {"robot": 15.0, "human": 3.0}
    assert scaled(thesis, "6", -0.1).tasks["6"].time["human"] == 2.7


@pytest.mark.parametrize("share", [-1.0, 0.0, 99.0])
def test_shares_that_make_no_sense(thesis: Cell, share: float) -> None:
    with pytest.raises(UsageError, match="must be above"):
        sensitivity(thesis, (share,))


def test_the_tornado_has_a_bar_for_each_effect() -> None:
    rows = [
        ("task 1", {"-10%": 7.5, "+10%": -7.5}),
        ("task 2", {"-10%": 1.0, "+10%": -0.5}),
        ("task 3", {"-10%": 0.0}),
    ]
    ax = plot_tornado(rows, xlabel="change in %", title="What moves the front")
    widths = sorted(patch.get_width() for patch in ax.patches)
    assert widths == [-7.5, -0.5, 0.0, 1.0, 7.5]
    assert [text.get_text() for text in ax.get_yticklabels()] == ["task 1", "task 2", "task 3"]
    assert ax.yaxis_inverted()


def test_a_shorter_time_never_makes_the_front_worse_though_time_is_short() -> None:
    """Of 12 tasks, searched for a fifth of a second each: what the base found holds for the variant
    too.
    """
    cell = layered(12, seed=3)
    found = sensitivity(cell, (-0.1,), time_limit=4.0, workers=1)
    assert [effect.task for effect in found.effects if effect.gain is None or effect.gain < 0] == []


def test_schedules_are_carried_over_to_new_times(thesis: Cell) -> None:
    schedules = [result.schedule for result in plan(thesis)]
    assert carried_over(thesis, schedules) == [(23, 7), (24, 3), (34, 2)]
    assert carried_over(scaled(thesis, "7", 1.0), schedules) == [(25, 7), (26, 3), (36, 2)]


def test_nondominated_points() -> None:
    assert nondominated([(3, 1), (1, 5), (2, 5), (1, 6), (3, 1), (2, 2)]) == [
        (1, 5),
        (2, 2),
        (3, 1),
    ]


def test_a_worker_that_is_killed_is_no_bug_of_ours(thesis: Cell) -> None:
    def killed(done: int, of: int) -> None:
        for child in multiprocessing.active_children():
            child.kill()

    with pytest.raises(NothingFoundError, match=r"ended from outside.* planned.*--workers") as told:
        sensitivity(thesis, (-0.2, -0.1, 0.1, 0.2), each=True, workers=2, on_done=killed)
    assert told.value.exit_code == 5
