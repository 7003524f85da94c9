"""The fuzzing programs themselves: a short run finds nothing, and a fault that is planted is
found.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from random import Random

from tests.fuzz import axes, judges, limits, people
from tests.fuzz.cells import cell as random_cell
from tests.plan.brute_force import front_in_order, front_of_all, worth
from tests.schedule.cells import thesis, thesis_schedule

from tandem.cell.parts import Operator, TimeOff
from tandem.files.validate import cell_of
from tandem.plan import exact, race
from tandem.plan.axes.allocations import Between
from tandem.plan.methods import METHODS


def test_exact_and_exhaustive_search_answer_random_cells_as_brute_force_does():
    total = judges.judge_all(range(1, 151), until=float("inf"))
    assert total.findings == []
    assert total.cells == 150
    assert total.with_deadlines > 50
    assert total.with_releases > 40
    assert total.with_setups > 40
    assert total.replayed > 400
    assert total.every_moment > 20
    assert sum(total.questions.values()) > 600


def test_what_works_on_large_cells_is_right_on_small_ones(monkeypatch):
    """Neighbourhoods, the search along the clock and the front in two steps have their turn in
    cells that brute force can answer.
    """
    monkeypatch.setattr(exact, "SMALL", 0)
    monkeypatch.setattr(race, "SMALL", 0)
    for seed in range(1001, 1081, 2):  # odd ones are planned by two workers
        assert judges.judge(seed).findings == []


def test_the_cells_have_every_feature():
    cells = [random_cell(Random(seed)) for seed in range(300)]
    text = json.dumps(cells)
    of_operators, of_tasks = (
        ("breaks", "setup", "stress_limit"),
        ("together", "release", "deadline", "after"),
    )
    for word in (
        *of_operators,
        *of_tasks,
        "changeover",
        "capacity",
        "same_operator",
        "stress_of_set",
    ):
        assert text.count(f'"{word}"') > 20, word
    assert any(
        str(time).startswith("0.00000") or len(str(time)) > 7
        for data in cells
        for task in data["tasks"].values()
        for time in task["time"].values()
    )


def test_a_planner_that_forgets_the_setup_is_caught(monkeypatch):
    breaks = property(
        lambda operator: tuple(
            TimeOff(start, end, "break") for start, end in sorted(operator.breaks)
        )
    )
    monkeypatch.setattr(Operator, "times_off", breaks)
    found = [finding for seed in range(1, 31) for finding in judges.judge(seed, "setup").findings]
    assert {finding.method for finding in found} >= {"exact", "exhaustive"}


def test_a_judge_that_leaves_out_a_point_is_caught(monkeypatch, tmp_path, capsys):
    def forgetful(*arguments, **options):
        front = METHODS["exhaustive"](*arguments, **options)
        return replace(front, results=front.results[:1])

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(judges, "METHODS", {**METHODS, "exact": forgetful})
    total = judges.run(20, seed=1, minutes=60, workers=1)
    assert total.findings
    found = total.findings[0]
    assert f"python3 dev.py fuzz judges --cells 1 --seed {found.seed}" in capsys.readouterr().out
    stored = json.loads(
        (tmp_path / "tandem-out" / "fuzz" / f"judges-{found.seed}-exact-front.json").read_text(
            encoding="utf-8"
        )
    )
    assert cell_of(stored["cell"])
    assert stored["said"] != stored["right"]
    assert judges.judge(found.seed).findings  # one cell alone repeats it
    assert judges.judge(found.seed).findings[0].cell == found.cell


def test_a_judge_that_crashes_is_caught(monkeypatch):
    def broken(*_, **__):
        raise OverflowError("too large")

    monkeypatch.setattr(judges, "METHODS", {**METHODS, "exhaustive": broken})
    assert any(
        "OverflowError: too large" in finding.said
        for finding in judges.judge(1).findings + judges.judge(2).findings
    )


def test_brute_force_knows_the_thesis():
    rows = [(a.task, a.start, a.end, a.operators) for a in thesis_schedule()]
    data = thesis().to_dict()
    assert worth(data, rows) == (23, 7)
    assert (
        worth(
            data,
            [
                (name, start + (name == "2"), end + (name == "2"), who)
                for name, start, end, who in rows
            ],
        )
        is None
    )
    assert front_in_order(data) == [(23, 7), (24, 3), (34, 2)]
    two = {**data, "tasks": {name: data["tasks"][name] for name in "12"}}
    assert front_of_all(two) == front_in_order(two) == [(9, 11), (10, 10), (16, 0)]


def test_it_runs_as_a_command_and_says_what_it_did(tmp_path):
    command = [
        sys.executable,
        "-m",
        "tests.fuzz.judges",
        "--cells",
        "12",
        "--seed",
        "5",
        "--workers",
        "2",
        "--out",
        str(tmp_path / "out.json"),
    ]
    ended = subprocess.run(command, capture_output=True, text=True, check=True)
    said = json.loads(ended.stdout)
    assert said == json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert (said["cells"], said["differ"]) == (12, 0)


def test_the_verb_lists_the_programs_and_refuses_others():
    root = Path(__file__).parents[2]
    listed = subprocess.run(
        [sys.executable, "dev.py", "fuzz"], cwd=root, capture_output=True, text=True
    )
    assert listed.returncode == 0
    assert "python3 dev.py fuzz judges" in listed.stdout
    unknown = subprocess.run(
        [sys.executable, "dev.py", "fuzz", "jugdes"], cwd=root, capture_output=True, text=True
    )
    assert unknown.returncode == 2
    assert "nothing is called 'jugdes'; there are axes, choco, cycles" in unknown.stderr


PROPERTY = """
from hypothesis import given, settings, strategies as st
drawn = []

@settings(max_examples=20)
@given(st.integers(0, 10**9))
def test_it(number):
    drawn.append(number)

def teardown_module():
    with open("drawn.txt", "a") as file:
        print(*drawn, file=file)

@given(st.integers())
def test_that_is_wrong(number):
    assert number < 1000

def test_that_draws_nothing():
    raise RuntimeError("is not asked")
"""


def test_properties_are_drawn_anew_and_what_refutes_one_is_kept(tmp_path):
    (tmp_path / "test_drawn.py").write_text(PROPERTY, encoding="utf-8")
    shutil.copy(Path(__file__).parents[1] / "conftest.py", tmp_path)
    command = [sys.executable, "-m", "tests.fuzz.properties", "--rounds", "1", "test_drawn.py"]
    path = {"PYTHONPATH": str(Path(__file__).parents[2]), "CI": "true"}
    for _ in range(2):
        ended = subprocess.run(
            command, cwd=tmp_path, env=os.environ | path, capture_output=True, text=True
        )
        assert ended.returncode == 1, ended.stdout + ended.stderr
        assert "1 failed, 1 passed" in ended.stdout
        assert "reproduce_failure" in ended.stdout
    first, second = (tmp_path / "drawn.txt").read_text(encoding="utf-8").splitlines()
    assert first != second
    assert (tmp_path / ".hypothesis" / "examples").is_dir()


def test_no_plan_exceeds_a_limit(capsys):
    assert limits.main(["--cells", "8"]) == 0
    assert ": 0 exceed it;" in capsys.readouterr().out


def test_no_shift_and_no_plan_exceeds_a_limit_of_a_person(capsys):
    assert people.main(["--cells", "1", "--tasks", "4", "--shifts", "20"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["random_shifts"] == 100
    assert found["plans"] >= 5
    assert found["violations"] == 0


def test_a_formula_from_plain_data_says_who_exceeds_what():
    data = people.drawn(Random(1), 4)
    rows = list(data["tasks"].values())
    alone = [["anna"] * 4, ["robot"] * 4, ["anna", "ben", "ben", "robot"]]
    for kind in people.KINDS:
        of_each = {who: [people.taken(row, who, kind) for row in rows] for who in people.PEOPLE}
        both = max if kind == "peak:reba" else sum
        mixed = max(of_each["anna"][0], both(of_each["ben"][1:3]))
        assert people.worst(data, alone, kind).tolist() == [both(of_each["anna"]), 0, mixed]


def test_the_docs_say_what_limits_cost():
    found = json.loads(Path("benchmarks/results/people_limits.json").read_text(encoding="utf-8"))
    page = Path("docs/planning.md").read_text(encoding="utf-8")
    assert people.table(found) in page
    for said in (found["command"], f"{found['random_shifts']:,}", f"{found['plans']:,}"):
        assert said in page
    assert found["violations"] == 0


def test_fronts_of_several_measures_are_those_of_all_allocations(capsys):
    assert axes.main(["--cells", "25"]) == 0
    assert capsys.readouterr().out.startswith("axes: 25 cells")


def test_a_bound_on_allocations_that_is_too_high_is_caught(monkeypatch):
    """Nothing is drawn by chance here, so that what the bound leaves out is missed."""
    right = Between.by_chains
    monkeypatch.setattr(Between, "by_chains", lambda between: right(between) + 3)
    monkeypatch.setattr("tandem.plan.axes.search.ROUNDS_A_TASK", 0)
    monkeypatch.setattr("tandem.plan.axes.compromises.DRAWN", 1)
    assert any(axes.judge(seed)[1] for seed in range(1, 30))
