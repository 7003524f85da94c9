"""`tandem score` as people and programs call it."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import pytest
from tests.ergonomics.worked_examples import EXAMPLES, close

from tandem.cli.root import run

EXAMPLE = Path(__file__).parents[2] / "examples" / "ergonomics" / "gearbox.yaml"


def asked(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = run(["score", *arguments])
    printed = capsys.readouterr()
    return code, printed.out, printed.err


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example["id"])
def test_every_worked_example_can_be_asked_by_name(example: dict[str, Any], tmp_path, capsys):
    facts = tmp_path / "facts.json"
    facts.write_text(json.dumps(example["inputs"]))
    code, out, _ = asked(
        capsys, "--method", example["method"], "--function", example["function"],
        "--facts", str(facts), "--json", "--unverified",
    )  # fmt: skip
    assert code == 0
    answer = json.loads(out)
    assert answer["steps"]
    for name, printed in example["expected"].items():
        assert close(printed, answer[name], example["tolerance"])


def test_facts_come_from_standard_input_too(monkeypatch, capsys):
    monkeypatch.setattr("sys.stdin", io.StringIO("{c: 5, d: 5}"))
    code, out, _ = asked(
        capsys, "--method", "rula", "--function", "rula_table_c", "--facts", "-", "--json"
    )
    assert code == 0
    assert json.loads(out)["value"] == 6


def test_the_step_is_found_by_the_facts_when_none_is_named(tmp_path, capsys):
    facts = tmp_path / "facts.json"
    facts.write_text('{"tasks": [{"lever_cm": 40, "load_kg": 13, "reps": 400}]}')
    code, out, _ = asked(capsys, "--method", "lifft", "--facts", str(facts), "--json")
    assert code == 0
    assert json.loads(out)["function"] == "lifft_si"


def test_recalled_numbers_are_marked(tmp_path, capsys):
    facts = tmp_path / "facts.json"
    facts.write_text('{"npf": 2, "hal": 4}')
    code, out, err = asked(
        capsys, "--method", "hal_tlv", "--function", "hal_2018", "--facts", str(facts), "--json"
    )
    assert code == 0
    assert json.loads(out)["unverified"] is True
    assert "recalled" in err


def test_methods_with_recalled_tables_are_computed_on_request_alone(tmp_path, capsys):
    facts = tmp_path / "facts.json"
    facts.write_text('{"rating_points_sum": 14, "time_rating": 3.5}')
    arguments = ("--method", "kim_lhc", "--facts", str(facts), "--json")
    code, _, err = asked(capsys, *arguments)
    assert code == 2
    assert "Give --unverified" in err
    code, out, err = asked(capsys, *arguments, "--unverified")
    assert code == 0
    assert json.loads(out)["unverified"] is True
    assert "recalled" in err


def test_a_file_is_scored_and_pages_are_written(tmp_path, capsys):
    files = [tmp_path / f"page.{ending}" for ending in ("html", "xlsx", "md", "json")]
    code, out, err = asked(
        capsys, str(EXAMPLE), *(part for file in files for part in ("-o", str(file)))
    )
    assert code == 0
    assert "REBA 7: trunk 4 because flexed 45 degrees and twisted" in out
    assert "Scores that only rank are not added." in out
    assert "no safety function" in out
    assert all(file.stat().st_size > 1000 for file in files)
    assert err.count("wrote") == 4


def test_json_is_one_document_on_stdout_and_nothing_else(capsys):
    code, out, _ = asked(capsys, str(EXAMPLE), "--json")
    assert code == 0
    assert json.loads(out)["tasks"][0]["score"] == 7


def test_a_file_comes_from_standard_input_too(monkeypatch, capsys):
    text = EXAMPLE.read_bytes()
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(text), "utf-8"))
    code, out, _ = asked(capsys, "-", "--json")
    assert code == 0
    assert json.loads(out)["name"] == "Gearbox, station 3"


def test_the_template_is_scored_as_it_is(tmp_path, capsys):
    path = tmp_path / "facts.xlsx"
    assert asked(capsys, "--template", str(path), "--lang", "de")[0] == 0
    code, out, _ = asked(capsys, str(path), "--lang", "de", "--cycles", "420")
    assert code == 0
    assert "20 Vorgänge mit Seite bewertet." in out
    assert asked(capsys, "--template", str(path))[0] == 2
    code, _, err = asked(capsys, str(path))
    assert code == 3
    assert "Angaben!W15" in err
    assert "give --cycles N" in err


def test_a_recording_is_scored_by_three_postures(tmp_path, capsys):
    frames, rest = tmp_path / "frames.csv", tmp_path / "rest.yaml"
    frames.write_text("trunk,neck,upper arm\n" + "".join(f"{i},5,20\n" for i in range(70)))
    rest.write_text("{load: 4, grip: fair, knees: 0, wrist: 0, lower arm: 80}")
    code, out, _ = asked(
        capsys, "--method", "reba", "--angles", str(frames), "--facts", str(rest), "--json"
    )
    assert code == 0
    data = json.loads(out)
    assert [task["task"] for task in data["tasks"]] == [
        "frames: median", "frames: 95th percentile", "frames: peak",
    ]  # fmt: skip
    assert data["totals"] == []


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        ([], 2, "give one of: FILE"),
        (["--facts", "x.json"], 2, "need --method NAME"),
        (["a.yaml", "--function", "rula_table_c"], 2, "--function needs --facts"),
        (["nowhere.yaml"], 3, "nowhere.yaml: the file cannot be read"),
        (["nowhere.xlsx"], 3, "cannot be read"),
        (["--method", "rebba", "--facts", "x.json"], 2, "Did you mean 'reba'?"),
        ([str(EXAMPLE), "-o", "page.docx"], 2, "an assessment is written as"),
        ([str(EXAMPLE), "--method", "rebba"], 2, "Did you mean 'reba'?"),
        (["--template", "x.csv"], 2, "a template is an .xlsx workbook"),
    ],
)
def test_wrong_use_is_told_in_one_message(arguments, code, said, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    got, out, err = asked(capsys, *arguments)
    assert (got, out) == (code, "")
    assert said in err
    assert "Traceback" not in err


def test_facts_out_of_range_end_with_three_and_the_range(tmp_path, capsys):
    facts = tmp_path / "facts.json"
    facts.write_text('{"c": 0, "d": 5}')
    code, _, err = asked(
        capsys, "--method", "rula", "--function", "rula_table_c", "--facts", str(facts)
    )
    assert code == 3
    assert "c is 0, but rula takes at least 1" in err


def test_the_list_names_every_method_and_its_facts(capsys):
    code, out, _ = asked(capsys, "--list", "--json")
    assert code == 0
    listed = json.loads(out)
    assert "rula_table_c" in listed["rula"]["functions"]
    assert listed["reba"]["facts"]["trunk_flexion_deg"]["range"] == "-45 to 150 degrees"
    assert listed["duet"]["scale"] == "dose"
