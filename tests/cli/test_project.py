"""`tandem init`, stale results, and what `tandem check` says of a folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from tandem.cli.root import run
from tandem.files.load import load

EXAMPLES = Path(__file__).parents[2] / "examples"


def tandem(capfd: pytest.CaptureFixture[str], *arguments: object, code: int = 0) -> tuple[str, str]:
    """Stdout and stderr of a command that ends with this code."""
    ended = run([str(argument) for argument in arguments])
    printed = capfd.readouterr()
    assert ended == code, printed.err
    return printed.out, printed.err


@pytest.fixture
def project(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Path:
    tandem(capfd, "init", tmp_path / "line")
    return tmp_path / "line"


def change(project: Path) -> None:
    """The human needs a second more for task 6."""
    file = project / "cell.yaml"
    file.write_text(file.read_text().replace("human: 3}", "human: 4}"))


def test_a_project_has_a_cell_a_variant_and_a_place_for_results(project: Path) -> None:
    assert sorted(path.relative_to(project).as_posix() for path in project.rglob("*")) == [
        "README.md", "cell.yaml", "results", "variants", "variants/faster.yaml",
    ]  # fmt: skip
    assert load(project / "cell.yaml").tasks.keys() == load(EXAMPLES / "thesis.yaml").tasks.keys()
    assert load(project / "variants/faster.yaml").tasks["6"].time["robot"] == 8


def test_the_commands_of_its_page_run(
    project: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    commands = [
        line.split()[1:]
        for line in (project / "README.md").read_text().splitlines()
        if line.startswith("tandem ")
    ]
    assert [words[0] for words in commands] == ["plan", "compare", "check"]
    monkeypatch.chdir(project)
    printed = [tandem(capfd, *words)[0] for words in commands]
    assert (project / "results/plan.html").stat().st_size > 10_000
    assert "task 6: robot takes 8 s instead of 10 s" in printed[1]
    assert "results/plan.json: current, of cell.yaml; 3 schedules, none breaks it" in printed[2]


def test_nothing_is_overwritten_unless_asked(
    project: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    change(project)
    (project / "README.md").unlink()
    _, err = tandem(capfd, "init", project, code=2)
    assert "cell.yaml: exists already. Give --force" in err
    assert "human: 4}" in (project / "cell.yaml").read_text()
    assert not (project / "README.md").exists()
    (project / "results/plan.json").write_text("mine")
    tandem(capfd, "init", project, "--force")
    assert "human: 3}" in (project / "cell.yaml").read_text()
    assert (project / "results/plan.json").read_text() == "mine"


def test_a_cell_file_keeps_its_comments(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "cell.yaml").write_text(
        "# measured on Monday\n" + (EXAMPLES / "gearbox.yaml").read_text()
    )
    tandem(capfd, "init", tmp_path, "--from", tmp_path / "cell.yaml")
    assert (tmp_path / "cell.yaml").read_text().startswith("# measured on Monday\n")
    tandem(capfd, "plan", tmp_path / "variants/faster.yaml", "--minimize", "makespan", "-q")


def test_a_workbook_becomes_a_project(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    book = openpyxl.Workbook()
    for row in [
        ("Vorgang", "Zeit Mensch [s]", "Zeit Roboter [s]", "Vorgänger"),
        (1, 4, 0, None),
        (2, 6, 3.5, 1),
    ]:
        book.active.append(row)
    book.save(tmp_path / "tasks.xlsx")
    _, err = tandem(capfd, "init", tmp_path, "--from", tmp_path / "tasks.xlsx")
    assert "Who cannot do what" in err
    cell = load(tmp_path / "cell.yaml")
    assert cell.tasks["2"].after == ("1",)
    assert dict(cell.tasks["1"].time.items()) == {cell.humans[0]: 4}


def test_a_workbook_that_cannot_be_read_leaves_nothing(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "tasks.xlsx").write_bytes(b"")
    tandem(capfd, "init", tmp_path / "line", "--from", tmp_path / "tasks.xlsx", code=3)
    assert not (tmp_path / "line").exists()


def planned(project: Path, capfd: pytest.CaptureFixture[str]) -> Path:
    result = project / "results/plan.json"
    tandem(
        capfd,
        "plan",
        project / "cell.yaml",
        "-q",
        "-o",
        result,
        "--report",
        project / "results/plan.html",
    )
    return result


def test_a_stale_result_says_so(project: Path, capfd: pytest.CaptureFixture[str]) -> None:
    result = planned(project, capfd)
    assert tandem(capfd, "check", project / "cell.yaml", result)[1] == ""
    file = project / "cell.yaml"
    file.write_text(file.read_text().replace("stress: 10", "stress: 9"))
    out, err = tandem(capfd, "check", project / "cell.yaml", result)
    assert "stale: made for another state of the cell" in err
    assert "none breaks the cell" in out
    document = json.loads(tandem(capfd, "check", project / "cell.yaml", result, "--json")[0])
    assert (document["stale"], document["faults"]) == (True, [])
    change(project)
    assert "it takes 4 s" in tandem(capfd, "check", project / "cell.yaml", result, code=6)[1]
    assert "--from" in tandem(capfd, "plan", project / "cell.yaml", "-q", "--from", result)[1]
    assert f"{result}: stale" in tandem(capfd, "compare", result, result)[1]


def test_a_folder_is_looked_through(project: Path, capfd: pytest.CaptureFixture[str]) -> None:
    planned(project, capfd)
    tandem(
        capfd, "plan", project / "variants/faster.yaml", "-q", "-o", project / "results/faster.json"
    )
    (project / "results/notes.json").write_text("{}")
    change(project)
    out, err = tandem(capfd, "check", project)
    assert "plan.json: stale: made for another state of the cell" in out
    assert "plan.html: stale" in out
    assert "faster.json: current, of variants/faster.yaml" in out
    assert "notes.json: does not say which cell it belongs to" in out
    assert "2 of 4 results are stale" in err
    rows: list[dict[str, Any]] = json.loads(tandem(capfd, "check", project, "--json")[0])["results"]
    assert {row["file"]: row["stale"] for row in rows} == {
        "results/faster.json": False, "results/notes.json": None, "results/plan.html": True,
        "results/plan.json": True,
    }  # fmt: skip


def test_a_folder_with_a_broken_schedule(project: Path, capfd: pytest.CaptureFixture[str]) -> None:
    result = planned(project, capfd)
    document = json.loads(result.read_text())
    document["front"][0]["assignments"][0]["end"] = 1
    result.write_text(json.dumps(document))
    assert "plan.json: schedule 1: task" in tandem(capfd, "check", project, code=6)[1]


def test_a_folder_that_is_no_project(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert "without a cell.yaml" in tandem(capfd, "check", tmp_path, code=3)[1]


def test_what_if_as_json_carries_the_difference(capfd: pytest.CaptureFixture[str]) -> None:
    out, _ = tandem(
        capfd, "plan", EXAMPLES / "thesis.yaml", "--set", "tasks.6.time.robot=8", "--json", "-q"
    )
    document = json.loads(out)
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
    told = document["difference"]
    assert told["base"]["front"] == [[23, 7], [24, 3], [34, 2]]
    assert told["cell"][0]["sentence"] == "task 6: robot takes 8 s instead of 10 s"
    assert [
        (row["makespan"], row["stress"], row["makespan_then"], row["seconds"])
        for row in told["points"]
    ][-1] == (34, 2, 32, -2)
    plain = json.loads(tandem(capfd, "plan", EXAMPLES / "thesis.yaml", "--json", "-q")[0])
    assert "difference" not in plain
