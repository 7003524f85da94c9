"""The door for names: one spelling of each, no signs that do harm, and the nearest known name for
an unknown one.

Two spellings that nobody can tell apart on a screen would be two tasks, or one task that nobody
finds. So every name comes in through `clean`, wherever it is written: cell files, workbooks,
events, options of the command line, plans that are read back.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator
from difflib import get_close_matches

SEARCHES = 25
COMPARISONS = 250_000
"""Comparing with thousands of names takes a moment; whoever misspells more than this gets no more
guesses.
"""

JOINERS = "\u200c\u200d\ufe00-\ufe0f"
"""Unseen signs that shape their neighbours, as in Persian words and in pictures made of several:
titles keep them.
"""
UNSEEN = re.compile(
    "[\u00ad\u034f\u061c\u115f\u1160\u17b4\u17b5\u180b-\u180f\u200b-\u200f\u202a-\u202e\u2060-\u206f\u3164\ufe00-\ufe0f\ufeff\uffa0"
    "\ufff0-\ufff8\U0001bca0-\U0001bca3\U0001d173-\U0001d17a\U000e0000-\U000e0fff]"
)
"""Signs without a look of their own: Unicode's Default_Ignorable_Code_Point. Among them are those
that turn the direction of writing.
"""
UNSEEN_IN_TITLES = re.compile(f"(?![{JOINERS}]){UNSEEN.pattern}")
BLANKS = re.compile(r"[\s\u2800]+")
"""Blanks of every width, line breaks, and the pattern of no dots."""
HARMFUL = re.compile(r"[\x00-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
"""Control characters, which a terminal or a printer would obey, and halves of characters, which no
file can hold.
"""

SAME_LOOK = str.maketrans(
    "АВЕЅІЈКМНОРСТУХЗаеѕіјорсухһԁԛԝ" + "ΑΒΕΖΗΙΚΜΝΟΡΤΥΧον" + "‐‑‒–—−ı",
    "ABESIJKMHOPCTYX3aesijopcyxhdqw" + "ABEZHIKMNOPTYXov" + "------i",
)
"""Cyrillic and Greek letters that look like Latin ones, and dashes that look alike."""
LOOKS_OTHERWISE = ("<super>", "<sub>", "<circle>", "<fraction>", "<square>", "<vertical>")
"""Compatible forms that have a look of their own: m² is not m2."""


def clean(text: str) -> str:
    """The one spelling of a name: letters with their accents in one piece (NFC), single blanks,
    none at the ends, no unseen signs.

    What comes out stays as it is when it is cleaned again. A name in which nothing can be seen
    comes out empty; what no name may hold (`harm_in`) is left for the caller to refuse.
    """
    if text.isascii():
        return " ".join(text.split()) if " " in text or not text.isprintable() else text
    return BLANKS.sub(" ", unicodedata.normalize("NFC", UNSEEN.sub("", text))).strip()


def clean_title(text: str) -> str:
    """The same for a title, which people only read: it keeps the unseen signs that shape letters
    and pictures.
    """
    return (
        clean(text)
        if text.isascii()
        else BLANKS.sub(" ", unicodedata.normalize("NFC", UNSEEN_IN_TITLES.sub("", text))).strip()
    )


def key(text: str) -> str:
    """Casefolded, umlauts spelled out, marks as blanks: what tables are looked up by."""
    plain = (
        unicodedata.normalize("NFKC", clean(text))
        .casefold()
        .translate({ord("ä"): "ae", ord("ö"): "oe", ord("ü"): "ue"})
    )
    return " ".join(re.sub(r"[^\w#]|_", " ", plain).split())


def harm_in(text: str) -> str | None:
    """What stands in a name or title that none may hold, such as "the control character U+001B";
    None when nothing does.
    """
    found = HARMFUL.search(text)
    if found is None:
        return None
    sign = ord(found.group())
    kind = (
        "the half character"
        if 0xD800 <= sign <= 0xDFFF
        else "the control character"
        if sign < 0xA0
        else "the sign"
    )
    return f"{kind} U+{sign:04X}"


def look(name: str) -> str:
    """What a reader sees of a clean name: names of one look cannot be told apart, whatever signs
    they are made of.
    """
    if name.isascii():
        return name
    folded = "".join(
        c
        if unicodedata.decomposition(c).startswith(LOOKS_OTHERWISE)
        else unicodedata.normalize("NFKC", c)
        for c in name
    )
    return " ".join(folded.translate(SAME_LOOK).split())


def twins(names: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Pairs of different clean names of one look: the first that has it, and each later one."""
    seen: dict[str, str] = {}
    for name in names:
        first = seen.setdefault(look(name), name)
        if first != name:
            yield first, name


def difference(one: str, other: str) -> str:
    """Where two names of one look differ, such as "U+0430 where the first has U+0061"."""
    place = next(
        (place for place, (a, b) in enumerate(zip(one, other, strict=False)) if a != b),
        min(len(one), len(other)),
    )
    signs = [
        f"U+{ord(name[place]):04X}" if place < len(name) else "nothing" for name in (one, other)
    ]
    return f"{signs[1]} where the first has {signs[0]}"


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
        if self._searches > SEARCHES or self._searches * len(self._folded) > COMPARISONS:
            return None
        close = get_close_matches(_fold(name), self._folded, n=1, cutoff=0.6)
        return self._folded[close[0]] if close else None

    def hint(self, name: str) -> str:
        """What follows the complaint about an unknown name: the nearest known one, else all of them
        when they are few.
        """
        nearest = self.nearest(name)
        if nearest is not None:
            return f"Did you mean {nearest!r}?"
        if len(self.names) <= 12:
            return (
                f"Known: {', '.join(map(repr, self.names))}." if self.names else "None are stated."
            )
        return f"{len(self.names)} others are known, none like it."


def _fold(name: str) -> str:
    return "".join(look(clean(name)).split()).casefold()
