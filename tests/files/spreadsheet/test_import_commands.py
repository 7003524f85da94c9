"""`tandem import` and `tandem template` on the command line."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from tests.files.spreadsheet import books

from tandem.cell.language import LANGUAGES, sentences
from tandem.cli.sheets import import_command, template_command
from tandem.errors import CellError, UsageError
from tandem.files.load import load
from tandem.files.spreadsheet import said


def run(command: object, *arguments: object) -> Result:
    return CliRunner().invoke(command, [str(argument) for argument in arguments])  # type: ignore[arg-type]


def test_template_then_import_then_the_same_cell(tmp_path: Path) -> None:
    assert run(template_command, "-o", tmp_path / "t.xlsx", "--lang", "de").exit_code == 0
    result = run(import_command, tmp_path / "t.xlsx", "-o", tmp_path / "cell.yaml")
    assert result.exit_code == 0, result.exception
    assert load(tmp_path / "cell.yaml") == books.THESIS
    assert "7 tasks, 2 operators (robot, human)" in result.stderr
    assert result.stdout == ""
    assert (
        run(template_command, tmp_path / "cell.yaml", "-o", tmp_path / "again.xlsx").exit_code == 0
    )
    assert (
        run(import_command, tmp_path / "again.xlsx", "-o", tmp_path / "again.json").exit_code == 0
    )
    assert load(tmp_path / "again.json") == books.THESIS


def test_preview_shows_the_mapping_and_writes_nothing(tmp_path: Path) -> None:
    path = books.german_plan(tmp_path / "plan.xlsx")
    result = run(import_command, path, "--preview", "-o", tmp_path / "cell.yaml")
    assert result.exit_code == 0
    assert "Zeit [1/100 min] Roboter" in result.stdout
    assert "time of Roboter, 1/100 min" in result.stdout
    assert "5 tasks, 2 operators: Roboter (robot), Mensch (human)" in result.stdout
    assert "row 14 was not read: 'Summe' is a total" in result.stderr
    assert not (tmp_path / "cell.yaml").exists()


def test_a_preview_of_a_faulty_sheet_still_shows_the_mapping(tmp_path: Path) -> None:
    result = run(import_command, books.broken_cells(tmp_path / "b.xlsx"), "--preview")
    assert "time of human, s" in result.stdout
    assert isinstance(result.exception, CellError)


def test_nothing_is_written_when_anything_is_wrong(tmp_path: Path) -> None:
    result = run(
        import_command, books.broken_cells(tmp_path / "b.xlsx"), "-o", tmp_path / "cell.yaml"
    )
    assert isinstance(result.exception, CellError)
    assert [path.name for path in tmp_path.iterdir()] == ["b.xlsx"]


def test_an_existing_file_is_kept_without_force(tmp_path: Path) -> None:
    path = books.sheet(tmp_path / "t.xlsx", [books.PLAIN_HEADER, *books.PLAIN_ROWS])
    (tmp_path / "cell.yaml").write_text("mine")
    assert isinstance(run(import_command, path, "-o", tmp_path / "cell.yaml").exception, UsageError)
    assert (tmp_path / "cell.yaml").read_text() == "mine"
    assert run(import_command, path, "-o", tmp_path / "cell.yaml", "--force").exit_code == 0
    assert load(tmp_path / "cell.yaml").replace(name="") == books.THESIS.replace(name="")
    assert isinstance(run(template_command, "-o", path).exception, UsageError)


@pytest.mark.parametrize("option", ["no equals sign", "=time", "X="])
def test_map_is_written_header_equals_meaning(option: str, tmp_path: Path) -> None:
    path = books.sheet(tmp_path / "t.xlsx", [books.PLAIN_HEADER, *books.PLAIN_ROWS])
    assert "write HEADER=MEANING" in str(run(import_command, path, "--map", option).exception)


def test_without_output_the_cell_goes_to_stdout(tmp_path: Path) -> None:
    path = books.sheet(tmp_path / "t.xlsx", [books.PLAIN_HEADER, *books.PLAIN_ROWS])
    (tmp_path / "out.yaml").write_text(run(import_command, path).stdout)
    assert load(tmp_path / "out.yaml").tasks == books.THESIS.tasks


def test_remarks_and_the_preview_speak_german_when_asked(tmp_path: Path) -> None:
    (tmp_path / "plan.csv").write_text(
        "Vorgang;Zeit Mensch [min];Zeit Roboter [min];Notiz\n"
        "Greifen;0,5;0,25;\nFügen;1;0;Vorsicht\nSumme;1,5;0,25;\n",
        encoding="utf-8",
    )
    german = run(import_command, tmp_path / "plan.csv", "--preview", "--lang", "de")
    assert german.exit_code == 0, german.exception
    for words in (
        "Die Vorgänge stehen im Blatt 'plan'",
        "wird gelesen als",
        "2 Vorgänge, 2 Bediener",
    ):
        assert words in german.stdout
    for words in (
        "Nicht gelesene Zeilen:",
        "Zeile 4 wurde nicht gelesen: 'Summe' ist eine Summe, kein Vorgang.",
        "Wer was nicht kann:",
        "Roboter kann nicht: Fügen",
        "Angenommen:",
        "Keine Spalte nennt die ergonomische Belastung",
        "Zeiten wurden in Sekunden umgerechnet aus min.",
    ):
        assert words in german.stderr
    assert not re.search(r"\b(were|is|are|not read)\b", german.stderr)
    english = run(import_command, tmp_path / "plan.csv", "--preview")
    assert "row 4 was not read: 'Summe' is a total, not a task." in english.stderr


def test_every_remark_is_said_in_every_language() -> None:
    folder = Path(said.__file__).parent
    code = "\n".join(path.read_text() for path in folder.glob("*.py"))
    used = set(re.findall(r'\bsay\(\s*"([^"]+)"', code))
    assert len(used) > 40
    for language in LANGUAGES:
        assert used <= sentences("tandem.files.spreadsheet", language).keys()
