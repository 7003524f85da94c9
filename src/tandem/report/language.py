"""The words of a report: those of its pictures, and `words_en.json` and its like with every other
sentence that a reader sees.
"""

from __future__ import annotations

from functools import lru_cache

from tandem.draw.language import Words, sentences

__all__ = ["Words", "words"]


@lru_cache
def words(language: str = "en") -> Words:
    """The words of a language. Raises UsageError when there are none."""
    return Words(
        language, {**sentences("tandem.draw", language), **sentences("tandem.report", language)}
    )
