"""`tandem replan` as users type it: what is said, what is written, and what is refused."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from tests.cli.test_planning import THESIS, tandem

from tandem.schedule.changes import changes
from tandem.schedule.model import Schedule

SLOWER = "2: {time: {robot: 7", "2: {time: {robot: 12"
"""Task 2 takes the robot five seconds longer."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The thesis's cell, its plan, and the same cell with a slower robot."""
    folder = tmp_path_factory.mktemp("replan")
    text = THESIS.read_text()
    assert SLOWER[0] in text
    (folder / "cell.yaml").write_text(text)
    (folder / "slower.yaml").write_text(text.replace(*SLOWER))
    assert tandem("plan", "cell.yaml", "-q", "-o", "plan.json", cwd=folder).returncode == 0
    return folder


def replanned(folder: Path, cell: str, *options: object) -> dict[str, Any]:
    done = tandem("replan", cell, "--from", "plan.json", "-q", "--json", *options, cwd=folder)
    assert done.returncode == 0, done.stderr
    document: dict[str, Any] = json.loads(done.stdout)
    return document


def old_schedule(folder: Path, point: int) -> Schedule:
    rows = json.loads((folder / "plan.json").read_text())["front"][point - 1]["assignments"]
    return Schedule.from_list(rows)


@pytest.mark.parametrize("point", [1, 2, 3])
def test_where_nothing_has_changed_the_plan_is_the_old_one_to_the_digit(
    folder: Path, point: int
) -> None:
    document = replanned(folder, "cell.yaml", "--point", point)
    found = document["front"][0]
    assert found["digest"] == old_schedule(folder, point).digest
    assert found["changed"] == []
    assert document["complete"] is True


def test_the_document_is_a_plan_that_other_commands_read(folder: Path) -> None:
    document = replanned(folder, "slower.yaml", "--point", 2, "--tolerance", 0, "-o", "new.json")
    assert json.loads((folder / "new.json").read_text())["front"] == document["front"]
    assert tandem("check", "slower.yaml", "new.json", cwd=folder).returncode == 0
    point = document["front"][0]
    now = Schedule.from_list(point["assignments"])
    expected = changes(old_schedule(folder, 2), now, 0.0)
    assert point["changed"] == [changed.to_dict() for changed in expected.changed]
    assert {row["what"] for row in point["changed"]} <= {"operator", "order", "start"}
    assert document["replan"]["from"] == old_schedule(folder, 2).digest
    again = tandem("replan", "slower.yaml", "--from", "new.json", "-q", "--json", cwd=folder)
    assert json.loads(again.stdout)["front"][0]["digest"] == point["digest"]


def test_any_number_of_workers_and_any_seed_give_the_same_plan(folder: Path) -> None:
    digests = {
        replanned(folder, "slower.yaml", "--workers", workers, "--seed", seed)["front"][0]["digest"]
        for workers, seed in ((1, 0), (2, 1), (4, 7))
    }
    assert len(digests) == 1


def test_a_limit_on_work_repeats_to_the_letter_and_says_so(tmp_path: Path) -> None:
    cell = tmp_path / "cell.yaml"
    made = ("generate", "layered", "--tasks", 24, "--humans", 2, "--robots", 1, "--seed", 3)
    assert tandem(*made, "-o", cell, cwd=tmp_path).returncode == 0
    plan = ("plan", "cell.yaml", "--minimize", "makespan", "--work", 1, "-q", "-o", "plan.json")
    assert tandem(*plan, cwd=tmp_path).returncode == 0
    change = ("--set", "tasks.5.time.robot_1=40", "--set", "tasks.7.time.human_1=30")
    first, second = (
        replanned(tmp_path, "cell.yaml", *change, "--work", 0.003, "--workers", workers)
        for workers in (1, 2)
    )
    del first["wall_s"], second["wall_s"]
    assert first == second
    assert (first["ended_by"], first["complete"]) == ("work", False)


def test_what_has_started_is_done_or_kept_does_not_move(folder: Path) -> None:
    document = replanned(
        folder, "slower.yaml", "--point", 2, "--at", 5, "--done", 2, "--keep", "5", "--allow", 50
    )
    was = {a.task: a for a in old_schedule(folder, 2)}
    now = {a.task: a for a in Schedule.from_list(document["front"][0]["assignments"])}
    kept = {row["task"]: row["why"] for row in document["replan"]["kept"]}
    assert kept == {"2": "done", "3": "started", "5": "kept"}
    for task in kept:
        assert (now[task].start, now[task].operators) == (was[task].start, was[task].operators)
    assert all(a.start >= 5 for a in now.values() if a.task not in kept)


def test_people_read_what_changes_and_that_the_plan_was_made_for_another_cell(folder: Path) -> None:
    done = tandem(
        "replan", "slower.yaml", "--from", "plan.json", "--point", 2, "--tolerance", 1, "-q",
        cwd=folder,
    )  # fmt: skip
    assert done.returncode == 0
    assert "0 tasks change operator, 0 change order, 5 move by more than 1 s" in done.stdout
    assert "the rest (2) stays." in done.stdout
    assert "task 4: start: robot, start 16 s -> 21 s (+5 s)" in done.stdout
    assert "plan.json: made for another state of the cell; it is carried over." in done.stderr


def test_people_read_it_in_their_language(folder: Path) -> None:
    asked = ("slower.yaml", "--from", "plan.json", "--point", 2, "--tolerance", 1, "-q")
    said = tandem("replan", *asked, "--keep", 5, "--allow", 50, "--lang", "de", cwd=folder)
    assert said.returncode == 0
    assert "Alter Plan" in said.stdout
    assert "Belastung von höchstens 3. Erlaubt, 50 % darüber, ist ein Plan mit" in said.stdout
    assert "Nicht bewegt: festgehalten 5" in said.stdout
    assert "Vorgang 4: " in said.stdout
    assert " verschoben, der Rest (" in said.stdout
    assert "für einen anderen Stand der Zelle gemacht" in said.stderr
    front = tandem("replan", *asked, "--front", "--lang", "de", cwd=folder)
    assert "geändert" in front.stdout
    assert "vollständig und bewiesen" in front.stdout
    for english in ("changed", "stress", "makespan", "proven", "kept", "start"):
        assert english not in said.stdout + front.stdout


def test_new_tasks_and_gone_ones_are_said(folder: Path) -> None:
    text = THESIS.read_text().replace(
        "5: {time: {robot: 4, human: 2}, stress: 4, after: [3]}",
        "8: {time: {robot: 3, human: 3}, stress: 0, after: [3]}",
    )
    (folder / "other.yaml").write_text(text.replace("[1, 2, 3, 4, 5, 6]", "[1, 2, 3, 4, 6, 8]"))
    done = tandem("replan", "other.yaml", "--from", "plan.json", "-q", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "new: 8, gone: 5." in done.stdout
    point = replanned(folder, "other.yaml")["front"][0]
    assert (point["new"], point["gone"]) == (["8"], ["5"])


def test_a_front_of_changes_gains_time_with_every_point(folder: Path) -> None:
    """Task 5 takes the human ten seconds longer: the robot takes it over, or all are later."""
    text = THESIS.read_text()
    assert "5: {time: {robot: 4, human: 2}" in text
    (folder / "weary.yaml").write_text(
        text.replace("{robot: 4, human: 2}", "{robot: 4, human: 12}")
    )
    document = replanned(folder, "weary.yaml", "--point", 1, "--front")
    rows = [(point["makespan"], len(point["changed"])) for point in document["front"]]
    assert rows == [(24, 1), (27, 0)]
    assert document["complete"] is True
    assert all(point["status"] == "optimal" for point in document["front"])
    said = tandem("replan", "weary.yaml", "--from", "plan.json", "--point", 1, "--front", "-q",
                  cwd=folder)  # fmt: skip
    assert said.stdout.count("proven") == len(rows) + 1


def test_every_output_of_a_plan_can_be_written(folder: Path) -> None:
    endings = ("json", "csv", "svg", "html", "xlsx", "xml", "md")
    files = [option for ending in endings for option in ("-o", f"out.{ending}")]
    done = tandem(
        "replan", "slower.yaml", "--from", "plan.json", "--point", 2, "-q", *files, cwd=folder
    )
    assert done.returncode == 0, done.stderr
    assert all((folder / f"out.{ending}").stat().st_size > 100 for ending in endings)
    assert "no plan within these limits changes less" in (folder / "out.md").read_text()


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (["--point", "9"], 2, ["--point 9: the front has 3 points"]),
        (
            ["--done", "9,5", "--keep", "8", "--at", "-3"],
            2,
            ["--done 9: the plan has no such task", "--done 5: 3 must be done", "--keep 8", "--at"],
        ),
        (["--point", "2", "--at", "50"], 2, ["--at 50: the old plan ends at 24 s"]),
        (["--point", "2", "--at", "5", "--done", "4"], 2, ["begins at 16 s", "--done 1,2,4"]),
        (["--allow", "-1", "--tolerance", "nan"], 2, ["allow -1", "tolerance not a number"]),
        (["--time-limit", "0"], 2, ["--time-limit 0"]),
        (["--work", "1", "--time-limit", "9"], 2, ["--work and --time-limit exclude each other"]),
        (["--work", "-1"], 2, ["work -1", "more than 0"]),
        (
            ["--point", "2", "--at", "5", "--set", "tasks.7.deadline=25"],
            4,
            ["keep all limits after task 2 (started", "Without the deadline of task 7 (25 s)"],
        ),
        (["--set", "tasks.7.deadline=20"], 4, ["the deadline of task 7 (20 s) cannot be kept"]),
        (["--front", "-o", "front.html"], 2, ["-o front.html", ".json or .csv"]),
        (
            ["--point", "2", "--keep", "1,2,4"],
            4,
            ["does task '2' (0 to 12 s) and task '1' (7 to 16 s)", "Leave out of --keep"],
        ),
        (
            ["--point", "2", "--keep", "2,7"],
            4,
            [
                "task 2 (kept: robot from 0 s) and task 7 (kept: robot from 22 s) cannot all",
                "Without --keep 7 there is a plan.",
            ],
        ),
    ],
)
def test_what_cannot_be_is_refused_in_words(
    folder: Path, options: list[str], code: int, said: list[str]
) -> None:
    done = tandem("replan", "slower.yaml", "--from", "plan.json", "-q", *options, cwd=folder)
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    for words in said:
        assert words in done.stderr


def test_a_plan_of_another_cell_and_files_that_are_none_are_refused(folder: Path) -> None:
    gearbox = THESIS.with_name("gearbox.yaml")
    done = tandem("replan", gearbox, "--from", "plan.json", cwd=folder)
    assert done.returncode == 2
    assert "the plan is one of another cell: none of its tasks" in done.stderr
    for file in ("cell.yaml", "missing.json"):
        done = tandem("replan", "cell.yaml", "--from", file, cwd=folder)
        assert done.returncode == 3
        assert file in done.stderr


def test_the_tasks_done_must_be_doable_by_who_did_them(folder: Path) -> None:
    text = THESIS.read_text()
    assert "1: {time: {robot: 9, human: 10}" in text
    (folder / "alone.yaml").write_text(text.replace("{robot: 9, human: 10}", "{human: 10}"))
    done = tandem("replan", "alone.yaml", "--from", "plan.json", "--point", 2, "--done", 1, "-q",
                  cwd=folder)  # fmt: skip
    assert done.returncode == 4
    assert "task 1 has been done with robot, but the cell gives no time for robot" in done.stderr


def test_ctrl_c_prints_and_saves_the_best_so_far(tmp_path: Path) -> None:
    cell = tmp_path / "large.yaml"
    tandem("generate", "layered", "--tasks", 90, "--humans", 2, "--robots", 2, "-o", cell)
    plan = tmp_path / "plan.json"
    tandem("plan", cell, "-q", "--minimize", "makespan", "--time-limit", 2, "-o", plan)
    command = [sys.executable, "-m", "tandem.cli", "replan", cell, "--from", plan, "--json"]
    process = subprocess.Popen(
        [*map(str, command), "--time-limit", "300"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
    )
    assert process.stderr is not None
    process.stderr.readline()  # the first schedule has been found
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    document = json.loads(out)
    assert document["interrupted"] is True
    assert document["complete"] is False
    saved = tmp_path / "large.interrupted.json"
    assert json.loads(saved.read_text())["front"] == document["front"]
    assert tandem("check", cell, saved).returncode == 0
