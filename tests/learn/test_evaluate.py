"""Players side by side, and the commands that show them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner
from tests.learn import tiny
from tests.learn.short_runs import run_once

import tandem
from tandem.cli.learn import _show_cells, evaluate_command, train_command
from tandem.draw.curves import band, plot_curves
from tandem.errors import CellError, UsageError
from tandem.learn.results import relative_gap
from tandem.learn.training.evaluate import evaluate


@pytest.fixture(scope="module")
def run(shared_folder) -> Path:
    return run_once(shared_folder, "tiny")[0]


def test_every_player_stands_beside_the_exact_front(run):
    found = evaluate(run, episodes=20)
    assert [line.player.split()[0] for line in found.lines] == [
        "greedy",
        "sampled",
        "best",
        "rule",
        "random",
    ]
    assert found.front.points == [(23, 7), (24, 3), (34, 2)]
    for line in found.lines:
        assert line.gap >= 0
        if line.schedule:
            assert tandem.faults(found.cell, line.schedule) == []
    assert found.line("greedy").schedule is not None
    rule = next(line for line in found.lines if line.player.startswith("rule"))
    assert found.line("random").makespan > rule.makespan


def test_numpy_plays_what_jax_said_it_would(run):
    """The greedy pair of the training's last figures is the one that the NumPy player reaches."""
    document = json.loads((run / "result.json").read_text())
    for seed in document["seeds"]:
        line = evaluate(run, seed=seed["seed"], episodes=2).line("greedy")
        assert (line.makespan, line.stress) == (
            seed["greedy"]["makespan"],
            seed["greedy"]["stress"],
        )


def test_an_evaluation_repeats(run):
    assert evaluate(run, episodes=10).to_dict() == evaluate(run, episodes=10).to_dict()


def test_a_cell_with_another_number_of_tasks_is_refused_with_the_reason(run):
    small = tandem.Cell.model_validate(
        {
            "operators": {"r": {"kind": "robot"}, "h": {"kind": "human"}},
            "tasks": {"a": {"time": {"r": 3, "h": 4}}},
        }
    )
    with pytest.raises(UsageError, match="it has 1 tasks"):
        evaluate(run, small)


def test_a_seed_that_is_not_there_is_named(run):
    with pytest.raises(UsageError, match="no policy of seed 9; there are 3, 4"):
        evaluate(run, seed=9)


def test_a_policy_in_its_run_is_judged_as_the_run_s_seed(run, tmp_path):
    file = run / "policy-4.safetensors"
    assert evaluate(file, episodes=5).to_dict() == evaluate(run, seed=4, episodes=5).to_dict()
    with pytest.raises(UsageError, match="seed 3: chooses among a run's policies"):
        evaluate(file, seed=3)
    alone = tmp_path / "policy-4.safetensors"
    alone.write_bytes(file.read_bytes())
    with pytest.raises(UsageError, match="Name the run's folder, or the file in it"):
        evaluate(alone, episodes=5)


def test_a_cell_whose_front_is_not_proven_says_so(run, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    found = evaluate(run, episodes=2)
    _show_cells({"proven.json": found, "open.json": replace(found, front=None)}, False)
    said = capsys.readouterr().out
    assert "open.json *" in said
    assert "proven.json *" not in said
    assert "mean" in said
    assert "--front-limit" in said


def test_the_gap_is_the_excess_of_what_is_paid():
    front = tandem.plan(tandem.load(tiny.CELL))
    paid = {"step": -10.0, "per_second": 1, "stress_factor": 5.0}
    assert relative_gap(front, 24, 3, **paid) == 0
    assert relative_gap(front, 23, 7, **paid) == pytest.approx(10 / 255, abs=1e-6)
    assert relative_gap(None, 23, 7, **paid) is None
    assert relative_gap(front, None, None, **paid) is None


def test_evaluate_draws_and_prints_one_document(run, tmp_path):
    done = CliRunner().invoke(
        evaluate_command,
        [
            str(run),
            "--episodes",
            "5",
            "--json",
            "--gantt",
            str(tmp_path / "g.svg"),
            "--curves",
            str(tmp_path / "c.svg"),
        ],
        catch_exceptions=False,
    )
    document = json.loads(done.stdout)
    assert document["exact_front"] == [[23, 7], [24, 3], [34, 2]]
    assert "critic" in (tmp_path / "c.svg").read_text()
    assert (tmp_path / "g.svg").stat().st_size > 2000


def test_train_wants_a_cell_or_a_run():
    with pytest.raises(UsageError, match="one of the two"):
        CliRunner().invoke(train_command, [], catch_exceptions=False, standalone_mode=False)


def test_train_finds_no_run_to_go_on_with(tmp_path):
    with pytest.raises(CellError, match="holds no run"):
        CliRunner().invoke(
            train_command,
            ["--resume", str(tmp_path), "-q"],
            catch_exceptions=False,
            standalone_mode=False,
        )


def test_a_band_is_the_mean_and_its_interval():
    x, mean, half = band([[0, 10], [0, 10]], [[0, 10], [2, 12]], points=3)
    assert x.tolist() == [0, 5, 10]
    assert mean.tolist() == [1, 6, 11]
    assert half == pytest.approx([1.96] * 3)


def test_curves_draw_into_the_axes_they_are_given():
    from tandem.draw.figure import blank

    ax = blank(4, 3).axes[0]
    assert (
        plot_curves({"one": ([[1, 2]], [[3, 4]])}, ax, marks={"here": 1.5}, levels={"best": 4})
        is ax
    )
    assert next(line.get_label() for line in ax.get_lines()) == "one"
