"""Remarks about a workbook, kept as what is said rather than in one language."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from tandem.cell.language import Words, spoken


@dataclass(frozen=True)
class Said:
    """A sentence, or a part of one, by its key in `words_en.json` and its like.

    Attributes:
      values: what stands in its places: text, another `Said`, or several texts to be listed.
    """

    key: str
    values: tuple[tuple[str, object], ...] = ()

    def __str__(self) -> str:
        return self.sentence()

    def sentence(self, language: str = "en") -> str:
        """In words. Raises UsageError for a language that nobody speaks here."""
        t = spoken(language, "tandem.files.spreadsheet")
        return t(self.key, **{name: _text(value, language, t) for name, value in self.values})


def say(key: str, **values: object) -> Said:
    """`Said` as it is written down where it comes to light."""
    return Said(key, tuple(values.items()))


def enumerated(items: Iterable[object], most: int = 200) -> Said:
    """Several things, joined by commas; the rest counted."""
    found = tuple(items)
    if len(found) <= most:
        return say("list", items=found)
    return say("list.cut", items=found[:most], n=len(found) - most)


def _text(value: object, language: str, t: Words) -> object:
    if isinstance(value, Said):
        return value.sentence(language)
    if isinstance(value, tuple):
        return ", ".join(str(_text(one, language, t)) for one in value)
    return value
