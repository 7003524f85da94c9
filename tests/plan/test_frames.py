"""Fronts as tables of pandas."""

from __future__ import annotations

from pathlib import Path

import pytest

from tandem.files.load import load
from tandem.plan.methods import plan

THESIS = Path(__file__).resolve().parents[2] / "examples/thesis.yaml"


def test_a_front_as_a_table_has_its_points_or_all_their_tasks() -> None:
    pytest.importorskip("pandas", reason="needs pandas")
    front = plan(load(THESIS), method="exhaustive")
    assert front.to_frame()[["makespan", "stress"]].values.tolist() == [[23, 7], [24, 3], [34, 2]]
    frame = front.to_frame(tasks=True)
    assert len(frame) == 3 * 7
    for place, result in enumerate(front, 1):
        rows = frame[frame.point == place]
        assert rows.end.max() == result.makespan
        assert list(rows.task) == [one.task for one in result.schedule]
        assert list(rows.operators) == [" + ".join(one.operators) for one in result.schedule]


def test_an_empty_table_of_tasks_has_its_columns() -> None:
    pytest.importorskip("pandas", reason="needs pandas")
    from dataclasses import replace

    front = replace(plan(load(THESIS), method="spt"), results=())
    assert list(front.to_frame(tasks=True)) == [
        *("point", "makespan", "stress", "task", "operators", "start", "end")
    ]
