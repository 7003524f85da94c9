"""The page "Add a method", followed to the letter.

On a copy of the package its files are written and its lines go into the tables; its package is
installed beside it. Then each of the six is called by its name on the command line.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "add-a-method.md").read_text("utf-8")
CELL = "examples/thesis.yaml"
TOLD = re.compile(r"^```(?:python|text|toml)\n(# .*?)\n(.*?)^```", re.DOTALL | re.MULTILINE)
"""A block that says in its first line where it belongs."""


def follow(page: str, root: Path) -> list[str]:
    """Does what the blocks of the page say; gives their first lines."""
    heads = []
    for head, rest in TOLD.findall(page):
        heads.append(head)
        if whole := re.fullmatch(r"# ((?:src|mine)/\S+)", head):
            write(root / whole[1], rest)
        elif line := re.fullmatch(r"# (\w+) in (src/\S+)", head):
            put(root / line[2], line[1], rest)
        else:
            pytest.fail(f"a block that says nothing of where it belongs: {head}")
    return heads


def write(file: Path, text: str) -> None:
    assert not file.exists(), f"{file} is there already"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, "utf-8")


def put(file: Path, table: str, line: str) -> None:
    """Puts the line first into the table of the file, or before its imports of ours."""
    text = file.read_text("utf-8")
    if table == "import":
        text, count = re.subn(r"^(?=from tandem\.)", line, text, count=1, flags=re.MULTILINE)
    else:
        opening = rf'(?<=^){table}\b[^\n]*= (Table\(\n    "\w+",\n    )?\{{\n'
        text, count = re.subn(
            opening, lambda found: f"{found[0]}    {line}", text, count=1, flags=re.MULTILINE
        )
    assert count == 1, f"{file} has no place for a line of {table}"
    file.write_text(text, "utf-8")


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package with all that the page adds, and the page's own package installed."""
    root = tmp_path_factory.mktemp("copy")
    shutil.copytree(ROOT / "src", root / "src")  # what Python has compiled goes along, and holds
    heads = follow(PAGE, root)
    tables = {head.split()[1] for head in heads if " in " in head}
    assert tables == {"import", "METHODS", "SPECS", "POLICIES", "KINDS"}
    as_it_is = ("--quiet", "--no-deps", "--no-build-isolation", "--disable-pip-version-check")
    pip = ("-m", "pip", "install", *as_it_is, "--target", str(root / "installed"))
    done = subprocess.run(
        [sys.executable, *pip, str(root / "mine")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return root


def python(root: Path, *arguments: str, code: int = 0) -> subprocess.CompletedProcess[str]:
    found = os.pathsep.join([str(root / "src"), str(root / "installed")])
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": found},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == code, done.stderr + done.stdout
    return done


def command(root: Path, *arguments: str) -> str:
    return python(root, "-m", "tandem", *arguments).stdout


def document(root: Path, *arguments: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(command(root, *arguments, "--json"))
    return found


needs_learn = pytest.mark.usefixtures("learn")


@pytest.fixture
def learn() -> None:
    pytest.importorskip("jax", reason="needs tandem[learn]")


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("one-by-one", "the tasks one after the other"),
        ("fewest-hands", "the task that fewest can do first"),
    ],
)
def test_a_new_method_and_a_new_rule_are_listed_and_plan(
    extended: Path, name: str, what: str
) -> None:
    assert re.search(rf"^{name} +{what}", command(extended, "methods"), re.MULTILINE)
    listed = document(extended, "methods")["methods"]
    assert what in next(method["what"] for method in listed if method["name"] == name)
    planned = document(extended, "plan", CELL, "--method", name, "-q")
    assert planned["front"]
    assert not planned["complete"]
    assert all(point["makespan"] >= 23 for point in planned["front"])


@needs_learn
@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("first-come", "whoever is free begins"),
        ("fewest-hands", "the task that fewest can do first"),
    ],
)
def test_a_new_decider_and_a_new_rule_decide_live(extended: Path, name: str, what: str) -> None:
    assert re.search(rf"^{name} +{what}", command(extended, "policies"), re.MULTILINE)
    policies = ("--policy", f"fixed,{name}", "--people", "careful", "--episodes", "2", "-q")
    judged = document(extended, "simulate", CELL, *policies)
    fixed, mine = judged["policies"]
    assert mine["policy"] == name
    assert judged["people"] == "careful"
    slowed = "a careful person takes longer than the stated times"
    assert min(mine["makespan"]["mean"], fixed["makespan"]["mean"]) > 23, slowed


@needs_learn
def test_a_new_environment_passes_every_standard_by_itself(extended: Path) -> None:
    standards = ("tests/envs/test_standards.py", "-k", "Ordering")
    out = python(extended, "-m", "pytest", "-q", "-p", "no:cacheprovider", *standards).stdout
    assert re.search(r"^\d\d+ passed", out, re.MULTILINE)
    assert "failed" not in out


@needs_learn
@pytest.mark.parametrize(
    ("name", "what"),
    [("wide", "PPO with wider networks"), ("priorities", "the cross-entropy method")],
)
def test_new_recipes_are_listed_by_the_command_that_trains(
    extended: Path, name: str, what: str
) -> None:
    assert re.search(rf"^ +{name} +{what}", command(extended, "train", "--help"), re.MULTILINE)


@needs_learn
def test_a_new_recipe_is_held_against_its_settings(extended: Path) -> None:
    wrong = ("--recipe", "priorities", "--set", "kept=99", "--set", "round=3")
    said = python(extended, "-m", "tandem", "train", CELL, *wrong, code=2).stderr
    assert "kept 99: must be at most draws, 24." in said
    assert "round=3: the recipe has no such setting; it has rounds, draws, kept." in said


@pytest.fixture(scope="module")
def run(extended: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page's own training."""
    pytest.importorskip("jax", reason="needs tandem[learn]")
    folder = tmp_path_factory.mktemp("priorities") / "run"
    (line,) = re.findall(r"^tandem train .*--recipe priorities.*$", PAGE, re.MULTILINE)
    found = document(extended, *line.split()[1:], "--run", str(folder), "-q")
    assert [seed["seed"] for seed in found["seeds"]] == [0, 1]
    assert found["exact_front"][0] == [23, 7]
    assert all(seed["greedy"]["makespan"] >= 23 for seed in found["seeds"])
    assert any(seed["best_of_n"]["gap"] == 0 for seed in found["seeds"]), "seven tasks are few"
    return folder


def test_a_new_algorithm_is_evaluated_beside_the_others(extended: Path, run: Path) -> None:
    players = {row["player"]: row for row in document(extended, "evaluate", str(run))["players"]}
    assert players["greedy"]["faults"] == []
    assert players["greedy"]["makespan"] <= players["random"]["makespan"]


def test_a_new_algorithm_goes_on_to_the_same_end_after_a_stop(
    extended: Path, run: Path, tmp_path: Path
) -> None:
    half = tmp_path / "half"
    shutil.copytree(run, half)
    os.replace(half / "checkpoint-before.safetensors", half / "checkpoint.safetensors")
    again = document(extended, "train", "--resume", str(half), "-q")
    first = json.loads((run / "result.json").read_text("utf-8"))
    assert [seed["greedy"] for seed in again["seeds"]] == [
        seed["greedy"] for seed in first["seeds"]
    ]
    assert (half / "policy-0.safetensors").read_bytes() == (
        run / "policy-0.safetensors"
    ).read_bytes()


@needs_learn
def test_a_package_that_cannot_be_loaded_is_named(extended: Path, tmp_path: Path) -> None:
    broken = tmp_path / "broken"
    shutil.copytree(extended / "installed", broken / "installed")
    shutil.copytree(extended / "src", broken / "src")
    (broken / "installed" / "mine" / "recipes.py").unlink()
    said = python(broken, "-m", "tandem", "train", CELL, "--recipe", "wide", code=2).stderr
    assert "'wide' of tandem.recipes is added by an installed package" in said
    assert "mine.recipes:WIDE: No module named 'mine.recipes'. Mend that package" in said


def test_the_generated_pages_know_what_was_added(extended: Path) -> None:
    asked = (
        "import sys; sys.path.insert(0, 'docs'); "
        "import reference; print(reference.method_reference())"
    )
    assert "| `one-by-one` | the tasks one after the other" in python(extended, "-c", asked).stdout
