"""What a Gantt chart shows, as plain data: the same lanes for matplotlib, SVG and the terminal."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from tandem.cell.model import Cell
from tandem.draw.style import Look, looks, shade, task_label
from tandem.schedule.critical import critical_path
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.measures import changeovers, exact, utilisation, working
from tandem.schedule.model import Schedule
from tandem.schedule.steady import rounds


@dataclass(frozen=True)
class Bar:
    """One task in one lane. `start`, `end` and `deadline` in seconds; `joint` when other lanes hold
    the same task too; `product` where several are assembled: 0 is launched with the first cycle
    that is shown, 1 a cycle later, -1 a cycle before.
    """

    task: str
    label: str
    start: float
    end: float
    joint: bool
    critical: bool
    deadline: float | None
    product: int | None = None

    @property
    def mark(self) -> str:
        """What tells the product: "#1", "#2" for those launched in the first and second cycle that
        are shown, "-1", "-2" for those launched one and two cycles before; else empty.
        """
        return "" if self.product is None else product_mark(self.product)


def product_mark(product: int) -> str:
    """What charts and sheets call a product of a station that repeats, counted as in a `Bar`."""
    return f"#{product + 1}" if product >= 0 else str(product)


@dataclass(frozen=True)
class Shading:
    """How a time without a task is shown.

    Attributes:
      fill: of what kind it looks: "break" or "changeover".
      hatch: matplotlib's notation for that.
    """

    fill: Literal["break", "changeover"]
    hatch: str


SHADINGS = {
    "break": Shading("break", "xxxx"),
    "setup": Shading("changeover", "...."),
    "changeover": Shading("changeover", "...."),
}
"""Kind of time off -> how it is shown; each has the words `picture.KIND` and `gantt.KIND`."""


@dataclass(frozen=True)
class Shaded:
    """A time in which an operator works on no task, seconds.

    Attributes:
      kind: a key of `SHADINGS`.
      tool: what is taken up; empty when it is no changeover.
    """

    start: float
    end: float
    kind: str
    tool: str = ""

    @property
    def shading(self) -> Shading:
        """How it is shown."""
        return SHADINGS[self.kind]


@dataclass(frozen=True)
class Lane:
    """One operator over time. `busy` seconds on tasks, `utilisation` as a share of the makespan; of
    a station that repeats, both of one cycle.
    """

    look: Look
    bars: tuple[Bar, ...]
    shaded: tuple[Shaded, ...]
    busy: float
    utilisation: float

    def look_of(self, bar: Bar) -> Look:
        """The operator's look, in the shade of the bar's product."""
        return self.look if bar.product is None else shade(self.look, bar.product)


def lanes(
    cell: Cell, schedule: Schedule, *, until: float, critical: bool = True
) -> tuple[Lane, ...]:
    """Every operator's lane, in the cell's order, also of those who do nothing.

    Args:
      until: where the time axis ends, seconds; breaks are cut there and later ones left out.
      critical: whether bars on the critical path are marked.
    """
    path = {link.assignment.task for link in critical_path(cell, schedule)} if critical else set()
    changes, busy, used = (
        changeovers(cell, schedule),
        working(cell, schedule),
        utilisation(cell, schedule),
    )
    found = []
    for name, look in looks(cell).items():
        bars = tuple(
            Bar(
                a.task,
                task_label(cell, a.task),
                a.start,
                a.end,
                len(a.operators) > 1,
                a.task in path,
                cell.tasks[a.task].deadline,
            )
            for a in schedule.of(name)
        )
        shaded = [
            Shaded(start, min(end, until), "break")
            for start, end in cell.operators[name].breaks
            if start < until
        ]
        shaded += [
            Shaded(c.start, c.end, "changeover", c.tool) for c in changes if c.operator == name
        ]
        if bars and (span := cell.operators[name].setting_up) is not None:
            shaded.append(Shaded(*span, "setup"))
        found.append(Lane(look, bars, tuple(shaded), busy[name], used[name]))
    return tuple(found)


def steady_lanes(cell: Cell, periodic: PeriodicSchedule, cycles: int = 2) -> tuple[Lane, ...]:
    """Every operator's lane over so many cycles of the steady state, from the launch of a product
    on: the bars and changeovers of all products that are in the station then. What begins before or
    ends after has its own start and end; charts cut it.
    """
    length, found = exact(periodic.cycle_time), []
    turned = rounds(cell, periodic)
    for name, look in looks(cell).items():
        bars, shaded = [], []
        for turn in turned[name].turns:
            a = turn.assignment
            for cycle in range(-1, cycles + 1):
                start = exact(turn.begin) + cycle * length
                end = start + exact(turn.seconds)
                if start < cycles * length and end > 0:
                    joint, label = len(a.operators) > 1, task_label(cell, a.task)
                    bars.append(
                        Bar(
                            a.task,
                            label,
                            float(start),
                            float(end),
                            joint,
                            critical=False,
                            deadline=None,
                            product=cycle - turn.lap,
                        )
                    )
                begin = start - exact(turn.change)
                if turn.change and begin < cycles * length and start > 0:
                    shaded.append(Shaded(float(begin), float(start), "changeover", turn.tool))
        bars.sort(key=lambda bar: (bar.start, bar.end))
        turns = turned[name]
        share = turns.share(turns.working)
        found.append(Lane(look, tuple(bars), tuple(shaded), turns.working, share))
    return tuple(found)


def products_shown(rows: Iterable[Lane]) -> list[int]:
    """The products in these lanes, the oldest first: a legend explains them."""
    return sorted({bar.product for lane in rows for bar in lane.bars if bar.product is not None})


def kinds_shaded(rows: Iterable[Lane]) -> list[str]:
    """The kinds of time without a task in these lanes, in the order of `SHADINGS`: a legend
    explains them.
    """
    there = {off.kind for lane in rows for off in lane.shaded}
    return [kind for kind in SHADINGS if kind in there]
