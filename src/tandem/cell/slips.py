"""Names that differ by no more than a slip of the pen: capitals, blanks, or one letter. "Presse",
"presse" and "Press" are such names.

Names that people number or letter on purpose are not: "jig 1" and "jig 2", "table A" and "table B".
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

SHORTEST = 4
"""Letters that a name needs before one letter more in another looks like a slip; before a wrong
letter does, it is one more.
"""


def slips(names: Iterable[str]) -> dict[str, str]:
    """A name -> the first of the names before it that is the same but for a slip; names like no
    earlier one are left out.

    Each name is filed under itself and under itself less any one letter; two names that are one
    slip apart meet under such an entry, so that thousands of names are compared in a moment.
    """
    filed: dict[str, list[tuple[int, str]]] = {}
    found: dict[str, str] = {}
    for place, name in enumerate(dict.fromkeys(names)):
        folded = _folded(name)
        entries = {folded, *(folded[:at] + folded[at + 1 :] for at in range(len(folded)))}
        earlier = {
            other
            for entry in entries
            for other in filed.get(entry, ())
            if a_slip_apart(name, other[1])
        }
        if earlier:
            found[name] = min(earlier)[1]
        else:
            for entry in entries:
                filed.setdefault(entry, []).append((place, name))
    return found


def a_slip_apart(one: str, other: str) -> bool:
    """Both are most likely meant to be one name."""
    short, long = sorted((_folded(one), _folded(other)), key=len)
    if short == long:
        return True
    start = next(
        (at for at, (a, b) in enumerate(zip(short, long, strict=False)) if a != b), len(short)
    )
    if len(long) == len(short) + 1:
        return (
            len(short) >= SHORTEST
            and short[start:] == long[start + 1 :]
            and long[start].isalpha()
            and not _is_a_mark(one, other, long[start])
        )
    if len(long) > len(short) or len(short) <= SHORTEST:
        return False
    if not (short[start].isalpha() and long[start].isalpha()):
        return False
    swapped = (
        short[start : start + 2] == long[start : start + 2][::-1]
        and short[start + 2 :] == long[start + 2 :]
    )
    return swapped or (
        start < len(short) - 1
        and short[start + 1 :] == long[start + 1 :]
        and not _is_a_mark(one, other, short[start])
    )


def _is_a_mark(one: str, other: str, letter: str) -> bool:
    """The letter stands alone in one of the names, as in "table A", "TableA" or "10a": it tells
    things of one kind apart.
    """
    words = (
        word for name in (one, other) for word in re.findall(r"[^\W\d_][^\W\d_A-Z]*|\d+", name)
    )
    return any(word.casefold() == letter for word in words)


def _folded(name: str) -> str:
    """What is left of a name when capitals, blanks and hyphens do not count; between digits they
    do.
    """
    plain = unicodedata.normalize("NFKC", name).casefold()
    return re.sub(r"(?<!\d)[\s_-]+|[\s_-]+(?!\d)", "", plain)
