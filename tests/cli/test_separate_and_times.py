"""`tandem separate` and `tandem times`: what they say, what they write, what they refuse."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import tandem
from tandem.cell.model import Cell
from tandem.cli.root import run
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule

EXAMPLES = Path(__file__).parents[2] / "examples" / "ergonomics"
CELL, SPACE = str(EXAMPLES / "pump-station.yaml"), str(EXAMPLES / "cobot-space.yaml")
TIMES = str(EXAMPLES / "pump-times.yaml")


def separated(capsys, *options: str) -> dict:
    assert run(["separate", CELL, "--facts", SPACE, "--json", *options]) == 0
    return json.loads(capsys.readouterr().out)


def test_each_pair_of_places_is_judged_by_its_distance(capsys):
    document = separated(capsys)
    assert document["robots"]["cobot"]["S_p"] == pytest.approx(0.95)
    pairs = {(one["robot_place"], one["human_place"]): one for one in document["pairs"]}
    assert {key: one["verdict"] for key, one in pairs.items()} == {
        ("rack", "table"): "free",
        ("rack", "fixture"): "free",
        ("fixture", "table"): "slow",
        ("fixture", "fixture"): "apart",
    }
    assert pairs["fixture", "table"]["factor"] == pytest.approx(1.5)
    assert document["zones"] == {"shared space": ["fixture", "table"]}
    assert "not a safety function" in document["advice"]


def test_what_is_written_keeps_people_and_robot_apart_by_the_checker(tmp_path, capsys):
    output = tmp_path / "apart.yaml"
    separated(capsys, "-o", str(output))
    cell, before = tandem.load(output), tandem.load(CELL)
    assert cell.zones["shared space"].apart == ("human", "robot")
    # the robot drives screws while somebody works at the table: sound before, and not any more
    rows = {row.task: row for row in tandem.plan(before, workers=1)[0].schedule}
    hoses, screws = rows["connect hoses"], rows["drive screws"]
    assert hoses.start < screws.end
    assert screws.start < hoses.end
    schedule = Schedule(tuple(rows.values()))
    assert faults(before, schedule) == []
    assert any("shared space" in fault for fault in faults(cell, schedule))
    planned = tandem.plan(cell, workers=1)[0]
    assert planned.makespan > 56  # what it costs is said by planning
    assert faults(cell, planned.schedule) == []


def test_slowing_down_lengthens_the_robot_s_times_and_leaves_the_place_free(tmp_path, capsys):
    output = tmp_path / "slow.yaml"
    document = separated(capsys, "--slow", "times", "-o", str(output))
    assert document["times"] == [
        {"task": "drive screws", "operator": "cobot", "before": 16, "after": 24}
    ]
    cell = tandem.load(output)
    assert cell.tasks["drive screws"].time["cobot"] == 24
    assert cell.tasks["connect hoses"].zone is None
    assert cell.tasks["press in bearing"].zone == "shared space"
    assert run(["separate", CELL, "--facts", SPACE, "-o", str(output)]) == 2
    assert "exists already" in capsys.readouterr().err


def test_what_cannot_be_judged_is_said(tmp_path, capsys):
    data = tandem.load(CELL).to_dict()
    del data["places"]["rack"]
    data["tasks"]["seal"]["zone"] = "bench"
    cell = tmp_path / "cell.json"
    cell.write_text(json.dumps(data))
    assert run(["separate", str(cell), "--facts", SPACE]) == 2
    assert "places without coordinates: 'rack'" in capsys.readouterr().err
    data["places"]["rack"] = [3.4, 0]
    cell.write_text(json.dumps(data))
    assert run(["separate", str(cell), "--facts", SPACE]) == 2
    assert "tasks are in a zone already ('seal' in 'bench')" in capsys.readouterr().err
    del data["tasks"]["seal"]["zone"]
    data["tasks"]["seal"]["together"] = [{"operators": ["bench", "cobot"], "time": 6}]
    del data["tasks"]["fetch housing"]["place"]
    cell.write_text(json.dumps(data))
    assert run(["separate", str(cell), "--facts", SPACE, "--lang", "de"]) == 0
    told = capsys.readouterr().out
    assert "Leistungs- und Kraftbegrenzung oder Handführung braucht: seal" in told
    assert "ohne Ort: fetch housing" in told
    assert "keine Sicherheitsfunktion" in told


def test_facts_of_robots_are_refused_all_at_once(tmp_path, capsys):
    facts = tmp_path / "space.yaml"
    facts.write_text("robots:\n  cobott: {}\n  cobot: {v_r: fast, T_r: 0.1, C: 3}\n")
    assert run(["separate", CELL, "--facts", str(facts)]) == 3
    told = capsys.readouterr().err
    assert "space.yaml:2:3: 'cobott' is no robot of the cell. Did you mean 'cobot'?" in told
    assert "v_r is 'fast', but a number of m/s is needed" in told
    assert "C is 3 m, but separation takes 0 to 2 m" in told
    assert "reach is missing" in told


def test_times_are_worked_out_and_written_into_the_cell(tmp_path, capsys):
    output = tmp_path / "timed.yaml"
    assert run(["times", TIMES, "--cell", CELL, "-o", str(output), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    found = {(one["task"], one["operator"]): one["rounded"] for one in document["times"]}
    assert found == {
        ("drive screws", "cobot"): 15.6,
        ("fetch housing", "cobot"): 10,
        ("seal", "bench"): 13.7,
        ("connect hoses", "bench"): 19.5,
    }
    cell = tandem.load(output)
    assert isinstance(cell, Cell)
    assert all(cell.tasks[task].time[who] == seconds for (task, who), seconds in found.items())
    assert all(one["error"] for one in document["times"])
    assert run(["times", TIMES, "--lang", "de"]) == 0
    assert "13,7 s" in capsys.readouterr().out


def test_times_that_do_not_fit_are_refused_at_their_lines(tmp_path, capsys):
    file = tmp_path / "times.yaml"
    file.write_text("tasks:\n  seal:\n    bench: {tmu: -3}\n    cobot: {}\n")
    assert run(["times", str(file)]) == 3
    told = capsys.readouterr().err
    assert "times.yaml:3:" in told
    assert "times.yaml:4:5: task 'seal', 'cobot': one of `moves`, `tmu`, `first`" in told
    file.write_text("tasks:\n  seel: {bench: {tmu: 3}}\n  seal: {cobot: {tmu: 3}, ben: {tmu: 3}}\n")
    assert run(["times", str(file), "--cell", CELL, "-o", str(tmp_path / "out.yaml")]) == 3
    told = capsys.readouterr().err
    assert "the cell has no task 'seel'. Did you mean 'seal'?" in told
    assert "'cobot' is a robot, but `tmu` is for humans" in told
    assert "the cell has no operator 'ben'" in told
    assert not (tmp_path / "out.yaml").exists()
    assert run(["times", TIMES, "--cell", CELL]) == 2
