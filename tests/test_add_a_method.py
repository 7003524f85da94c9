"""The page "Add a method", followed to the letter on a copy of the package.

Its files are written, its lines go into the tables, and each is called by its name.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "add-a-method.md").read_text()
CELL = "examples/thesis.yaml"


def follow(page: str, root: Path) -> list[str]:
    """Does what the blocks of the page say; gives their first lines."""
    told = []
    for block in re.findall(r"^```(?:python|text)\n(.*?)^```", page, re.DOTALL | re.MULTILINE):
        head, _, rest = block.partition("\n")
        told.append(head)
        if whole := re.fullmatch(r"# (src/\S+)", head):
            assert not (root / whole[1]).exists(), f"{whole[1]} is there already"
            (root / whole[1]).write_text(rest)
            continue
        named = re.fullmatch(r"# (\w+) in (src/\S+)", head)
        assert named, f"a block that says nothing of where it belongs: {head}"
        file = root / named[2]
        text = file.read_text()
        if named[1] == "import":
            text, count = re.subn(
                r"^(from tandem\.)", f"{rest}\\1", text, count=1, flags=re.MULTILINE
            )
        else:
            text, count = re.subn(
                rf"^({named[1]}\b[^\n]*= \{{\n)",
                lambda found, rest=rest: found[1] + f"    {rest}",
                text,
                count=1,
                flags=re.MULTILINE,
            )
        assert count == 1, f"{named[2]} has no place for: {head}"
        file.write_text(text)
    return told


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package with all that the page adds."""
    root = tmp_path_factory.mktemp("copy")
    shutil.copytree(ROOT / "src", root / "src", ignore=shutil.ignore_patterns("__pycache__"))
    told = follow(PAGE, root)
    tables = {head.split()[1] for head in told if " in " in head}
    assert tables >= {"METHODS", "SPECS", "POLICIES", "KINDS", "SINGLE", "RECIPES"}
    return root


def python(root: Path, *arguments: str) -> str:
    environment = {**os.environ, "PYTHONPATH": str(root / "src")}
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr + done.stdout
    return done.stdout


def command(root: Path, *arguments: str) -> str:
    return python(root, "-m", "tandem.cli", *arguments)


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
    listed = json.loads(command(extended, "methods", "--json"))["methods"]
    assert what in next(method["what"] for method in listed if method["name"] == name)
    document = json.loads(command(extended, "plan", CELL, "--method", name, "--json", "-q"))
    assert document["front"]
    assert not document["complete"]
    assert all(point["makespan"] >= 23 for point in document["front"])


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("first-come", "whoever is free begins"),
        ("fewest-hands", "the task that fewest can do first"),
    ],
)
def test_a_new_decider_and_a_new_rule_decide_live(extended: Path, name: str, what: str) -> None:
    pytest.importorskip("jax", reason="simulating needs tandem[learn]")
    assert re.search(rf"^{name} +{what}", command(extended, "policies"), re.MULTILINE)
    judged = json.loads(
        command(
            extended,
            "simulate",
            CELL,
            "--policy",
            f"fixed,{name}",
            "--people",
            "careful",
            "--episodes",
            "2",
            "--json",
            "-q",
        )
    )
    fixed, mine = judged["policies"]
    assert mine["policy"] == name
    assert judged["people"] == "careful"
    assert min(mine["makespan"]["mean"], fixed["makespan"]["mean"]) > 23, (
        "a careful person takes longer than the stated times"
    )


def test_a_new_environment_passes_every_standard_by_itself(extended: Path) -> None:
    pytest.importorskip("pettingzoo", reason="needs tandem[learn]")
    out = python(
        extended,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "tests/envs/test_standards.py",
        "-k",
        "Ordering",
    )
    assert re.search(r"^\d\d+ passed", out, re.MULTILINE)
    assert "failed" not in out


def test_a_new_recipe_is_known_and_checked(extended: Path) -> None:
    pytest.importorskip("jax", reason="needs tandem[learn]")
    asked = (
        "from tandem.learn.training.recipes import RECIPES, changed;"
        " print(changed(RECIPES['scaled'], ['config.epochs=2']).sees)"
    )
    assert python(extended, "-c", asked).strip() == "scaled"


def test_the_generated_pages_know_what_was_added(extended: Path) -> None:
    told = python(
        extended,
        "-c",
        "import sys; sys.path.insert(0, 'docs'); import reference;"
        " print(reference.method_reference())",
    )
    assert "| `one-by-one` | the tasks one after the other" in told
