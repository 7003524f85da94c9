"""Text that stays inside its box: it is measured when it is drawn, at whatever size the figure then
has.

This file needs matplotlib as soon as it is imported; those who draw import it when they draw.
"""

from __future__ import annotations

import bisect
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

from matplotlib.axes import Axes
from matplotlib.text import Text

from tandem.draw.style import INK

STEPS = (1.0, 0.85, 0.7)
"""Shares of the wanted size that are tried before a shorter wording."""
PADDING = 4.0
"""Points that stay free in the box, both sides together."""


class FittedText(Text):
    """The first wording that fits into a box, centred; when none does, the last one cut short; when
    not even that, nothing.

    Args:
      box: left, bottom, right, top in data coordinates.
      wordings: from the fullest to the shortest; a wording may have several lines.
      size: points.
      turn: whether upright text may be used in a narrow box.
    """

    def __init__(
        self,
        box: tuple[float, float, float, float],
        wordings: Sequence[str],
        *,
        size: float = 9.0,
        turn: bool = True,
        **style: Any,
    ):
        left, bottom, right, top = box
        self.box, self.wordings, self.full_size, self.turn = (
            box,
            list(dict.fromkeys(w for w in wordings if w)),
            size,
            turn,
        )
        plain = {
            "ha": "center",
            "va": "center_baseline",
            "color": INK,
            "fontsize": size,
            "zorder": 5,
            "parse_math": False,
            "linespacing": 1.1,
        }
        super().__init__(
            (left + right) / 2,
            (bottom + top) / 2,
            self.wordings[0] if self.wordings else "",
            **{**plain, **style},
        )

    def draw(self, renderer: Any) -> None:
        self._fit(renderer)
        super().draw(renderer)

    def get_window_extent(self, renderer: Any = None, dpi: float | None = None) -> Any:
        if renderer is not None and self.axes is not None:
            self._fit(renderer)
        return super().get_window_extent(renderer, dpi)

    def _fit(self, renderer: Any) -> None:
        left, bottom, right, top = self.box
        assert self.axes is not None
        (x0, y0), (x1, y1) = self.axes.transData.transform([(left, bottom), (right, top)])
        pad = renderer.points_to_pixels(PADDING)
        words, size, upright = next(
            self._choices(renderer, abs(x1 - x0) - pad, abs(y1 - y0) - pad),
            ("", self.full_size, False),
        )
        self.set(
            text=words,
            fontsize=size,
            rotation=90 if upright else 0,
            va="center" if upright else "center_baseline",
        )

    def _choices(
        self, renderer: Any, width: float, height: float
    ) -> Iterator[tuple[str, float, bool]]:
        rooms = (
            [(False, width, height), (True, height, width)]
            if self.turn
            else [(False, width, height)]
        )
        for words in self.wordings:
            for size in (self.full_size * step for step in STEPS):
                yield from (
                    (words, size, upright)
                    for upright, along, across in rooms
                    if self._fits(renderer, words, size, along, across)
                )
        last, size = self.wordings[-1] if self.wordings else "", self.full_size * STEPS[-1]
        found = []
        for upright, along, across in rooms:
            # Shorter text is never wider, so the longest that fits is found by halving.
            cuts = [_cut(last, count) for count in range(len(last) - 3)]
            fits = partial(self._fits, renderer, size=size, along=along, across=across)
            count = bisect.bisect_left(cuts, True, key=fits)
            if count < len(last) - 3:
                found.append((cuts[count], size, upright))
        yield from sorted(found, key=lambda choice: -len(choice[0]))

    def _fits(self, renderer: Any, words: str, size: float, along: float, across: float) -> bool:
        font = self.get_fontproperties().copy()
        font.set_size(size)
        extents = [
            renderer.get_text_width_height_descent(line, font, False) for line in words.split("\n")
        ]
        high = max(extent[1] for extent in extents) * (1 + 1.2 * (len(extents) - 1))
        return bool(max(extent[0] for extent in extents) <= along and high <= across)


def _cut(words: str, away: int) -> str:
    """The words without their last `away + 1` letters."""
    return words[: len(words) - 1 - away].rstrip() + "…"


def fitted_text(
    ax: Axes, box: tuple[float, float, float, float], wordings: Sequence[str], **style: Any
) -> FittedText:
    """Puts a `FittedText` on the axes and clips it there."""
    text = FittedText(box, wordings, **style)
    ax.add_artist(text)
    text.set_clip_on(True)
    return text
