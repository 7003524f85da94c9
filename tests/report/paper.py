"""Instruction sheets as a reader of the page has them: text alone, taken apart without the words
and functions that wrote it; and people who know nothing but these sheets, at work.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from html.parser import HTMLParser

SAID = {
    "en": {
        "title": r"Instructions for (.+)",
        "breaks": r"Breaks: (.+)\. Begin nothing that would run into one\.",
        "span": r"(?P<off>\S+) to (?P<back>\S+) s",
        "start": r"at once",
        "previous": r"previous step done",
        "own": r"own tasks done: (?P<tasks>.+)",
        "both": r"previous step done, and own tasks: (?P<tasks>.+)",
        "break": r"own break over \((?P<off>\S+) to (?P<back>\S+) s\)",
        "release": r"(?P<release>\S+) s passed since the start",
        "lag.end": (
            r"(?:(?P<exact>exactly )?(?P<least>\S+) s |at the latest (?P<most>\S+) s )?after"
            r" (?P<who>.+) ended (?P<task>.+?)(?:, at the latest (?P<until>\S+) s)?"
        ),
        "lag.start": (
            r"(?:(?P<exact>exactly )?(?P<least>\S+) s |at the latest (?P<most>\S+) s )?after"
            r" (?P<who>.+) began (?P<task>.+?)(?:, at the latest (?P<until>\S+) s)?"
        ),
        "hold": r"not before (?P<hold>\S+) s, so that (?P<tasks>.+) can follow in time",
        "tool.room": (
            r"one of (?P<places>\d+) (?P<name>.+) free: at most (?P<spare>\d+) not done of"
            r" (?P<those>.+)"
        ),
        "zone.room": (
            r"room in zone (?P<name>.+) for (?P<places>\d+): at most (?P<spare>\d+) not out of"
            r" (?P<those>.+)"
        ),
        "freed": r"(?P<who>.+) done with (?P<task>.+) \((?P<freed>.+ (?:free|zone).*)\)",
        "done": r"(?P<who>.+) done with (?P<task>.+)",
        "partner": r"(?P<who>.+) ready too",
        "tool": r"tool (.+) free",
        "zone": r"out of zone (.+)",
        "with": r"(.+) with (.+)",
        "own then": r"own tasks: (.+)",
        "freed then": r"(.+) with (.+) \(((?:tool|zone|machine) .+)\)",
        "wait then": (
            r"(.+) with (.+) \((?:\S+ s to \S+ s later|\S+ s later at the earliest"
            r"|exactly \S+ s later|within \S+ s|at once)"
            r"(, counted from the beginning of this step)?\)"
        ),
        "change": r"change over to (.+): (\S+) s",
        "setup": r"set up: (\S+) s",
        "walk": r"go from (.+) to (.+): (\S+) s",
    },
    "de": {
        "title": r"Anweisung für (.+)",
        "breaks": r"Pausen: (.+)\. Nichts anfangen, was in eine Pause reichen würde\.",
        "span": r"(?P<off>\S+) bis (?P<back>\S+) s",
        "start": r"sofort",
        "previous": r"voriger Schritt fertig",
        "own": r"eigene Vorgänge fertig: (?P<tasks>.+)",
        "both": r"voriger Schritt fertig und eigene Vorgänge: (?P<tasks>.+)",
        "break": r"eigene Pause vorbei \((?P<off>\S+) bis (?P<back>\S+) s\)",
        "release": r"(?P<release>\S+) s seit Beginn vergangen",
        "lag.end": (
            r"(?:(?P<exact>genau )?(?P<least>\S+) s |spätestens (?P<most>\S+) s )?nach dem Ende von"
            r" (?P<task>.+) \((?P<who>[^()]+)\)(?:, spätestens (?P<until>\S+) s)?"
        ),
        "lag.start": (
            r"(?:(?P<exact>genau )?(?P<least>\S+) s |spätestens (?P<most>\S+) s )?nach dem Beginn"
            r" von (?P<task>.+) \((?P<who>[^()]+)\)(?:, spätestens (?P<until>\S+) s)?"
        ),
        "hold": r"nicht vor (?P<hold>\S+) s, damit (?P<tasks>.+) rechtzeitig folgen kann",
        "tool.room": (
            r"eines von (?P<places>\d+) Stück (?P<name>.+) frei: höchstens (?P<spare>\d+) nicht"
            r" fertig von (?P<those>.+)"
        ),
        "zone.room": (
            r"Platz im Bereich (?P<name>.+) für (?P<places>\d+): höchstens (?P<spare>\d+) nicht"
            r" heraus von (?P<those>.+)"
        ),
        "freed": (
            r"(?P<who>.+) fertig mit (?P<task>.+)"
            r" \((?P<freed>.*(?:Werkzeug .+|Bereich .+| frei))\)"
        ),
        "done": r"(?P<who>.+) fertig mit (?P<task>.+)",
        "partner": r"(?P<who>.+) auch bereit",
        "tool": r"Werkzeug (.+) frei",
        "zone": r"heraus aus Bereich (.+)",
        "with": r"(.+) mit (.+)",
        "own then": r"eigene Vorgänge: (.+)",
        "freed then": r"(.+) mit (.+) \(((?:Werkzeug|Bereich|Maschine) .+)\)",
        "wait then": (
            r"(.+) mit (.+) \((?:\S+ s bis \S+ s später|(?:genau |frühestens )\S+ s später"
            r"|innerhalb von \S+ s|sofort)(, vom Beginn dieses Schritts an)?\)"
        ),
        "change": r"wechseln auf (.+): (\S+) s",
        "setup": r"rüsten: (\S+) s",
        "walk": r"von (.+) zu (.+) gehen: (\S+) s",
    },
}
CONDITIONS = (
    *("start", "previous", "both", "own", "break", "release"),
    *("tool.room", "zone.room", "freed", "done", "partner"),
    *("lag.end", "lag.start", "hold"),
)
HEADS = {
    "en": {
        "step": "number",
        "task": "task",
        "what to do": "does",
        "with": "means",
        "begin when": "begin",
        "then can begin": "then",
        "start [s]": "start",
        "end [s]": "end",
        "latest end [s]": "deadline",
    },
    "de": {
        "Schritt": "number",
        "Vorgang": "task",
        "was zu tun ist": "does",
        "womit, wo, mit wem": "means",
        "anfangen, wenn": "begin",
        "danach kann anfangen": "then",
        "Beginn [s]": "start",
        "Ende [s]": "end",
        "spätestes Ende [s]": "deadline",
    },
}


@dataclass
class Row:
    """One step as it is printed.

    Attributes:
      task: its name, empty for a walk, a changeover and for setting up.
      change: (tool, seconds) of a changeover, ("FROM -> TO", seconds) of a walk; the tool is empty
        for setting up.
      cells: column -> its lines.
      conditions: kind -> what the places in the sentences of that kind hold.
      bold: the sentences in bold, and the kind of each.
      own, others: names of tasks that can begin then: those of this sheet; (who, task, tools and
        zones that become free).
    """

    task: str
    change: tuple[str, Decimal] | None
    cells: Mapping[str, list[str]]
    conditions: dict[str, list[dict[str, str]]] = field(default_factory=dict)
    bold: list[tuple[str, str]] = field(default_factory=list)
    own: tuple[str, ...] = ()
    others: list[tuple[str, str, frozenset[tuple[str, str]]]] = field(default_factory=list)

    def told(self, kind: str) -> set[tuple[str, ...]]:
        return {tuple(values.values()) for values in self.conditions.get(kind, [])}

    def waits_for(self) -> set[tuple[str, str]]:
        """(who, task) of all that others must have done."""
        found = (*self.conditions.get("done", []), *self.conditions.get("freed", []))
        return {(values["who"], values["task"]) for values in found}

    def lags(self, kind: str) -> set[tuple[str, str, Decimal, Decimal | None]]:
        """(who, task, seconds at least, at most) of the waits after an "end" or a "start"."""
        return {
            (
                values["who"],
                values["task"],
                number(values["least"] or "0"),
                None
                if not (most := values["most"] or values["until"] or values["exact"])
                else number(values["least"] if values["exact"] else most),
            )
            for values in self.conditions.get(f"lag.{kind}", [])
        }

    def own_before(self) -> set[str]:
        """Names of the tasks of this sheet that must be done."""
        found = (*self.conditions.get("own", []), *self.conditions.get("both", []))
        return {name for values in found for name in values["tasks"].split(", ")}

    def rooms(self) -> list[tuple[str, str, int, list[tuple[str, str]]]]:
        """(tool or zone, its name, how many may be left of these, (who, task) of each)."""
        return [
            (
                kind,
                values["name"],
                int(values["spare"]),
                [_pair(one) for one in values["those"].split("; ")],
            )
            for kind in ("tool", "zone")
            for values in self.conditions.get(f"{kind}.room", [])
        ]


def _pair(said: str) -> tuple[str, str]:
    who, task = re.fullmatch(r"(.+?) (?:with|mit) (.+)", said).groups()  # type: ignore[union-attr]
    return who, name_of(task)


def name_of(said: str) -> str:
    """The name in "name: label"."""
    return said.split(": ", maxsplit=1)[0]


@dataclass
class Sheet:
    """One operator's: its steps, and its breaks in seconds."""

    rows: list[Row]
    breaks: list[tuple[Decimal, Decimal]]


@dataclass
class _Raw:
    """A sheet as the page holds it: heading, paragraphs, rows of cells of lines; bold lines."""

    heading: str = ""
    said: list[str] = field(default_factory=list)
    rows: list[list[list[str]]] = field(default_factory=list)
    bold: set[tuple[int, str]] = field(default_factory=set)


class _Reader(HTMLParser):
    """Every `details.sheet` of a page; a `div` within a cell is a line."""

    def __init__(self) -> None:
        super().__init__()
        self.sheets: list[_Raw] = []
        self.inside, self.open, self.bold = False, "", False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "details":
            self.inside = True
            self.sheets.append(_Raw())
        elif not self.inside:
            return
        elif tag == "tr":
            self.sheets[-1].rows.append([])
        elif tag in ("td", "th"):
            self.sheets[-1].rows[-1].append([""])
            self.open = "cell"
        elif tag == "div" and self.open == "cell":
            self.sheets[-1].rows[-1][-1].append("")
        elif tag in ("h3", "p"):
            self.open = tag
            self.sheets[-1].said.append("")
        elif tag == "b":
            self.bold = True

    def handle_endtag(self, tag: str) -> None:
        if tag == "details":
            self.inside = False
        if tag in ("td", "th", "h3", "p"):
            self.open = ""
        if tag == "b":
            self.bold = False
            raw = self.sheets[-1]
            raw.bold.add((len(raw.rows), raw.rows[-1][-1][-1]))

    def handle_data(self, data: str) -> None:
        if not self.inside:
            return
        raw = self.sheets[-1]
        if self.open == "h3":
            raw.heading += data
        elif self.open == "p":
            raw.said[-1] += data
        elif self.open == "cell":
            raw.rows[-1][-1][-1] += data


def sheets_of(page: str, language: str) -> dict[str, Sheet]:
    """Operator -> sheet, of a page with one plan. Every sentence must be one that is known."""
    reader = _Reader()
    reader.feed(page)
    found = {}
    for raw in reader.sheets:
        (who,) = _match(language, "title", raw.heading).groups()
        # a line across the table says on paper whose page it is
        numbered = [(place, row) for place, row in enumerate(raw.rows, 1) if len(row) > 1]
        head = [name[0] for name in numbered[0][1]] if numbered else []
        rows = [
            _row(head, row, {line for n, line in raw.bold if n == place}, language)
            for place, row in numbered[1:]
        ]
        found[who] = Sheet(rows, _breaks(raw.said, language))
    return found


def _breaks(said: list[str], language: str) -> list[tuple[Decimal, Decimal]]:
    spans = [
        span
        for line in said
        if (match := re.fullmatch(SAID[language]["breaks"], line))
        for span in match[1].split(", ")
    ]
    return [
        (number(match["off"]), number(match["back"]))
        for match in (_match(language, "span", span) for span in spans)
    ]


def _match(language: str, kind: str, said: str) -> re.Match[str]:
    match = re.fullmatch(SAID[language][kind], said)
    assert match, f"{said!r} is no {kind}"
    return match


def number(text: str) -> Decimal:
    return Decimal(text.replace(",", "."))


def _row(head: list[str], row: list[list[str]], bold: set[str], language: str) -> Row:
    cells = {
        HEADS[language][name]: [line for line in cell if line and line != "–"]
        for name, cell in zip(head, row, strict=True)
    }
    if "does" not in cells:  # no task has a label: one column says what to do
        cells["what"] = cells["task"]
    what = (cells["task"] or cells["does"])[0]
    found = Row(what if cells["task"] else "", None, cells)
    if match := re.fullmatch(SAID[language]["change"], what):
        found.task, found.change = "", (match[1], number(match[2]))
    elif match := re.fullmatch(SAID[language]["walk"], what):
        found.task, found.change = "", (f"{match[1]} -> {match[2]}", number(match[3]))
    elif match := re.fullmatch(SAID[language]["setup"], what):
        found.task, found.change = "", ("", number(match[1]))
    for sentence in cells["begin"]:
        kind, match = next(
            (kind, match)
            for kind in CONDITIONS
            if (match := re.fullmatch(SAID[language][kind], sentence))
        )
        values = match.groupdict()
        if "task" in values:
            values["task"] = name_of(values["task"])
        found.conditions.setdefault(kind, []).append(values)
        if sentence in bold:
            found.bold.append((kind, sentence))
    for sentence in cells["then"]:
        _then(found, sentence, language)
    return found


def _then(row: Row, sentence: str, language: str) -> None:
    if match := re.fullmatch(SAID[language]["own then"], sentence):
        row.own = tuple(match[1].split(", "))
    elif match := re.fullmatch(SAID[language]["wait then"], sentence):
        row.others.append((match[1], name_of(match[2]), frozenset()))
    elif match := re.fullmatch(SAID[language]["freed then"], sentence):
        kinds = {"Werkzeug": "tool", "Bereich": "zone", "Maschine": "machine"}
        freed = (one.split(" ", 1) for one in match[3].split(", "))
        row.others.append(
            (match[1], name_of(match[2]), frozenset((kinds.get(k, k), name) for k, name in freed))
        )
    else:
        who, task = _match(language, "with", sentence).groups()
        row.others.append((who, name_of(task), frozenset()))


# --- at work by the sheets alone ------------------------------------------------------------------


@dataclass(frozen=True)
class Worked:
    """One step as people did it by their sheets: moments in seconds, and who.

    Attributes:
      task: empty for a walk, a changeover and for setting up.
    """

    task: str
    start: Decimal
    end: Decimal
    who: frozenset[str]


Seconds = Callable[[str, Row], Decimal]
"""(operator, step) -> how long it really takes; the same for all who do a joint task."""


def work_by(sheets: Mapping[str, Sheet], seconds: Seconds) -> list[Worked]:
    """Everybody does their own sheet from top to bottom, begins each step as soon as it allows, and
    knows nothing else.

    Raises AssertionError when all wait for each other.
    """
    crew = _Crew(sheets, seconds)
    worked: list[Worked] = []
    while waiting := [who for who in sheets if crew.place[who] < len(sheets[who].rows)]:
        ready = [found for who in waiting if (found := crew.next_of(who))]
        assert ready, f"nobody can go on: {[(who, crew.row(who)) for who in waiting]}"
        first = min(ready, key=lambda found: (found.start, found.task, sorted(found.who)))
        worked.append(first)
        if first.task:
            crew.done[first.task] = first.end
            crew.begun[first.task] = first.start
        for who in first.who:
            crew.place[who] += 1
            crew.free[who] = first.end
    return worked


class _Crew:
    """All who work by the sheets, and how far they are."""

    def __init__(self, sheets: Mapping[str, Sheet], seconds: Seconds):
        self.sheets, self.seconds = sheets, seconds
        self.place = dict.fromkeys(sheets, 0)
        self.free = dict.fromkeys(sheets, Decimal(0))
        self.done: dict[str, Decimal] = {}
        self.begun: dict[str, Decimal] = {}

    def row(self, who: str) -> Row:
        return self.sheets[who].rows[self.place[who]]

    def next_of(self, who: str) -> Worked | None:
        """The operator's next step, begun as soon as can be; None while something it waits for has
        not begun yet, or a partner is elsewhere.
        """
        row = self.row(who)
        together = {who, *(one for (one,) in row.told("partner"))}
        moments = []
        for one in together:
            if self.place[one] >= len(self.sheets[one].rows) or self.row(one).task != row.task:
                return None
            moments.append(self.may_begin(one))
        known = [moment for moment in moments if moment is not None]
        if len(known) < len(moments):
            return None
        start, length = max(known), self.seconds(who, row)
        blocks = sorted(span for one in together for span in self.sheets[one].breaks)
        for off, back in blocks:  # begin nothing that would run into a break
            if off < start + length and start < back:
                start = back
        return Worked(row.task, start, start + length, frozenset(together))

    def may_begin(self, who: str) -> Decimal | None:
        """When all that stands under "begin when" is so for one operator."""
        row = self.row(who)
        needed = {task for _, task in row.waits_for()} | row.own_before()
        if not needed <= self.done.keys():
            return None
        moments = [self.free[who], *(self.done[task] for task in needed)]
        moments += [number(values["release"]) for values in row.conditions.get("release", [])]
        moments += [number(values["back"]) for values in row.conditions.get("break", [])]
        moments += [number(values["hold"]) for values in row.conditions.get("hold", [])]
        for kind, reached in (("end", self.done), ("start", self.begun)):
            for _, task, least, _ in row.lags(kind):
                if task not in reached:
                    return None
                moments.append(reached[task] + least)
        for _, _, spare, those in row.rooms():
            ends = sorted(self.done[task] for _, task in those if task in self.done)
            if len(ends) < len(those) - spare:
                return None
            moments.append(ends[len(those) - spare - 1])
        return max(moments)
