"""The command line as users type it: in a process of its own, judged by what comes out and by the
exit code.
"""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
import time
from contextlib import chdir
from pathlib import Path

import pytest
from click.testing import CliRunner

from tandem.cli.root import VERBS, run

ROOT = Path(__file__).parents[2]
THESIS = ROOT / "examples" / "thesis.yaml"


def tandem(
    *arguments: object, stdin: str | None = None, cwd: Path | None = None, **env: str
) -> subprocess.CompletedProcess[str]:
    """Runs the command line in this process; asserts that nobody ever sees a traceback."""
    asked = [str(part) for part in arguments]
    with chdir(cwd or Path.cwd()), CliRunner().isolation(stdin, env) as (out, err, _):
        code = run(asked)
        sys.stdout.flush()
        sys.stderr.flush()
        said = [stream.getvalue().decode() for stream in (out, err)]
    assert "Traceback" not in said[1]
    return subprocess.CompletedProcess(asked, code, *said)


def process(
    *arguments: object, stdin: str | None = None, cwd: Path | None = None, **env: str
) -> subprocess.CompletedProcess[str]:
    """Runs the command line as a user does, where what a process inherits, prints or draws anew is
    the subject.
    """
    command = [sys.executable, "-m", "tandem.cli", *map(str, arguments)]
    done = subprocess.run(
        command,
        input=stdin,
        capture_output=True,
        text=True,
        cwd=cwd,
        env={**os.environ, **env},
        timeout=120,
    )
    assert "Traceback" not in done.stderr
    return done


def test_plan_prints_one_document_and_nothing_else_on_stdout():
    done = process("plan", THESIS, "--json")
    assert done.returncode == 0
    document = json.loads(done.stdout)
    assert {
        "schema_version",
        "cell",
        "objectives",
        "complete",
        "solver",
        "seed",
        "wall_s",
        "front",
    } <= set(document)
    assert document["complete"] is True
    assert [
        (point["makespan"], point["stress"], point["status"], point["bound"])
        for point in document["front"]
    ] == [
        (23, 7, "optimal", {"makespan": 23, "stress": 7}),
        (24, 3, "optimal", {"makespan": 24, "stress": 3}),
        (34, 2, "optimal", {"makespan": 34, "stress": 2}),
    ]
    assert document["solver"].startswith("cp-sat 9.14.")
    assert all(
        set(row) == {"task", "operators", "start", "end"}
        for point in document["front"]
        for row in point["assignments"]
    )


def test_the_exhaustive_method_gives_the_same_front():
    fronts = [
        json.loads(tandem("plan", THESIS, "--json", "--method", method).stdout)["front"]
        for method in ("exact", "exhaustive")
    ]
    assert [[(point["makespan"], point["stress"]) for point in front] for front in fronts] == [
        [(23, 7), (24, 3), (34, 2)]
    ] * 2


@pytest.mark.parametrize(
    ("options", "points"),
    [
        (["--minimize", "makespan"], [(23, 7)]),
        (["--minimize", "stress"], [(34, 2)]),
        (["--weights", "1,0.5"], [(24, 3)]),
        (["--max-stress", "3"], [(24, 3), (34, 2)]),
        (["--max-makespan", "33"], [(23, 7), (24, 3)]),
    ],
)
def test_questions(options, points):
    document = json.loads(tandem("plan", THESIS, "--json", "-q", *options).stdout)
    assert [(point["makespan"], point["stress"]) for point in document["front"]] == points
    assert document["complete"] is True


def test_plan_for_people_fits_eighty_columns_without_colour():
    done = tandem("plan", THESIS, "-q", NO_COLOR="1", COLUMNS="80")
    assert done.returncode == 0
    assert "\x1b" not in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "3 points on the front, complete and proven" in done.stdout.replace("\n", " ")


def test_a_cell_can_come_through_a_pipe():
    done = process("plan", "-", "--json", "-q", stdin=THESIS.read_text())
    assert json.loads(done.stdout)["complete"] is True


def test_every_file_that_is_asked_for_is_written(tmp_path):
    names = ["plan.json", "plan.csv", "plan.svg", "plan.png", "plan.pdf", "plan.html"]
    done = tandem(
        "plan",
        THESIS,
        "-q",
        "--json",
        *(part for name in names for part in ("-o", tmp_path / name)),
    )
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
    assert (
        json.loads((tmp_path / "plan.json").read_text())["front"]
        == json.loads(done.stdout)["front"]
    )


def test_check_judges_schedules(tmp_path):
    result = tmp_path / "result.json"
    result.write_text(tandem("plan", THESIS, "--json", "-q").stdout)
    assert tandem("check", THESIS, result).returncode == 0
    document = json.loads(result.read_text())
    document["front"][0]["assignments"][0]["start"] = 1
    result.write_text(json.dumps(document))
    broken = tandem("check", THESIS, result)
    assert broken.returncode == 6
    assert "schedule 1" in broken.stderr


def test_a_seed_and_a_limit_on_work_print_the_same_document_again():
    cell = ROOT / "examples" / "alternator.yaml"
    runs = [
        json.loads(
            tandem("plan", cell, "--seed", "7", "--work", "0.05", "--workers", n, "--json").stdout
        )
        for n in (1, 2)
    ]
    for document in runs:
        del document["wall_s"]
    assert runs[0] == runs[1]
    assert runs[0]["ended_by"] == "work"


def test_a_fresh_process_shows_the_same_schedules_with_any_number_of_workers():
    runs = [json.loads(process("plan", THESIS, "--json", "--workers", n).stdout) for n in (1, 2, 4)]
    for document in runs:
        del document["wall_s"]
    assert runs[0] == runs[1] == runs[2]
    assert runs[0]["ended_by"] == "proof"
    assert all(point["canonical"] for point in runs[0]["front"])


INFEASIBLE = ["plan", THESIS, "--max-makespan", "20"]


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["plan", THESIS, "--method", "exat"], 2, "Did you mean 'exact'"),
        (["plan", THESIS, "--weights", "1"], 2, "two numbers"),
        (["plan", THESIS, "--weights", "1,2", "--minimize", "stress"], 2, "exclude each other"),
        (["plan", THESIS, "--time-limit", "-1"], 2, "more than 0 seconds"),
        (["plan", THESIS, "--work", "0"], 2, "work 0.0: must be a number of more than 0."),
        (["plan", THESIS, "--work", "1", "--time-limit", "60"], 2, "exclude each other"),
        (["plan", THESIS, "-o", "plan.docx"], 2, "docx"),
        (["plan", THESIS, "--format", "yml"], 2, "Did you mean 'yaml'"),
        (["plan"], 2, "CELL"),
        (["plain", THESIS], 2, "plain"),
        ([THESIS], 2, "tandem plan"),
        (["plan", "thesis.yml"], 3, "no such file"),
        (["plan", ROOT], 3, "folder"),
        (["check", THESIS, THESIS], 3, "no result document"),
        (
            INFEASIBLE,
            4,
            "Without the limit on the makespan (20 s) it works: 23 s with a stress of 7.",
        ),
        (["plan", THESIS, "-o", "/nowhere/plan.json"], 2, "/nowhere"),
    ],
)
def test_exit_codes_and_messages(arguments, code, words, tmp_path):
    done = tandem(*arguments, cwd=tmp_path)
    assert done.returncode == code, done.stderr
    assert words in done.stderr
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_all_faults_are_told_at_once_with_their_places(tmp_path):
    path = tmp_path / "cell.yaml"
    path.write_text(
        "operators:\n"
        "  robot: {kind: robot}\n"
        "tasks:\n"
        "  1: {time: {robo: 3}, after: [2]}\n"
        "  2: {time: {robot: -1}, after: [1]}\n"
    )
    done = tandem("plan", path)
    assert done.returncode == 3
    assert "Did you mean 'robot'" in done.stderr
    assert "tasks '1' and '2' wait for each other" in done.stderr
    assert "-1" in done.stderr
    assert f"{path}:4:" in done.stderr
    assert f"{path}:5:" in done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_full_disk_is_told_and_nothing_is_left():
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "tandem.cli", "plan", THESIS, "--json", "-q"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
        )
    assert done.returncode == 2
    assert "no space left" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_reader_that_goes_away_is_no_error():
    head = f"{shlex.quote(sys.executable)} -m tandem.cli generate layered --tasks 400 | head -n 1"
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {head}"],
        capture_output=True,
        text=True,
        timeout=60,
        cwd=ROOT,
    )
    assert done.stderr == ""
    assert done.stdout


def test_ctrl_c_prints_and_saves_the_best_so_far(tmp_path):
    cell = tmp_path / "large.yaml"
    tandem("generate", "layered", "--tasks", 120, "--humans", 2, "--robots", 2, "-o", cell)
    command = [sys.executable, "-m", "tandem.cli", "plan", cell, "--json", "--time-limit", "300"]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path
    )
    assert process.stderr is not None
    process.stderr.readline()  # the first schedule has been found
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in err
    document = json.loads(out)
    assert document["interrupted"] is True
    assert document["complete"] is False
    assert all(point["bound"]["makespan"] <= point["makespan"] for point in document["front"])
    assert (
        json.loads((tmp_path / "large.interrupted.json").read_text())["front"] == document["front"]
    )
    assert tandem("check", cell, tmp_path / "large.interrupted.json").returncode == 0


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help_with_an_example_or_options(verb):
    done = tandem(verb, "--help")
    assert done.returncode == 0
    assert "Usage: tandem " + verb in done.stdout


def test_schema_and_methods_are_printed():
    assert json.loads(tandem("schema").stdout)["title"]
    listed = json.loads(tandem("methods", "--json").stdout)["methods"]
    assert {"exact", "exhaustive", "spt"} <= {entry["name"] for entry in listed}
