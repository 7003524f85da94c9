"""The words of pictures: `words_en.json` and its like, with what axes, legends and titles say."""

from __future__ import annotations

from tandem.cell.language import Words, spoken

__all__ = ["Words", "words"]


def words(language: str = "en") -> Words:
    """The words of a language. Raises UsageError when there are none."""
    return spoken(language, "tandem.draw")
