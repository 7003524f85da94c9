"""Columns that are not read and yet say something against what was read: that the robot cannot,
that a task is deleted, that a link is none from end to start.

What merely is not read is a note; what contradicts the plan is asked about, at its cell.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator

from tandem.cell.names import key
from tandem.cell.parts import Kind
from tandem.files.spreadsheet.findings import Findings, listed
from tandem.files.spreadsheet.grid import Value, blank, shown, tidy
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.precedence import END_TO_START
from tandem.files.spreadsheet.said import Said, enumerated, say
from tandem.files.spreadsheet.values import UnreadableError, cannot, number, says_able
from tandem.files.spreadsheet.vocabulary import KINDS, PEOPLE, bound_of, kind_of, split_unit

POSSIBLE = re.compile(
    r"\b(possible|feasible|feasibility|capable|suitable|suitability|allowed|able|ok|automatable"
    r"|automatisierbar\w*"
    r"|machbar\w*|moeglich\w*|geeignet|eignung|faehig\w*|tauglich\w*|robot\w*(tauglich|faehig)\w*)\b"
)
ROBOTS = re.compile(r"\b(automat\w*|robo\w*|cobot\w*|kobot\w*)")
ONLY = re.compile(r"(?:only|nur)\s+(.+)|(.+?)\s+(?:only|nur)")
ACTIVE = re.compile(r"(is )?(active|aktiv|included?|enabled|einplanen|relevant|in scope)")
DEAD = re.compile(
    r"(is )?(inactive|inaktiv|deleted|geloescht|obsolete|entfaellt|entfallen|gestrichen|cancell?ed"
    r"|removed|disabled)"
)
"""Headers, and values, that say that a task is no more."""
LINK_KIND = re.compile(
    r"(relation|link|dependency|beziehungs?|anordnungsbeziehung)( ?(type|typ|art))?|type|typ|art"
)
NOT_FROM_END = re.compile(
    r"ss|aa|ff|ee|sf|ae|(start|anfang)[ -]?(to )?[ -]?(start|anfang|finish|end|ende)"
    r"|(finish|end|ende)[ -]?(to )?[ -]?(finish|end|ende)"
)
LAG = re.compile(r"lag( time)?|zeitabstand|time lag|lead lag")
COUNT = re.compile(
    r"basismenge|losgroesse|lot size|batch( size)?|base quantity|every .+|je(de[rns]?)? .+ zyklus"
    r"|cycles|zyklen|occurrences?|freq\w*( .+)?|haeufigkeit.*|(no|number|count) of .+|anzahl .+"
    r"|crew( size)?|repeats?|wdh|auftreten.*"
)
STATION = re.compile(
    r"(work ?)?stations?( (no|nr|name|id))?|workplace|arbeitsplatz( nr)?|arbeitsstation"
    r"|arbeitssystem|ap|line|linie"
)
TOTAL = re.compile(r"\b(total|gesamt\w*|sum|summe)\b")


def why_unread(table: Table, column: Column, rows: list[int]) -> Said | None:
    """What follows from leaving a column out, where that can be told."""
    name = key(split_unit(column.header)[0])
    values = [value for row in rows if not blank(value := table.grid.value(row, column.index))]
    if STATION.fullmatch(name):
        several = list(dict.fromkeys(map(shown, values)))
        return say("why.stations", stations=enumerated(several, 12)) if len(several) > 1 else None
    if COUNT.fullmatch(name) and any(shown(value) not in ("1", "100 %", "-") for value in values):
        return say("why.once")
    names = {key(who) for c in table.having("time") if c.meaning for who in c.meaning.who}
    if names and values and all(_names_somebody(value, names) for value in values):
        return say("why.plan")
    return None


def _names_somebody(value: Value, names: set[str]) -> bool:
    parts = re.split(r"[/|+&,;]", shown(value)) if isinstance(value, str) else []
    return bool(parts) and all(key(part) in names or key(part) in KINDS for part in parts)


def ask_about_contradictions(table: Table, rows: list[int], findings: Findings) -> None:
    """Faults for the columns that contradict what was read of the rows."""
    for column in table.columns:
        what = column.meaning
        if what is not None and what.what != "ignore" and not what.told:
            findings.sound(table.grid, table.header_row, column.index)
        if not column.header or (what is not None and (what.what != "ignore" or what.told)):
            continue
        if what is None:
            _ask_who_can(table, column, rows, findings)
            _ask_about_links(table, column, rows, findings)
            _ask_about_the_total(table, column, rows, findings)
        _ask_about_the_dead(table, column, rows, findings)
    _ask_how_many(table, rows, findings)
    _ask_who_was_left_out(table, findings)


def _ask_who_was_left_out(table: Table, findings: Findings) -> None:
    """ "Human cycle 1 [s]" beside "Robot [s]": without it, nobody but the robot would work."""
    planned = {
        kind_of(who)
        for column in table.having("time", "able")
        for who in (column.meaning.who if column.meaning else ())
    }
    for column in table.columns if planned - {None} else ():
        name, unit = split_unit(column.header)
        kinds = {KINDS[word] for word in key(name).split() if word in KINDS and len(word) > 1}
        left_out = column.meaning is None and unit and len(kinds) == 1 and not kinds & planned
        if left_out and not bound_of(column.header):
            who = kinds.pop()
            findings.fault(
                f"{column.header!r} is not read, and no other column holds a time of a {who}. Say"
                f' what it means, such as --map "{column.header}=time {who} [{unit}]"'
                " (=ignore leaves it out).",
                column.place,
            )
            planned.add(who)


def _cells(table: Table, column: Column, rows: list[int]) -> Iterator[tuple[int, Value, str]]:
    """`(row, value, folded text)` of the cells that hold something."""
    for row in rows:
        value = table.grid.value(row, column.index)
        if not blank(value):
            yield row, value, key(shown(value))


def _ask_who_can(table: Table, column: Column, rows: list[int], findings: Findings) -> None:
    header = key(column.header)
    asks = POSSIBLE.search(header) is not None
    of: Kind | None = None
    if asks:
        of = "robot" if ROBOTS.search(header) else kind_of(POSSIBLE.sub(" ", header))
    for row, value, text in _cells(table, column, rows):
        only = ONLY.fullmatch(text)
        barred: Kind | None = None
        if only and (alone := kind_of(only[1] or only[2])):
            barred = "robot" if alone == "human" else "human"
        elif of and (says_able(value) is False or text in ("no", "nein", "n")):
            barred = of
        if barred and (there := _time_of(table, row, barred)):
            findings.fault(
                f"{column.header!r} says {shown(value)!r}, and {there} holds a time of a {barred}"
                " for the same task. Clear that time if it is not to count, or say"
                f' --map "{column.header}=ignore".',
                table.grid.place(row, column.index),
            )


def _time_of(table: Table, row: int, kind: Kind) -> str:
    """Where the row has a time of an operator of that kind alone."""
    for column in table.having("time"):
        who = column.meaning.who if column.meaning else ()
        stated = not cannot(table.grid.value(row, column.index))
        if stated and len(who) == 1 and kind_of(who[0]) == kind:
            return f"{column.letter}{row + 1}"
    return ""


def _ask_about_the_dead(table: Table, column: Column, rows: list[int], findings: Findings) -> None:
    header = key(column.header)
    dead = []
    for row, value, text in _cells(table, column, rows):
        able = says_able(value)
        if (
            DEAD.fullmatch(text)
            or (ACTIVE.fullmatch(header) and able is False)
            or (DEAD.fullmatch(header) and able)
        ):
            dead.append(row)
    if dead:
        said = shown(table.grid.value(dead[0], column.index))
        numbers = listed(row + 1 for row in dead)
        which = f"row {numbers} is" if len(dead) == 1 else f"rows {numbers} are"
        findings.fault(
            f"{column.header!r} says {said!r}, so {which} perhaps no work any more. Delete"
            f' what is not to be planned, or say --map "{column.header}=ignore" to plan it.',
            table.grid.place(dead[0], column.index),
        )


def _ask_about_links(table: Table, column: Column, rows: list[int], findings: Findings) -> None:
    if not table.having("after", "after rows", "before"):
        return
    name = key(split_unit(column.header)[0])
    for row, value, text in _cells(table, column, rows):
        kind = LINK_KIND.fullmatch(name) and text not in END_TO_START
        if kind and NOT_FROM_END.fullmatch(text):
            findings.fault(
                f"holds {shown(value)!r}: a list of predecessors knows only links from end to start"
                " (FS). Write such a link as a wait, such as 'glue (start) >= 0' in a column 'Wait"
                f' after\', or say --map "{column.header}=ignore".',
                table.grid.place(row, column.index),
            )
        elif LAG.fullmatch(name) and not cannot(value):
            findings.fault(
                f"holds {shown(value)!r}, a wait between tasks that is not read here. Write it into"
                " a column 'Wait after', such as 'glue >= 40', or say"
                f' --map "{column.header}=ignore".',
                table.grid.place(row, column.index),
            )


def _ask_about_the_total(table: Table, column: Column, rows: list[int], findings: Findings) -> None:
    """ "Total time" that is the time of the task times "Qty" shows that the time is that of one."""
    counts = table.having("quantity")
    if not counts or not TOTAL.search(key(column.header)):
        return
    for time in table.having("time"):
        if time.meaning is None or time.meaning.per_piece:
            continue
        triples = [
            tuple(_number(table, row, c, findings) for c in (time, counts[0], column))
            for row in rows
        ]
        whole = [t for t in triples if None not in t]
        if (
            len(whole) > 0
            and any(many != 1 for _, many, _ in whole)
            and all(abs(one * many - total) < 1e-6 for one, many, total in whole)  # type: ignore[operator]
        ):
            findings.fault(
                f"{column.header!r} is {time.header!r} times {counts[0].header!r}, so that is the"
                " time of one piece. Write 'per piece' into its header, or leave it out"
                f' (--map "{time.header}=ignore") and say what {column.header!r} is'
                f' (--map "{column.header}=time human [s]").',
                column.place,
            )
            return


def _number(table: Table, row: int, column: Column, findings: Findings) -> float | None:
    try:
        return float(number(table.grid.value(row, column.index), findings.marks).value)
    except UnreadableError:
        return None


def _ask_how_many(table: Table, rows: list[int], findings: Findings) -> None:
    """ "Workers" with 1 and 2 beside times with a unit is how many there are, not how long."""
    times = table.having("time")
    if not any(c.meaning and c.meaning.unit for c in times):
        return
    for column in times:
        what = column.meaning
        if what is None or what.unit or what.told or key(column.header) not in PEOPLE:
            continue
        values = [value for _, value, _ in _cells(table, column, rows)]
        if values and all(re.fullmatch(r"[0-9]", shown(value)) for value in values):
            findings.fault(
                f"{column.header!r} may be how many people a task takes, or how long it takes them."
                f' Say --map "{column.header}=ignore", or write the unit into the header.',
                column.place,
            )


HOW_MANY = re.compile(
    r"\d+ ?[x×]? ?(?P<behind>[^\W\d].*)|(?P<before>.+?) ?(?:\(\d+\)|[x×] ?\d+)", re.IGNORECASE
)
"""Several of somebody: "2 Werker", "2x Human", "Werker (2)", "Human x 2"; "Werker 2" is a name."""


def ask_how_many_people(
    table: Table, rows: list[int], known: Collection[str], findings: Findings
) -> None:
    """ "2 Werker" in a column of operators is no third person beside "Werker".

    Args:
      known: operators that a sheet of their own or an option names.
    """
    named = {tidy(name) for name in known}
    for column in table.having("operator"):
        for row, value, _ in _cells(table, column, rows):
            text = shown(value)
            found = HOW_MANY.fullmatch(text)
            words = key(found["behind"] or found["before"]).split() if found else []
            kinds = [KINDS[word] for word in words if word in KINDS and len(word) > 1]
            if text not in named and kinds and len(kinds) == len(words):
                findings.fault(
                    f"holds {text!r}, which may say how many people the task takes. Give each of"
                    f" them a name and write 'A + B' for two; --{kinds[0]} {text!r} says that"
                    " somebody is called so.",
                    table.grid.place(row, column.index),
                )
