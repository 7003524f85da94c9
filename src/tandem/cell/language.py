"""The reader's language: sentences by key, and numbers as people write them there.

Each room that speaks to people has a `words_en.json` and its like beside its code; `spoken` puts
those of several rooms together. What all of them need, the decimal mark, stands here.
"""

from __future__ import annotations

import json
from functools import lru_cache
from importlib import resources

from tandem.cell import written
from tandem.errors import UsageError

LANGUAGES = ("en", "de")
"""What every room speaks; the first when nothing is said."""


class Words:
    """Sentences by key, with places for values: `words("plan.title", n=2)`. A count chooses between
    `key.one` and `key.other`.
    """

    def __init__(self, language: str, sentences: dict[str, str]):
        self.language, self.sentences = language, sentences

    def __call__(self, key: str, **values: object) -> str:
        return self.sentences[key].format(**values)

    def count(self, key: str, n: int, **values: object) -> str:
        """The sentence for one or for several."""
        return self(f"{key}.{'one' if n == 1 else 'other'}", n=n, **values)

    def number(self, value: float) -> str:
        """A number with this language's decimal mark; thousands are never separated."""
        return self._marked(written.number(value))

    def signed(self, value: float) -> str:
        """A difference with its sign."""
        return self._marked(written.signed(value))

    def seconds(self, value: float) -> str:
        """A time with its unit."""
        return f"{self.number(value)} s"

    def share(self, value: float) -> str:
        """A share of 1 as a percentage; below 10 % with one decimal."""
        return self._marked(written.share(value))

    def _marked(self, text: str) -> str:
        return text.replace(".", self.sentences["decimal"])


def sentences(package: str, language: str) -> dict[str, str]:
    """What `package` says in a language, by key. Raises UsageError when it does not speak it."""
    if language not in LANGUAGES:
        raise UsageError(f"language {language!r}: reports speak {', '.join(sorted(LANGUAGES))}.")
    file = resources.files(package) / f"words_{language}.json"
    found: dict[str, str] = json.loads(file.read_text("utf-8"))
    return found


@lru_cache
def spoken(language: str, *packages: str) -> Words:
    """The words of these rooms in a language. Raises UsageError when they do not speak it."""
    found: dict[str, str] = {}
    for package in ("tandem.cell", *packages):
        found |= sentences(package, language)
    return Words(language, found)
