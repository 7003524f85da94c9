"""What a plan by the policy for any cell says of itself: how sure it was, and what is new to it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import tandem
from tandem.cell.model import Cell
from tandem.cli.root import run as command
from tandem.files.generators import layered
from tandem.learn.graph.drawing import Drawing
from tandem.learn.graph.familiar import FACTS, SEEN, beyond, facts, seen
from tandem.learn.graph.labels import layout_of
from tandem.learn.graph.making import Maker
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.training_cells import training_cell
from tandem.learn.graph.weights import shipped
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.report.language import words
from tandem.report.stored import read_plan
from tandem.report.terminal import remarks

FILE = Path(tandem.learn.__file__ or "").parent / "graph" / SEEN


def layout(cell: Cell) -> Layout:
    return Layout.of(Instance.of(cell))


def test_what_was_seen_is_counted_over_the_cells_that_are_trained_on() -> None:
    """Else `benchmarks/graph_seen.py` has to run anew."""
    pytest.importorskip("jax", reason="training needs the extra tandem[learn]")
    from tandem.learn.graph.training import Config

    kept = json.loads(FILE.read_text())
    assert kept["most_tasks"] == Config().most_tasks
    assert set(seen()) == set(FACTS)
    for number in range(40):
        assert beyond(layout_of(training_cell(number, kept["most_tasks"]))) == ()


def test_what_is_new_is_told_with_what_was_seen() -> None:
    (tasks, *others) = beyond(layout(layered(400, seed=0)))
    assert (tasks.what, tasks.value) == ("tasks", 400)
    assert tasks.most == seen()["tasks"][1] < 400
    assert "breaks" not in {one.what for one in others}
    gearbox = {one.what: one for one in beyond(layout(tandem.load("examples/gearbox.yaml")))}
    assert (gearbox["breaks"].value, gearbox["breaks"].most) == (1, 0)
    assert gearbox.keys() >= {"breaks", "deadlines", "releases"}


def test_the_numbers_of_a_cell_are_ratios_or_counts() -> None:
    """Worked out by hand: two tasks in a row, one of which two can do."""
    data = {
        "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
        "tasks": {
            "grease": {"time": {"anna": 4, "cobot": 8}},
            "press": {"time": {"cobot": 12}, "after": ["grease"]},
        },
    }
    found = facts(layout(Cell.model_validate({"format": 1, **data})))
    assert {name: number for name, number in found.items() if number} == {
        "tasks": 2,
        "operators": 2,
        "tasks_per_operator": 1,
        "ways_per_task": 1.5,
        "slowest_way": 1.5,  # of 2 and 1
        "longest_task": 1.5,  # 12 of a mean of 8
        "chain": 2,  # 16 of an even share of 8
    }


@pytest.mark.parametrize("seed", range(3))
def test_a_chance_is_that_of_the_best_of_the_choices(seed: int) -> None:
    maker = Maker.of(shipped(), Outlook.of(layout(layered(12, seed=seed)), 0.0))
    state, chance = Drawing.of(maker, np.random.default_rng(0)).greedy()
    alone = maker.build()
    assert state is not None
    assert alone is not None
    assert state.starts() == alone.starts()
    assert chance is not None
    assert 1 / 48 <= chance <= 1


def test_where_nothing_is_to_choose_there_is_no_chance() -> None:
    data = {
        "operators": {"anna": {"kind": "human"}},
        "tasks": {"grease": {"time": {"anna": 4}}, "press": {"time": {"anna": 1}, "after": []}},
    }
    data["tasks"]["press"]["after"] = ["grease"]  # type: ignore[index]
    front = tandem.plan(Cell.model_validate({"format": 1, **data}), method="learned")
    assert front.confidence is not None
    assert front.confidence.chance is None
    assert not [line for line in remarks(front) if "chance" in line]


def test_a_plan_says_it_and_what_is_kept_says_it_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = ["plan", "examples/gearbox.yaml", "--method", "learned", "--samples", "2", "-q"]
    assert command([*asked, "-o", str(tmp_path / "plan.json")]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "unlike those it learned on: breaks, deadlines" in said
    document = json.loads((tmp_path / "plan.json").read_text())
    assert [one["what"] for one in document["confidence"]["beyond"]][:2] == ["breaks", "deadlines"]
    again = read_plan(tmp_path / "plan.json").front
    assert again.confidence is not None
    assert again.confidence.to_dict() == document["confidence"]
    assert any(
        "anders als die, an denen es lernte: Pausen" in line for line in remarks(again, "de")
    )


def test_other_methods_say_nothing_of_it() -> None:
    front = tandem.plan(layered(8, seed=0), method="spt")
    assert front.confidence is None
    assert "confidence" not in front.to_dict()


@pytest.mark.parametrize("language", ["en", "de"])
def test_every_number_has_its_words(language: str) -> None:
    t = words(language)
    for name in FACTS:
        assert t(f"terminal.beyond.{name}", value="1", seen="0")


def test_time_that_runs_out_leaves_a_schedule() -> None:
    front = tandem.plan(layered(60, seed=1), method="learned", time_limit=1e-9)
    assert len(front) == 1
    assert front.ended_by == "time"
    assert "learned" not in front.solver
    assert front.confidence is not None
    assert front.confidence.chance is None
