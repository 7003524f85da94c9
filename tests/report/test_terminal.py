"""The front in the terminal: fits, needs no colour, and says every task."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import pytest
from rich.console import Console
from tests.draw.cells import (
    desk,
    front_of,
    gearbox_front,
    greedy,
    layered_front,
    thesis,
    thesis_front,
    thesis_schedules,
)

from tandem.plan.result import Front, Status
from tandem.report.terminal import FrontView, GanttText, headline, remarks

FRONTS = {
    "thesis": thesis_front,
    "gearbox": gearbox_front,
    "desk": lambda: front_of(desk(), [greedy(desk())]),
    "120 tasks": layered_front,
}


def printed(view: object, width: int = 80, *, encoding: str = "utf-8", **options: object) -> str:
    buffer = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    Console(file=buffer, width=width, highlight=False, **options).print(view)
    buffer.flush()
    return buffer.buffer.getvalue().decode(encoding)


@pytest.mark.parametrize("width", [40, 60, 80, 160])
@pytest.mark.parametrize("name", FRONTS)
def test_no_line_is_wider_than_the_terminal(name: str, width: int) -> None:
    text = printed(FrontView(FRONTS[name]()), width)
    assert max(map(len, text.splitlines())) <= width


def test_the_table_has_every_point_and_marks_the_knee() -> None:
    rows = [line.split() for line in printed(FrontView(thesis_front())).splitlines()]
    assert ["1", "23", "7", "proven", "1", "2", "4", "7", "3", "5", "6"] in rows
    assert ["2*", "24", "3", "proven", "1", "2", "4", "5", "7", "3", "6"] in rows
    assert ["3", "34", "2", "proven", "1", "2", "4", "5", "6", "7", "3"] in rows


def test_what_is_not_proven_has_bounds_and_a_gap() -> None:
    text = printed(FrontView(front_of(thesis(), thesis_schedules(), proven=False, slack=0.1)))
    assert "23 (>= 20.7)" in text
    assert "gap 10 %" in text
    assert "not complete" in text


def test_points_that_time_cut_short_and_schedules_that_may_change_are_named() -> None:
    front = thesis_front()
    chosen = [replace(result, canonical=True) for result in front]
    assert remarks(replace(front, results=tuple(chosen))) == []
    chosen[2] = replace(chosen[2], canonical=False)
    mixed = replace(front, results=tuple(chosen))
    assert remarks(mixed) == ["Another run may show another schedule of the same values: point 3."]
    chosen[:2] = [replace(result, status=Status.FEASIBLE, canonical=False) for result in chosen[:2]]
    cut = replace(mixed, results=tuple(chosen), complete=False, out_of_time=True)
    text = printed(FrontView(cut), 160)
    assert "not complete, time ran out" in text
    assert (
        "Not proven because time ran out: points 1, 2; with a longer --time-limit more is." in text
    )
    assert "another schedule of the same values: point 3." in text


def test_bars_stand_where_their_tasks_do() -> None:
    lines = printed(GanttText(thesis(), thesis_schedules()[0]), 77).splitlines()
    robot, human = (re.split(r"[│]", line)[1] for line in lines[:2])
    scale = len(robot) / 23
    for lane, found in (
        (robot, {"1": 0, "2": 9, "4": 16, "7": 21}),
        (human, {"3": 0, "5": 10, "6": 18}),
    ):
        assert {name: lane.index(f"▐{name}") for name in found} == {
            name: round(start * scale) for name, start in found.items()
        }
    assert set(robot[round(18 * scale) : round(21 * scale)]) == {" "}
    assert lines[-1] == "critical path: 1 → 2 → 4 → 6 → 7"


def test_human_and_robot_differ_without_colour() -> None:
    robot, human, *_ = printed(GanttText(thesis(), thesis_schedules()[0])).splitlines()
    assert ("░" in robot, "█" in robot, "░" in human, "█" in human) == (True, False, False, True)


@pytest.mark.parametrize("name", FRONTS)
def test_ascii_terminals_get_ascii(name: str) -> None:
    text = printed(FrontView(FRONTS[name]()), encoding="ascii")
    assert text.isascii()
    assert "human" in text


def test_colours_are_for_terminals_that_want_them(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("NO_COLOR", "FORCE_COLOR", "TERM", "COLORTERM"):
        monkeypatch.delenv(name, raising=False)
    colour = re.compile(r"\x1b\[[0-9;]*3[0-9]m")
    assert colour.search(
        printed(FrontView(thesis_front()), force_terminal=True, color_system="standard")
    )
    assert not colour.search(printed(FrontView(thesis_front())))
    monkeypatch.setenv("NO_COLOR", "1")
    assert not colour.search(printed(FrontView(thesis_front()), force_terminal=True))
    monkeypatch.delenv("NO_COLOR")
    monkeypatch.setenv("TERM", "dumb")
    assert not colour.search(printed(FrontView(thesis_front()), force_terminal=True))


def test_a_large_schedule_is_folded_and_keeps_most_names() -> None:
    schedule = greedy(desk())
    text = printed(GanttText(desk(), schedule))
    chart = text.partition("critical path")[0]
    assert chart.count("robot │") > 2
    assert sum(bool(re.search(rf"▐{a.task}\b", chart)) for a in schedule) > 0.85 * len(schedule)


def test_markup_in_names_is_shown_and_not_obeyed() -> None:
    cell = thesis().replace(
        name="[bold red]x[/]",
        operators={"robot": {"kind": "robot", "label": "[red]R[/red]"}, "human": {"kind": "human"}},
    )
    text = printed(FrontView(front_of(cell, thesis_schedules())), 120)
    assert "[bold red]x[/]" in text
    assert text.count("[red]R[/red]") >= 2


def test_the_headline_says_what_was_found_and_how_far_proven() -> None:
    assert headline(thesis_front()) == (
        "Exemplary assembly (Kinat 2023, chapter 6) (7 tasks, 1 human, 1 robot): "
        "3 points on the front, complete and proven, 0.05 s, cp-sat 9.14.6206."
    )
    nothing = Front(thesis(), (), False, "exact", "cp-sat", 0, 1.0, interrupted=True)
    assert "0 points on the front, interrupted, not complete" in printed(FrontView(nothing), 160)
