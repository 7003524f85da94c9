"""Cycles in the terminal and as files: every number is the pattern's, in two languages; and read
back they are what was written, or a sentence about why not.
"""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from rich.console import Console
from tests.draw.cycles import FRONTS, bench, bench_front, thesis_cycles

from tandem.cell.model import Cell
from tandem.cli.root import run
from tandem.errors import CellError, UnsoundScheduleError, UsageError
from tandem.files.load import dump, dumps
from tandem.files.spreadsheet import import_cell
from tandem.plan.cycle.mix import plan_mix
from tandem.plan.cycle.result import CycleFront
from tandem.report.cycle.files import COLUMNS, EXPORTERS, ready_to_write, to_csv, write
from tandem.report.cycle.stored import read_cycle
from tandem.report.cycle.terminal import CycleText, CycleView
from tandem.report.cycle.told import summary
from tandem.report.language import words
from tandem.report.project import EMBEDDED
from tandem.report.stored import read_plan


def printed(view: object, width: int = 80, *, encoding: str = "utf-8") -> str:
    buffer = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    Console(file=buffer, width=width, highlight=False).print(view)
    buffer.flush()
    return buffer.buffer.getvalue().decode(encoding)


# --- the terminal ---------------------------------------------------------------------------------


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("width", [40, 60, 80, 160])
@pytest.mark.parametrize("name", FRONTS)
def test_no_line_is_wider_than_the_terminal(name: str, width: int, language: str) -> None:
    text = printed(CycleView(FRONTS[name](), language=language), width)
    assert max(map(len, text.splitlines())) <= width


def test_the_table_has_every_point_with_what_it_means_for_the_station() -> None:
    rows = [line.split()[:7] for line in printed(CycleView(thesis_cycles()), 120).splitlines()]
    assert ["1", "19", "12", "25", "2", "189.5", "proven"] in rows
    assert ["3*", "24", "3", "24", "1", "150", "proven"] in rows


def test_what_is_not_proven_has_its_bounds() -> None:
    text = printed(CycleView(bench_front()), 120)
    assert "24 (>= 23)" in text
    assert "2 (>= 1)" in text
    assert "within a takt of 26 s" in " ".join(text.split())


@pytest.mark.parametrize(
    ("language", "sentence"),
    [
        ("en", r"the cycle time \(24 s\) says how often .* the makespan \(42 s\) says how long"),
        ("de", r"Die Zykluszeit \(24 s\) sagt, wie oft .* die Dauer \(42 s\) sagt, wie lange"),
    ],
)
def test_it_says_which_number_a_planner_needs(language: str, sentence: str) -> None:
    assert re.search(
        sentence, " ".join(printed(CycleView(bench_front(), language=language)).split())
    )


def test_load_and_idle_share_of_every_operator_are_there() -> None:
    text = " ".join(printed(CycleView(bench_front())).split())
    assert "Anna: 9.5 s (40 %) work of 24 s, 14.5 s (60 %) idle" in text
    assert (
        "Cobot on the rail: 18 s (75 %) work and 5 s changeovers of 24 s, 1 s (4.2 %) idle" in text
    )


def test_two_cycles_stand_side_by_side_where_they_fit_and_products_are_named() -> None:
    wide = printed(CycleText(bench(), bench_front()[0].periodic), 160).splitlines()
    ben = [line for line in wide if line.startswith("Ben ")]
    assert len(ben) == 1
    assert ben[0].count("│") == 3
    assert "check -1" in ben[0]
    assert "check #1" in ben[0]
    narrow = printed(CycleText(bench(), bench_front()[0].periodic), 60).splitlines()
    assert len([line for line in narrow if line.startswith("Ben ")]) >= 2
    assert "-1: launched at -24 s, #1: launched at 0 s, #2: launched at 24 s" in wide


def test_a_terminal_without_block_characters_gets_plain_ones() -> None:
    text = printed(CycleText(bench(), bench_front()[0].periodic), 100, encoding="ascii")
    assert "#% human  =- robot  + joint task  ~ tool changeover" in text


# --- files ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("ending", EXPORTERS)
def test_every_form_is_written_and_says_which_cycle_it_shows(ending: str, tmp_path: Path) -> None:
    front = thesis_cycles()
    path = write(
        front, tmp_path / f"cycle{ending}", command="tandem plan", date="2026-01-01", point=2
    )
    data = path.read_bytes()
    assert (
        data
        == write(
            front, tmp_path / f"again{ending}", command="tandem plan", date="2026-01-01", point=2
        ).read_bytes()
    )
    if ending == ".xlsx":
        book = openpyxl.load_workbook(path)
        assert front[1].periodic.digest in book["Cycle"]["A2"].value
    elif ending not in (".png", ".pdf"):
        assert front[1].periodic.digest.encode() in data


def test_ms_project_cannot_hold_what_repeats_and_that_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"a\.xml: MS Project knows no work that repeats.*\.xlsx"):
        ready_to_write([tmp_path / "a.xml"])
    with pytest.raises(UsageError, match="MS Project"):
        write(bench_front(), tmp_path / "a.xml")
    assert not (tmp_path / "a.xml").exists()
    with pytest.raises(UsageError, match=r"(?s)\.xml.*\.xls'"):
        ready_to_write([tmp_path / "a.xml", tmp_path / "b.xls", tmp_path / "c.html"])


def test_the_table_has_every_task_with_its_place_in_the_cycle_and_no_formula() -> None:
    rows = list(csv.DictReader(io.StringIO(to_csv(bench_front()))))
    assert tuple(rows[0]) == COLUMNS
    found = {row["task"]: (row["start_s"], row["place_s"], row["lap"]) for row in rows}
    assert found["label"] == ("40", "16", "1")
    assert found["check"] == ("22", "22", "0")
    assert "'=grease" in found
    assert {row["per_hour"] for row in rows} == {"150"}


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("name", FRONTS)
def test_the_workbook_gives_the_same_cell_again(name: str, language: str, tmp_path: Path) -> None:
    front = FRONTS[name]()
    path = write(front, tmp_path / "cycle.xlsx", language=language)
    assert import_cell(path)[0] == front.cell


def test_the_workbook_has_loads_and_sheets(tmp_path: Path) -> None:
    path = write(bench_front(), tmp_path / "cycle.xlsx")
    book = openpyxl.load_workbook(path)
    assert book.sheetnames[:6] == ["Front", "Cycle", "Load", "Anna", "Ben", "Assumptions"]
    load = {row[0].value: [cell.value for cell in row[2:8]] for row in book["Load"].iter_rows(4, 6)}
    assert load["Cobot on the rail"] == [3, 18, 5, 1, 0.75, pytest.approx(1 / 24)]
    rows = [[cell.value for cell in row] for row in book["Cycle"].iter_rows(4, 9)]
    assert ["label", "Ben", 40, 42, 16, 1, "-1", 0] in rows
    assert ["check", "Ben", 22, 30, 22, 0, "#1", 1] in rows
    anna = [[cell.value for cell in row] for row in book["Anna"].iter_rows(3, 5)]
    assert anna[1][anna[0].index("task")] == "=grease"
    assert book["Anna"]["D4"].data_type == "s"


@pytest.mark.parametrize(
    ("language", "said"),
    [
        ("en", ["products per hour", "launched a cycle ago (-1)", "Set-up happens once"]),
        ("de", ["Produkte je Stunde", "vor einem Zyklus begonnen (-1)", "Gerüstet wird einmal"]),
    ],
)
@pytest.mark.parametrize("ending", [".html", ".md"])
def test_pages_say_all_of_it_in_both_languages(
    ending: str, language: str, said: list[str], tmp_path: Path
) -> None:
    text = write(bench_front(), tmp_path / f"cycle{ending}", language=language).read_text()
    for sentence in said:
        assert sentence in text
    assert "<b>" not in re.sub(r"<b>[^<]+</b>", "", text)
    assert "Cobot on the rail: " not in [
        line for line in text.splitlines() if line.startswith("### ")
    ]


def test_the_page_carries_its_document(tmp_path: Path) -> None:
    text = write(bench_front(), tmp_path / "cycle.html").read_text()
    carried = EMBEDDED.search(text)
    assert carried is not None
    assert json.loads(carried[1]) == bench_front().to_dict()


def test_breaks_and_set_up_are_said_to_play_no_part(tmp_path: Path) -> None:
    text = write(bench_front(), tmp_path / "cycle.md").read_text()
    assert "Breaks play no part in a cycle" in text
    assert "runs into a break" not in text


def test_the_summary_tells_a_takt_a_front_and_a_changed_cell() -> None:
    t = words("en")
    front = " ".join(summary(thesis_cycles(), t))
    assert "There are 4 sensible compromises between cycle time and stress" in front
    assert "We recommend point 3: a cycle time of 24 s, 150 products in an hour" in front
    chosen = summary(bench_front(), t, stale=True)
    assert chosen[0].startswith("Stale:")
    assert "Asked for: a takt of 26 s." in chosen[1]
    assert "The cycle time is 24 s, which makes 150 products in an hour" in chosen[1]
    assert "by 2 humans and 1 robot" in chosen[1]


def mixed() -> CycleFront:
    """Two of the bench's products in each cycle, one a variant, and what a piece costs."""
    document = {
        **bench().to_dict(),
        "cost": {"operators": {"anna": 30, "ben": 30}, "station": 12},
        "variants": {"long": {"tasks": {"screw": {"time": {"cobot": 9}}}}},
    }
    return plan_mix(
        Cell.model_validate(document), {"base": 1, "long": 1}, minimize="cycle_time", workers=1
    )


def test_a_mix_is_told_as_one_and_counted_by_its_products(tmp_path: Path) -> None:
    front = mixed()
    time = front[0].cycle_time
    an_hour, piece = round(2 * 3600 / time, 1), round(72 * time / 3600 / 2, 4)
    (row, *_) = csv.DictReader(io.StringIO(to_csv(front)))
    assert (float(row["per_hour"]), float(row["cost"])) == (an_hour, pytest.approx(piece, abs=1e-4))
    text = " ".join(printed(CycleView(front), 120).split())
    assert "the products of a cycle, 1 of base and 1 of long, are finished" in text
    assert f"{an_hour:g} products per hour" in text
    for ending in (".md", ".html"):
        page = write(front, tmp_path / f"cycle{ending}").read_text()
        assert "in each cycle, which makes 1 of base and 1 of long." in page
        assert "cost a piece" in page
    book = openpyxl.load_workbook(write(front, tmp_path / "cycle.xlsx"))
    heads = [cell.value for cell in book["Front"][3]]
    assert book["Front"].cell(4, heads.index("cost a piece") + 1).value == pytest.approx(
        piece, abs=1e-4
    )
    stored = read_cycle(write(front, tmp_path / "cycle.json"))
    assert stored.front.mix == front.mix
    assert stored.front.to_dict()["front"] == front.to_dict()["front"]


# --- read back ------------------------------------------------------------------------------------


def kept(front: CycleFront, path: Path) -> Path:
    return write(front, path)


@pytest.mark.parametrize("name", FRONTS)
def test_a_cycle_read_back_is_the_cycle_that_was_written(name: str, tmp_path: Path) -> None:
    front = FRONTS[name]()
    stored = read_cycle(kept(front, tmp_path / "cycle.json"))
    assert stored.front.to_dict() == {**front.to_dict(), "wall_s": stored.front.to_dict()["wall_s"]}
    assert (stored.cell, stored.made_for, stored.is_stale) == (front.cell, front.cell.digest, False)
    assert stored.front.question == front.question


def damaged(path: Path, **changes: Any) -> Path:
    """The document with these keys of its first point replaced."""
    document = json.loads(path.read_text())
    document["front"][0].update(changes)
    path.write_text(json.dumps(document))
    return path


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"cycle_time": 20}, "point 1: operator 'cobot': does task 'place'"),
        ({"cycle_time": 27}, "point 1: the cycle time is 27 s, over its limit of 26 s"),
        (
            {"stress": 1},
            "point 1: is said to be worth 42 s and a stress of 1, but takes 42 s with 4",
        ),
        ({"in_process": 3}, "point 1: is said to have 3 in process, but has 2"),
        ({"digest": "0" * 12}, "point 1: is said to be cycle '000000000000', but is cycle"),
    ],
)
def test_a_cycle_that_is_not_what_it_says_is_refused(
    changes: dict[str, Any], said: str, tmp_path: Path
) -> None:
    path = damaged(kept(bench_front(), tmp_path / "cycle.json"), **changes)
    with pytest.raises(UnsoundScheduleError) as refused:
        read_cycle(path)
    assert said in str(refused.value)


@pytest.mark.parametrize("value", [0, -3, "soon", None, True])
def test_a_cycle_time_must_be_one(value: object, tmp_path: Path) -> None:
    path = damaged(kept(bench_front(), tmp_path / "cycle.json"), cycle_time=value)
    with pytest.raises(CellError, match=r"cycle\.json.*point 1 of the front: cycle_time is"):
        read_cycle(path)


def test_a_cycle_is_stale_once_the_cell_beside_it_has_changed(tmp_path: Path) -> None:
    dump(bench(), tmp_path / "cell.yaml")
    path = kept(replace(bench_front(), source="cell.yaml"), tmp_path / "cycle.json")
    assert not read_cycle(path).is_stale
    changed = dumps(bench()).replace("cobot: 7", "cobot: 6.5")
    assert changed != dumps(bench())
    (tmp_path / "cell.yaml").write_text(changed)
    assert "made for another state" in read_cycle(path).stale_note()
    assert "für einen anderen Stand" in read_cycle(path).stale_note("de")


def test_plans_and_cycles_are_not_taken_for_each_other(tmp_path: Path) -> None:
    from tests.draw.cells import thesis_front

    from tandem.report.files import write as write_plan

    with pytest.raises(CellError, match="holds plans of one product, and no cycles"):
        read_cycle(write_plan(thesis_front(), tmp_path / "plan.json"))
    with pytest.raises(CellError, match="holds the cycles of a station that repeats"):
        read_plan(kept(bench_front(), tmp_path / "cycle.json"))


# --- commands -------------------------------------------------------------------------------------


def test_report_and_check_know_cycles(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    front = thesis_cycles()
    kept(front, tmp_path / "cycle.json")
    dump(front.cell, tmp_path / "cell.yaml")
    assert run(["check", "cycle.json"]) == 0
    assert run(["check", "cell.yaml", "cycle.json"]) == 0
    assert "4 schedules, none breaks the cell" in capsys.readouterr().out
    assert (
        run(["report", "cycle.json", "--stress", "7", "-o", "a.md", "b.html", "--lang", "de"]) == 0
    )
    assert "Punkt 2: Zykluszeit 20 s, Belastung 7" in (tmp_path / "a.md").read_text()
    capsys.readouterr()
    assert run(["report", "cycle.json", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["objectives"] == ["cycle_time", "stress"]
    assert run(["report", "cycle.json"]) == 0
    assert "Point 3: cycle time 24 s, stress 3" in capsys.readouterr().out
    assert run(["report", "cycle.json", "--makespan", "20"]) == 2
    assert run(["report", "cycle.json", "-o", "a.xml"]) == 2
    damaged(tmp_path / "cycle.json", cycle_time=18)
    assert run(["check", "cycle.json"]) == 6
    assert run(["report", "cycle.json"]) == 6
    assert "at the same time" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        ["explain", "cycle.json"],
        ["compare", "cycle.json", "cycle.json"],
        ["simulate", "cell.yaml", "--plan", "cycle.json", "--policy", "fixed"],
        ["dispatch", "cell.yaml", "--plan", "cycle.json"],
        ["replan", "cell.yaml", "--from", "cycle.json"],
        ["plan", "cell.yaml", "--from", "cycle.json"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_every_other_command_says_that_it_wants_a_plan(
    arguments: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    kept(thesis_cycles(), tmp_path / "cycle.json")
    dump(thesis_cycles().cell, tmp_path / "cell.yaml")
    assert run(arguments) == 3
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.count("holds the cycles of a station that repeats") == 1
    assert len(told.err.strip().splitlines()) == 1


def test_a_project_judges_cycles_by_their_own_checker(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "results").mkdir()
    dump(bench(), tmp_path / "cell.yaml")
    kept(bench_front(), tmp_path / "results" / "cycle.json")
    write(bench_front(), tmp_path / "results" / "cycle.html")
    assert run(["check", str(tmp_path)]) == 0
    damaged(tmp_path / "results" / "cycle.json", cycle_time=20)
    assert run(["check", str(tmp_path)]) == 6
    assert "'cobot'" in "".join(capsys.readouterr())
