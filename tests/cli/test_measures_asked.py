"""`tandem plan --measure` and `--axes`: documents, pictures, and what does not go together."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tandem.cli.root import run

GEARBOX = str(Path(__file__).parents[2] / "examples" / "gearbox.yaml")


def test_three_axes_as_a_document_and_a_picture(tmp_path: Path, capsys: pytest.CaptureFixture):
    picture, stored = tmp_path / "front.png", tmp_path / "front.json"
    axes = ["--axes", "makespan,stress,worst:stress"]
    assert run(["plan", GEARBOX, *axes, "-o", str(picture), "-o", str(stored), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["objectives"] == ["makespan", "stress", "worst:stress"]
    assert document["complete"]
    assert [(p["makespan"], p["stress"], p["worst:stress"]) for p in document["front"]] == [
        (107, 20.5, 11),
        (108, 17.5, 9),
        (115, 13.5, 8.5),
        (115, 14.5, 7.5),
        (136, 10.5, 5.5),
    ]
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert json.loads(stored.read_text())["front"] == document["front"]
    # a stored front is a plan like any other
    assert run(["check", str(stored)]) == 0


def test_several_measures_are_several_fronts(capsys: pytest.CaptureFixture):
    asked = ["--measure", "peak:stress", "--measure", "time-above:stress:4", "--json"]
    assert run(["plan", GEARBOX, *asked]) == 0
    fronts = json.loads(capsys.readouterr().out)["fronts"]
    assert [front["objectives"][1] for front in fronts] == ["peak:stress", "time-above:stress:4"]


def test_limits_are_kept_and_said(capsys: pytest.CaptureFixture):
    assert run(["plan", GEARBOX, "--measure", "stress", "--limit", "peak:stress=6"]) == 0
    assert "Kept for each person: peak:stress=6." in capsys.readouterr().out
    assert run(["plan", GEARBOX, "--measure", "stress", "--limit", "stress=1"]) == 4
    assert "no schedule keeps the cell's own limits and stress=1" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("lang", "said"),
    [
        ("en", "Shown are 2 of 5 points. The least of each axis: makespan 107, stress 10.5"),
        ("de", "Gezeigt werden 2 von 5 Punkten. Der kleinste Wert jeder Achse: makespan 107"),
    ],
)
def test_a_part_of_a_front_is_shown(lang: str, said: str, capsys: pytest.CaptureFixture):
    asked = ["--axes", "makespan,stress,worst:stress", "--lang", lang]
    parts = ["--within", "makespan=115", "--within", "worst:stress=8.5"]
    assert run(["plan", GEARBOX, *asked, *parts]) == 0
    told = capsys.readouterr().out
    assert said in told
    first = [row.split("│")[1].strip() for row in told.splitlines() if row.startswith("│")]
    assert [cell for cell in first if cell] == ["115", "115"]
    assert run(["plan", GEARBOX, *asked, *parts, "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["front"]) == 5


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--limit", "stress=3"], "--limit goes with --measure or --axes"),
        (["--axes", "makespan,stress", "--takt", "3"], "--takt: not with --measure or --axes"),
        (["--axes", "makespan,stress", "-o", "front.xlsx"], "are written as .json"),
        (["--measure", "stress", "--axes", "makespan,stress"], "exclude each other"),
        (["--shift", "3600"], "--shift goes with --measure or --axes"),
        (["--cycles-per-shift", "5", "--limit", "stress=1"], "--cycles-per-shift go with"),
        (["--measure", "peek:stress"], "Did you mean 'peak'"),
        (["--within", "stress=3"], "--within goes with --measure or --axes"),
        (["--measure", "stress", "--within", "stres=3"], "Did you mean 'stress'"),
        (["--measure", "stress", "--within", "stress=x"], "write an axis and a number"),
        (["--measure", "stress", "--within", "stress=nan"], "write an axis and a number"),
    ],
)
def test_what_does_not_go_together_is_refused(
    options: list[str], said: str, capsys: pytest.CaptureFixture
):
    assert run(["plan", GEARBOX, *options]) == 2
    assert said in capsys.readouterr().err


def test_ctrl_c_keeps_the_points_that_were_found(tmp_path: Path):
    cell = tmp_path / "large.yaml"
    size = ["--tasks", "20", "--humans", "3", "--robots", "1"]
    assert run(["generate", "layered", *size, "-o", str(cell)]) == 0
    program = """
import sys
from tandem.cli.root import run
from tandem.plan.axes.allocations import Allocations

def told(self, *arguments):
    # where Ctrl-C comes while arrays are worked out, and not a solver
    print("listing", file=sys.stderr, flush=True)
    return listed(self, *arguments)

listed, Allocations.open = Allocations.open, told
sys.exit(run(sys.argv[1:]))
"""
    axes = ["--axes", "makespan,stress,worst:stress", "--json", "--time-limit", "300"]
    process = subprocess.Popen(
        [sys.executable, "-c", program, "plan", str(cell), *axes],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
    )
    assert process.stderr is not None
    assert process.stderr.readline() == "listing\n"
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in err
    document = json.loads(out)
    assert document["interrupted"] is True
    assert document["complete"] is False
    stored = tmp_path / "large.interrupted.json"
    assert len(json.loads(stored.read_text())["front"]) == len(document["front"]) > 1
    assert run(["check", str(stored)]) == 0
