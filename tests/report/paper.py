"""Instruction sheets as a reader of the page has them: text alone, taken apart without the words
and functions that wrote it.
"""

from __future__ import annotations

import random
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from html.parser import HTMLParser

SAID = {
    "en": {
        "title": r"Instructions for (.+)",
        "done": r"(?P<task>.+) is done \((?:call|signal) from (?P<who>.+)\)",
        "tool": r"tool (?P<name>.+) is free \((?P<who>.+) is done with (?P<task>.+)\)",
        "zone": r"zone (?P<name>.+) is free \((?P<who>.+) is done with (?P<task>.+) and out\)",
        "partner": r"(?P<who>.+) is ready too",
        "break": r"your break is over \((?P<off>.+) to (?P<back>.+) s\)",
        "setup": (
            r"you are set up \(set up first: (?P<seconds>.+) s, (?P<begin>.+) to (?P<ready>.+) s\)"
        ),
        "release": r"it is (?P<release>.+) s or later",
        "previous": r"your last task is done",
        "start": r"at once",
    },
    "de": {
        "title": r"Anweisung für (.+)",
        "done": r"wenn (?P<task>.+) fertig ist \((?:Zuruf|Anzeige) von (?P<who>.+)\)",
        "tool": r"wenn Werkzeug (?P<name>.+) frei ist \((?P<who>.+) ist mit (?P<task>.+) fertig\)",
        "zone": (
            r"wenn Bereich (?P<name>.+) frei ist \((?P<who>.+) ist mit (?P<task>.+) fertig und"
            r" heraus\)"
        ),
        "partner": r"wenn auch (?P<who>.+) bereit ist",
        "break": r"wenn die eigene Pause vorbei ist \((?P<off>.+) bis (?P<back>.+) s\)",
        "setup": (
            r"wenn der eigene Platz gerüstet ist \(zuerst rüsten: (?P<seconds>.+) s, (?P<begin>.+)"
            r" bis (?P<ready>.+) s\)"
        ),
        "release": r"nicht vor (?P<release>.+) s",
        "previous": r"wenn der letzte eigene Vorgang fertig ist",
        "start": r"sofort",
    },
}
KINDS = {"release": "release", "ready": "setup"}
"""What a moment is called in a sentence -> the kind of sentence."""
HEADS = {
    "en": {
        "what to do": "task",
        "tool": "tool",
        "zone": "zone",
        "together with": "with",
        "begin when": "wait",
        "then tell": "tell",
    },
    "de": {
        "was zu tun ist": "task",
        "Werkzeug": "tool",
        "Bereich": "zone",
        "zusammen mit": "with",
        "anfangen": "wait",
        "danach melden": "tell",
    },
}


@dataclass
class Row:
    """One turn. `conditions`: kind -> what the places in the sentences of that kind hold."""

    task: str
    cells: Mapping[str, str]
    conditions: dict[str, list[dict[str, str]]] = field(default_factory=dict)
    tell: list[str] = field(default_factory=list)

    def told(self, kind: str) -> set[tuple[str, ...]]:
        return {tuple(values.values()) for values in self.conditions.get(kind, [])}


class _Reader(HTMLParser):
    """Every `details.sheet` of a page: its heading and the rows of its table; a `div` within a cell
    is a line.
    """

    def __init__(self) -> None:
        super().__init__()
        self.sheets: list[tuple[list[str], list[list[list[str]]]]] = []
        self.inside, self.open = False, ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "details":
            self.inside = True
            self.sheets.append(([""], []))
        elif self.inside and tag == "tr":
            self.sheets[-1][1].append([])
        elif self.inside and tag in ("td", "th"):
            self.sheets[-1][1][-1].append([""])
            self.open = "cell"
        elif self.inside and tag == "div" and self.open == "cell":
            self.sheets[-1][1][-1][-1].append("")
        elif self.inside and tag == "h3":
            self.open = "heading"

    def handle_endtag(self, tag: str) -> None:
        if tag == "details":
            self.inside = False
        if tag in ("td", "th", "h3"):
            self.open = ""

    def handle_data(self, data: str) -> None:
        if self.inside and self.open == "heading":
            self.sheets[-1][0][0] += data
        elif self.inside and self.open == "cell":
            self.sheets[-1][1][-1][-1][-1] += data


def sheets_of(page: str, language: str) -> dict[str, list[Row]]:
    """Operator -> turns, of a page with one plan. Every sentence under "begin when" must be one
    that is known.
    """
    reader = _Reader()
    reader.feed(page)
    found = {}
    for heading, rows in reader.sheets:
        (who,) = re.fullmatch(SAID[language]["title"], heading[0]).groups()  # type: ignore[union-attr]
        # a line across the table says on paper whose page it is
        head, *turns = [row for row in rows if len(row) > 1] or [[]]
        found[who] = [_row(head, row, language) for row in turns]
    return found


def _row(head: list[list[str]], row: list[list[str]], language: str) -> Row:
    lines = {
        HEADS[language].get(name[0], name[0]): [line for line in cell if line]
        for name, cell in zip(head, row, strict=True)
    }
    turn = Row(
        lines["task"][0], {key: " ".join(value) for key, value in lines.items()}, tell=lines["tell"]
    )
    for sentence in lines["wait"]:
        kind, match = next(
            (kind, match)
            for kind, pattern in SAID[language].items()
            if kind != "title" and (match := re.fullmatch(pattern, sentence))
        )
        turn.conditions.setdefault(kind, []).append(match.groupdict())
    return turn


@dataclass(frozen=True)
class Worked:
    """One task as people did it by their sheets: moments in seconds, who, with which tool and in
    which zone.
    """

    task: str
    start: float
    end: float
    who: frozenset[str]


def work_by(sheets: Mapping[str, list[Row]], chance: random.Random) -> list[Worked]:
    """Everybody does their own sheet from top to bottom, knows nothing else, and every task takes a
    time of its own by chance.

    Raises AssertionError when all wait for each other.
    """
    place, free, done = dict.fromkeys(sheets, 0), dict.fromkeys(sheets, 0.0), {}
    worked: list[Worked] = []
    while waiting := [who for who in sheets if place[who] < len(sheets[who])]:
        ready = [found for who in waiting if (found := _may_begin(sheets, place, free, done, who))]
        assert ready, f"nobody can go on: {[(who, sheets[who][place[who]]) for who in waiting]}"
        start, task, who = min(ready, key=lambda found: found[:2])
        end = start + chance.choice((0.1, 1.0, 3.0, 10.0))
        worked.append(Worked(task, start, end, who))
        done[task] = end
        for one in who:
            place[one], free[one] = place[one] + 1, end
    return worked


def _may_begin(
    sheets: Mapping[str, list[Row]],
    place: Mapping[str, int],
    free: Mapping[str, float],
    done: Mapping[str, float],
    who: str,
) -> tuple[float, str, frozenset[str]] | None:
    """When the operator can begin the next turn, with whom; None while something is not done or a
    partner is elsewhere.
    """
    turn = sheets[who][place[who]]
    together = frozenset({who, *(one for (one,) in turn.told("partner"))})
    turns = []
    for one in together:
        if place[one] >= len(sheets[one]) or sheets[one][place[one]].task != turn.task:
            return None
        turns.append(sheets[one][place[one]])
    needed = {
        values["task"]
        for t in turns
        for kind in ("done", "tool", "zone")
        for values in t.conditions.get(kind, [])
    }
    if not needed <= set(done):
        return None
    moments = [
        values[kind]
        for t in turns
        for kind in ("release", "ready")
        for values in t.conditions.get(KINDS[kind], [])
    ]
    told = [float(moment.replace(",", ".")) for moment in moments]
    return (
        max([*told, *(free[one] for one in together), *(done[task] for task in needed)]),
        turn.task,
        together,
    )
