"""What stands on paper is enough: whoever knows nothing but the sheets cannot work against the
cell, however late the others are.
"""

from __future__ import annotations

import io
import random
from functools import cache
from itertools import pairwise

import openpyxl
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.draw.cells import front_of, gearbox_front, rows, thesis_front
from tests.report.paper import Row, sheets_of, work_by
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan.methods import plan
from tandem.plan.result import Front
from tandem.report.html import html
from tandem.report.markdown import markdown
from tandem.report.xlsx import xlsx
from tandem.schedule.measures import changeover_times
from tandem.schedule.model import Schedule

OPTIONS = {
    "deadline": None,
    "suppress_health_check": [
        HealthCheck.too_slow,
        HealthCheck.filter_too_much,
        HealthCheck.data_too_large,
    ],
}


@cache
def knee(cell: Cell) -> Schedule | None:
    try:
        return plan(cell, time_limit=60, workers=1).knee.schedule
    except InfeasibleError:
        return None


def on_paper(cell: Cell, schedule: Schedule, language: str) -> dict[str, list[Row]]:
    return sheets_of(html(front_of(cell, [schedule]), language=language), language)


def joined(names: tuple[str, ...]) -> str:
    return " + ".join(names)


@settings(max_examples=60, **OPTIONS)
@given(cells(max_tasks=7), st.sampled_from(("en", "de")))
def test_every_step_names_all_that_it_waits_for(cell: Cell, language: str) -> None:
    schedule = knee(cell)
    if schedule is None:
        return
    sheets, who = on_paper(cell, schedule, language), {a.task: a.operators for a in schedule}
    assert set(sheets) == set(cell.operators)
    for one, turns in sheets.items():
        assert [turn.task for turn in turns] == [a.task for a in schedule.of(one)]
        for turn in turns:
            task = cell.tasks[turn.task]
            others = {(name, joined(who[name])) for name in task.after if one not in who[name]}
            partners = [name for name in who[turn.task] if name != one]
            assert turn.told("done") == others
            assert turn.told("partner") == {(name,) for name in partners}
            assert (turn.cells.get("with", "–") or "–") == (", ".join(partners) or "–")
            assert turn.cells.get("tool", "–").split(" (")[0] == (task.tool or "–")
            assert turn.cells.get("zone", "–") == (task.zone or "–")
            assert turn.told("release") == (
                {(f"{task.release:g}".replace(".", "," if language == "de" else "."),)}
                if task.release
                else set()
            )
            assert turn.conditions


@settings(max_examples=60, **OPTIONS)
@given(cells(max_tasks=7), st.sampled_from(("en", "de")), st.integers(0, 2**32))
def test_work_by_the_sheets_alone_keeps_to_the_cell_however_late_others_are(
    cell: Cell, language: str, seed: int
) -> None:
    schedule = knee(cell)
    if schedule is None:
        return
    worked = {w.task: w for w in work_by(on_paper(cell, schedule, language), random.Random(seed))}
    assert set(worked) == set(cell.tasks)
    for name, task in cell.tasks.items():
        assert all(worked[first].end <= worked[name].start for first in task.after)
        assert worked[name].start >= task.release
    for who, operator in cell.operators.items():
        assert all(
            w.start >= (operator.setting_up or (0, 0))[1] for w in worked.values() if who in w.who
        )
    for kind, table in (("tool", cell.tools), ("zone", cell.zones)):
        for place in {getattr(task, kind) for task in cell.tasks.values()} - {None}:
            users = [w for w in worked.values() if getattr(cell.tasks[w.task], kind) == place]
            capacity = table[place].capacity if place in table else 1
            for now in users:
                assert sum(len(w.who) for w in users if w.start <= now.start < w.end) <= capacity


@settings(max_examples=40, **OPTIONS)
@given(cells(max_tasks=7), st.sampled_from(("en", "de")))
def test_every_break_between_two_turns_and_every_changeover_is_said(
    cell: Cell, language: str
) -> None:
    schedule = knee(cell)
    if schedule is None:
        return
    for one, turns in on_paper(cell, schedule, language).items():
        own = schedule.of(one)
        ends = [0.0, *(a.end for a in own)]
        for turn, a, free, seconds in zip(
            turns, own, ends, changeover_times(cell, one, [a.task for a in own]), strict=False
        ):
            between = [
                (off, back)
                for off, back in cell.operators[one].breaks
                if free <= off and back <= a.start
            ]
            said = {
                tuple(float(number.replace(",", ".")) for number in pair)
                for pair in turn.told("break")
            }
            assert said == set(between)
            assert ("(" in turn.cells.get("tool", "")) == (seconds > 0)
            assert (
                not seconds
                or f"{seconds:g}".replace(".", "," if language == "de" else ".")
                in turn.cells["tool"]
            )


def shop() -> Cell:
    """Everything once: Anna clamps and fetches before Cobot drills, with one driver and one jig
    between them.
    """
    return cell_of(
        {
            "operators": {
                "a": {"kind": "human", "label": "Anna", "breaks": [[6, 9.5]]},
                "c": {"kind": "robot", "label": "Cobot"},
                "b": {"kind": "human", "label": "Bert"},
            },
            "tools": {"driver": {"changeover": {"a": 1.5}}, "file": {}},
            "tasks": {
                "clamp part": {"time": {"a": 2}, "zone": "jig"},
                "fetch tool": {"time": {"b": 1}},
                "drill": {
                    "time": {"c": 3},
                    "after": ["clamp part", "fetch tool"],
                    "zone": "jig",
                    "tool": "driver",
                },
                "deburr": {"time": {"a": 1}, "after": ["clamp part"], "tool": "file"},
                "screw": {"time": {"a": 2}, "tool": "driver", "release": 7.5, "deadline": 20},
                "turn over": {
                    "together": [{"operators": ["a", "b"], "time": 4}],
                    "after": ["drill"],
                },
            },
        }
    )


def shop_front() -> Front:
    schedule = rows(
        ("clamp part", "a", 0, 2),
        ("fetch tool", "b", 0, 1),
        ("drill", "c", 2, 5),
        ("deburr", "a", 2, 3),
        ("screw", "a", 11, 13),
        ("turn over", "a+b", 13, 17),
    )
    return front_of(shop(), [schedule])


def test_the_drill_waits_for_the_clamp_although_only_the_tool_comes_last() -> None:
    cell = shop().replace(
        tasks={
            name: task
            for name, task in shop().tasks.items()
            if name in ("clamp part", "fetch tool", "drill")
        }
    )
    late = rows(("clamp part", "a", 0, 2), ("fetch tool", "b", 4, 5), ("drill", "c", 5, 8))
    (drill,) = on_paper(cell, late, "en")["Cobot"]
    assert drill.told("done") == {("clamp part", "Anna"), ("fetch tool", "Bert")}


def test_a_sheet_says_all_that_there_is_to_a_step_in_english() -> None:
    sheets = sheets_of(html(shop_front()), "en")
    (drill,) = sheets["Cobot"]
    assert drill.told("done") == {("clamp part", "Anna"), ("fetch tool", "Bert")}
    assert drill.told("zone") == {("jig", "Anna", "clamp part")}
    assert drill.tell == ["Anna + Bert, for turn over", "Anna, that tool driver is free for screw"]
    clamp, deburr, screw, turn = sheets["Anna"]
    assert clamp.told("start") == {()}
    assert clamp.tell == ["Cobot, for drill", "Cobot, that zone jig is free for drill"]
    assert deburr.told("previous") == {()}
    assert screw.conditions == {
        "tool": [{"name": "driver", "who": "Cobot", "task": "drill"}],
        "break": [{"off": "6", "back": "9.5"}],
        "release": [{"release": "7.5"}],
    }
    assert screw.cells["tool"] == "driver (take it up first: 1.5 s)"
    assert screw.cells["at the latest [s]"] == "20"
    assert turn.conditions == {
        "done": [{"task": "drill", "who": "Cobot"}],
        "partner": [{"who": "Bert"}],
    }


def test_a_sheet_says_all_that_there_is_to_a_step_in_german() -> None:
    screw = sheets_of(html(shop_front(), language="de"), "de")["Anna"][2]
    assert screw.conditions == {
        "tool": [{"name": "driver", "who": "Cobot", "task": "drill"}],
        "break": [{"off": "6", "back": "9,5"}],
        "release": [{"release": "7,5"}],
    }
    assert screw.cells["tool"] == "driver (vorher aufnehmen: 1,5 s)"
    assert screw.cells["spätestens [s]"] == "20"


def test_the_last_task_of_the_thesis_names_all_that_others_do_before_it() -> None:
    for result in thesis_front():
        (seventh,) = [
            turn
            for turns in on_paper(result.cell, result.schedule, "en").values()
            for turn in turns
            if turn.task == "7"
        ]
        doer = next(a.operators[0] for a in result.schedule if a.task == "7")
        others = {
            (a.task, a.operators[0])
            for a in result.schedule
            if a.task != "7" and a.operators[0] != doer
        }
        assert seventh.told("done") == others


def test_one_of_two_tools_stays_with_whoever_has_it() -> None:
    """Two drivers for two people who work side by side: nobody fetches the other's."""
    tasks = {f"{who}{n}": {"time": {who: 2}, "tool": "driver"} for who in "ab" for n in (1, 2)}
    cell = cell_of(
        {
            "operators": {w: {"kind": "human"} for w in "ab"},
            "tools": {"driver": {"capacity": 2}},
            "tasks": tasks,
        }
    )
    schedule = rows(("a1", "a", 0, 2), ("b1", "b", 1, 3), ("b2", "b", 5, 7), ("a2", "a", 6, 8))
    for turns in on_paper(cell, schedule, "en").values():
        assert not any(turn.told("tool") for turn in turns)


@pytest.mark.parametrize("language", ["en", "de"])
def test_workbook_and_markdown_say_what_the_page_says(language: str) -> None:
    front = shop_front()
    book, text = (
        openpyxl.load_workbook(io.BytesIO(xlsx(front, language=language))),
        markdown(front, language=language),
    )
    for who, turns in sheets_of(html(front, language=language), language).items():
        rows = [row for row in book[who].iter_rows(min_row=4, values_only=True) if row[0]]
        heads = [
            head for (head,) in book[who].iter_cols(min_row=3, max_row=3, values_only=True) if head
        ]
        for turn, row in zip(turns, rows, strict=True):
            wait = str(row[heads.index("begin when" if language == "en" else "anfangen")]).split(
                "\n"
            )
            assert " ".join(wait) == turn.cells["wait"]
            assert f"| {'; '.join(wait)} |" in text


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_long_sheet_tells_every_turn_its_own_number(language: str) -> None:
    front = gearbox_front()
    for turns in on_paper(front.cell, front.knee.schedule, language).values():
        numbers = [int(next(iter(turn.cells.values()))) for turn in turns]
        assert all(b == a + 1 for a, b in pairwise(numbers))
