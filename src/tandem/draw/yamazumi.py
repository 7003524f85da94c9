"""A Yamazumi chart: what each operator has to do in every cycle, stacked up against the cycle time
and the takt.
"""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell
from tandem.draw.figure import axes_or_new, legend_below, numbers_in
from tandem.draw.lanes import SHADINGS
from tandem.draw.language import Words, words
from tandem.draw.style import ACCENT, FAINT_INK, INK, RULE, SHADE, Look, looks, task_label
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.measures import exact
from tandem.schedule.steady import Round, rounds

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

HALF = 0.38
"""Half the width of a stack; stacks are one apart."""
WIDE, BESIDE, HIGH = 1.95, 1.5, 4.8
"""Inches for a stack, for what stands beside all of them, and for the height."""
ACROSS = 22
"""Letters of an operator's name that stand on one line."""


@dataclass(frozen=True)
class Block:
    """A task, all walks or all changeovers, in an operator's stack.

    Attributes:
      task: its name; empty for walks and changeovers.
      label: what pictures call it.
      low, high: from where to where it reaches, seconds of the cycle's work.
      joint: others take part too.
      kind: "walk" or "changeover", as in `SHADINGS`; empty for a task.
    """

    task: str
    label: str
    low: float
    high: float
    joint: bool = False
    kind: str = ""

    @property
    def seconds(self) -> float:
        """How much of the cycle it takes."""
        return float(exact(self.high) - exact(self.low))


@dataclass(frozen=True)
class Stack:
    """An operator's work in each cycle: tasks from below in the order of the cycle, walks and
    changeovers on top.
    """

    look: Look
    blocks: tuple[Block, ...]
    round: Round


def stacks(cell: Cell, periodic: PeriodicSchedule) -> tuple[Stack, ...]:
    """Every operator's stack, in the cell's order, also of those who do nothing."""
    found, turned = [], rounds(cell, periodic)
    for name, look in looks(cell).items():
        blocks, low = [], Decimal(0)
        for turn in turned[name].turns:
            task, high = turn.assignment.task, low + exact(turn.seconds)
            joint = len(turn.assignment.operators) > 1
            blocks.append(Block(task, task_label(cell, task), float(low), float(high), joint))
            low = high
        for kind, seconds in (
            ("walk", turned[name].walking),
            ("changeover", turned[name].changing),
        ):
            if seconds:
                high = low + exact(seconds)
                blocks.append(Block("", "", float(low), float(high), kind=kind))
                low = high
        found.append(Stack(look, tuple(blocks), turned[name]))
    return tuple(found)


def yamazumi_size(cell: Cell) -> tuple[float, float]:
    """Inches for the chart."""
    return max(5.0, BESIDE + WIDE * len(cell.operators)), HIGH


def plot_yamazumi(
    cell: Cell,
    periodic: PeriodicSchedule,
    ax: Axes | None = None,
    *,
    takt: float | None = None,
    title: str | None = None,
    legend: bool = True,
    language: str = "en",
) -> Axes:
    """Draws each operator's load per cycle as a stack of tasks and returns the axes.

    Args:
      periodic: a sound periodic schedule of the cell.
      takt: seconds; a line is drawn there too.
      title: what stands above; that this is the work in each cycle when absent, nothing when
        empty.
      legend: whether marks are explained below the chart; only those that occur.
      language: of the words and the decimal mark.

    Raises UsageError when pictures do not speak the language.
    """
    t = words(language)
    ax = axes_or_new(ax, yamazumi_size(cell))
    piled = stacks(cell, periodic)
    ax.set_xlim(-0.6, len(piled) - 0.4)
    ax.set_ylim(0, 1.09 * max(periodic.cycle_time, takt or 0.0))
    for place, stack in enumerate(piled):
        for block in stack.blocks:
            _block(ax, place, stack.look, block, t)
    _limit(
        ax,
        periodic.cycle_time,
        t("cycle.time", cycle_time=t.seconds(periodic.cycle_time)),
        at=words_at(periodic.cycle_time, takt),
    )
    if takt is not None:
        _limit(ax, takt, t("cycle.takt", takt=t.seconds(takt)), at=takt, takt=True)
    ax.set_xticks(
        range(len(piled)),
        [_foot(stack, t) for stack in piled],
        fontsize=10,
    )
    ax.tick_params(axis="x", length=0)
    ax.set_ylabel(t("yamazumi.axis"))
    numbers_in(ax.yaxis, t)
    ax.grid(axis="y", color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    title = t("yamazumi.title") if title is None else title
    if title:
        ax.set_title(title, loc="left", fontsize=11, fontweight="bold", parse_math=False)
    entries = _legend(piled, t) if legend else []
    if entries:
        legend_below(ax, entries, inches=0.8)
    return ax


def names_in(block: Block, t: Words) -> list[str]:
    """What may stand in a block, from the fullest to the shortest; the second is in two lines."""
    label = block.label or t(f"picture.{block.kind}")
    name = (block.task or label) + ("+" if block.joint else "")
    full = name if label in (block.task, name) else f"{name}: {label}"
    seconds = t.seconds(block.seconds)
    whole = f"{full}, {seconds}"
    folded = textwrap.wrap(whole, len(whole) // 2 + 4, break_long_words=False)
    two = ["\n".join(folded)] if len(folded) == 2 else []
    return [whole, *two, f"{name}, {seconds}", name]


def _block(ax: Axes, place: int, look: Look, block: Block, t: Words) -> None:
    import matplotlib
    from matplotlib.patches import Rectangle

    from tandem.draw.fitted import fitted_text

    fill, edge, hatch = (
        (look.tint, look.colour, look.hatch)
        if block.task
        else (SHADE, "#9AA0A6", SHADINGS[block.kind].hatch)
    )
    at, size = (place - HALF, block.low), (2 * HALF, block.seconds)
    with matplotlib.rc_context({"hatch.linewidth": 0.6}):
        patch = Rectangle(at, *size, facecolor=fill, edgecolor=edge, hatch=hatch, lw=0, zorder=2)
        ax.add_patch(patch)
    outline = Rectangle(at, *size, fill=False, edgecolor="#6B7280", lw=0.8, zorder=3)
    outline.set_gid(f"load {block.task or block.kind} {look.operator}")
    ax.add_patch(outline)
    backing = (
        {"boxstyle": "round,pad=0.12", "facecolor": fill, "edgecolor": "none"} if hatch else None
    )
    text = fitted_text(
        ax,
        (place - HALF, block.low, place + HALF, block.high),
        names_in(block, t),
        size=10,
        turn=False,
        bbox=backing,
        clip_path=patch,
    )
    text.set_clip_path(patch)


def words_at(cycle_time: float, takt: float | None) -> float:
    """The line, s, above which the cycle time is named: the takt's where that would run through the
    words.
    """
    return takt if takt is not None and 0.92 * takt < cycle_time < takt else cycle_time


def _limit(ax: Axes, seconds: float, says: str, *, at: float, takt: bool = False) -> None:
    """A line across all stacks, and above the line `at` what it is; the words of the cycle time
    stand on the left, those of the takt on the right, so that they never meet.
    """
    style: dict[str, Any] = {"color": ACCENT, "ls": (0, (5, 2))} if takt else {"color": INK}
    ax.axhline(seconds, lw=1.6, zorder=6, gid="takt" if takt else "cycle time", **style)
    ax.annotate(
        says,
        (1.0 if takt else 0.0, at),
        (-2 if takt else 2, 3),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        ha="right" if takt else "left",
        va="bottom",
        fontsize=9.5,
        color=ACCENT if takt else INK,
        annotation_clip=False,
    )


def _foot(stack: Stack, t: Words) -> str:
    """The operator, and below how much of the cycle is work and how much nothing."""
    found = stack.round
    lines = [*textwrap.wrap(stack.look.label, ACROSS)[:2]]
    for key, seconds in (("yamazumi.work", found.working), ("yamazumi.idle", found.idle)):
        lines.append(t(key, seconds=t.seconds(seconds), share=t.share(found.share(seconds))))
    return "\n".join(lines).replace("$", r"\$")


def _legend(piled: tuple[Stack, ...], t: Words) -> list[tuple[Artist, str]]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries: list[tuple[Artist, str]] = []
    if any(block.joint for stack in piled for block in stack.blocks):
        none = Line2D([], [], ls="", marker="$+$", color=FAINT_INK, ms=8)
        entries.append((none, t("picture.joint")))
    there = {block.kind for stack in piled for block in stack.blocks}
    for kind in (kind for kind in SHADINGS if kind in there):
        hatch = SHADINGS[kind].hatch
        patch = Patch(facecolor=SHADE, edgecolor="#9AA0A6", hatch=hatch, lw=0)
        entries.append((patch, t(f"picture.{kind}")))
    return entries
