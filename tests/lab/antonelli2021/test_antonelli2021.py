"""`tandem reproduce antonelli2021`: a run that fits here, and what the stored one says."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

from tests.lab.changed_records import refuses_changed_records

from tandem.lab.antonelli2021 import experiment
from tandem.lab.antonelli2021.markov import policy_values, reaching_states, value_iteration
from tandem.lab.kinat2023.game import thesis_cell

SHORTER = {
    "CHANCES": (0.0, 0.3, 0.1, 0.2, 0.3),
    "TRAINED_AT": (0.0,),
    "PRECISE": replace(experiment.PRECISE, steps=200_000),
}


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """A quick run, smaller still: one seed, the own cell, one p of training. Its settings are
    shared so that little is compiled.
    """
    folder = tmp_path_factory.mktemp("antonelli")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(experiment, "cells", lambda: {"flanges": experiment.own_cell()})
        for name, value in SHORTER.items():
            patch.setattr(experiment, name, value)
        return folder, experiment.reproduce(folder, quick=True, seeds=1)


def test_a_short_run_fills_every_player_and_says_that_it_is_one(short):
    folder, document = short
    found = document["cells"]["flanges"]
    assert {row["player"] for row in found["players"]} == {"as described, trained at p = 0", "ours"}
    assert found["states"] == found["with_a_way_to_the_goal"] == 81
    assert json.loads((folder / "antonelli2021.json").read_text()) == json.loads(
        json.dumps(document)
    )
    text = experiment.table(document)
    assert "quick run" in text
    assert "not public" in text
    assert "81 states, 71 of them with a part that sits wrongly" in text


def test_a_changed_record_stops_the_reproduction(short, tmp_path, capfd, monkeypatch):
    monkeypatch.setattr(experiment, "cells", lambda: {"flanges": experiment.own_cell()})
    for name, value in SHORTER.items():
        monkeypatch.setattr(experiment, name, value)
    refuses_changed_records(
        ["reproduce", "antonelli2021", "--quick", "--seeds", "1"], short[0], tmp_path, capfd
    )


def test_planner_and_value_iteration_agree_on_a_human_who_makes_no_mistakes(short):
    found = short[1]["cells"]["flanges"]
    assert found["planned_one_at_a_time"] == found["exact"][0]["expected_s"] == 76
    thesis = thesis_cell()
    assert value_iteration(experiment.runs_on(thesis).process(0.0)).values[0] == 35
    assert (
        min(mode.time for task in thesis.tasks for mode in experiment.joint(thesis).modes(task))
        == 2
    )


def test_what_was_trained_without_mistakes_does_not_know_what_to_do_with_them_and_ours_does(short):
    rows = {(row["player"], row["p"]): row for row in short[1]["cells"]["flanges"]["players"]}
    exact = short[1]["cells"]["flanges"]["exact"][-1]["expected_s"]
    nominal, ours = rows["as described, trained at p = 0", 0.3], rows["ours", 0.3]
    assert max(nominal["reaches_as_asked"]) < 1.0
    assert min(ours["reaches_as_asked"]) == 1.0
    assert min(ours["finished_from_anywhere"]) > 0.99
    assert all(value is None or value > exact * 1.05 for value in nominal["expected_s"])
    assert all(exact - 1e-3 <= value < exact * 1.05 for value in ours["expected_s"])


def test_seven_tasks_are_learned_exactly(short):
    """The thesis's cell without slips: 547 states, 100,000 updates; 0.15 s on a core of its own."""
    speed = short[1]["speed"]
    assert speed["updates"] == 100_000
    assert speed["error_s"] < 1e-3


def test_even_draws_come_nearest(short):
    last = {row["way"]: row["error_s"][-1] for row in short[1]["precision"]}
    assert last["rounds, even draws"] < last["rounds, independent draws"] / 3
    assert set(last) == {
        "episodes",
        "rounds, independent draws",
        "rounds, even draws",
        "rounds, even draws, single precision",
    }


def test_the_figures_are_drawn(short, tmp_path):
    files = experiment.draw_figures(short[1], tmp_path)
    assert {"product.svg", "time-flanges.svg", "reached-flanges.png", "precision.svg"} <= {
        file.name for file in files
    }
    assert all(file.stat().st_size > 2000 for file in files)


def test_an_episode_takes_apart_what_was_mounted_wrongly():
    played = [experiment.episode(experiment.own_cell(), seed, p=0.3) for seed in range(3)]
    assert all(one.makespan is not None and one.makespan >= 76 for one in played)
    assert sum(one.undone for one in played) > 0
    assert sum(one.deviations for one in played) > 0
    assert experiment.episode(experiment.own_cell(), 0, p=0.0).makespan == 76


def test_the_stored_long_run_holds_what_the_page_says():
    document = experiment.stored()
    assert not document["quick"]
    assert len(document["seeds"]) >= 10
    assert set(document["cells"]) == {"flanges", "thesis"}
    for name, cell in experiment.cells().items():
        world, found = experiment.runs_on(cell), document["cells"][name]
        assert found["states"] == len(world.nodes) == found["with_a_way_to_the_goal"]
        assert [row["p"] for row in found["exact"]] == list(experiment.CHANCES)
        for row in found["exact"]:
            exact = value_iteration(world.process(row["p"]))
            assert row["expected_s"] == pytest.approx(exact.values[0], abs=1e-5)
            assert row["sure"] == row["reaches_as_asked"] == found["states"]
            assert policy_values(world.process(row["p"]), exact.policy)[0] == pytest.approx(
                exact.values[0]
            )
            assert reaching_states(world.process(row["p"]), exact.policy).all()
        assert found["exact"][0]["expected_s"] == found["planned_one_at_a_time"]
        for row in found["players"]:
            exact_s = next(
                exact["expected_s"] for exact in found["exact"] if exact["p"] == row["p"]
            )
            # nobody beats the exact policy
            assert all(value is None or value >= exact_s - 1e-3 for value in row["expected_s"])
        ours = [row for row in found["players"] if row["player"] == "ours"]
        assert np.min([row["reaches_as_asked"] for row in ours]) == 1.0
    best = {
        row["p"]: row["error_s"][-1]
        for row in document["precision"]
        if row["way"] == "rounds, even draws"
    }
    assert max(error for p, error in best.items() if p <= 0.3) < 1e-3
    assert document["speed"]["wall_s"] < 1.0


def test_the_best_rule_is_exact_without_slips_and_no_better_than_exact_with_them():
    world = experiment.runs_on(experiment.own_cell())
    for p in (0.0, 0.2):
        _, expected = experiment.best_rule_at(world, p)
        exact = float(value_iteration(world.process(p)).values[0])
        assert expected >= exact - 1e-6
        assert (abs(expected - exact) < 1e-6) == (p == 0)
    assert "| best rule |" in experiment.table(experiment.stored())
