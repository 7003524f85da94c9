"""A station that repeats, drawn: two cycles with every product in the station, and the load of each
operator against cycle time and takt.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from tests.draw.cycles import FRONTS, bench, bench_front, bench_pattern, thesis_cycles

from tandem.draw.cycle_gantt import plot_cycle
from tandem.draw.cycle_overview import cycle_overview
from tandem.draw.fitted import FittedText
from tandem.draw.front import plot_front
from tandem.draw.lanes import products_shown, steady_lanes
from tandem.draw.style import HUMAN_COLOURS, INK, ROBOT_COLOURS, SHADES, contrast, tint
from tandem.draw.yamazumi import plot_yamazumi, stacks, words_at
from tandem.errors import UsageError
from tandem.plan.cycle.result import CycleFront


def marked(ax: Axes, word: str) -> dict[str, Rectangle]:
    """What of the patches is a bar or a block, by what it is called."""
    found = [patch for patch in ax.patches if (patch.get_gid() or "").startswith(f"{word} ")]
    return {patch.get_gid(): patch for patch in found}


def texts(ax: Axes) -> list[FittedText]:
    FigureCanvasAgg(ax.figure).draw()
    return [text for text in ax.get_children() if isinstance(text, FittedText)]


@pytest.mark.parametrize("name", FRONTS)
def test_two_cycles_hold_every_task_twice_and_what_runs_over_their_edges(name: str) -> None:
    result = FRONTS[name]().knee
    length = result.cycle_time
    for lane in steady_lanes(result.cell, result.periodic):
        own = [a for a in result.schedule if lane.look.operator in a.operators]
        seen = sum(min(bar.end, 2 * length) - max(bar.start, 0) for bar in lane.bars)
        assert seen == pytest.approx(2 * sum(a.end - a.start for a in own))
        for bar in lane.bars:
            (a,) = (a for a in own if a.task == bar.task)
            assert bar.product is not None
            assert bar.start == pytest.approx(a.start + bar.product * length)
            assert bar.end == pytest.approx(a.end + bar.product * length)


def test_products_are_told_apart_by_mark_and_by_shade() -> None:
    ax = plot_cycle(bench(), bench_pattern())
    assert {gid for gid in marked(ax, "task") if "label" in gid or "check" in gid} == {
        *("task label ben -1", "task label ben #1"),
        *("task check ben -1", "task check ben #1", "task check ben #2"),
    }
    lane = steady_lanes(bench(), bench_pattern())[1]
    fills = {bar.product: lane.look_of(bar).tint for bar in lane.bars}
    assert len(set(fills.values())) == len(fills) == 3
    assert products_shown(steady_lanes(bench(), bench_pattern())) == [-1, 0, 1]


def test_every_shade_of_every_operator_is_one_on_which_black_text_reads() -> None:
    for colour in (*HUMAN_COLOURS, *ROBOT_COLOURS):
        assert min(contrast(INK, tint(colour, strength)) for strength in SHADES) >= 4.5, colour


def test_the_changeover_into_a_cycle_is_at_the_end_of_the_one_before() -> None:
    cobot = steady_lanes(bench(), bench_pattern())[2]
    spans = [(off.start, off.end, off.what) for off in cobot.shaded]
    assert sorted(spans) == [
        (11, 14, "driver"),
        (22, 24, "gripper"),
        (35, 38, "driver"),
        (46, 48, "gripper"),
    ]


def test_a_line_ends_each_cycle_and_joint_tasks_are_linked_within_their_product() -> None:
    ax = plot_cycle(bench(), bench_pattern())
    at = [line.get_xdata()[0] for line in ax.lines if line.get_gid() == "boundary"]
    assert at == [24, 48]
    assert [line.get_gid() for line in ax.lines].count("joint lift") == 2
    assert ax.get_xlim() == (0, 48)


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("name", FRONTS)
def test_no_name_leaves_the_part_of_its_bar_that_is_seen(name: str, language: str) -> None:
    result = FRONTS[name]()[0]
    ax = plot_cycle(result.cell, result.periodic, language=language)
    found = texts(ax)
    renderer = ax.figure.canvas.get_renderer()
    left, right = ax.transData.transform([(0, 0), (ax.get_xlim()[1], 0)])[:, 0]
    for text in found:
        (x0, y0), (x1, y1) = ax.transData.transform([text.box[:2], text.box[2:]])
        extent = text.get_window_extent(renderer)
        if text.get_text():
            assert max(x0, left) - 1 <= extent.x0 <= extent.x1 <= min(x1, right) + 1
            assert min(y0, y1) - 2 <= extent.y0 <= extent.y1 <= max(y0, y1) + 2
    assert sum(bool(text.get_text()) for text in found) > 0.85 * len(found)


@pytest.mark.parametrize("name", FRONTS)
def test_a_stack_is_an_operators_work_with_changeovers_on_top(name: str) -> None:
    for result in FRONTS[name]():
        for stack in stacks(result.cell, result.periodic):
            tops = [0.0, *(block.high for block in stack.blocks)]
            assert [block.low for block in stack.blocks] == tops[:-1]
            assert tops[-1] == pytest.approx(result.cycle_time - stack.round.idle)
            done = [block.task for block in stack.blocks if block.task]
            assert set(done) == {a.task for a in result.schedule.of(stack.look.operator)}
            assert [block.task for block in stack.blocks[len(done) :]] in ([], [""])


def test_the_stacks_stand_against_cycle_time_and_takt() -> None:
    ax = plot_yamazumi(bench(), bench_pattern(), takt=26)
    lines = {line.get_gid(): line.get_ydata()[0] for line in ax.lines if line.get_gid()}
    assert lines == {"cycle time": 24, "takt": 26}
    blocks = marked(ax, "load")
    assert blocks["load changeover cobot"].get_y() == 18
    assert blocks["load changeover cobot"].get_height() == 5
    assert {"load lift anna", "load lift cobot"} <= set(blocks)
    alone = plot_yamazumi(bench(), bench_pattern())
    assert "takt" not in {line.get_gid() for line in alone.lines}


def test_the_words_of_a_stack_are_those_of_the_language() -> None:
    feet = {
        language: [
            tick.get_text()
            for tick in plot_yamazumi(bench(), bench_pattern(), language=language).get_xticklabels()
        ]
        for language in ("en", "de")
    }
    assert feet["en"][0] == "Anna\n9.5 s work, 40 %\n14.5 s idle, 60 %"
    assert feet["de"][0] == "Anna\n9,5 s Arbeit, 40 %\n14,5 s frei, 60 %"


def test_a_front_of_cycles_has_its_axis_its_points_and_its_bounds() -> None:
    ax = plot_front(thesis_cycles())
    assert ax.get_xlabel() == "cycle time [s]"
    assert "24 s, 3 (knee)" in [text.get_text() for text in ax.texts]
    open_ends = plot_front(bench_front()).lines
    assert 23.0 in [line.get_xdata()[0] for line in open_ends if line.get_marker() == "|"]


def told(ax: Axes) -> list[Text]:
    """Every text of a chart that can be seen."""
    ticks = [
        tick.label1
        for axis in (ax.xaxis, ax.yaxis)
        for tick in axis.get_major_ticks()
        if min(axis.get_view_interval()) <= tick.get_loc() <= max(axis.get_view_interval())
    ]
    legend = ax.get_legend()
    own = [text for text in ax.get_children() if isinstance(text, Text)]
    return [*own, *ticks, *(legend.get_texts() if legend else ()), ax.xaxis.label, ax.yaxis.label]


@pytest.mark.parametrize("make", FRONTS.values())
@pytest.mark.parametrize("language", ["en", "de"])
def test_no_two_texts_of_the_overview_lie_upon_each_other(
    make: Callable[[], CycleFront], language: str
) -> None:
    figure = cycle_overview(make(), language=language)
    FigureCanvasAgg(figure).draw()
    renderer = figure.canvas.get_renderer()
    boxes = [
        (text.get_text(), text.get_window_extent(renderer))
        for ax in figure.axes
        for text in told(ax)
        if text.get_text() and text.get_visible()
    ]
    assert len(boxes) > 30
    clash = [
        (one, other)
        for place, (one, a) in enumerate(boxes)
        for other, b in boxes[place + 1 :]
        if min(a.x1, b.x1) - max(a.x0, b.x0) > 1.5 and min(a.y1, b.y1) - max(a.y0, b.y0) > 1.5
    ]
    assert clash == []
    wide, high = figure.bbox.width + 1, figure.bbox.height + 1
    outside = [
        word for word, box in boxes if box.x0 < -1 or box.y0 < -1 or box.x1 > wide or box.y1 > high
    ]
    assert outside == []


def test_a_language_that_nobody_speaks_is_refused() -> None:
    with pytest.raises(UsageError, match="'fr'"):
        plot_cycle(bench(), bench_pattern(), language="fr")


def test_the_words_of_a_cycle_time_are_not_struck_through_by_the_takt() -> None:
    assert words_at(59, 60) == 60
    assert words_at(54, 60) == 54
    assert words_at(60, 60) == 60
    assert words_at(54, None) == 54
