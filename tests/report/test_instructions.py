"""What stands on an instruction sheet: every condition of a step, and all that can begin then; the
same in the page, in the workbook and in Markdown. `test_sheets_hold.py` works by it.
"""

from __future__ import annotations

import io
import re
from decimal import Decimal
from functools import cache

import openpyxl
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from openpyxl.cell.rich_text import CellRichText, TextBlock
from tests.draw.cells import front_of, gearbox_front, rows, thesis_front
from tests.fuzz.sheets import all_sheets
from tests.report.paper import number, sheets_of
from tests.schedule.cells import glued, glued_schedule
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.cell.parts import Task
from tandem.errors import InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan.methods import plan
from tandem.plan.result import Front
from tandem.report.html import html
from tandem.report.markdown import markdown
from tandem.report.xlsx import xlsx
from tandem.schedule.measures import exact, made_ready
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


def joined(names: tuple[str, ...]) -> str:
    return " + ".join(names)


@settings(max_examples=60, **OPTIONS)
@given(cells(max_tasks=7), st.sampled_from(("en", "de")))
def test_every_step_names_all_that_it_waits_for(cell: Cell, language: str) -> None:
    schedule = knee(cell)
    if schedule is None:
        return
    sheets, who = all_sheets(cell, schedule, language), {a.task: a.operators for a in schedule}
    assert set(sheets) == set(cell.operators)
    for one, sheet in sheets.items():
        assert [row.task for row in sheet.rows if row.task] == [a.task for a in schedule.of(one)]
        off = [tuple(map(exact, span)) for span in cell.operators[one].breaks]
        assert sheet.breaks == (off if sheet.rows else [])
        for row in sheet.rows:
            assert row.conditions
            assert len(row.bold) == ("start" not in row.conditions)
            if not row.task:
                continue
            task = cell.tasks[row.task]
            ends, begins = _told_apart(task, who)
            plain = [name for name in task.predecessors if name not in {end[1] for end in ends}]
            others = {(joined(who[name]), name) for name in plain if one not in who[name]}
            partners = [name for name in who[row.task] if name != one]
            assert others <= row.waits_for()
            assert row.own_before() == {name for name in plain if one in who[name]}
            assert (row.lags("end"), row.lags("start")) == (ends, begins)
            assert row.told("partner") == {(name,) for name in partners}
            assert {number(said) for (said,) in row.told("release")} == (
                {exact(task.release)} if task.release else set()
            )
            said = " ".join(row.cells.get("means", []))
            tool = cell.tools_for(row.task, who[row.task]).get(one)
            assert all(name in said for name in (tool, task.zone, task.place, *partners) if name)


Lags = set[tuple[str, str, Decimal, Decimal | None]]


def _told_apart(task: Task, who: dict[str, tuple[str, ...]]) -> tuple[Lags, Lags]:
    """The waits after ends that say more than that a task must have ended, and those after
    starts.
    """
    found: dict[str, Lags] = {"end-start": set(), "start-start": set()}
    for wait in task.wait:
        if wait.at_least or wait.at_most is not None or wait.between == "start-start":
            most = None if wait.at_most is None else exact(wait.at_most)
            lag = (joined(who[wait.after]), wait.after, exact(wait.at_least), most)
            found[wait.between].add(lag)
    return found["end-start"], found["start-start"]


@settings(max_examples=60, **OPTIONS)
@given(cells(max_tasks=7), st.sampled_from(("en", "de")))
def test_what_can_begin_then_is_all_that_waits_for_it(cell: Cell, language: str) -> None:
    """Both columns say the same, seen from both ends."""
    schedule = knee(cell)
    if schedule is None:
        return
    who = {a.task: a.operators for a in schedule}
    rows = [row for sheet in all_sheets(cell, schedule, language).values() for row in sheet.rows]
    waits: dict[str, set[str]] = {name: set() for name in who}
    for row in rows:
        named = {task for _, task in row.waits_for()} | row.own_before()
        named |= {lag[1] for kind in ("end", "start") for lag in row.lags(kind)}
        for task in named | {task for *_, those in row.rooms() for _, task in those}:
            waits[task].add(row.task)
    for row in rows:
        if row.task:
            told = {task for _, task, _ in row.others} | set(row.own)
            assert told == waits[row.task]
            assert told >= {name for name in who if row.task in cell.tasks[name].begun_first}
            assert all(said == joined(who[task]) for said, task, _ in row.others)


@settings(max_examples=40, **OPTIONS)
@given(cells(max_tasks=7), st.sampled_from(("en", "de")))
def test_every_break_between_two_steps_and_every_changeover_is_said(
    cell: Cell, language: str
) -> None:
    schedule = knee(cell)
    if schedule is None:
        return
    for one, sheet in all_sheets(cell, schedule, language).items():
        own, operator = schedule.of(one), cell.operators[one]
        wanted = [("", exact(operator.setup))] if own and operator.setup else []
        for ready in made_ready(cell, one, own):
            walk = (f"{ready.origin} -> {ready.place}", exact(ready.walk))
            wanted += [pair for pair in (walk, (ready.tool, exact(ready.change))) if pair[1]]
        assert [row.change for row in sheet.rows if row.change] == wanted
        said = [tuple(map(number, span)) for row in sheet.rows for span in row.told("break")]
        begun = [tuple(number(row.cells[key][0]) for key in ("start", "end")) for row in sheet.rows]
        ends = [0, *(end for _, end in begun)]
        assert sorted(said) == [
            (exact(off), exact(back))
            for free, (start, _) in zip(ends, begun, strict=False)
            for off, back in operator.breaks
            if free <= exact(off) and exact(back) <= start
        ]


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


@pytest.mark.parametrize(
    ("language", "said"),
    [
        (
            "en",
            (
                "not before 35 s, so that press can follow in time",
                "anna with press (40 s to 60 s later)",
                "40 s after cobot ended glue, at the latest 60 s",
                "cobot with cool (4 s to 9 s later, counted from the beginning of this step)",
                "4 s after anna began press, at the latest 9 s",
            ),
        ),
        (
            "de",
            (
                "nicht vor 35 s, damit press rechtzeitig folgen kann",
                "anna mit press (40 s bis 60 s später)",
                "40 s nach dem Ende von glue (cobot), spätestens 60 s",
                "cobot mit cool (4 s bis 9 s später, vom Beginn dieses Schritts an)",
                "4 s nach dem Beginn von press (anna), spätestens 9 s",
            ),
        ),
    ],
)
def test_what_must_wait_is_told_to_who_waits_and_to_who_comes_before(
    language: str, said: tuple[str, ...]
) -> None:
    sheets = all_sheets(glued(), glued_schedule(), language)
    (glue, cool), (_, press) = sheets["cobot"].rows, sheets["anna"].rows
    found = (
        *(glue.cells["begin"][0], glue.cells["then"][0]),
        *(press.cells["begin"][1], press.cells["then"][0]),
        cool.cells["begin"][-1],
    )
    assert found == said


def test_the_drill_waits_for_the_clamp_although_only_the_tool_comes_last() -> None:
    cell = shop().replace(
        tasks={
            name: task
            for name, task in shop().tasks.items()
            if name in ("clamp part", "fetch tool", "drill")
        }
    )
    late = rows(("clamp part", "a", 0, 2), ("fetch tool", "b", 4, 5), ("drill", "c", 5, 8))
    (drill,) = all_sheets(cell, late, "en")["Cobot"].rows
    assert drill.waits_for() == {("Anna", "clamp part"), ("Bert", "fetch tool")}
    assert drill.bold == [("done", "Bert done with fetch tool")]


def test_a_sheet_says_all_that_there_is_to_a_step_in_english() -> None:
    sheets = sheets_of(html(shop_front()), "en")
    (drill,) = sheets["Cobot"].rows
    assert drill.cells["begin"] == [
        "Anna done with clamp part (out of zone jig)",
        "Bert done with fetch tool",
    ]
    assert drill.bold == [("freed", "Anna done with clamp part (out of zone jig)")]
    assert drill.cells["means"] == ["tool driver (only one)", "zone jig (one at a time)"]
    assert drill.cells["then"] == ["Anna with screw (tool driver)", "Anna + Bert with turn over"]
    clamp, deburr, change, screw, turn = sheets["Anna"].rows
    assert clamp.cells["begin"] == ["at once"]
    assert clamp.cells["then"] == ["own tasks: deburr", "Cobot with drill (zone jig)"]
    assert deburr.cells["begin"] == ["own tasks done: clamp part"]
    assert change.cells["what"] == ["change over to driver: 1.5 s"]
    assert change.cells["begin"] == ["previous step done", "own break over (6 to 9.5 s)"]
    assert change.bold == [("break", "own break over (6 to 9.5 s)")]
    assert screw.cells["begin"] == [
        "previous step done",
        "7.5 s passed since the start",
        "Cobot done with drill (tool driver free)",
    ]
    assert screw.bold == [("previous", "previous step done")]
    assert screw.cells["deadline"] == ["20"]
    assert turn.cells["means"] == ["together with Bert"]
    assert turn.cells["begin"] == ["previous step done", "Cobot done with drill", "Bert ready too"]


def test_a_sheet_says_all_that_there_is_to_a_step_in_german() -> None:
    change, screw = sheets_of(html(shop_front(), language="de"), "de")["Anna"].rows[2:4]
    assert change.cells["what"] == ["wechseln auf driver: 1,5 s"]
    assert change.cells["begin"] == ["voriger Schritt fertig", "eigene Pause vorbei (6 bis 9,5 s)"]
    assert screw.cells["means"] == ["Werkzeug driver (nur eines da)"]
    assert screw.cells["begin"] == [
        "voriger Schritt fertig",
        "7,5 s seit Beginn vergangen",
        "Cobot fertig mit drill (Werkzeug driver frei)",
    ]
    assert screw.cells["deadline"] == ["20"]


def test_the_last_task_of_the_thesis_names_all_six_before_it() -> None:
    for result in thesis_front():
        (seventh,) = [
            row
            for sheet in all_sheets(result.cell, result.schedule, "en").values()
            for row in sheet.rows
            if row.task == "7"
        ]
        who = {a.task: a.operators[0] for a in result.schedule}
        theirs = {(who[name], name) for name in "123456" if who[name] != who["7"]}
        assert seventh.waits_for() == theirs
        assert seventh.own_before() == set("123456") - {name for _, name in theirs}


def drivers(people: str) -> Cell:
    """Two drivers for so many people, each of whom has two screws to drive."""
    tasks = {f"{who}{n}": {"time": {who: 2}, "tool": "driver"} for who in people for n in (1, 2)}
    return cell_of(
        {
            "operators": {w: {"kind": "human"} for w in people},
            "tools": {"driver": {"capacity": 2}},
            "tasks": tasks,
        }
    )


def test_one_of_two_tools_stays_with_whoever_has_it() -> None:
    """Two drivers for two people who work side by side: nobody waits for the other's."""
    schedule = rows(("a1", "a", 0, 2), ("b1", "b", 1, 3), ("b2", "b", 5, 7), ("a2", "a", 6, 8))
    for sheet in all_sheets(drivers("ab"), schedule, "en").values():
        for row in sheet.rows:
            assert not row.rooms()
            assert not row.waits_for()


def test_the_third_of_two_drivers_waits_for_whoever_is_done_first() -> None:
    """It does not matter which of the others that is; for who has not come yet a driver is kept."""
    schedule = rows(
        ("a1", "a", 0, 2), ("b1", "b", 0, 2), ("c1", "c", 2, 4), ("a2", "a", 2, 4),
        ("b2", "b", 4, 6), ("c2", "c", 4, 6),
    )  # fmt: skip
    first, second = all_sheets(drivers("abc"), schedule, "en")["c"].rows
    assert first.rooms() == [("tool", "driver", 1, [("b", "b1"), ("a", "a2")])]
    assert first.cells["begin"] == [
        "one of 2 driver free: at most 1 not done of b with b1; a with a2"
    ]
    assert second.rooms() == [("tool", "driver", 1, [("a", "a2"), ("b", "b2")])]


@pytest.mark.parametrize("language", ["en", "de"])
def test_workbook_and_markdown_say_what_the_page_says(language: str) -> None:
    front = shop_front()
    book, text = (
        openpyxl.load_workbook(io.BytesIO(xlsx(front, language=language))),
        markdown(front, language=language),
    )
    heads = {"en": ("step", "begin when"), "de": ("Schritt", "anfangen, wenn")}[language]
    for who, sheet in sheets_of(html(front, language=language), language).items():
        printed = [row for row in book[who].iter_rows(min_row=3, values_only=True) if row[0]]
        head = [name for name in printed[0] if name]
        assert head[0] == heads[0]
        column = head.index(heads[1])
        steps = [row for row in printed[1:] if isinstance(row[0], int)]
        for row, step in zip(sheet.rows, steps, strict=True):
            begin, bold = row.cells["begin"], {sentence for _, sentence in row.bold}
            assert str(step[column]).split("\n") == begin
            shown = [f"**{said}**" if said in bold else said for said in begin]
            assert f"| {'<br>'.join(shown)} |" in text
            assert all(said in text for said in row.cells["then"])


def test_the_workbook_prints_the_last_condition_in_bold() -> None:
    book = openpyxl.load_workbook(io.BytesIO(xlsx(shop_front())), rich_text=True)
    said = [cell.value for row in book["Anna"].iter_rows() for cell in row]
    bold = [
        str(piece).strip()
        for text in said
        if isinstance(text, CellRichText)
        for piece in text
        if isinstance(piece, TextBlock) and piece.font.b
    ]
    assert bold == [
        sentence
        for row in sheets_of(html(shop_front()), "en")["Anna"].rows
        for _, sentence in row.bold
    ]


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_sheet_says_which_plan_it_belongs_to_wherever_it_stands(language: str) -> None:
    front, word = shop_front(), {"en": "plan", "de": "Plan"}[language]
    digest = f"{word} {front.knee.schedule.digest}"
    book = openpyxl.load_workbook(io.BytesIO(xlsx(front, language=language)))
    for who in ("Anna", "Bert", "Cobot"):
        said = [str(value) for row in book[who].iter_rows(values_only=True) for value in row]
        assert any(one.startswith(who) for one in said)
        assert any(digest in one for one in said)
        for text in (markdown(front, language=language), html(front, language=language)):
            assert re.search(rf"{who} · .* · {digest}", text)


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_long_sheet_tells_every_step_its_own_number(language: str) -> None:
    front = gearbox_front()
    for sheet in all_sheets(front.cell, front.knee.schedule, language).values():
        numbers = [int(row.cells["number"][0]) for row in sheet.rows]
        assert numbers == list(range(1, len(numbers) + 1))


def test_names_and_labels_of_tasks_stand_in_columns_of_their_own() -> None:
    front = gearbox_front()
    for sheet in all_sheets(front.cell, front.knee.schedule, "en").values():
        for row in sheet.rows:
            if row.task:
                assert row.cells["task"] == [row.task]
                assert row.cells["does"] == [front.cell.tasks[row.task].label]
