"""The table of `benchmarks/axes.py` in the docs is what the committed run says, and the program
does what it measured.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROGRAM = [sys.executable, "benchmarks/axes.py"]


def told(*options: str) -> list[str]:
    """What the program prints."""
    ended = subprocess.run(
        [*PROGRAM, *options], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return ended.stdout.splitlines()


def test_the_docs_tell_what_is_kept() -> None:
    page = (ROOT / "docs" / "planning.md").read_text(encoding="utf-8")
    lines = [line for line in told("--show", "benchmarks/results/axes.json") if line]
    assert len(lines) > 3
    assert [line for line in lines if line not in page] == []


def test_a_small_run_proves_its_front() -> None:
    lines = told("--tasks", "8", "--people", "1", "--seeds", "1")
    assert lines[0].startswith("1 people, seed 0: ")
    assert ", proven, " in lines[0]
