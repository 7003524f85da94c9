"""The examples of code of one's own, outside the package: judged beside people, and run live."""

from __future__ import annotations

import json
import os
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("jax", reason="needs tandem[learn]")

import tandem
from tandem.cli.root import run
from tandem.files.generators import layered

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "examples" / "extensions"
CELL = str(ROOT / "examples" / "thesis.yaml")
Capture = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def outside(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(FOLDER))


def judged(capsys: Capture, policy: str, *more: str) -> dict[str, Any]:
    asked = ["--policy", f"fixed,{policy}", "--people", "random:0.5", "--episodes", "12"]
    assert run(["simulate", CELL, *asked, *more, "--json", "-q"]) == 0
    document: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert document["left_out"] == []
    return document


def lived(capsys: Capture, policy: str, *more: str) -> dict[str, Any]:
    """The summary of a shift beside somebody slower than stated."""
    asked = ["--policy", policy, "--simulate", "pace:1.5", "--budget", "60000", "--json"]
    assert run(["dispatch", CELL, *asked, *more]) == 0
    summary: dict[str, Any] = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert summary["over"]
    assert summary["failed"] == summary["late"] == 0
    return summary


def test_an_own_decider_is_judged_and_runs_live(capsys: Capture) -> None:
    _, own = judged(capsys, "own_decider:make")["policies"]
    assert own["policy"] == "own_decider:make"
    assert own["done"] == 1
    assert lived(capsys, "own_decider:make")["makespan"] >= 23


def test_an_own_method_plans(capsys: Capture) -> None:
    assert run(["plan", CELL, "--method", "own_method:plan", "--json", "-q"]) == 0
    document = json.loads(capsys.readouterr().out)
    (point,) = document["front"]
    assert not document["complete"]
    assert point["makespan"] >= 23
    for cell in (layered(12, 2, 1, seed=1), layered(9, 1, 2, seed=2)):
        for result in tandem.plan(cell, method="own_method:plan"):
            assert tandem.faults(cell, result.schedule) == []


def test_an_own_pettingzoo_learner_learns_is_judged_and_runs_live(
    capsys: Capture, tmp_path: Path
) -> None:
    example = runpy.run_path(str(FOLDER / "own_pettingzoo_learner.py"))
    import numpy as np

    cell = tandem.load(CELL)
    learned = example["learn"](cell, episodes=200, seed=0)
    np.savez(tmp_path / "learned.npz", **learned)
    named = ("own_pettingzoo_learner:make", "--learned", str(tmp_path / "learned.npz"))
    _, own = judged(capsys, *named)["policies"]
    assert own["done"] == 1
    lived(capsys, *named)
    knows, naught = (
        tandem.judge(cell, [example["of_pettingzoo"](cell, example["greedy"](prefers))], episodes=2)
        for prefers in (learned, {agent: 0 * prefers for agent, prefers in learned.items()})
    )
    best, worst = (found[0]["policies"][0]["makespan"]["mean"] for found in (knows, naught))
    assert 23 <= best < worst, "it learned something"


def test_an_sb3_policy_learns_is_judged_and_runs_live(capsys: Capture, tmp_path: Path) -> None:
    pytest.importorskip("sb3_contrib", reason="pip install 'tandem[sb3]' to run it")
    example = runpy.run_path(str(FOLDER / "sb3_policy.py"))
    model = example["learn"](tandem.load(CELL), person="random:0.5", steps=1024)
    model.save(tmp_path / "learned.zip")
    named = ("sb3_policy:make", "--learned", str(tmp_path / "learned.zip"))
    _, own = judged(capsys, *named)["policies"]
    assert own["done"] == 1
    lived(capsys, *named)


class LikeSB3:
    """Has SB3's `predict`; takes the last legal action."""

    def predict(self, seen: Any, deterministic: bool, action_masks: Any) -> tuple[Any, None]:
        import numpy as np

        assert deterministic
        return np.array(np.flatnonzero(action_masks)[-1]), None


def test_whatever_has_sb3s_predict_is_judged() -> None:
    example = runpy.run_path(str(FOLDER / "sb3_policy.py"))
    cell = tandem.load(CELL)
    own = example["of_gymnasium"](cell, example["greedy"](LikeSB3()))
    (document,) = tandem.judge(cell, [own], episodes=2)
    assert document["policies"][0]["done"] == 1


def test_an_example_runs_as_its_first_lines_say() -> None:
    done = subprocess.run(
        [sys.executable, str(FOLDER / "own_decider.py"), "--episodes", "2"],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert [line.partition(":")[0] for line in done.stdout.splitlines()] == ["fixed", "make"]
