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
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from tandem.cell.model import Cell
from tandem.draw.imprint import imprint
from tandem.draw.lanes import SHADINGS, Bar, Lane, kinds_shaded, lanes
from tandem.draw.style import looks, shorten, task_label
from tandem.plan.cycle.result import CycleFront
from tandem.plan.result import Front, Result, Status
from tandem.report.language import Words, words
from tandem.report.progress import open_share
from tandem.report.risk import is_told, risk_heads, risk_note, risk_rows
from tandem.schedule.critical import critical_path
from tandem.schedule.measures import makespan
from tandem.schedule.model import Schedule

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderResult
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
    short, which proven ones may have another schedule in the next run, and how much is open.
    """
    t, places = words(language), list(enumerate(front, 1))
    cut = [str(place) for place, r in places if r.status != Status.OPTIMAL]
    loose = [str(p) for p, r in places if r.status == Status.OPTIMAL and not r.canonical]
    found = {"cut": cut if front.ended_by == "time" else [], "loose": loose}
    said = [
        t(f"terminal.{key}", points=t.count("points", len(names), names=", ".join(names)))
        for key, names in found.items()
        if names
    ]
    if front.open_area is not None:
        said.append(t("terminal.open_area", share=open_share(front.open_area, t)))
    return [*said, *_confident(front, t)]


def _confident(front: Front, t: Words) -> Iterator[str]:
    """How far the policy that made schedules is to be trusted, and what happens where it is not."""
    known = front.confidence
    if known is None:
        return
    if known.chance is not None:
        yield t("terminal.confidence.chance", chance=f"{100 * known.chance:.0f}")
    if known.beyond:
        what = ", ".join(
            t(
                f"terminal.beyond.{one.what}",
                value=t.number(one.value),
                seen=f"{t.number(one.least)}–{t.number(one.most)}",
            )
            for one in known.beyond
        )
        yield t("terminal.confidence.unlike", what=what)
    else:
        yield t("terminal.confidence.like")


def front_table(front: Front, *, width: int = 80, language: str = "en") -> Table:
    """The points as a table that fits into `width` characters: makespan, stress, how far proven,
    and who does what in short.

    The knee has a star. Bounds stand behind a value that is not proven.
    """
    t = words(language)
    heads = [(t("front.makespan"), "right"), (t("front.stress"), "right")]
    heads += [(t("front.cost"), "right")] if front.cell.cost is not None else []
    heads += [(t("front.status"), "")]
    rows = [
        (
            bounded(r.makespan, r.bound.makespan, t),
            bounded(r.stress, r.bound.stress, t),
            *([t.number(r.cost)] if r.cost is not None else []),
            status(r, language),
        )
        for r in front
    ]
    return points_table(front, heads, rows, width=width, language=language)


def points_table(
    front: Front | CycleFront,
    heads: Sequence[tuple[str, str]],
    rows: Sequence[Sequence[str]],
    *,
    width: int,
    language: str,
) -> Table:
    """The points as a table that fits into `width` characters: what `rows` say of each, and who
    does what in short. The knee has a star.

    Args:
      heads: words, of one or more lines, and "right" where numbers stand.
    """
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table
    from rich.text import Text

    t = words(language)
    table = Table(box=SIMPLE_HEAD, pad_edge=False, header_style="bold")
    table.add_column("", no_wrap=True)
    for head, side in heads:
        table.add_column(escape(head), justify="right" if side else "left", no_wrap=True)
    taken = 6 + sum(
        2 + max([*map(len, head.split("\n")), *(len(row[i]) for row in rows)])
        for i, (head, _) in enumerate(heads)
    )
    shown = list(looks(front.cell).values())
    room = (width - taken) // len(shown) - 2
    shown = shown if room >= max(8, len(t.count("task", len(front.cell.tasks)))) else []
    for look in shown:
        table.add_column(
            escape(shorten(look.label, max(room, 8), "..")),
            overflow="fold",
            style=_colour(front.cell, look.operator),
        )
    knee = front.knee_place if len(front) > 2 else None
    for place, (schedule, row) in enumerate(zip([r.schedule for r in front], rows, strict=True)):
        cells = [
            Text(
                tasks_in_short(
                    schedule,
                    look.operator,
                    room,
                    lines=3 if len(front) <= 10 else 1,
                    language=language,
                )
            )
            for look in shown
        ]
        table.add_row(
            f"{place + 1}{'*' if place == knee else ''}",
            *row,
            *cells,
            style="bold" if place == knee else "",
        )
    if knee is not None:
        sure = isinstance(front, CycleFront) or front.is_knee_certain
        table.caption = t("terminal.knee" if sure else "terminal.knee.open")
        table.caption_justify = "left"
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
    """Proven, or how far the makespan is from its bound; where that is proven, stress is open."""
    t = words(language)
    if result.status == Status.OPTIMAL:
        return t("front.proven")
    if result.gap <= 0:
        return t("terminal.stress_open")
    return t("terminal.gap", gap=t.share(result.gap))


def bounded(value: float, bound: float, t: Words) -> str:
    """The value, and behind it the bound where that is less."""
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
    ruled. `x` is a break, `~` a tool changeover, `>` walking, `·` a part held.
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
        rows = lanes(
            self.cell, self.schedule, until=makespan(self.schedule), critical=self.critical
        )
        chart = LanesText(self.cell, rows, options, self.words)
        yield from chart.lines([[panel] for panel in self._panels(chart.width)])
        yield from chart.notes()
        yield from self._critical(chart.marks, options.max_width)
        yield from chart.names()

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

    def _critical(self, marks: _Marks, width: int) -> Iterator[Text]:
        """The critical path, named."""
        from rich.text import Text

        if self.critical:
            chain = [link.assignment.task for link in critical_path(self.cell, self.schedule)]
            arrow = f" {marks.arrow} "
            if len(arrow.join(chain)) > 3 * width:
                chain = [*chain[:8], marks.ellipsis, *chain[-8:]]
            yield Text(self.words("terminal.critical", chain=arrow.join(chain)))


class LanesText:
    """Lanes as lines of characters, as wide as the console.

    Attributes:
      width: characters across a lane.
    """

    def __init__(self, cell: Cell, rows: Iterable[Lane], options: ConsoleOptions, t: Words):
        self.cell, self.rows, self.words = cell, list(rows), t
        self.marks = _Marks(plain=not _can_print(options.encoding, _Marks(plain=False)))
        room = max(4, min(18, options.max_width // 4))
        self._names = [shorten(lane.look.label, room, self.marks.ellipsis) for lane in self.rows]
        self._left = max(map(len, self._names)) + 2
        self.width = max(10, min(options.max_width, 160) - self._left - 1)

    def lines(self, folded: Iterable[Sequence[tuple[float, float]]]) -> Iterator[Text]:
        """The lanes, once for each entry of `folded`: the pieces of time that stand side by side,
        all of the same length, an edge behind each.
        """
        from rich.text import Text

        for pieces in folded:
            width = (self.width - len(pieces) + 1) // len(pieces)
            scale = width / (pieces[0][1] - pieces[0][0])
            for name, lane in zip(self._names, self.rows, strict=True):
                colour = _colour(self.cell, lane.look.operator)
                line = Text(
                    name.ljust(self._left - 1) + self.marks.edge, no_wrap=True, overflow="crop"
                )
                for begin, end in pieces:
                    line.append_text(_lane_text(lane, begin, end, scale, width, self.marks, colour))
                    line.append(self.marks.edge)
                yield line
            axes = "".join(_axis(*piece, scale, width, self.words) for piece in pieces)
            yield Text(" " * self._left + axes, style="dim", no_wrap=True, overflow="crop")

    def notes(self) -> Iterator[Text]:
        """What the signs mean."""
        from rich.text import Text

        marks, t = self.marks, self.words
        several = any(bar.product is not None for lane in self.rows for bar in lane.bars)
        parts = [
            f"{marks.fill(kind, 0)}{marks.fill(kind, 1) if several else ''} {t(kind)}"
            for kind in ("human", "robot", *(["machine"] if self.cell.machines else []))
        ]
        if any(bar.joint for lane in self.rows for bar in lane.bars):
            parts.append(f"+ {t('picture.joint')}")
        parts += [
            f"{marks.shaded[SHADINGS[kind].fill]} {t(f'picture.{kind}')}"
            for kind in kinds_shaded(self.rows)
        ]
        yield Text("  ".join(parts), style="dim")

    def names(self) -> Iterator[Text]:
        """What the tasks are called, unless they are too many."""
        from rich.text import Text

        named = [
            bar
            for bar in {bar.task: bar for lane in self.rows for bar in lane.bars}.values()
            if bar.label != bar.task
        ]
        if named and len(named) <= 24:
            names = ", ".join(f"{bar.task} = {task_label(self.cell, bar.task)}" for bar in named)
            yield Text(self.words("terminal.tasks", names=names), style="dim")


class _Marks:
    """The characters of a chart; `plain` keeps to ASCII."""

    def __init__(self, *, plain: bool):
        self.human, self.robot = ("#%", "=-") if plain else ("█▓", "░▒")
        self.machine = ":;" if plain else "▤▥"
        self.bar, self.edge = ("[", "|") if plain else ("▐", "│")
        self.arrow, self.ellipsis = ("->", "..") if plain else ("→", "…")
        self.pause, self.swap, self.walk = ("x", "~", ">") if plain else ("╳", "~", "›")
        self.hold = "." if plain else "·"

    def fill(self, kind: str, product: int) -> str:
        """The sign of a bar; products that follow each other differ."""
        of_kind = {"human": self.human, "robot": self.robot, "machine": self.machine}
        return of_kind[kind][product % 2]

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
        fill = marks.fill(lane.look.kind, bar.product or 0)
        edge = marks.bar if bar.start >= begin else ""
        words = edge + _name_in(bar, len(places) - len(edge), marks)
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


def _name_in(bar: Bar, room: int, marks: _Marks) -> str:
    """As much of a bar's name, and of the mark of its product, as fits; nothing where that is too
    little.
    """
    name = bar.task + ("+" if bar.joint else "")
    mark = f" {bar.mark}" if bar.mark else ""
    if mark and room >= min(len(name), 4) + len(mark):
        return shorten(name, room - len(mark), marks.ellipsis) + mark
    return shorten(name, room, marks.ellipsis) if room >= min(len(name), 4) else ""


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
