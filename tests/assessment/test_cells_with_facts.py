"""`tandem score CELL`: the facts of a cell, scored, and what a plan does to each person."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import openpyxl
import pytest

import tandem
from tandem.assessment import pages
from tandem.assessment.sentences import words
from tandem.assessment.shift import from_outside, rows_of, shift
from tandem.cell.exposures import exposures
from tandem.cell.model import Cell
from tandem.cli.root import run
from tandem.ergonomics.tasks import scored
from tandem.files.load import dumps, load, loads
from tandem.files.spreadsheet.draft import read_workbook
from tandem.files.spreadsheet.template import export_cell

EXAMPLE = Path(__file__).parents[2] / "examples/ergonomics/thesis-with-facts.yaml"


@pytest.fixture(scope="module")
def cell() -> Cell:
    return load(EXAMPLE)


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plans") / "plan.json"
    assert run(["plan", str(EXAMPLE), "-o", str(path), "--quiet"]) == 0
    return path


def told(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    capsys.readouterr()
    assert run(["score", *words, "--json"]) == 0
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def test_the_example_is_the_cell_of_the_thesis_but_for_its_facts(cell):
    data = cell.to_dict()
    for task in data["tasks"].values():
        task.pop("ergonomics", None)
    assert {**data, "name": ""} == {
        **load(EXAMPLE.parents[1] / "thesis.yaml").to_dict(),
        "name": "",
    }


def test_a_persons_shift_is_the_sum_of_the_plans_tasks_by_the_cycles(cell):
    front = tandem.plan(cell, time_limit=20)
    each = exposures(cell)["duet"]
    for result in front:
        found = shift(cell, result.schedule, each_s=result.makespan)
        [human] = found.people
        assert found.cycles == 8 * 3600 // result.makespan
        mine = [one.task for one in result.schedule.of("human")]
        assert list(human.tasks) == mine
        dose = sum(float(each.get((task, "human"), 0)) for task in mine) * found.cycles
        [total] = [one for one in human.totals if one.method == "duet"]
        assert total.value == pytest.approx(dose)


def test_a_quicker_plan_of_the_same_tasks_raises_the_dose_of_the_day(cell):
    schedule = tandem.plan(cell, time_limit=20)[0].schedule
    slow, quick = (shift(cell, schedule, each_s=each).people[0] for each in (60.0, 30.0))
    doses = [one.totals[-1].value or 0 for one in (slow, quick)]
    assert doses[1] == pytest.approx(2 * doses[0])


def test_score_tells_a_plan_person_by_person(plan, capsys):
    found = told(capsys, str(EXAMPLE), "--plan", str(plan), "--point", "1")
    assert found["shift"]["cycles"] == 1252
    [human] = found["shift"]["people"]
    assert human["tasks"] == ["3", "5", "6"]
    assert human["unassessed"] == []
    assert [one["method"] for one in human["totals"]] == ["reba", "duet"]
    assert found["totals"] == []
    assert len(found["tasks"]) == 12


def test_a_dose_asks_how_many_products_a_shift_has(capsys):
    assert run(["score", str(EXAMPLE)]) == 2
    assert "Give --cycles N" in capsys.readouterr().err


def test_scores_are_written_beside_the_facts_and_read_again(tmp_path, cell, capsys):
    filled = tmp_path / "filled.yaml"
    assert run(["score", str(EXAMPLE), "--cycles", "400", "--fill", str(filled)]) == 0
    again = load(filled)
    assert exposures(again) == exposures(cell)
    assert all(one.score is not None for t in again.tasks.values() for one in t.ergonomics)
    capsys.readouterr()
    assert run(["score", str(EXAMPLE), "--cycles", "400", "--fill", str(filled)]) == 2
    assert "exists already" in capsys.readouterr().err


def test_a_score_that_its_facts_do_not_come_to_is_refused_at_its_place(tmp_path, capsys):
    path = tmp_path / "cell.yaml"
    path.write_text(
        "operators: {h: {kind: human}}\n"
        "tasks:\n"
        "  a:\n"
        "    time: {h: 3}\n"
        "    ergonomics:\n"
        "      - {method: duet, omni_res: 4, reps_per_cycle: 1, score: 7}\n"
        "      - {method: reba, trunk: 400}\n"
    )
    assert run(["check", str(path)]) == 3
    said = capsys.readouterr().err
    assert f"{path}:6:" in said
    assert "the facts beside it come to" in said
    assert f"{path}:7:" in said
    assert "reba takes -45 to 150 degrees" in said


OUTSIDE = {
    "operators": {"anna": {"kind": "human"}, "bob": {"kind": "human"}, "cobot": {"kind": "robot"}},
    "tasks": {
        "a": {"time": {"anna": 3, "bob": 4}, "ergonomics": [
            {"method": "eaws", "score": 38, "source": "measured", "assessor": "MM"},
            {"method": "eaws", "score": 21.5, "operators": ["bob"]},
            {"method": "lifft", "score": 7.25e-7},
        ]},
        "b": {"time": {"anna": 3, "cobot": 2}, "ergonomics": [
            {"method": "duet", "Anstrengungsgrad": 4, "reps_per_cycle": 2, "side": "left"},
            {"method": "rula", "score": 6, "side": "right"},
        ]},
    },
}  # fmt: skip


@pytest.mark.parametrize("form", ["yaml", "json"])
def test_what_a_task_carries_survives_every_writer(form, cell):
    for one in (cell, Cell.model_validate(OUTSIDE)):
        assert loads(dumps(one, form), form) == one


@pytest.mark.parametrize("lang", ["en", "de"])
def test_a_workbook_gives_the_same_facts_back(lang, cell, tmp_path):
    for number, one in enumerate((cell, Cell.model_validate({**OUTSIDE, "name": "n"}))):
        path = tmp_path / f"{number}.xlsx"
        assert export_cell(one, path, lang=lang) == ()
        assert read_workbook(path).cell() == one


def test_variants_change_facts_and_keep_those_of_the_cell():
    data = {
        **OUTSIDE,
        "variants": {"light": {"tasks": {"b": {"ergonomics": {"method": "rula", "score": 2}}}}},
    }
    whole = Cell.model_validate(data)
    light = whole.variant("light")
    assert exposures(light)["rula"] == {("b", "anna"): 2}
    assert exposures(light)["eaws"] == exposures(whole)["eaws"]


def sheet(path: Path, header: str) -> Path:
    book = openpyxl.Workbook()
    rows = [["Vorgang", "Zeit Mensch [s]", "Zeit Roboter [s]", header], ["Bohren", 10, 9, 3]]
    for row in [*rows, ["Schrauben", 12, None, 6]]:
        book.worksheets[0].append(row)
    book.save(path)
    return path


@pytest.mark.parametrize("aggregate", ["peak", "time-weighted", "time-above"])
def test_a_column_of_ranks_is_kept_where_somebody_says_what_for(aggregate, tmp_path):
    found = read_workbook(sheet(tmp_path / "a.xlsx", "RULA rechts"), aggregate=aggregate)
    cell = found.cell()
    assert exposures(cell)["rula"] == {("Bohren", "Mensch"): 3, ("Schrauben", "Mensch"): 6}
    assert all(t.ergonomics[0].facts == {"side": "right"} for t in cell.tasks.values())
    assert not any(task.stress for task in cell.tasks.values())


def test_a_column_of_ranks_is_asked_about_and_added_only_on_request(tmp_path, capsys):
    path = sheet(tmp_path / "a.xlsx", "RULA")
    assert run(["import", str(path)]) == 3
    assert "--aggregate peak" in capsys.readouterr().err
    added = read_workbook(path, aggregate="sum").cell()
    assert [task.stress for task in added.tasks.values()] == [3, 6]
    left = read_workbook(path, aggregate="ignore").cell()
    assert not any(task.stress or task.ergonomics for task in left.tasks.values())


def test_what_has_no_scale_here_cannot_be_kept(tmp_path):
    found = read_workbook(sheet(tmp_path / "a.xlsx", "OWAS"), aggregate="peak")
    assert any("no scale that is known" in fault.message for fault in found.faults)


@pytest.mark.parametrize("language", ["en", "de"])
def test_every_page_tells_people_and_numbers_from_outside(language, tmp_path):
    cell, t = Cell.model_validate(OUTSIDE), words(language)
    schedule = tandem.plan(cell, time_limit=10)[0].schedule
    found = pages.Assessment(
        "n", [scored(row) for row in rows_of(cell, 100)], [], {"version": "0", "command": "c"},
        from_outside(cell), shift(cell, schedule, each_s=10.0),
    )  # fmt: skip
    for ending, write in pages.WRITERS.items():
        content = write(t, found)
        if ending in (".html", ".md"):
            assert "EAWS" in str(content)
            assert t("head.people") in str(content)
            assert "anna" in str(content)
            assert t("limits.outside") in str(content)
    book = openpyxl.load_workbook(_stored(tmp_path, pages.xlsx(t, found)))
    assert {t("sheet.people"), t("sheet.outside")} <= set(book.sheetnames)
    pdf = pages.pdf(t, found)
    assert pdf.startswith(b"%PDF")
    assert pdf == pages.pdf(t, found)


def _stored(folder: Path, content: bytes) -> Path:
    path = folder / "a.xlsx"
    path.write_bytes(content)
    return path
