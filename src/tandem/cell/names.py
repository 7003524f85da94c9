"""One spelling of a name, and the nearest known one for an unknown one."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from difflib import get_close_matches

SEARCHES = 25
"""Comparing with thousands of names takes a moment; whoever misspells more than this gets no more guesses."""


def clean(text: str) -> str:
    """The one spelling of a name: letters with their accents in one piece (NFC), single blanks, none at the ends."""
    return " ".join(unicodedata.normalize("NFC", text).split())


class Known:
    """Names that exist, and which of them somebody may have meant."""

    def __init__(self, names: Iterable[str]):
        self.names = tuple(names)
        self._known = frozenset(self.names)
        self._folded: dict[str, str] | None = None
        self._searches = 0

    def __contains__(self, name: str) -> bool:
        return name in self._known

    def nearest(self, name: str) -> str | None:
        """The known name most like this one; None when none is like it."""
        if self._folded is None:
            self._folded = {_fold(known): known for known in reversed(self.names)}
        if (known := self._folded.get(_fold(name))) is not None:
            return known
        self._searches += 1
        if self._searches > SEARCHES:
            return None
        close = get_close_matches(_fold(name), self._folded, n=1, cutoff=0.6)
        return self._folded[close[0]] if close else None

    def hint(self, name: str) -> str:
        """What follows the complaint about an unknown name: the nearest known one, else all of them when they are few."""
        nearest = self.nearest(name)
        if nearest is not None:
            return f"Did you mean {nearest!r}?"
        if len(self.names) <= 12:
            return f"Known: {', '.join(map(repr, self.names))}." if self.names else "None are stated."
        return f"{len(self.names)} others are known, none like it."


def _fold(name: str) -> str:
    return "".join(name.split()).casefold()
