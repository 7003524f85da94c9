"""Two schedules of one cell over each other, and what differs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from tandem.cell.model import Cell
from tandem.draw.figure import axes_or_new, compare_size, numbers_in
from tandem.draw.gantt import HALF, axis_end, draw_lanes, lane_name
from tandem.draw.lanes import Lane, lanes
from tandem.draw.language import Words, words
from tandem.draw.style import ACCENT, FAINT_INK, INK, RULE, looks
from tandem.schedule.measures import makespan, stress
from tandem.schedule.model import Assignment, Schedule

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GAP = 1.15
"""Lanes that stay free between the two blocks."""


@dataclass(frozen=True)
class Change:
    """What became of one task.

    Attributes:
      kind: "moved" to other operators, "shifted" in time only, "added" or "dropped" when only one
        of the schedules has it, or "same".
      before, after: the task in either schedule.
    """

    task: str
    kind: Literal["moved", "shifted", "added", "dropped", "same"]
    before: Assignment | None
    after: Assignment | None


def changes(before: Schedule, after: Schedule) -> tuple[Change, ...]:
    """What became of every task of either schedule, in order of the start in the second, dropped
    ones last.
    """
    old = {a.task: a for a in before}
    found = []
    for now in after:
        then = old.pop(now.task, None)
        if then is None:
            found.append(Change(now.task, "added", None, now))
        elif set(then.operators) != set(now.operators):
            found.append(Change(now.task, "moved", then, now))
        else:
            found.append(
                Change(
                    now.task,
                    "same" if (then.start, then.end) == (now.start, now.end) else "shifted",
                    then,
                    now,
                )
            )
    return (*found, *(Change(task, "dropped", then, None) for task, then in old.items()))


def summary(cell: Cell, before: Schedule, after: Schedule, language: str = "en") -> str:
    """One line: makespan and stress from one to the other, and how many tasks moved and shifted."""
    t = words(language)
    kinds = [change.kind for change in changes(before, after)]
    time = _from_to(makespan(before), makespan(after), " s", t)
    load = _from_to(stress(cell, before), stress(cell, after), "", t)
    counts = [
        t(f"compare.{kind}", n=kinds.count(kind))
        for kind in ("moved", "shifted", "added", "dropped")
        if kind in kinds
    ]
    tasks = ", ".join(counts) or t("compare.none")
    return t("compare.summary", makespan=time, stress=load, tasks=tasks)


def plot_compare(
    cell: Cell,
    before: Schedule,
    after: Schedule,
    ax: Axes | None = None,
    *,
    names: tuple[str, str] | None = None,
    language: str = "en",
) -> Axes:
    """Draws both schedules over each other on one time axis and returns the axes. `names` are what
    they are called; before and after when not given.

    Tasks that moved to another operator have a bold red outline and an arrow from the one to the
    other; tasks that stayed as they were are pale.
    """
    t = words(language)
    ax = axes_or_new(ax, compare_size(cell, max(before, after, key=len)))
    names = names or (t("compare.before"), t("compare.after"))
    end = max(axis_end(before), axis_end(after))
    upper, lower = (
        lanes(cell, schedule, until=end, critical=False) for schedule in (before, after)
    )
    below = len(upper) + GAP
    ax.set_xlim(0, end)
    ax.set_ylim(below + len(lower) - 0.45, -0.95)
    draw_lanes(ax, upper, t, deadlines=False)
    draw_lanes(ax, lower, t, at=below, deadlines=False)
    found = changes(before, after)
    _mark(ax, found, cell, below)
    for schedule, top, name in ((before, 0.0, names[0]), (after, below, names[1])):
        _heading(ax, cell, schedule, top, name, t)
    _moves(
        ax,
        [change for change in found if change.kind == "moved"],
        cell,
        len(upper) - 0.5 + GAP / 2 - 0.2,
        t,
    )
    _dress(ax, upper, lower, below, t)
    ax.set_title(
        summary(cell, before, after, language),
        loc="left",
        fontsize=11,
        fontweight="bold",
        parse_math=False,
    )
    return ax


def _mark(ax: Axes, found: Iterable[Change], cell: Cell, below: float) -> None:
    from matplotlib.patches import FancyArrowPatch, Rectangle

    place = {name: float(y) for y, name in enumerate(cell.operators)}
    for change in found:
        for a, top in ((change.before, 0.0), (change.after, below)):
            if a is None or change.kind == "shifted":
                continue
            for who in a.operators:
                corner, width = (a.start, top + place[who] - HALF), a.end - a.start
                if change.kind == "same":
                    ax.add_patch(
                        Rectangle(
                            corner, width, 2 * HALF, facecolor="white", alpha=0.55, lw=0, zorder=4.5
                        )
                    )
                else:
                    ax.add_patch(
                        Rectangle(
                            corner,
                            width,
                            2 * HALF,
                            fill=False,
                            edgecolor=ACCENT,
                            lw=2.4,
                            zorder=4.6,
                            gid=f"changed {change.task} {who}",
                        )
                    )
        if change.kind == "moved" and change.before and change.after:
            start = (
                (change.before.start + change.before.end) / 2,
                max(place[o] for o in change.before.operators) + HALF,
            )
            stop = (
                (change.after.start + change.after.end) / 2,
                below + min(place[o] for o in change.after.operators) - HALF,
            )
            arrow = FancyArrowPatch(
                start,
                stop,
                arrowstyle="-|>",
                mutation_scale=12,
                shrinkA=0,
                shrinkB=0,
                color=ACCENT,
                lw=1.4,
                zorder=4.2,
            )
            arrow.set_gid(f"move {change.task}")
            ax.add_patch(arrow)


def _heading(ax: Axes, cell: Cell, schedule: Schedule, top: float, name: str, t: Words) -> None:
    said = t(
        "compare.heading",
        name=name,
        makespan=t.seconds(makespan(schedule)),
        stress=t.number(stress(cell, schedule)),
        plan=t("imprint.plan", digest=schedule.digest),
    )
    ax.text(
        0,
        top - 0.5,
        said,
        ha="left",
        va="bottom",
        fontsize=10,
        fontweight="bold",
        color=INK,
        parse_math=False,
    )
    ax.plot(
        [makespan(schedule)] * 2,
        [top - 0.5, top + len(cell.operators) - 0.5],
        color=INK,
        lw=1.2,
        zorder=1.6,
    )


def _moves(ax: Axes, moved: list[Change], cell: Cell, y: float, t: Words) -> None:
    """Between the blocks, in words, who gives what to whom; as much as fits."""
    from tandem.draw.fitted import fitted_text

    shown = looks(cell)

    def who(a: Assignment | None) -> str:
        return "+".join(shown[o].label for o in a.operators) if a else t("compare.nobody")

    sentences = [f"{change.task}: {who(change.before)} → {who(change.after)}" for change in moved]
    fuller = [
        ";  ".join(sentences[:count])
        + (t("compare.more", n=len(sentences) - count) if count < len(sentences) else "")
        for count in range(len(sentences), 0, -1)
    ]
    if fuller:
        box = (0.0, y - 0.26, ax.get_xlim()[1], y + 0.26)
        backing = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
        fitted_text(ax, box, fuller, size=9, turn=False, color=ACCENT, bbox=backing, zorder=5)


def _dress(
    ax: Axes, upper: tuple[Lane, ...], lower: tuple[Lane, ...], below: float, t: Words
) -> None:
    from matplotlib.ticker import MaxNLocator

    ticks = [*range(len(upper)), *(below + y for y in range(len(lower)))]
    ax.set_yticks(ticks, [lane_name(lane, t) for lane in (*upper, *lower)], fontsize=10)
    ax.tick_params(axis="y", length=0)
    ax.xaxis.set_major_locator(MaxNLocator(nbins=12, steps=[1, 2, 5, 10]))
    ax.set_xlabel(t("gantt.axis"))
    numbers_in(ax.xaxis, t)
    ax.grid(axis="x", color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    for side in ("top", "right", "left"):
        ax.spines[side].set_visible(False)
    hint: dict[str, Any] = {
        "xycoords": "axes fraction",
        "textcoords": "offset points",
        "ha": "left",
        "va": "top",
        "fontsize": 9,
        "color": FAINT_INK,
    }
    ax.annotate(t("compare.legend"), (0, 0), (0, -36), **hint)


def _from_to(before: float, after: float, unit: str, t: Words) -> str:
    now = f"{t.number(after)}{unit}"
    if before == after:
        return t("compare.as_before", now=now)
    more = f"{'+' if after > before else '−'}{t.number(abs(after - before))}"
    return t("compare.change", before=t.number(before), now=now, more=more)
