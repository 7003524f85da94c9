"""Facts in YAML and in workbooks: what is read, converted and asked for, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from tandem.cell.stated import Conditions, meanings, with_unit
from tandem.ergonomics import METHODS, FactsError
from tandem.ergonomics.facts import about
from tandem.ergonomics.tasks import scored
from tandem.ergonomics.units import UNITS, converted
from tandem.files.facts.angles import load_angles
from tandem.files.facts.load import FactsFile, load_facts
from tandem.files.facts.template import write

SOUND = (
    "{method: reba, side: right, trunk: 45, neck: 25, upper arm: 50, lower arm: 70, wrist: 10,"
    " knees: 0, load: 6, grip: fair}"
)
EXAMPLE = Path(__file__).parents[3] / "examples" / "ergonomics" / "gearbox.yaml"


def read(tmp_path: Path, text: str, **whole: Any) -> FactsFile:
    file = tmp_path / "facts.yaml"
    file.write_text(text, "utf-8")
    return load_facts(file, Conditions(**whole))


def refused(tmp_path: Path, text: str, **whole: Any) -> list[str]:
    with pytest.raises(FactsError) as error:
        read(tmp_path, text, **whole)
    return [str(fault) for fault in error.value.faults]


def sheet(tmp_path: Path, rows: list[list[Any]]) -> Path:
    book = openpyxl.Workbook()
    for row in rows:
        book.worksheets[0].append(row)
    book.worksheets[0].title = "Angaben"
    book.save(tmp_path / "facts.xlsx")
    return tmp_path / "facts.xlsx"


# --- what is read ---------------------------------------------------------------------------------


def test_the_example_is_read_with_where_each_fact_came_from():
    file = load_facts(EXAMPLE)
    assert file.name == "Gearbox, station 3"
    assert [(task.task, task.method, task.side) for task in file.tasks] == [
        ("insert bearing", "reba", "right"), ("insert bearing", "duet", "right"),
        ("lift housing", "niosh", ""),
    ]  # fmt: skip
    reba, duet, niosh = file.tasks
    assert reba.origins["trunk_flexion_deg"].source == "video"
    assert reba.origins["trunk_flexion_deg"].assessor == "M. Muster"
    assert reba.origins["shock"].source == "default"
    assert niosh.origins["L"].source == "measured"
    assert niosh.origins["H"].source == "stated"
    assert dict(duet.facts)["reps"] == 3 * 420


@pytest.mark.parametrize("language", ["en", "de"])
def test_the_template_has_twenty_tasks_and_is_scored_alike_in_both_languages(tmp_path, language):
    write(tmp_path / "facts.xlsx", language)
    file = load_facts(tmp_path / "facts.xlsx", Conditions(cycles=420))
    assert len(file.tasks) == 20
    assert file.remarks == ()
    levels = [scored(task).outcome.level for task in file.tasks]
    assert levels == [3, 2, 1, 1, 2, 3, 3, 1, 1, 3, 1, 1, 0, 1, 1, 1, 1, 0, 0, 0]


def test_german_headings_words_and_decimal_commas_are_understood(tmp_path):
    path = sheet(
        tmp_path,
        [
            ["Bewertung der Station 3"],
            ["Vorgang", "Methode", "Seite", "Oberarm [°]", "Unterarm [°]", "Handgelenk [°]",
             "Nacken [°]", "Rumpf [rad]", "Last [lb]", "statisch", "Quelle", "Datum"],
            ["Lager einsetzen", "RULA", "rechts", "38,5", 85, 12, 22, 0.2617993878, 4.5, "ja",
             "gemessen", "03.11.2025"],
        ],
    )  # fmt: skip
    (task,) = load_facts(path).tasks
    facts = dict(task.facts)
    assert (task.task, task.method, task.side) == ("Lager einsetzen", "rula", "right")
    assert facts["upper_arm_flexion_deg"] == 38.5
    assert math.isclose(facts["trunk_flexion_deg"], 15, rel_tol=1e-6)
    assert math.isclose(facts["load_kg"], 4.5 * 0.45359237)
    assert facts["static"] is True
    assert task.origins["load_kg"].source == "measured"
    assert task.origins["load_kg"].date == "03.11.2025"


@pytest.mark.parametrize(
    ("stated", "fact", "value"),
    [
        ("load: 12 lb", "load_kg", 5.44310844),
        ("load: 98.0665 N", "load_kg", 10.0),
        ("load: 2500 g", "load_kg", 2.5),
        ("load: 2,5", "load_kg", 2.5),
        ("load: {value: 10, unit: lb}", "load_kg", 4.5359237),
    ],
)
def test_units_of_mass_and_force_are_converted(tmp_path, stated, fact, value):
    text = f"tasks: {{a: {SOUND.replace('load: 6', stated)}}}".replace("2,5", "'2,5'")
    (task,) = read(tmp_path, text).tasks
    assert math.isclose(dict(task.facts)[fact], value)


def test_lengths_and_angles_are_converted(tmp_path):
    text = (
        "tasks: {a: {method: lifft, lever: 16 in, load: 5, reps: 10},"
        " b: {method: lifft, lever: 400 mm, load: 5, reps: 10},"
        f" c: {SOUND.replace('trunk: 45', 'trunk: 0.7853981634 rad')}}}"
    )
    a, b, c = read(tmp_path, text).tasks
    assert math.isclose(dict(a.facts)["lever_cm"], 40.64)
    assert math.isclose(dict(b.facts)["lever_cm"], 40.0)
    assert math.isclose(dict(c.facts)["trunk_flexion_deg"], 45, rel_tol=1e-9)


@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_converted_there_and_back_is_the_same(unit):
    for other, kind in UNITS.items():
        if kind.measures == UNITS[unit].measures:
            assert math.isclose(converted(converted(7.3, unit, other), other, unit), 7.3)
        else:
            with pytest.raises(ValueError, match="measures"):
                converted(7.3, unit, other)


def test_a_lift_in_inches_and_pounds_stays_in_the_us_system(tmp_path):
    text = (
        "tasks: {a: {method: niosh, unit: in, H: 10, V: 30, D: 10, A: 0, F: 0.2, duration: short,"
        " grip: good, L: 51}}"
    )
    (task,) = read(tmp_path, text).tasks
    assert scored(task).outcome.score == pytest.approx(1.0)
    (other,) = read(tmp_path, text.replace("L: 51", "L: 23.13321087 kg")).tasks
    assert dict(other.facts)["L"] == pytest.approx(51)


def test_the_wrist_is_turned_round_for_the_strain_index(tmp_path):
    """A column of flexion serves RULA as it is, and RSI, which takes extension as positive."""
    text = "tasks: {a: {method: rsi, I: 0.3, E: 8, D: 1, H: 4, wrist: 15}}"
    (task,) = read(tmp_path, text).tasks
    assert dict(task.facts)["P"] == -15


def test_every_fact_has_its_published_name_and_its_unit_is_known():
    for method in METHODS.values():
        for name, field in method.model.model_fields.items():
            assert name in meanings(name)
            unit = about(field)["unit"]
            assert unit == "" or unit in UNITS


def test_units_are_taken_off_a_heading():
    assert with_unit("Rumpf [°]") == ("Rumpf", "deg")
    assert with_unit("load (lb)") == ("load", "lb")
    assert with_unit("Hebelarm in cm") == ("Hebelarm", "cm")
    assert with_unit("Griff") == ("Griff", None)


# --- what is refused ------------------------------------------------------------------------------


def test_a_missing_fact_is_named_with_a_cautious_value_and_never_assumed(tmp_path):
    text = "tasks: {a: {method: duet, side: left, omni_res: 4}}"
    (fault,) = refused(tmp_path, text)
    assert "facts.yaml:1:9" in fault
    assert "reps is missing (exertions per work day)" in fault
    assert "a cautious value would be 5000" in fault


def test_cautious_takes_the_value_and_marks_it(tmp_path):
    text = "tasks: {a: {method: duet, side: left, omni_res: 4}}"
    (task,) = read(tmp_path, text, cautious=True).tasks
    assert dict(task.facts)["reps"] == 5000
    assert task.origins["reps"].source == "default"
    assert scored(task).unstated == {"reps": 5000}


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ("trunk: 200", "trunk_flexion_deg is 200 degrees, but reba takes -45 to 150 degrees"),
        ("trunk: much", "trunk_flexion_deg is 'much', but a number of degrees is needed"),
        ("trunk: 45 kg", "trunk_flexion_deg is '45 kg': kg measures mass, but deg is needed"),
        ("trunk: .nan", "trunk_flexion_deg is nan, but must be a number"),
        ("load: -5", "load_kg is -5 kg, but reba takes 0 to 100 kg"),
        ("grip: great", "coupling is 'great', but must be 'good', 'fair'"),
        ("side: middle", "side is 'middle', but must be left, right, both"),
        ("method: rebba", "there is no method 'rebba'. Did you mean 'reba'?"),
        ("method: eaws", "EAWS scores no tasks here"),
        ("omni_res: 4", "'omni_res' is a fact of duet, but the row is scored by reba. Scales are"),
        ("turnk: 3", "reba knows no fact 'turnk'"),
        ("source: guess", "source is 'guess', but must be measured, video, estimated"),
        ("minutes: 2000", "minutes is 2000, but must be a number from 0 to 1440"),
    ],
)
def test_bad_facts_are_refused_with_place_value_and_remedy(tmp_path, changed, said):
    key = changed.partition(":")[0]
    row = dict(part.split(": ") for part in SOUND.strip("{}").split(", "))
    row[key] = changed.partition(": ")[2]
    inside = ", ".join(f"{name}: {value}" for name, value in row.items())
    (fault,) = refused(tmp_path, f"tasks:\n  a: {{{inside}}}\n")
    assert said in fault
    assert "facts.yaml:2:" in fault


def test_swapped_sides_are_seen_by_the_name_and_by_doubles(tmp_path):
    right = SOUND
    (fault,) = refused(tmp_path, f"tasks: {{Griff links: {right}}}")
    assert "the task's name says left, but side says right. Were the sides swapped?" in fault
    (fault,) = refused(tmp_path, f"tasks: {{a: [{right}, {right}]}}")
    assert "reba, side right is stated twice" in fault
    assert "Is one of them the other side?" in fault


def test_a_side_of_a_method_of_the_whole_body_is_refused(tmp_path):
    (fault,) = refused(
        tmp_path, "tasks: {a: {method: lifft, side: left, lever: 40, load: 5, reps: 3}}"
    )
    assert "lifft scores the whole body and knows no left side" in fault


def test_all_faults_of_all_rows_are_told_at_once(tmp_path):
    text = """
foo: 1
cycles_per_shift: -3
tasks:
  a: {method: duet, omni_res: 11, reps: -1}
  b: {method: rebba}
  c: 5
"""
    said = "\n".join(refused(tmp_path, text))
    for part in (
        "unknown key `foo`", "cycles_per_shift is -3", "omni_res is 11", "reps is -1",
        "no method 'rebba'", "task 'c': a mapping of facts is needed",
    ):  # fmt: skip
        assert part in said


def test_repetitions_per_cycle_need_the_cycles_of_a_shift(tmp_path):
    text = "tasks: {a: {method: duet, omni_res: 4, reps_per_cycle: 3}}"
    (fault,) = refused(tmp_path, text)
    assert "State cycles_per_shift at the top of the file, or give --cycles N" in fault
    (task,) = read(tmp_path, text, cycles=100).tasks
    assert dict(task.facts)["reps"] == 300


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "the file is empty"),
        ("[1, 2]", "a mapping with the key `tasks`"),
        ("tasks: {}", "`tasks` is missing or empty"),
        ("tasks: {a: []}", "task 'a': a mapping of facts is needed"),
        ("operators: {a: {kind: human}}\ntasks: {1: {time: {a: 3}}}", "this is a cell file"),
        ("tasks: {a: {method: duet, omni_res: {values: 3}, reps: 3}}", "Write its `value`"),
        ("tasks: {a: {omni_res: 3, reps: 3}}", "no method is named"),
        ("tasks: {a: {method: duet, omni_res: 3, omni_res: 4, reps: 3}}", "stated twice"),
    ],
)
def test_files_that_hold_no_facts_say_so(tmp_path, text, said):
    assert any(said in fault for fault in refused(tmp_path, text))


def test_a_bad_cell_of_a_sheet_is_named(tmp_path):
    path = sheet(
        tmp_path,
        [
            ["Vorgang", "Methode", "Seite", "Anstrengungsgrad", "Wiederholungen je Tag"],
            ["Kabel", "duet", "links", 14, 100],
            ["Kabel", "duet", "rechts", 4, "viele"],
            ["", "duet", "rechts", 4, 3],
        ],
    )
    with pytest.raises(FactsError) as error:
        load_facts(path)
    said = [str(fault) for fault in error.value.faults]
    assert any("Angaben!D2" in one and "omni_res is 14" in one for one in said)
    assert any("Angaben!E3" in one and "'viele'" in one for one in said)
    assert any("Angaben!A4" in one and "no task" in one for one in said)


def test_a_sheet_without_facts_says_what_a_header_needs(tmp_path):
    path = sheet(tmp_path, [["a", "b"], [1, 2]])
    with pytest.raises(FactsError, match="no sheet has a header with the tasks and their facts"):
        load_facts(path)


def test_a_column_that_is_no_fact_is_named(tmp_path):
    path = sheet(
        tmp_path,
        [["Vorgang", "Methode", "Anstrengungsgrad", "Wiederholungen je Tag", "Farbe"],
         ["Kabel", "duet", 4, 100, "rot"]],
    )  # fmt: skip
    assert load_facts(path).remarks == ("Angaben!E1: column 'Farbe' is no fact, and not read.",)


# --- angles frame by frame ------------------------------------------------------------------------


def frames(tmp_path: Path, lines: list[str]) -> Path:
    path = tmp_path / "frames.csv"
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


REST = {"load": 4, "grip": "fair", "knees": 0, "wrist": 0, "lower arm": 80}


def test_a_recording_gives_the_median_the_95th_percentile_and_the_peak(tmp_path):
    lines = ["t;Rumpf [°];Nacken;Oberarm"]
    lines += [f"{i};{i},0;{-i if i == 40 else 5};30" for i in range(1, 101)]
    median, high, peak = load_angles(frames(tmp_path, lines), "reba", REST, Conditions())
    of = [dict(task.facts) for task in (median, high, peak)]
    assert [facts["trunk_flexion_deg"] for facts in of] == [50, 95, 100]
    assert [facts["neck_flexion_deg"] for facts in of] == [5, 5, -40]
    assert median.origins["trunk_flexion_deg"].source == "video"
    assert median.origins["load_kg"].source == "stated"
    scores = [scored(task).outcome.score for task in (median, high, peak)]
    assert scores == sorted(scores)


def test_a_frame_without_a_number_is_named(tmp_path):
    path = frames(tmp_path, ["trunk,neck,upper arm", "1,2,3", "1,,3", "x,2,3"])
    with pytest.raises(FactsError) as error:
        load_angles(path, "reba", REST, Conditions())
    said = [str(fault) for fault in error.value.faults]
    assert any("frames.csv:3:2" in one and "neck_flexion_deg is ''" in one for one in said)
    assert any("frames.csv:4:1" in one and "trunk_flexion_deg is 'x'" in one for one in said)


def test_a_recording_without_angles_and_a_method_without_joints_say_so(tmp_path):
    path = frames(tmp_path, ["a,b", "1,2"])
    with pytest.raises(FactsError, match="no column is an angle of reba"):
        load_angles(path, "reba", REST, Conditions())
    with pytest.raises(FactsError, match="duet takes no angles of joints"):
        load_angles(path, "duet", REST, Conditions())
