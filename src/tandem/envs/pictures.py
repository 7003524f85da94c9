"""A station's schedule so far, as text for terminals and as an array of pixels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tandem.cell.model import Cell
from tandem.schedule.model import Schedule

WIDEST = 100
"""Characters that a lane may take."""


def text_gantt(cell: Cell, schedule: Schedule, now: float) -> str:
    """A lane per operator, a character per second (more seconds when it would be too wide):
    `1=======|` is task 1 done by a human.

    Humans' bars are filled with `=`, those of robots and machines with `-`; the first line
    holds the seconds.
    """
    scale = max(1.0, now / WIDEST)
    width = round(now / scale)
    margin = max(len(name) for name in cell.operators) + 1
    lines = [" " * margin + _axis(width, scale)]
    for name, operator in cell.operators.items():
        lane = [" "] * width
        for row in schedule.of(name):
            begin, end = round(row.start / scale), round(row.end / scale)
            room = max(end - begin, 0)
            fill = "=" if operator.kind == "human" else "-"
            bar = (row.task + fill * room)[: max(room - 1, 0)] + "|" * (room > 0)
            lane[begin:end] = bar
        lines.append(f"{name:<{margin}}{''.join(lane)}".rstrip())
    return "\n".join(lines) + "\n"


def _axis(width: int, scale: float) -> str:
    line = ""
    for place in range(0, width + 1, 10):
        line = line.ljust(place) + f"{place * scale:.4g}"
    return line


def rgb_gantt(cell: Cell, schedule: Schedule, now: float, stress: float) -> NDArray[np.uint8]:
    """`[height, width, 3]`, the Gantt chart of `tandem.draw` at 100 dots per inch. Needs
    matplotlib.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from tandem.draw.gantt import plot_gantt

    figure = Figure(figsize=(8, 2.4), dpi=100, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    total = sum(max(task.time.values(), default=0.0) for task in cell.tasks.values())
    plot_gantt(
        cell,
        schedule,
        figure.subplots(),
        critical=False,
        until=max(now, total / 2),
        title=f"{now:g} s, stress {stress:g}",
        legend=False,
    )
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()
