"""Recipes of games of turns through the one trainer: they learn what is known to be best, and a
stop changes nothing.
"""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import jax
import pytest
from click.testing import CliRunner
from safetensors.numpy import load_file
from tests.learn import tiny
from tests.learn.short_runs import SEARCHED_FACTOR, held_after, run_once, with_every_interval

import tandem
from tandem.cli.learn import evaluate_command
from tandem.errors import CellError, UsageError
from tandem.lab.yu2020.board import random_board
from tandem.lab.yu2020.config import YuConfig, YuSearch
from tandem.lab.yu2020.recipe import YuRecipe
from tandem.learn.algorithm import TrainingOrder
from tandem.learn.alphazero.recipes import SearchRecipe
from tandem.learn.dqn.config import Config as DqnConfig
from tandem.learn.dqn.recipes import ValueRecipe
from tandem.learn.training import trainer
from tandem.learn.training.algorithms import algorithm
from tandem.learn.training.recipes import RECIPES, changed, recipe_from
from tandem.learn.training.runs import RunFolder

THREE = tandem.Cell.model_validate(
    {
        "name": "two robots and a human",
        "operators": {"r": {"kind": "robot"}, "s": {"kind": "robot"}, "h": {"kind": "human"}},
        "tasks": {
            "a": {"time": {"r": 2, "s": 3}},
            "b": {"time": {"h": 4}, "stress": 1},
            "c": {"time": {"s": 1, "h": 2}, "after": ["a"]},
            "d": {"together": [{"operators": ["r", "h"], "time": 2}], "after": ["b"]},
        },
    }
)
"""b, then d, take 6 s at least; who gives c to the human first takes longer."""

BOARD = random_board(4, 4, 2, 3, 3, 5, seed=1).to_cell()

SMALL = {
    "yu": (
        BOARD,
        0.0,
        YuRecipe(
            YuConfig(YuSearch(4, 2, temperature=1000.0), outer=1, inner=2, switch=10, dense=8),
            samples=4,
        ),
    ),
    "dqn": (
        THREE,
        0.0,
        ValueRecipe(
            DqnConfig(
                4800, games=8, kept=1024, minibatch=32, warm_up=10, target_every=20, units=16
            ),
            samples=4,
        ),
    ),
}


@pytest.fixture(scope="module", params=["alphazero", *SMALL])
def whole(request, tmp_path_factory, shared_folder):
    """A run that nothing stopped: what was asked, its folder, its document. Beside it is kept what
    the folder held after each interval.
    """
    if request.param not in SMALL:
        options = {"recipe_name": request.param, "stress_factor": SEARCHED_FACTOR}
        return tandem.load(tiny.CELL), options, *run_once(shared_folder, request.param)
    cell, factor, recipe = SMALL[request.param]
    folder = tmp_path_factory.mktemp(request.param) / "run"
    options = {"own_recipe": recipe, "recipe_name": request.param, "stress_factor": factor}
    return cell, options, folder, with_every_interval(folder, cell, **options)


def test_what_is_learned_is_held_against_the_exact_front(whole):
    _, options, folder, document = whole
    best = min(
        10 * makespan + options["stress_factor"] * stress
        for makespan, stress in document["exact_front"]
    )
    for seed in document["seeds"]:
        played = [seed[name] for name in ("greedy", "searched", "best_of_n") if name in seed]
        for one in played:
            assert one["gap"] == pytest.approx(
                (10 * one["makespan"] + options["stress_factor"] * one["stress"] - best) / best,
                abs=1e-6,
            )
        assert min(one["gap"] for one in played) == 0 or options["recipe_name"] == "yu"
        assert played[-1]["gap"] <= 0.1
    rows = RunFolder(folder).rows()
    assert {"greedy_makespan", "gap", "mean_return_team", "episodes", "steps"} <= rows[0].keys()
    assert json.loads((folder / "result.json").read_text()) == json.loads(json.dumps(document))


def test_a_stop_changes_nothing(whole, tmp_path):
    """The power fails, then Ctrl-C an interval after --resume, then --resume: checkpoint, policies
    and figures are the same to the bit. The stops are near the end: what lies before need not be
    trained again.
    """
    folder = whole[2]
    begun = max(1, RunFolder(folder).rows()[-1]["interval"] - 2)
    shutil.copytree(held_after(folder, begun), tmp_path / "stopped")

    def stop(progress):
        if progress.rows[0]["interval"] == begun + 1:
            raise KeyboardInterrupt

    assert trainer.resume(tmp_path / "stopped", on_progress=stop)["interrupted"]
    assert not trainer.resume(tmp_path / "stopped")["interrupted"]
    for name in ("checkpoint.safetensors", "policy-3.safetensors", "policy-4.safetensors"):
        ours, theirs = load_file(tmp_path / "stopped" / name), load_file(folder / name)
        assert ours.keys() == theirs.keys()
        assert all(ours[key].tobytes() == theirs[key].tobytes() for key in ours)
    assert RunFolder(tmp_path / "stopped").rows() == RunFolder(folder).rows()


def test_evaluate_plays_it_beside_rules_and_chance(whole, tmp_path):
    _, _, folder, document = whole
    asked = [str(folder), "--episodes", "4", "--json", "--curves", str(tmp_path / "c.svg")]
    done = CliRunner().invoke(evaluate_command, asked, catch_exceptions=False)
    told = json.loads(done.stdout)
    lines = {line["player"]: line for line in told["players"]}
    assert told["exact_front"] == document["exact_front"]
    assert {"greedy", "sampled", "random"} <= lines.keys()
    mine = next(row for row in document["seeds"] if row["seed"] == told["seed"])
    assert lines["greedy"]["makespan"] == mine["greedy"]["makespan"]
    assert lines["greedy"]["gap"] == min(row["greedy"]["gap"] for row in document["seeds"])
    assert lines["greedy"]["faults"] == []
    assert lines["greedy"]["assignments"]
    assert "team" in (tmp_path / "c.svg").read_text()


def test_the_board_refuses_what_it_cannot_hold(tmp_path):
    with pytest.raises(CellError, match="chessboard"):
        trainer.train(THREE, recipe_name="yu2020", folder=tmp_path / "run")
    with pytest.raises(UsageError, match="knows time only"):
        trainer.train(BOARD, recipe_name="yu2020", stress_factor=1.0, folder=tmp_path / "run")


@pytest.mark.parametrize("name", RECIPES)
def test_a_recipe_comes_back_from_what_a_run_writes_down(name):
    recipe = RECIPES[name]
    assert recipe_from(recipe.algorithm, json.loads(json.dumps(recipe.to_dict()))) == recipe


def test_settings_of_a_recipe_are_changed_by_name_and_faults_come_all_at_once():
    recipe = changed(
        RECIPES["alphazero"],
        [
            "waiting=false",
            "config.search.simulations=64",
            "config.search.kind=puct",
            "config.search.depth=3",
        ],
    )
    assert isinstance(recipe, SearchRecipe)
    plain = RECIPES["alphazero"]
    search = replace(plain.config.search, kind="puct", simulations=64, depth=3)
    assert recipe == replace(plain, waiting=False, config=replace(plain.config, search=search))
    with pytest.raises(
        UsageError,
        match=r"(?s)--set x=3: .*has no such setting.*--set waiting 3: must be true or false",
    ):
        changed(RECIPES["alphazero"], ["x=3", "waiting=3"])


@pytest.mark.parametrize("name", ["alphazero", "dqn", "tandem", "response", "station", "yu2020"])
def test_a_training_begins_in_the_form_in_which_it_goes_on(name):
    """What begins in a weak type goes on in a strong one, and all is compiled a second time."""
    cell = BOARD if name == "yu2020" else tandem.load(tiny.CELL)
    trainee = algorithm(TrainingOrder(cell, RECIPES[name], name))
    assert not [leaf for leaf in jax.tree.leaves(jax.eval_shape(trainee.begin)) if leaf.weak_type]
