"""The words of a report: those of its pictures, and `words_en.json` and its like with every other
sentence that a reader sees.
"""

from __future__ import annotations

from tandem.cell.language import Words, spoken

__all__ = ["Words", "words"]


def words(language: str = "en") -> Words:
    """The words of a language. Raises UsageError when there are none."""
    return spoken(language, "tandem.draw", "tandem.report")
