"""Names that are one but for a slip of the pen are told from names that people number and letter on
purpose.
"""

from __future__ import annotations

import pytest

from tandem.cell.slips import a_slip_apart, slips


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("Presse", "presse"),
        ("Presse", "Press"),
        ("presse", "Press"),
        ("driver", "drvier"),
        ("screwdriver", "screwdrivr"),
        ("fixture", "fixtures"),
        ("wrench", "wrensh"),
        ("H1", "h1"),
        ("Tisch 2", "tisch2"),
        ("Übergabe", "u\u0308bergabe"),
        ("Vor-Montage", "Vormontage"),
    ],
)
def test_a_slip(one: str, other: str) -> None:
    assert a_slip_apart(one, other)
    assert a_slip_apart(other, one)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("jig 1", "jig 2"),
        ("jig 1", "jig 11"),
        ("jig 1 1", "jig 11"),
        ("table A", "table B"),
        ("TableA", "TableB"),
        ("Table", "TableB"),
        ("SW10", "SW10a"),
        ("M4", "M5"),
        ("left", "lift"),
        ("press", "table"),
        ("driver left", "driver right"),
        ("A", "B"),
    ],
)
def test_no_slip(one: str, other: str) -> None:
    assert not a_slip_apart(one, other)


def test_each_name_is_led_to_the_first_that_is_like_it() -> None:
    assert slips(["Presse", "driver", "presse", "Press", "jig 1", "jig 2"]) == {
        "presse": "Presse",
        "Press": "Presse",
    }


def test_thousands_of_names_are_compared_by_what_they_share_and_not_each_with_each(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []

    def counted(one: str, other: str) -> bool:
        asked.append(one)
        return a_slip_apart(one, other)

    monkeypatch.setattr("tandem.cell.slips.a_slip_apart", counted)
    names = [f"fixture number {place} of hall" for place in range(2_000)]
    assert slips([*names, "fixture number 7 of hal"]) == {
        "fixture number 7 of hal": "fixture number 7 of hall"
    }
    assert 0 < len(asked) < 2_000 * 1_999 / 2 / 20, "each with each would be two million"
