"""What the manual says of training on the example cells is what was measured."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tandem
from tandem.cell.model import Cell
from tandem.schedule.model import Schedule
from tandem.world import state as world
from tandem.world.arrays import Array, Arrays, Names
from tandem.world.episode import Episode, Shift, play_one
from tandem.world.people import compliant, crew
from tandem.world.randomness import Draw, nominal_scenario

ROOT = Path(__file__).resolve().parents[2]
STORED = ROOT / "benchmarks" / "results" / "learned_cells.json"
TRAINED = sorted((ROOT / "examples").glob("*.yaml"))


@pytest.fixture(scope="module")
def rows() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(STORED.read_text())["rows"]
    return found


def test_every_example_cell_was_trained_with_five_seeds_against_a_proven_optimum(
    rows: list[dict[str, Any]],
) -> None:
    assert {row["cell"] for row in rows} == {path.stem for path in TRAINED}
    assert all(row["proven"] and len(row["seeds"]) == 5 for row in rows)


def test_nothing_learned_is_better_than_exact_and_little_of_it_is_worse(
    rows: list[dict[str, Any]],
) -> None:
    for row in rows:
        gaps = [seed["greedy"]["gap"] for seed in row["seeds"]]
        assert min(gaps) >= 0
        missed = row["cell"] in ("alternator", "crew", "washing-machine")
        assert max(gaps) == 0 or (missed and max(gaps) < 0.02)
        # one seed of five is behind the best rule there
        is_behind = (row["cell"], row["factor"]) == ("washing-machine", 0)
        assert is_behind or max(gaps) <= row["rule"]["gap"]


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


def by_turns(cell: Cell, schedule: Schedule) -> Episode:
    """The schedule as decisions: whoever is asked begins the next of its tasks that is its own as
    soon as it may, and waits till then.
    """
    names = Names.of(cell)
    arrays, order = names.arrays(), sorted(schedule)

    def decide(arrays: Arrays, shift: Shift) -> Array:
        who, begun = names.operators[int(shift.turn)], shift.state.way >= 0
        own = (
            row for row in order if who in row.operators and not begun[names.tasks.index(row.task)]
        )
        mask = world.legal_of(arrays, shift.mask, shift.turn)
        way = next((names.way(row.task, row.operators) for row in own), -1)
        return np.int32(way if way >= 0 and mask[way] else -1)

    return play_one(
        names,
        arrays,
        nominal_scenario(Draw.of(names, arrays), arrays),
        crew(arrays, compliant(arrays)),
        decide,
    )


AT_ONCE = [path for path in TRAINED if path.stem != "washing-machine"]
"""Examples whose exact plans begin every task as soon as its operators may. The washing machine's
is put off now and then, so that what follows comes in time; learners meet it all the same.
"""


@pytest.mark.parametrize("path", AT_ONCE, ids=lambda path: path.stem)
def test_the_decisions_that_a_learner_has_reach_every_point_of_the_exact_front(path: Path) -> None:
    """A gap that is left is the learner's, not the game's."""
    cell = tandem.load(path)
    for point in tandem.plan(cell, time_limit=30, seed=0):
        played = by_turns(cell, point.schedule)
        assert played.done
        assert played.makespan <= point.makespan
        assert played.stress == pytest.approx(point.stress)
