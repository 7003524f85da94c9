"""What is out of range is refused with the range, and more of a bad thing never lowers a score."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tandem.ergonomics import METHODS, FactsError, score
from tandem.ergonomics.facts import about
from tandem.errors import UsageError

POSTURE = {
    "neck_flexion_deg": st.floats(-70, 90),
    "trunk_flexion_deg": st.floats(-45, 150),
    "upper_arm_flexion_deg": st.floats(-90, 180),
    "lower_arm_flexion_deg": st.floats(0, 160),
    "wrist_flexion_deg": st.floats(-90, 90),
}
FLAGS = st.booleans()
DRAWN: dict[str, dict[str, Any]] = {
    "rula": {
        **POSTURE, "load_kg": st.floats(0, 20), "repeats_per_min": st.floats(0, 10),
        "load_pattern": st.sampled_from(["intermittent", "static", "repeated", "shock"]),
        "static": FLAGS, "neck_twisted": FLAGS, "trunk_twisted": FLAGS, "legs_supported": FLAGS,
    },
    "reba": {
        **POSTURE, "knee_flexion_deg": st.floats(0, 160), "load_kg": st.floats(0, 20),
        "repeats_per_min": st.floats(0, 10), "trunk_twist_or_side": FLAGS, "static": FLAGS,
        "coupling": st.sampled_from(["good", "fair", "poor", "unacceptable"]),
    },
    "niosh": {
        "H": st.floats(0, 63), "V": st.floats(0, 175), "D": st.floats(0, 175),
        "A": st.floats(0, 135), "F": st.floats(0, 8), "L": st.floats(0.1, 60),
        "duration": st.sampled_from(["short", "moderate", "long"]),
        "coupling": st.sampled_from(["good", "fair", "poor"]),
    },
    "rsi": {
        "I": st.floats(0.01, 1), "E": st.floats(0.1, 60), "D": st.floats(0.01, 1),
        "P": st.floats(-60, 60), "H": st.floats(0.01, 12),
    },
    "lifft": {
        "lever_cm": st.floats(0, 100), "load_kg": st.floats(0, 50), "reps": st.floats(0, 5000),
    },
    "duet": {"omni_res": st.integers(0, 10), "reps": st.floats(0, 20_000)},
    "shoulder_tool": {
        "lever_cm": st.floats(0, 100), "load_kg": st.floats(0, 20), "reps": st.floats(0, 20_000),
        "type": st.sampled_from(["handling", "horizontal_push_pull"]),
    },
    "strain_index_1995": {
        "borg_level": st.sampled_from(
            ["light", "somewhat_hard", "hard", "very_hard", "near_maximal"]
        ),
        "percent_duration": st.floats(0, 100), "efforts_per_min": st.floats(0, 40),
        "posture": st.sampled_from(["good", "fair", "bad"]),
        "speed": st.sampled_from(["slow", "fast"]), "hours": st.floats(0.1, 12),
    },
    "hal_tlv": {"npf": st.floats(0, 10), "hal": st.floats(0, 9.9)},
}  # fmt: skip
RISES = {
    "rula": {"load_kg": 20, "repeats_per_min": 10, "static": True, "neck_twisted": True},
    "reba": {"load_kg": 20, "repeats_per_min": 10, "static": True, "trunk_twist_or_side": True},
    "niosh": {"L": 60, "H": 63, "D": 175, "A": 135, "F": 8},
    "rsi": {"I": 1, "E": 60, "D": 1, "H": 12},
    "lifft": {"lever_cm": 100, "load_kg": 50, "reps": 5000},
    "duet": {"omni_res": 10, "reps": 20_000},
    "shoulder_tool": {"lever_cm": 100, "load_kg": 20, "reps": 20_000},
    "strain_index_1995": {"percent_duration": 100, "efforts_per_min": 40, "hours": 12},
    "hal_tlv": {"npf": 10, "hal": 9.9},
}
"""Fact -> the most of it in `DRAWN`; more of each never lowers the score."""


@pytest.mark.parametrize("method", RISES)
@settings(max_examples=120, deadline=None)
@given(data=st.data())
def test_more_load_force_or_duration_never_lowers_a_score(method, data):
    facts = data.draw(st.fixed_dictionaries(DRAWN[method]))
    name = data.draw(st.sampled_from(sorted(RISES[method])))
    low, most = facts[name], RISES[method][name]
    if isinstance(most, bool):
        more: Any = most
    elif isinstance(low, int):
        more = data.draw(st.integers(low, most))
    else:
        more = data.draw(st.floats(low, most))
    first, second = score(method, facts), score(method, {**facts, name: more})
    # the damage of ever so few repetitions, and the last digit of a product
    assert second.score >= first.score * (1 - 1e-12)
    assert second.level >= first.level


AWAY = {
    "neck_flexion_deg": (0.0, 90.0),
    "trunk_flexion_deg": (0.0, 150.0),
    "upper_arm_flexion_deg": (0.0, 180.0),
    "wrist_flexion_deg": (0.0, 90.0),
    "lower_arm_flexion_deg": (80.0, 160.0),
}


@pytest.mark.parametrize("method", ["rula", "reba"])
@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_a_posture_further_from_neutral_never_lowers_a_score(method, data):
    facts = data.draw(st.fixed_dictionaries(DRAWN[method]))
    name = data.draw(st.sampled_from(sorted(AWAY)))
    neutral, most = AWAY[name]
    angle = data.draw(st.floats(neutral, most))
    further = data.draw(st.floats(angle, most))
    near = score(method, {**facts, name: angle})
    far = score(method, {**facts, name: further})
    assert far.score >= near.score


def test_the_lifting_index_is_least_at_75_cm_and_rises_to_both_sides():
    lift = {"H": 30, "D": 30, "A": 0, "F": 1, "duration": "short", "coupling": "good", "L": 10}
    indices = [score("niosh", {**lift, "V": height}).score for height in (0, 40, 75, 120, 175)]
    assert indices[0] > indices[1] > indices[2] < indices[3] < indices[4]


def test_a_lift_beyond_reach_is_allowed_no_weight():
    lift = {"V": 75, "D": 30, "A": 0, "F": 1, "duration": "short", "coupling": "good", "L": 5}
    outcome = score("niosh", {**lift, "H": 64})
    assert outcome.outputs["RWL"] == 0
    assert outcome.score is None
    assert outcome.level == 2


ONE = {
    "rula": {
        "upper_arm_flexion_deg": 30, "lower_arm_flexion_deg": 80, "wrist_flexion_deg": 5,
        "neck_flexion_deg": 5, "trunk_flexion_deg": 5, "load_kg": 1,
    },
    "reba": {
        "upper_arm_flexion_deg": 30, "lower_arm_flexion_deg": 80, "wrist_flexion_deg": 5,
        "neck_flexion_deg": 5, "trunk_flexion_deg": 5, "load_kg": 1,
    },
    "niosh": {
        "H": 30, "V": 75, "D": 30, "A": 0, "F": 1, "duration": "short", "coupling": "good", "L": 9,
    },
    "rsi": {"I": 0.3, "E": 10, "D": 1.5, "P": 0, "H": 8},
    "lifft": {"lever_cm": 40, "load_kg": 10, "reps": 100},
    "duet": {"omni_res": 4, "reps": 100},
    "shoulder_tool": {"lever_cm": 40, "load_kg": 3, "reps": 100},
    "strain_index_1995": {
        "borg_level": "hard", "percent_duration": 20, "efforts_per_min": 10, "posture": "fair",
        "speed": "fair", "hours": 6,
    },
    "hal_tlv": {"npf": 4, "hal": 6},
    "lm_mmh": {"task": "lift", "sex": "female", "H": 0.4, "VRM": 1.0, "DV": 0.5, "F": 1},
    "garg_energy": {
        "equation": "stoop_lift", "BW": 80, "L": 10, "h1": 0.2, "h2": 0.8, "S": 1, "reps": 100,
    },
    "rest_allowance": {"T_min": 60, "W": 600, "S": 350, "R": 100},
}  # fmt: skip
BOUNDED = [
    (method, name)
    for method, facts in ONE.items()
    for name, value in facts.items()
    if not isinstance(value, str)
]


@pytest.mark.parametrize(("method", "name"), BOUNDED)
def test_what_is_out_of_range_is_refused_with_value_and_range(method, name):
    assert score(method, ONE[method]) is not None
    for value in (-10_000, 1_000_000):
        with pytest.raises(FactsError) as refused:
            score(method, {**ONE[method], name: value})
        said = str(refused.value)
        assert name in said
        assert f"{value:g}" in said
        assert " to " in said


@pytest.mark.parametrize("method", METHODS)
def test_every_number_that_is_no_number_is_refused(method):
    name = next(n for n, v in ONE[method].items() if not isinstance(v, str))
    for value in (math.nan, math.inf, "much", None, True):
        with pytest.raises(FactsError, match=name):
            score(method, {**ONE[method], name: value})


def test_all_faults_are_told_at_once_with_the_cautious_value_of_what_is_missing():
    facts = {"upper_arm_flexion_deg": 200, "trunk_flexion_deg": 5, "wrist_flexion_deg": 0, "x": 1}
    with pytest.raises(FactsError) as refused:
        score("rula", facts)
    said = str(refused.value)
    assert "upper_arm_flexion_deg is 200 degrees, but rula takes -90 to 180 degrees" in said
    assert "neck_flexion_deg is missing" in said
    assert "lower_arm_flexion_deg is missing" in said
    assert "a cautious value would be" in said
    assert "knows no fact 'x'" in said
    assert len(refused.value.faults) == 4


def test_more_exertion_than_the_minute_has_is_refused():
    with pytest.raises(FactsError, match="120 s of exertion in a minute of 60 s"):
        score("rsi", {**ONE["rsi"], "E": 60, "D": 2})


def test_an_unknown_method_is_met_with_the_nearest_and_a_licensed_one_with_the_reason():
    with pytest.raises(UsageError, match="'reba'"):
        score("rebe", {})
    with pytest.raises(UsageError, match="EAWS scores no tasks here"):
        score("eaws", {})


def test_every_fact_of_every_method_is_explained_and_asked_ones_have_a_unit_or_words():
    for method in METHODS.values():
        for name, field in method.model.model_fields.items():
            assert field.description, (method, name)
            assert "unit" in about(field)
