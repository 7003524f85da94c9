"""A front in the terminal: a table of its points, a Gantt chart in characters, and what a method
knows while it works.

Colour is never the only sign: humans, robots and machines differ in the fill of their bars too, and
the critical path is named. rich leaves colours out when the output is no terminal, with NO_COLOR
and with TERM=dumb; where the encoding has no block characters, plain ASCII stands for them.
"""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from tandem.cell.model import Cell
from tandem.draw.imprint import imprint
from tandem.draw.lanes import SHADINGS, Lane, kinds_shaded, lanes
from tandem.draw.style import looks, shorten, task_label
from tandem.plan.result import Front, Result, Status
from tandem.report.language import Words, words
from tandem.report.risk import is_told, risk_heads, risk_note, risk_rows
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
    "machine": ("white", "bright_black", "bright_blue", "bright_green"),
}


class FrontView:
    """Everything the terminal says about a front: a headline, the table, the Gantt chart of one
    point and its digest.

    Args:
      point: counted from 1; the knee when not given.
      stale: the cell has changed since; the last line says so.
    """

    def __init__(
        self,
        front: Front,
        *,
        language: str = "en",
        point: int | None = None,
        stale: bool = False,
    ):
        self.front, self.language, self.point, self.stale = front, language, point, stale

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich.text import Text

        front, t = self.front, words(self.language)
        yield Text(headline(front, self.language))
        if not len(front):
            return
        yield front_table(front, width=options.max_width, language=self.language)
        for line in remarks(front, self.language):
            yield Text(line)
        if is_told(front):
            yield risk_table(front, self.language)
        result = front.shown(self.point)
        recommended = len(front) > 2 and result is front.knee
        title = t(
            "terminal.point.knee" if recommended else "terminal.point",
            n=front.results.index(result) + 1,
            makespan=t.seconds(result.makespan),
            stress=t.number(result.stress),
        )
        yield Text(title, style="bold")
        yield GanttText(front.cell, result.schedule, language=self.language)
        yield Text(imprint(result, t, stale=self.stale), style="dim")


def headline(front: Front, language: str = "en") -> str:
    """One sentence: what was found, and how far it is proven."""
    cell, t = front.cell, words(language)
    people = [t.count(kind, len(names)) for kind, names in cell.crew.items()]
    proof = "open" if front.ended_by == "work" else front.ended_by
    return t(
        "terminal.found",
        name=cell.name or t("terminal.unnamed"),
        counts=", ".join([t.count("task", len(cell.tasks)), *people]),
        points=t.count("terminal.points", len(front)),
        within=_limits(front, t),
        proof=t(f"terminal.{proof}"),
        seconds=t.seconds(round(front.wall_s, 2)),
        solver=front.solver,
    )


def _limits(front: Front, t: Words) -> str:
    """Within what was asked for."""
    asked = front.question
    limits = [
        t(f"terminal.limit.{key}", limit=words_of(limit))
        for key, limit, words_of in (
            ("makespan", asked.max_makespan, t.seconds),
            ("stress", asked.max_stress, t.number),
        )
        if limit is not None
    ]
    if not limits:
        return ""
    both = t("and", first=limits[0], last=limits[-1]) if len(limits) > 1 else limits[0]
    return t("terminal.within", limits=both)


def remarks(front: Front, language: str = "en") -> list[str]:
    """What is to be said of a front that is not all that it could be: which points time has cut
    short, and which proven ones may have another schedule in the next run.
    """
    t, places = words(language), list(enumerate(front, 1))
    cut = [str(place) for place, r in places if r.status != Status.OPTIMAL]
    loose = [str(p) for p, r in places if r.status == Status.OPTIMAL and not r.canonical]
    found = {"cut": cut if front.ended_by == "time" else [], "loose": loose}
    return [
        t(f"terminal.{key}", points=t.count("points", len(names), names=", ".join(names)))
        for key, names in found.items()
        if names
    ]


def front_table(front: Front, *, width: int = 80, language: str = "en") -> Table:
    """The points as a table that fits into `width` characters: makespan, stress, how far proven,
    and who does what in short.

    The knee has a star. Bounds stand behind a value that is not proven.
    """
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table
    from rich.text import Text

    t = words(language)
    cost = [t("front.cost")] if front.cell.cost is not None else []
    heads = [t("front.makespan"), t("front.stress"), *cost, t("front.status")]
    table = Table(box=SIMPLE_HEAD, pad_edge=False, header_style="bold")
    table.add_column("", no_wrap=True)
    table.add_column(escape(heads[0]), justify="right", no_wrap=True)
    for head in heads[1:-1]:
        table.add_column(head, justify="right", no_wrap=True)
    table.add_column(heads[-1], no_wrap=True)
    rows = [
        (
            _bounded(r.makespan, r.bound.makespan, t),
            _bounded(r.stress, r.bound.stress, t),
            *([t.number(r.cost)] if r.cost is not None else []),
            status(r, language),
        )
        for r in front
    ]
    taken = 6 + sum(
        2 + max([len(head), *(len(row[i]) for row in rows)]) for i, head in enumerate(heads)
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
                    result.schedule,
                    look.operator,
                    room,
                    lines=3 if len(front) <= 10 else 1,
                    language=language,
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
        table.caption, table.caption_justify = t("terminal.knee"), "left"
    return table


def risk_table(front: Front, language: str = "en") -> Table:
    """What becomes of each point's makespan where times scatter: half of the assemblies end by P50,
    95 of 100 by P95.
    """
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    t, table = words(language), Table(box=SIMPLE_HEAD, pad_edge=False, header_style="bold")
    for head in risk_heads(front, t):
        table.add_column(Text(head), justify="right", no_wrap=True)
    for row in risk_rows(front, t):
        table.add_row(*row)
    table.caption, table.caption_justify = risk_note(front, t), "left"
    return table


def status(result: Result, language: str = "en") -> str:
    """Proven, or how far the makespan is from its bound."""
    t = words(language)
    if result.status == Status.OPTIMAL:
        return t("front.proven")
    return t("terminal.gap", gap=t.share(result.gap))


def _bounded(value: float, bound: float, t: Words) -> str:
    shown = t.number(value)
    return shown if bound >= value else f"{shown} (>= {t.number(round(bound, 2))})"


def tasks_in_short(
    schedule: Schedule, operator: str, room: int, *, lines: int = 1, language: str = "en"
) -> str:
    """The operator's tasks in order when so many lines of `room` characters hold them, else how
    many there are. `+` marks a joint task.
    """
    names = [a.task + ("+" if len(a.operators) > 1 else "") for a in schedule.of(operator)]
    if not names:
        return "-"
    folded = textwrap.wrap(" ".join(names), room, break_long_words=False, break_on_hyphens=False)
    fits = len(folded) <= lines and max(map(len, folded)) <= room
    return "\n".join(folded) if fits else words(language).count("task", len(names))


class GanttText:
    """A schedule as lanes of characters, as wide as the console; it is folded into several panels
    when tasks would get too narrow.

    A bar begins with an edge and the task's name; humans' bars are solid, robots' shaded, machines'
    shaded closer. `x` is a break, `~` a tool changeover, `>` walking, `·` a part held.
    """

    def __init__(
        self, cell: Cell, schedule: Schedule, *, critical: bool = True, language: str = "en"
    ):
        self.cell, self.schedule, self.critical = cell, schedule, critical
        self.words = words(language)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich.text import Text

        if not len(self.schedule):
            yield Text(self.words("terminal.nobody"))
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
                " " * left + _axis(begin, end, scale, width, self.words),
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

        rows, t = list(rows), self.words
        parts = [f"{marks.of[kind]} {t(kind)}" for kind in ("human", "robot")]
        if self.cell.machines:
            parts.append(f"{marks.of['machine']} {t('machine')}")
        if any(bar.joint for lane in rows for bar in lane.bars):
            parts.append(f"+ {t('picture.joint')}")
        parts += [
            f"{marks.shaded[SHADINGS[kind].fill]} {t(f'picture.{kind}')}"
            for kind in kinds_shaded(rows)
        ]
        yield Text("  ".join(parts), style="dim")
        if self.critical:
            chain = [link.assignment.task for link in critical_path(self.cell, self.schedule)]
            arrow = f" {marks.arrow} "
            if len(arrow.join(chain)) > 3 * width:
                chain = [*chain[:8], marks.ellipsis, *chain[-8:]]
            yield Text(t("terminal.critical", chain=arrow.join(chain)))
        named = [
            bar
            for bar in {bar.task: bar for lane in rows for bar in lane.bars}.values()
            if bar.label != bar.task
        ]
        if named and len(named) <= 24:
            yield Text(
                t(
                    "terminal.tasks",
                    names=", ".join(
                        f"{bar.task} = {task_label(self.cell, bar.task)}" for bar in named
                    ),
                ),
                style="dim",
            )


class _Marks:
    """The characters of a chart; `plain` keeps to ASCII."""

    def __init__(self, *, plain: bool):
        self.human, self.robot, self.machine = ("#", "=", ":") if plain else ("█", "░", "▒")
        self.bar, self.edge = ("[", "|") if plain else ("▐", "│")
        self.arrow, self.ellipsis = ("->", "..") if plain else ("→", "…")
        self.pause, self.swap, self.walk = ("x", "~", ">") if plain else ("╳", "~", "›")
        self.hold = "." if plain else "·"

    @property
    def of(self) -> dict[str, str]:
        """The fill of the bars of each kind of operator."""
        return {"human": self.human, "robot": self.robot, "machine": self.machine}

    @property
    def shaded(self) -> dict[str, str]:
        """The sign of each fill of a time without a task."""
        return {
            "break": self.pause,
            "changeover": self.swap,
            "walk": self.walk,
            "hold": self.hold,
        }


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
    fill = marks.of[lane.look.kind]

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


def _axis(begin: float, end: float, scale: float, width: int, t: Words) -> str:
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
        label = t.number(i * step)
        at = round((i * step - begin) * scale)
        if at + len(label) <= width - 7 or span < step:
            line[at : at + len(label)] = label
    last = t.seconds(end)
    at = width - len(last) + 1
    line[at : at + len(last)] = last
    return "".join(line[: width + 1])


def _colour(cell: Cell, operator: str) -> str:
    kind = cell.operators[operator].kind
    return COLOURS[kind][cell.crew[kind].index(operator) % 4]
