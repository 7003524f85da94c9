"""A Yamazumi chart as SVG for the page: each operator's work in a cycle as a stack, against the
cycle time and the takt.
"""

from __future__ import annotations

from tandem.cell.model import Cell
from tandem.draw.lanes import SHADINGS
from tandem.draw.style import looks
from tandem.draw.yamazumi import Block, Stack, names_in, stacks, words_at
from tandem.report.language import Words
from tandem.report.markup import Markup, figure, fitting, hatch_id, tag, text, ticks, width_of
from tandem.schedule.cycle import PeriodicSchedule

LEFT, TOP, HIGH, BOTTOM = 80.0, 34.0, 380.0, 78.0
STACK, GAP, LEAST = 200.0, 44.0, 460.0
"""Pixels across a stack, between stacks, and across the chart at least."""
LINE = 19.0
"""Pixels from one line of a name to the next."""


def yamazumi(
    cell: Cell, periodic: PeriodicSchedule, t: Words, *, takt: float | None, label: str
) -> Markup:
    """The chart. `takt`: seconds; a line is drawn there too."""
    piled = stacks(cell, periodic)
    width = max(LEAST, LEFT + GAP + (STACK + GAP) * len(piled))
    top = 1.06 * max(periodic.cycle_time, takt or 0.0)

    def y(seconds: float) -> float:
        return TOP + HIGH * (1 - seconds / top)

    pieces = []
    for value in ticks(0, top, 10):
        pieces.append(tag("line", x1=LEFT - 5, x2=width, y1=y(value), y2=y(value), class_="grid"))
        said = t.number(value)
        pieces.append(text(LEFT - 10, y(value) + 5.5, said, text_anchor="end", class_="faint"))
    for place, stack in enumerate(piled):
        x = LEFT + GAP + (STACK + GAP) * place
        fill = hatch_id(stack.look, looks(cell))
        for block in stack.blocks:
            pieces.append(_block(stack, block, x, y(block.high), y(block.low), fill, t))
        pieces += _foot(stack, x + STACK / 2, t)
    pieces.append(tag("path", d=f"M{LEFT:g},{TOP:g} V{y(0):g} H{width:g}", class_="axis"))
    middle = TOP + HIGH / 2
    pieces.append(
        text(
            20,
            middle,
            t("yamazumi.axis"),
            text_anchor="middle",
            transform=f"rotate(-90 20 {middle:g})",
        )
    )
    told = t("cycle.time", cycle_time=t.seconds(periodic.cycle_time))
    above = y(words_at(periodic.cycle_time, takt))
    pieces += _limit(y(periodic.cycle_time), above, told, width, "end")
    if takt is not None:
        pieces += _limit(y(takt), y(takt), t("cycle.takt", takt=t.seconds(takt)), width, "takt")
    height = TOP + HIGH + BOTTOM
    drawing = tag(
        "svg",
        *pieces,
        viewBox=f"0 0 {width:g} {height:g}",
        width=width,
        height=height,
        role="img",
        aria_label=label,
        class_="yamazumi",
        xmlns="http://www.w3.org/2000/svg",
    )
    return figure(drawing, label)


def _block(
    stack: Stack, block: Block, x: float, top: float, low: float, fill: str, t: Words
) -> Markup:
    """A task, or the walks and changeovers on top; its name where it is high enough for letters."""
    key = f"yamazumi.{block.kind or 'block'}"
    who, seconds = stack.look.label, t.seconds(block.seconds)
    title = t(key, task=block.label, who=who, seconds=seconds)
    paint = fill if block.task else f"fill-{SHADINGS[block.kind].fill}"
    pieces = [
        tag("title", title),
        tag("rect", x=x, y=top, width=STACK, height=low - top, fill=f"url(#{paint})", class_="bar"),
    ]
    lines = _lines(block, low - top, t)
    for place, line in enumerate(lines):
        middle = (top + low) / 2 + (place - (len(lines) - 1) / 2) * LINE
        if stack.look.hatch or not block.task:
            wide = min(width_of(line, 16), STACK - 4)
            pieces.append(
                tag(
                    "rect",
                    x=x + STACK / 2 - wide / 2,
                    y=middle - 9,
                    width=wide,
                    height=18,
                    rx=3,
                    fill=stack.look.tint if block.task else "#E9ECEF",
                )
            )
        pieces.append(
            text(x + STACK / 2, middle + 5.5, line, text_anchor="middle", class_="on-bar")
        )
    return tag("g", *pieces, class_="task")


def _lines(block: Block, high: float, t: Words) -> list[str]:
    """The fullest wording that fits into a block of so many pixels; nothing where none does."""
    room = STACK - 12
    for words in names_in(block, t):
        lines = words.split("\n")
        if len(lines) * LINE <= high and all(width_of(line, 16) <= room for line in lines):
            return lines
    cut = fitting(names_in(block, t)[-1:], room) if high >= LINE else ""
    return [cut] if cut else []


def _foot(stack: Stack, middle: float, t: Words) -> list[Markup]:
    """The operator, and below how much of the cycle is work and how much nothing."""
    own, low = stack.round, TOP + HIGH
    name = fitting([stack.look.label], STACK + GAP - 8)
    lines = [text(middle, low + 24, name, text_anchor="middle", class_="lane-name")]
    for place, (key, seconds) in enumerate(
        (("yamazumi.work", own.working), ("yamazumi.idle", own.idle))
    ):
        said = t(key, seconds=t.seconds(seconds), share=t.share(own.share(seconds)))
        at = low + 45 + 20 * place
        lines.append(text(middle, at, said, text_anchor="middle", class_="faint"))
    return lines


def _limit(y: float, above: float, says: str, width: float, kind: str) -> list[Markup]:
    """A line across all stacks, and what it is, above that height; the words of the takt stand on
    the right, so that they never meet those of the cycle time.
    """
    takt = kind == "takt"
    return [
        tag("line", x1=LEFT, x2=width, y1=y, y2=y, class_=kind),
        text(
            width - 4 if takt else LEFT + 6,
            above - 6,
            says,
            text_anchor="end" if takt else "start",
            class_="strong takt-words" if takt else "strong",
        ),
    ]
