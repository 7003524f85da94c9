"""A Gantt chart as SVG for the page: text stays text, every bar explains itself, and a long one is
folded into panels.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence

from tandem.cell.model import Cell
from tandem.draw.gantt import wordings
from tandem.draw.lanes import Bar, Lane, Shaded, lanes, steady_lanes
from tandem.draw.style import Look, looks
from tandem.report.language import Words
from tandem.report.markup import Markup, figure, fitting, hatch_id, tag, text, ticks, width_of
from tandem.schedule.critical import slack
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.measures import exact, makespan
from tandem.schedule.model import Schedule

WIDTH = 1040.0
LANE, BAR = 70.0, 52.0
TOP, BOTTOM = 30.0, 44.0
MOST_PANELS = 12


def gantt(cell: Cell, schedule: Schedule, t: Words, *, label: str) -> Markup:
    """The chart, one drawing per panel."""
    end = makespan(schedule)
    rows = lanes(cell, schedule, until=end)
    left = _left(rows, t)
    slacks = slack(cell, schedule)
    panels = panel_times(schedule, WIDTH - left - 22)
    drawn = [
        _panel(rows, slacks, begin, stop, left, t, label, [end], looks(cell))
        for begin, stop in panels
    ]
    return figure(Markup("".join(drawn)), label)


def cycle_gantt(
    cell: Cell, periodic: PeriodicSchedule, t: Words, *, label: str, cycles: int = 2
) -> Markup:
    """The chart of a station that repeats over so many cycles, one drawing for all, for each cycle
    or for each part of one.
    """
    rows, length = steady_lanes(cell, periodic, cycles), exact(periodic.cycle_time)
    left = _left(rows, t)
    spans = [(bar.end - bar.start, f"{bar.task} {bar.mark}") for row in rows for bar in row.bars]
    count = _panels_wanted(spans, float(cycles * length), WIDTH - left - 22, most=120)
    parts = 1 if count == 1 else cycles * math.ceil(count / cycles)
    ends = [float(cycle * length) for cycle in range(1, cycles + 1)]
    moments = [float(cycles * length * part / parts) for part in range(parts + 1)]
    drawn = [
        _panel(rows, {}, begin, stop, left, t, label, ends, looks(cell), boundaries=True)
        for begin, stop in itertools.pairwise(moments)
    ]
    return figure(Markup("".join(drawn)), label)


def _left(rows: Sequence[Lane], t: Words) -> float:
    """Pixels for the names of the lanes."""
    wide = max(max(width_of(lane.look.label, 16), width_of(_busy(lane, t), 16)) for lane in rows)
    return min(24 + wide, 250.0)


def panel_times(schedule: Schedule, width: float) -> list[tuple[float, float]]:
    """The time axis in equal pieces, so many that most bars are wide enough for a short name."""
    end = makespan(schedule)
    if not len(schedule) or end <= 0:
        return [(0.0, 1.0)]
    count = _panels_wanted([(a.end - a.start, a.task) for a in schedule], end, width)
    if count == 1:
        return [(0.0, end)]
    step = 10 ** math.floor(math.log10(end / count)) / 5
    piece = math.ceil(end / count / step) * step
    return [(i * piece, (i + 1) * piece) for i in range(math.ceil(end / piece - 1e-9))]


def _panels_wanted(
    spans: Sequence[tuple[float, str]], end: float, width: float, *, most: float = 60
) -> int:
    """How many drawings of this width make most bars, of so many seconds and with these names,
    wide enough: for the name, if it takes no more than `most` pixels.
    """
    found = sorted(span / min(max(width_of(name, 16) + 6, 20), most) for span, name in spans)
    return min(MOST_PANELS, max(1, math.ceil(end / (width * found[len(found) // 8]) - 0.15)))


def _busy(lane: Lane, t: Words) -> str:
    return t("gantt.busy", seconds=t.seconds(lane.busy), share=t.share(lane.utilisation))


def _panel(
    rows: Sequence[Lane],
    slacks: dict[str, float],
    begin: float,
    stop: float,
    left: float,
    t: Words,
    label: str,
    ends: Sequence[float],
    order: dict[str, Look],
    *,
    boundaries: bool = False,
) -> Markup:
    scale = (WIDTH - left - 22) / (stop - begin)
    height = TOP + LANE * len(rows) + BOTTOM

    def x(moment: float) -> float:
        return left + (min(max(moment, begin), stop) - begin) * scale

    pieces = [_axis(begin, stop, x, len(rows), t)]
    for place, lane in enumerate(rows):
        pieces += _empty(lane, TOP + place * LANE, left, t)
    # a bar that runs on into the next cycle hides its end, so that the bar's name stays legible
    pieces += _lines(ends, "boundary", begin, stop, x, len(rows), t) if boundaries else []
    joints: dict[tuple[str, int | None], list[float]] = {}
    bars = []
    for place, lane in enumerate(rows):
        y = TOP + place * LANE
        for off in lane.shaded:
            if off.end > begin and off.start < stop:
                bars.append(_off(off, x(off.start), x(off.end), y + 9, t))
        bars += _waits(lane, begin, stop, x, y + 9 + BAR + 3)
        for bar in lane.bars:
            if bar.end > begin and bar.start < stop:
                bars.append(
                    _bar(
                        lane.look_of(bar),
                        bar,
                        x(bar.start),
                        x(bar.end),
                        y + 9,
                        slacks,
                        t,
                        hatch_id(lane.look, order, bar.product),
                    )
                )
                if bar.joint:
                    middle = (x(bar.start) + x(bar.end)) / 2
                    joints.setdefault((bar.task, bar.product), [middle]).append(y)
    for middle, *ys in joints.values():
        pieces.append(
            tag("line", x1=middle, x2=middle, y1=min(ys) + 9 + BAR, y2=max(ys) + 9, class_="joint")
        )
    pieces += bars  # over the links, which pass behind whoever takes no part
    pieces += [] if boundaries else _lines(ends, "end", begin, stop, x, len(rows), t)
    return tag(
        "svg",
        *pieces,
        viewBox=f"0 0 {WIDTH:g} {height:g}",
        width=WIDTH,
        height=height,
        role="img",
        aria_label=label,
        class_="gantt",
        xmlns="http://www.w3.org/2000/svg",
    )


def _waits(
    lane: Lane, begin: float, stop: float, x: Callable[[float], float], y: float
) -> list[Markup]:
    """A line for each wait before a task, as far as it lies in the panel."""
    return [
        tag("line", x1=x(moment), x2=x(bar.start), y1=y, y2=y, class_="wait")
        for bar in lane.bars
        for moment in bar.since
        if moment < stop and bar.start > begin
    ]


def _empty(lane: Lane, y: float, left: float, t: Words) -> list[Markup]:
    """A lane without its bars."""
    name = fitting([lane.look.label], left - 20)
    return [
        text(left - 10, y + 30, name, text_anchor="end", class_="lane-name"),
        text(left - 10, y + 50, _busy(lane, t), text_anchor="end", class_="faint"),
        tag("rect", x=left, y=y + 5, width=WIDTH - left - 22, height=LANE - 10, class_="lane"),
    ]


def _off(off: Shaded, x0: float, x1: float, y: float, t: Words) -> Markup:
    """A time without a task."""
    words = t(f"gantt.{off.kind}", why=off.what, start=t.number(off.start), end=t.number(off.end))
    fill = f"url(#fill-{off.shading.fill})"
    return tag("rect", tag("title", words), x=x0, y=y, width=x1 - x0, height=BAR, fill=fill)


def _lines(
    ends: Sequence[float],
    kind: str,
    begin: float,
    stop: float,
    x: Callable[[float], float],
    count: int,
    t: Words,
) -> list[Markup]:
    """Where something ends: a line through all lanes, and the time."""
    pieces = []
    for end in ends:
        if begin < end <= stop:
            low = TOP + LANE * count
            pieces.append(tag("line", x1=x(end), x2=x(end), y1=TOP - 8, y2=low, class_=kind))
            pieces.append(
                text(x(end), TOP - 12, t.seconds(end), text_anchor="end", class_="strong")
            )
    return pieces


def _bar(
    look: Look,
    bar: Bar,
    x0: float,
    x1: float,
    y: float,
    slacks: dict[str, float],
    t: Words,
    fill: str,
) -> Markup:
    key = "gantt.bar.critical" if bar.critical else "gantt.bar"
    details = t(
        key,
        task=bar.label,
        who=look.label,
        start=t.number(bar.start),
        end=t.number(bar.end),
        span=t.number(bar.end - bar.start),
    )
    if bar.product is not None:
        details += t("gantt.product", mark=bar.mark)
    elif not bar.critical:
        details += t("gantt.slack", slack=t.number(slacks[bar.task]))
    details += t("gantt.bar.joint") if bar.joint else ""
    details += (
        t("gantt.bar.deadline", deadline=t.number(bar.deadline)) if bar.deadline is not None else ""
    )
    pieces = [
        tag("title", details),
        tag(
            "rect",
            x=x0,
            y=y,
            width=max(x1 - x0, 0.5),
            height=BAR,
            fill=f"url(#{fill})",
            class_="critical" if bar.critical else "bar",
        ),
    ]
    room = x1 - x0 - 8
    whole = [w.split("\n") for w in wordings(bar) if w.count("\n") < 2]
    lines = next(
        (lines for lines in whole if all(width_of(line, 16) <= room for line in lines)), None
    )
    if lines is None:
        upright = next(
            (lines[0] for lines in whole if len(lines) == 1 and width_of(lines[0], 16) <= BAR - 4),
            "",
        )
        if upright and x1 - x0 >= 17:
            middle = ((x0 + x1) / 2 + 5.5, y + BAR / 2)
            turned = f"rotate(-90 {middle[0]:.2f} {middle[1]:.2f})"
            return tag(
                "g",
                *pieces,
                text(*middle, upright, text_anchor="middle", class_="on-bar", transform=turned),
                class_="task",
            )
        name = fitting([bar.task], room)
        lines = [name, bar.mark] if name and bar.mark and width_of(bar.mark, 16) <= room else [name]
    for place, line in enumerate(lines):
        shift = (place - (len(lines) - 1) / 2) * 18
        if line:
            back = width_of(line, 16) if look.hatch else 0
            if back:
                backing = min(back, x1 - x0 - 4)
                middle_x = (x0 + x1) / 2
                pieces.append(
                    tag(
                        "rect",
                        x=middle_x - backing / 2,
                        y=y + BAR / 2 + shift - 9,
                        width=backing,
                        height=18,
                        rx=3,
                        fill=look.tint,
                    )
                )
            pieces.append(
                text(
                    (x0 + x1) / 2,
                    y + BAR / 2 + 5.5 + shift,
                    line,
                    text_anchor="middle",
                    class_="on-bar",
                )
            )
    return tag("g", *pieces, class_="task")


def _axis(begin: float, stop: float, x: Callable[[float], float], count: int, t: Words) -> Markup:
    low = TOP + LANE * count
    pieces = []
    for moment in ticks(begin, stop, 12):
        pieces.append(tag("line", x1=x(moment), x2=x(moment), y1=TOP, y2=low + 5, class_="grid"))
        pieces.append(
            text(x(moment), low + 22, t.number(moment), text_anchor="middle", class_="faint")
        )
    middle = (x(begin) + x(stop)) / 2
    pieces.append(tag("line", x1=x(begin), x2=x(stop), y1=low, y2=low, class_="axis"))
    pieces.append(text(middle, low + 41, t("gantt.axis"), text_anchor="middle", class_="faint"))
    return tag("g", *pieces)
