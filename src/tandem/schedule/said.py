"""Sentences of the checker that can be said in other languages too: each keeps what it is about."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from decimal import Decimal

from tandem.cell.language import Words, spoken

PACKAGE = "tandem.schedule"


class Said(str):
    """A sentence in English, which is what it equals and prints as.

    Attributes:
      key: its sentence in `words_en.json` and its like.
      values: what stands in it; see `said`.
      package: whose words these are.
    """

    key: str
    values: Mapping[str, object]
    package: str


def said(key: str, package: str = PACKAGE, /, **values: object) -> Said:
    """The sentence of a key among the words of a package.

    A Decimal is a number, a tuple of names or numbers a list of them; a tuple of tuples, names of
    which one group is needed; a `Said` is a part of the sentence. Anything else is written as it
    is.
    """
    sentence = Said(_rendered(spoken("en", package), key, values))
    sentence.key, sentence.values, sentence.package = key, values, package
    return sentence


def in_language(sentence: str, language: str) -> str:
    """The same sentence in a language; one that is only said in English stays as it is. Raises
    UsageError when there is no such language.
    """
    if not isinstance(sentence, Said):
        return sentence
    return _rendered(spoken(language, sentence.package), sentence.key, sentence.values)


def listed(names: Iterable[str], words: Words | None = None) -> str:
    """Names in a sentence: "a, b and c"; "nobody" for none. In English when no words are given."""
    t = words or spoken("en", PACKAGE)
    *most, last = list(names) or [t("nobody")]
    return f"{', '.join(most)} {t('and')} {last}" if most else last


def num(number: Decimal) -> str:
    """A number in a sentence, exactly."""
    return f"{number.normalize():f}" if abs(number) < Decimal(10) ** 15 else f"{number:.6g}"


def _rendered(words: Words, key: str, values: Mapping[str, object]) -> str:
    return words(key, **{name: _written(value, words) for name, value in values.items()})


def _written(value: object, words: Words) -> object:
    if isinstance(value, Said):
        return in_language(value, words.language)
    if isinstance(value, Decimal):
        return num(value).replace(".", words.sentences["decimal"])
    if not isinstance(value, tuple):
        return value
    if value and isinstance(value[0], Decimal):
        return f" {words('or')} ".join(f"{_written(number, words)} s" for number in value)
    if value and isinstance(value[0], tuple):
        # a comma parts groups of several, whose names have an "and" of their own
        comma = "," if any(len(group) > 1 for group in value) else ""
        return f"{comma} {words('or')} ".join(listed(group, words) for group in value)
    return listed((str(_written(name, words)) for name in value), words)
