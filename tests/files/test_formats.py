"""Public formats: small files worked out by hand, broken ones refused at their line, and every
public set read to the last file.
"""

from __future__ import annotations

import csv
import json
import warnings
from typing import Any

import pytest
from tests.benchmark_data import folder

from tandem.cli.root import run
from tandem.errors import CellError, NotReadWarning
from tandem.files.formats.table import FORMATS, detected
from tandem.files.instances.named import files_of
from tandem.files.load import dumps, load, loads

FJS = "2 3 1.5\n2 2 1 4 3 5 1 2 7\n1 1 3 6\n"
FJS_DAG = "0 0\n3 2 2\n0 2\n1 2\n2 0 4 1 5\n1 1 7\n1 0 3\n"
ALB = "<number of tasks>\n3\n\n<cycle time>\n10\n\n<order strength>\n0,268\n\n"
ALB += "<task times>\n1 4\n2 6\n3 5\n\n<precedence relations>\n1,3\n2,3\n\n<end>\n"
IN2 = "3\n4\n6\n5\n1,3\n2, 3\n-1,-1\n\nBowman (1960)\n"
JSP = "2 3\n0 3 1 2 2 2\n2 4 0 1 1 5\n"
ALWABP = "3\n4 Inf\n6 2\nInf 5\n1 3\n2 3\n-1 -1\n"
CASE: dict[str, Any] = {
    "name": "packs",
    "agents": [{"id": "H1", "type": "human"}, {"id": "R1", "type": "robot"}],
    "tasks": [
        {
            "id": "P1.1",
            "name": "place",
            "product": 1,
            "modes": [{"agents": ["H1"], "time": 15, "sd_left": 5, "sd_right": 4}],
            "fatigue": 0.12345678,
        },
        {
            "id": "P1.2",
            "modes": [{"agents": ["H1"], "time": 20}, {"agents": ["R1"], "time": 50.5}],
            "fatigue": 1,
        },
        {
            "id": "P1.3",
            "modes": [{"agents": ["H1", "R1"], "time": 10, "sd_left": 2, "sd_right": 1}],
        },
    ],
    "precedence": [["P1.1", "P1.2"], ["P1.2", "P1.3"]],
    "same_agent": [["P1.1", "P1.2"]],
}
LIBRARY: dict[str, Any] = {
    "name": "two jobs",
    "duration_matrix": [[3, 2], [4, 1]],
    "machines_matrix": [[0, 1], [1, [0, 2]]],
    "release_dates_matrix": [[0, 0], [5, 0]],
    "deadlines_matrix": [[None, 90], [None, None]],
    "metadata": {"optimum": 7},
}
SMALL = {
    "fjs": FJS,
    "fjs-dag": FJS_DAG,
    "alb": ALB,
    "alwabp": ALWABP,
    "jsp": JSP,
    "case": json.dumps(CASE, indent=1),
    "job-shop-lib": json.dumps(LIBRARY, indent=1),
}


@pytest.mark.parametrize("name", SMALL)
def test_the_format_is_told_from_the_content(name):
    assert detected(SMALL[name]) == name
    assert loads(SMALL[name], source="x/small.txt") == loads(SMALL[name], name, source="small.txt")


def test_in2_is_told_from_the_content():
    assert detected(IN2) == "alb"


def test_our_own_files_are_told_from_the_content():
    cell = loads(FJS)
    assert detected(dumps(cell)) == "yaml"
    assert detected(dumps(cell, "json")) == "json"


def test_a_job_shop_becomes_chains_on_robots():
    cell = loads(FJS, source="folder/mk00.fjs")
    assert cell.name == "mk00"
    assert cell.robots == ("machine_1", "machine_2", "machine_3")
    assert {name: (dict(task.time), task.after) for name, task in cell.tasks.items()} == {
        "1.1": ({"machine_1": 4, "machine_3": 5}, ()),
        "1.2": ({"machine_2": 7}, ("1.1",)),
        "2.1": ({"machine_3": 6}, ()),
    }


def test_machines_counted_from_0_keep_their_numbers():
    assert loads("1 3\n1 2 0 4 2 5\n", "fjs").robots == ("machine_0", "machine_1", "machine_2")


def test_a_graph_becomes_precedence():
    cell = loads(FJS_DAG)
    assert {name: (dict(task.time), task.after) for name, task in cell.tasks.items()} == {
        "0": ({"machine_0": 4, "machine_1": 5}, ()),
        "1": ({"machine_1": 7}, ()),
        "2": ({"machine_0": 3}, ("0", "1")),
    }


def test_a_line_has_as_many_workers_as_its_work_fills():
    cell = loads(ALB)
    assert cell.humans == ("worker_1", "worker_2")  # 15 of work at a cycle time of 10
    assert {name: (dict(task.time), task.after) for name, task in cell.tasks.items()} == {
        "1": ({"worker_1": 4, "worker_2": 4}, ()),
        "2": ({"worker_1": 6, "worker_2": 6}, ()),
        "3": ({"worker_1": 5, "worker_2": 5}, ("1", "2")),
    }
    alone = loads(IN2)
    assert alone.humans == ("worker_1",)
    assert alone.tasks["3"].after == ("1", "2")


def test_a_worker_who_cannot_is_left_out():
    cell = loads(ALWABP)
    assert [dict(task.time) for task in cell.tasks.values()] == [
        {"worker_1": 4},
        {"worker_1": 6, "worker_2": 2},
        {"worker_2": 5},
    ]
    assert cell.tasks["3"].after == ("1", "2")


def test_a_case_keeps_names_parts_groups_fatigue_and_spread():
    cell = loads(SMALL["case"])
    place, screw, joint = cell.tasks.values()
    assert (place.label, place.part, place.stress, dict(place.spread)) == (
        "place",
        "1",
        0.123457,
        {"H1": 0.3},
    )
    assert (dict(screw.time), screw.stress, screw.after) == ({"H1": 20, "R1": 50.5}, 1, ("P1.1",))
    assert [(group.operators, group.time) for group in joint.together] == [(("H1", "R1"), 10)]
    assert joint.spread == 0.15
    assert cell.same_operator == (("P1.1", "P1.2"),)


def test_an_instance_of_job_shop_lib_becomes_chains():
    cell = loads(SMALL["job-shop-lib"])
    assert (cell.name, cell.robots) == ("two jobs", ("machine_0", "machine_1", "machine_2"))
    assert {name: dict(task.time) for name, task in cell.tasks.items()} == {
        "1.1": {"machine_0": 3},
        "1.2": {"machine_1": 2},
        "2.1": {"machine_1": 4},
        "2.2": {"machine_0": 1, "machine_2": 1},
    }
    assert (cell.tasks["2.1"].release, cell.tasks["1.2"].deadline) == (5, 90)
    with pytest.warns(NotReadWarning, match="due dates are not read"):
        loads(json.dumps({**LIBRARY, "due_dates_matrix": [[1, 2], [3, 4]]}))


def test_a_table_of_strain_takes_the_place_of_the_sum():
    cell = loads(
        json.dumps({**CASE, "strain_index_of_human_task_set": {"P1.2,P1.1,P1.3": 4.5, "P1.3": 1}})
    )
    assert cell.stress_of_set == {"P1.1,P1.2,P1.3": 4.5, "P1.3": 1}
    assert all(task.stress == 0 for task in cell.tasks.values())


def test_the_strain_of_a_task_beside_a_table_is_an_assessment_of_that_task():
    tasks = [{**task, "strain": 0.75} for task in CASE["tasks"]]
    cell = loads(
        json.dumps({**CASE, "tasks": tasks, "strain_index_of_human_task_set": {"P1.3": 1}})
    )
    found = cell.exposures["strain_index_1995"]
    assert set(map(str, found.values())) == {"0.75"}
    assert {who for _, who in found} == set(cell.humans)
    alone = loads(json.dumps({**CASE, "tasks": tasks}))
    assert all(task.stress == 0.75 for task in alone.tasks.values() if task.stress)
    assert not alone.exposures


BROKEN = [
    ("fjs", "2 3\n1 1 1 4\n", "x:1: .*states 2 jobs, but 1 lines follow"),
    ("fjs", "1\n1 1 1 4\n", "x:1: .*the numbers of jobs and of machines"),
    ("fjs", "1 3\n2 1 1 4\n", "x:2: the line ends before operation 2"),
    ("fjs", "1 3\n1 2 1 4\n", "x:2: operation 1: 2 machines need 4 numbers, but 2 follow"),
    ("fjs", "1 3\n1 1 1 4 7\n", "x:2: .*1 operations, but 1 more numbers"),
    ("fjs", "1 3\n1 1 one 4\n", "x:2: a machine of operation 1 is 'one'"),
    ("fjs", "1 3\n1 1 7 4\n", "x:2: there is no machine 7: line 1 states 3"),
    ("fjs", "1 3\n1 2 1 4 1 5\n", "x:2: operation 1: machine 1 is stated twice"),
    ("fjs", "1 3\n1 1 1 0\n", "x:2: task '1.1': time of 'machine_1' is 0"),
    ("fjs", "1 3\n1 0\n", "x:2: operation 1: no machine can do it"),
    ("fjs-dag", "2 1\n0 1\n", "x:1: .*operations, arcs and machines comes first"),
    ("fjs-dag", "2 1 1\n0 1\n1 0 4\n", "x:1: 1 arcs and 2 operations need 3 lines, but 2 follow"),
    ("fjs-dag", "2 1 1\n0 2\n1 0 4\n1 0 4\n", "x:2: there is no operation 2"),
    (
        "fjs-dag",
        "3 2 1\n0 1\n1 2 J1\n1 0 4\n1 0 4\n1 0 4\n",
        "x:3: an arc is two numbers, but this line has 3 words",
    ),
    ("fjs-dag", "2 2 1\n0 1\n1 0\n1 0 4\n1 0 4\n", "x:3: .*'0' and '1' wait for each other"),
    ("fjs-dag", "1 0 1\n1 0 4 4\n", "x:2: operation 0 states 1 machines, but 1 more"),
    (
        "alb",
        "<number of tasks>\n2\n<task times>\n1 5\n<end>",
        "x:2: 2 tasks are stated here, but 1 times .* task 2 is missing",
    ),
    ("alb", "<number of tasks>\n1\n<end>", "x:3: the section <task times> is missing"),
    (
        "alb",
        "<number of tasks>\n1\n<task times>\n1 five\n<end>",
        "x:4: the time of task 1 is 'five'",
    ),
    ("alb", "<number of tasks>\n1\n<task times>\n2 5\n<end>", "x:4: task 2 does not exist"),
    (
        "alb",
        "<number of tasks>\n1\n<task times>\n1 5\n<precedence relations>\n1;2\n<end>",
        "x:6: '1;2' is no precedence",
    ),
    (
        "alb",
        "<number of tasks>\n1\n<task times>\n1 5\n<precedence relations>\n1,2\n<end>",
        "x:6: there is no task 2",
    ),
    (
        "alb",
        "<number of tasks>\n1\n<cycle time>\n0\n<task times>\n1 5\n<precedence relations>\n<end>",
        "x:4: the cycle time is 0",
    ),
    ("alb", "3\n4\n5\n1,2\n", "x:4: 3 tasks are stated .* this line is '1,2'"),
    ("alwabp", "2\n4 5\n6\n", "x:3: task 2 has 1 times, but the first task has 2"),
    ("alwabp", "3\n4 5\n6 7\n", "x:1: 3 tasks are stated here, but 2 lines"),
    ("alwabp", "1\n4 five\n", "x:2: the time of worker 2 for task 1 is 'five'"),
    ("alwabp", "1\n4 5\n1 2\n", "x:3: there is no task 2"),
    ("alwabp", "1\nInf Inf\n", "x:2: task '1': nobody can do it"),
    ("job-shop-lib", '{"duration_matrix": [["x"]],\n "machines_matrix": [[0]]}', "x:1:23: "),
    (
        "job-shop-lib",
        '{"duration_matrix": [[1, 2]],\n "machines_matrix": [[0]]}',
        r"x:2:2: machines_matrix has rows of \[1\] entries, but duration_matrix of \[2\]",
    ),
    ("case", '{"agents": []}', "x:1:2: agents: .*at least 1"),
    (
        "case",
        '{"agents": [{"id": "H", "type": "human"}],\n "tasks": [{"id": "1", "modes": []}]}',
        "x:2:24: tasks.0.modes: ",
    ),
    (
        "case",
        (
            '{"agents": [{"id": "H", "type": "human"}],\n'
            ' "tasks": [{"id": "1",\n'
            ' "modes": [{"agents": ["X"], "time": 3}]}]}'
        ),
        "x:2:12: .*names 'X'",
    ),
    (
        "case",
        (
            '{"agents": [{"id": "H", "type": "cyborg"}],\n'
            ' "tasks": [{"id": "1",\n'
            ' "modes": [{"agents": ["H"], "time": 3}]}]}'
        ),
        "x:1:13: .*kind is 'cyborg'",
    ),
]


@pytest.mark.parametrize(
    ("name", "text", "sentence"), BROKEN, ids=[f"{name}: {text[:30]!r}" for name, text, _ in BROKEN]
)
def test_a_broken_file_is_refused_once_at_its_line(name, text, sentence):
    with pytest.raises(CellError, match=sentence) as caught:
        loads(text, name, source="x")
    assert caught.value.exit_code == 3


# Dialects: what is nearly of a form is met in its words, and what a cell has no place for is named


@pytest.mark.parametrize(
    ("heading", "meant"),
    [
        ("<precedence relation>", "precedence relations"),
        ("<Precedence_Relations>", "precedence relations"),
        ("<predecence relations>", "precedence relations"),
        ("<precedences>", "precedence relations"),
        ("<precedence relations", None),
        ("< precedence  relations >", None),
    ],
)
def test_a_misspelt_heading_is_refused_before_what_stands_under_it_is_lost(heading, meant):
    text = ALB.replace("<precedence relations>", heading)
    if meant is None:
        assert loads(text) == loads(ALB)
        return
    with pytest.raises(
        CellError, match=f"line.alb:15: <.*> is no section that is known. Did you mean <{meant}>"
    ):
        loads(text, source="line.alb")


@pytest.mark.parametrize(
    ("heading", "meant"),
    [
        ("<number of task>", "number of tasks"),
        ("<task time>", "task times"),
        ("<cycletime>", "cycle time"),
        ("<cycle tme>", "cycle time"),
    ],
)
def test_other_misspelt_headings_are_refused_too(heading, meant):
    with pytest.raises(CellError, match=f"is no section that is known. Did you mean <{meant}>"):
        loads(ALB.replace(f"<{meant}>", heading), "alb")


def test_precedence_that_is_missing_is_no_precedence_that_is_empty():
    without = ALB.replace("<precedence relations>\n1,3\n2,3\n", "")
    with pytest.raises(CellError, match="the section <precedence relations> is missing"):
        loads(without)
    empty = loads(ALB.replace("1,3\n2,3\n", ""))
    assert all(task.after == () for task in empty.tasks.values())


@pytest.mark.parametrize(
    ("section", "said"),
    [
        (
            "<setup times forward>\n1,2:3\n",
            "the section <setup times forward> is not read: a cell has no setup times",
        ),
        (
            "<setup times: backward>\n1,2:3\n",
            "the section <setup times: backward> is not read: a cell has no setup times",
        ),
        ("<average force>\n0.1\n0.3\n0.2\n", "the section <average force> is not read"),
        ("<incompatible tasks>\n1,2\n", "the section <incompatible tasks> is not read"),
        ("<number of stations>\n4\n", "the section <number of stations> is not read"),
    ],
)
def test_a_section_that_a_cell_has_no_place_for_is_named_with_its_line(section, said):
    with pytest.warns(NotReadWarning, match=f"line.alb:19: {said}") as told:
        cell = loads(ALB.replace("<end>", f"{section}\n<end>"), source="line.alb")
    assert len(told) == 1
    assert cell == loads(ALB, source="line.alb")


@pytest.mark.parametrize(
    "section",
    ["<order strength>\n0,3\n", "<optimal SALBP-1 value>\n4\n", "<Order  Strength>\n0.3\n"],
)
def test_sections_that_say_nothing_of_the_work_make_no_noise(section):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(loads(ALB.replace("<end>", f"{section}\n<end>")).tasks) == 3


@pytest.mark.parametrize(
    ("text", "mark"), [(ALB.replace("<end>\n", ""), "<end>"), (IN2.partition("-1,-1")[0], "-1,-1")]
)
def test_a_line_file_without_its_end_may_be_cut_off(text, mark):
    with pytest.warns(NotReadWarning, match=f"the end mark {mark} is missing"):
        loads(text)


def test_arcs_may_name_the_job_that_they_belong_to():
    cell = loads("4\t2\t2\n0\t1\tJ1\n2\t3\tJ2\n2\t0\t5\t1\t7\n1\t0\t4\n2\t0\t6\t1\t3\n1\t1\t8\n")
    assert {
        name: (dict(task.time), task.after, task.part) for name, task in cell.tasks.items()
    } == {
        "0": ({"machine_0": 5, "machine_1": 7}, (), "J1"),
        "1": ({"machine_0": 4}, ("0",), "J1"),
        "2": ({"machine_0": 6, "machine_1": 3}, (), "J2"),
        "3": ({"machine_1": 8}, ("2",), "J2"),
    }
    joined = loads("3 2 1\n0 2 A\n1 2 B\n1 0 4\n1 0 4\n1 0 4\n")
    assert [task.part for task in joined.tasks.values()] == ["A", "B", None]


def test_a_classic_job_shop_visits_machines_in_the_order_of_its_line():
    cell = loads(JSP, source="ft02.txt")
    assert cell.robots == ("machine_0", "machine_1", "machine_2")
    assert {name: (dict(task.time), task.after) for name, task in cell.tasks.items()} == {
        "1.1": ({"machine_0": 3}, ()),
        "1.2": ({"machine_1": 2}, ("1.1",)),
        "1.3": ({"machine_2": 2}, ("1.2",)),
        "2.1": ({"machine_2": 4}, ()),
        "2.2": ({"machine_0": 1}, ("2.1",)),
        "2.3": ({"machine_1": 5}, ("2.2",)),
    }
    assert loads("1 2\n2 5 1 3\n").robots == ("machine_1", "machine_2")


AMBIGUOUS = ["2 2\n1 1 0 3\n1 1 0 4\n", "1 2\n1 1 2 9\n", "3 2\n1 1 0 2\n1 1 0 7\n1 1 0 5\n"]


@pytest.mark.parametrize("text", AMBIGUOUS)
def test_what_reads_as_two_kinds_of_job_shop_is_not_guessed(text):
    with pytest.raises(
        CellError,
        match=r"two.txt:1: .* every line can be read both ways. .* --format jsp or --format fjs",
    ) as refused:
        loads(text, source="two.txt")
    assert refused.value.exit_code == 3
    jobs = int(text[0])
    assert len(loads(text, "jsp").tasks) == 2 * jobs
    assert len(loads(text, "fjs").tasks) == len(loads(text, source="two.fjs").tasks) == jobs


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        (
            "a.fjs",
            "2 2 1\n1 1 1 -3\n1 2 1 3 2 4\n",
            r"a.fjs:2: .* is -3, but a time is more than 0",
        ),
        (
            "a.txt",
            "2 2 1\n1 1 1 -3\n1 2 1 3 2 4\n",
            r"a.txt:2: .* is -3, but a time is more than 0",
        ),
        (
            "a.txt",
            "2 3\n2 2 1 4 3 5x 1 2 7\n1 1 3 6\n",
            r"a.txt:2: the time of operation 1 on machine 3 is '5x'",
        ),
        (
            "a.txt",
            "2 3\n0 3 1 2 2 2\n2 4 0 l 1 5\n",
            r"a.txt:3: the time of operation 2 is 'l', but a number is needed",
        ),
        (
            "a.txt",
            "2 3\n0 3 1 2,5 2 2\n2 4 0 1 1 5\n",
            r"a.txt:2: the time of operation 2 is '2,5'.* Write it with a point: 2.5",
        ),
        (
            "a.IN2",
            "3\n10,5\n12\n5\n1,2\n2,3\n-1,-1\n",
            r"a.IN2:2: .* this line is '10,5'. If it is a time, write it with a point: 10.5",
        ),
        ("a.txt", "3\n10,5\n12\n5\n1,2\n2,3\n-1,-1\n", r"a.txt:2: .* this line is '10,5'"),
        (
            "a.txt",
            "3\n4 Inf\n6 2,5\nInf 5\n1 3\n-1 -1\n",
            r"a.txt:3: the time of worker 2 for task 2 is '2,5'",
        ),
        ("a.txt", "3 2 2\n0 -2\n1 2\n2 0 4 1 5\n1 1 7\n1 0 3\n", r"a.txt:2: an arc's end is '-2'"),
        ("a.alb", "number of tasks\n3\n", r"a.alb:1: the number of tasks is 'number'"),
    ],
)
def test_one_wrong_word_is_told_with_its_line_and_not_taken_for_yaml(name, text, said):
    with pytest.raises(CellError, match=said):
        loads(text, source=name)


FULL_LINE = "<number of tasks>\n9999\n<cycle time>\n10\n<task times>\n" + "".join(
    f"{n} 1\n" for n in range(1, 10_000)
)
TOO_MUCH = [
    ("fjs", "1 1000000000\n1 1 1 4\n"),
    ("jsp", "1 99999\n1 4\n"),
    ("fjs-dag", "1 0 123456789\n1 0 4\n"),
    ("fjs", "1 123456789012345678901234567890\n1 1 1 4\n"),
    ("alb", f"{FULL_LINE}<precedence relations>\n<end>"),
    ("alwabp", "3\n" + f"{'4 ' * 2000}\n" * 3 + "-1 -1\n"),
]


@pytest.mark.parametrize(("form", "text"), TOO_MUCH, ids=[form for form, _ in TOO_MUCH])
def test_a_number_of_machines_that_no_cell_has_is_refused_before_it_is_built(form, text):
    with pytest.raises(CellError, match=r"more than Tandem reads|too large"):
        loads(text, form)


@pytest.mark.parametrize("form", ["convert", "check"])
def test_every_command_that_loads_a_file_says_what_it_does_not_read(form, tmp_path, capsys):
    path = tmp_path / "ergonomic.alb"
    path.write_text(ALB.replace("<end>", "<average force>\n0.1\n0.3\n0.2\n\n<end>"))
    assert run([form, str(path)]) == 0
    said = capsys.readouterr()
    assert said.err.count("the section <average force> is not read") == 1
    assert "average force" not in said.out


def test_remarks_and_the_end_marks_of_old_systems_do_no_harm(tmp_path):
    path = tmp_path / "old.IN2"
    path.write_bytes(IN2.encode() + b"M\x94rz\r\n\x1a")
    assert len(load(path).tasks) == 3
    assert len(loads("# remark\n" + FJS).tasks) == 3


# The public sets

SETS = {
    "alwabp": "alwabp",
    "hrc_battery_cells": "case",
    "hrc_case_studies": "case",
    "salbp_scholl": "alb",
    "salbp_otto_n20": "alb",
    "salbp_otto_n50": "alb",
    "salbp_otto_n100": "alb",
    "fjsp_dag_birgin": "fjs-dag",
    "fjsp_dag_mini": "fjs-dag",
    "fjsp_barnes": "fjs",
    "fjsp_behnke": "fjs",
    "fjsp_brandimarte": "fjs",
    "fjsp_dauzere": "fjs",
    "fjsp_fattahi": "fjs",
    "fjsp_hurink_edata": "fjs",
    "fjsp_hurink_rdata": "fjs",
    "fjsp_hurink_vdata": "fjs",
    "fjsp_kacem": "fjs",
    "fjsp_sd1_10x5": "fjs",
    "fjsp_sd1_15x10": "fjs",
    "fjsp_sd1_20x5": "fjs",
    "fjsp_sd2_10x5": "fjs",
    "fjsp_sd2_15x10": "fjs",
    "fjsp_sd2_20x5": "fjs",
    "hrc_battery_sampled": "battery",
    "hrcalbp_sikora_n20": "hrcalbp",
    "hrcalbp_sikora_n50": "hrcalbp",
    "hrcalbp_sikora_n100": "hrcalbp",
    "mrcpsp_mmlib50": "psplib",
    "mrcpsp_psplib_j10": "psplib",
    "mrcpsp_psplib_j20": "psplib",
    "mrcpsp_psplib_j30": "psplib",
    "rcpsp_psplib_j30": "psplib",
    "rcpsp_psplib_j60": "psplib",
    "rcpsp_psplib_j120": "psplib",
}
NOT_CELLS = {
    "mrcpsp_mmlib50": 45, "mrcpsp_psplib_j10": 99, "mrcpsp_psplib_j20": 49, "mrcpsp_psplib_j30": 43,
}  # fmt: skip


@pytest.mark.parametrize("name", SETS)
@pytest.mark.filterwarnings("ignore:.*stations are not read:tandem.errors.NotReadWarning")
@pytest.mark.filterwarnings("error::tandem.errors.NotReadWarning")
def test_every_file_of_a_public_set_is_detected_and_read(name):
    """All that a cell can hold; what a project uses up for good is refused, with that reason."""
    count = refused = 0
    for path in files_of(folder(name)):
        text = path.read_bytes().decode("latin-1")
        assert detected(text, str(path)) == SETS[name], path.name
        count += 1
        try:
            assert load(path).tasks, path.name
        except CellError as error:
            refused += all("is used up" in fault.message for fault in error.faults)
    with open(folder() / "README.md", encoding="utf-8") as file:
        stated = {
            row.split("|")[1].strip(): int(row.split("|")[2])
            for row in file
            if row.startswith("| ") and row.split("|")[2].strip().isdigit()
        }
    assert set(stated) == set(SETS)
    assert (count, refused) == (stated[name], NOT_CELLS.get(name, 0))


def test_the_tables_of_the_strain_index_hold_the_published_fronts():
    """Each stress on the published front is the value of some set of tasks."""
    with open(folder("hrc_case_studies") / "pareto.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        cell = load(folder("hrc_case_studies") / f"{row['instance']}.json")
        assert float(row["strain_index"]) in (cell.stress_of_set or {}).values()


def test_published_facts_about_some_instances():
    cell = load(folder("fjsp_brandimarte") / "mk01.txt")
    assert (
        len(cell.robots),
        len({name.split(".")[0] for name in cell.tasks}),
        len(cell.tasks),
    ) == (6, 10, 55)
    assert len(load(folder("salbp_scholl") / "BOWMAN8.IN2").tasks) == 8
    battery = load(folder("hrc_battery_cells") / "battery_H2R1.json")
    assert (len(battery.humans), len(battery.robots), len(battery.tasks)) == (2, 1, 33)
    assert sum(bool(task.together) for task in battery.tasks.values()) == 3


def test_all_formats_but_our_own_are_covered_here():
    elsewhere = {"battery", "hrcalbp", "psplib", "rcp", "taillard"}  # test_projects.py
    assert set(SMALL) | elsewhere | {"yaml", "json"} == set(FORMATS)
