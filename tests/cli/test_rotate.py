"""`tandem rotate`: the example of the docs as text, document and files; what is refused."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import jsonschema
import openpyxl
import pytest

from tandem.cli.root import run

EXAMPLES = Path(__file__).parents[2] / "examples" / "ergonomics"
CELL, PEOPLE = str(EXAMPLES / "pump-station.yaml"), str(EXAMPLES / "early-shift.yaml")


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("rotate") / "plan.json"
    assert run(["plan", CELL, "-o", str(path), "--workers", "1"]) == 0
    return str(path)


def test_the_document_keeps_its_schema_and_files_say_the_same(plan, tmp_path, capsys):
    files = [tmp_path / f"rotation{ending}" for ending in (".json", ".csv", ".md", ".xlsx")]
    outputs = [word for file in files for word in ("-o", str(file))]
    capsys.readouterr()
    assert run(["rotate", plan, "--people", PEOPLE, "--json", *outputs]) == 0
    document = json.loads(capsys.readouterr().out)
    assert run(["schema", "--of", "rotation"]) == 0
    jsonschema.Draft202012Validator(json.loads(capsys.readouterr().out)).validate(document)
    assert document["status"] == "optimal"
    eva = next(one for one in document["people"] if one["person"] == "eva")
    assert eva["values"]["dose:duet"] <= eva["limits"]["dose:duet"] == 0.03
    assert json.loads(files[0].read_text())["people"] == document["people"]
    rows = list(csv.DictReader(io.StringIO(files[1].read_text())))
    for one in document["people"]:
        mine = [row for row in rows if row["person"] == one["person"]]
        assert [row["role"] or None for row in mine] == one["roles"]
        total = sum(float(row["dose:duet"]) for row in mine)
        assert total == pytest.approx(one["values"]["dose:duet"])
    assert "| eva |" in files[2].read_text()
    sheet = openpyxl.load_workbook(files[3]).active
    assert [sheet.cell(row, 1).value for row in range(4, 9)] == [
        "anna",
        "ben",
        "cem",
        "dana",
        "eva",
    ]


@pytest.mark.parametrize(("asked", "made"), [([], 200), (["--cycles", "100"], 100)])
def test_the_products_of_a_shift_are_those_that_the_cell_states(asked, made, tmp_path, capsys):
    cell = tmp_path / "cell.yaml"
    cell.write_text(f"cycles_per_shift: 200\n{Path(CELL).read_text()}")
    assert run(["rotate", str(cell), "--people", PEOPLE, "--json", *asked]) == 0
    document = json.loads(capsys.readouterr().out)
    assert sum(period["products"] for period in document["periods"]) == made


def test_it_speaks_german(plan, capsys):
    assert run(["rotate", plan, "--people", PEOPLE, "--lang", "de"]) == 0
    shown = capsys.readouterr().out
    assert "Arbeitsplatzwechsel" in shown
    assert "Bewiesen" in shown
    assert "0,03" in shown
    assert "keine Sicherheitsfunktion" in shown


def test_limits_that_cannot_be_kept_end_with_4_and_a_document(plan, tmp_path, capsys):
    people = tmp_path / "people.yaml"
    people.write_text("limits: {dose:duet: 0.03}\npeople: [anna, ben, cem]\n")
    assert run(["rotate", plan, "--people", str(people), "--json"]) == 4
    shown = capsys.readouterr()
    document = json.loads(shown.out)
    assert document["infeasible"]["minimal"]
    assert "limit dose:duet=0.03 of 'anna', the limit dose:duet=0.03 of 'ben'" in shown.err
    assert "the person who bears most of dose:duet has at least 0.05" in shown.err


def test_everything_wrong_with_a_file_of_people_is_told_at_its_line(plan, tmp_path, capsys):
    people = tmp_path / "people.yaml"
    people.write_text(
        "periods: [120, -5]\nlimits: {dose:duet: lots}\nshift: early\npeople:\n"
        "  anna: {rols: [press]}\n  ben: 5\n  cem: {periods: [0]}\n"
    )
    assert run(["rotate", plan, "--people", str(people)]) == 3
    told = capsys.readouterr().err
    for line, said in [
        (1, "the minutes of each period"),
        (2, "must be a number"),
        (3, "unknown key `shift`"),
        (5, "Did you mean 'roles'?"),
        (6, "no mapping"),
        (7, "counted from 1"),
    ]:
        assert any(f"people.yaml:{line}:" in row and said in row for row in told.splitlines()), said
    people.write_text("people:\n  anna: {roles: [pres], limits: {dose:reba: 3}}\n  ben: {}\n")
    assert run(["rotate", plan, "--people", str(people)]) == 3
    told = capsys.readouterr().err
    assert "people.yaml:2:18: person 'anna': 'pres' is no role of the plan. Did you mean" in told
    assert "ranks are not added" in told


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--periods", "3"], "states the minutes of 4 periods"),
        (["-o", "rotation.pdf"], "a rotation is written as"),
        (["--measure", "dose:rula"], "no task of the cell has a value on the scale"),
        (["--cycles", "2"], "not one whole product"),
        (["--point", "7"], "--point 7"),
    ],
)
def test_wrong_options_end_with_2(plan, options, said, capsys):
    assert run(["rotate", plan, "--people", PEOPLE, *options]) == 2
    assert said in capsys.readouterr().err
