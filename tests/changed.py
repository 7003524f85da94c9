"""`pytest --changed`: only the tests that a change can break, so that a developer hears of it
within two minutes.

A test file runs when it was changed itself, when it stands in the room of a changed module, or when
what it imports leads down to one. Tests that are marked slow run only in the room that was changed;
the whole suite (`python3 dev.py test`) runs them all.
"""

from __future__ import annotations

import ast
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[1]
EVERYTHING = ("pyproject.toml", "constraints.txt", "tests/conftest.py")
"""What all tests depend on."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--changed",
        nargs="?",
        const="",
        default=None,
        metavar="COMMIT",
        help=(
            "Run only what differs from COMMIT can break: from HEAD where the tree is dirty, else"
            " from the commit before."
        ),
    )


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    since = config.getoption("--changed")
    if since is None:
        return
    files = changed_files(since)
    kept = [item for item in items if _concerns(item, files)]
    config.hook.pytest_deselected(items=[item for item in items if item not in set(kept)])
    items[:] = kept


def changed_files(since: str = "") -> frozenset[str]:
    """The files that differ from the commit, as paths from the root; also those that git does not
    know yet.
    """
    new = _git("ls-files", "--others", "--exclude-standard")
    since = since or ("HEAD" if new or _git("diff", "--name-only", "HEAD") else "HEAD~1")
    return frozenset(new + _git("diff", "--name-only", since))


def _git(*arguments: str) -> list[str]:
    return subprocess.run(
        ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split("\n")[:-1]


def _concerns(item: pytest.Item, files: frozenset[str]) -> bool:
    is_quick = item.get_closest_marker("slow") is None
    if files & set(EVERYTHING):
        return is_quick
    file = item.path.relative_to(ROOT).as_posix()
    if file in files or (
        room_of(file) in {room_of(name) for name in files if name.startswith("src/")}
    ):
        return True
    return is_quick and bool(_imports(item.path) & _downstream(files))


def room_of(file: str) -> tuple[str, ...]:
    """The room of a source or test file: its first folder, in the laboratory the paper's too."""
    folders = Path(file.removeprefix("src/tandem/").removeprefix("tests/")).parts[:-1]
    return folders[: 2 if folders[:1] == ("lab",) else 1]


@cache
def _graph() -> Any:
    """What imports what, and that the command line finds its commands by name."""
    import grimp

    from tandem.cli.root import VERBS

    graph = grimp.build_graph("tandem")
    for module, _ in VERBS.values():
        graph.add_import(importer="tandem.cli.root", imported=module)
    return graph


@cache
def _downstream(files: frozenset[str]) -> frozenset[str]:
    """The modules that a change of these files can break."""
    graph = _graph()
    found = set()
    for name in files:
        if name.startswith("src/tandem/") and name.endswith(".py"):
            module = ".".join(Path(name).with_suffix("").parts[1:]).removesuffix(".__init__")
            if module in graph.modules:
                found |= {module, *graph.find_downstream_modules(module)}
    return frozenset(found)


@cache
def _imports(path: Path) -> frozenset[str]:
    """The modules of Tandem that a test file imports itself, or through the helpers of other
    tests.
    """
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        named = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom) and node.module:
            named = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        for name in named:
            helper = ROOT / Path(*name.split(".")).with_suffix(".py")
            found |= _imports(helper) if name.startswith("tests.") and helper.exists() else {name}
    return frozenset(found)
