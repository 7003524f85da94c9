"""The checker keeps limits of people by the exact formula, and says who exceeds which by what."""

from __future__ import annotations

import pytest
from tests import limited

from tandem.schedule.checker import faults
from tandem.schedule.model import Assignment, Schedule

ALL_ANNA = Schedule((
    Assignment(0, 4, "base", ("anna",)),
    Assignment(4, 6, "cover", ("anna",)),
    Assignment(6, 9, "close", ("anna",)),
))  # fmt: skip


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        (
            {"peak_reba": 10.5},
            ["comes to 11 of peak:reba, the limit is 10.5 (most from 'close' 11"],
        ),
        ({"peak_reba": 11}, []),
        ({"time_above_reba_9": 6.9}, ["comes to 7 of time-above:reba:9, the limit is 6.9"]),
        ({"time_above_reba_9": 7}, []),
        ({"dose_lifft": 0.599999}, ["comes to 0.6 of dose:lifft, the limit is 0.599999"]),
        ({"dose_lifft": 0.6}, []),
        ({"dose_stress": 299}, ["comes to 300 of dose:stress, the limit is 299"]),
    ],
)
def test_a_limit_is_judged_exactly(limits: dict[str, float], words: list[str]) -> None:
    told = faults(limited.cell(**limits), ALL_ANNA)
    assert len(told) == len(words)
    assert all(f"operator 'anna': {part}" in said for part, said in zip(words, told, strict=True))
