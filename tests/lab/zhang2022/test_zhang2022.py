"""`tandem reproduce zhang2022`: the code of the long run at a size that fits here, and what its
stored result says.
"""

from __future__ import annotations

import json
from typing import Any

import pytest

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

import tandem
from tandem.errors import CellError
from tandem.files.validate import cell_of
from tandem.lab.zhang2022 import experiment
from tandem.lab.zhang2022.display import episode, lines, shown
from tandem.lab.zhang2022.play import play_on
from tandem.lab.zhang2022.runs import ARMS, FACTORS, OURS, Arm, Size, alternator, run
from tandem.lab.zhang2022.summary import summary
from tandem.lab.zhang2022.yardstick import exact_front
from tandem.schedule.checker import faults
from tandem.schedule.measures import difficulty, makespan
from tandem.schedule.model import Schedule

TINY = Size(seeds=1, steps=1600, noisy=5, changed=12, sampled=1)


@pytest.fixture(scope="module")
def stored() -> dict[str, Any]:
    return experiment.stored()


@pytest.fixture(scope="module")
def short(stored: dict[str, Any]) -> list[dict[str, Any]]:
    """Our recipe with and without changes in training, a thirtieth as long."""
    front = [tuple(point) for point in stored["exact_front"]]
    return run(
        alternator(),
        [Arm("ours", False, factors=FACTORS), Arm("ours", False, 0.5)],
        TINY,
        front,
        lambda _: None,
    )


def test_the_packaged_cell_is_the_example_and_says_that_it_is_an_assumption() -> None:
    cell = alternator()
    assert cell.digest == tandem.load("examples/alternator.yaml").digest
    assert "ASSUMPTION" in cell.name
    assert 12 <= len(cell.tasks) <= 16


def test_a_short_run_finishes_every_episode_and_never_beats_the_front(
    short: list[dict[str, Any]],
) -> None:
    assert [(row["changes"], row["factor"]) for row in short] == [(0, 1), (0, 4), (0.5, 1)]
    for row in short:
        assert row["greedy"]["finished"]
        assert row["greedy"]["gap"] >= 0
        assert row["greedy"]["beyond"] >= 0
        assert row["noisy"]["finished"] == 1
        assert row["changed"]["finished"] == row["changed"]["episodes"] == 12
        assert sum(row["changed"]["kinds"]) == 12
        assert all(loss > -1e-4 for loss in row["changed"]["losses"])


def test_what_was_done_replays_to_what_was_paid(short: list[dict[str, Any]]) -> None:
    for row in short:
        played = episode(alternator(), row["greedy"]["action"]).schedule
        assert faults(alternator(), played) == []
        assert makespan(played) == row["greedy"]["makespan"]
        assert difficulty(alternator(), played) == row["greedy"]["difficulty"]


def test_the_document_of_a_short_run_is_shown_and_drawn(
    short: list[dict[str, Any]], stored: dict[str, Any], tmp_path: Any
) -> None:
    chance = [stored["random"][f"{factor:g}"] for factor in FACTORS]
    document = experiment.assemble(
        short, alternator(), stored["exact_front"], True, chance, quick=True, seeds=1
    )
    document["other_cells"] = stored["other_cells"]
    text = experiment.table(json.loads(json.dumps(document)))
    for words in (
        "not public",
        "quick run",
        "exact: the front's matching point",
        "random player",
        "What the human is shown",
        "now: ",
    ):
        assert words in text
    files = experiment.draw_figures(document, tmp_path)
    assert {"front.svg", "noise.png", "recovery.svg", "curves.svg", "schedule.svg"} <= {
        file.name for file in files
    }
    assert all(file.stat().st_size > 2000 for file in files)


# --- What the human is shown ---


def test_the_display_says_what_to_do_now_and_next() -> None:
    cell = cell_of(
        {
            "operators": {"robot": {"kind": "robot"}, "ann": {"kind": "human"}},
            "tasks": {
                "a": {"time": {"ann": 4}, "tool": "press"},
                "b": {"together": [{"operators": ["robot", "ann"], "time": 3}], "after": ["c"]},
                "c": {"time": {"robot": 6}},
            },
        }
    )
    front = exact_front(cell)
    rows = shown(cell, front[0].schedule)
    assert rows[0]["ann"]["now"] == {"task": "a", "with": [], "tool": "press", "start": 0, "end": 4}
    assert [line.split("s  ", 1)[1] for line in lines(cell, rows)] == [
        "now: a, press (until 4 s); next: b with robot (at 6 s)",
        "now: wait; next: b with robot (at 6 s)",
        "now: b with robot (until 9 s); next: nothing more",
    ]
    assert lines(cell, rows, "robot")[0].endswith("now: c (until 6 s); next: b with ann (at 6 s)")


# --- Other cells ---


def test_it_runs_on_the_thesis_cell_and_plays_it_to_the_end() -> None:
    cell = tandem.load("examples/thesis.yaml")
    assert experiment.runs_on(cell).arrays.release.shape == (7,)
    played = play_on(cell, seed=0)
    assert played.makespan is not None
    assert played.makespan >= 23
    assert played.deviations == 0
    assert len(played.decisions_ms) >= 4
    assert play_on(cell, seed=0, deviates=1.0).deviations > 0


def test_it_refuses_a_cell_by_the_features_that_it_cannot_express() -> None:
    with pytest.raises(CellError, match="1 robot and 2 humans"):
        experiment.runs_on(tandem.load("examples/gearbox.yaml"))


def test_the_laboratory_can_ask_it(stored: dict[str, Any]) -> None:
    features, cell = experiment.FEATURES, tandem.load("examples/thesis.yaml")
    assert features.agents() == ("robot_0", "human_0")
    assert features.cost(cell) == 24 + 3
    assert features.exact is not None
    assert list(features.exact(stored)[:2]) == stored["exact_front"][0]


# --- The stored long run ---


def test_the_stored_front_is_the_exact_one(stored: dict[str, Any]) -> None:
    front = exact_front(alternator())
    assert front.complete
    assert stored["exact_front_complete"]
    assert [tuple(point) for point in stored["exact_front"]] == front.points


def test_the_stored_long_run_shows_what_the_issue_asks_for(stored: dict[str, Any]) -> None:
    assert not stored["quick"]
    assert stored["seeds"] == list(range(10))
    assert {(row["arm"], row["factor"]) for row in stored["records"]} == {
        (arm.name, factor) for arm in ARMS for factor in arm.factors
    }
    for row in stored["summary"]:
        assert row["seeds"] == row["finished"] == 10
        if row["arm"].startswith("ours"):
            assert row["gap"]["mean"] + row["gap"]["ci95"] < 0.05, (
                "over ten seeds within 5 % of the front's matching point, with noise and without"
            )
        assert row["changed_episodes"] == row["changed_finished"] == 1000
    assert all(max(row["gaps"]) <= 0.05 for row in stored["other_cells"])


def test_the_stored_summary_follows_from_the_records_and_they_replay(
    stored: dict[str, Any],
) -> None:
    optimum = {
        float(factor): point[0] + float(factor) * point[1]
        for factor, point in stored["matching"].items()
    }
    assert json.loads(json.dumps(summary(stored["records"], optimum))) == stored["summary"]
    for row in stored["records"]:
        if row["seed"] == 0:
            played = episode(alternator(), row["greedy"]["action"]).schedule
            assert (makespan(played), difficulty(alternator(), played)) == (
                row["greedy"]["makespan"],
                row["greedy"]["difficulty"],
            )
    assert faults(alternator(), Schedule.from_list(stored["display"]["assignments"])) == []
    assert OURS.to_dict()["ahead"] == 4
