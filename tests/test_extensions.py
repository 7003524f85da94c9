"""Tables that others may add to: by entry points and by dotted names, and what is said when that
goes wrong.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from tandem import extensions
from tandem.cli.root import run
from tandem.errors import UsageError
from tandem.extensions import Table, is_dotted

ROOT = Path(__file__).resolve().parents[1]
CELL = str(ROOT / "examples" / "thesis.yaml")
Capture = pytest.CaptureFixture[str]


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], str]:
    """Writes a module that Python finds; gives its name."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def written(text: str) -> str:
        name = f"own_{tmp_path.name.replace('-', '_')}"
        (tmp_path / f"{name}.py").write_text(text, "utf-8")
        sys.modules.pop(name, None)
        return name

    return written


@pytest.fixture
def installed(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Pretends that a package with these entry points is installed: `name="module:attribute"`."""

    def add(**entries: str) -> None:
        found = [EntryPoint(name, home, "tandem.x") for name, home in entries.items()]
        monkeypatch.setattr(extensions, "entry_points", lambda *, group: found)

    return add


def test_a_dotted_name_says_module_and_attribute() -> None:
    assert is_dotted("package.module:make")
    assert is_dotted("module:Class.make")
    for name in ("fixed", "own:", ":make", "random:0.5", "a b:c", "package.module"):
        assert not is_dotted(name)


def test_one_broken_package_is_told_and_the_others_go_on(
    installed: Callable[..., None], module: Callable[[str], str]
) -> None:
    home = module("good = 1\n")
    installed(good=f"{home}:good", gone="nowhere.at_all:x", wrong="no place")
    table: Table[int] = Table("x", {"ours": 0})
    assert list(table) == ["ours", "gone", "good", "wrong"], "nothing is imported to list them"
    assert table.sound() == {"ours": 0, "good": 1}
    told = table.told(str)
    assert told["good"] == "1"
    assert "No module named 'nowhere'" in told["gone"]
    assert "package.module:attribute" in told["wrong"]
    with pytest.raises(UsageError, match=r"'gone' of tandem\.x.*nowhere\.at_all:x"):
        table["gone"]


def test_a_package_that_fails_while_it_is_imported_says_what_failed(
    installed: Callable[..., None], module: Callable[[str], str]
) -> None:
    installed(bad=f"{module('1 / 0')}:x")
    with pytest.raises(UsageError, match=r"'bad'.*ZeroDivisionError: division by zero"):
        Table("x", {})["bad"]


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (
            ["plan", CELL, "--method", "nowhere.at_all:plan"],
            "nowhere.at_all:plan: cannot be loaded",
        ),
        (["plan", CELL, "--method", "math:pi"], "math:pi: is 3.14"),
        (["plan", CELL, "--method", "math:sqrt"], "math:sqrt: TypeError"),
        (["plan", CELL, "--method", "exakt"], "Did you mean 'exact'?"),
    ],
)
def test_a_wrong_method_is_wrong_usage(command: list[str], message: str, capsys: Capture) -> None:
    assert run([*command, "-q"]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert "bug" not in said


def test_a_method_of_ones_own_is_judged_by_the_checker(
    module: Callable[[str], str], capsys: Capture
) -> None:
    """It moves the optimum's last task to the start."""
    home = module(
        "from dataclasses import replace\n"
        "from tandem.plan.exact import solve\n"
        "from tandem.schedule.model import Schedule\n"
        "def plan(cell, question, **options):\n"
        "    front = solve(cell, question, **options)\n"
        "    first = front[0]\n"
        "    *steps, last = first.schedule\n"
        "    moved = replace(last, start=0, end=last.end - last.start)\n"
        "    wrong = replace(first, schedule=Schedule((*steps, moved)))\n"
        "    return replace(front, results=(wrong,))\n"
    )
    assert run(["plan", CELL, "--method", f"{home}:plan", "-q"]) == 6
    assert f"{home}:plan" in capsys.readouterr().err


needs_learn = pytest.mark.usefixtures("learn")


@pytest.fixture
def learn() -> None:
    pytest.importorskip("jax", reason="needs tandem[learn]")


@needs_learn
@pytest.mark.parametrize(
    ("command", "message"),
    [
        (["simulate", CELL, "--policy", "fixed,nowhere:make"], "nowhere:make: cannot be loaded"),
        (["simulate", CELL, "--policy", "math:pi"], "math:pi: is 3.14"),
        (["simulate", CELL, "--policy", "math:sqrt"], "math:sqrt: TypeError"),
        (["simulate", CELL, "--policy", "fixed", "--people", "math:pi"], "no kind of person"),
        (["simulate", CELL, "--policy", "fixed", "--people", "randon:half"], "'random'"),
        (["train", CELL, "--recipe", "math:pi"], "math:pi: is 3.14"),
        (["train", CELL, "--recipe", "nowhere:R"], "nowhere:R: cannot be loaded"),
        (["train", CELL, "--people", "math:pi"], "tandem.people"),
        (["dispatch", CELL, "--policy", "nowhere:make", "--simulate", "compliant"], "nowhere:make"),
    ],
)
def test_a_wrong_dotted_name_is_wrong_usage(
    command: list[str],
    message: str,
    capsys: Capture,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(command) == 2
    said = capsys.readouterr().err
    assert message in said
    assert "bug" not in said


@needs_learn
def test_a_kind_of_person_of_ones_own_takes_numbers_and_joins_others(
    module: Callable[[str], str], capsys: Capture
) -> None:
    home = module(
        "from tandem.world.behaviour import Kind, Setting\n"
        "CAREFUL = Kind('needs more time', 'careful:1.25',\n"
        "    lambda made: {'pace': made.numbers['factor']}, {'factor': Setting(None, 0.1, 9.0)})\n"
    )
    people = f"{home}:CAREFUL:2+random:0,pace:2+random:0"
    asked = ["--policy", "fixed", "--people", people, "--episodes", "4", "--json", "-q"]
    assert run(["simulate", CELL, *asked]) == 0
    own, pace = json.loads(capsys.readouterr().out)
    assert own["people"] == f"{home}:CAREFUL:2+random:0"
    assert own["policies"][0]["makespan"] == pace["policies"][0]["makespan"]


@needs_learn
def test_no_population_file_makes_code_run(
    module: Callable[[str], str], tmp_path: Path, capsys: Capture
) -> None:
    home = module("raise SystemExit('ran')\n")
    file = tmp_path / "crew.yaml"
    file.write_text(
        f"format: 1\ntrain: [{{person: '{home}:X'}}]\nheld_out: [{{person: '{home}:X'}}]\n"
    )
    asked = ["--policy", "fixed", "--people", f"population:{file}", "--episodes", "4", "-q"]
    assert run(["simulate", CELL, *asked]) == 3
    assert "no file makes code run" in capsys.readouterr().err


@needs_learn
def test_a_recipe_of_ones_own_is_checked_like_any(
    module: Callable[[str], str], capsys: Capture
) -> None:
    home = module(
        "from dataclasses import replace\n"
        "from tandem.learn.ppo.recipes import TANDEM\n"
        "WIDE = replace(TANDEM, config=replace(TANDEM.config, hidden=(8, 8)))\n"
    )
    assert run(["train", CELL, "--recipe", f"{home}:WIDE", "--set", "config.hidden=[0]"]) == 2
    assert "config.hidden.0 0: must be 1 or more." in capsys.readouterr().err


@needs_learn
def test_a_refusal_names_the_recipes_that_can_take_the_cell(
    capsys: Capture, tmp_path: Path
) -> None:
    crew = str(ROOT / "examples" / "crew.yaml")
    assert run(["train", crew, "--recipe", "thesis", "--run", str(tmp_path / "run"), "-q"]) == 3
    *_, last = capsys.readouterr().err.strip().splitlines()
    named = last.partition("trained with ")[2].partition(":")[0].split(", ")
    assert {"tandem", "response", "alphazero", "dqn"} <= set(named)
    assert not {"thesis", "station", "yu2020"} & set(named)
    assert not (tmp_path / "run").exists()
