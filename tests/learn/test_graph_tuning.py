"""Tuning the policy for any cell to one's own: it learns, goes on to the bit, and what it writes is
taken wherever a policy is.
"""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tandem
from tandem.cli.root import run as command
from tandem.errors import CellError, UsageError
from tandem.files.generators import layered
from tandem.schedule.checker import faults

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

from tandem.dispatch.deciders.any_cell import AnyCell
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.learn.graph.recipes import GRAPH
from tandem.learn.graph.trained import weights_of
from tandem.learn.graph.weights import packed, shipped
from tandem.learn.training.runs import RunFolder
from tandem.learn.training.trainer import TrainingProgress, resume, train

CELL = layered(10, seed=3)
SHORT = replace(GRAPH, rounds=3, samples=8, steps=20, rate=1e-3, weights=(0.3,))


def tuned(folder: Path, **given: Any) -> dict[str, Any]:
    return train(
        CELL, recipe_name="graph", own_recipe=SHORT, folder=folder, front_limit=1.0, **given
    )


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    """A short tuning of two seeds."""
    folder = tmp_path_factory.mktemp("tuning") / "run"
    tuned(folder, seeds=(0, 1))
    return RunFolder(folder)


def test_it_learns_the_best_schedules_that_were_found(run: RunFolder) -> None:
    """What is learned becomes likelier, and the greedy schedule is no farther from the best."""
    rows = [row for row in run.figures() if row["seed"] == 0]
    assert [row["interval"] for row in rows] == [1, 2, 3]
    assert rows[-1]["loss"] < rows[0]["loss"]
    assert rows[-1]["above_best"] <= rows[0]["above_best"]
    before, after = shipped(), weights_of(run.policy(0))
    assert any((packed(before)[name] != part).any() for name, part in packed(after).items())


def test_what_was_stopped_goes_on_to_the_same_bits(run: RunFolder, tmp_path: Path) -> None:
    def stop(progress: TrainingProgress) -> None:
        if progress.rows[0]["interval"] == 1:
            raise KeyboardInterrupt

    assert tuned(tmp_path / "parts", seeds=(0, 1), on_progress=stop)["interrupted"]
    assert not resume(tmp_path / "parts")["interrupted"]
    parts = RunFolder(tmp_path / "parts")
    assert parts.figures() == run.figures()
    for seed in (0, 1):
        whole, again = packed(weights_of(run.policy(seed))), packed(weights_of(parts.policy(seed)))
        for name, part in whole.items():
            np.testing.assert_array_equal(again[name], part)


def test_a_plan_is_made_by_tuned_weights(run: RunFolder) -> None:
    """Its greedy schedule is the run's own."""
    (row, *_) = run.result()["seeds"]
    front = tandem.plan(
        CELL, minimize="makespan", method="learned", samples=1, policy=run.policy(0)
    )
    (found,) = front
    assert found.makespan <= row["greedy"]["makespan"]
    assert faults(CELL, found.schedule) == []
    with pytest.raises(UsageError, match=r"'spt' reads no trained policy.*learned"):
        tandem.plan(CELL, method="spt", policy=run.policy(0))


def test_live_tuned_weights_decide_alone_and_in_the_chain(run: RunFolder) -> None:
    options = Options(learned=str(run.policy(1)))
    alone = policy("learned", CELL, SECONDS, options)
    assert isinstance(alone, AnyCell)
    own = packed(weights_of(run.policy(1)))
    assert all((packed(alone.weights)[name] == part).all() for name, part in own.items())
    chain = policy("auto", CELL, SECONDS, options)
    (exact,) = chain.chain  # type: ignore[attr-defined]
    assert isinstance(exact.proposer, AnyCell)
    assert (packed(exact.proposer.weights)["task/0/bias"] == own["task/0/bias"]).all()


def test_commands_take_the_run(
    run: RunFolder, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "cell.json"
    file.write_text(json.dumps(CELL.to_dict()))
    asked = ["--policy", "learned,auto", "--learned", str(run.path), "--episodes", "2"]
    assert command(["simulate", str(file), *asked, "--json", "-q"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [row["policy"] for row in document["policies"]] == ["learned", "auto"]
    asked = ["--method", "learned", "--learned", str(run.path), "--minimize", "makespan"]
    assert command(["plan", str(file), *asked, "--json", "-q"]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out)["method"] == "learned"
    assert "the best of 2" in said.err


def test_a_folder_is_trained_on_and_judged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cells = tmp_path / "cells"
    cells.mkdir()
    for seed in range(2):
        (cells / f"{seed}.json").write_text(json.dumps(layered(6, seed=seed).to_dict()))
    folder = str(tmp_path / "run")
    quick = [part for name in ("rounds=1", "samples=4", "steps=4") for part in ("--set", name)]
    asked = ["train", str(cells), "--run", folder, "--front-limit", "1", "-q"]
    assert command([*asked, "--json"]) == 2
    assert "Only the recipe graph trains on several cells" in capsys.readouterr().err
    assert command([*asked, "--recipe", "graph", *quick, "--json"]) == 0
    # two cells, each with the weight that was asked for and two others
    assert json.loads(capsys.readouterr().out)["cell"] == layered(6, seed=0).name
    assert RunFolder(Path(folder)).figures()[-1]["episodes"] == 2 * 3 * 4
    asked = ["evaluate", folder, str(cells), "--episodes", "4", "--front-limit", "1", "--json"]
    assert command(asked) == 0
    document = json.loads(capsys.readouterr().out)
    assert [one["file"] for one in document["cells"]] == ["0.json", "1.json"]
    # the file of its policy is judged alike, wherever it lies, but only on cells that are named
    carried = str(shutil.copy(RunFolder(Path(folder)).policy(0), tmp_path / "carried.safetensors"))
    assert command([asked[0], carried, *asked[2:]]) == 0
    assert json.loads(capsys.readouterr().out) == document
    assert command(["evaluate", carried]) == 2
    assert f"tandem evaluate {carried} CELL|FOLDER" in capsys.readouterr().err
    gaps = [
        line["gap"]
        for one in document["cells"]
        for line in one["players"]
        if line["player"] == "greedy"
    ]
    assert document["mean_gap"]["greedy"] == pytest.approx(sum(gaps) / 2)
    assert set(document["mean_gap"]) >= {"best of 4", "best rule", "random"}


def test_what_is_wrong_with_a_folder_is_said_of_all_its_cells(
    run: RunFolder, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.json").write_text(json.dumps(layered(3, seed=0).to_dict()))
    listed = next(
        path for path in sorted(Path("examples").glob("*.yaml")) if tandem.load(path).stress_of_set
    )
    for name in ("b", "c"):
        shutil.copy(listed, tmp_path / f"{name}.yaml")
    asked = ["evaluate", str(run.policy(1)), str(tmp_path), "--episodes", "2", "--front-limit", "1"]
    assert command(asked) == 3
    said = capsys.readouterr().err
    assert "b.yaml: the network for all cells needs a stress that adds up" in said
    assert "c.yaml: the network" in said
    for name in ("b", "c"):
        (tmp_path / f"{name}.yaml").write_text("operators: {}\n")
    assert command(asked) == 3
    said = capsys.readouterr().err
    assert "b.yaml" in said
    assert "c.yaml" in said


def test_what_is_no_such_network_is_refused(run: RunFolder, tmp_path: Path) -> None:
    from safetensors.numpy import load_file, save_file

    arrays = load_file(run.policy(0))
    notes = {"format": "tandem network 1", "network": "graph", "sizes": {}, "notes": {}}
    file = tmp_path / "cut.safetensors"
    del arrays["task/0/bias"]
    save_file(arrays, file, {"tandem": json.dumps(notes)})
    with pytest.raises(CellError, match=r"no network for all cells.*has no task/0/bias.*Tune anew"):
        weights_of(file)
    save_file(arrays, file, {"tandem": json.dumps(notes | {"network": "scorer"})})
    with pytest.raises(UsageError, match=r"kind 'scorer'.*--recipe graph"):
        weights_of(file)


def test_a_cell_whose_stress_is_listed_by_sets_is_refused() -> None:
    listed = next(
        cell
        for path in sorted(Path("examples").glob("*.yaml"))
        if (cell := tandem.load(path)).stress_of_set
    )
    with pytest.raises(CellError, match="needs a stress that adds up"):
        train(listed, recipe_name="graph", own_recipe=SHORT, front_limit=1.0)
