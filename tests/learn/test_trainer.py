"""Runs: nothing is lost, whatever stops them, and what they say is true."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import load_file
from tests.learn import tiny
from tests.learn.short_runs import run_once

from tandem.errors import CellError, UsageError
from tandem.learn.training import trainer
from tandem.learn.training.runs import RunFolder


@pytest.fixture(scope="module")
def whole(shared_folder):
    """A run that nothing stopped: its folder and document."""
    return run_once(shared_folder, "tiny")


def same_run(left: Path, right: Path) -> None:
    """Checkpoint, policies and figures agree to the bit; only what was spent on them may differ."""
    for name in ("checkpoint.safetensors", "policy-3.safetensors", "policy-4.safetensors"):
        ours, theirs = load_file(left / name), load_file(right / name)
        assert ours.keys() == theirs.keys()
        assert all(ours[key].tobytes() == theirs[key].tobytes() for key in ours)
    assert RunFolder(left).rows() == RunFolder(right).rows()
    assert (left / "metrics.csv").read_text() == (right / "metrics.csv").read_text()


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
def test_a_run_that_was_killed_goes_on_to_the_same_bits(whole, tmp_path):
    folder = tmp_path / "killed"
    child = subprocess.Popen(
        [sys.executable, str(Path(tiny.__file__)), str(folder)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )
    deadline = time.monotonic() + 300
    while len(RunFolder(folder).rows()) < 3 * 2:
        assert child.poll() is None, child.stderr.read().decode()
        assert time.monotonic() < deadline, "the training did not get to its third interval"
        time.sleep(0.002)
    os.kill(child.pid, signal.SIGKILL)
    child.wait()
    assert len(RunFolder(folder).rows()) < tiny.INTERVALS * 2, "killed too late to show anything"
    assert not (folder / "result.json").exists()
    trainer.resume(folder)
    same_run(folder, whole[0])


def test_ctrl_c_saves_says_so_and_resumes_to_the_same_bits(whole, tmp_path):
    def stop(progress):
        if progress.rows[0]["interval"] == 4:
            raise KeyboardInterrupt

    document = tiny.train(tmp_path / "stopped", on_progress=stop)
    assert document["interrupted"]
    assert document["seeds"][0]["steps"] == 4 * 128
    assert RunFolder(tmp_path / "stopped").seeds == [3, 4]
    after = trainer.resume(tmp_path / "stopped")
    assert not after["interrupted"]
    same_run(tmp_path / "stopped", whole[0])


def test_figures_behind_the_checkpoint_are_forgotten_and_come_again(whole, tmp_path):
    """A power cut between figures and checkpoint, in the middle of a line."""

    def stop(progress):
        if progress.rows[0]["interval"] == 4:
            raise KeyboardInterrupt

    tiny.train(tmp_path / "run", on_progress=stop)
    with open(tmp_path / "run" / "metrics.jsonl", "a") as file:
        file.write(json.dumps({"interval": 5, "seed": 3}) + '\n{"interval": 5, "se')
    trainer.resume(tmp_path / "run")
    same_run(tmp_path / "run", whole[0])


def test_numbers_that_are_not_finite_stop_it_and_the_last_good_checkpoint_stays(tmp_path):
    stages = (
        tiny.RECIPE.config.stages[0],
        replace(tiny.RECIPE.config.stages[1], learning_rate=1e38),
    )
    broken = replace(tiny.RECIPE, config=replace(tiny.RECIPE.config, stages=stages))
    with pytest.raises(
        trainer.NotFiniteError, match=r"seed 3, 4 are no longer finite.*after interval [67]"
    ):
        tiny.train(tmp_path / "run", own_recipe=broken)
    kept = load_file(tmp_path / "run" / "checkpoint.safetensors")
    assert all(np.isfinite(array).all() for array in kept.values() if array.dtype.kind == "f")
    assert kept["steps"].tolist() in ([6 * 128] * 2, [7 * 128] * 2)


def test_the_document_is_what_outsiders_rely_on(whole):
    folder, document = whole
    assert document["run"] == str(folder)
    assert document["exact_front"] == [[23, 7], [24, 3], [34, 2]]
    assert document["exact_front_complete"]
    for index, seed in enumerate(document["seeds"]):
        assert seed["seed"] == 3 + index
        assert seed["steps"] == tiny.INTERVALS * 128
        assert seed["cpu_s"] > 0
        for played in (seed["greedy"], seed["best_of_n"]):
            assert played["illegal"] == 0
            assert played["makespan"] >= 23
            assert played["gap"] == pytest.approx(
                (10 * played["makespan"] + played["stress"] - 237) / 237, abs=1e-6
            )
    assert json.loads((folder / "result.json").read_text()) == json.loads(json.dumps(document))


def test_every_interval_has_the_figures_that_the_thesis_watches(whole):
    folder, _ = whole
    with open(folder / "metrics.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["interval"], row["seed"]) for row in rows] == [
        (str(i), s) for i in range(1, tiny.INTERVALS + 1) for s in ("3", "4")
    ]
    for agent in ("robot_0", "human_0"):
        for figure in ("return", "mean_return", "first_value", "illegal"):
            assert all(np.isfinite(float(row[f"{figure}_{agent}"])) for row in rows)
    assert {"greedy_makespan", "greedy_stress", "gap", "stage", "episodes", "steps"} <= rows[
        0
    ].keys()
    assert [row["stage"] for row in rows[::2]] == ["1"] * 6 + ["2"] * 6


def test_a_folder_that_holds_a_run_is_not_written_over(whole):
    with pytest.raises(UsageError, match=r"holds a run already.*--resume"):
        tiny.train(whole[0])


def test_resuming_what_is_no_run_says_so(tmp_path):
    with pytest.raises(CellError, match="holds no run"):
        trainer.resume(tmp_path)


def test_a_checkpoint_of_another_form_is_refused_with_the_arrays_that_do_not_fit(whole, tmp_path):
    import shutil

    folder = tmp_path / "copy"
    shutil.copytree(whole[0], folder)
    asked = json.loads((folder / "run.json").read_text())
    asked["settings"]["config"]["hidden"] = [4]
    (folder / "run.json").write_text(json.dumps(asked))
    with pytest.raises(CellError, match=r"does not fit this training: .*actor"):
        trainer.resume(folder)


def test_tensorboard_events_are_written_on_request(tmp_path):
    tiny.train(tmp_path / "run", tensorboard=True)
    assert list((tmp_path / "run" / "tensorboard").glob("events.*"))
