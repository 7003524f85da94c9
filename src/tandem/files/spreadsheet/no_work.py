"""Rows with a time that are likely no work of the cycle: breaks, getting ready, and totals or
figures that somebody numbered on.

As a task, a break would be done by whoever is free, and a set-up once in each product.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from tandem.cell.names import key
from tandem.files.spreadsheet.findings import Findings
from tandem.files.spreadsheet.outline import Row
from tandem.files.spreadsheet.rows import is_a_figure, is_total
from tandem.files.spreadsheet.said import enumerated, say
from tandem.files.spreadsheet.values import unit_named

NoWork = Literal["break", "setup", "figure"]

BREAK = re.compile(
    r"(?:(?:coffee|lunch|tea|meal|rest|short|morning|afternoon|kaffee|mittags?|fruehstuecks?|vesper"
    r"|brotzeit|kurz|erholungs?|arbeits)[ -]?)*(?:breaks?|pausen?)(?: ?(?:time|zeit))?"
    r"|lunch(?: ?time)?|mittag(?:essen)?|brotzeit|vesper|fruehstueck|erholung|recovery time"
)
SETUP = re.compile(
    r"set ?up(?: time)?|change ?over(?: time)?|tool change(?: ?over)?"
    r"|(?:um|auf|ab)?ruest(?:en|zeit(?:en)?|ung)|ruestvorgang|einricht(?:en|zeit)|werkzeugwechsel"
)
WAITING = re.compile(
    r"(?:ab)?wart(?:en|ezeit)|(?:aus|durch)haert(?:en|ung|ezeit)|(?:ab)?trockn(?:en|ung)"
    r"|(?:ab|aus)kuehlen|(?:wait(?:ing)?|cur(?:e|ing)|dry(?:ing)?|cool(?:ing)?(?: down)?)(?: time)?"
)
"""What goes on without anybody, mostly."""
SOMETIMES = re.compile(
    r"\b(?:optional|bei bedarf|falls (?:noetig|erforderlich)|if (?:needed|required|necessary)"
    r"|(?:nur|only) (?:bei|fuer|for|if|when|wenn|variant\w*)|every (?:\d+|nth)|jede[rns]? \d+"
    r"|alle \d+ (?:teile|stueck)|stichprobe\w*)\b"
)
"""Work that is not done each time."""


def reads_like_no_work(text: str, *, numbered: bool) -> NoWork | None:
    """What a task's name says if it is rather no work; None for any other name, and for one in
    double quotes.

    Args:
      numbered: the task has a number besides. Totals and figures without one are told by their
        place in the sheet.
    """
    plain = re.sub(r"[\[(][^\])]*[\])]|[\d.,%]+", " ", text)
    words = " ".join(word for word in key(plain).split() if not unit_named(word))
    if text[:1] == '"':
        return None
    if BREAK.fullmatch(words):
        return "break"
    if SETUP.fullmatch(words):
        return "setup"
    return "figure" if numbered and (is_total(text) or is_a_figure(text)) else None


def ask_what_is_no_work(
    rows: Sequence[Row], tasks: Mapping[str, Mapping[str, Any]], findings: Findings
) -> None:
    """A fault for breaks; for getting ready where nothing comes before or after it, as of work; and
    for totals and figures if besides no work stands below them.
    """
    _say_how_it_is_planned(rows, tasks, findings)
    linked = {link for task in tasks.values() for link in _links(task)}
    work_below = False
    for row in reversed(rows):
        task = tasks.get(row.name, {})
        text = str(task.get("label", row.name))
        what = None if row.quoted else reads_like_no_work(text, numbered="label" in task)
        place = findings.place_of(("tasks", row.name))
        alone = row.name not in linked and not _links(task)
        if (
            what == "break"
            or (what == "setup" and alone)
            or (what == "figure" and alone and not work_below)
        ):
            findings.fault(f"{text!r} {WAY_OUT[what]} {_in_quotes(row.name)}", place)
        elif what == "setup":
            findings.note("assumed", say("row.setup", text=repr(text)), place)
        work_below = work_below or what is None


def _say_how_it_is_planned(
    rows: Sequence[Row], tasks: Mapping[str, Mapping[str, Any]], findings: Findings
) -> None:
    """Notes for names that say that somebody need not be there, or not each time."""
    texts = {
        row.name: str(tasks[row.name].get("label", row.name))
        for row in rows
        if row.name in tasks and not row.quoted
    }
    for name, text in texts.items():
        first = re.split(r"[/(,;:–-]", text)[0]
        if WAITING.fullmatch(key(first)):
            place = findings.place_of(("tasks", name))
            findings.note("assumed", say("row.waiting", text=repr(text)), place)
    sometimes = [repr(text) for text in texts.values() if SOMETIMES.search(key(text))]
    if sometimes:
        findings.note("assumed", say("rows.sometimes", tasks=enumerated(sometimes)))


def _links(task: Mapping[str, Any]) -> list[str]:
    return [*task.get("after", ()), *(wait["after"] for wait in task.get("wait", ()))]


WAY_OUT: dict[NoWork, str] = {
    "break": (
        "reads like a break and is listed as a task. Take the row out, and give the break to who"
        " has it in a sheet 'Operators', in a column 'breaks', such as 300-600."
    ),
    "setup": (
        "reads like getting ready for the work, and no task comes before or after it. Take the row"
        " out, and write it into a sheet 'Operators', in a column 'setup [s]', or as the changeover"
        " of a tool into a sheet 'Tools'; or say what comes before it or after it."
    ),
    "figure": (
        "reads like a total or a figure, and no task comes before or after it. Take the row out, or"
        " say what comes before it or after it."
    ),
}


def _in_quotes(name: str) -> str:
    return f'If it is a task all the same, write {name!r} in double quotes: "{name}".'
