"""Commands on a stored plan: which point is meant, what is said when its cell has changed, and how
they end when the plan is none.
"""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import openpyxl
import pytest

from tandem.cell.language import sentences
from tandem.cli.root import run

EXAMPLES = Path(__file__).parents[2] / "examples"
STALE = "stale: made for another state of the cell"


class Typed:
    """What a command printed, and how it ended."""

    def __init__(self, capfd: pytest.CaptureFixture[str]):
        self.capfd = capfd

    def __call__(self, *arguments: str) -> tuple[int, str, str]:
        self.capfd.readouterr()
        code = run(list(arguments))
        printed = self.capfd.readouterr()
        return code, printed.out, printed.err


@pytest.fixture
def typed(capfd: pytest.CaptureFixture[str]) -> Typed:
    return Typed(capfd)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the thesis's cell and a plan of it, as the working folder."""
    shutil.copy(EXAMPLES / "thesis.yaml", tmp_path / "cell.yaml")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "160")
    assert run(["plan", "cell.yaml", "--workers", "1", "-q", "-o", "plan.json"]) == 0
    return tmp_path


def digests(path: Path) -> list[str]:
    return [row["digest"] for row in json.loads(path.read_text())["front"]]


def change(cell: Path, before: str, after: str) -> None:
    text = cell.read_text()
    assert before in text
    cell.write_text(text.replace(before, after))


ROBOT_1 = ("1: {time: {robot: 9, human: 10}", "1: {time: {robot: 8, human: 10}")
HUMAN_1 = ("1: {time: {robot: 9, human: 10}", "1: {time: {robot: 9, human: 11}")


# --- points ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("which", "place"),
    [
        ((), 1),
        (("--point", "3"), 2),
        (("--makespan", "33.9"), 1),
        (("--makespan", "23"), 0),
        (("--stress", "2.5"), 2),
        (("--stress", "7"), 0),
    ],
)
def test_a_point_is_named_by_number_time_or_stress(
    here: Path, typed: Typed, which: tuple[str, ...], place: int
) -> None:
    digest = digests(here / "plan.json")[place]
    code, out, _ = typed("report", "plan.json", *which)
    assert code == 0
    assert f"plan {digest}" in out
    code, out, _ = typed("explain", "plan.json", "--task", "5", *which)
    assert f"point {place + 1} of 3" in out
    assert f"plan {digest}" in out
    code, out, _ = typed("compare", "plan.json", "plan.json", *which)
    assert f"plan {digest}" in out


@pytest.mark.parametrize("command", ["report", "explain", "compare"])
@pytest.mark.parametrize(
    ("which", "said"),
    [
        (
            ("--point", "4"),
            "--point 4: the front has 3 points, counted from 1: (23 s, 7), (24 s, 3)",
        ),
        (("--makespan", "22.5"), "--makespan 22.5: no point of the front keeps this"),
        (("--stress", "1"), "--stress 1: no point of the front keeps this"),
        (("--point", "1", "--stress", "7"), "exclude each other"),
    ],
)
def test_a_point_that_is_not_there_ends_with_the_points_that_are(
    here: Path, typed: Typed, command: str, which: tuple[str, ...], said: str
) -> None:
    files = ("plan.json",) * (2 if command == "compare" else 1)
    code, out, err = typed(command, *files, *which)
    assert (code, out) == (2, "")
    assert said in err


def test_planning_shows_the_point_that_is_asked_for(here: Path, typed: Typed) -> None:
    plan = ("plan", "cell.yaml", "--workers", "1", "-q")
    code, out, _ = typed(*plan, "--point", "3", "-o", "sheets.xlsx", "-o", "again.json")
    assert code == 0
    assert "Point 3: makespan 34 s, stress 2" in out
    digest = digests(here / "again.json")[2]
    assert f"plan {digest}" in out
    sheet = openpyxl.load_workbook("sheets.xlsx")["robot"]
    assert any(digest in str(cell.value) for line in sheet for cell in line)


def test_a_point_that_was_not_found_does_not_lose_what_was(here: Path, typed: Typed) -> None:
    plan = ("plan", "cell.yaml", "--workers", "1", "-q", "--point", "9")
    code, _, err = typed(*plan, "-o", "kept.json", "-o", "slide.svg")
    assert code == 2
    assert "--point 9: the front has 3 points" in err
    assert "wrote kept.json" in err
    assert len(digests(here / "kept.json")) == 3
    assert not (here / "slide.svg").exists()


# --- stale ----------------------------------------------------------------------------------------


def test_everyone_says_that_a_plan_is_stale(here: Path, typed: Typed) -> None:
    change(here / "cell.yaml", *ROBOT_1)
    on_paper = "made for another state of the cell"
    files = ["a.html", "a.md", "a.svg", "a.xml", "a.csv", "a.json", "a.xlsx"]
    wanted = [part for file in files for part in ("-o", file)]
    for command in (
        ("report", "plan.json"),
        ("report", "plan.json", *wanted),
        ("explain", "plan.json", "--task", "5"),
        ("compare", "plan.json", "plan.json"),
        ("check", "plan.json"),
    ):
        code, out, err = typed(*command)
        assert code == 0, (command, err)
        assert f"plan.json: {STALE}" in err, command
        if command[0] != "check" and "-o" not in command:
            assert on_paper in out, command
    for file in files[:4]:
        assert on_paper in (here / file).read_text(), file
    assert ",yes\n" in (here / "a.csv").read_text()
    assert json.loads((here / "a.json").read_text())["stale"] is True
    for sheet in openpyxl.load_workbook("a.xlsx").worksheets[:5]:
        assert any(on_paper in str(cell.value) for line in sheet for cell in line), sheet.title


def test_a_stale_plan_that_breaks_the_cell_as_it_is_is_refused(here: Path, typed: Typed) -> None:
    change(here / "cell.yaml", *ROBOT_1)
    for command in (
        ("report", "plan.json", "--cell", "cell.yaml", "-o", "a.md"),
        ("check", "cell.yaml", "plan.json"),
    ):
        code, _, err = typed(*command)
        assert code == 6
        assert STALE in err
        assert "task '1': robot cannot do it in 9 s" in err
    assert not (here / "a.md").exists()


def test_a_stale_plan_that_keeps_the_cell_as_it_is_is_shown_as_it_was_stored(
    here: Path, typed: Typed
) -> None:
    change(here / "cell.yaml", *HUMAN_1)
    code, out, err = typed("report", "plan.json", "--cell", "cell.yaml")
    assert (code, STALE in err) == (0, True)
    assert digests(here / "plan.json")[1] in out


def test_where_the_command_is_typed_does_not_matter(
    here: Path, typed: Typed, monkeypatch: pytest.MonkeyPatch
) -> None:
    (here / "results").mkdir()
    (here / "elsewhere").mkdir()
    shutil.move(here / "plan.json", here / "results" / "plan.json")
    # a cell of the same name that has nothing to do with the plan
    shutil.copy(EXAMPLES / "gearbox.yaml", here / "elsewhere" / "cell.yaml")
    for folder in (here, here / "results", here / "elsewhere"):
        monkeypatch.chdir(folder)
        plan = str(here / "results" / "plan.json")
        assert STALE not in typed("check", plan)[2], folder
    change(here / "cell.yaml", *ROBOT_1)
    for folder in (here, here / "results", here / "elsewhere"):
        monkeypatch.chdir(folder)
        assert STALE in typed("check", str(here / "results" / "plan.json"))[2], folder


def test_a_cell_that_is_no_sound_one_any_more_makes_its_plan_stale(
    here: Path, typed: Typed
) -> None:
    (here / "cell.yaml").write_text("operators: {}")
    assert STALE in typed("check", "plan.json")[2]


def test_a_plan_of_a_variant_or_of_standard_input_names_no_file_to_be_stale_for(
    here: Path, typed: Typed
) -> None:
    variant = ("plan", "cell.yaml", "--set", "tasks.1.time.robot=8", "--workers", "1", "-q")
    assert typed(*variant, "-o", "variant.json")[0] == 0
    code, out, err = typed("check", "variant.json")
    assert (code, err) == (0, "")
    assert "variant.json: 3 schedules, none breaks the cell that it holds." in out


# --- what is none ---------------------------------------------------------------------------------


def test_a_plan_that_somebody_changed_by_hand_is_refused(here: Path, typed: Typed) -> None:
    document = json.loads((here / "plan.json").read_text())
    (first,) = [row for row in document["front"][0]["assignments"] if row["task"] == "1"]
    first["end"] += 1
    document["front"][1]["makespan"] = 20
    document["front"][2]["digest"] = "0" * 12
    (here / "plan.json").write_text(json.dumps(document))
    for command in (("check", "plan.json"), ("report", "plan.json"), ("explain", "plan.json")):
        code, _, err = typed(*command)
        assert code == 6
        assert "1: task '1': robot cannot do it in 10 s" in err
        assert "2: is said to be worth 20 s and a stress of 3, but takes 24 s with 3" in err
        assert "3: is said to be plan '000000000000', but is plan" in err
    found = json.loads(typed("check", "plan.json", "--json")[1])
    assert sorted({row["point"] for row in found["faults"]}) == [1, 2, 3]


def test_a_cell_is_no_plan(here: Path, typed: Typed) -> None:
    code, _, err = typed("report", "cell.yaml")
    assert code == 3
    assert "cell.yaml" in err
    assert "Give what `tandem plan CELL --json` prints" in err
    assert typed("report", "nowhere.json")[0] == 3


def test_a_file_of_no_known_kind_is_refused_before_anything_is_written(
    here: Path, typed: Typed
) -> None:
    code, _, err = typed("report", "plan.json", "-o", "a.md", "-o", "a.docx")
    assert code == 2
    assert "'.docx'" in err
    assert not (here / "a.md").exists()


def test_files_may_follow_one_another_but_only_after_o(here: Path, typed: Typed) -> None:
    code, _, err = typed("report", "plan.json", "-o", "a.md", "b.csv", "--point", "1")
    assert (code, err.split()) == (0, ["wrote", "a.md", "wrote", "b.csv"])
    kept = (here / "plan.json").read_bytes()
    code, _, err = typed("report", "a.json", "plan.json")
    assert code == 2
    assert "-o plan.json" in err
    assert (here / "plan.json").read_bytes() == kept


def test_the_floor_of_a_front_of_one_is_that_of_what_was_asked(here: Path, typed: Typed) -> None:
    for asked, floor in (
        (("--minimize", "stress"), "34 s is the floor with a stress of at most 2"),
        (("--minimize", "makespan"), "23 s is the floor: "),
        (("--max-stress", "5"), "24 s is the floor with a stress of at most 3"),
    ):
        plan = ("plan", "cell.yaml", "--workers", "1", "-q", *asked, "-o", "one.json")
        assert typed(*plan)[0] == 0
        code, out, _ = typed("explain", "one.json", "--point", "1", "--time-limit", "8")
        assert code == 0
        assert floor in out, asked


# --- German ---------------------------------------------------------------------------------------


def test_the_terminal_speaks_german_when_asked(here: Path, typed: Typed) -> None:
    change(here / "cell.yaml", "robot: 9", "robot: 9.5")
    code, out, err = typed("plan", "cell.yaml", "--workers", "1", "--lang", "de", "-o", "de.json")
    assert code == 0
    for said in ("Punkte auf der Front", "Dauer [s]", "bewiesen", "kritischer Pfad", "24,5 s"):
        assert said in out
    for said in ("Dauer", "der Fläche der Front offen", "de.json geschrieben"):
        assert said in err
    _, out, _ = typed("explain", "de.json", "--lang", "de", "--task", "7")
    assert "wartet auf Vorgang" in out
    assert "auf dem kritischen Pfad" in out
    _, out, _ = typed("compare", "de.json", "plan.json", "--lang", "de")
    assert "verschiedenen Zellen" in out
    assert "Dauer 24,5 s -> 24 s, Belastung 3 -> 3" in out
    change(here / "cell.yaml", "robot: 9.5", "robot: 9")
    _, _, err = typed("report", "de.json", "--lang", "de")
    assert "veraltet: für einen anderen Stand der Zelle gemacht" in err
    what_if = ("plan", "cell.yaml", "--set", "tasks.1.time.robot=8.5", "-q", "--workers", "1")
    _, out, _ = typed(*what_if, "--lang", "de")
    assert "Vorgang 1: robot braucht 8,5 s statt 9 s" in out
    assert "bei gleicher Belastung" in out


def words_of(room: str, language: str) -> dict[str, str]:
    return sentences(f"tandem.{room}", language)


@pytest.mark.parametrize("room", ["cell", "draw", "explain", "files.spreadsheet", "report"])
def test_both_languages_say_the_same_things(room: str) -> None:
    english, german = words_of(room, "en"), words_of(room, "de")
    assert english.keys() == german.keys()
    for key, sentence in english.items():
        places = [set(re.findall(r"{(\w+)}", text)) for text in (sentence, german[key])]
        assert places[0] == places[1], key


def begun(typed: Typed, *more: str, code: int = 0) -> tuple[str, str]:
    """`tandem plan cell.yaml --from plan.json`: what was printed on both sides."""
    ended, out, err = typed("plan", "cell.yaml", "--from", "plan.json", "--work", "1", "-q", *more)
    assert ended == code, err
    return out, err


def test_a_plan_begins_with_the_schedules_of_a_stored_one(here: Path, typed: Typed) -> None:
    out, err = begun(typed, "--json")
    assert err == "--from plan.json: 3 of 3 schedules fit.\n"
    old, new = json.loads((here / "plan.json").read_text()), json.loads(out)
    assert new["front"] == old["front"]


def test_with_no_work_to_speak_of_it_still_has_what_was_stored(here: Path, typed: Typed) -> None:
    points = json.loads((here / "plan.json").read_text())["front"]
    out, _ = begun(typed, "--minimize", "stress", "--method", "exhaustive", "--json")
    assert json.loads(out)["front"][0]["stress"] == points[-1]["stress"] == 2


@pytest.mark.parametrize(
    ("limit", "fits"), [(("--max-stress", "3"), 2), (("--max-makespan", "24"), 2)]
)
def test_what_breaks_a_limit_is_left_aside_and_said(
    here: Path, typed: Typed, limit: tuple[str, str], fits: int
) -> None:
    _, err = begun(typed, *limit)
    assert f"--from plan.json: {fits} of 3 schedules fit; 1 left aside, point " in err
    assert err.count("\n") == 1


def test_what_a_changed_cell_refuses_is_left_aside_and_said(here: Path, typed: Typed) -> None:
    change(here / "cell.yaml", *ROBOT_1)
    _, err = begun(typed)
    assert err.startswith(f"--from plan.json, {STALE}: ")
    assert re.search(r"\d of 3 schedules fit; \d left aside, point 1: .*8 s", err), err
    assert err.count("\n") == 1


def test_a_stored_plan_goes_with_no_cycle(here: Path, typed: Typed) -> None:
    code, _, err = typed("plan", "cell.yaml", "--cycle", "--from", "plan.json")
    assert (code, err.count("\n")) == (2, 1)
    assert "--from: asks about one product alone" in err


def test_the_recommended_point_of_a_kept_front_is_the_one_it_was_stored_with(
    here: Path, typed: Typed
) -> None:
    """Of a front cut short as well, whose bounds are read back with it."""
    layers = ("generate", "layered", "--tasks", "30", "--humans", "2", "--seed", "0")
    assert typed(*layers, "-o", "layers.yaml")[0] == 0
    assert typed("plan", "layers.yaml", "--work", "0.05", "-q", "-o", "cut.json")[0] == 0
    kept = json.loads((here / "cut.json").read_text())
    assert not kept["complete"]
    code, out, _ = typed("report", "cut.json", "--json")
    assert code == 0
    shown = json.loads(out)
    for key in ("recommended", "open_area", "bound_front"):
        assert shown[key] == kept[key]
    _, told, _ = typed("report", "cut.json")
    assert "by what is known" in told
    assert "of the front's area" in told
