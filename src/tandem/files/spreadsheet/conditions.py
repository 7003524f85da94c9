"""Several times of one operator under several conditions: "Human before" and "Human after", "Model
A human" and "Model B human", the left hand and the right one.

Read as they stand they would be several people who share the work, so the import asks.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from tandem.cell.names import key
from tandem.files.spreadsheet.findings import Findings, listed
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.vocabulary import CONDITIONS, KINDS, MACHINES, kind_of

VARIANT = re.compile(
    r"\b(model|modell|variant|variante|product|produkt|version|option|scenario|szenario|case|fall|trial|versuch"
    r"|run|lauf|obs|observation|messung|reading|shift|schicht) ?#?(\w+)\b|\bp\d\d\b"
    r"|\b\d+ ?(pcs?|pieces?|stk|stueck)\b"
)
"""A product, a variant, a shift or a reading by its letter or number, a percentile, a number of
pieces.
"""
SIDES = frozenset(("left", "right", "linke", "rechte", "links", "rechts"))
"""Words that are a condition beside "hand" alone: a left robot and a right one are two."""
STATION = re.compile(
    r"\b(?P<what>work ?station|station|arbeitsplatz|arbeitsstation|ap|st|stn|ws|linie|line)"
    r" ?(?:nr |no |# ?)?(?P<which>\d+|(?<=station )[a-z]|(?<=platz )[a-z]|(?<=line )[a-z]"
    r"|(?<=linie )[a-z])\b"
)
"""A station by its number or letter, within the name of an operator."""
LEAST = re.compile(r"(.+) min")
MOST = "max|maximum|maximal|avg|average|mean|mittel|mittelwert|typ|typical"


def ask_which_condition(table: Table, known: Collection[str], findings: Findings) -> None:
    """A fault for every group of columns that may be times of one and the same operator.

    Args:
      known: operators that a sheet of their own or an option names; they are no condition.
    """
    named = {key(name) for name in known}
    columns = [column for column in table.having("time") if _may_be_a_condition(column, named)]
    groups: dict[str, list[Column]] = {}
    for column in columns:
        groups.setdefault(_base(_who(column)), []).append(column)
    plain = {key(_who(column)) for column in columns}
    for base, several in groups.items():
        if len(several) > 1 and any(key(_who(column)) != base for column in several):
            _ask(base, several, findings)
    for column in columns:
        base = _kind_within(_who(column), plain)
        if base and _base(_who(column)) != base:
            other = next(c for c in columns if key(_who(c)) == base)
            _ask(base, [other, column], findings)
    _ask_which_station(columns, findings)
    _ask_about_the_least(table, findings)


def _ask_which_station(columns: Sequence[Column], findings: Findings) -> None:
    """ "Station 1 Human" and "Station 2 Human" are people of two cells, not two of one."""
    stations: dict[str, list[Column]] = {}
    for column in columns:
        name = key(_who(column))
        found = STATION.search(name)
        if found and STATION.sub("", name).strip():
            what = found["what"].title() if len(found["what"]) > 3 else found["what"].upper()
            stations.setdefault(f"{what} {found['which'].upper()}", []).append(column)
    if len(stations) < 2:
        return
    several = sorted(
        (column for own in stations.values() for column in own), key=lambda column: column.index
    )
    last = several[-1]
    kind = kind_of(_who(last)) or "human"
    findings.fault(
        f"{listed(repr(column.header) for column in several)}: the tasks of {listed(stations)}"
        " would be planned together, as one cell. Keep only the columns and the rows of one to plan"
        f' it alone (--map "{last.header}=ignore" leaves out a column); if it is one cell, say that'
        f' each is an operator of it, such as --{kind} "{_who(last)}".',
        last.place,
    )


def _may_be_a_condition(column: Column, named: Collection[str]) -> bool:
    what = column.meaning
    return (
        what is not None
        and len(what.who) == 1
        and not what.told
        and '"' not in column.header
        and key(what.who[0]) not in named
    )


def _who(column: Column) -> str:
    return column.meaning.who[0] if column.meaning else ""


def _base(name: str) -> str:
    """The name less the words of a condition, folded."""
    plain = VARIANT.sub(" ", key(name))
    words = plain.split()
    own = CONDITIONS if "hand" in words else CONDITIONS - SIDES
    return " ".join(word for word in words if word not in own)


def _kind_within(name: str, plain: Collection[str]) -> str:
    """Of "basic human" the "human" that has a column too; "" where the rest is a number or a
    letter, as in "Werker 2".
    """
    words = key(name).split()
    for word in words:
        rest = [other for other in words if other != word]
        if (
            word in plain
            and (word in KINDS or word in MACHINES)
            and rest
            and all(len(other) > 1 and not re.search(r"\d", other) for other in rest)
            and not any(other in KINDS for other in rest)
        ):
            return word
    return ""


def _ask(base: str, columns: Sequence[Column], findings: Findings) -> None:
    names = listed(repr(column.header) for column in columns)
    last = columns[-1]
    whose = f", {base!r}," if base else ""
    kind = kind_of(_who(last)) or "human"
    findings.fault(
        f"{names} may be times of one operator{whose} under several conditions, or of several"
        f' operators. Leave out all but one (--map "{last.header}=ignore"); if each is an operator'
        f' of its own, say so, such as --{kind} "{_who(last)}".',
        last.place,
    )


def _ask_about_the_least(table: Table, findings: Findings) -> None:
    """ "Human min" beside "Human max" is the least, and no minutes."""
    plain = {key(column.header) for column in table.columns}
    for column in table.having("time"):
        found = LEAST.fullmatch(key(column.header))
        bare = found and not re.search(r"[\[(]", column.header)
        if found and bare and column.meaning and not column.meaning.told:
            beside = next(
                (text for text in plain if re.fullmatch(f"{re.escape(found[1])} ({MOST})", text)),
                "",
            )
            if beside:
                findings.fault(
                    f"{column.header!r} stands beside {beside!r}, so 'min' may be the least and not"
                    " minutes. Say which time the plan is to count on, and its unit, with"
                    f' --map "{column.letter}=time {found[1]} [s]" (=ignore leaves a column out).',
                    column.place,
                )
