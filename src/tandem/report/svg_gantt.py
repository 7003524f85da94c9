"""A Gantt chart as SVG for the page: text stays text, every bar explains itself, and a long one is
folded into panels.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from tandem.cell.model import Cell
from tandem.draw.gantt import wordings
from tandem.draw.lanes import Bar, Lane, lanes
from tandem.draw.style import Look, looks
from tandem.report.language import Words
from tandem.report.markup import Markup, figure, fitting, hatch_id, tag, text, ticks, width_of
from tandem.schedule.critical import slack
from tandem.schedule.measures import makespan
from tandem.schedule.model import Schedule

WIDTH = 1040.0
LANE, BAR = 70.0, 52.0
TOP, BOTTOM = 30.0, 44.0
MOST_PANELS = 12


def gantt(cell: Cell, schedule: Schedule, t: Words, *, label: str) -> Markup:
    """The chart, one drawing per panel."""
    end = makespan(schedule)
    rows = lanes(cell, schedule, until=end)
    left = 24 + max(
        max(width_of(lane.look.label, 16), width_of(_busy(lane, t), 16)) for lane in rows
    )
    left = min(left, 250.0)
    slacks = slack(cell, schedule)
    panels = panel_times(schedule, WIDTH - left - 22)
    drawn = [
        _panel(rows, slacks, begin, stop, left, t, label, end, looks(cell))
        for begin, stop in panels
    ]
    return figure(Markup("".join(drawn)), label)


def panel_times(schedule: Schedule, width: float) -> list[tuple[float, float]]:
    """The time axis in equal pieces, so many that most bars are wide enough for a short name."""
    end = makespan(schedule)
    spans = sorted((a.end - a.start) / min(max(width_of(a.task, 16) + 6, 20), 60) for a in schedule)
    if not spans or end <= 0:
        return [(0.0, 1.0)]
    count = min(MOST_PANELS, max(1, math.ceil(end / (width * spans[len(spans) // 8]) - 0.15)))
    if count == 1:
        return [(0.0, end)]
    step = 10 ** math.floor(math.log10(end / count)) / 5
    piece = math.ceil(end / count / step) * step
    return [(i * piece, (i + 1) * piece) for i in range(math.ceil(end / piece - 1e-9))]


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
    end: float,
    order: dict[str, Look],
) -> Markup:
    scale = (WIDTH - left - 22) / (stop - begin)
    height = TOP + LANE * len(rows) + BOTTOM

    def x(moment: float) -> float:
        return left + (min(max(moment, begin), stop) - begin) * scale

    pieces = [_axis(begin, stop, x, len(rows), t)]
    joints: dict[str, list[float]] = {}
    for place, lane in enumerate(rows):
        y = TOP + place * LANE
        pieces.append(
            text(
                left - 10,
                y + 30,
                fitting([lane.look.label], left - 20),
                text_anchor="end",
                class_="lane-name",
            )
        )
        pieces.append(text(left - 10, y + 50, _busy(lane, t), text_anchor="end", class_="faint"))
        pieces.append(
            tag("rect", x=left, y=y + 5, width=WIDTH - left - 22, height=LANE - 10, class_="lane")
        )
        for off in lane.shaded:
            if off.end > begin and off.start < stop:
                words = t(
                    f"gantt.{off.kind}",
                    why=off.what,
                    start=t.number(off.start),
                    end=t.number(off.end),
                )
                pieces.append(
                    tag(
                        "rect",
                        tag("title", words),
                        x=x(off.start),
                        y=y + 9,
                        width=x(off.end) - x(off.start),
                        height=BAR,
                        fill=f"url(#fill-{off.shading.fill})",
                    )
                )
        pieces += _waits(lane, begin, stop, x, y + 9 + BAR + 3)
        for bar in lane.bars:
            if bar.end > begin and bar.start < stop:
                pieces.append(
                    _bar(
                        lane.look,
                        bar,
                        x(bar.start),
                        x(bar.end),
                        y + 9,
                        slacks,
                        t,
                        hatch_id(lane.look, order),
                    )
                )
                if bar.joint:
                    joints.setdefault(bar.task, [(x(bar.start) + x(bar.end)) / 2]).append(y)
    for middle, *ys in joints.values():
        pieces.append(
            tag("line", x1=middle, x2=middle, y1=min(ys) + 9 + BAR, y2=max(ys) + 9, class_="joint")
        )
    if begin < end <= stop:
        pieces.append(
            tag("line", x1=x(end), x2=x(end), y1=TOP - 8, y2=TOP + LANE * len(rows), class_="end")
        )
        pieces.append(text(x(end), TOP - 12, t.seconds(end), text_anchor="end", class_="strong"))
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
    details += "" if bar.critical else t("gantt.slack", slack=t.number(slacks[bar.task]))
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
        lines = [fitting([bar.task], room)]
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


def _axis(begin: float, stop: float, x: object, count: int, t: Words) -> Markup:
    assert callable(x)
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
