"""`pytest --changed`: only the tests that a change can break, so that one hears of it soon.

A test file runs when it was changed itself, when it stands in the room of a changed file, or when
what it imports leads down to a changed module. Of the commands that it calls on the command line
only those count that it names. A change of a page runs the tests that read the pages, one of an
example those that name it. Tests that are marked slow run only in the room that was changed; the
whole suite (`python3 dev.py test`) runs them all.

Nearest first: what fewer imports part from the change runs earlier, and after two minutes
(`--within`) no more begins. How many did not is one line at the end.
"""

from __future__ import annotations

import ast
import re
import subprocess
import time
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[1]
EVERYTHING = ("pyproject.toml", "constraints.txt", "tests/conftest.py")
"""What all tests depend on."""
COMMANDS = "tandem.cli.root"
"""The module that finds commands by their names. Nothing else imports it but tests."""
ADDED = {
    "environments": "tandem.envs.registry",
    "gymnasium": "tandem.envs.registry",
    "recipes": "tandem.learn.training.recipes",
    "algorithms": "tandem.learn.training.algorithms",
    "deciders": "tandem.learn.training.algorithms",
}
"""Group of entry points -> the module whose table they fill: it loads them by their names."""
SECONDS = 120.0
"""After so many no test begins any more, unless told otherwise."""
READ = ("docs/", "README.md", "CONTRIBUTING.md", "examples/", "benchmarks/", "dev.py")
"""What tests read as files."""


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

    parser.addoption(
        "--within",
        type=float,
        default=SECONDS,
        metavar="SECONDS",
        help=f"With --changed: after so many no test begins any more; 0 runs all. [{SECONDS:g}]",
    )


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("--changed") is not None and config.getoption("--within"):
        config.pluginmanager.register(Deadline(config.getoption("--within")), "changed-deadline")


class Deadline:
    """Skips what has not begun when the time is over. What is under way ends."""

    def __init__(self, seconds: float) -> None:
        self.seconds, self.began = seconds, time.monotonic()

    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        if time.monotonic() - self.began > self.seconds:
            pytest.skip(
                f"{self.seconds:g} s are over: further from the change than what ran; `--within 0`"
                " and the whole suite run it"
            )


@pytest.hookimpl(trylast=True)  # rooms mark their slow tests first
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    since = config.getoption("--changed")
    if since is None:
        return
    files = changed_files(since)
    steps = {item: _steps_to(item, files) for item in items}
    kept = [item for item in items if steps[item] is not None]
    config.hook.pytest_deselected(items=[item for item in items if steps[item] is None])
    items[:] = sorted(kept, key=lambda item: steps[item] or 0)


def changed_files(since: str = "") -> frozenset[str]:
    """The files that differ from the commit, as paths from the root; also those that git does not
    know yet.
    """
    new = _git("ls-files", "--others", "--exclude-standard")
    since = since or ("HEAD" if new or _git("diff", "--name-only", "HEAD") else "HEAD~1")
    return frozenset(new + _git("diff", "--name-only", since))


def _git(*arguments: str) -> list[str]:
    found = subprocess.run(
        ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return found.stdout.split("\n")[:-1]


def _steps_to(item: pytest.Item, files: frozenset[str]) -> int | None:
    """How many imports part the test from what was changed; None when that cannot break it."""
    is_quick = item.get_closest_marker("slow") is None
    if files & set(EVERYTHING):
        return 0 if is_quick else None
    file = item.path.relative_to(ROOT).as_posix()
    rooms = {room_of(name) for name in files if name.startswith("src/")}
    if file in files or room_of(file) in rooms:
        return 0
    if not is_quick:
        return None
    found = [steps for module, steps in downstream(files).items() if module in needs(item.path)]
    return min(found, default=1 if _reads(item.path, files) else None)


def room_of(file: str) -> tuple[str, ...]:
    """The room of a source or test file: its first folder, in the laboratory the paper's too."""
    folders = Path(file.removeprefix("src/tandem/").removeprefix("tests/")).parts[:-1]
    return folders[: 2 if folders[:1] == ("lab",) else 1] or ("",)


@cache
def _graph() -> Any:
    """What imports what, and which modules are found by their names in entry points."""
    import grimp

    from tandem.extensions import added

    graph = grimp.build_graph("tandem", cache_dir=None)
    for group, table in ADDED.items():
        for home in added(group).values():
            if (module := home.split(":")[0]) in graph.modules:
                graph.add_import(importer=table, imported=module)
    return graph


@cache
def downstream(files: frozenset[str]) -> Mapping[str, int]:
    """The modules that a change of these files can break -> by how many imports they are reached;
    0 are the changed ones.
    """
    found: dict[str, int] = {}
    edge = {module for name in files if (module := module_of(name)) in _graph().modules}
    while edge:
        found |= dict.fromkeys(edge, max(found.values(), default=-1) + 1)
        edge = {
            above
            for module in edge
            for above in _graph().find_modules_that_directly_import(module)
            if above not in found
        }
    return found


def module_of(file: str) -> str | None:
    """The module that a source file is; None of any other file."""
    if not (file.startswith("src/tandem/") and file.endswith(".py")):
        return None
    return ".".join(Path(file).with_suffix("").parts[1:]).removesuffix(".__init__")


@cache
def needs(path: Path) -> frozenset[str]:
    """The modules of Tandem that a test file imports, itself or through the helpers of other tests,
    and those of the commands that it calls."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    found = set()
    for name in _imported(tree):
        helper = ROOT / Path(*name.split(".")).with_suffix(".py")
        found |= needs(helper) if name.startswith("tests.") and helper.exists() else {name}
    strings = _strings(tree)
    if COMMANDS in found or ("-m" in strings and {"tandem", "tandem.cli"} & set(strings)):
        found |= _commands(strings)
    return frozenset(found)


def _imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _strings(tree: ast.Module) -> list[str]:
    return [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]


def _commands(strings: list[str]) -> set[str]:
    """The modules of the commands whose names stand at the head of a text; of all where none
    does.
    """
    from tandem.cli.root import VERBS

    lines = [text for text in strings if text.strip() and not re.search(r"[\n;]", text)]
    heads = {text.split()[0] for text in lines}  # what has more lines is a program or a file
    called = {module for verb, (module, *_) in VERBS.items() if verb in heads}
    return called or {module for module, *_ in VERBS.values()}


@cache
def _reads(path: Path, files: frozenset[str]) -> bool:
    """Whether the test file names one of the changed files that tests read, or its folder."""
    text = path.read_text(encoding="utf-8")
    for name in (name for name in files if name.startswith(READ)):
        folder = name.split("/")[0]
        if name in text or re.search(rf"[\"']{re.escape(folder)}[\"']", text):
            return True
    return False
