"""The compiled search by insertion: what it reckons is what list scheduling gives, and what it
finds is sound and repeats.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, assume, given, reject, settings
from hypothesis import strategies as st
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.files.generators import layered
from tandem.plan import insertion, insertion_moves
from tandem.plan.door import Door
from tandem.plan.insertion import Insertion, knows
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.plan.rules import SPECS, build
from tandem.plan.starts import append, by_start, measures


def _search(cell: Cell, seed: int = 0) -> tuple[Insertion, tuple[tuple[int, int], ...]]:
    """A search that stands at a schedule by a rule, and that schedule."""
    instance = Instance.of(cell)
    layout = Layout.of(instance)
    if not knows(instance) or layout.impossible():
        reject()
    state = build(layout, SPECS["random"], Random(seed))
    if state is None:
        reject()
    search = Insertion(layout, insertion_moves, Random(seed))
    starts = tuple(state.starts())
    search.aim(1, 0, None, None)
    assert search.begin(starts)
    return search, starts


known = st.one_of(cells(min_tasks=3, rich=False), cells(min_tasks=3))
"""Most cells with every feature are left to stretches, so half of these have few."""
patient = settings(
    deadline=None, max_examples=60, suppress_health_check=[HealthCheck.filter_too_much]
)


@given(known, st.integers(0, 9))
@patient
def test_compiled_and_plain_list_scheduling_give_the_same_starts(cell: Cell, seed: int) -> None:
    search, starts = _search(cell, seed)
    layout = search.layout
    order, ways = by_start(layout.instance, starts), [way for way, _ in starts]
    plain = append(layout, order, ways)
    assert [start for _, start in plain] == search.walk.now.head.tolist()
    assert search.value == measures(layout.instance, plain)[0]


@given(known, st.integers(0, 99), st.sampled_from([(1, 0), (0, 1), (3, 2)]))
@patient
def test_what_insertion_finds_is_sound_and_worth_what_it_reckons(
    cell: Cell, seed: int, weights: tuple[int, int]
) -> None:
    search, starts = _search(cell, seed)
    instance = search.layout.instance
    door = Door(cell, instance, Question())
    assume(door.admit(starts) is not None)
    makespan, stress = measures(instance, starts)
    before = weights[0] * makespan + weights[1] * stress
    search.aim(*weights, makespan, stress)
    assert search.begin(starts)
    search.go(3000)
    admitted = door.admit(search.best())
    assert admitted is not None
    assert admitted.makespan <= makespan
    assert admitted.stress <= stress
    worth = weights[0] * admitted.makespan + weights[1] * admitted.stress
    assert worth == search.value <= before


def test_it_improves_what_rules_find() -> None:
    search, starts = _search(layered(60, 2, 2, seed=3))
    search.go(2_000_000)
    assert search.value < 0.95 * measures(search.layout.instance, starts)[0]


def test_the_same_seed_makes_the_same_search() -> None:
    found = []
    for _ in range(2):
        search, _ = _search(layered(40, 2, 2, seed=1))
        for _ in range(5):
            search.go(40_000)
        found.append(search.best())
    assert found[0] == found[1]


@pytest.mark.parametrize("minimize", ["makespan", "stress"])
def test_bounded_work_repeats_exactly_on_a_cell_that_is_searched(minimize: str) -> None:
    cell = layered(36, 1, 1, seed=5)
    one, other = (plan(cell, minimize=minimize, work=0.5, seed=2) for _ in range(2))
    assert [point.schedule for point in one] == [point.schedule for point in other]


def test_small_cells_load_no_compiler() -> None:
    code = (
        "import sys, tandem; from tandem.files.generators import layered;"
        "tandem.plan(layered(12, 1, 1, seed=0)); sys.exit('numba' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_without_the_compiler_stretches_do_the_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "tandem.plan.insertion_moves", None)
    monkeypatch.delattr("tandem.plan.insertion_moves")
    monkeypatch.setattr(insertion, "_loaded", [])
    monkeypatch.setattr(insertion, "_loading", [])
    front = plan(layered(34, 1, 1, seed=0), minimize="makespan", work=0.5)
    assert insertion.moves() is None
    assert not insertion.is_loading()
    assert len(front) == 1


def test_a_command_that_is_over_sooner_leaves_the_code_to_the_next(tmp_path: Path) -> None:
    code = (
        "from tandem.plan import insertion, insertion_moves;"
        "print(insertion_moves.is_kept()); insertion.load(); insertion._loading[0].join(2)"
    )
    kept = "from tandem.plan import insertion_moves; print(insertion_moves.is_kept())"

    def said(program: str) -> str:
        return subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()

    assert said(code) == "False"
    for _ in range(300):
        if list(tmp_path.rglob("insertion_moves.rounds-*.nbi")):
            break
        time.sleep(0.5)
    assert said(kept) == "True"
    # the same text with a newer date, as a checkout leaves it, is found again
    for index in tmp_path.rglob("*.nbi"):
        os.utime(index, (0, 0))
    loads = "from tandem.plan import insertion_moves as m; print(m.is_kept()); m.warm()"
    assert said(f"{loads}; print(m.is_kept())") == "False\nTrue"
