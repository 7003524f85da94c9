"""One look for every picture: an operator keeps its colour, hatch and letters in charts, terminal
and reports.

The colours are those of Okabe and Ito (2008), which people with any common colour blindness can
tell apart: warm ones for humans, cool ones for robots; machines have greys. Because colour alone is
not enough, humans are plain, robots hatched in slanting and machines in level lines, and every
operator has letters of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from tandem.cell.model import Cell
from tandem.cell.parts import Kind

HUMAN_COLOURS = ("#E69F00", "#CC79A7", "#D55E00", "#F0E442")
ROBOT_COLOURS = ("#56B4E9", "#009E73", "#0072B2", "#7F8FA6")
MACHINE_COLOURS = ("#7A7A7A", "#4D4D4D", "#9A9A9A", "#636363")
HUMAN_HATCHES = ("", "..", "oo", "**")
ROBOT_HATCHES = ("///", "\\\\\\", "xxx", "|||")
MACHINE_HATCHES = ("---", "+++")

FILLS: dict[Kind, tuple[Sequence[str], Sequence[str]]] = {
    "human": (HUMAN_COLOURS, HUMAN_HATCHES),
    "robot": (ROBOT_COLOURS, ROBOT_HATCHES),
    "machine": (MACHINE_COLOURS, MACHINE_HATCHES),
}
"""Colours and hatches of each kind of operator; each is used up in turn."""

INK = "#1A1A1A"
"""Text and the critical path."""
FAINT_INK = "#595959"
"""Second-rank text: 7 to 1 on white."""
RULE = "#C8CCD0"
"""Grid lines and idle lanes."""
SHADE = "#E9ECEF"
"""Breaks, dominated area."""
ACCENT = "#B3261E"
"""Deadlines, limits and what changed."""


@dataclass(frozen=True)
class Look:
    """How one operator looks everywhere.

    Attributes:
      operator: its name in the cell; `label` is what pictures call it.
      letters: one to three letters that are its own within the cell.
      colour: full colour for edges, hatches and marks; `tint` is the light fill on which black text
        reads.
      hatch: matplotlib's notation; empty for the first human, never empty for a robot or machine.
    """

    operator: str
    label: str
    kind: str
    letters: str
    colour: str
    tint: str
    hatch: str


def looks(cell: Cell) -> dict[str, Look]:
    """Per operator its look, in the cell's order. It depends on the cell's operators alone, never
    on a schedule.
    """
    letters = _letters(
        [(name, operator.label or name) for name, operator in cell.operators.items()]
    )
    found, seen = {}, dict.fromkeys(FILLS, 0)
    for name, operator in cell.operators.items():
        place = seen[operator.kind]
        seen[operator.kind] += 1
        colours, hatches = FILLS[operator.kind]
        colour = colours[place % len(colours)]
        # When the colours are used up they begin again with the next hatch, so that a pair of both
        # stays an operator's own.
        hatch = hatches[(place + place // len(colours)) % len(hatches)]
        found[name] = Look(
            name, operator.label or name, operator.kind, letters[name], colour, tint(colour), hatch
        )
    return found


SHADES = (0.45, 0.72, 0.18)
"""Strengths of tint by which neighbouring products are told apart."""


def shade_of(product: int) -> int:
    """Which of the `SHADES` a product has; products launched one after the other differ."""
    return product % len(SHADES)


def shade(look: Look, product: int) -> Look:
    """The operator's look in the shade of one of several products."""
    return replace(look, tint=tint(look.colour, SHADES[shade_of(product)]))


def task_label(cell: Cell, task: str) -> str:
    """What pictures call a task."""
    return cell.tasks[task].label or task


def shorten(text: str, length: int, ellipsis: str = "…") -> str:
    """At most `length` characters; an ellipsis stands for what was cut."""
    if len(text) <= length:
        return text
    return (
        text[: max(length - len(ellipsis), 0)].rstrip() + ellipsis
        if length > len(ellipsis)
        else text[:length]
    )


def tint(colour: str, strength: float = 0.45) -> str:
    """The colour mixed with white; `strength` 1 leaves it, 0 gives white."""
    channels = (int(colour[place : place + 2], 16) for place in (1, 3, 5))
    return "#" + "".join(f"{round(255 - strength * (255 - channel)):02X}" for channel in channels)


def contrast(first: str, second: str) -> float:
    """Contrast of two colours from 1 to 21, as WCAG 2.1 defines it; text wants 4.5 or more."""
    light, dark = sorted((_luminance(first), _luminance(second)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def _luminance(colour: str) -> float:
    channels = [int(colour[place : place + 2], 16) / 255 for place in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def _letters(names: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Per operator the shortest letters that no other has: its initial, else the initial with the
    digits it ends in or a count.
    """
    names = list(names)
    initials = {name: next((c.upper() for c in label if c.isalnum()), "?") for name, label in names}
    found: dict[str, str] = {}
    for name, label in names:
        initial = initials[name]
        if list(initials.values()).count(initial) == 1:
            found[name] = initial
            continue
        digits = "".join(
            c
            for c in label[::-1][: len(label) - len(label.rstrip("0123456789"))][::-1]
            if c.isdigit()
        )
        candidate = initial + digits if digits and initial + digits not in found.values() else ""
        count = 1
        while not candidate or candidate in found.values():
            candidate, count = f"{initial}{count}", count + 1
        found[name] = candidate
    return found
