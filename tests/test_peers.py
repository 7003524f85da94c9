"""The peers of the benchmarks are asked what Tandem is: on small cells all find the optimum."""

from __future__ import annotations

import importlib
import sys
from itertools import combinations
from pathlib import Path

import pytest

from tandem.files.generators import layered
from tandem.files.validate import cell_of
from tandem.plan.instance import Instance
from tandem.plan.methods import plan
from tandem.schedule.measures import makespan, stress

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "benchmarks"))
import peers  # noqa: E402  a program beside the package
import scaling  # noqa: E402  likewise

PACKAGES = {"cp-sat": "ortools", "pyjobshop": "pyjobshop", "airbus": "discrete_optimization"}


def _peer(name: str):
    try:
        importlib.import_module(PACKAGES[name])
    except ImportError:
        pytest.skip("needs tandem[bench]")
    return peers.PEERS[name]


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("name", PACKAGES)
def test_a_peer_proves_the_quickest_schedule_of_a_small_cell(name: str, seed: int) -> None:
    peer, cell = _peer(name), layered(9, 2, 1, seed=seed)
    run = peer(cell, 60, 1, seed)
    assert run.proven
    assert run.makespan == run.bound == plan(cell, minimize="makespan")[0].makespan
    assert makespan(run.schedule) == run.makespan


@pytest.mark.parametrize("name", PACKAGES)
def test_a_peer_leaves_two_tasks_to_one_operator(name: str) -> None:
    peer, data = _peer(name), layered(7, 2, 1, seed=5).to_dict()
    tasks = {task: set(told["time"]) for task, told in data["tasks"].items()}
    pair = next(
        [one, two] for one, two in combinations(tasks, 2) if len(tasks[one] & tasks[two]) > 1
    )
    cell = cell_of({**data, "same_operator": [pair]})
    run = peer(cell, 60, 1)
    assert run.proven
    assert run.makespan == plan(cell, minimize="makespan")[0].makespan


@pytest.mark.parametrize("name", PACKAGES)
def test_a_peer_keeps_a_limit_of_stress(name: str) -> None:
    peer, cell = _peer(name), layered(9, 1, 1, seed=3)
    front = plan(cell)
    assert len(front) > 2
    asked, instance = front[1], Instance.of(cell)
    units = round(asked.stress * instance.per_stress)
    run = peer(cell, 60, 1, 0, units)
    assert run.proven
    assert run.makespan == asked.makespan
    assert stress(cell, run.schedule) <= asked.stress


def test_a_table_of_scaling_goes_on_where_it_stopped(tmp_path, monkeypatch, capsys) -> None:
    path = tmp_path / "scaling.csv"
    common = ["scaling.py", "--tasks", "9", "--operators", "2", "--seeds", "1", "-o", str(path)]
    common += ["--seconds", "20", "--peers"]
    monkeypatch.setattr(sys, "argv", [*common, "tandem"])
    assert scaling.main() == 0
    first = scaling.read(path)
    monkeypatch.setattr(sys, "argv", [*common, "tandem", "cp-sat"])
    assert scaling.main() == 0
    both = scaling.read(path)
    assert both[:1] == first
    assert [row.solver for row in both] == ["tandem", "cp-sat"]
    assert {row.makespan for row in both} == {row.best_bound for row in both}
    assert "cp-sat" in capsys.readouterr().out
    monkeypatch.setattr(sys, "argv", [*common[:-3], "--seconds", "1", "--peers", "tandem"])
    with pytest.raises(SystemExit, match="were run for 20 s"):
        scaling.main()
