"""Ways of doing a task together, as planners write them: "W1 + W2", "Anna und UR5", "gemeinsam",
"beide", "both", "Team".

A word such as "gemeinsam" names nobody. It means the operators of the sheet where these are clear,
two of them; else the import asks.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

from tandem.cell.names import key
from tandem.files.spreadsheet.findings import Findings
from tandem.files.spreadsheet.grid import shown, tidy
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.said import say
from tandem.files.spreadsheet.vocabulary import JOINT, kind_of

EVERYBODY = {"alle", "all", "everybody", "everyone"}
"""Joint words that also say that nobody is left out."""
SMALL = {"im", "in", "als", "as", "a", "an", "the", "by", "von", "durch", "way"}
EITHER = r"\s*[/|]\s*|\s+(?:oder|or)\s+"
BOTH = r"\s*[+&]\s*|\s+(?:und|and|mit|with)\s+"


class WhoError(ValueError):
    """Why it is not clear who does it; the end of a sentence that begins with what was said."""


def ways(text: str, people: Sequence[str]) -> list[tuple[str, ...]]:
    """The ways that an entry names, each with its operators: "anna / ben" is one or the other,
    "anna + ben" both at once.

    Args:
      people: everybody whom the sheets name, joint words aside.

    Raises:
      WhoError: with the way out, when it may be either, or names too few.
    """
    if re.search(r"\[\s*\d+([.,]\d+)?\s*%?\s*\]", text):
        raise WhoError(
            "gives a share or a number of somebody, as project tools do, and here a person works on"
            " a task or does not: write the name alone, or 'A + B' for two"
        )
    named = {key(name): name for name in reversed(people)}
    if (alone := named.get(key(text))) is not None:
        return [(alone,)]
    rest, said = _without_joint_words(text)
    if said and not all(key(part) in named for part in re.split(rf"{EITHER}|{BOTH}", text)):
        return [_group(text, rest, said, people)]
    if re.search(r"[,;]", text):
        raise WhoError(
            "may be either or both: write 'A / B' when one of them does it, 'A + B' when both do it"
            " together"
        )
    choices = [part for part in re.split(EITHER, text) if part]
    return [
        (
            tuple(name for name in re.split(BOTH, choice) if name)
            if key(choice) not in named
            else (choice,)
        )
        for choice in choices
    ]


def _group(text: str, rest: str, said: set[str], people: Sequence[str]) -> tuple[str, ...]:
    names = tuple(tidy(part) for part in re.split(rf"[/|,;:()]|{BOTH}", rest) if tidy(part))
    if len(names) > 1:
        return names
    if not names and (len(people) == 2 or (len(people) > 2 and said & EVERYBODY)):
        return tuple(people)
    if names and said <= {"team"}:
        return (text,)
    those = f"The sheets name {_and(people)}" if people else "The sheets name nobody"
    example = " + ".join((*people, "A", "B")[:2])
    raise WhoError(
        f"does not say who takes part. {those}: write all who do it together, such as '{example}'"
    )


def _without_joint_words(text: str) -> tuple[str, set[str]]:
    """The text without words such as "together", and those words."""
    words = re.findall(r"[^\W_]+|[^\w\s]+|_", text)
    said = {key(word) for word in words if key(word) in JOINT}
    if not said:
        return text, said
    pieces = re.split(r"(\s+|[/|,;:()+&])", text)
    return (
        tidy(
            "".join(
                piece for piece in pieces if key(piece) not in JOINT and key(piece) not in SMALL
            )
        ),
        said,
    )


def _and(names: Iterable[str]) -> str:
    quoted = [repr(name) for name in names]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}"


def people_in(table: Table, known: Iterable[str]) -> list[str]:
    """Everybody whom the headers, the rows or other sheets name, in that order, joint words
    aside.
    """
    names = [
        name for column in table.having("time") if column.meaning for name in column.meaning.who
    ]
    for column in table.having("operator"):
        for row in range(table.first_row, len(table.grid.rows)):
            names += re.split(
                rf"[,;]|{EITHER}|{BOTH}",
                _without_joint_words(shown(table.grid.rows[row][column.index]))[0],
            )
    own = [name for name in map(tidy, names) if name and key(name) not in JOINT and "/" not in name]
    return list({key(name): name for name in reversed([*known, *own])}.values())[::-1]


# --- headers --------------------------------------------------------------------------------------


def with_joint_ways(table: Table, known: Sequence[str], findings: Findings) -> Table:
    """The table with operators in the place of joint words: "Zeit gemeinsam [s]" is a time of those
    whom the other columns name.
    """
    people = people_in(table, known)
    return replace(
        table, columns=tuple(_with_group(column, people, findings) for column in table.columns)
    )


def _with_group(column: Column, people: Sequence[str], findings: Findings) -> Column:
    what = column.meaning
    if what is None or not what.who or what.human:
        return column
    named = {key(name) for name in people}
    name = " + ".join(what.who)
    either = [part for part in re.split(EITHER, name) if part]
    if (
        len(what.who) == 1
        and len(either) > 1
        and key(name) not in named
        and all(key(part) in named or kind_of(part) for part in either)
    ):
        findings.fault(
            f"{column.header!r} may be the time of either or of both. Write '{' + '.join(either)}'"
            " into the header when they do it together, or give each a column of its own.",
            column.place,
        )
        return replace(column, meaning=None, why=say("why.either"))
    if (
        all(key(one) in named for one in what.who)
        or key(name) in named
        or not _without_joint_words(name)[1]
    ):
        return column
    try:
        return replace(column, meaning=replace(what, who=ways(name, people)[0]))
    except WhoError as error:
        findings.fault(f"{column.header!r} {error}.", column.place)
        return replace(column, meaning=None, why=say("why.who"))
