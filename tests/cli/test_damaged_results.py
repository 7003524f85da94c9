"""Results of `tandem plan --json` and population files in which one value was changed, and every
command that reads them.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from tests.mutants import Mutant, mutants

import tandem
from tandem.cli.root import run

EXAMPLES = Path(__file__).parents[2] / "examples"
CELL = EXAMPLES / "thesis.yaml"
CODES = (0, 2, 3, 6)


def judged(
    command: list[str], mutant: Mutant, file: Path, capfd: pytest.CaptureFixture[str]
) -> int:
    """Runs the command; how it ended. Whatever was changed, it is no bug, and one message names the
    file.
    """
    capfd.readouterr()
    code = run(command)
    err = capfd.readouterr().err
    told = f"{mutant.what}, tandem {' '.join(command)}: {code} {err}"
    assert "bug in Tandem" not in err, told
    assert "Traceback" not in err, told
    assert code in CODES, told
    if code == 3:
        assert err.count("tandem:") == 1, told
        assert str(file) in err, told
    return code


@pytest.fixture(scope="module")
def result() -> str:
    """The document of a plan."""
    return json.dumps(tandem.plan(tandem.load(str(CELL)), seed=0).to_dict())


@pytest.mark.parametrize("seed", range(4))
def test_a_result_with_one_value_changed(result: str, tmp_path: Path, capfd, seed: int) -> None:
    project, whole = tmp_path / "project", tmp_path / "whole.json"
    (project / "results").mkdir(parents=True)
    shutil.copy(CELL, project / "cell.yaml")
    whole.write_text(result)
    refused = 0
    for mutant in mutants(json.loads(result), seed, count=40):
        file = project / "results" / "plan.json"
        file.write_text(mutant.text)
        for command in (
            ["check", str(CELL), str(file)],
            ["check", str(CELL), str(file), "--json"],
            ["check", str(file)],
            ["check", str(file), "--json"],
            ["check", str(project)],
            ["report", str(file), "--json"],
            ["report", str(file), "--point", "2", "-o", str(tmp_path / "shown.csv")],
            ["explain", str(file), "--task", "3", "--time-limit", "0.5", "--json"],
            ["compare", str(file), str(whole)],
            ["compare", str(whole), str(file), "--point", "2"],
            ["compare", str(whole), str(file), "--json"],
            ["plan", str(CELL), "--from", str(file), "--method", "longest-tail", "-q", "--json"],
        ):
            refused += judged(command, mutant, file, capfd) == 3
    assert refused > 40


PEOPLE = {
    "format": 1,
    "name": "Day shift",
    "train": [{"person": "pace:0.8..1.5", "share": 2}, {"person": "random:0..0.5+forgetful:0.05"}],
    "held_out": [{"person": "prefers:3,1"}],
}


@pytest.mark.parametrize("seed", range(2))
def test_a_population_with_one_value_changed(tmp_path: Path, capfd, seed: int) -> None:
    refused = 0
    for mutant in mutants(PEOPLE, seed, count=60):
        file = tmp_path / "people.yaml"
        file.write_text(mutant.text)  # JSON is YAML
        people, decider = f"population:{file}", ["--policy", "longest-tail", "--json"]
        code = judged(["dispatch", str(CELL), "--simulate", people, *decider], mutant, file, capfd)
        if code == 3 and refused < 5:
            pytest.importorskip("jax", reason="simulating many episodes needs tandem[learn]")
            many = ["simulate", str(CELL), "--people", people, "--episodes", "2", "-q", *decider]
            assert judged(many, mutant, file, capfd) == 3
        refused += code == 3
    assert refused > 30
