"""A Gantt chart shows every task where and when it happens, and its labels stay in their bars."""

from __future__ import annotations

import re

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patches import Rectangle
from tests.draw.cells import (
    desk,
    front_of,
    gearbox,
    greedy,
    layered,
    rows,
    thesis,
    thesis_schedules,
)
from tests.schedule.cells import glued, glued_schedule, thesis_schedule

from tandem.cell.model import Cell
from tandem.draw.figure import blank, figure_for
from tandem.draw.fitted import FittedText
from tandem.draw.gantt import plot_gantt
from tandem.report.html import html
from tandem.schedule.critical import critical_path
from tandem.schedule.model import Schedule

CASES = {
    "thesis": (thesis(), thesis_schedules()[0]),
    "gearbox": (gearbox(), greedy(gearbox())),
    "desk": (desk(), greedy(desk())),
    "120 tasks": (layered(120), greedy(layered(120))),
}


def bars(ax) -> dict[tuple[str, str], Rectangle]:
    """(task, operator) -> its outline."""
    found = [patch for patch in ax.patches if (patch.get_gid() or "").startswith("task ")]
    assert len({patch.get_gid() for patch in found}) == len(found)
    return {patch.get_gid(): patch for patch in found}


def drawn(ax) -> list[FittedText]:
    FigureCanvasAgg(ax.figure).draw()
    return [text for text in ax.get_children() if isinstance(text, FittedText)]


@pytest.mark.parametrize("name", CASES)
def test_there_is_one_bar_for_each_task_of_each_operator_at_its_time(name: str) -> None:
    cell, schedule = CASES[name]
    found = bars(plot_gantt(cell, schedule))
    lanes = list(cell.operators)
    assert set(found) == {f"task {a.task} {who}" for a in schedule for who in a.operators}
    for a in schedule:
        for who in a.operators:
            bar = found[f"task {a.task} {who}"]
            assert bar.get_x() == a.start
            assert bar.get_width() == pytest.approx(a.end - a.start)
            assert bar.get_y() + bar.get_height() / 2 == pytest.approx(lanes.index(who))


def test_there_is_one_lane_per_operator_and_it_says_how_busy() -> None:
    ax = plot_gantt(thesis(), thesis_schedules()[0])
    assert [tick.get_text() for tick in ax.get_yticklabels()] == [
        "robot\n20 s busy, 87 %",
        "human\n15 s busy, 65 %",
    ]
    assert ax.get_xlabel() == "time [s]"


def test_an_operator_who_does_nothing_keeps_a_lane() -> None:
    cell = thesis().replace(
        operators={
            "robot": {"kind": "robot"},
            "human": {"kind": "human"},
            "spare": {"kind": "robot"},
        }
    )
    assert len(plot_gantt(cell, thesis_schedules()[0]).get_yticks()) == 3


def test_exactly_the_critical_path_has_bold_outlines() -> None:
    cell, schedule = CASES["desk"]
    path = {link.assignment.task for link in critical_path(cell, schedule)}
    bold = {
        gid.split()[1]
        for gid, bar in bars(plot_gantt(cell, schedule)).items()
        if bar.get_linewidth() > 2
    }
    assert bold == path
    assert {
        gid
        for gid, bar in bars(plot_gantt(cell, schedule, critical=False)).items()
        if bar.get_linewidth() > 2
    } == set()


def test_a_joint_task_is_in_both_lanes_and_linked() -> None:
    cell, schedule = CASES["gearbox"]
    ax = plot_gantt(cell, schedule)
    assert {"task cover ben", "task cover cobot2"} <= set(bars(ax))
    assert [line.get_gid() for line in ax.lines if line.get_gid()] == ["joint cover"]


def test_human_and_robot_differ_in_more_than_colour() -> None:
    ax = plot_gantt(thesis(), thesis_schedules()[0])
    filled = [
        patch
        for patch in ax.patches
        if isinstance(patch, Rectangle) and patch.get_gid() is None and patch.get_fill()
    ]
    hatched = {
        round(p.get_y() + p.get_height() / 2): p.get_hatch() for p in filled if p.get_height() < 0.7
    }
    assert hatched[0]
    assert not hatched[1]


@pytest.mark.parametrize("name", CASES)
def test_no_label_leaves_its_bar_and_most_bars_have_one(name: str) -> None:
    cell, schedule = CASES[name]
    figure = figure_for(cell, schedule)
    ax = plot_gantt(cell, schedule, figure.axes[0])
    texts = drawn(ax)
    renderer = figure.canvas.get_renderer()
    for text in texts:
        left, bottom, right, top = text.box
        (x0, y0), (x1, y1) = ax.transData.transform([(left, bottom), (right, top)])
        extent = text.get_window_extent(renderer)
        if text.get_text():
            assert x0 - 1 <= extent.x0 <= extent.x1 <= x1 + 1, text.get_text()
            assert min(y0, y1) - 2 <= extent.y0 <= extent.y1 <= max(y0, y1) + 2, text.get_text()
    named = [text for text in texts if text.get_text()]
    assert len(named) > 0.85 * len(texts)


def test_labels_fit_after_the_figure_became_smaller() -> None:
    cell, schedule = CASES["gearbox"]
    figure = blank(10, 5)
    ax = plot_gantt(cell, schedule, figure.axes[0], legend=False)
    before = [text.get_text() for text in drawn(ax)]
    figure.set_size_inches(5, 3)
    after = [text.get_text() for text in drawn(ax)]
    assert "shaft: Insert shaft" in before
    assert sum(map(len, after)) < sum(map(len, before))


def test_a_long_name_is_cut_and_a_dollar_is_no_formula() -> None:
    cell = Cell.model_validate(
        {
            "operators": {"r": {"kind": "robot"}},
            "tasks": {
                "$x$ " + "very long name " * 10: {"time": {"r": 5}},
                "b": {"time": {"r": 60}},
            },
        }
    )
    long = next(iter(cell.tasks))
    texts = [
        text.get_text()
        for text in drawn(plot_gantt(cell, rows((long, "r", 0, 5), ("b", "r", 5, 65))))
    ]
    assert texts[1] == "b"
    assert texts[0] == "" or texts[0].endswith("…")


def test_makespan_and_limit_have_lines_and_words() -> None:
    ax = plot_gantt(thesis(), thesis_schedules()[1], limit=30)
    assert {text.get_text() for text in ax.texts} >= {"24 s", "limit 30 s"}
    assert ax.get_xlim()[1] > 30


def test_breaks_changeovers_and_deadlines_are_explained_when_there_are_any() -> None:
    def legend(ax) -> set[str]:
        return {text.get_text() for text in ax.get_legend().get_texts()}

    plain = legend(plot_gantt(*CASES["thesis"]))
    assert plain == {"human (plain)", "robot (hatched)", "critical path"}
    assert legend(plot_gantt(*CASES["gearbox"])) - plain == {
        "joint task",
        "break",
        "tool changeover",
        "until a task's deadline",
    }


def test_a_wait_is_a_dotted_line_from_the_moment_it_counts_from() -> None:
    ax = plot_gantt(glued(), glued_schedule())
    dotted = [line for line in ax.lines if line.get_linestyle() not in ("-", "None")]
    assert sorted(tuple(line.get_xdata()) for line in dotted) == [(40, 100), (100, 104)]
    assert "wait before a task" in {text.get_text() for text in ax.get_legend().get_texts()}
    page = html(front_of(glued(), [glued_schedule()]))
    assert page.count('class="wait"') >= 2
    assert "Dotted line below a bar: the wait before it." in page
    assert "the wait before it" not in html(front_of(thesis(), [thesis_schedule()]))


def test_an_empty_schedule_is_an_empty_chart() -> None:
    assert bars(plot_gantt(thesis(), Schedule(()))) == {}


def test_drawing_needs_no_pyplot() -> None:
    import sys

    for name in [name for name in sys.modules if name == "matplotlib.pyplot"]:
        del sys.modules[name]
    plot_gantt(*CASES["thesis"])
    assert "matplotlib.pyplot" not in sys.modules


def test_a_german_picture_has_german_words_and_a_decimal_comma() -> None:
    cell = gearbox()
    ax = plot_gantt(cell, greedy(cell), language="de")
    said = [
        text.get_text() for text in (*ax.texts, *ax.get_yticklabels(), *ax.get_legend().get_texts())
    ]
    assert ax.get_xlabel() == "Zeit [s]"
    assert re.fullmatch(r"Dauer \d+(,\d+)? s, Belastung \d+(,\d+)?", ax.get_title(loc="left"))
    assert {"kritischer Pfad", "gemeinsamer Vorgang"} <= set(said)
    assert not any(re.search(r"\d\.\d|busy|break|task", words) for words in said)
    assert any(re.search(r"\d,\d s beschäftigt", words) for words in said)


@pytest.mark.parametrize("language", ["en", "de"])
def test_no_word_of_the_legend_is_cut_off(language: str) -> None:
    """With all marks that there are; German ones are longer."""
    cell = gearbox()
    ax = plot_gantt(cell, greedy(cell), figure_for(cell, greedy(cell)).axes[0], language=language)
    FigureCanvasAgg(ax.figure).draw()
    words = ax.get_legend().get_texts()
    assert len(words) >= 6
    assert all(
        ax.figure.bbox.x0 <= word.get_window_extent().x0
        and word.get_window_extent().x1 <= ax.figure.bbox.x1
        for word in words
    )
