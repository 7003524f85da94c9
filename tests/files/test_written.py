"""Cells in other people's forms: what is written is read again as the same cell, or has the same
optimum; what a form cannot hold is refused, and what it leaves out is said.
"""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.strategies import cells

import tandem
from tandem.cell.model import Cell
from tandem.cli.root import run
from tandem.errors import CellError, NotWrittenWarning, UsageError
from tandem.files.formats.table import FORMATS, WRITERS
from tandem.files.load import dump, dumps, load, loads
from tandem.plan.result import Status

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
BOTH = [name for name in WRITERS if name in FORMATS]
FOREIGN = [name for name in BOTH if name not in ("yaml", "json")]


@pytest.fixture
def thesis() -> Cell:
    return load(EXAMPLES / "thesis.yaml")


def quietly(cell: Cell, form: str) -> str:
    """The text, without the remarks on what it leaves out."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotWrittenWarning)
        return dumps(cell, form)


@st.composite
def shops(draw: st.DrawFn, form: str) -> str:
    """A file of the form."""
    machines, first = draw(st.integers(1, 4)), draw(st.integers(0, 1))
    if form == "fjs-dag":
        return draw(graphs(machines, first))
    jobs: list[list[dict[int, int]]] = []
    for _ in range(draw(st.integers(1, 3))):
        job = []
        for _ in range(draw(st.integers(1, 3))):
            most = 1 if form == "jsp" else machines
            able = draw(st.sets(st.integers(0, machines - 1), min_size=1, max_size=most))
            time = draw(st.integers(1, 99))
            same = form == "job-shop-lib"
            job.append({one: time if same else draw(st.integers(1, 99)) for one in sorted(able)})
        jobs.append(job)
    if form == "job-shop-lib":
        return library(draw, jobs)
    lines = [f"{len(jobs)} {machines}"]
    for job in jobs:
        pairs = [[f"{one + first} {time}" for one, time in ways.items()] for ways in job]
        if form == "fjs":
            found = [str(len(job)), *(" ".join([str(len(p)), *p]) for p in pairs)]
            lines.append(" ".join(found))
        else:
            lines.append(" ".join(pair for (pair,) in pairs))
    return "\n".join(lines) + "\n"


def library(draw: st.DrawFn, jobs: list[list[dict[int, int]]]) -> str:
    data: dict[str, Any] = {
        "name": "drawn",
        "duration_matrix": [[next(iter(ways.values())) for ways in job] for job in jobs],
        "machines_matrix": [[list(ways) for ways in job] for job in jobs],
        "metadata": {},
    }
    if draw(st.booleans()):
        data["release_dates_matrix"] = [[draw(st.integers(0, 5)) for _ in job] for job in jobs]
    if draw(st.booleans()):
        late = st.one_of(st.none(), st.integers(900, 999))
        data["deadlines_matrix"] = [[draw(late) for _ in job] for job in jobs]
    return json.dumps(data)


@st.composite
def graphs(draw: st.DrawFn, machines: int, first: int) -> str:
    many = draw(st.integers(1, 5))
    arcs = [(a, b) for b in range(many) for a in range(b) if draw(st.booleans())]
    lines = [f"{many} {len(arcs)} {machines}", *(f"{a} {b}" for a, b in arcs)]
    for _ in range(many):
        able = sorted(draw(st.sets(st.integers(0, machines - 1), min_size=1)))
        pairs = [f"{one + first} {draw(st.integers(1, 99))}" for one in able]
        lines.append(" ".join([str(len(able)), *pairs]))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("form", FOREIGN)
def test_what_was_read_is_written_and_read_again_as_the_same_cell(form):
    @given(shops(form))
    @settings(max_examples=60, deadline=None)
    def holds(text: str) -> None:
        cell = loads(text, form)
        assert loads(quietly(cell, form), form) == cell

    holds()


@pytest.mark.parametrize("form", FOREIGN)
@given(cell=cells(max_tasks=5))
@settings(max_examples=30, deadline=None)
def test_a_cell_that_a_form_can_hold_keeps_its_optimum(form, cell):
    try:
        text = quietly(cell, form)
    except CellError:
        return
    again = loads(text, form)
    assert best(again) == pytest.approx(best(cell) * per_second(cell, again))


def best(cell: Cell) -> float:
    (point,) = tandem.plan(cell, minimize="makespan", workers=1)
    return point.makespan


def per_second(cell: Cell, again: Cell) -> float:
    """In how many units a second of the one is counted in the other."""
    one, other = (
        max(mode.time for name in each.tasks for mode in each.modes(name)) for each in (cell, again)
    )
    return other / one


@given(cell=cells(max_tasks=5))
@settings(max_examples=60, deadline=None)
def test_pyjobshop_finds_the_same_optimum(cell):
    pyjobshop = pytest.importorskip("pyjobshop")
    try:
        text = quietly(cell, "pyjobshop")
    except CellError:
        return
    data = pyjobshop.ProblemData.from_json(text)
    theirs = pyjobshop.solve(data, solver="ortools", time_limit=20, display=False, num_workers=1)
    try:
        ours = best(cell)
    except tandem.InfeasibleError:
        assert theirs.status.value == "Infeasible"
        return
    units = max(mode.duration for mode in data.modes) / max(
        mode.time for name in cell.tasks for mode in cell.modes(name)
    )
    assert theirs.objective == pytest.approx(ours * units)


RICH = {
    "operators": {
        "anna": {"kind": "human", "breaks": [[30, 40]], "stress_limit": 9},
        "cobot": {"kind": "robot"},
    },
    "tasks": {
        "1": {"time": {"anna": 4, "cobot": 6}, "stress": 3, "tool": "driver"},
        "2": {"together": [{"operators": ["anna", "cobot"], "time": 5}], "after": ["1"]},
        "3": {"time": {"cobot": 2.5}, "zone": "fixture", "wait": {"after": "1", "at_least": 3}},
        "4": {"time": {"cobot": 2}, "after": ["1"], "release": 8, "deadline": 60},
    },
    "same_operator": [["3", "4"]],
}


@pytest.mark.parametrize("form", [name for name in WRITERS if name not in ("yaml", "json")])
def test_all_that_a_form_cannot_hold_is_named_at_once(form):
    cell = loads(json.dumps(RICH), "json")
    if form == "pyjobshop":
        with pytest.warns(NotWrittenWarning) as told:
            assert len(json.loads(dumps(cell, form))["resources"]) == 5  # and a limit of stress
        assert [str(one.message).partition(" is ")[0] for one in told][:1] == [
            "pyjobshop: the stress of tasks"
        ]
        assert "in units of 0.1 s" in str(told[1].message)
        return
    with pytest.raises(CellError) as refused:
        dumps(cell, form)
    paths = {".".join(map(str, fault.path)) for fault in refused.value.faults}
    expected = {
        "operators.anna.breaks", "operators.anna.stress_limit", "tasks.1.tool",
        "tasks.2.together", "tasks.3.zone", "tasks.3.wait", "same_operator",
    }  # fmt: skip
    assert expected <= paths
    assert ("tasks.4.release" in paths) == (form != "job-shop-lib")


def test_a_changeover_is_more_than_pyjobshop_can_say():
    data = {**RICH, "tools": {"driver": {"changeover": {"anna": 2}}}}
    with pytest.raises(CellError, match=r"tools.driver.changeover: pyjobshop has no changeover"):
        dumps(loads(json.dumps(data), "json"), "pyjobshop")


def test_precedence_that_is_no_row_is_refused_and_what_would_hold_it_named(thesis):
    with pytest.raises(CellError, match=r"tasks.4.after: it comes after 2 tasks, '1' and '2'"):
        dumps(thesis, "fjs")
    with pytest.warns(NotWrittenWarning) as told:
        text = dumps(thesis, "fjs-dag")
    assert {str(one.message) for one in told} == {
        "fjs-dag: the stress of tasks is not written: this form knows only time.",
        "fjs-dag: names are not written; of the machines 1 is robot, 2 is human.",
    }
    assert best(loads(text, "fjs-dag")) == 23


def test_an_arc_that_follows_from_others_does_not_break_a_row():
    chain = loads("1 2\n3 1 1 4 1 2 7 1 1 3\n", "fjs")
    data = chain.to_dict()
    data["tasks"]["1.3"]["after"] = ["1.1", "1.2"]
    assert quietly(loads(json.dumps(data), "json"), "fjs") == quietly(chain, "fjs")


def test_a_form_that_nobody_writes_is_wrong_usage(thesis):
    with pytest.raises(UsageError, match=r"not written as 'pyjobshob'. Did you mean 'pyjobshop'"):
        dumps(thesis, "pyjobshob")


def test_the_ending_says_what_is_written(tmp_path, capsys):
    source = tmp_path / "shop.txt"
    source.write_text("2 3\n0 3 1 2 2 2\n2 4 0 1 1 5\n")
    assert run(["convert", str(source), "-o", str(tmp_path / "a.fjs")]) == 0
    assert run(["convert", str(tmp_path / "a.fjs"), "-o", str(tmp_path / "a.yaml")]) == 0
    assert load(tmp_path / "a.yaml").tasks == load(source).tasks
    dump(load(source), tmp_path / "b.jsp")
    assert load(tmp_path / "b.jsp").tasks == load(source).tasks
    assert run(["convert", str(source), "--to", "job-shop-lib"]) == 0
    assert json.loads(capsys.readouterr().out)["duration_matrix"] == [[3, 2, 2], [4, 1, 5]]


def test_a_refusal_is_exit_code_3_and_writes_nothing(tmp_path, capsys):
    target = tmp_path / "thesis.fjs"
    assert run(["convert", str(EXAMPLES / "thesis.yaml"), "-o", str(target)]) == 3
    assert "tasks.4.after" in capsys.readouterr().err
    assert not target.exists()


def test_statuses_of_a_plan_are_proofs_here():
    """`best` takes the one point of a plan for the optimum."""
    (point,) = tandem.plan(loads("1 2\n0 3 1 2\n", "jsp"), minimize="makespan")
    assert point.status is Status.OPTIMAL
