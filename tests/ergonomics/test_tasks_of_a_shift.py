"""What moves a level, and what tasks come to: doses are added, ranks never."""

from __future__ import annotations

import math
from typing import Any

import pytest

from tandem.ergonomics import METHODS, published
from tandem.ergonomics.tasks import Origin, TaskFacts, scored, totals


def task(method: str, side: str = "", minutes: float | None = None, name: str = "a", **facts: Any):
    model = METHODS[method].model
    found = model.model_validate(facts)
    origins = {key: Origin("measured" if key in facts else "default") for key in model.model_fields}
    return TaskFacts(name, method, side, found, origins, minutes)  # type: ignore[arg-type]


REBA = {
    "neck_flexion_deg": 5, "trunk_flexion_deg": 45, "upper_arm_flexion_deg": 30,
    "lower_arm_flexion_deg": 80, "wrist_flexion_deg": 5, "knee_flexion_deg": 0, "load_kg": 1,
    "coupling": "good",
}  # fmt: skip


def test_a_level_that_five_degrees_change_is_told_with_the_fact():
    near = scored(task("reba", "left", **{**REBA, "neck_flexion_deg": 18, "load_kg": 4.8}))
    moved = {(move.fact, move.change, move.is_share) for move in near.moves}
    for move in near.moves:
        facts = {**REBA, "neck_flexion_deg": 18, "load_kg": 4.8, move.fact: move.value}
        again = scored(task("reba", "left", **facts)).outcome
        assert (again.score, again.level) == (move.score, move.level)
        assert again.level != near.outcome.level
    assert all(abs(change) == 5 for name, change, share in moved if name.endswith("_deg"))


def test_what_no_small_change_moves_is_stable():
    assert scored(task("reba", "left", **REBA)).stable
    lift = {"H": 40, "V": 60, "D": 50, "A": 30, "F": 1, "duration": "long", "coupling": "fair"}
    assert not scored(task("niosh", **lift, L=8.1)).stable
    assert scored(task("niosh", **lift, L=12)).stable


def test_what_was_not_stated_is_named_with_the_worst_it_could_be():
    row = scored(task("reba", "left", **REBA))
    assert row.unstated["trunk_twist_or_side"] is False
    assert "load_kg" not in row.unstated
    assert row.at_worst is not None
    assert row.at_worst.score > row.outcome.score


def test_ordinal_scores_are_never_added():
    rows = [
        scored(task("reba", "left", 60.0, "a", **{**REBA, "load_kg": 12, "static": True})),
        scored(task("reba", "left", 180.0, "b", **{**REBA, "trunk_flexion_deg": 0})),
    ]
    (total,) = totals(rows)
    assert total.kind == "ordinal"
    assert total.value == max(row.outcome.score for row in rows)
    weighted = sum(r.outcome.score * r.given.minutes for r in rows) / 240
    assert math.isclose(total.outputs["time_weighted"], weighted)
    assert total.outputs["minutes_at_level"][str(total.level)] == sum(
        row.given.minutes for row in rows if row.outcome.level >= total.level
    )


def test_without_minutes_an_ordinal_total_is_a_peak_alone():
    (total,) = totals([scored(task("reba", "left", None, **REBA))])
    assert set(total.outputs) == {"peak"}


@pytest.mark.parametrize(
    ("method", "step", "one", "other"),
    [
        ("duet", "duet", {"omni_res": 4, "reps": 1000}, {"omni_res": 6, "reps": 100}),
        ("lifft", "lifft_si", {"lever_cm": 40, "load_kg": 10, "reps": 100},
         {"lever_cm": 50, "load_kg": 15, "reps": 40}),
    ],
)  # fmt: skip
def test_doses_of_a_side_are_added_as_their_authors_do(method, step, one, other):
    side = "left" if METHODS[method].sided else ""
    rows = [
        scored(task(method, side, name="a", **one)),
        scored(task(method, side, name="b", **other)),
    ]
    (total,) = totals(rows)
    together = published(method, step, {"tasks": [one, other]})
    assert math.isclose(total.value, together.score)
    assert math.isclose(total.outputs["probability"], together.outputs["probability"])
    assert total.level == together.level
    assert total.tasks == ("a", "b")


def test_sides_are_summed_apart_and_what_both_hands_do_counts_for_each():
    rows = [
        scored(task("duet", "left", name="a", omni_res=4, reps=1000)),
        scored(task("duet", "both", name="b", omni_res=6, reps=100)),
    ]
    left, right = totals(rows)
    assert (left.side, right.side) == ("left", "right")
    assert math.isclose(left.value, rows[0].outcome.score + rows[1].outcome.score)
    assert math.isclose(right.value, rows[1].outcome.score)


def test_methods_are_never_mixed():
    rows = [
        scored(task("reba", "left", **REBA)),
        scored(task("duet", "left", omni_res=4, reps=1000)),
        scored(task("lifft", lever_cm=40, load_kg=10, reps=100)),
    ]
    assert [(total.method, len(total.tasks)) for total in totals(rows)] == [
        ("reba", 1), ("lifft", 1), ("duet", 1),
    ]  # fmt: skip


def test_lifts_come_together_as_cli_and_exertions_as_cusi():
    lift = {"H": 30, "V": 75, "D": 25, "A": 0, "duration": "moderate", "coupling": "good"}
    lifts = [{**lift, "F": 1, "L": 12}, {**lift, "F": 2, "L": 8}]
    (total,) = totals([scored(task("niosh", name=str(i), **one)) for i, one in enumerate(lifts)])
    assert total.value == published("niosh", "niosh_cli", {"tasks": lifts}).score
    exertion = {"I": 0.3, "E": 8, "D": 1, "P": 0}
    rows = [scored(task("rsi", "left", name=str(h), **exertion, H=h)) for h in (2, 3)]
    (total,) = totals(rows)
    days = [{"H": h, "subtasks": [exertion]} for h in (2, 3)]
    assert total.value == published("rsi", "cusi", {"tasks": days}).score
    # the same exertion for 2 h and for 3 h is that of 5 h
    assert total.value == pytest.approx(scored(task("rsi", **exertion, H=5)).outcome.score)
