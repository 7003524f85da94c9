"""A front in the terminal: a table of its points, a Gantt chart in characters, and what a method
knows while it works.

Colour is never the only sign: humans and robots differ in the fill of their bars too, and the
critical path is named. rich leaves colours out when the output is no terminal, with NO_COLOR and
with TERM=dumb; where the encoding has no block characters, plain ASCII stands for them.
"""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from tandem.cell.model import Cell
from tandem.cell.written import number, seconds, share
from tandem.draw.lanes import SHADINGS, Lane, kinds_shaded, lanes
from tandem.draw.style import looks, shorten, task_label
from tandem.plan.result import Front, Result, Status
from tandem.schedule.critical import critical_path
from tandem.schedule.measures import makespan
from tandem.schedule.model import Schedule

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
    from rich.table import Table
    from rich.text import Text

MOST_PANELS = 8
COLOURS = {
    "human": ("yellow", "magenta", "red", "bright_yellow"),
    "robot": ("cyan", "green", "blue", "bright_cyan"),
}


class FrontView:
    """Everything the terminal says about a front: a headline, the table, the Gantt chart of the
    knee.
    """

    def __init__(self, front: Front):
        self.front = front

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich.text import Text

        front = self.front
        yield Text(headline(front))
        if not len(front):
            return
        yield front_table(front, width=options.max_width)
        for line in remarks(front):
            yield Text(line)
        knee = front.results.index(front.knee)
        words = (
            f"Point {knee + 1}: makespan {seconds(front[knee].makespan)}, stress"
            f" {number(front[knee].stress)}"
        )
        yield Text(words + (", the recommended compromise" if len(front) > 2 else ""), style="bold")
        yield GanttText(front.cell, front[knee].schedule)


def headline(front: Front) -> str:
    """One sentence: what was found, and how far it is proven."""
    cell, name = front.cell, front.cell.name or "Cell"
    people = [
        _count(len(names), noun)
        for names, noun in ((cell.humans, "human"), (cell.robots, "robot"))
        if names
    ]
    proof = (
        "complete and proven"
        if front.complete
        else "interrupted, not complete"
        if front.interrupted
        else "not complete, time ran out"
        if front.ended_by == "time"
        else "not complete"
    )
    within = f" within {' and '.join(front.question.limits)}" if front.question.limits else ""
    found = (
        f"{_count(len(front), 'point')} on the front{within}, {proof},"
        f" {number(round(front.wall_s, 2))} s, {front.solver}"
    )
    return f"{name} ({', '.join([_count(len(cell.tasks), 'task'), *people])}): {found}."


def remarks(front: Front) -> list[str]:
    """What is to be said of a front that is not all that it could be: which points time has cut
    short, and which proven ones may have another schedule in the next run.
    """
    places = list(enumerate(front, 1))
    cut = [place for place, r in places if r.status != Status.OPTIMAL]
    loose = [place for place, r in places if r.status == Status.OPTIMAL and not r.canonical]
    lines = []
    if cut and front.ended_by == "time":
        lines.append(
            f"Not proven because time ran out: {_points(cut)}; with a longer --time-limit more is."
        )
    if loose:
        lines.append(f"Another run may show another schedule of the same values: {_points(loose)}.")
    return lines


def _points(places: list[int]) -> str:
    return f"point{'s' * (len(places) > 1)} {', '.join(map(str, places))}"


def front_table(front: Front, *, width: int = 80) -> Table:
    """The points as a table that fits into `width` characters: makespan, stress, how far proven,
    and who does what in short.

    The knee has a star. Bounds stand behind a value that is not proven.
    """
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table
    from rich.text import Text

    table = Table(box=SIMPLE_HEAD, pad_edge=False, header_style="bold")
    table.add_column("", no_wrap=True)
    table.add_column(escape("makespan [s]"), justify="right", no_wrap=True)
    table.add_column("stress", justify="right", no_wrap=True)
    table.add_column("status", no_wrap=True)
    rows = [
        (_bounded(r.makespan, r.bound.makespan), _bounded(r.stress, r.bound.stress), status(r))
        for r in front
    ]
    taken = 6 + sum(
        2 + max([len(head), *(len(row[i]) for row in rows)])
        for i, head in enumerate(("makespan [s]", "stress", "status"))
    )
    shown = list(looks(front.cell).values())
    room = (width - taken) // len(shown) - 2
    shown = shown if room >= 8 else []
    for look in shown:
        table.add_column(
            escape(shorten(look.label, max(room, 8), "..")),
            overflow="fold",
            style=_colour(front.cell, look.operator),
        )
    knee = front.knee if len(front) > 2 else None
    for place, (result, row) in enumerate(zip(front, rows, strict=True), 1):
        cells = [
            Text(
                tasks_in_short(
                    result.schedule, look.operator, room, lines=3 if len(front) <= 10 else 1
                )
            )
            for look in shown
        ]
        table.add_row(
            f"{place}{'*' if result is knee else ''}",
            *row,
            *cells,
            style="bold" if result is knee else "",
        )
    if knee is not None:
        table.caption, table.caption_justify = "* knee: the recommended compromise", "left"
    return table


def status(result: Result) -> str:
    """Proven, or how far the makespan is from its bound."""
    return "proven" if result.status == Status.OPTIMAL else f"gap {share(result.gap)}"


def _bounded(value: float, bound: float) -> str:
    return number(value) if bound >= value else f"{number(value)} (>= {number(round(bound, 2))})"


def tasks_in_short(schedule: Schedule, operator: str, room: int, *, lines: int = 1) -> str:
    """The operator's tasks in order when so many lines of `room` characters hold them, else how
    many there are. `+` marks a joint task.
    """
    names = [a.task + ("+" if len(a.operators) > 1 else "") for a in schedule.of(operator)]
    if not names:
        return "-"
    folded = textwrap.wrap(" ".join(names), room, break_long_words=False, break_on_hyphens=False)
    fits = len(folded) <= lines and max(map(len, folded)) <= room
    return "\n".join(folded) if fits else _count(len(names), "task")


class GanttText:
    """A schedule as lanes of characters, as wide as the console; it is folded into several panels
    when tasks would get too narrow.

    A bar begins with an edge and the task's name; humans' bars are solid, robots' shaded. `x` is a
    break, `~` a tool changeover.
    """

    def __init__(self, cell: Cell, schedule: Schedule, *, critical: bool = True):
        self.cell, self.schedule, self.critical = cell, schedule, critical

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich.text import Text

        if not len(self.schedule):
            yield Text("nobody does anything")
            return
        marks = _Marks(plain=not _can_print(options.encoding, _Marks(plain=False)))
        rows = lanes(
            self.cell, self.schedule, until=makespan(self.schedule), critical=self.critical
        )
        room = max(4, min(18, options.max_width // 4))
        names = [shorten(lane.look.label, room, marks.ellipsis) for lane in rows]
        left = max(map(len, names)) + 2
        width = max(10, min(options.max_width, 160) - left - 1)
        for begin, end in self._panels(width):
            scale = width / (end - begin)
            for name, lane in zip(names, rows, strict=True):
                line = Text(name.ljust(left - 1) + marks.edge, no_wrap=True, overflow="crop")
                line.append_text(
                    _lane_text(
                        lane,
                        begin,
                        end,
                        scale,
                        width,
                        marks,
                        _colour(self.cell, lane.look.operator),
                    )
                )
                line.append(marks.edge)
                yield line
            yield Text(
                " " * left + _axis(begin, end, scale, width),
                style="dim",
                no_wrap=True,
                overflow="crop",
            )
        yield from self._notes(rows, marks, options.max_width)

    def _panels(self, width: int) -> list[tuple[float, float]]:
        """The time axis in pieces of the same length, so many that a typical bar can hold its
        name.
        """
        end = makespan(self.schedule)
        spans = sorted((a.end - a.start) / (len(a.task) + 1) for a in self.schedule)
        wanted = width * spans[len(spans) // 12]
        count = min(MOST_PANELS, max(1, math.ceil(end / wanted - 0.1)))
        piece = end / count
        if count > 1:
            step = 10 ** math.floor(math.log10(piece)) / 5
            piece = math.ceil(piece / step) * step
        return [
            (i * piece, min((i + 1) * piece, end) if count == 1 else (i + 1) * piece)
            for i in range(math.ceil(end / piece - 1e-9))
        ]

    def _notes(self, rows: Iterable[Lane], marks: _Marks, width: int) -> Iterator[RenderableType]:
        from rich.text import Text

        rows = list(rows)
        parts = [f"{marks.human} human", f"{marks.robot} robot"]
        parts += ["+ joint task"] if any(bar.joint for lane in rows for bar in lane.bars) else []
        parts += [
            f"{marks.shaded[SHADINGS[kind].fill]} {SHADINGS[kind].word}"
            for kind in kinds_shaded(rows)
        ]
        yield Text("  ".join(parts), style="dim")
        if self.critical:
            chain = [link.assignment.task for link in critical_path(self.cell, self.schedule)]
            arrow = f" {marks.arrow} "
            if len(arrow.join(chain)) > 3 * width:
                chain = [*chain[:8], marks.ellipsis, *chain[-8:]]
            yield Text(f"critical path: {arrow.join(chain)}")
        named = [
            bar
            for bar in {bar.task: bar for lane in rows for bar in lane.bars}.values()
            if bar.label != bar.task
        ]
        if named and len(named) <= 24:
            yield Text(
                "tasks: "
                + ", ".join(f"{bar.task} = {task_label(self.cell, bar.task)}" for bar in named),
                style="dim",
            )


class _Marks:
    """The characters of a chart; `plain` keeps to ASCII."""

    def __init__(self, *, plain: bool):
        self.human, self.robot = ("#", "=") if plain else ("█", "░")
        self.bar, self.edge = ("[", "|") if plain else ("▐", "│")
        self.arrow, self.ellipsis = ("->", "..") if plain else ("→", "…")
        self.pause, self.swap = ("x", "~") if plain else ("╳", "~")

    @property
    def shaded(self) -> dict[str, str]:
        """The sign of each fill of a time without a task."""
        return {"break": self.pause, "changeover": self.swap}


def _can_print(encoding: str | None, marks: _Marks) -> bool:
    try:
        "".join(vars(marks).values()).encode(encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def _lane_text(
    lane: Lane, begin: float, end: float, scale: float, width: int, marks: _Marks, colour: str
) -> Text:
    """One lane of one panel, exactly `width` characters."""
    from rich.text import Text

    signs, styles = [" "] * width, [""] * width
    fill = marks.human if lane.look.kind == "human" else marks.robot

    def columns(start: float, stop: float) -> range:
        first, last = (
            round((max(start, begin) - begin) * scale),
            round((min(stop, end) - begin) * scale),
        )
        return (
            range(min(first, width - 1), max(last, min(first, width - 1) + 1))
            if start < end and stop > begin
            else range(0)
        )

    for off in lane.shaded:
        for x in columns(off.start, off.end):
            signs[x], styles[x] = marks.shaded[off.shading.fill], "dim"
    for bar in lane.bars:
        places = columns(bar.start, bar.end)
        strong = f"bold {colour}" if bar.critical else colour
        name = bar.task + ("+" if bar.joint else "")
        edge = marks.bar if bar.start >= begin else ""
        room = len(places) - len(edge)
        words = edge + (shorten(name, room, marks.ellipsis) if room >= min(len(name), 4) else "")
        for place, x in enumerate(places):
            inside = place < len(words)
            signs[x] = words[place] if inside else fill
            styles[x] = (
                ("bold" if bar.critical else "") if inside and words[place] != marks.bar else strong
            )
    text = Text(no_wrap=True)
    for style, run in itertools.groupby(zip(signs, styles, strict=True), key=lambda pair: pair[1]):
        text.append("".join(sign for sign, _ in run), style=style)
    return text


def _axis(begin: float, end: float, scale: float, width: int) -> str:
    """Numbers under a panel; the last one has the unit."""
    span = end - begin
    step = next(
        s
        for power in range(-3, 9)
        for s in (10**power, 2 * 10**power, 5 * 10**power)
        if s * scale >= 8
    )
    line = [" "] * (width + 8)
    for i in range(math.ceil(begin / step - 1e-9), math.floor(end / step + 1e-9) + 1):
        label = number(i * step)
        at = round((i * step - begin) * scale)
        if at + len(label) <= width - 7 or span < step:
            line[at : at + len(label)] = label
    last = seconds(end)
    at = width - len(last) + 1
    line[at : at + len(last)] = last
    return "".join(line[: width + 1])


def _colour(cell: Cell, operator: str) -> str:
    kind = cell.operators[operator].kind
    names = cell.humans if kind == "human" else cell.robots
    return COLOURS[kind][names.index(operator) % 4]


def _count(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"
