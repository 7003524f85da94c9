"""Which point is recommended by what is known, and when that is certain."""

from __future__ import annotations

from itertools import pairwise
from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tandem.files.generators import layered
from tandem.plan.archive import dominated_area
from tandem.plan.knee import knee_index, recommended
from tandem.plan.methods import plan
from tandem.plan.result import Front

TRUE = [(10.0, 20.0), (12.0, 12.0), (14.0, 9.0), (22.0, 6.0), (30.0, 2.0)]


def test_of_a_complete_front_it_is_the_knee_of_das():
    assert TRUE[knee_index(TRUE)] == (14, 9)


def test_a_proven_point_is_preferred_to_one_that_is_hardly_better():
    near = [(10.0, 20.0), (13.0, 9.2), (14.0, 9.0), (22.0, 6.0), (30.0, 2.0)]
    assert knee_index(near) == 1
    assert recommended(near, [True, False, True, True, True], near) == (2, False)


def test_a_proven_point_that_is_a_much_worse_compromise_is_not():
    """Where the ends alone are proven, one of them would be no compromise at all."""
    assert recommended(TRUE, [True, False, False, False, True], TRUE).place == knee_index(TRUE)


@pytest.mark.parametrize("proven", [[True] * 5, [False] * 5])
def test_a_proven_knee_is_certain_once_nothing_else_can_be_the_knee(proven):
    assert recommended(TRUE, proven, TRUE) == (2, proven[0])
    behind = [*TRUE[:3], (15.0, 6.0), (22.0, 2.0), TRUE[-1]]
    assert not recommended(TRUE, proven, behind).certain
    harmless = [*TRUE[:3], (18.0, 6.0), (29.0, 5.0), TRUE[-1]]
    assert recommended(TRUE, proven, harmless).certain == proven[0]


def test_while_an_end_is_open_so_is_the_knee():
    for moved in ([(9.0, 20.0), *TRUE[1:]], [*TRUE[:-1], (30.0, 1.0)]):
        assert not recommended(TRUE, [True] * 5, moved).certain
    assert not recommended(TRUE, [True] * 5, ()).certain


@pytest.mark.parametrize("count", range(3))
def test_of_fewer_than_three_points_it_is_the_quickest_and_never_certain(count):
    assert recommended(TRUE[:count], [True] * count, TRUE) == (0, False)


@st.composite
def known(draw):
    """A true front, and what a search may know of it: points found, of each whether it is proven,
    and the bound front of some facts that hold.
    """
    times = sorted(draw(st.sets(st.integers(5, 25), min_size=3, max_size=8)))
    loads = sorted(draw(st.sets(st.integers(1, 20), min_size=len(times), max_size=len(times))))
    true = list(zip(times, reversed(loads), strict=True))
    least = draw(st.integers(0, true[-1][1]))
    facts = {least - 1: inf, 99: draw(st.integers(1, times[0]))}
    for level in draw(st.sets(st.integers(0, 22), max_size=12)):
        real = next((time for time, load in true if load <= level), inf)
        facts[level] = real if draw(st.booleans()) or real == inf else draw(st.integers(1, real))

    def floor(load):
        return max(time for level, time in facts.items() if level >= load)

    def lightest(time):
        return max(level + 1 for level, latest in facts.items() if latest > time)

    seen = sorted({int(time) for time in facts.values() if time < inf})
    corners = [(time, lightest(time)) for time in seen]
    bound = [
        c for c in corners if not any(o != c and o[0] <= c[0] and o[1] <= c[1] for o in corners)
    ]
    found = {(t, s) if draw(st.booleans()) else (t + draw(st.integers(0, 4)), s) for t, s in true}
    kept = sorted(
        p for p in found if not any(o != p and o[0] <= p[0] and o[1] <= p[1] for o in found)
    )
    proven = [floor(load) == time and lightest(time) == load for time, load in kept]
    return true, kept, proven, bound


@given(known())
def test_what_is_certain_is_the_knee_of_the_true_front(case):
    true, found, proven, bound = case
    place, certain = recommended(found, proven, bound)
    if proven[place]:
        assert found[place] in true
    if certain:
        assert found[place] == true[knee_index(true)]


@given(known())
def test_everything_true_lies_on_or_above_the_bound_and_the_areas_say_so(case):
    true, found, _, bound = case
    for time, load in true:
        assert any(t <= time and s <= load for t, s in bound)
    areas = [dominated_area(points, 40, 30) for points in (found, true, bound)]
    assert areas == sorted(areas)
    grid = {(t, s) for t in range(40) for s in range(30) if any(a <= t and b <= s for a, b in true)}
    assert areas[1] == len(grid)


def test_a_front_says_what_is_recommended_and_how_sure_that_is(tmp_path):
    cell = layered(30, 2, 1, seed=0)
    cut = plan(cell, work=0.05)
    document = cut.to_dict()
    assert not cut.complete
    assert document["recommended"] == {
        "point": cut.knee_place + 1,
        "certain": cut.is_knee_certain,
    }
    assert 0 < document["open_area"] < 1
    corners = [(corner["makespan"], corner["stress"]) for corner in document["bound_front"]]
    assert all(a[0] < b[0] and a[1] > b[1] for a, b in pairwise(corners))
    whole = plan(layered(8, 1, 1, seed=0))
    assert whole.complete
    assert whole.to_dict()["recommended"]["certain"]
    assert not {"open_area", "bound_front"} & set(whole.to_dict())


def test_the_same_work_recommends_the_same_point_and_gives_the_same_document():
    cell = layered(30, 2, 1, seed=0)
    stored = plan(cell, work=0.02)
    for hint in (None, [result.schedule for result in stored]):
        documents = [{**plan(cell, work=0.05, hint=hint).to_dict(), "wall_s": 0} for _ in range(2)]
        assert documents[0] == documents[1]
        assert documents[0]["ended_by"] == "work"


def test_every_schedule_of_a_hint_is_begun_with():
    cell = layered(30, 2, 1, seed=0)
    stored = plan(cell, work=0.1)
    begun = plan(cell, work=1e-6, hint=[result.schedule for result in stored])
    alone = plan(cell, work=1e-6)

    def reached(front):
        return [any(m <= t and s <= load for m, s in front.points) for t, load in stored.points]

    assert all(reached(begun))
    assert not all(reached(alone))


@pytest.mark.parametrize("workers", [1, 2])
def test_the_area_that_is_open_only_shrinks_to_nothing(workers):
    told = []
    front = plan(layered(14, 2, 1, seed=1), workers=workers, on_solution=told.append)
    shares = [progress.open_area for progress in told]
    assert isinstance(front, Front)
    assert front.complete
    assert shares[0] == 1
    assert shares == sorted(shares, reverse=True)
    assert len(set(shares)) > 5
    assert shares[-1] == 0
