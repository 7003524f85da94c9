"""What a Gantt chart shows, as plain data: the same lanes for matplotlib, SVG and the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Literal

from tandem.cell.model import Cell
from tandem.draw.style import Look, looks, shade, task_label
from tandem.schedule.critical import critical_path
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.measures import changeovers, exact, utilisation, walks, working
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.parts import Hold, holds
from tandem.schedule.steady import Turn, rounds


@dataclass(frozen=True)
class Bar:
    """One task in one lane. `start`, `end` and `deadline` in seconds; `joint` when other lanes hold
    the same task too; `since`: the moments from which its waits after other tasks count; `product`
    where several are assembled: 0 is launched with the first cycle that is shown, 1 a cycle later,
    -1 a cycle before.
    """

    task: str
    label: str
    start: float
    end: float
    joint: bool
    critical: bool
    deadline: float | None
    since: tuple[float, ...] = ()
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
      fill: of what kind it looks: "break", "changeover", "walk" or "hold".
      hatch: matplotlib's notation for that.
    """

    fill: Literal["break", "changeover", "walk", "hold"]
    hatch: str


SHADINGS = {
    "break": Shading("break", "xxxx"),
    "setup": Shading("changeover", "...."),
    "walk": Shading("walk", "||||"),
    "changeover": Shading("changeover", "...."),
    "hold": Shading("hold", ".."),
}
"""Kind of time off -> how it is shown; each has the words `picture.KIND` and `gantt.KIND`."""


@dataclass(frozen=True)
class Shaded:
    """A time in which an operator works on no task, seconds.

    Attributes:
      kind: a key of `SHADINGS`.
      what: the tool that is taken up, or the place to which somebody walks; else empty.
    """

    start: float
    end: float
    kind: str
    what: str = ""

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
    busy, used = working(cell, schedule), utilisation(cell, schedule)
    before = [
        *((w.operator, Shaded(w.start, w.end, "walk", w.place)) for w in walks(cell, schedule)),
        *(
            (c.operator, Shaded(c.start, c.end, "changeover", c.tool))
            for c in changeovers(cell, schedule)
        ),
    ]
    rows = {a.task: a for a in schedule}
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
                tuple(_waited_from(cell, a.task, rows)),
            )
            for a in schedule.of(name)
        )
        shaded = [
            Shaded(start, min(end, until), "break")
            for start, end in cell.operators[name].breaks
            if start < until
        ]
        shaded += [piece for who, piece in before if who == name]
        if bars and (span := cell.operators[name].setting_up) is not None:
            shaded.append(Shaded(*span, "setup"))
        shaded += _holding(name, bars, shaded, holds(cell, schedule))
        found.append(Lane(look, bars, tuple(shaded), busy[name], used[name]))
    return tuple(found)


def _holding(
    name: str, bars: Iterable[Bar], shaded: Iterable[Shaded], found: Iterable[Hold]
) -> list[Shaded]:
    """When the machine holds a part and does nothing."""
    taken = sorted([*((b.start, b.end) for b in bars), *((s.start, s.end) for s in shaded)])
    idle = []
    for hold in found:
        start = hold.first.start
        for begin, end in [*taken, (hold.last.end, hold.last.end)] if hold.machine == name else ():
            if end > start:
                stop = min(begin, hold.last.end)
                if stop > start:
                    idle.append(Shaded(start, stop, "hold"))
                start = max(start, end)
    return idle


def steady_lanes(cell: Cell, periodic: PeriodicSchedule, cycles: int = 2) -> tuple[Lane, ...]:
    """Every operator's lane over so many cycles of the steady state, from the launch of a product
    on: the bars, walks and changeovers of all products that are in the station then, and when a
    machine holds a part of one. What begins before or ends after has its own start and end; charts
    cut it.
    """
    length, found = exact(periodic.cycle_time), []
    until = cycles * length
    turned = rounds(cell, periodic)
    held = [
        hold.later(float(product * length))
        for hold in holds(cell, periodic.schedule)
        for product in range(-periodic.in_process, cycles)
    ]
    for name, look in looks(cell).items():
        bars: list[Bar] = []
        shaded: list[Shaded] = []
        turns = turned[name]
        for turn in turns.turns:
            a = turn.assignment
            for cycle in range(-1, cycles + 1):
                start = exact(turn.begin) + cycle * length
                end = start + exact(turn.seconds)
                if start < until and end > 0:
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
                shaded += _before(turn, start)
        shaded = [off for off in shaded if off.start < until and off.end > 0]
        bars.sort(key=lambda bar: (bar.start, bar.end))
        shaded += [
            replace(off, start=max(off.start, 0.0), end=min(off.end, float(until)))
            for off in _holding(name, bars, shaded, held)
            if off.start < until and off.end > 0
        ]
        share = turns.share(turns.working)
        found.append(Lane(look, tuple(bars), tuple(shaded), turns.working, share))
    return tuple(found)


def _before(turn: Turn, start: Decimal) -> Iterator[Shaded]:
    """The walk and the changeover directly before a task that starts then."""
    ready = turn.ready
    there = start - exact(ready.change)
    if ready.walk:
        begin = there - exact(ready.walk)
        yield Shaded(float(begin), float(there), "walk", ready.place)
    if ready.change:
        yield Shaded(float(there), float(start), "changeover", ready.tool)


def products_shown(rows: Iterable[Lane]) -> list[int]:
    """The products in these lanes, the oldest first: a legend explains them."""
    return sorted({bar.product for lane in rows for bar in lane.bars if bar.product is not None})


def kinds_shaded(rows: Iterable[Lane]) -> list[str]:
    """The kinds of time without a task in these lanes, in the order of `SHADINGS`: a legend
    explains them.
    """
    there = {off.kind for lane in rows for off in lane.shaded}
    return [kind for kind in SHADINGS if kind in there]


def _waited_from(cell: Cell, task: str, rows: Mapping[str, Assignment]) -> Iterator[float]:
    for wait in cell.tasks[task].wait:
        if wait.at_least or wait.at_most is not None:
            first = rows[wait.after]
            yield first.start if wait.between == "start-start" else first.end
