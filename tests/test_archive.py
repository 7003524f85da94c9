"""The archive of public cells: what is stored is whole, and the checker accepts every schedule."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from tests.benchmark_data import folder

from tandem.files.load import load
from tandem.plan.methods import plan

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))
import archive  # noqa: E402  the command beside the files
from public_sets import instances  # noqa: E402

FILES = sorted((BENCHMARKS / "archive").glob("*/*.json"))
HOW = {"seconds", "machine", "date", "version"}


def stored(path: Path) -> archive.Entry:
    """The file as it is."""
    return archive.Entry(**json.loads(path.read_text(encoding="utf-8")))


@pytest.fixture
def empty(tmp_path, monkeypatch) -> None:
    """An archive that holds nothing."""
    monkeypatch.setattr(archive, "HERE", tmp_path)


@pytest.fixture(scope="module")
def thesis():
    return load(Path(__file__).parents[1] / "examples" / "thesis.yaml")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_file_agrees_with_itself(path):
    entry = stored(path)
    assert (entry.set, entry.instance) == (path.parent.name, path.stem)
    assert entry.faults() == []
    assert entry.schedule is not None
    assert entry.bound is not None
    assert entry.schedule.keys() == {"makespan", "tasks", "by"} | HOW
    assert entry.bound.keys() == {"makespan", "by"} | HOW
    starts = [start for _, start in entry.schedule["tasks"].values()]
    assert min(starts) >= 0
    assert max(starts) < entry.upper


def test_there_is_an_archive():
    assert FILES


@pytest.mark.parametrize("name", sorted({path.parent.name for path in FILES}))
def test_the_checker_accepts_every_stored_schedule(name):
    there = {instance: path for instance, _, _, path in instances(folder(name))}
    for path in FILES:
        if path.parent.name == name:
            assert stored(path).faults(load(there[path.stem])) == [], path


def test_what_was_found_is_kept_and_read_back(empty, thesis):
    entry = archive.Entry("own", "thesis", thesis.digest)
    assert archive.work_on(entry, thesis, 20.0, 1)
    assert entry.proven
    assert entry.upper == 23
    again = archive.Entry.read("own", "thesis", thesis)
    assert again == entry
    assert again.faults(thesis) == []


def test_a_worse_schedule_and_a_lower_bound_change_nothing(thesis):
    entry = archive.Entry("own", "thesis", thesis.digest)
    quick = plan(thesis, minimize="makespan")[0].schedule
    gentle = plan(thesis, minimize="stress")[0].schedule
    entry.take_schedule(thesis, quick, {})
    entry.take_bound(20, "chain bound", {})
    before = replace(entry)
    entry.take_schedule(thesis, gentle, {})
    entry.take_bound(19, "load bound", {})
    assert entry == before


def test_a_schedule_that_breaks_its_cell_does_not_come_in(thesis):
    entry = archive.Entry("own", "thesis", thesis.digest)
    sound = plan(thesis, minimize="makespan")[0].schedule
    last = max(sound, key=lambda row: row.end)
    rushed = replace(
        sound,
        assignments=tuple(
            replace(row, start=0.0, end=row.end - row.start) if row is last else row
            for row in sound
        ),
    )
    entry.take_schedule(thesis, rushed, {})
    assert entry.schedule is None


def test_a_bound_above_a_checked_schedule_is_an_error(thesis):
    entry = archive.Entry("own", "thesis", thesis.digest)
    entry.take_schedule(thesis, plan(thesis, minimize="makespan")[0].schedule, {})
    with pytest.raises(archive.ContradictionError, match=r"proves 24 s, above .* 23 s"):
        entry.take_bound(24, "a guess", {})


def test_a_schedule_below_a_bound_is_an_error(thesis):
    entry = archive.Entry("own", "thesis", thesis.digest)
    entry.take_bound(24, "a guess", {})
    with pytest.raises(archive.ContradictionError, match="below the bound 24 s by a guess"):
        entry.take_schedule(thesis, plan(thesis, minimize="makespan")[0].schedule, {})


def test_a_file_of_another_cell_is_refused(empty, thesis):
    entry = archive.Entry("own", "thesis", thesis.digest)
    entry.take_schedule(thesis, plan(thesis, minimize="makespan")[0].schedule, {})
    replace(entry, digest="0" * 16).write()
    with pytest.raises(archive.ContradictionError, match="of a cell 0000"):
        archive.Entry.read("own", "thesis", thesis)


def test_a_file_that_was_changed_by_hand_is_refused(empty, thesis):
    entry = archive.Entry("own", "thesis", thesis.digest)
    entry.take_schedule(thesis, plan(thesis, minimize="makespan")[0].schedule, {})
    assert entry.schedule is not None
    entry.schedule["makespan"] = 22
    entry.write()
    with pytest.raises(archive.ContradictionError, match="its makespan is 23 and not 22"):
        archive.Entry.read("own", "thesis", thesis)


def test_work_that_is_interrupted_keeps_what_it_found(empty, thesis, monkeypatch):
    def stopped(*arguments, on_solution, **options):
        on_solution(archive.Progress((plan(thesis, minimize="makespan")[0],), 0.0, 0.0))
        raise KeyboardInterrupt

    monkeypatch.setattr(archive, "plan", stopped)
    entry = archive.Entry("own", "thesis", thesis.digest)
    assert not archive.work_on(entry, thesis, 20.0, 1)
    assert archive.Entry.read("own", "thesis", thesis).upper == 23
