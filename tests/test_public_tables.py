"""The tables of the planner and its peers in the docs are what the committed runs say."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "benchmarks"))
import public_sets  # noqa: E402  the commands that made them
import scaling  # noqa: E402  likewise

DOCS = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8").splitlines()
RESULTS = ROOT / "benchmarks" / "results"
ROWS, LONG, BATTERY = (
    public_sets.read(RESULTS / f"public_sets_{name}.csv")
    for name in ("sample", "sample_30s", "battery")
)
SOLVERS = ("tandem", "cp-sat", "pyjobshop")
ALL = (*SOLVERS, "airbus")


def _told(rows: list[public_sets.Row], name: str, solver: str) -> str:
    mine = [row for row in rows if (row.set, row.solver) == (name, solver)]
    gaps = [row.gap for row in mine if row.gap is not None]
    none = len(mine) - len(gaps)
    mean = f"{sum(gaps) / len(gaps):.2%}".replace("%", " %") if gaps else ""
    said = f"{mean}{f' ({none} none)' if none else ''}" if gaps else "nothing"
    return f"{sum(row.proven for row in mine)}, {said}"


@pytest.mark.parametrize("name", sorted({row.set for row in ROWS}))
def test_each_set_of_the_sample_stands_in_the_docs_as_it_was_measured(name: str) -> None:
    assert f"| {name} | {' | '.join(_told(ROWS, name, solver) for solver in ALL)} |" in DOCS


@pytest.mark.parametrize("name", sorted({row.set for row in LONG}))
def test_thirty_seconds_stand_in_the_docs_as_they_were_measured(name: str) -> None:
    told = [_told(LONG, name, solver) for solver in SOLVERS]
    assert f"| {name} | {' | '.join(told)} |" in DOCS


@pytest.mark.parametrize("name", sorted({row.instance for row in BATTERY}))
def test_battery_cells_stand_in_the_docs_with_what_their_proofs_took(name: str) -> None:
    mine = {row.solver: row for row in BATTERY if row.instance == name}
    assert all(row.proven for row in mine.values())
    told = [f"{mine[solver].cpu_s:.1f} s of a core" for solver in SOLVERS]
    assert f"| {name} | {' | '.join(told)} |" in DOCS


def test_whole_sets_stand_in_the_docs_as_they_were_measured() -> None:
    rows = public_sets.read(RESULTS / "public_sets_whole.csv")
    for name in {row.set for row in rows}:
        count = len({row.instance for row in rows if row.set == name})
        told = [_told(rows, name, solver) for solver in ("tandem", "pyjobshop")]
        assert f"| {name} | {count} | {' | '.join(told)} |" in DOCS
    for short, name in (("brandimarte", "fjsp_brandimarte"), ("dag", "fjsp_dag_birgin")):
        rows = public_sets.read(RESULTS / f"public_sets_{short}_30s.csv")
        assert any(f"{_told(rows, name, 'tandem')}" in line for line in DOCS)


def test_scaling_stands_in_the_docs_as_it_was_measured() -> None:
    rows = scaling.read(RESULTS / "scaling.csv")
    for tasks, seconds in {(row.tasks, row.seconds) for row in rows}:
        told, seeds = [], {row.seed for row in rows if row.tasks == tasks}
        for solver in ALL:
            mine = [r for r in rows if (r.tasks, r.solver, r.seconds) == (tasks, solver, seconds)]
            gaps = [100 * row.gap for row in mine if row.gap is not None]
            mean = sum(gaps) / max(len(gaps), 1)
            none = f" ({len(mine) - len(gaps)} none)" if len(gaps) < len(mine) else ""
            shown = f"{mean:.0f} %{none}" if mean >= 100 else f"{mean:.1f} %{none}"
            told.append(f"**{shown}**" if solver == "tandem" else shown if gaps else "–")
        begin = f"| {tasks:,} | 4 | {len(seeds)} | {seconds:g} s |"
        assert f"{begin} {' | '.join(told)} |" in DOCS


def test_fronts_stand_in_the_docs_as_they_were_measured() -> None:
    document = json.loads((RESULTS / "front_quality.json").read_text(encoding="utf-8"))
    limits = [f"{seconds:g}" for seconds in document["seconds"]]
    rows = [(row["cell"], row["gap"]) for row in document["rows"]]
    means = {
        solver: {s: sum(gap[solver][s] for _, gap in rows) / len(rows) for s in limits}
        for solver in rows[0][1]
    }
    for name, gap in [*rows, ("mean", means)]:
        told = [
            " / ".join(f"{100 * gap[solver][s]:.1f}" for s in limits) + " %"
            for solver in ("tandem", "tandem again", "cp-sat", "pyjobshop")
        ]
        assert f"| {name} | {' | '.join(told)} |" in DOCS
