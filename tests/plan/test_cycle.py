"""The station that repeats: what is known of cells, and what must hold for all of them."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from random import Random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.fuzz import cycles
from tests.fuzz.cycles import drawn, wrong_on_the_floor

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError, NothingFoundError, UsageError
from tandem.files.generators import layered
from tandem.files.validate import cell_of
from tandem.plan.cycle import exact
from tandem.plan.cycle.batch import plan_batch
from tandem.plan.cycle.door import CycleDoor
from tandem.plan.cycle.methods import CYCLE_METHODS, plan_cycle
from tandem.plan.cycle.result import CycleFront
from tandem.plan.door import RefusedScheduleWarning
from tandem.schedule.cycle import copied

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def thesis() -> Cell:
    return tandem.load(EXAMPLES / "thesis.yaml")


@pytest.fixture(scope="module")
def cover() -> Cell:
    return tandem.load(EXAMPLES / "cover.yaml")


@pytest.mark.parametrize("method", CYCLE_METHODS)
def test_the_front_of_the_thesis(thesis: Cell, method: str):
    front = plan_cycle(thesis, method=method)
    assert front.points == [(19, 12), (20, 7), (24, 3), (34, 2)]
    assert [point.in_process for point in front] == [2, 2, 1, 1]
    assert front.complete
    alone = plan_cycle(thesis, method=method, max_in_process=1)
    assert alone.points == [(23, 7), (24, 3), (34, 2)]


@pytest.mark.parametrize("method", CYCLE_METHODS)
def test_a_takt_asks_for_the_least_stress_that_keeps_it(thesis: Cell, method: str):
    def one(takt: float) -> tuple[float, float, int]:
        (point,) = plan_cycle(thesis, method=method, takt=takt)
        return point.cycle_time, point.stress, point.in_process

    assert one(30) == (24, 3, 1)
    assert one(23.9) == (23, 7, 1)  # one product is enough: 20 s would need two
    assert one(22) == (20, 7, 2)
    assert one(19) == (19, 12, 2)
    with pytest.raises(InfeasibleError, match="least cycle time that can be kept is 19 s"):
        one(18.5)


def test_a_takt_of_less_than_a_tick_is_too_short(thesis: Cell):
    with pytest.raises(InfeasibleError):
        plan_cycle(thesis, takt=0.5)


def test_single_answers(thesis: Cell):
    assert plan_cycle(thesis, minimize="cycle_time").points == [(19, 12)]
    assert plan_cycle(thesis, minimize="stress").points == [(34, 2)]
    assert plan_cycle(thesis, max_stress=5).points == [(24, 3), (34, 2)]


def test_the_makespan_is_no_cycle_time(cover: Cell):
    """Planned in 48 s; one allocation for all products brings one every 31 s, and that is proven
    by what the two have to do. Twelve products show that no mix of allocations comes below 28 s.
    """
    assert tandem.plan(cover, minimize="makespan")[0].makespan == 48
    for method in CYCLE_METHODS:
        assert plan_cycle(cover, method=method).points == [(31, 9), (33, 8), (40, 5)]


@pytest.mark.parametrize(("products", "seconds"), [(1, 48), (2, 66), (4, 116), (6, 172)])
def test_a_batch_is_the_cell_that_makes_all_products(cover: Cell, products: int, seconds: int):
    batch = plan_batch(cover, products, time_limit=60)
    assert (batch[0].makespan, batch.complete) == (seconds, True)
    copies = tandem.plan(copied(cover, products), minimize="makespan", time_limit=60)
    assert copies[0].makespan == seconds


def test_a_batch_begins_with_the_steady_state():
    """Where nothing is proven, the pattern of the steady state is a schedule of the batch."""
    cell = layered(12, 2, 1, seed=1)
    steady = plan_cycle(cell, minimize="cycle_time")[0]
    batch = plan_batch(cell, 40, time_limit=3)[0]
    assert batch.makespan <= steady.makespan + 39 * steady.cycle_time + 1e-6
    assert batch.bound.makespan <= batch.makespan


def test_random_cells_have_one_answer():
    total = cycles.slice_of(list(range(2001, 2061)), None)
    assert total.findings == []
    assert total.by_brute_force > 40
    assert total.replayed > 100


def test_a_limited_zone_and_a_changeover_make_the_cycle_longer():
    data = {
        "operators": {"ann": {"kind": "human"}, "bob": {"kind": "human"}},
        "tools": {"saw": {"changeover": {"ann": 3}}, "file": {"changeover": {"ann": 2}}},
        "tasks": {
            "cut": {"time": {"ann": 4}, "tool": "saw"},
            "smooth": {"time": {"ann": 6}, "tool": "file"},
            "paint": {"time": {"bob": 8}},
            "pack": {"time": {"bob": 5}},
        },
    }
    for method in CYCLE_METHODS:
        assert plan_cycle(cell_of(data), method=method)[0].cycle_time == 15
    data["tasks"]["smooth"]["zone"] = data["tasks"]["paint"]["zone"] = "bench"
    data["tasks"]["pack"]["zone"] = "bench"
    for method in CYCLE_METHODS:
        assert plan_cycle(cell_of(data), method=method)[0].cycle_time == 19


def _front(data: dict, **asked: int) -> CycleFront | None:
    try:
        front = plan_cycle(cell_of(data), workers=1, time_limit=5, **asked)
    except InfeasibleError:
        return None
    except NothingFoundError:
        front = None
    # times in millionths may take a search that moves its bound tick by tick too long
    assume(front is not None and front.complete)
    return front


def _drawn(seed: int) -> dict | None:
    _, data = drawn(seed)
    try:
        cell_of(data)
    except CellError:
        return None
    return data


@given(seed=st.integers(0, 10**6))
def test_more_in_process_never_lengthens_the_cycle_and_none_is_shorter_than_anybodys_work(
    seed: int,
):
    if (data := _drawn(seed)) is None:
        return
    fronts = [*(_front(data, max_in_process=laps) for laps in (1, 2, 3)), _front(data)]
    for tighter, wider in pairwise(fronts):
        _covers(wider, tighter)
    for point in (point for front in fronts if front is not None for point in front):
        assert max(point.utilisation.values()) <= 1 + 1e-9
        assert point.makespan <= point.in_process * point.cycle_time + 1e-6
        assert point.makespan > (point.in_process - 1) * point.cycle_time - 1e-6


@given(seed=st.integers(0, 10**6))
def test_leaving_out_a_rule_never_lengthens_the_cycle(seed: int):
    if (data := _drawn(seed)) is None:
        return
    front, random = _front(data, max_in_process=2), Random(seed)
    key = random.choice(
        ("after", "wait", "zone", "tool", "walk", "stress_limit", "holds", "same_operator")
    )
    for entry in data["tasks"].values():
        entry.pop(key, None)
    for operator in data["operators"].values():
        operator.pop(key if key in ("stress_limit", "holds") else "", None)
        if key in ("after", "wait"):
            operator.pop("holds", None)  # which names tasks that lie behind each other
    data.pop(key, None)
    _covers(_front(data, max_in_process=2), front)


def _covers(wider: CycleFront | None, tighter: CycleFront | None) -> None:
    """Every point of the one is equalled or beaten by the other."""
    for time, stress in tighter.points if tighter is not None else ():
        assert wider is not None
        assert any(t <= time and s <= stress for t, s in wider.points)


def test_a_pattern_that_the_checker_refuses_proves_nothing(thesis: Cell, monkeypatch):
    """Whatever a model says counts only when the checker has accepted it."""
    vouched = CycleDoor.vouched
    monkeypatch.setattr(
        CycleDoor, "vouched", lambda door, pattern, length: vouched(door, pattern, length - 1)
    )
    with pytest.raises(NothingFoundError, match="bug in Tandem"):
        exact.solve(thesis)


def test_a_later_refusal_takes_the_proof_back(thesis: Cell, monkeypatch):
    vouched = CycleDoor.vouched

    def refuse_the_first(door, pattern, length):
        return vouched(door, pattern, length - (length == 19))

    monkeypatch.setattr(CycleDoor, "vouched", refuse_the_first)
    with pytest.raises(NothingFoundError, match="bug in Tandem"):
        exact.solve(thesis)
    monkeypatch.setattr(
        CycleDoor,
        "vouched",
        lambda door, pattern, length: vouched(door, pattern, length - (length == 24)),
    )
    with pytest.warns(RefusedScheduleWarning):
        front = exact.solve(thesis)
    assert not front.complete
    assert {str(point.status) for point in front} == {"feasible"}


def test_a_limit_on_work_repeats():
    cell = layered(30, 2, 2, seed=5)
    one, two = (plan_cycle(cell, work=0.5, seed=3).to_dict() for _ in range(2))
    assert {**one, "wall_s": 0} == {**two, "wall_s": 0}
    assert one["ended_by"] in ("work", "proof")


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"takt": 0}, "takt 0: must be"),
        ({"max_in_process": 0}, "max_in_process 0: must be 1 or more"),
        ({"max_stress": -1}, "max_stress -1: must be"),
        ({"minimize": "makespan"}, "choose front, cycle_time or stress"),
        ({"method": "exat"}, "Did you mean 'exact'"),
        ({"time_limit": 0}, "time limit 0"),
        ({"work": float("nan")}, "work nan"),
        ({"workers": 0}, "workers 0"),
    ],
)
def test_wrong_questions_are_refused(thesis: Cell, asked: dict, said: str):
    with pytest.raises(UsageError, match=said):
        plan_cycle(thesis, **asked)


def test_what_cannot_repeat_is_refused_at_once():
    data = tandem.load(EXAMPLES / "thesis.yaml").to_dict()
    data["tasks"]["1"]["release"] = 5
    data["tasks"]["3"]["deadline"] = 50
    with pytest.raises(CellError) as refused:
        plan_cycle(cell_of(data))
    assert [fault.path for fault in refused.value.faults] == [
        ("tasks", "1", "release"),
        ("tasks", "3", "deadline"),
    ]
    with pytest.raises(CellError):
        plan_batch(cell_of(data), 3)


def test_breaks_play_no_part(thesis: Cell):
    data = thesis.to_dict()
    data["operators"]["human"]["breaks"] = [[10, 20]]
    data["operators"]["human"]["setup"] = 4
    assert plan_cycle(cell_of(data)).points == plan_cycle(thesis).points


@pytest.mark.parametrize(
    ("station", "takt", "makespans", "kept"),
    [
        ("washing-machine", 60, [62, 65], (58, 11, 2)),
        ("planetary-gear", 60, [94, 97, 100], (54, 17, 3)),
        ("control-box", 60, [137, 139, 140, 142, 144, 146, 151, 153], (59, 9, 3)),
    ],
)
def test_stations_from_practice_keep_a_takt_below_their_makespan(
    station: str, takt: float, makespans: list[float], kept: tuple[float, float, int]
):
    """None of them could, if one product had to be done before the next is begun. The takt is
    proven by the exact method; the checker has accepted each pattern.
    """
    cell = tandem.load(EXAMPLES / f"{station}.yaml")
    assert [point.makespan for point in tandem.plan(cell, time_limit=60)] == makespans
    front = plan_cycle(cell, takt=takt, time_limit=120)
    (point,) = front
    assert (point.cycle_time, point.stress, point.in_process) == kept
    assert front.complete
    assert wrong_on_the_floor(cell, point, front.question) == ""


def test_a_pattern_to_begin_with_does_not_stand_beside_the_answer():
    """Larger cells begin with one product after the other; what answers the question takes its
    place, and where nothing else is found it is all there is.
    """
    data = layered(26, 2, 2, seed=2).to_dict()
    for name in list(data["tasks"])[::3]:
        data["tasks"][name]["zone"] = "bench"
    cell = cell_of(data)
    quickest = plan_cycle(cell, minimize="cycle_time", time_limit=60)
    assert (len(quickest), quickest.complete) == (1, True)
    within = plan_cycle(cell, takt=quickest[0].cycle_time + 20, time_limit=60)
    assert (len(within), within.complete) == (1, True)
    asked = []

    def stop(points: int) -> None:
        asked.append(points)
        raise KeyboardInterrupt

    stopped = plan_cycle(cell, on_point=stop)
    assert (len(stopped), stopped.interrupted, stopped.complete) == (1, True, False)
    assert asked == [1]
    assert stopped[0].in_process == 1
