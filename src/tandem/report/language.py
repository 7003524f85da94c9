"""The words of a report, in one file per language: `words_en.json` and its like hold every sentence that a reader sees."""

from __future__ import annotations

import json
from functools import lru_cache
from importlib import resources

from tandem.errors import UsageError


class Words:
    """Sentences by key, with places for values: `words("plan.title", n=2)`. A count chooses between `key.one` and `key.other`."""

    def __init__(self, language: str, sentences: dict[str, str]):
        self.language, self.sentences = language, sentences

    def __call__(self, key: str, **values: object) -> str:
        return self.sentences[key].format(**values)

    def count(self, key: str, n: int) -> str:
        """The sentence for one or for several."""
        return self(f"{key}.{'one' if n == 1 else 'other'}", n=n)


@lru_cache
def words(language: str = "en") -> Words:
    """The words of a language. Raises UsageError when there are none."""
    folder = resources.files("tandem.report")
    file = folder / f"words_{language}.json"
    if not language.isalpha() or not file.is_file():
        known = sorted(f.name[6:-5] for f in folder.iterdir() if f.name.startswith("words_") and f.name.endswith(".json"))
        raise UsageError(f"language {language!r}: reports speak {', '.join(known)}.")
    return Words(language, json.loads(file.read_text("utf-8")))
