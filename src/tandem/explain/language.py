"""The words of answers: those of pictures, and `words_en.json` and its like beside this file."""

from __future__ import annotations

from collections.abc import Sequence

from tandem.cell.language import Words, spoken

__all__ = ["Words", "listed", "together", "words"]


def words(language: str = "en") -> Words:
    """The words of a language. Raises UsageError when there are none."""
    return spoken(language, "tandem.draw", "tandem.explain")


def together(t: Words, parts: Sequence[str]) -> str:
    """ "1", "1 and 2", "1, 2 and 4"."""
    return t("and", first=", ".join(parts[:-1]), last=parts[-1]) if len(parts) > 1 else parts[0]


def listed(t: Words, names: Sequence[str], *, word: bool = True) -> str:
    """ "tasks 1, 2 and 4", "task 1"; four and more numbers in a row as "1 to 16". Without `word`
    the names alone.
    """
    text = together(t, _runs(t, names))
    return t.count("tasks", len(names), names=text) if word else text


def _runs(t: Words, names: Sequence[str]) -> list[str]:
    runs: list[list[str]] = []
    for name in names:
        if (
            runs
            and name.isdecimal()
            and runs[-1][-1].isdecimal()
            and int(name) == int(runs[-1][-1]) + 1
        ):
            runs[-1].append(name)
        else:
            runs.append([name])
    return [
        text
        for run in runs
        for text in ([t("run", first=run[0], last=run[-1])] if len(run) > 3 else run)
    ]
