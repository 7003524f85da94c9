"""What someone meets before the first plan: the import, the command, the wheel, the files around
the code.
"""

from __future__ import annotations

import importlib
import json
import os
import re
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest
from packaging.specifiers import SpecifierSet

import tandem

ROOT = Path(__file__).resolve().parents[1]
HEAVY = {
    "jax",
    "jaxlib",
    "torch",
    "matplotlib",
    "starlette",
    "pandas",
    "numpy",
    "ortools",
    "pydantic",
    "rich",
    "click",
}


def python(*arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        env=os.environ | variables,
        cwd=ROOT,
    )


def test_importing_loads_nothing_heavy() -> None:
    program = "import json, sys, tandem; print(json.dumps(sorted(sys.modules)))"
    loaded = json.loads(python("-c", program).stdout)
    assert HEAVY & {name.partition(".")[0] for name in loaded} == set()


def test_asking_the_command_for_help_loads_neither_solver_nor_pictures() -> None:
    program = (
        "import json, sys\n"
        "from tandem.cli import main\n"
        "sys.argv = ['tandem', '--help']\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "print(json.dumps(sorted(sys.modules)), file=sys.stderr)"
    )
    loaded = json.loads(python("-c", program).stderr.splitlines()[-1])
    assert (HEAVY - {"click", "rich", "pydantic"}) & {
        name.partition(".")[0] for name in loaded
    } == set()


@pytest.mark.parametrize(
    "arguments", [("--help",), ("plan", "--help"), ("check", "no-such-file.yaml"), ("--version",)]
)
def test_the_package_runs_as_a_module_under_its_own_name(arguments: tuple[str, ...]) -> None:
    ran = python("-m", "tandem", *arguments)
    assert "tandem" in ran.stdout + ran.stderr
    assert "__main__" not in ran.stdout + ran.stderr
    assert ran.returncode == (3 if "check" in arguments else 0)


def test_the_face_is_sorted_and_every_name_on_it_is_there() -> None:
    assert list(tandem.__all__) == sorted(tandem.__all__)
    assert set(tandem.__all__) <= set(dir(tandem))
    for name in tandem.__all__:
        assert getattr(tandem, name) is not None


@pytest.mark.parametrize("room", ["cell", "dispatch.shift", "plan", "schedule"])
def test_the_faces_of_the_rooms_hold_what_they_promise(room: str) -> None:
    module = importlib.import_module(f"tandem.{room}")
    names = list(getattr(module, "__all__", ()))
    assert names == sorted(names)
    assert all(hasattr(module, name) for name in names)


def test_a_name_that_is_not_there_is_refused() -> None:
    with pytest.raises(AttributeError, match="'tandem' has no attribute 'solve'"):
        tandem.solve  # noqa: B018


def test_plan_is_a_room_and_a_verb_whichever_comes_first() -> None:
    cell = "tandem.load('examples/thesis.yaml')"
    for program in (
        f"import tandem; print(tandem.plan({cell}).points)",
        f"import tandem, tandem.plan.result; print(tandem.plan({cell}).points)",
        f"import tandem; from tandem import plan; print(plan({cell}).points)",
        (
            "import tandem; import tandem.plan.methods;"
            f" print(tandem.plan.methods.plan({cell}).points)"
        ),
    ):
        done = python("-c", program)
        assert done.stdout.strip() == "[(23.0, 7.0), (24.0, 3.0), (34.0, 2.0)]", done.stderr


def test_the_wheel_holds_types_licence_and_command(tmp_path: Path) -> None:
    done = python("-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path))
    assert done.returncode == 0, done.stderr
    (path,) = tmp_path.glob("tandem-*.whl")
    with zipfile.ZipFile(path) as wheel:
        names = set(wheel.namelist())
        meta = f"tandem-{tandem.__version__}.dist-info"
        assert {"tandem/py.typed", "tandem/__init__.py", f"{meta}/licenses/LICENSE"} <= names
        assert "tandem = tandem.cli:main" in wheel.read(f"{meta}/entry_points.txt").decode()
        assert "License-Expression: Apache-2.0" in wheel.read(f"{meta}/METADATA").decode()
    tracked = subprocess.run(
        ["git", "ls-files", "src/tandem"], capture_output=True, text=True, cwd=ROOT
    ).stdout.split()
    assert {name.removeprefix("src/") for name in tracked} <= names


def declared() -> dict[str, str]:
    """Every distribution that pyproject.toml asks for, with its specifier, extras among themselves
    left out.
    """
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = [
        *project["dependencies"],
        *(line for lines in project["optional-dependencies"].values() for line in lines),
    ]
    return {
        name: rest
        for name, rest in (re.match(r"([A-Za-z0-9_.-]+)(.*)", line).groups() for line in lines)
        if name != "tandem"
    }  # type: ignore[union-attr]


def pinned() -> dict[str, str]:
    """Every distribution of constraints.txt, with its version."""
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    return dict(line.split("==") for line in lines if "==" in line)


def test_what_is_pinned_runs_on_the_first_python_of_the_oldest_version() -> None:
    def asks(name: str) -> str:
        try:
            return distribution(name).metadata["Requires-Python"] or ""
        except PackageNotFoundError:  # of an extra that is not installed here
            return ""

    # Debian 12 has 3.11.2
    wrong = {name: asks(name) for name in pinned() if not SpecifierSet(asks(name)).contains("3.11")}
    assert wrong == {}


def test_every_dependency_is_pinned_and_has_its_reason() -> None:
    names = {name.lower().replace("_", "-") for name in pinned()}
    reasons = (ROOT / "docs" / "dependencies.md").read_text()
    assert {name.lower() for name in declared()} <= names
    assert [name for name in declared() if f"`{name}`" not in reasons] == []


def test_the_solver_stays_at_the_version_that_is_right() -> None:
    assert declared()["ortools"] == "==9.14.*"


def test_the_changelog_and_the_citation_name_this_version() -> None:
    assert "## [Unreleased]" in (ROOT / "CHANGELOG.md").read_text()
    assert f"version: {tandem.__version__}" in (ROOT / "CITATION.cff").read_text()


@pytest.mark.parametrize(("ci", "ending"), [("", "2 skipped"), ("1", "1 failed, 1 skipped")])
def test_in_ci_a_test_without_its_program_has_failed(tmp_path: Path, ci: str, ending: str) -> None:
    (tmp_path / "conftest.py").write_text((ROOT / "tests" / "conftest.py").read_text())
    (tmp_path / "test_pages.py").write_text(
        "import pytest\n"
        "\n"
        "def test_page():\n"
        "    pytest.skip('there is no Chromium here; apt-get install chromium')\n"
        "\n"
        "def test_data():\n"
        "    pytest.skip('the benchmark sets are not here')\n"
    )
    done = python(
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "--rootdir",
        str(tmp_path),
        str(tmp_path),
        TANDEM_CI=ci,
    )
    assert ending in done.stdout.splitlines()[-1]


def test_comments_docstrings_and_pages_name_only_files_that_exist() -> None:
    """`tests/...`, `src/...`, `docs/...`, `examples/...` and `benchmarks/...` wherever they are
    written. The page that adds files says so itself.
    """
    texts = [
        file
        for room in ("src", "tests", "benchmarks", "examples")
        for file in (ROOT / room).rglob("*.py")
    ]
    texts += [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    added = set(
        re.findall(r"^# (src/\S+)", (ROOT / "docs" / "add-a-method.md").read_text(), re.MULTILINE)
    )
    named = re.compile(
        r"(?<![\w/.-])(?:tests|src|docs|examples|benchmarks)/[\w/-]+\.(?:py|md|yaml)\b"
    )
    gone = {
        (str(file.relative_to(ROOT)), name)
        for file in texts
        for name in named.findall(file.read_text(encoding="utf-8"))
        if name not in added and not (ROOT / name).exists() and not (file.parent / name).exists()
    }
    assert gone == set()
