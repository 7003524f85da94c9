"""The precedence graph as SVG for the page."""

from __future__ import annotations

import math

from tandem.cell.model import Cell
from tandem.draw.graph import HALF_HEIGHT, HALF_WIDTH, Chip, arrow_curve, chips, critical_pairs
from tandem.draw.layers import Layers, layers
from tandem.draw.style import looks, task_label
from tandem.report.language import Words
from tandem.report.markup import Markup, figure, fitting, hatch_id, tag, text, width_of
from tandem.report.waits import wait_words

COLUMN, ROW = 236.0, 88.0
TILE = (6, 8)
"""Columns and rows of a piece of a large graph that fills a printed page."""


def graph(cell: Cell, t: Words) -> Markup:
    """The graph; a node says who can do the task and in how many seconds."""
    drawn = layers(cell)
    columns, rows = drawn.extent
    width, height = columns * COLUMN, rows * ROW + 6
    marker = tag(
        "marker",
        tag("path", d="M0,0 L9,4 L0,8 z", class_="tip"),
        id="tip",
        viewBox="0 0 9 8",
        refX=9,
        refY=4,
        markerWidth=9,
        markerHeight=8,
        orient="auto",
        markerUnits="userSpaceOnUse",
    )
    bold = marker.replace('id="tip"', 'id="tip-bold"').replace('class="tip"', 'class="tip bold"')
    pieces = [
        *_arrows(drawn),
        *(
            _node(cell, task, drawn.at[task], t, critical=task in drawn.critical)
            for task in cell.tasks
        ),
    ]
    drawing = tag(
        "svg",
        tag("defs", marker, Markup(bold)),
        tag("g", *pieces, id="graph-drawing"),
        viewBox=f"0 0 {width:.0f} {height:.0f}",
        width=width,
        height=height,
        role="img",
        aria_label=t("graph.chart"),
        class_="graph small" if width < 1040 else "graph",
        xmlns="http://www.w3.org/2000/svg",
    )
    shown = figure(drawing, t("graph.chart"))
    if columns <= TILE[0] and rows <= TILE[1]:
        return shown
    return tag(
        "div",
        shown,
        tag("div", *_tiles(drawn, t), class_="tiles", aria_hidden="true"),
        class_="tiled",
    )


def _tiles(drawn: Layers, t: Words) -> list[Markup]:
    """The same drawing in pieces that can be read on paper; pieces without a task are left out."""
    (columns, rows), (across, down) = drawn.extent, TILE
    corners = [
        (x, y)
        for y in range(0, math.ceil(rows), down)
        for x in range(0, math.ceil(columns), across)
    ]
    held = [
        (
            x,
            [
                b
                for a, b in drawn.at.values()
                if x - 0.5 <= a < x + across - 0.5 and y - 0.5 <= b < y + down - 0.5
            ],
        )
        for x, y in corners
    ]
    filled = [(x, min(heights), max(heights)) for x, heights in held if heights]
    found = []
    for place, (x, top, bottom) in enumerate(filled, 1):
        box = (
            f"{x * COLUMN:.0f} {top * ROW:.0f} {COLUMN * across:.0f}"
            f" {(bottom - top + 1) * ROW + 6:.0f}"
        )
        drawing = tag(
            "svg",
            tag("use", href="#graph-drawing"),
            viewBox=box,
            class_="graph",
            xmlns="http://www.w3.org/2000/svg",
        )
        found.append(
            tag("figure", tag("figcaption", t("graph.part", n=place, of=len(filled))), drawing)
        )
    return found


def _at(column: float, row: float) -> tuple[float, float]:
    return (column + 0.5) * COLUMN, (row + 0.5) * ROW + 3


def _arrows(drawn: Layers) -> list[Markup]:
    strong = critical_pairs(drawn)
    found = []
    for pair, points in sorted(drawn.arrows.items(), key=lambda item: item[0] in strong):
        (x, y), *rest = [_at(*point) for point in arrow_curve(points)]
        curve = f"M{x:.1f},{y:.1f} C" + " ".join(f"{a:.1f},{b:.1f}" for a, b in rest)
        bold = pair in strong
        found.append(
            tag(
                "path",
                d=curve,
                class_="arrow bold" if bold else "arrow",
                marker_end=f"url(#{'tip-bold' if bold else 'tip'})",
            )
        )
    return found


def _node(cell: Cell, task: str, at: tuple[float, float], t: Words, *, critical: bool) -> Markup:
    x, y = _at(*at)
    half, high = HALF_WIDTH * COLUMN, HALF_HEIGHT * ROW
    label = task_label(cell, task)
    after = ", ".join(cell.tasks[task].predecessors)
    waits = "".join(f"; {said}" for said in wait_words(cell, task, t))
    details = (
        t("graph.node.after", task=label, after=after) if after else t("graph.node", task=label)
    ) + waits
    named = f"{task}: {label}" if label != task else task
    pieces = [
        tag("title", details),
        tag(
            "rect",
            x=x - half,
            y=y - high,
            width=2 * half,
            height=2 * high,
            rx=3,
            class_="node critical" if critical else "node",
        ),
        text(
            x,
            y - high + 23,
            fitting([named, task], 2 * half - 10),
            text_anchor="middle",
            class_="strong",
        ),
    ]
    found = chips(cell, task, t)
    each = (2 * half - 6 - 4 * (len(found) - 1)) / len(found)
    for place, chip in enumerate(found):
        pieces += _chip(cell, chip, x - half + 3 + place * (each + 4), y, each, high - 3, task)
    return tag("g", *pieces, class_="task")


def _chip(
    cell: Cell, chip: Chip, x: float, y: float, width: float, height: float, task: str
) -> list[Markup]:
    order = looks(cell)
    part = width / max(len(chip.looks), 1)
    pieces = [
        tag(
            "rect",
            x=x + i * part,
            y=y,
            width=part,
            height=height,
            fill=f"url(#{hatch_id(look, order)})",
        )
        for i, look in enumerate(chip.looks)
    ]
    shown = fitting([chip.words, chip.words.split()[0]], width - 4)
    back = min(width_of(shown, 16), width)
    if shown and any(look.hatch for look in chip.looks):
        pieces.append(
            tag(
                "rect",
                x=x + (width - back) / 2,
                y=y + height / 2 - 9,
                width=back,
                height=18,
                rx=3,
                fill="#FFFFFF",
                fill_opacity="0.85",
            )
        )
    pieces.append(
        text(x + width / 2, y + height / 2 + 5.5, shown, text_anchor="middle", class_="on-bar")
    )
    return pieces


def chain_words(cell: Cell, t: Words) -> str:
    """A sentence on the longest chain."""
    drawn = layers(cell)
    names = (
        [*drawn.critical[:8], "…", *drawn.critical[-4:]]
        if len(drawn.critical) > 14
        else list(drawn.critical)
    )
    return t(
        "graph.chain",
        seconds=t.seconds(drawn.critical_s),
        chain=" → ".join(names),
        n=t.number(len(drawn.critical)),
    )
