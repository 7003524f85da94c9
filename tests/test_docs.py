"""The documentation says what the code does: every key, format, method, command and option is in
it, and its examples run.
"""

from __future__ import annotations

import re
import shlex
import shutil
import sys
import types
from pathlib import Path
from pkgutil import resolve_name

import click
import pytest

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))

import reference  # noqa: E402
from tandem.cli.root import run  # noqa: E402

PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]
COMMANDS = dict(reference.commands())
OUTERMOST = {"-h", "--help", "--version"}


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of that language."""
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)


def written() -> str:
    """All that people wrote, without what is generated."""
    return "\n".join(page.read_text() for page in PAGES)


def test_every_key_of_a_cell_file_is_explained() -> None:
    tables = reference.cell_reference()
    rows = dict(re.findall(r"^\| `(\w+)` \|.*\| (.*) \|$", tables, re.MULTILINE))
    assert set(reference.keys()) <= set(rows)
    assert [key for key, meaning in rows.items() if not meaning.strip()] == []


@pytest.mark.parametrize("path", COMMANDS)
def test_every_command_and_option_is_explained(path: str) -> None:
    section = reference.command_reference().partition(f"## {path}\n")[2].partition("\n## ")[0]
    command = COMMANDS[path]
    assert command.help, f"{path} has no help text"
    for option in command.params:
        if isinstance(option, click.Option) and not option.hidden:
            assert all(name in section for name in option.opts)
            assert option.help or set(option.opts) & OUTERMOST, (
                f"{path} {option.opts} has no help text"
            )


def test_people_wrote_about_every_command() -> None:
    text = written()
    assert [path for path in COMMANDS if path not in text] == []


def test_every_option_that_the_pages_use_exists() -> None:
    known = {
        name
        for command in COMMANDS.values()
        for option in command.params
        for name in [*option.opts, *option.secondary_opts]
    } | {"--help"}
    used = set(re.findall(r"tandem [^`\n]*", written()))
    wrong = {word for line in used for word in re.findall(r"(?<=\s)--[a-z][a-z-]*", line)} - known
    assert wrong == set()


def test_every_benchmark_is_described() -> None:
    page = (DOCS / "benchmarks.md").read_text()
    programs = [
        path
        for path in (ROOT / "benchmarks").glob("*.py")
        if '__name__ == "__main__"' in path.read_text()
    ]
    assert [path.stem for path in programs if f"| `{path.stem}` |" not in page] == []


def test_every_page_is_reachable() -> None:
    listed = set(re.findall(r"^([a-z-]+)$", (DOCS / "index.md").read_text(), re.MULTILINE))
    assert listed == {page.stem for page in DOCS.glob("*.md")} - {"index"}


@pytest.mark.parametrize(
    "page", [page for page in PAGES if blocks(page, "python")], ids=lambda page: page.name
)
def test_the_python_examples_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if page.name in ("environments.md", "learning.md", "yu.md", "people.md"):
        pytest.importorskip("pettingzoo", reason="needs tandem[learn]")
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    assert run(["template", "-o", "tasks.xlsx"]) == 0
    module = types.ModuleType(page.stem.replace("-", "_"))
    monkeypatch.setitem(sys.modules, module.__name__, module)  # where a dataclass looks
    for block in blocks(page, "python"):
        exec(compile(block, str(page), "exec"), module.__dict__)
    assert "23.0 7.0" in capsys.readouterr().out or page.name != "python.md"


CONSOLE = [(page, block) for page in PAGES for block in blocks(page, "console")]


@pytest.mark.parametrize(
    ("page", "block"), CONSOLE, ids=[f"{page.name}-{i}" for i, (page, _) in enumerate(CONSOLE)]
)
def test_the_commands_that_are_shown_run_and_print_what_is_shown(
    page: Path,
    block: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Lines that begin with `$` are run in a folder that holds `examples`; what stands below must
    be what was printed, seconds of computing aside.
    """
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "90")
    for command, shown in re.findall(r"^\$ tandem (.*)\n((?:(?!\$ ).*\n)*)", block, re.MULTILINE):
        code = run(
            [*shlex.split(command), *(["--workers", "1"] if command.startswith("plan") else [])]
        )
        printed = capfd.readouterr()
        assert code == 0, printed.err
        if shown.strip():
            assert settled(shown) in settled(printed.out)


def settled(text: str) -> str:
    """Without what changes from run to run: seconds of computing, and where lines are broken for
    it.
    """
    return re.sub(r"\d+(\.\d+)? s, cp-sat [\d.]+", "* s, cp-sat *", " ".join(text.split()))


def named_in_code(pattern: str) -> set[tuple[str, str]]:
    """Page and match of all that stands in the pages' code; the page that adds files adds its
    own.
    """
    pages = [page for page in PAGES if page.name != "add-a-method.md"]
    return {
        (page.name, name)
        for page in pages
        for code in re.findall(r"^```.*?^```|`[^`\n]+`", page.read_text(), re.DOTALL | re.MULTILINE)
        for name in re.findall(pattern, code)
    }


GROUPS = {
    f"tandem.{name}"
    for name in (
        "environments",
        "gymnasium",
        "recipes",
        "algorithms",
        "deciders",
        "policies",
        "methods",
        "people",
        "rewards",
    )
}


def test_every_name_of_the_package_on_the_pages_is_there() -> None:
    names = named_in_code(r"(?<![\w./-])tandem(?:\.[A-Za-z_]\w*)+")
    lost = [(page, name) for page, name in names if name not in GROUPS and not is_there(name)]
    assert lost == []


def is_there(name: str) -> bool:
    """Whether it leads to a module, or to something in one."""
    try:
        resolve_name(name)
    except (ImportError, AttributeError):
        return False
    return True


def test_every_file_on_the_pages_is_there() -> None:
    """By its path from the root, from the package, or from a room of it."""
    rooms = [ROOT, ROOT / "src" / "tandem", *(ROOT / "src" / "tandem").iterdir()]
    paths = named_in_code(r"(?<![\w./-])[a-z][\w-]*(?:/[\w-]+)+\.(?:py|yaml|json|csv|md)\b")
    ours = {
        (page, path)
        for page, path in paths
        if not path.startswith(("results/", "line/", "line-3/", "tandem-out/", "runs/"))
    }
    assert [
        (page, path) for page, path in ours if not any((room / path).exists() for room in rooms)
    ] == []
