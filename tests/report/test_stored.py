"""A plan read back is the plan that was written, or a sentence about why it is not."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

import tandem
from tandem.errors import CellError, UnsoundScheduleError, UsageError
from tandem.files.load import dump
from tandem.plan.result import Front
from tandem.report import write
from tandem.report.stored import point_of, read_plan

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def front() -> Front:
    return tandem.plan(tandem.load(EXAMPLES / "thesis.yaml"), time_limit=None, workers=1)


def kept(front: Front, path: Path) -> Path:
    return write(front, path)


def test_a_plan_read_back_is_the_plan_that_was_written(front: Front, tmp_path: Path) -> None:
    plan = read_plan(kept(front, tmp_path / "plan.json"))
    assert plan.front.to_dict() == {**front.to_dict(), "wall_s": plan.front.to_dict()["wall_s"]}
    assert plan.cell == front.cell
    assert not plan.is_stale
    assert plan.made_for == front.cell.digest


def test_digests_tell_schedules_apart(front: Front) -> None:
    digests = [result.schedule.digest for result in front]
    assert len(set(digests)) == len(front)
    assert all(len(digest) == 12 and int(digest, 16) >= 0 for digest in digests)
    assert [row["digest"] for row in front.to_dict()["front"]] == digests


def test_a_plan_is_stale_once_the_cell_beside_it_has_changed(front: Front, tmp_path: Path) -> None:
    dump(front.cell, tmp_path / "cell.yaml")
    path = kept(replace(front, source="cell.yaml"), tmp_path / "plan.json")
    assert not read_plan(path).is_stale
    text = (tmp_path / "cell.yaml").read_text()
    (tmp_path / "cell.yaml").write_text(text.replace("robot: 9", "robot: 8"))
    plan = read_plan(path)
    assert plan.is_stale
    assert plan.cell == front.cell
    assert plan.changed == tandem.load(tmp_path / "cell.yaml")


def test_a_schedule_that_breaks_the_cell_is_refused(front: Front, tmp_path: Path) -> None:
    path = kept(front, tmp_path / "plan.json")
    document = json.loads(path.read_text())
    document["front"][0]["assignments"][0]["start"] += 1
    document["front"][1]["stress"] = 99
    path.write_text(json.dumps(document))
    with pytest.raises(UnsoundScheduleError) as refused:
        read_plan(path)
    assert "point 1" in str(refused.value)
    assert "point 2: is said to be worth" in str(refused.value)


@pytest.mark.parametrize("held", [None, [], {"format": 1}])
def test_a_plan_without_its_cell_needs_one_beside_it(
    front: Front, tmp_path: Path, held: object
) -> None:
    path = kept(front, tmp_path / "plan.json")
    path.write_text(json.dumps({**json.loads(path.read_text()), "cell_document": held}))
    with pytest.raises(CellError, match="cell"):
        read_plan(path)


def test_points_are_chosen_by_number_or_by_what_they_keep(front: Front) -> None:
    assert front.points == [(23, 7), (24, 3), (34, 2)]
    assert [point_of(front, point=n) for n in (1, 2, 3)] == [0, 1, 2]
    assert point_of(front) == 1
    assert point_of(front, makespan=33.9) == 1
    assert point_of(front, stress=6) == 1
    assert point_of(front, stress=7) == 0


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"point": 4}, "--point 4: the front has 3 points, counted from 1: (23 s, 7)"),
        ({"makespan": 22}, "--makespan 22: no point of the front keeps this"),
        ({"stress": 1}, "--stress 1: no point of the front keeps this"),
        ({"point": 1, "stress": 1}, "exclude each other"),
    ],
)
def test_a_point_that_is_not_there_is_said(
    front: Front, given: dict[str, float], said: str
) -> None:
    with pytest.raises(UsageError) as refused:
        point_of(front, **given)  # type: ignore[arg-type]
    assert said in str(refused.value)
