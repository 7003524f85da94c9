"""The table of public sets in the docs is what the committed runs say."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "benchmarks"))
import public_sets  # noqa: E402  the command that made them

DOCS = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8").splitlines()
ROWS = public_sets.read(ROOT / "benchmarks" / "results" / "public_sets_sample.csv")
SOLVERS = ("tandem", "cp-sat", "pyjobshop")


def _told(name: str, solver: str) -> str:
    mine = [row for row in ROWS if (row.set, row.solver) == (name, solver)]
    gaps = [row.gap for row in mine if row.gap is not None]
    none = len(mine) - len(gaps)
    mean = f"{sum(gaps) / len(gaps):.2%}".replace("%", " %") if gaps else ""
    said = f"{mean}{f' ({none} none)' if none else ''}" if gaps else "nothing"
    return f"{sum(row.proven for row in mine)}, {said}"


@pytest.mark.parametrize("name", sorted({row.set for row in ROWS}))
def test_each_set_of_the_sample_stands_in_the_docs_as_it_was_measured(name: str) -> None:
    assert f"| {name} | {' | '.join(_told(name, solver) for solver in SOLVERS)} |" in DOCS
