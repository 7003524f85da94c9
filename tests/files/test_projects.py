"""Projects under shared capacities, lines with robots, sampled battery cells, Taillard's tables:
read as cells that have the same schedules, or refused with the reason at its line.
"""

from __future__ import annotations

import csv

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ortools.sat.python import cp_model
from tests.benchmark_data import folder

import tandem
from tandem.errors import CellError, NotReadWarning
from tandem.files.formats.table import detected
from tandem.files.load import load, loads

STARS = "*" * 72


def project(
    ways: list[list[tuple[int, list[int]]]],
    after: list[list[int]],
    renewable: list[int],
    consumed: list[int] | None = None,
) -> str:
    """A PSPLIB file: for each activity between source and sink its modes (duration, demands) and
    the activities directly before it, counted from 0.
    """
    consumed = consumed or []
    many, resources = len(ways), len(renewable) + len(consumed)
    follows = {one: [two for two in range(many) if one in after[two]] for one in range(many)}
    lines = [
        STARS,
        f"jobs (incl. supersource/sink ):  {many + 2}",
        "RESOURCES",
        f"  - renewable                 :  {len(renewable)}   R",
        f"  - nonrenewable              :  {len(consumed)}   N",
        "  - doubly constrained        :  0   D",
        STARS,
        "PRECEDENCE RELATIONS:",
        "jobnr.    #modes  #successors   successors",
    ]
    first = [number + 2 for number in range(many) if not after[number]]
    lines.append(" ".join(map(str, [1, 1, len(first), *first])))
    for number in range(many):
        then = [two + 2 for two in follows[number]] or [many + 2]
        lines.append(" ".join(map(str, [number + 2, len(ways[number]), len(then), *then])))
    none = " ".join("0" * resources)
    lines += [f"{many + 2} 1 0", STARS, "REQUESTS/DURATIONS:", "jobnr. mode duration  R 1", "-----"]
    lines.append(f"1 1 0 {none}")
    for number, modes in enumerate(ways, 2):
        for count, (duration, needs) in enumerate(modes, 1):
            head = f"{number} " if count == 1 else ""
            lines.append(f"{head}{count} {duration} {' '.join(map(str, needs))}")
    lines += [f"{many + 2} 1 0 {none}", STARS, "RESOURCEAVAILABILITIES:", "  R 1"]
    return "\n".join([*lines, " ".join(map(str, [*renewable, *consumed])), STARS, ""])


SMALL = project([[(3, [2])], [(2, [1])], [(4, [2])]], [[], [], [0]], [2])
RCP = "5 1\n2\n0 0 2 2 3\n3 2 1 4\n2 1 1 5\n4 2 1 5\n0 0 0\n"


def test_a_project_becomes_crews_that_hold_its_resource():
    assert detected(SMALL) == "psplib"
    cell = loads(SMALL)
    assert {name: task.after for name, task in cell.tasks.items()} == {
        "2": (),
        "3": (),
        "4": ("2",),
    }
    assert cell.tools["R1"].capacity == 2
    (mode,) = cell.modes("2")
    assert mode.time == 3
    assert dict(mode.tools) == {"crew_1_R1_1": "R1", "crew_1_R1_2": "R1"}
    assert cell.modes("4")[0].operators == mode.operators  # one crew: 4 comes after 2
    assert cell.modes("3")[0].operators == ("crew_2_R1_1",)
    assert [point.makespan for point in tandem.plan(cell, minimize="makespan")] == [9]


def test_pattersons_form_says_the_same():
    assert loads(RCP, "rcp") == loads(SMALL)
    assert loads(RCP, source="a.rcp").tasks == loads(SMALL).tasks


def least_makespan(
    ways: list[list[tuple[int, list[int]]]], after: list[list[int]], capacities: list[int]
) -> int:
    """The same project in CP-SAT's own words: a cumulative for each resource."""
    model = cp_model.CpModel()
    horizon = sum(max(duration for duration, _ in modes) for modes in ways)
    starts, ends, uses = [], [], [[] for _ in capacities]
    for modes in ways:
        start, end = (model.new_int_var(0, horizon, "") for _ in range(2))
        chosen = []
        for duration, needs in modes:
            taken = model.new_bool_var("")
            interval = model.new_optional_fixed_size_interval_var(start, duration, taken, "")
            model.add(end == start + duration).only_enforce_if(taken)
            for place, units in enumerate(needs):
                uses[place].append((interval, units))
            chosen.append(taken)
        model.add_exactly_one(chosen)
        starts.append(start)
        ends.append(end)
    for capacity, mine in zip(capacities, uses, strict=True):
        model.add_cumulative([one for one, _ in mine], [units for _, units in mine], capacity)
    for number, firsts in enumerate(after):
        for first in firsts:
            model.add(ends[first] <= starts[number])
    last = model.new_int_var(0, horizon, "")
    model.add_max_equality(last, ends)
    model.minimize(last)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    assert solver.solve(model) == cp_model.OPTIMAL
    return round(solver.objective_value)


@st.composite
def projects(draw):
    many, resources = draw(st.integers(1, 5)), draw(st.integers(1, 2))
    capacities = draw(st.lists(st.integers(1, 4), min_size=resources, max_size=resources))
    ways = [
        [
            (draw(st.integers(1, 5)), [draw(st.integers(0, most)) for most in capacities])
            for _ in range(draw(st.integers(1, 3)))
        ]
        for _ in range(many)
    ]
    after = [
        sorted(draw(st.sets(st.integers(0, number - 1), max_size=2))) if number else []
        for number in range(many)
    ]
    return ways, after, capacities


@given(projects())
@settings(max_examples=40, deadline=None)
def test_the_cell_has_the_least_makespan_of_the_project(drawn):
    ways, after, capacities = drawn
    cell = loads(project(ways, after, capacities))
    (point,) = tandem.plan(cell, minimize="makespan", workers=1)
    assert point.makespan == least_makespan(ways, after, capacities)


def test_what_is_used_up_is_refused_unless_there_is_enough_of_it():
    ways = [[(3, [1, 4]), (5, [1, 1])], [(2, [1, 3])]]
    scarce = project(ways, [[], []], [1], [6])
    line = next(n for n, text in enumerate(scarce.splitlines(), 1) if text == "1 6")
    with pytest.raises(
        CellError,
        match=rf"a.mm:{line}: resource N1 is used up: there are 6 units .* up to 7 \(activity 2 up"
        r" to 4\).* no stock",
    ) as refused:
        loads(scarce, source="a.mm")
    assert refused.value.exit_code == 3
    plenty = loads(project(ways, [[], []], [1], [7]))
    assert [mode.time for mode in plenty.modes("2")] == [3]  # same need: the quicker one


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("3 1 2 1\n", "3 1 two 1\n", "LINE: a number of activity 3 is 'two'"),
        ("3 1 2 1\n", "3 1 2\n", "LINE: a mode is the activity .* this line is '3 1 2'"),
        ("3 1 2 1\n", "3 1 2 9\n", "LINE: activity 3 needs 9 units of R1, but there are 2"),
        ("3 1 2 1\n", "3 1 0 1\n", "LINE: activity 3 takes 0 s"),
        ("2 1 1 4\n", "2 1 1 44\n", "LINE: there is no activity '44'"),
        ("2 1 1 4\n", "2 1 2 4\n", "LINE: activity 2 states 2 successors, but 1 follow"),
        ("4 1 1 5\n", "4 1 1 2\n", "'2' and '4' wait for each other"),
        ("PRECEDENCE RELATIONS:", "PRECEDENCES:", "the section PRECEDENCE RELATIONS: is missing"),
        ("sink ):  5", "sink ):  7", "7 jobs are stated, .* but 5 have a duration"),
        ("constrained        :  0", "constrained        :  1", "a.sm:6: 1 resources are doubly"),
    ],
)
def test_a_broken_project_is_refused_at_its_line(old, new, said):
    assert old in SMALL
    line = SMALL[: SMALL.index(old)].count("\n") + 1
    with pytest.raises(CellError, match=said.replace("LINE", rf"a\.sm:{line}")):
        loads(SMALL.replace(old, new), "psplib", source="a.sm")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("5 1\n2\n0 0 2 2", "a.rcp:3: the file ends before a successor of activity 1"),
        (RCP.replace("0 0 2 2 3", "0 0 2 2 9"), "a.rcp:3: there is no activity 9"),
        (RCP + "7\n", "a.rcp:8: 5 activities are stated, but more numbers follow"),
        (RCP.replace("3 2 1 4", "3 x 1 4"), "a.rcp:4: what activity 2 needs of R1 is 'x'"),
    ],
)
def test_a_broken_rcp_is_refused_at_its_line(text, said):
    with pytest.raises(CellError, match=said):
        loads(text, source="a.rcp")


# A few of the public sets, to the optimum that is known of them


@pytest.mark.parametrize(
    ("name", "instance"),
    [
        ("rcpsp_psplib_j30", "j3017_7.sm"),
        ("rcpsp_psplib_j30", "j3024_5.sm"),
        ("hrc_battery_sampled", "H1R1_12.txt"),
    ],
)
def test_the_optimum_is_the_published_one(name, instance):
    place = folder(name)
    with open(place / "best_known.csv", encoding="utf-8") as file:
        known = {row["instance"]: row for row in csv.DictReader(file)}[instance.split(".")[0]]
    assert known["lower_bound"] == known["upper_bound"]
    (point,) = tandem.plan(load(place / instance), minimize="makespan", workers=1)
    assert (point.makespan, point.status.value) == (float(known["upper_bound"]), "optimal")


# Lines on which people and robots do a task alone or together

LINE = """File name,Number of stations,Number of robots,Number of tasks,RD,RF
small,2,1,3,0.5,0.4
Task id,Human time,Robot time,Collaboration time,Predecessors,,
1,10,20,7,,,
2,4,-1,-1,1,,
3,6,-1,4,"1, 2",,
"""


def test_a_line_with_robots_becomes_one_cell_and_says_that_it_has_no_stations():
    assert detected(LINE) == "hrcalbp"
    with pytest.warns(NotReadWarning, match=r"line.csv:2: the 2 stations are not read"):
        cell = loads(LINE, source="line.csv")
    assert cell.humans == ("human_1", "human_2")
    assert cell.robots == ("robot_1",)
    assert dict(cell.tasks["1"].time) == {"human_1": 10, "human_2": 10, "robot_1": 20}
    assert [joint.time for joint in cell.tasks["1"].together] == [7, 7]
    assert cell.tasks["2"].together == ()
    assert cell.tasks["3"].after == ("1", "2")


def test_its_csv_is_no_spreadsheet(tmp_path):
    path = tmp_path / "instance.csv"
    path.write_text(LINE)
    with pytest.warns(NotReadWarning):
        assert len(load(path).tasks) == 3
    path.write_text("task;time\n1;4\n")
    with pytest.raises(CellError, match=r"this is a spreadsheet. Import it first"):
        load(path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("small,2,1,3", "small,2,1,4", "a:2: 4 tasks are stated here, but 3 follow"),
        ("2,4,-1", "2,four,-1", "a:5: the human time of task 2 is 'four'"),
        ("2,4,-1,-1,1", "2,4,-1,-1,9", "a:5: .*comes after '9', which is no task"),
        ("2,4,-1,-1,1", "1,4,-1,-1,1", "a:5: task '1' is stated twice"),
        ("2,4,-1,-1,1", "2,-1,-1,-1,1", "a:5: task '2': nobody can do it"),
        ("small,2,1,3", "small,two,1,3", "a:2: the number of stations is 'two'"),
        ("Number of robots", "Robots", "a:1: the column 'number of robots' of the line is missing"),
    ],
)
def test_a_broken_line_is_refused_at_its_line(old, new, said):
    assert old in LINE
    with pytest.raises(CellError, match=said):
        loads(LINE.replace(old, new), source="a")


def test_a_cell_without_stations_is_at_most_as_slow_as_the_line():
    place = folder("alwabp")
    with open(place / "best_known.csv", encoding="utf-8") as file:
        known = {row["instance"]: row for row in csv.DictReader(file)}["heskia/1"]
    (point,) = tandem.plan_cycle(load(place / "heskia" / "1"), minimize="cycle_time", workers=1)
    assert point.cycle_time <= float(known["upper_bound"])


# Sampled battery cells

PACK = "5 3 1\n3 1 1 17 2 1 18 2 53 2 1 26 2 57\n" + "1 1 1 5\n" * 3 + "1 1 3 106\n"


def test_the_name_of_a_battery_cell_says_who_its_columns_are():
    assert detected(PACK, "x/H1R1_0.txt") == "battery"
    cell = loads(PACK, source="x/H1R1_0.txt")
    assert (cell.humans, cell.robots) == (("H1",), ("R1",))
    assert cell.tasks["1.2"].after == cell.tasks["1.3"].after == ("1.1",)
    assert dict(cell.tasks["1.2"].time) == {"H1": 18, "R1": 53}
    assert cell.tasks["5.1"].after == ("1.1", "1.2", "1.3", "2.1", "3.1", "4.1")
    assert [joint.operators for joint in cell.tasks["5.1"].together] == [("H1", "R1")]
    with pytest.raises(CellError, match=r"x:1: .* is told by the file's name, such as H2R1_7.txt"):
        loads(PACK, "battery", source="x")
    with pytest.raises(CellError, match=r"H2R1_0.txt:1: 3 columns are stated, but 2 humans"):
        loads(PACK, source="H2R1_0.txt")


# Taillard's two tables, and the OR-Library's headings

TAILLARD = """Nb of jobs, Nb of Machines, Time seed, Machine seed, Upper bound, Lower bound
 2 3 840612802 398197754 1247 977
Times
 3 2 2
 4 1 5
Machines
 1 2 3
 3 1 2
"""
LIBRARY = """ instance tiny

 ++++++++++++++++++
 Two jobs for a test
 2 3
 0 3 1 2 2 2
 2 4 0 1 1 5
 ++++++++++++++++++
"""


def test_taillards_tables_and_the_librarys_headings_say_the_same():
    assert detected(TAILLARD) == "taillard"
    assert detected(LIBRARY) == "jsp"
    tables, lines = loads(TAILLARD), loads(LIBRARY)
    times = [[*task.time.values()] for task in lines.tasks.values()]
    assert [[*task.time.values()] for task in tables.tasks.values()] == times
    assert [list(task.time) for task in tables.tasks.values()] == [
        [f"machine_{int(name.split('_')[1]) + 1}" for name in task.time]
        for task in lines.tasks.values()
    ]


@pytest.mark.parametrize(
    ("text", "form", "said"),
    [
        (TAILLARD * 2, "taillard", "a:11: the file holds 2 job shops or more; a cell is one"),
        (TAILLARD.replace(" 4 1 5\n", ""), "taillard", "a:2: 2 jobs are stated, but a table has 1"),
        (TAILLARD.replace("4 1 5", "4 1"), "taillard", "a:5: 3 machines are stated, .* has 2 num"),
        (TAILLARD.replace("3 1 2", "7 1 2"), "taillard", "a:8: there is no machine 7"),
        (TAILLARD.replace("Times", "Time"), "taillard", "a:1: the tables `Times` and `Machines`"),
        (LIBRARY * 2, "jsp", "a:9: the file holds 2 job shops, from tiny to tiny"),
        (LIBRARY.replace("0 1 1 5", "0 1 1 x"), "jsp", "a:7: the time of operation 3 is 'x'"),
    ],
)
def test_a_broken_job_shop_is_refused_at_its_line(text, form, said):
    with pytest.raises(CellError, match=said):
        loads(text, form, source="a")
