"""Fronts over other measures against every allocation that there is, and limits by the exact
formula.
"""

from __future__ import annotations

import csv
import math
from fractions import Fraction
from random import Random

import pytest
from tests.benchmark_data import folder
from tests.plan.every_allocation import MEASURES, assessed, expected, least, of_all

import tandem
from tandem.cell.burdens import named
from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, UsageError
from tandem.files.validate import cell_of
from tandem.plan.axes.search import plan_axes
from tandem.schedule.checker import faults
from tandem.schedule.exposure import by_person, limit_of, value


@pytest.mark.parametrize("seed", range(6))
def test_no_allocation_is_missed_and_none_is_invented(seed: int):
    """Every measure alone, and pairs of them as three axes, against all allocations and orders."""
    random = Random(seed)
    data = assessed(random)
    cell, everything = cell_of(data), of_all(data)
    asked = [(name,) for name in MEASURES] + [
        tuple(random.sample(MEASURES, 2)),
        ("dose:shoulder_tool", "worst:stress"),
        tuple(random.sample(MEASURES, 3)),
    ]
    for names in asked:
        front = plan_axes(cell, ["makespan", *names])
        assert front.complete
        assert sorted(point.values for point in front.points) == pytest.approx(
            [pytest.approx(row, rel=1e-12) for row in expected(everything, names)]
        ), names
        assert all(not faults(cell, point.schedule) for point in front.points)


def test_the_front_of_stress_is_the_front():
    cell = tandem.load("examples/thesis.yaml")
    points = [point.values for point in plan_axes(cell, ["makespan", "stress"]).points]
    assert points == [(23, 7), (24, 3), (34, 2)] == tandem.plan(cell, workers=1).points


@pytest.mark.parametrize("instance", ["pearce2018_p1", "pearce2018_p2", "pearce2018_p3"])
def test_the_fronts_of_the_strain_index_are_the_published_enumeration(instance: str):
    place = folder("hrc_case_studies")
    with open(place / "pareto.csv", newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["instance"] == instance]
    front = plan_axes(tandem.load(place / f"{instance}.json"), ["makespan", "stress"])
    published = sorted((float(row["makespan"]), float(row["strain_index"])) for row in rows)
    assert published
    assert [point.values for point in front.points] == published
    with pytest.raises(UsageError, match="by sets of tasks"):
        plan_axes(front.cell, ["makespan", "peak:stress"])


@pytest.mark.parametrize("seed", range(6))
def test_limits_cut_off_what_exceeds_them_and_nothing_else(seed: int):
    random = Random(100 + seed)
    data = assessed(random)
    cell = cell_of(data)
    for text, name, factor in (
        (f"peak:reba={random.randint(4, 11)}", "peak:reba", 1),
        (f"stress={random.randint(4, 12)}", "worst:stress", 1),
        (f"time-above:reba:6={random.randint(3, 12)}", "worst:time-above:reba:6", 1),
        (
            f"dose:shoulder_tool={random.randint(5, 30) * 0.0005:.4f}",
            "worst:dose:shoulder_tool",
            Fraction(500, 28_800),
        ),
    ):
        most = Fraction(text.partition("=")[2])
        within = {
            (t, values["stress"]) for t, values in of_all(data) if values[name] * factor <= most
        }
        try:
            front = plan_axes(cell, ["makespan", "stress"], limits=[text], cycles=500)
        except InfeasibleError:
            assert not within, text
            continue
        assert {point.values for point in front.points} == least(within), text
        limit = limit_of(text, cell, 500)
        assert all(not limit.faults(cell, point.schedule) for point in front.points)


def test_a_limit_of_fatigue_is_kept_by_its_envelope():
    cell = tandem.load("examples/gearbox.yaml")
    text = "fatigue:stress:0.05:0.1=0.1"
    front = plan_axes(cell, ["makespan", "stress"], limits=[text])
    limit = limit_of(text, cell, None)
    for point in front.points:
        people = by_person(cell, point.schedule, limit.measure)
        assert max(people.values()) <= limit.most
    assert front.points[0].values[0] > plan_axes(cell, ["makespan", "stress"]).points[0].values[0]


def test_fatigue_rises_at_work_and_falls_at_rest():
    """Jaber: 60 min of work, 10 of rest, 60 of work at 0.005 and 0.05 a minute."""
    data = {
        "operators": {"anna": {"kind": "human"}},
        "tasks": {
            "a": {"time": {"anna": 3600}, "stress": 1},
            "b": {"time": {"anna": 3600}, "stress": 1, "wait": {"after": "a", "at_least": 600}},
        },
    }
    cell = cell_of(data)
    schedule = tandem.plan(cell, workers=1)[0].schedule
    fatigue = value(cell, schedule, named("fatigue:stress:0.005:0.05", cell))
    assert fatigue == pytest.approx(0.3756396597, rel=1e-9)
    assert fatigue < 1 - math.exp(-0.005 * 120)


def test_a_faster_plan_of_the_same_allocation_raises_the_dose_of_a_shift():
    data = assessed(Random(3))
    cell = cell_of(data)
    point = plan_axes(cell, ["makespan", "dose:shoulder_tool"]).points[0]
    measure = named("dose:shoulder_tool", cell)
    rows = [
        {**row, "start": row["start"] + 60, "end": row["end"] + 60}
        for row in point.schedule.to_list()
    ]
    late = type(point.schedule).from_list(rows)
    assert value(cell, late, measure) < value(cell, point.schedule, measure)
    assert value(cell, late, measure, cycles=400) == value(
        cell, point.schedule, measure, cycles=400
    )


@pytest.mark.parametrize(
    ("axes", "said"),
    [
        (["stress", "makespan"], "write makespan first"),
        (["makespan"], "one or more measures"),
        (["makespan", "stress", "stress"], "stands there twice"),
        (["makespan", "dose:reba"], "reba only ranks"),
        (["makespan", "peak:eaws"], "no task of the cell has a value"),
        (["makespan", "pek:reba"], "Did you mean 'peak'"),
        (["makespan", "time-above:reba"], "time-above:SCALE:LEVEL"),
        (["makespan", "time-above:reba:-1"], "must be a number, 0 or more"),
    ],
)
def test_axes_that_are_none_are_refused(axes: list[str], said: str):
    with pytest.raises(UsageError, match=said):
        plan_axes(_cell(), axes)


@pytest.mark.parametrize(
    ("limit", "said"),
    [
        ("peak:reba", "write it as MEASURE=MOST"),
        ("peak:reba@carla=3", "is no human of the cell"),
        ("worst:stress=3", "leave out `worst:`"),
        ("time-weighted:reba=3", "falls by waiting alone"),
        ("dose:shoulder_tool=0.02", "--cycles-per-shift"),
        ("stress=much", "must be a number"),
    ],
)
def test_limits_that_are_none_are_refused(limit: str, said: str):
    with pytest.raises(UsageError, match=said):
        plan_axes(_cell(), ["makespan", "stress"], limits=[limit])


def test_limits_that_cannot_be_kept_are_a_minimal_set_beside_those_of_the_cell():
    free = tandem.load("examples/thesis.yaml")
    last = free.tasks["7"].model_copy(update={"deadline": 30})
    cell = free.replace(tasks={**free.tasks, "7": last})
    limits = ["stress=2", "peak:stress=9"]
    with pytest.raises(InfeasibleError) as failed:
        plan_axes(cell, ["makespan", "stress"], limits=limits)
    told = failed.value.to_dict()["infeasible"]
    assert [one["where"] for one in told["together"]] == [
        ["limit", "stress=2"],
        ["tasks", "7", "deadline"],
    ]
    assert told["minimal"] is True
    assert [(one["makespan"], one["stress"]) for one in told["without"]] == [(23, 7), (34, 2)]
    # each is needed, and the third is not
    assert plan_axes(cell, ["makespan", "stress"], limits=limits[1:]).points
    assert plan_axes(free, ["makespan", "stress"], limits=limits).points
    with pytest.raises(InfeasibleError):
        plan_axes(cell, ["makespan", "stress"], limits=limits[:1])


def _cell() -> Cell:
    return cell_of(assessed(Random(1)))
