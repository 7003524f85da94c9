"""`tandem reproduce thesis`: the code of the long run at a size that fits here, and what its stored
result says.
"""

from __future__ import annotations

import json

import pytest

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

import tandem
from tandem.lab import other_cells
from tandem.lab.kinat2023 import experiment
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.kinat2023.recipe import THESIS
from tandem.lab.kinat2023.runs import FACTORS, PUBLISHED, VARIANTS, run_all, run_thesis
from tandem.lab.records import read_record
from tandem.learn.ppo.config import Stage
from tandem.learn.ppo.recipes import longer


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    folder = tmp_path_factory.mktemp("quick")
    return folder, experiment.reproduce(folder, quick=True)


def test_the_packaged_cell_is_the_example():
    assert thesis_cell().digest == tandem.load("examples/thesis.yaml").digest


def test_the_thesis_recipe_is_what_the_thesis_says():
    config = THESIS.config
    assert (
        config.horizon,
        config.clip,
        config.minibatch,
        config.epochs,
        config.gae,
        config.discount,
    ) == (512, 0.2, 128, 4, 0.95, 1.0)
    assert (config.environments, config.episode_limit, set(config.hidden), config.masked) == (
        1,
        1400,
        {256},
        False,
    )
    assert [
        (stage.episodes, stage.entropy, stage.learning_rate, stage.idle) for stage in config.stages
    ] == [
        (800, 0.7, 1e-4, -10.0),
        (500, 0.7, 1e-4, 0.0),
        (800, 0.01, 1e-4, 0.0),
    ]
    assert VARIANTS["thesis, rewards of table 5-2"].config.stages[0].idle == -11.0
    assert isinstance(longer(THESIS, 0.5).config.stages[0], Stage)
    assert [stage.episodes for stage in longer(THESIS, 0.5).config.stages] == [400, 250, 400]


def test_a_quick_run_fills_every_recipe_and_says_that_it_is_one(quick):
    folder, document = quick
    assert {row["variant"] for row in document["summary"]} == {"tandem", *VARIANTS}
    assert json.loads((folder / "thesis.json").read_text()) == json.loads(json.dumps(document))
    assert "quick run" in experiment.table(document)
    assert document["exact_front"] == [[23, 7], [24, 3], [34, 2]]


def test_dynamic_programming_explains_the_published_table_with_the_appendix_only(quick):
    pairs = quick[1]["return_optimal"]
    assert pairs["appendix"] == {"0": [[23, 7], [23, 17]], "1": [[23, 7]], "5": [[24, 3]]}
    assert all(list(PUBLISHED[factor]) in pairs["appendix"][str(factor)] for factor in FACTORS)
    assert pairs["table_5_2"]["1"] == [[24, 3]]


def test_the_figures_are_drawn(quick, tmp_path):
    files = experiment.draw_figures(quick[1], tmp_path)
    assert {f"figure-6-{number}.svg" for number in (1, 2, 3, 5, 7)} <= {file.name for file in files}
    assert all(file.stat().st_size > 2000 for file in files)


def test_runs_that_have_a_record_are_not_run_again(tmp_path, monkeypatch):
    calls = []
    monkeypatch.setattr(
        "tandem.lab.kinat2023.runs.run_thesis",
        lambda *arguments: calls.append(arguments) or {"seed": arguments[2]},
    )
    first = list(run_all(tmp_path, ["thesis"], range(2), factors=(0, 5)))
    assert calls == [("thesis", 0, 0), ("thesis", 5, 0), ("thesis", 0, 1), ("thesis", 5, 1)]
    assert list(run_all(tmp_path, ["thesis"], range(2), factors=(0, 5))) == first
    assert len(calls) == 4
    assert [read_record(file)["seed"] for file in first] == [0, 0, 1, 1]


def test_a_run_repeats_for_its_seed():
    recipe = longer(THESIS, 0.004)
    first, again = (run_thesis("thesis", 1, 7, recipe, most_steps=4000) for _ in range(2))
    assert {**first, "cpu_s": 0} == {**again, "cpu_s": 0}
    assert first["episodes"] > 0


def test_the_interval_of_a_share_is_wilsons():
    """Values of Wilson (1927) as any statistics package gives them."""
    assert experiment.wilson(0, 10) == [0.0, 0.2775]
    assert experiment.wilson(5, 10) == [0.2366, 0.7634]
    assert experiment.wilson(20, 20) == [0.8389, 1.0]


def test_the_stored_long_run_is_complete():
    document = experiment.stored()
    assert not document["quick"]
    rows = {(row["variant"], row["factor"]): row for row in document["summary"]}
    toolbox = ("thesis, toolbox defaults", 1)
    whole = [variant for variant in ("tandem", *VARIANTS) if variant != toolbox[0]]
    # a training of the toolbox's wide networks takes six times as long: factor 1, half the seeds
    assert set(rows) >= {(variant, factor) for variant in whole for factor in FACTORS} | {toolbox}
    assert rows[toolbox]["seeds"] >= 5
    assert all(
        rows[variant, factor]["seeds"] >= (20 if variant == "tandem" else 10)
        for variant in whole
        for factor in FACTORS
    )
    assert {run["factor"] for run in document["watched"]} == set(FACTORS)
    assert all(
        rows["tandem", factor]["greedy"]["return_optimal"]["count"] == 20 for factor in FACTORS
    )
    again = experiment.assemble(document["records"])
    assert again["summary"] == document["summary"]
    assert again["return_optimal"] == document["return_optimal"]


def test_the_stored_result_on_other_cells_holds_random_ones_and_case_studies():
    rows = other_cells.stored()["rows"]
    assert sum(row["cell"].startswith("random 12 tasks") for row in rows) >= 1
    assert any("pearce" in row["cell"] for row in rows)
    for row in rows:
        assert row["exact_front_complete"]
        assert len(row["gaps"]) == 10
        assert row["optimal"] == sum(gap == 0 for gap in row["gaps"])
        assert other_cells.line(row).startswith(row["cell"])


def test_what_a_case_study_has_that_the_station_has_not_is_left_out_and_said():
    cell = thesis_cell().replace(same_operator=[["1", "2"]])
    fitted, left_out = other_cells.fitted(cell)
    assert left_out == "same_operator"
    assert fitted.same_operator == ()
    assert other_cells.fitted(thesis_cell())[1] == ""
