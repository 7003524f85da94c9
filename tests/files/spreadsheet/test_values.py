"""Numbers are read as the sheet shows them, and doubtful ones are refused."""

from __future__ import annotations

import datetime
from decimal import Decimal
from typing import Any

import pytest

from tandem.files.spreadsheet.references import References, UnknownTaskError
from tandem.files.spreadsheet.values import (
    Marks,
    UnreadableError,
    cannot,
    marks_of,
    number,
    seconds,
)


@pytest.mark.parametrize(
    ("value", "mark", "expected"),
    [
        (10.5, None, "10.5"),
        (0.1 + 0.2, None, "0.3"),
        ("10,5", None, "10.5"),
        ("10.5", None, "10.5"),
        ("1.234,5", None, "1234.5"),
        ("1,234.5", None, "1234.5"),
        ("1.234", ",", "1234"),
        ("1.234", ".", "1.234"),
        ("1.234.567", None, "1234567"),
        ("0,125", None, "0.125"),
        ("1 200", None, "1200"),
        ("1'200.5", None, "1200.5"),
        ("\u00a012", None, "12"),
        (",5", None, "0.5"),
        ("-3", None, "-3"),
        ("1234,567", None, "1234.567"),
    ],
)
def test_numbers(value: object, mark: Any, expected: str) -> None:
    assert number(value, Marks(mark, grouped=True) if mark else Marks()).value == Decimal(expected)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "value",
    [
        "1.234",
        "1,234",
        "12 apples",
        "10:30",
        "~5",
        True,
        datetime.date(2024, 2, 1),
        datetime.time(12, 30),
        "1,2,3x",
    ],
)
def test_doubtful_numbers_are_refused(value: object) -> None:
    with pytest.raises(UnreadableError):
        number(value)  # type: ignore[arg-type]


def test_a_unit_behind_the_number_counts_more_than_the_header() -> None:
    assert seconds(number("2 min"), "s") == (Decimal(120), False)
    assert seconds(number("10"), "TMU") == (Decimal("0.36"), False)
    assert seconds(number("1"), "1/100 min") == (Decimal("0.6"), False)
    assert seconds(number(1 / 3), "min") == (Decimal(20), False)
    assert seconds(number(1.23456), "s") == (Decimal("1.235"), True)


def test_decimal_mark_needs_evidence() -> None:
    assert marks_of(["10,5", "1.234"]) == Marks(",")
    assert marks_of(["10.5", "1,234"]) == Marks(".")
    assert marks_of(["1.234"]) == Marks()
    assert marks_of(["10,5", "10.5"]) == Marks()
    assert marks_of([10.5, "x", "10.5 and 3"]) == Marks()


def test_thousands_need_evidence_too() -> None:
    assert marks_of(["1.234,5", "1.234"]) == Marks(",", grouped=True)
    assert marks_of(["1.200.000"]) == Marks(",", grouped=True)
    assert number("1.234", Marks(",", grouped=True)).value == 1234
    assert number("1.234", Marks(".")).value == Decimal("1.234")
    with pytest.raises(UnreadableError, match=r"may be 1234 or 1\.234"):
        number("1.234", Marks(","))


@pytest.mark.parametrize(
    ("value", "no"),
    [
        (0, True),
        ("", True),
        ("0,0", True),
        ("0 s", True),
        ("–", True),
        ("k.A.", True),
        (0.1, False),
        ("x", False),
        (True, False),
    ],
)
def test_zero_empty_and_dashes_mean_cannot(value: object, no: bool) -> None:
    assert cannot(value) is no  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("1; 2", ["1", "2"]),
        ("1,2", ["1", "2"]),
        ("1 2", ["1", "2"]),
        ("1\n2", ["1", "2"]),
        (1.0, ["1"]),
        ("1-3", ["1", "2", "3"]),
        ("1 und 3", ["1", "3"]),
        ("2FS", ["2"]),
        ("-", []),
        ("", []),
        ("2; 2", ["2"]),
        ("10", ["10"]),
        ("010", ["10"]),
        ("Mount cover", ["a b"]),
        ("a b; 1", ["a b", "1"]),
    ],
)
def test_lists_of_tasks(value: object, expected: list[str]) -> None:
    assert References(["1", "2", "3", "10", "a b"], {"Mount cover": "a b"}).read(value) == expected  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("1; 11", "'11', which is no task"),
        ("2SS", "only end-to-start"),
        ("2FS+3", "only end-to-start"),
        (1.2, "Excel makes a number of '1,2'"),
        (datetime.date(2024, 2, 1), "Excel makes dates"),
    ],
)
def test_what_is_no_list_of_tasks(value: object, words: str) -> None:
    with pytest.raises(UnknownTaskError, match=words):
        References(["1", "2", "3", "10"]).read(value)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("names", "rows", "values", "expected", "said"),
    [
        (
            ["T1", "T2", "T3"],
            {"T1": 4, "T2": 5, "T3": 6},
            ["1", "1,2"],
            ["T1", "T2"],
            "the number at the end",
        ),
        (
            ["cover", "wheel", "cable"],
            {"cover": 4, "wheel": 5, "cable": 6},
            ["1", "1,2"],
            ["cover", "wheel"],
            "places in the list",
        ),
        (
            ["cover", "wheel", "cable"],
            {"cover": 4, "wheel": 5, "cable": 6},
            ["4", "4,5"],
            ["cover", "wheel"],
            "row numbers of the sheet",
        ),
    ],
)
def test_numbers_that_are_no_names(
    names: list[str], rows: dict[str, int], values: list[str], expected: list[str], said: str
) -> None:
    references = References(names, {}, rows)
    references.agree_on_numbers(values)
    assert references.read(values[1]) == expected
    assert said in str(references.said)
