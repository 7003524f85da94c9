"""Every worked example of every method comes out as printed."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from tests.ergonomics.worked_examples import EXAMPLES, NOT_REPRODUCED, answer, compared, table

from tandem.ergonomics import METHODS, published


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example["id"])
def test_a_worked_example_comes_out_as_printed(example):
    wrong = [c for c in compared(example) if not c.agrees]
    assert wrong == []


def test_every_method_has_a_worked_example():
    assert set(METHODS) <= {example["method"] for example in EXAMPLES}


def example_of(name):
    return next(example for example in EXAMPLES if example["id"] == name)


def test_what_is_printed_and_not_reproduced_is_what_the_page_says():
    """The reasons are those of the page; our numbers beside them are what we compute."""
    assert {row["id"] for row in NOT_REPRODUCED} == {
        "lifft-ms", "duet-multi", "niosh-ex1-origin", "shoulder-mono",
    }  # fmt: skip
    assert f"{answer(example_of('lifft-ms'))['probability']:.3f}" == "0.330"
    assert f"{answer(example_of('duet-multi'))['probability']:.3f}" == "0.600"
    assert f"{answer(example_of('niosh-ex1-origin'))['RWL']:.1f}" == "15.9"
    metric = {"lever_cm": 41.0, "load_kg": 9 / 9.80665, "reps": 2880.0}
    exact = published("shoulder_tool", "shoulder_task", metric)
    assert f"{exact.outputs['probability']:.3f}" == "0.210"


def test_the_page_shows_the_table_as_it_is_printed():
    page = Path(__file__).parents[2] / "docs" / "ergonomics.md"
    assert table() in page.read_text("utf-8")


def test_the_share_of_the_heaviest_task_is_as_the_duet_paper_says():
    shares = answer(example_of("duet-multi"))["shares"]
    assert math.isclose(shares[2], 0.976, abs_tol=0.0005)
