"""Yu, Huang and Chang 2021: the instances are the desk with more agents, and what is stored says
what it holds.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.lab.changed_records import refuses_changed_records

import tandem
from tandem.errors import CellError
from tandem.lab.systems import SYSTEMS
from tandem.lab.yu2020.board import desk
from tandem.lab.yu2021 import experiment

STORED = Path(experiment.__file__).parent / "results.json"

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")


def test_with_one_robot_and_one_human_the_instance_is_the_lower_desk():
    cell = experiment.Instance(3, 1, 1).cell()
    whole = desk().to_cell()
    assert (
        list(cell.tasks)
        == [name for name in whole.tasks if name in cell.tasks]
        == ["A1", "A2", "A3", "A4", "A5", "A6", "B1", "B2", "B3", "B4"]
    )
    for name, task in cell.tasks.items():
        assert sorted(task.time.values()) == sorted(whole.tasks[name].time.values())
        assert task.after == whole.tasks[name].after


def test_more_agents_are_never_slower_and_each_can_do_what_one_could():
    two, four = (
        tandem.plan(experiment.Instance(3, robots, humans).cell(), minimize="makespan").points[0][0]
        for robots, humans in ((1, 1), (2, 2))
    )
    assert four < two
    cell = experiment.Instance(4, 2, 2).cell()
    assert set(cell.tasks["A1"].time) == {"robot 1", "robot 2"}
    assert set(cell.tasks["C1"].time) == set(cell.operators)


def test_the_recipes_differ_in_what_their_names_say_and_have_one_budget():
    known = experiment.recipes(960, 24)
    described, single, ours = (
        known[name].config for name in ("as described", "one network for all", "ours")
    )
    assert (described.agents, single.agents) == ("each", "one")
    assert described.decisions == single.decisions == 960 * 24
    assert ours.iterations * ours.games == 960


@pytest.mark.slow
def test_a_short_run_of_the_same_code(tmp_path, tmp_path_factory, monkeypatch, capfd):
    from tandem.learn.training import trainer

    monkeypatch.setattr(
        experiment,
        "recipes",
        lambda *budget, all_=experiment.recipes: {"ours": all_(*budget)["ours"]},
    )

    def stopped(*order, train=trainer.train, **more):
        def stop(_):
            raise KeyboardInterrupt

        return train(*order, on_progress=stop, **more)

    with monkeypatch.context() as once:
        once.setattr(trainer, "train", stopped)
        with pytest.raises(KeyboardInterrupt):
            experiment.reproduce(tmp_path, quick=True)
    assert not (tmp_path / experiment.STORED).exists()
    document = experiment.reproduce(tmp_path, quick=True)
    check(document)
    assert document["rows"][0]["learned"]["ours"]["curve"][0][-1][0] >= experiment.QUICK_GAMES, (
        "the training was gone on with to its end"
    )
    assert "| published |" in experiment.table(document)
    assert all(file.exists() for file in experiment.draw_figures(document, tmp_path))
    assert experiment.reproduce(tmp_path, quick=True)["rows"] == document["rows"], (
        "kept runs are not made again"
    )
    refuses_changed_records(
        ["reproduce", "yu2021", "--quick"], tmp_path, tmp_path_factory.mktemp("changed"), capfd
    )


def check(document):
    """What holds for every document."""
    for row in document["rows"]:
        assert row["exact"] >= row["bound"] - 1e-9
        assert row["exact"] <= row["rule"]["makespan"]
        assert row["exact"] <= row["random"]["best"] <= row["random"]["mean"]
        for learned in row["learned"].values():
            assert len(learned["greedy"]) == len(document["seeds"])
            assert all(
                row["exact"] <= value
                for value in [*learned["greedy"], *learned["best_of_n"]]
                if value is not None
            )


@pytest.mark.skipif(not STORED.is_file(), reason="the long run has not been stored yet")
def test_the_stored_run_is_consistent_and_its_table_can_be_printed():
    document = experiment.stored()
    assert not document["quick"]
    check(document)
    assert [row["instance"] for row in document["rows"]] == [
        instance.name for instance in experiment.INSTANCES
    ]
    assert document["command"] == "tandem reproduce yu2021"
    table = experiment.table(document)
    assert table.count("not public") == len(document["rows"])
    assert "yu2021" in SYSTEMS


def test_a_run_folder_of_other_seeds_is_not_taken_for_this_one(tmp_path):
    from tandem.learn.training.runs import RunFolder

    cell = experiment.Instance(3, 2, 1).cell()
    run = RunFolder(tmp_path / "records" / "desk-3-rows-2-robots-1-human-ours-1")
    recipe = experiment.recipes(64, len(cell.tasks))["ours"]
    asked = {
        "cell": cell.to_dict(),
        "recipe": "yu2021",
        "algorithm": "alphazero",
        "settings": recipe.to_dict(),
    }
    run.begin({**asked, "seeds": [7], "stress_factor": 0.0, "front_limit": 1.0})
    with pytest.raises(
        CellError, match="ours-1: holds a training of another cell or of other seeds"
    ):
        experiment._learned(cell, recipe, [0], run)
