"""Separation of people and robots, and task times: closed forms, orders, ranges, second judges."""

from __future__ import annotations

import math
from random import Random

import pytest

from tandem.ergonomics import FactsError, published
from tandem.ergonomics.ssm import DistanceFacts, SeparationFacts, separation, slowed

ROBOT = {"v_r": 1.0, "T_r": 0.1, "T_s": 0.3, "S_s": 0.15, "C": 0.2, "Z_d": 0.1, "Z_r": 0.01}
TOPS = {"v_h": 5, "v_r": 10, "T_r": 5, "T_s": 10, "S_s": 10, "C": 2, "Z_d": 2, "Z_r": 2}


def test_no_fact_that_rises_lets_the_robot_come_nearer():
    random = Random(1)
    for _ in range(200):
        facts = {name: random.uniform(0.01, top / 2) for name, top in TOPS.items()}
        least = separation(SeparationFacts(**facts))["S_p"]
        for name in TOPS:
            assert separation(SeparationFacts(**{**facts, name: facts[name] * 1.3}))["S_p"] > least


def test_at_the_reduced_speed_the_distance_is_just_enough():
    random = Random(2)
    seen = set()
    for _ in range(300):
        facts = {name: random.uniform(0.01, top / 8) for name, top in TOPS.items()}
        distance = random.uniform(0, 8)
        found = slowed(DistanceFacts(**facts, distance=distance))
        seen.add(found["factor"] is None or found["factor"] > 1)
        if found["factor"] is None:
            assert distance <= found["S_0"]
            continue
        share = 1 / found["factor"]
        # way and speed in proportion, the time to stop as it is
        at = {**facts, "v_r": found["v_max"], "S_s": facts["S_s"] * share}
        needed = separation(SeparationFacts(**at))["S_p"]
        assert needed <= distance + 1e-9
        assert share == 1 or math.isclose(needed, distance)
    assert seen == {True, False}


def test_a_missing_fact_is_asked_for_with_a_cautious_value_and_none_is_assumed():
    with pytest.raises(FactsError) as error:
        published("ssm", "ssm_sp", {"v_r": 1.0, "T_r": -1, "T_s": 900})
    told = "\n".join(str(fault) for fault in error.value.faults)
    assert "T_r is -1 s, but ssm takes 0 to 5 s" in told
    assert "T_s is 900 s" in told
    for name in ("S_s", "C", "Z_d", "Z_r"):
        assert f"{name} is missing" in told
    assert "a cautious value would be 0.85" in told
    assert "v_h" not in told  # the standard's own value


def time_of(**facts: float) -> float:
    found = published("task_times", "robot_move", facts)
    assert isinstance(found, dict)
    return float(found["t_s"])


def stepped(d: float, v: float, a: float, j: float) -> float:
    """The least time of a motion with bounded jerk, found by halving: how long jerk, acceleration
    and cruising last, and the way by summing up what each phase adds.
    """

    def way(peak: float) -> tuple[float, float]:
        """Way and time of speeding up to a peak and braking at once."""
        jerk = min(a / j, math.sqrt(peak / j))
        steady = max(0.0, peak / (j * jerk) - jerk)
        clock = x = speed = acceleration = 0.0
        for seconds, change in ((jerk, j), (steady, 0.0), (jerk, -j)):
            x += speed * seconds + acceleration * seconds**2 / 2 + change * seconds**3 / 6
            speed += acceleration * seconds + change * seconds**2 / 2
            acceleration += change * seconds
            clock += seconds
        return 2 * x, 2 * clock

    low, high = 0.0, v
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if way(middle)[0] <= d else (low, middle)
    reached, clock = way(low)
    return clock + max(0.0, d - reached) / low


def test_motions_agree_with_closed_forms_and_with_phases_summed_up():
    random = Random(3)
    for _ in range(200):
        d, v = 10 ** random.uniform(-3, 1), 10 ** random.uniform(-2, 0.5)
        a, j = 10 ** random.uniform(-1, 1), 10 ** random.uniform(-0.5, 3)
        plain = d / v + v / a if d >= v * v / a else 2 * math.sqrt(d / a)
        assert math.isclose(time_of(d=d, v=v, a=a), plain)
        smooth = time_of(d=d, v=v, a=a, j=j)
        assert math.isclose(smooth, stepped(d, v, a, j), rel_tol=1e-9)
        assert plain <= smooth * (1 + 1e-12)
        assert smooth <= plain + 1.2 * a / j


def test_a_longer_way_takes_longer_and_a_quicker_robot_does_not():
    random = Random(4)
    for _ in range(100):
        facts = {name: 10 ** random.uniform(-1, 1) for name in "dvaj"}
        before = time_of(**facts)
        assert time_of(**{**facts, "d": facts["d"] * 1.1}) > before
        for name in "vaj":
            assert time_of(**{**facts, name: facts[name] * 1.1}) <= before * (1 + 1e-12)


def test_learning_leaves_its_rate_whenever_the_number_doubles():
    times = [
        published("task_times", "wright", {"first": 40.0, "rate": 0.8, "unit": n})["t_s"]
        for n in (1, 2, 4, 8)
    ]
    assert times == pytest.approx([40, 32, 25.6, 20.48])


def test_what_is_wrong_inside_a_list_is_told_once():
    with pytest.raises(FactsError) as error:
        published("task_times", "robot_task", {"moves": [{"d": 1.0, "v": 0.0, "a": 1.0}]})
    assert [str(fault) for fault in error.value.faults] == [
        "moves.0.v: v is 0 m/s, but task_times takes more than 0 to 20 m/s (greatest speed)."
        " Correct it."
    ]
    with pytest.raises(FactsError, match="one entry at least"):
        published("task_times", "robot_task", {"moves": []})
