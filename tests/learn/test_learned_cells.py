"""What the manual says of training on the example cells is what was measured."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
STORED = ROOT / "benchmarks" / "results" / "learned_cells.json"


@pytest.fixture(scope="module")
def rows() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(STORED.read_text())["rows"]
    return found


def test_every_example_cell_was_trained_with_five_seeds_against_a_proven_optimum(
    rows: list[dict[str, Any]],
) -> None:
    assert {row["cell"] for row in rows} == {
        path.stem for path in (ROOT / "examples").glob("*.yaml")
    }
    assert all(row["proven"] and len(row["seeds"]) == 5 for row in rows)


def test_nothing_learned_is_better_than_exact_and_the_alternator_alone_stays_above(
    rows: list[dict[str, Any]],
) -> None:
    for row in rows:
        gaps = [seed["greedy"]["gap"] for seed in row["seeds"]]
        assert min(gaps) >= 0
        assert max(gaps) == 0 or (row["cell"] == "alternator" and max(gaps) < 0.02)
        assert max(gaps) <= row["rule"]["gap"]


def test_what_was_trained_ran_its_shift_unless_no_decider_can(rows: list[dict[str, Any]]) -> None:
    for row in rows:
        shift = row["dispatched"]
        if row["cell"] == "strain-index":
            assert shift["code"] == 3
            assert "stress_of_set" in shift["said"]
        else:
            assert (shift["code"], shift["over"], shift["failed"]) == (0, True, 0)


def test_the_page_has_the_table_that_the_command_prints() -> None:
    asked = [sys.executable, str(ROOT / "benchmarks" / "learned_cells.py"), "--show", str(STORED)]
    shown = subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()
    assert shown in (ROOT / "docs" / "learning.md").read_text()
