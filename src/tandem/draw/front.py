"""The trade-off between makespan, or cycle time, and stress as a chart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from tandem.draw.figure import axes_or_new, legend_below, numbers_in
from tandem.draw.language import Words, words
from tandem.draw.style import INK, RULE, SHADE
from tandem.plan.cycle.result import CycleFront, CycleResult
from tandem.plan.result import Bound, Front, Result, Status

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

POINT = "#0072B2"
MOST_LABELS = 40
OPEN: dict[str, Any] = {"hatch": "////", "edgecolor": "#9AA3AB"}
BOUND: dict[str, Any] = {"color": INK, "lw": 1.3, "ls": (0, (4, 2))}


def plot_front(
    front: Front | CycleFront,
    ax: Axes | None = None,
    *,
    language: str = "en",
    point: int | None = None,
) -> Axes:
    """Draws every point with its numbers and returns the axes.

    What the points dominate is shaded, the knee has a ring, and a point that is not proven is
    hollow. A dashed line is the bound: no schedule lies below or left of it; what lies between it
    and the points is open, and hatched. Where the front knows no such line, the hollow points have
    dashed lines that reach to their own bounds. `point`, counted from 1, has a square around it
    when it is another than the knee. Raises UsageError when pictures do not speak the language.
    """
    t = words(language)
    ax = axes_or_new(ax, (7.0, 4.8))
    left, right, low, high = window(front)
    ax.set_xlim(left, right)
    ax.set_ylim(low, high)
    ax.set_xlabel(t(time_axis(front)))
    ax.set_ylabel(t("front.stress"))
    numbers_in(ax.xaxis, t)
    numbers_in(ax.yaxis, t)
    ax.grid(color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    if len(front):
        _dominated(ax, front, right, high)
        if bound_points(front):
            _open(ax, front, right, high)
        for result in front:
            _point(ax, result, reaches=not bound_points(front))
        _frame(ax, front.knee, "knee")
        if front.shown(point) is not front.knee:
            _frame(ax, front.shown(point), "shown")
        _labels(ax, front, point, t)
    title = t(
        "picture.complete" if front.complete else "picture.open",
        points=t.count("picture.points", len(front)),
    )
    ax.set_title(title, loc="left", fontsize=11, fontweight="bold")
    if len(front):
        _legend(ax, front, point, t)
    return ax


def time_of(result: Result | CycleResult) -> float:
    """What the chart goes by to the right, seconds: the cycle time of a pattern that repeats, else
    the makespan.
    """
    return result.cycle_time if isinstance(result, CycleResult) else result.makespan


def least_time(result: Result | CycleResult) -> float:
    """The bound on it, seconds."""
    bound = result.bound
    return bound.makespan if isinstance(bound, Bound) else bound.cycle_time


def time_axis(front: Front | CycleFront) -> str:
    """The key of the words for it."""
    return "front.cycle_time" if isinstance(front, CycleFront) else "front.makespan"


def bound_points(front: Front | CycleFront) -> tuple[tuple[float, float], ...]:
    """Corners of what is proven of the points that were not found: see `Front.bound_front`."""
    return front.bound_front if isinstance(front, Front) and not front.complete else ()


def knee_key(front: Front | CycleFront) -> str:
    """The key of the words for the ring: what is recommended, and whether it may change."""
    if isinstance(front, Front) and len(front) > 1 and not front.is_knee_certain:
        return "picture.knee.open"
    return "picture.knee" if len(front) > 2 else "picture.recommended"


def knee_label(front: Front | CycleFront) -> str:
    """The key of the words that stand at the recommended point."""
    if knee_key(front) == "picture.knee.open":
        return "picture.point.recommended"
    return "picture.point.knee" if len(front) > 2 else "picture.point"


def window(front: Front | CycleFront) -> tuple[float, float, float, float]:
    """Left, right, low, high of a chart in which every point and bound has room, seconds and
    stress.
    """
    times = [
        value
        for r in front
        for value in (time_of(r), least_time(r) if r.status != Status.OPTIMAL else time_of(r))
    ] + [time for time, _ in bound_points(front)] or [0.0, 1.0]
    loads = [
        value
        for r in front
        for value in (r.stress, r.bound.stress if r.status != Status.OPTIMAL else r.stress)
    ] + [load for _, load in bound_points(front)] or [0.0, 1.0]
    across = (
        max(max(times) - min(times), 0.02 * max(times))
        if len(front) > 1
        else max(0.3 * max(times), 1.0)
    )
    up = (
        max(max(loads) - min(loads), 0.02 * max(loads))
        if len(front) > 1
        else max(0.4 * max(loads), 1.0)
    )
    return (
        max(0.0, min(times) - 0.14 * across),
        max(times) + 0.22 * across,
        max(0.0, min(loads) - 0.16 * up),
        max(loads) + 0.22 * up,
    )


def staircase(
    points: Sequence[tuple[float, float]], right: float, high: float
) -> list[tuple[float, float]]:
    """Corners of the edge between what the points dominate and the rest, from top left to bottom
    right. Points are (time, stress), sorted by time, each with less stress than the one before.
    """
    corners = [(points[0][0], high)]
    for time, stress in points:
        corners += [(time, corners[-1][1]), (time, stress)]
    return [*corners[1:], (right, corners[-1][1])]


def _dominated(ax: Axes, front: Front | CycleFront, right: float, high: float) -> None:
    from matplotlib.patches import Polygon

    edge = staircase(front.points, right, high)
    ax.add_patch(
        Polygon(
            [*edge, (right, high)], closed=True, facecolor=SHADE, lw=0, zorder=0.6, gid="dominated"
        )
    )
    ax.plot([x for x, _ in edge], [y for _, y in edge], color="#7A828A", lw=1.1, zorder=1)


def _open(ax: Axes, front: Front | CycleFront, right: float, high: float) -> None:
    """The bound, and what is open between it and the points."""
    from matplotlib.patches import Polygon

    edge, bound = (staircase(points, right, high) for points in (front.points, bound_points(front)))
    between = Polygon(
        [*bound, *reversed(edge)],
        closed=True,
        facecolor="none",
        lw=0,
        zorder=0.8,
        gid="open",
        **OPEN,
    )
    ax.add_patch(between)
    ax.plot([x for x, _ in bound], [y for _, y in bound], zorder=1.5, gid="bound", **BOUND)


def _point(ax: Axes, result: Result | CycleResult, *, reaches: bool) -> None:
    x, y = time_of(result), result.stress
    proven = result.status == Status.OPTIMAL
    if not proven and reaches:
        ax.plot(
            [least_time(result), x],
            [y, y],
            color=POINT,
            lw=1.3,
            ls=(0, (3, 2)),
            marker="|",
            ms=9,
            markevery=[0],
            zorder=2,
        )
        ax.plot(
            [x, x],
            [result.bound.stress, y],
            color=POINT,
            lw=1.3,
            ls=(0, (3, 2)),
            marker="_",
            ms=9,
            markevery=[0],
            zorder=2,
        )
    ax.plot(
        [x],
        [y],
        ls="",
        marker="o",
        ms=9,
        mfc=POINT if proven else "white",
        mec=POINT,
        mew=1.8,
        zorder=5,
    )


FRAMES: dict[str, dict[str, Any]] = {
    "knee": {"ls": "", "marker": "o", "mfc": "none", "mec": INK, "mew": 1.6},
    "shown": {"ls": "", "marker": "s", "mfc": "none", "mec": INK, "mew": 1.6},
}


def _frame(ax: Axes, result: Result | CycleResult, why: str) -> None:
    at = [time_of(result)], [result.stress]
    ax.plot(*at, ms=17, zorder=4, gid=why, **FRAMES[why])


def _labels(ax: Axes, front: Front | CycleFront, point: int | None, t: Words) -> None:
    """The knee and the ends first, then every other point whose label meets no other."""
    from matplotlib.transforms import Bbox

    knee = front.knee_place
    shown = knee if point is None else point - 1
    order = list(dict.fromkeys([knee, 0, len(front) - 1, *range(len(front))]))
    to_points = 72 / ax.figure.dpi
    dots = [to_points * ax.transData.transform((time_of(r), r.stress)) for r in front]
    taken: list[Bbox] = [Bbox.from_bounds(x - 5, y - 5, 10, 10) for x, y in dots]
    for place in order[: 3 * MOST_LABELS]:
        result, (x, y) = front[place], dots[place]
        key = knee_label(front) if place == knee else "picture.point"
        label = t(key, makespan=t.seconds(time_of(result)), stress=t.number(result.stress))
        away = 10 if place in (knee, shown) else 7
        # Above right of a point lies only what it dominates: the one side that is always free of
        # other points.
        box = Bbox.from_bounds(x + away, y + away - 2, 5.6 * len(label), 11)
        if place not in (knee, 0, len(front) - 1) and any(box.overlaps(other) for other in taken):
            continue
        taken.append(box)
        bold = "bold" if place == knee else "normal"
        at: dict[str, Any] = {
            "textcoords": "offset points",
            "fontsize": 9.5,
            "color": INK,
            "fontweight": bold,
            "zorder": 6,
        }
        ax.annotate(label, (time_of(result), result.stress), (away, away - 2), **at)


def _legend(ax: Axes, front: Front | CycleFront, point: int | None, t: Words) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    marks: dict[str, Any] = {"ls": "", "marker": "o", "mec": POINT, "mew": 1.8}
    entries: list[tuple[Artist, str]] = []
    if any(r.status == Status.OPTIMAL for r in front):
        entries.append((Line2D([], [], mfc=POINT, ms=8, **marks), t("picture.proven")))
    bounded = bool(bound_points(front))
    if any(r.status != Status.OPTIMAL for r in front):
        unproven = t("picture.found" if bounded else "picture.unproven")
        entries.append((Line2D([], [], mfc="white", ms=8, **marks), unproven))
    ring = Line2D([], [], ms=12, **FRAMES["knee"])
    entries.append((ring, t(knee_key(front))))
    if front.shown(point) is not front.knee:
        entries.append((Line2D([], [], ms=12, **FRAMES["shown"]), t("picture.shown")))
    entries.append((Patch(facecolor=SHADE, edgecolor="#7A828A"), t("picture.dominated")))
    if bounded:
        entries.append((Patch(facecolor="none", lw=0, **OPEN), t("picture.between")))
        entries.append((Line2D([], [], **BOUND), t("picture.bound")))
    legend_below(ax, entries)
