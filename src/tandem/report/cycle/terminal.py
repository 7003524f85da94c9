"""A front of cycle times in the terminal: a table of its points, and of one of them two cycles in
characters, the load of each operator and which number to plan with.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from tandem.cell.model import Cell
from tandem.draw.imprint import imprint
from tandem.draw.lanes import Lane, product_mark, products_shown, steady_lanes
from tandem.draw.style import looks
from tandem.plan.cycle.result import CycleFront, CycleResult
from tandem.plan.result import Status
from tandem.report.cycle.told import (
    cost,
    crew,
    in_process,
    limits,
    listed,
    more,
    per_hour,
    title,
    which,
)
from tandem.report.language import Words, words
from tandem.report.terminal import MOST_PANELS, LanesText, bounded, points_table
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.steady import rounds

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderResult
    from rich.table import Table

CYCLES = 2


class CycleView:
    """Everything the terminal says about a front of cycle times: a headline, the table, two cycles
    of one point, its load and its digest.

    Args:
      point: counted from 1; the knee when not given.
      stale: the cell has changed since; the last line says so.
    """

    def __init__(
        self,
        front: CycleFront,
        *,
        language: str = "en",
        point: int | None = None,
        stale: bool = False,
    ):
        self.front, self.language, self.point, self.stale = front, language, point, stale

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich.text import Text

        front, t = self.front, words(self.language)
        yield Text(headline(front, t))
        if not len(front):
            return
        yield cycle_table(front, width=options.max_width, language=self.language)
        for line in remarks(front, t):
            yield Text(line)
        result = front.shown(self.point)
        place = front.knee_place if self.point is None else self.point - 1
        yield Text(title(front, place, t, knee=True), style="bold")
        yield CycleText(front.cell, result.periodic, language=self.language)
        yield Text(more(front, result, t))
        for line in load(result, t):
            yield Text(line)
        yield Text(which(front, result, t))
        yield Text(imprint(result, t, stale=self.stale), style="dim")


def headline(front: CycleFront, t: Words) -> str:
    """One sentence: what was found, and how far it is proven."""
    cell, asked = front.cell, limits(front, t, within=True)
    proof = "open" if front.ended_by == "work" else front.ended_by
    return t(
        "cycle.found",
        name=cell.name or t("terminal.unnamed"),
        counts=", ".join([t.count("task", len(cell.tasks)), *crew(cell, t)]),
        points=t.count("terminal.points", len(front)),
        within=t("terminal.within", limits=listed(asked, t)) if asked else "",
        proof=t(f"terminal.{proof}"),
        seconds=t.seconds(round(front.wall_s, 2)),
        solver=front.solver,
    )


def remarks(front: CycleFront, t: Words) -> list[str]:
    """What is to be said of a front that is not all that it could be: which points time has cut
    short, and which proven ones may have another pattern in the next run.
    """
    places = list(enumerate(front, 1))
    cut = [str(place) for place, r in places if r.status != Status.OPTIMAL]
    loose = [str(p) for p, r in places if r.status == Status.OPTIMAL and not r.canonical]
    found = {"cut": cut if front.ended_by == "time" else [], "loose": loose}
    return [
        t(f"cycle.{key}", points=t.count("points", len(names), names=", ".join(names)))
        for key, names in found.items()
        if names
    ]


def cycle_table(front: CycleFront, *, width: int = 80, language: str = "en") -> Table:
    """The points as a table that fits into `width` characters: cycle time, stress, makespan, how
    many in process and finished in an hour, how far proven, and who does what in short.
    """
    t = words(language)
    heads = [
        (t("cycle.head.time"), "right"),
        (t("front.stress"), "right"),
        (t("cycle.head.makespan"), "right"),
        (t("cycle.head.in_process"), "right"),
        (t("cycle.head.per_hour"), "right"),
        *([(t("front.cost"), "right")] if front.cell.cost is not None else []),
        (t("front.status"), ""),
    ]
    rows = []
    for r in front:
        proven = r.status == Status.OPTIMAL
        least = (r.cycle_time, r.stress) if proven else (r.bound.cycle_time, r.bound.stress)
        rows.append(
            (
                bounded(r.cycle_time, least[0], t),
                bounded(r.stress, least[1], t),
                t.number(r.makespan),
                in_process(r, t),
                t.number(per_hour(front, r)),
                *(t.number(each) for each in [cost(front, r)] if each is not None),
                t("front.proven") if proven else t("terminal.gap", gap=t.share(r.gap)),
            )
        )
    return points_table(front, heads, rows, width=width, language=language)


def load(result: CycleResult, t: Words) -> list[str]:
    """Of each operator, how much of the cycle is work and how much is idle."""
    found, shown = [], looks(result.cell)
    for name, own in rounds(result.cell, result.periodic).items():
        told = {
            "who": shown[name].label,
            "work": f"{t.seconds(own.working)} ({t.share(own.share(own.working))})",
            "change": t.seconds(own.changing),
            "walk": t.seconds(own.walking),
            "idle": f"{t.seconds(own.idle)} ({t.share(own.share(own.idle))})",
            "cycle_time": t.seconds(own.length),
        }
        key = "cycle.load" + ".walk" * bool(own.walking) + ".change" * bool(own.changing)
        found.append(t(key, **told))
    return found


class CycleText:
    """Two cycles of the steady state as lanes of characters, side by side where they fit, else
    below each other; an edge stands between them.

    A bar begins with an edge, the task's name and the mark of its product; the fill of products
    alternates.
    """

    def __init__(self, cell: Cell, periodic: PeriodicSchedule, *, language: str = "en"):
        self.cell, self.periodic, self.words = cell, periodic, words(language)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich.text import Text

        rows = steady_lanes(self.cell, self.periodic, CYCLES)
        chart = LanesText(self.cell, rows, options, self.words)
        yield from chart.lines(self._folded(rows, chart.width))
        yield from chart.notes()
        length = self.periodic.cycle_time
        launched = [
            self.words(
                "cycle.product",
                mark=product_mark(product),
                moment=self.words.seconds(product * length),
            )
            for product in products_shown(rows)
        ]
        yield Text(", ".join(launched), style="dim")
        yield from chart.names()

    def _folded(self, rows: tuple[Lane, ...], width: int) -> list[list[tuple[float, float]]]:
        """The cycles side by side when a typical bar can then hold its name and mark, else each in
        as many pieces of one length as that takes.
        """
        length = self.periodic.cycle_time
        spans = sorted(
            (bar.end - bar.start) / (len(f"{bar.task} {bar.mark}") + 1)
            for row in rows
            for bar in row.bars
        )
        typical = spans[len(spans) // 4]
        beside = (width - CYCLES + 1) // CYCLES
        if length / (beside * typical) <= 1.1:
            return [[(cycle * length, (cycle + 1) * length) for cycle in range(CYCLES)]]
        wanted = math.ceil(length / (width * typical) - 0.1)
        parts = min(MOST_PANELS // CYCLES, max(1, wanted))
        piece = length / parts
        return [[(part * piece, (part + 1) * piece)] for part in range(CYCLES * parts)]
