"""What commands print is prose and tables for people: no print of Python, no missing blank, no
plural of one.

Every command that answers in words is run on every example and on drawn cells with every feature.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from random import Random

import pytest
from tests.fuzz.cells import cell as drawn

import tandem
from tandem.cell.model import Cell
from tandem.cli.root import run
from tandem.errors import CellError

EXAMPLES = sorted(Path(__file__).parents[2].glob("examples/*.yaml"))

UNLIKE_PROSE = {
    "a mapping of Python": r"\{'|': [\[{\d]",
    "a list of Python": r"\['|'\]",
    "a tuple of Python": r"\('[^']*',|\(\d[\d.]*,\)",
    "None": r"\bNone\b|\bTrue\b|\bFalse\b",
    "no number": r"\b(nan|inf)\b",
    "a blank before a mark": r"\w ,|\w \.(\s|$)|\w ;",
    "a plural of one": (
        r"(?<![\d.,])1"
        r" (tasks|humans|robots|points|schedules|results|plans|operators|faults|events|decisions"
        r"|entries|others|lines)\b"
    ),
    "words run together": r"\b[a-z]{3,}[A-Z][a-z]{2,}",
    "an object": (
        r"<[a-z_.]+"
        r" object|\b(Decimal|Fraction|Fault|Mode|array|frozenset|mappingproxy)\(|np\.|float64"
    ),
    "two blanks in a sentence": r"^(?!.*\S {2,}\S.* {2,}\S)\S.*[a-z,;.:]  [a-z].*\.$",
    "two marks": r",,|;;|[,;]\.|\.{4}",
    # damage, such as 0.0000028, has zeros before its digits
    "a number with a tail of digits": r"(?<![\d.])(?!0\.0+[1-9]\d{0,5}(?!\d))\d+\.\d{7,}",
}


def odd_in(text: str) -> list[str]:
    """Lines that do not read like prose, each with why; what stands in backquotes is written as in
    a file.
    """
    text = re.sub(r"`[^`\n]*`", "`...`", text)
    return [
        f"{why}: {line}"
        for line in text.splitlines()
        for why, sign in UNLIKE_PROSE.items()
        if re.search(sign, line)
    ]


def said(command: list[str], capfd: pytest.CaptureFixture[str]) -> str:
    """Everything that the command prints; it may end in any way but a bug."""
    capfd.readouterr()
    assert run(command) != 1, (command, capfd.readouterr().err)
    return "\n".join(capfd.readouterr())


def commands(file: Path, cell: Cell, out: Path) -> list[list[str]]:
    """Every command that answers in words, on the cell."""
    name = str(file)
    first = next(iter(cell.tasks))
    way = cell.modes(first)[0]
    quick = ["--time-limit", "0.5", "--workers", "1"]
    change = (
        ["--set", f"tasks.{first}.time.{way.operators[0]}=-10%"]
        if len(way.operators) == 1
        else ["--set", f"tasks.{first}.label=first"]
    )
    floor = ["dispatch", name, "--words", "--simulate"]
    return [
        ["check", name],
        ["plan", name, "-q", *quick, "-o", str(out / "plan.json"), "-o", str(out / "plan.md")],
        ["plan", name, "-q", *quick, "--minimize", "makespan"],
        ["plan", name, "-q", *quick, "--max-stress", "0.001"],
        ["plan", name, "-q", *quick, *change],
        ["plan", name, "-q", *quick, "--without", next(iter(cell.operators))],
        ["check", name, str(out / "plan.json")],
        ["compare", str(out / "plan.json"), str(out / "plan.json"), "--point", "1"],
        ["explain", name, "--time-limit", "1", "--workers", "1"],
        [*floor, "random:0.5+pace:1.5", "--policy", "longest-tail"],
        [*floor, "forgetful:0.2", "--policy", "fixed", "--failures", "40", "--absences", "50"],
    ]


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_what_commands_say_of_an_example_reads_like_prose(
    file: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    for command in commands(file, tandem.load(str(file)), tmp_path):
        assert odd_in(said(command, capfd)) == [], command
    assert odd_in((tmp_path / "plan.md").read_text()) == []


@pytest.mark.slow
@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_what_would_help_reads_like_prose(file: Path, capfd: pytest.CaptureFixture[str]) -> None:
    asked = ["sensitivity", str(file), "--time-limit", "1", "--workers", "1", "-q", "--each"]
    assert odd_in(said(asked, capfd)) == []


def test_what_differs_between_two_examples_reads_like_prose(
    capfd: pytest.CaptureFixture[str],
) -> None:
    for before in EXAMPLES:
        for after in EXAMPLES:
            assert odd_in(said(["compare", str(before), str(after), "--no-plan"], capfd)) == [], (
                before,
                after,
            )


@pytest.mark.parametrize("seed", range(4))
def test_what_commands_say_of_drawn_cells_reads_like_prose(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], seed: int
) -> None:
    random, before = Random(seed), None
    for number in range(8):
        file = tmp_path / f"cell{number}.json"
        file.write_text(json.dumps(drawn(random)))
        assert odd_in(said(["check", str(file)], capfd)) == []
        try:
            cell = tandem.load(str(file))
        except CellError:
            continue  # it is no sound cell; what `check` says of it was read
        asked = (
            commands(file, cell, tmp_path)
            if number % 4 == 0
            else commands(file, cell, tmp_path)[:1]
        )
        if before is not None:
            asked += [["compare", str(before), str(file), "--no-plan"]]
        for command in asked:
            if command[0] in ("check", "compare") and not all(
                Path(name).exists() for name in command[1:3] if name.endswith(".json")
            ):
                continue  # the cell has no plan
            assert odd_in(said(command, capfd)) == [], command
        before = file
