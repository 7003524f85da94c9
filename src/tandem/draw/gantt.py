"""A schedule as a Gantt chart: one lane per operator, seconds to the right."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell
from tandem.cell.parts import KINDS
from tandem.draw.figure import axes_or_new, gantt_size, legend_below, numbers_in
from tandem.draw.lanes import SHADINGS, Bar, Lane, kinds_shaded, lanes
from tandem.draw.language import Words, words
from tandem.draw.style import ACCENT, FAINT_INK, INK, RULE, SHADE
from tandem.schedule.critical import critical_path
from tandem.schedule.measures import makespan, stress
from tandem.schedule.model import Schedule

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

HALF = 0.33
"""Half the height of a bar; lanes are one apart."""
WAIT = (0, (1, 2))
"""Dots of the line that stands for a wait before a task."""


def plot_gantt(
    cell: Cell,
    schedule: Schedule,
    ax: Axes | None = None,
    *,
    critical: bool = True,
    limit: float | None = None,
    until: float | None = None,
    title: str | None = None,
    legend: bool = True,
    language: str = "en",
) -> Axes:
    """Draws the schedule and returns the axes.

    Tasks on the critical path have a bold outline and are joined by a line; a joint task stands in
    the lane of everyone who takes part, joined by a bracket; breaks, walks and changeovers are
    shaded; a task's own deadline is a mark in its lane.

    Args:
      schedule: a sound schedule of the cell.
      critical: whether the critical path is marked.
      limit: a time to draw a line at, such as the takt; seconds.
      until: where the axis ends, seconds, so that several charts can be compared; a little behind
        the makespan when absent.
      title: what stands above; makespan and stress when absent, nothing when empty.
      legend: whether marks are explained below the chart; only those that occur.
      language: of the words and the decimal mark.

    Raises UsageError when pictures do not speak the language.
    """
    t = words(language)
    ax = axes_or_new(ax, gantt_size(cell, schedule))
    end = until if until is not None else axis_end(schedule, limit)
    rows = lanes(cell, schedule, until=end, critical=critical)
    ax.set_xlim(0, end)
    ax.set_ylim(len(rows) - 0.45, -0.55)
    draw_lanes(ax, rows, t)
    if critical:
        _critical_links(ax, cell, schedule)
    joint_links(ax, rows)
    _end_line(ax, makespan(schedule), limit, t)
    if title is None:
        title = t(
            "picture.plan",
            makespan=t.seconds(makespan(schedule)),
            stress=t.number(stress(cell, schedule)),
        )
    dress(ax, rows, title, t)
    if legend:
        draw_legend(ax, rows, t, critical=critical and len(schedule) > 0)
    return ax


def axis_end(schedule: Schedule, limit: float | None = None) -> float:
    """Where a time axis ends so that makespan and limit have room, seconds."""
    return 1.03 * max(makespan(schedule), limit or 0.0, 1e-3)


def draw_lanes(
    ax: Axes, rows: Sequence[Lane], t: Words, *, at: float = 0.0, deadlines: bool = True
) -> None:
    """Bars, breaks, walks and changeovers of every lane, the first lane at height `at`; a dotted
    line for a wait before a task, and from a task's end to its deadline a line if wanted. Names
    stand in the part of a bar that the axes show.
    """
    for place, lane in enumerate(rows):
        y = at + place
        ax.axhspan(y - HALF - 0.08, y + HALF + 0.08, color="#F6F7F8", zorder=0, lw=0)
        for off in lane.shaded:
            _shaded(
                ax, off.start, off.end, y, off.what or t(f"picture.{off.kind}"), off.shading.hatch
            )
        for bar in lane.bars:
            _bar(ax, lane, bar, y)
            for moment in bar.since:
                below = y + HALF + 0.05
                ax.plot([moment, bar.start], [below] * 2, color=INK, lw=1.2, ls=WAIT, zorder=4.5)
            if deadlines and bar.deadline is not None:
                above = y - HALF - 0.06
                ax.plot(
                    [bar.end, bar.deadline, bar.deadline],
                    [above, above, above + 0.12],
                    color=ACCENT,
                    lw=1.4,
                    zorder=4.5,
                )


def _bar(ax: Axes, lane: Lane, bar: Bar, y: float) -> None:
    import matplotlib
    from matplotlib.patches import Rectangle

    from tandem.draw.fitted import fitted_text

    place, width, look = (bar.start, y - HALF), bar.end - bar.start, lane.look_of(bar)
    left, right = _seen(ax, bar.start, bar.end)
    with matplotlib.rc_context({"hatch.linewidth": 0.6}):
        patch = Rectangle(
            place,
            width,
            2 * HALF,
            facecolor=look.tint,
            edgecolor=look.colour,
            hatch=look.hatch,
            lw=0,
            zorder=2,
        )
        ax.add_patch(patch)
    edge, weight, above = (INK, 2.2, 4) if bar.critical else ("#6B7280", 0.8, 3)
    outline = Rectangle(place, width, 2 * HALF, fill=False, edgecolor=edge, lw=weight, zorder=above)
    outline.set_gid(" ".join(filter(None, ["task", bar.task, look.operator, bar.mark])))
    ax.add_patch(outline)
    backing = (
        {"boxstyle": "round,pad=0.12", "facecolor": look.tint, "edgecolor": "none"}
        if look.hatch
        else None
    )
    text = fitted_text(
        ax,
        (left, y - HALF, right, y + HALF),
        wordings(bar),
        size=10,
        bbox=backing,
        clip_path=patch,
    )
    text.set_clip_path(patch)


def wordings(bar: Bar) -> list[str]:
    """What may stand in a bar, from the fullest to the shortest. The name is always there, so that
    no bar has a number where its neighbour has a label; the mark of the product, if there are
    several, as long as there is room.
    """
    full = bar.label if bar.label == bar.task else f"{bar.task}: {bar.label}"
    longest = max((len(word) for word in full.split()), default=1)
    folded = [
        textwrap.wrap(full, max(longest, -(-len(full) // lines) + 1), break_long_words=False)
        for lines in (2, 3)
    ]
    found = [full, *("\n".join(lines) for lines in folded if 1 < len(lines) < 4), bar.task]
    if not bar.mark:
        return found
    below = [f"{bar.task}\n{bar.mark}"]
    return [*(f"{words} {bar.mark}" for words in found), *below, bar.task]


def _seen(ax: Axes, start: float, end: float) -> tuple[float, float]:
    """The part of a span of time that the axes show; the span when they show none of it."""
    low, high = ax.get_xlim()
    return (max(start, low), min(end, high)) if start < high and end > low else (start, end)


def _shaded(ax: Axes, start: float, end: float, y: float, why: str, hatch: str) -> None:
    import matplotlib
    from matplotlib.patches import Rectangle

    from tandem.draw.fitted import fitted_text

    left, right = _seen(ax, start, end)
    with matplotlib.rc_context({"hatch.linewidth": 0.5}):
        ax.add_patch(
            Rectangle(
                (start, y - HALF),
                end - start,
                2 * HALF,
                facecolor=SHADE,
                edgecolor="#9AA0A6",
                hatch=hatch,
                lw=0,
                zorder=1,
            )
        )
    backing = {"boxstyle": "round,pad=0.1", "facecolor": SHADE, "edgecolor": "none"}
    fitted_text(
        ax,
        (left, y - HALF, right, y + HALF),
        [why],
        size=8,
        color=FAINT_INK,
        bbox=backing,
        zorder=1.5,
    )


def _critical_links(ax: Axes, cell: Cell, schedule: Schedule) -> None:
    """Where the critical path goes from one operator to another, a line shows it."""
    place = {name: y for y, name in enumerate(cell.operators)}
    of_task = {a.task: a for a in schedule}
    for link in critical_path(cell, schedule):
        if link.waited_for is None or set(of_task[link.waited_for].operators) & set(
            link.assignment.operators
        ):
            continue
        first, then = of_task[link.waited_for], link.assignment
        pairs = [(place[one], place[two]) for one in first.operators for two in then.operators]
        y0, y1 = min(pairs, key=lambda pair: abs(pair[0] - pair[1]))
        side = HALF if y1 > y0 else -HALF
        ax.plot(
            [first.end, first.end, then.start, then.start],
            [y0 + side, (y0 + y1) / 2, (y0 + y1) / 2, y1 - side],
            color=INK,
            lw=2.2,
            zorder=1.9,
        )


def joint_links(ax: Axes, rows: Sequence[Lane]) -> None:
    """Lines between the bars of each joint task."""
    spans: dict[tuple[str, int | None], list[tuple[int, Bar]]] = {}
    for y, lane in enumerate(rows):
        for bar in lane.bars:
            if bar.joint:
                spans.setdefault((bar.task, bar.product), []).append((y, bar))
    for found in spans.values():
        bar, ys = found[0][1], [y for y, _ in found]
        middle = sum(_seen(ax, bar.start, bar.end)) / 2
        ax.plot(
            [middle] * 2,
            [min(ys) + HALF, max(ys) - HALF],
            color=INK,
            lw=1.4,
            ls=(0, (1, 1)),
            zorder=1.8,
            gid=f"joint {bar.task}",
        )
        for y in ys:
            ends = ([y + HALF] if y < max(ys) else []) + ([y - HALF] if y > min(ys) else [])
            ax.plot([middle] * len(ends), ends, ls="", marker="o", ms=4.5, color=INK, zorder=6)


def _end_line(ax: Axes, end: float, limit: float | None, t: Words) -> None:
    ax.axvline(end, color=INK, lw=1.2, zorder=1.6)
    at: dict[str, Any] = {
        "xycoords": ("data", "axes fraction"),
        "textcoords": "offset points",
        "va": "bottom",
        "fontsize": 9.5,
    }
    ax.annotate(t.seconds(end), (end, 1), (-3, 3), ha="right", **at)
    if limit is not None:
        ax.axvline(limit, color=ACCENT, lw=1.4, ls=(0, (5, 2)), zorder=6)
        ax.annotate(
            t("picture.limit", limit=t.seconds(limit)),
            (limit, 1),
            (-3, 15),
            ha="right",
            color=ACCENT,
            **at,
        )


def dress(ax: Axes, rows: Sequence[Lane], title: str, t: Words) -> None:
    """Names of the lanes, the axis of time and the title."""
    from matplotlib.ticker import MaxNLocator

    ax.set_yticks(range(len(rows)), [lane_name(lane, t) for lane in rows], fontsize=10)
    ax.tick_params(axis="y", length=0)
    ax.xaxis.set_major_locator(MaxNLocator(nbins=12, steps=[1, 2, 5, 10]))
    ax.set_xlabel(t("gantt.axis"))
    numbers_in(ax.xaxis, t)
    ax.grid(axis="x", color=RULE, lw=0.6, zorder=0.5)
    ax.set_axisbelow(True)
    for side in ("top", "right", "left"):
        ax.spines[side].set_visible(False)
    if title:
        ax.set_title(title, loc="left", fontsize=11, fontweight="bold", pad=20, parse_math=False)


def lane_name(lane: Lane, t: Words) -> str:
    """The operator, and below how busy it is."""
    busy = t("gantt.busy", seconds=t.seconds(lane.busy), share=t.share(lane.utilisation))
    return f"{lane.look.label}\n{busy}".replace("$", r"\$")


def draw_legend(ax: Axes, rows: Sequence[Lane], t: Words, *, critical: bool) -> None:
    """Explains, below the axes, the marks that occur."""
    legend_below(ax, legend_entries(rows, t, critical=critical))


def legend_entries(rows: Sequence[Lane], t: Words, *, critical: bool) -> list[tuple[Artist, str]]:
    """The marks that occur, and what they mean."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries: list[tuple[Artist, str]] = []
    for kind in KINDS:
        look = next((lane.look for lane in rows if lane.look.kind == kind), None)
        if look:
            fill = "hatched" if look.hatch else "plain"
            entries.append(
                (
                    Patch(facecolor=look.tint, edgecolor=look.colour, hatch=look.hatch),
                    t(f"picture.{kind}.{fill}"),
                )
            )
    if critical:
        entries.append((Patch(fill=False, edgecolor=INK, lw=2.2), t("picture.critical")))
    if any(bar.joint for lane in rows for bar in lane.bars):
        entries.append(
            (Line2D([], [], color=INK, ls=(0, (1, 1)), marker="o", ms=4.5), t("picture.joint"))
        )
    for off in kinds_shaded(rows):
        entries.append(
            (
                Patch(facecolor=SHADE, edgecolor="#9AA0A6", hatch=SHADINGS[off].hatch, lw=0),
                t(f"picture.{off}"),
            )
        )
    if any(bar.since for lane in rows for bar in lane.bars):
        entries.append((Line2D([], [], color=INK, lw=1.2, ls=WAIT), t("picture.wait")))
    if any(bar.deadline is not None for lane in rows for bar in lane.bars):
        entries.append((Line2D([], [], color=ACCENT, lw=1.4), t("picture.deadline")))
    return entries
