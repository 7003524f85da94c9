"""What can be chosen by a name stands in a table; each of its lines has help, a page and a test.

A table says in the docstring below it that "a new one is a line here", and this file finds it by
that.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Callable, Iterator
from functools import cache
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
sys.path.insert(0, str(ROOT / "docs"))

import reference  # noqa: E402
from tandem.extensions import added, extended, resolved  # noqa: E402


def first_line(thing: Any) -> str:
    return (inspect.getdoc(thing) or "").partition("\n")[0]


HELP: dict[str, Callable[[Any], str]] = {
    "tandem.cli.root.VERBS": lambda verb: verb[2],
    "tandem.dispatch.deciders.table.POLICIES": lambda entry: entry.what,
    "tandem.dispatch.situation.events.KINDS": lambda kind: kind.what,
    "tandem.envs.registry.PARALLEL": lambda home: first_line(resolved(home)),
    "tandem.envs.registry.SINGLE": lambda home: first_line(resolved(home)),
    "tandem.files.formats.table.FORMATS": lambda form: form.what,
    "tandem.files.formats.table.WRITERS": lambda form: form.what,
    "tandem.lab.systems.SYSTEMS": lambda system: system.title,
    "tandem.lab.yu2020.players.PLAYERS": first_line,
    "tandem.learn.training.algorithms.ALGORITHMS": lambda home: first_line(resolved(home)),
    "tandem.learn.training.algorithms.DECIDERS": lambda home: first_line(resolved(home)),
    "tandem.learn.training.recipes.RECIPES": lambda recipe: recipe.what,
    "tandem.plan.methods.METHODS": lambda entry: entry.what,
    "tandem.plan.opening.OPENINGS": first_line,
    "tandem.plan.rules.SPECS": lambda rule: rule.what,
    "tandem.report.files.EXPORTERS": lambda exporter: exporter.what,
    "tandem.studio.jobs.JOBS": lambda job: first_line(job.do),
    "tandem.world.behaviour.KINDS": lambda kind: kind.what,
}
"""Every table -> what one of its lines says of itself."""

NEED_LEARN = ("tandem.envs", "tandem.learn", "tandem.lab", "tandem.dispatch")


def growing() -> Iterator[str]:
    """The tables of the package that say of themselves that they grow."""
    for path in sorted((ROOT / "src").rglob("*.py")):
        body = ast.parse(path.read_text("utf-8")).body
        for table, below in pairwise(body):
            match table, below:
                case (
                    ast.Assign(targets=[ast.Name(id=name)])
                    | ast.AnnAssign(target=ast.Name(id=name)),
                    ast.Expr(value=ast.Constant(value=str(text))),
                ) if re.search(r"a\s+line\s+here", text):
                    yield ".".join([*path.relative_to(ROOT / "src").with_suffix("").parts, name])


def test_every_table_that_grows_is_walked_here() -> None:
    assert set(growing()) == set(HELP)


@cache
def names_on_pages() -> str:
    """All code that the pages show, with the tables that are filled in when they are built."""
    text = "\n".join(page.read_text("utf-8") for page in PAGES)
    for name in ("format", "method"):
        assert f"<!-- {name} reference -->" in text
        text += reference.REFERENCES[name]()
    return "\n".join(re.findall(r"^```.*?^```|`[^`\n]+`", text, re.DOTALL | re.MULTILINE))


@cache
def strings_of_tests() -> str:
    """All texts in the code of the tests, docstrings left out, and the modules that they import."""
    return "\n".join(
        text
        for path in (ROOT / "tests").rglob("*.py")
        for text in _strings(path)
        if path != Path(__file__)
    )


def _strings(path: Path) -> Iterator[str]:
    tree = ast.parse(path.read_text("utf-8"))
    told = {node.value for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in told:
            yield node.value
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def lines(table: str) -> dict[str, Any]:
    module, _, name = table.rpartition(".")
    if module.startswith(NEED_LEARN):
        pytest.importorskip("jax", reason="needs tandem[learn]")
    return dict(getattr(import_module(module), name))


@pytest.mark.parametrize("table", HELP)
def test_every_line_says_in_one_line_what_it_is(table: str) -> None:
    said = {name: HELP[table](line) for name, line in lines(table).items()}
    assert [name for name, text in said.items() if not 8 <= len(text) <= 160 or "\n" in text] == []
    assert all(text.strip() == text for text in said.values())


@pytest.mark.parametrize("table", HELP)
def test_every_line_is_named_on_a_page(table: str) -> None:
    assert [name for name in lines(table) if not named(name, names_on_pages())] == []


@pytest.mark.parametrize("table", HELP)
def test_every_line_is_named_in_a_test(table: str) -> None:
    assert [name for name in lines(table) if not named(name, strings_of_tests())] == []


def named(name: str, text: str) -> bool:
    return re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", text) is not None


def test_a_name_within_another_one_does_not_count() -> None:
    assert named("replan", "--policy replan,fixed")
    assert not named("replan", "--policy replan-robust")


def test_the_help_of_plan_names_every_ending_that_it_can_write() -> None:
    from tandem.cli.planning import plan_command
    from tandem.report.files import EXPORTERS

    (output,) = [option for option in plan_command.params if option.name == "outputs"]
    assert [ending for ending in EXPORTERS if ending not in output.help] == []


def test_the_help_of_train_lists_every_recipe() -> None:
    pytest.importorskip("jax", reason="needs tandem[learn]")
    from click import Context

    from tandem.cli.learn import train_command
    from tandem.learn.training.recipes import RECIPES

    told = " ".join(train_command.get_help(Context(train_command)).split())
    assert [name for name, recipe in RECIPES.items() if f"{name} {recipe.what}" not in told] == []


def test_a_name_that_tandem_has_stays_tandems() -> None:
    ours = {"thesis": "tandem.mine:OURS"}
    table = extended("recipes", ours)
    assert table["thesis"] == "tandem.mine:OURS"
    assert table["yu2020"] == "tandem.lab.yu2020.recipe:YU_2020"


def test_what_the_laboratory_adds_is_found_by_entry_points_alone() -> None:
    assert set(added("environments")) >= {"thesis", "chessboard", "grid", "duo"}
    assert set(added("gymnasium")) >= {"tandem/Thesis-v0", "tandem/Repair-v0"}
    assert set(added("recipes")) >= {"thesis", "station", "yu2020", "yu2021"}
