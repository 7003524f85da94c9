"""Small pieces of HTML and SVG. Every value is escaped here and nowhere else; what is `Markup`
already is left as it is.
"""

from __future__ import annotations

import html
import re
import unicodedata
from collections.abc import Iterable, Iterator

from tandem.cell.written import number
from tandem.draw.style import SHADES, Look, shade, shade_of

CELLS = ("td", "th", "div", "span")
"""Elements in which a table's cell holds its text."""
LONGEST_WORD, PIECE = 12, 9
"""A word with more letters than that may be broken between pieces of so many, so that a table never
needs more room than paper has.
"""
JOINT = re.compile(r"(?<=[^\W_][._])(?=[^\W\d_])|(?<=[a-z])(?=[A-Z])")
"""Where a long word is broken first: `tandem.learn.ppo` behind its dots, `early_stop` and
`SmallCell` between their words.
"""
WIDE, NARROW = "mwMW%@—", "iljtfrI.,:;'|!()[]/ "


class Markup(str):
    """Text that is HTML or SVG already."""

    __slots__ = ()


def tag(name: str, *children: object, **attributes: object) -> Markup:
    """One element. `class_` and the like lose their last underscore, other underscores become
    hyphens; None and False leave an attribute out.
    """
    head = "".join(
        f' {_attribute(key)}="{_value(value)}"'
        for key, value in attributes.items()
        if value is not None and value is not False
    )
    inside = join(map(_breakable, children) if name in CELLS else children)
    return Markup(f"<{name}{head}>{inside}</{name}>")


def _breakable(child: object) -> object:
    """Text of a cell with places where its long words may be broken; everything else as it is."""
    if isinstance(child, Markup) or not isinstance(child, str):
        return child
    return join(Markup("<wbr>") if piece is None else piece for piece in _pieces(child))


def _pieces(text: str) -> Iterator[str | None]:
    """The text in pieces, None where a line may be broken within a word."""
    for word in re.split(r"(\s+|(?<=[-/]))", text):
        if len(word) <= LONGEST_WORD:
            yield word
            continue
        for joint, part in enumerate(JOINT.split(word)):
            yield from (None,) * (joint > 0)
            yield part[:PIECE] if len(part) > LONGEST_WORD else part
            for place in range(PIECE, len(part), PIECE) if len(part) > LONGEST_WORD else ():
                yield from (None, part[place : place + PIECE])


def join(children: Iterable[object]) -> Markup:
    """Pieces one after the other, each escaped unless it is `Markup`."""
    return Markup(
        "".join(
            piece if isinstance(piece, Markup) else html.escape(_plain(piece)) for piece in children
        )
    )


def _attribute(key: str) -> str:
    return key.rstrip("_").replace("_", "-") if key != "viewBox" else key


def _value(value: object) -> str:
    return html.escape("" if value is True else _plain(value))


def _plain(value: object) -> str:
    return (
        f"{round(value, 2):.10g}"
        if isinstance(value, float)
        else "".join(c for c in str(value) if c in "\t\n" or unicodedata.category(c) != "Cc")
    )


def text(x: float, y: float, words: str, *, size: float = 16, **attributes: object) -> Markup:
    """SVG text; `anchor` start, middle or end through `text_anchor`."""
    return tag("text", words, x=float(x), y=float(y), font_size=float(size), **attributes)


def width_of(words: str, size: float) -> float:
    """Pixels that the words take at most in a common sans-serif font of that size."""
    return size * sum(_em(c) for c in words)


def _em(character: str) -> float:
    if unicodedata.east_asian_width(character) in "WF":
        return 1.05
    if character in WIDE:
        return 0.98
    if character in NARROW:
        return 0.42
    return 0.72 if character.isupper() else 0.65


def fitting(wordings: Iterable[str], room: float, size: float = 16) -> str:
    """The first wording that fits into so many pixels, else the last one cut to no less than four
    letters and half of it, else nothing.
    """
    last = ""
    for last in wordings:
        if width_of(last, size) <= room:
            return last
    for length in range(len(last) - 1, max(3, len(last) // 2), -1):
        if width_of(cut := last[:length].rstrip() + "…", size) <= room:
            return cut
    return ""


def hatch_id(look: Look, order: dict[str, Look], product: int | None = None) -> str:
    """The name of an operator's fill in the page; in the shade of one of several products."""
    name = f"fill-{list(order).index(look.operator)}"
    return name if product is None else f"{name}-{shade_of(product)}"


def hatches(order: dict[str, Look], *, shades: bool = False) -> Markup:
    """An invisible drawing that defines every operator's fill, for all other drawings of the page;
    with `shades` also those that tell products apart.
    """
    kinds = [None, *(range(len(SHADES)) if shades else ())]
    patterns = [
        _pattern(
            hatch_id(look, order, product),
            (look if product is None else shade(look, product)).tint,
            look.colour,
            look.hatch[:1],
        )
        for look in order.values()
        for product in kinds
    ]
    patterns.append(_pattern("fill-break", "#E9ECEF", "#8A929A", "x"))
    patterns.append(_pattern("fill-walk", "#E9ECEF", "#8A929A", "|"))
    patterns.append(_pattern("fill-changeover", "#E9ECEF", "#8A929A", "."))
    patterns.append(_pattern("fill-hold", "#F3F4F5", "#B4BAC0", "."))
    return tag(
        "svg",
        tag("defs", *patterns),
        width="0",
        height="0",
        aria_hidden="true",
        focusable="false",
        style="position:absolute",
    )


def _pattern(name: str, ground: str, colour: str, sign: str) -> Markup:
    lines = {
        "/": "M-3,3 L3,-3 M0,12 L12,0 M9,15 L15,9",
        "\\": "M-3,9 L3,15 M0,0 L12,12 M9,-3 L15,3",
        "|": "M6,0 L6,12",
        "x": "M0,0 L12,12 M0,12 L12,0",
        "-": "M0,3 L12,3 M0,9 L12,9",
        "+": "M0,6 L12,6 M6,0 L6,12",
    }
    pieces = [tag("rect", width=12, height=12, fill=ground)]
    if sign in lines:
        pieces.append(tag("path", d=lines[sign], stroke=colour, stroke_width="1.3", fill="none"))
    elif sign:
        radius = {".": 1.4, "o": 2.6, "*": 2.2}.get(sign, 1.4)
        hollow = sign == "o"
        pieces.append(
            tag(
                "circle",
                cx=6,
                cy=6,
                r=radius,
                fill="none" if hollow else colour,
                stroke=colour if hollow else None,
            )
        )
    return tag("pattern", *pieces, id=name, width=12, height=12, patternUnits="userSpaceOnUse")


def ticks(low: float, high: float, most: int) -> list[float]:
    """Round numbers between low and high, at most so many."""
    if high <= low:
        return [low]
    step = next(
        s
        for power in range(-6, 10)
        for s in (10.0**power, 2 * 10.0**power, 5 * 10.0**power)
        if (high - low) / s <= most
    )
    first = int(-(-low // step))
    return [round(i * step, 9) for i in range(first, int(high // step) + 1)]


def figure(drawing: Markup, label: str, *, class_: str = "chart") -> Markup:
    """A drawing that can be scrolled when the window is narrower than it is, by keyboard too."""
    return tag("div", drawing, class_=class_, role="region", aria_label=label, tabindex="0")


__all__ = [
    "Markup",
    "figure",
    "fitting",
    "hatch_id",
    "hatches",
    "join",
    "number",
    "tag",
    "text",
    "ticks",
    "width_of",
]
