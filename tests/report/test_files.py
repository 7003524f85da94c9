"""A front as a file: the right content by the ending, whole or absent."""

from __future__ import annotations

import csv
import io
import json
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from tests.draw.cells import front_of, gearbox_front, thesis, thesis_front

from tandem.errors import UsageError
from tandem.report.files import COLUMNS, EXPORTERS, ready_to_write, to_csv, write
from tandem.schedule.model import Schedule


@pytest.mark.parametrize("ending", EXPORTERS)
def test_every_ending_writes_the_same_file_twice_and_nothing_else(
    tmp_path: Path, ending: str
) -> None:
    first, second = (
        write(thesis_front(), tmp_path / f"{i}{ending}").read_bytes() for i in range(2)
    )
    assert first == second
    assert len(list(tmp_path.iterdir())) == 2


def test_json_is_the_result_document(tmp_path: Path) -> None:
    document = json.loads(write(gearbox_front(), tmp_path / "a.json").read_text())
    assert document == gearbox_front().to_dict()
    assert [Schedule.from_list(point["assignments"]) for point in document["front"]] == [
        r.schedule for r in gearbox_front()
    ]


def test_csv_has_every_assignment_of_every_point() -> None:
    front = gearbox_front()
    rows = list(csv.DictReader(io.StringIO(to_csv(front))))
    assert tuple(rows[0]) == COLUMNS
    assert len(rows) == sum(len(result.schedule) for result in front)
    cover = next(row for row in rows if row["task"] == "cover" and row["point"] == "1")
    assert (cover["label"], cover["operators"], cover["task_stress"]) == (
        "Set the cover on together",
        "ben + cobot2",
        "2",
    )
    for place, result in enumerate(front, 1):
        mine = [row for row in rows if row["point"] == str(place)]
        assert sum(float(row["task_stress"]) for row in mine) == result.stress
        assert (
            max(float(row["end_s"]) for row in mine)
            == result.makespan
            == float(mine[0]["makespan_s"])
        )


def test_a_spreadsheet_takes_no_name_for_a_formula(tmp_path: Path) -> None:
    tasks = {"=1+1": thesis().tasks["1"], "-5 °C": thesis().tasks["1"], "-3": thesis().tasks["1"]}
    cell = thesis().replace(
        tasks={name: task.model_copy(update={"label": None}) for name, task in tasks.items()}
    )
    schedule = Schedule.from_list(
        [
            {"task": name, "operators": ["robot"], "start": 9 * i, "end": 9 * i + 9}
            for i, name in enumerate(tasks)
        ]
    )
    data = write(front_of(cell, [schedule]), tmp_path / "a.csv").read_bytes()
    assert [row["task"] for row in csv.DictReader(io.StringIO(data.decode("utf-8-sig")))] == [
        "'=1+1",
        "'-5 °C",
        "-3",
    ]
    assert data.startswith(b"\xef\xbb\xbf")
    assert to_csv(thesis_front()).isascii()


def test_names_are_asked_for_before_the_search(tmp_path: Path) -> None:
    (tmp_path / "folder.json").mkdir()
    bad = [
        tmp_path / "a.htm",
        tmp_path / "plain",
        tmp_path / "missing" / "a.json",
        tmp_path / "folder.json",
    ]
    with pytest.raises(UsageError) as refused:
        ready_to_write([*bad, tmp_path / "good.json"])
    lines = str(refused.value).splitlines()
    assert len(lines) == 4
    assert "'.htm'" in lines[0]
    assert lines[0].endswith("Did you mean .html?")
    assert "a name without an ending" in lines[1]
    assert "does not exist" in lines[2]
    assert "is a folder" in lines[3]
    ready_to_write([tmp_path / f"good{ending}" for ending in EXPORTERS])
    with pytest.raises(UsageError, match="cannot tell"):
        write(thesis_front(), tmp_path / "a.txt")


@pytest.mark.parametrize("ending", EXPORTERS)
def test_a_full_disk_leaves_the_old_file_and_nothing_else(tmp_path: Path, ending: str) -> None:
    """The kernel refuses to write more than 200 bytes, as a full disk would."""
    target = tmp_path / f"plan{ending}"
    target.write_text("the old one")
    code = (
        "import sys\n"
        "from tests.draw.cells import thesis_front\n"
        "from tandem.report.files import write\n"
        "try:\n"
        "    write(thesis_front(), sys.argv[1])\n"
        "except OSError as error:\n"
        "    print('refused', error.strerror)\n"
    )

    def small_disk() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (200, 200))

    # matplotlib would write a cache of fonts of its own; it exists once this process has drawn
    # something.
    thesis_front().plot()
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run(
        [sys.executable, "-c", code, str(target)],
        preexec_fn=small_disk,
        cwd=root,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.stdout == "refused File too large\n", done.stderr
    assert [path.name for path in tmp_path.iterdir()] == [target.name]
    assert target.read_text() == "the old one"
