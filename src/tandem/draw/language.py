"""The reader's language: sentences by key, and numbers as people write them there.

`words_en.json` and its like hold what pictures say; `tandem.report` adds what its pages say.
"""

from __future__ import annotations

import json
from functools import lru_cache
from importlib import resources

from tandem.cell import written
from tandem.errors import UsageError


class Words:
    """Sentences by key, with places for values: `words("plan.title", n=2)`. A count chooses between
    `key.one` and `key.other`.
    """

    def __init__(self, language: str, sentences: dict[str, str]):
        self.language, self.sentences = language, sentences

    def __call__(self, key: str, **values: object) -> str:
        return self.sentences[key].format(**values)

    def count(self, key: str, n: int) -> str:
        """The sentence for one or for several."""
        return self(f"{key}.{'one' if n == 1 else 'other'}", n=n)

    def number(self, value: float) -> str:
        """A number with this language's decimal mark; thousands are never separated."""
        return written.number(value).replace(".", self.sentences["decimal"])

    def seconds(self, value: float) -> str:
        """A time with its unit."""
        return f"{self.number(value)} s"

    def share(self, value: float) -> str:
        """A share of 1 as a percentage; below 10 % with one decimal."""
        return written.share(value).replace(".", self.sentences["decimal"])


def sentences(package: str, language: str) -> dict[str, str]:
    """What `package` says in a language, by key. Raises UsageError when it does not speak it."""
    folder = resources.files(package)
    file = folder / f"words_{language}.json"
    if not language.isalpha() or not file.is_file():
        known = sorted(
            f.name[6:-5]
            for f in folder.iterdir()
            if f.name.startswith("words_") and f.name.endswith(".json")
        )
        raise UsageError(f"language {language!r}: reports speak {', '.join(known)}.")
    found: dict[str, str] = json.loads(file.read_text("utf-8"))
    return found


@lru_cache
def words(language: str = "en") -> Words:
    """The words of pictures. Raises UsageError when there are none in this language."""
    return Words(language, sentences("tandem.draw", language))
