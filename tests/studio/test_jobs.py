"""What the studio's jobs answer, without a server around them."""

from __future__ import annotations

import pytest

pytest.importorskip("starlette", reason="pip install 'tandem[studio]'")

from tandem.studio.jobs import JOBS

DRAGGED = {
    "cell": {
        "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
        "tasks": {
            "hold": {"time": {"human": 3}},
            "drill": {"time": {"robot": 4}, "after": ["hold"]},
        },
    },
    "assignments": [
        {"task": "hold", "operators": ["human"], "start": 0, "end": 3},
        {"task": "drill", "operators": ["robot"], "start": 3, "end": 7},
    ],
}


@pytest.mark.parametrize(
    ("language", "reason", "fault"),
    [
        (
            "en",
            "task 'hold': robot cannot do it; human can.",
            "task 'drill': starts at 3 s, before task 'hold' has ended, which it comes after: 4.5 s"
            " is the earliest.",
        ),
        (
            "de",
            "Vorgang 'hold': robot kann ihn nicht ausführen; möglich: human.",
            "Vorgang 'drill': beginnt bei 3 s, bevor sein Vorgänger 'hold' beendet ist: frühestens"
            " bei 4,5 s.",
        ),
    ],
)
def test_what_is_wrong_with_a_dragged_bar_is_said_in_the_language_of_the_page(
    language: str, reason: str, fault: str
) -> None:
    asked = {**DRAGGED, "task": "hold", "operators": ["robot"], "start": 1.5, "lang": language}
    told = JOBS["place"].do(asked, lambda _: None)
    assert told["reasons"] == [reason]
    assert {reason, fault} <= set(told["faults"])
    late = {**asked, "operators": ["human"]}
    assert JOBS["place"].do(late, lambda _: None)["faults"] == [fault]
