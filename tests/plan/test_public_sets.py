"""Public instances: the values known for them are met, and the committed table of the benchmark is
consistent with them.
"""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
from tests.benchmark_data import folder

from tandem.files.load import load
from tandem.plan.methods import plan
from tandem.schedule.checker import faults

TABLE = Path(__file__).parents[2] / "benchmarks" / "results" / "public_sets.csv"
QUICK = {
    "fjsp_kacem": ["k1", "k2", "k3"],
    "fjsp_fattahi": ["sfjs01", "sfjs05", "sfjs09", "mfjs01", "mfjs03"],
    "fjsp_dag_mini": ["miniDAFJS01", "miniDAFJS13", "miniYFJS04", "miniYFJS08"],
    "fjsp_dag_birgin": ["YFJS01", "DAFJS01"],
    "fjsp_brandimarte": ["mk01"],
    "hrc_case_studies": ["pearce2015_p1", "pearce2015_p2", "pearce2015_p3", "truss_wang2025_ur5e"],
    "hrc_battery_cells": ["battery_H1R1"],
}


def known(name: str) -> dict[str, tuple[float, float]]:
    """Instance -> (lower, upper) bound known."""
    with open(folder(name) / "best_known.csv", newline="", encoding="utf-8") as file:
        return {
            row["instance"]: (float(row["lower_bound"]), float(row["upper_bound"]))
            for row in csv.DictReader(file)
        }


@pytest.mark.parametrize(
    ("name", "instance"),
    [(name, instance) for name, instances in QUICK.items() for instance in instances],
)
def test_the_optimum_known_is_found_and_proven(name, instance):
    path = next(
        path
        for path in folder(name).iterdir()
        if path.stem == instance and path.suffix not in (".csv", ".md")
    )
    lower, upper = known(name)[instance]
    assert lower == upper
    front = plan(load(path), minimize="makespan", time_limit=120)
    assert front.complete
    assert front[0].makespan == upper
    assert faults(front.cell, front[0].schedule) == []


@pytest.mark.parametrize("instance", ["pearce2018_p1", "pearce2018_p2", "pearce2018_p3"])
@pytest.mark.parametrize("method", ["exact", "exhaustive"])
def test_the_fronts_of_makespan_and_strain_index(instance, method):
    """Pearce et al. (2018): the Strain Index of a set of tasks does not add up, so the cell holds
    it as a table.
    """
    data = folder("hrc_case_studies")
    with open(data / "pareto.csv", newline="", encoding="utf-8") as file:
        wanted = [
            (float(row["makespan"]), float(row["strain_index"]))
            for row in csv.DictReader(file)
            if row["instance"] == instance
        ]
    front = plan(load(data / f"{instance}.json"), method=method)
    assert front.complete
    assert front.points == wanted


def test_the_committed_table_contradicts_no_bound():
    with open(TABLE, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["solver"] == "tandem"]
    assert {row["set"] for row in rows} == set(QUICK)
    for row in rows:
        assert float(row["lower_known"]) <= float(row["makespan"]), row
        assert float(row["bound"]) <= float(row["upper_known"]), row
        assert float(row["bound"]) <= float(row["makespan"]), row
        assert (row["proven"] == "True") == (float(row["bound"]) == float(row["makespan"])), row
