"""What planners write above their columns, in English and German, and what it means here.

`meaning("Zeit Mensch [min]")` is a time of the operator "Mensch" in minutes. One table of phrases
for columns without an operator, and a few measures (time, stress, difficulty, spread) that name
one.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection
from dataclasses import dataclass, replace
from importlib import resources

from tandem.cell.names import clean, key
from tandem.cell.parts import Kind
from tandem.files.spreadsheet.values import unit_named

VOCABULARY = json.loads(resources.files(__package__).joinpath("vocabulary.json").read_text("utf-8"))

PHRASES: dict[str, list[str]] = VOCABULARY["columns"]
"""What a column means -> how it may be called: casefolded, umlauts spelled out, marks between words
as blanks.
"""

MEANS = {spelling: what for what, spellings in PHRASES.items() for spelling in spellings}

KINDS: dict[str, Kind] = {
    word: kind for kind, words in VOCABULARY["kinds"].items() for word in words
}
"""Words in the name of an operator that say whether it is a human or a robot. Those for machines
stand apart: nobody is taken for one by its name alone.
"""

MACHINES = frozenset(VOCABULARY["machines"])
"""Words for what works on its own and is neither a human nor a robot."""

APPLIANCES = MACHINES | frozenset(VOCABULARY["appliances"])
"""The same with words that are as likely a tool's name, so that they count only beside a word for
time.
"""

JOINT = frozenset(VOCABULARY["joint"])
"""Words that say that several do it together, and not who."""

FILLERS = frozenset(VOCABULARY["fillers"])
"""Words that say nothing beside a measure: "Zeit für den Roboter"."""

CONDITIONS = frozenset(VOCABULARY["conditions"])
"""Words that say under which condition a time of somebody holds, or which part of it is meant."""

PEOPLE = frozenset(VOCABULARY["people"])
"""What a column is called that says how many people a task takes."""

FIGURES, FIGURES_OF = frozenset(VOCABULARY["figures"]), frozenset(VOCABULARY["figures of"])
"""What planners reckon below the times of the tasks, and words before it: "target takt time"."""

MEASURES: dict[str, str] = {
    "time": (
        r"t|te|tg|times?|zeit(en)?|dauer|durations?|"
        r"(vorgabe|soll|bearbeitungs|ausfuehrungs|prozess|montage|stueck|grund|standard|fertigungs)zeit(en)?"
    ),
    "stress": (
        r"stress|load|strain|(eaws|ergo|belastung|beanspruchung)\w*|points?|punkte?|score|niosh|reba|rula|owas|kim|lmm|ocra|leitmerkmal\w*|physical|koerperliche|bewertung"
    ),
    "difficulty": r"difficulty|schwierigkeit(sgrad)?",
    "spread": r"spread|streuung|cv|variation|variationskoeffizient",
    "changeover": (
        r"changeover|change|ruestzeit|ruesten|setup|umruesten|werkzeugwechsel|wechselzeit"
    ),
}
"""Words that make a column a measure of an operator. Those of a measure may be mixed: "EAWS
points".
"""

NO_OPERATOR = re.compile(
    r"ruest\w*|setup|set-up|wart\w*|wait\w*|idle|leer\w*|cycle|zyklus\w*|takt\w*|gesamt\w*|total|sum|summe|wege\w*|walk\w*|geh\w*|puffer\w*|buffer|"
    r"start\w*|end|ende|beginn|begin|finish|max\w*|mean|avg|average|mittel\w*|durchschnitt\w*|kum\w*|cum\w*|anteil|share|alt|old|std|"
    r"abweichung|deviation|minimum|date|datum|liege\w*|slack|schlupf\w*|makespan|bound\w*|busy|utili[sz]ation|auslastung|transport\w*|lead|lag|durchlauf\w*|changeover|wechsel\w*|neben\w*|hilfs\w*|verteil\w*|erhol\w*|priority|prio\w*|\w*einheit(en)?|units?|uom|dimension"
)
"""Kinds of time that no single operator spends on the task: such columns are listed as not read."""

WALKING = re.compile(r"(walk|weg|geh|lauf)\w*( ?(time|zeit)\w*)?$")
"""Times between tasks, as a table of standard work has them."""

AUTOMATIC = frozenset(("automatic", "automatisch", "automation"))
"""Words for work without a person that name no robot."""

BOUNDS = re.compile(
    r"min|minimum|minimal|max|maximum|maximal|mean|avg|average|mittel|mittelwert|durchschnitt|typ"
)
"""Words for one of several times that a task may take."""

PER_PIECE = re.compile(
    r"\s*(?:/|\b(?:je|pro|per)\b)\s*(?:stück|stueck|stk|piece|pieces|pcs?|unit|einheit|teil|part)\b\.?",
    re.IGNORECASE,
)
"""Words that make a time that of one piece: "Zeit/Stück", "[s/pc]"."""

PLURAL = re.compile(r"\w\(s\)", re.IGNORECASE)
"""One or several: "Operator(s)"."""

ABOUT_LINKS = re.compile(
    r"\b(anzahl|zahl|count|number of|no of|num|wie viele|how"
    r" many|typ|type|art|lag|zeitabstand|abstand|time|zeit|dauer|duration|fertig|done|status)\b"
)
"""Words beside "predecessors" that make it something other than a list of tasks."""

QUOTES = re.compile(r'"([^"]+)"')
"""Names in a header that stand for themselves."""

TOTALS = re.compile(
    r"(zwischen)?summen?|(sub-?|grand )?totals?|sum|σ|∑|Σ|gesamt.*|insgesamt|overall", re.IGNORECASE
)
"""What planners write before a total."""


@dataclass(frozen=True)
class Meaning:
    """What a column holds.

    Attributes:
      what: "time", "stress", "after", ... : a key of `PHRASES` or `MEASURES`.
      who: the operators it speaks of; none for the task as a whole, several for a joint way of
        doing it.
      human: the human whose stress it is, within the joint way `who`.
      unit: the unit of time, when the header says one.
      sure: the words say so; a guess from the operator's name alone is not sure.
      told: by `--map`, not by the header.
      percent: the header gives the scale as per cent.
      per_piece: a time that a piece takes, of which the task may have several.
    """

    what: str
    who: tuple[str, ...] = ()
    human: str = ""
    unit: str | None = None
    sure: bool = True
    told: bool = False
    percent: bool = False
    per_piece: bool = False

    def __str__(self) -> str:
        of = f" of {' + '.join(self.who)}" if self.who and not self.human else ""
        joint = f" of {self.human} in {' + '.join(self.who)}" if self.human else ""
        unit = f", {self.unit}" if self.unit else ""
        return f"{self.what}{of}{joint}{unit}{' per piece' if self.per_piece else ''}"


def kind_of(name: str) -> Kind | None:
    """Human or robot, when the operator's name says so beyond doubt ("Werker 2", "UR5e"), else
    None.
    """
    words = _words(name)
    kinds = {KINDS[word] for word in words if word in KINDS}
    return kinds.pop() if len(kinds) == 1 else None


def _words(name: str) -> list[str]:
    """The name's words without the digits behind them: "Werker1" -> werker; "H1" -> h; but "UR5"
    stays.
    """
    words = [word for word in key(name).split() if word]
    return [
        piece
        for word in words
        for piece in ([word] if word in KINDS else re.split(r"(?<=[a-z])(?=\d+$)", word))
    ]


def is_kind_word(name: str) -> bool:
    """The name consists of nothing but kind words and digits: "Roboter", "robot 2"."""
    words = _words(name)
    kinds = KINDS.keys() | MACHINES
    return (
        bool(words)
        and any(word in kinds and len(word) > 1 for word in words)
        and all(word in kinds or word.isdigit() for word in words)
    )


def is_machine(name: str) -> bool:
    """The name is that of a machine, such as "Maschine 2", and not of a human or a robot."""
    return kind_of(name) is None and any(word in APPLIANCES for word in _words(name))


def says_how_alone(name: str) -> bool:
    """The name says only that nobody's hands are in it, "Automatic", not who works."""
    return is_kind_word(name) and bool(AUTOMATIC & set(_words(name)))


def is_walking(header: str) -> bool:
    """The column is what somebody walks between tasks: "Walk", "Wegezeit [s]"."""
    return bool(WALKING.match(key(split_unit(header)[0])))


def split_unit(text: str) -> tuple[str, str | None]:
    """The header without its unit, and the unit: `t human [s]`, `Zeit (min)`, `Dauer in Minuten`,
    `time_s`.
    """
    # a name in quotes may hold brackets and units of its own
    plain = QUOTES.sub(lambda name: "\x00" * len(name[0]), text)
    for bracket in re.finditer(r"[\[(]([^\[\]()]*)[\])]", plain):
        if unit := unit_named(re.sub(r"^in ", "", bracket[1].strip(), flags=re.IGNORECASE)):
            return tidy_marks(text[: bracket.start()] + " " + text[bracket.end() :]), unit
    tail = re.search(
        r"(?:\s+in\s+|\s*[/,;:]\s*|[\s_]+)([^\s_]+|1/100 ?min\.?|hundertstel minuten)$",
        plain,
        re.IGNORECASE,
    )
    if tail and (unit := unit_named(tail[1])):
        return tidy_marks(text[: tail.start()]), unit
    return text, None


def meaning(header: str, known: tuple[str, ...] = ()) -> Meaning | None:
    """What the header says, or None when it says nothing known.

    Args:
      known: operators that are known from elsewhere; their bare names count as times.
    """
    text, quoted = _without_quotes(clean(header))
    text, pieces = PER_PIECE.subn(" ", text)
    if pieces:
        found = meaning(_with_quotes(text, quoted), known)
        return replace(found, per_piece=True) if found and found.what == "time" else None
    several = PLURAL.search(text)
    text, unit = split_unit(text)
    if text and (what := MEANS.get(key(text)) or _stem(key(text))):
        # "Operator [s]" holds seconds, however an operator is called; "Operator(s)" holds names
        of_one = what == "operator" and unit is not None and not several
        return Meaning("time", (text,), unit=unit) if of_one else Meaning(what, unit=unit)
    measures, rest = _measures(text)
    who, human = _who(rest, quoted, known)
    if "changeover" in measures and (
        measures == {"changeover"} or measures == {"changeover", "time"}
    ):
        return Meaning("changeover", who, unit=unit)
    if any(NO_OPERATOR.fullmatch(word) for name in rest for word in key(name).split()):
        return None
    if unit and bound_of(header):  # beside a unit, "min" is the least
        return None
    if len(measures) == 1:
        what = measures.pop()
        return Meaning(what, who, human, unit) if what == "stress" or not human else None
    if measures:
        return None
    if who and (
        unit
        or all(
            name in known or is_kind_word(name) or key(name) in JOINT - {"team", "all", "alle"}
            for name in who
        )
    ):
        return Meaning(
            "time", who, unit=unit, sure=bool(unit) or all(name in known for name in who)
        )
    return None


def bound_of(header: str) -> str:
    """Whose time the header gives the least, the most or the mean of: "Human min [s]" -> "Human";
    "" where it does no such thing.
    """
    text, unit = split_unit(clean(header))
    # what stands in brackets is a unit, or meant to be one
    measures, rest = _measures(re.sub(r"[\[(][^\])]*[\])]", " ", text))
    names = [word for word in rest if not BOUNDS.fullmatch(key(word))]
    if len(names) == len(rest) or not measures <= {"time"} or (unit is None and not measures):
        return ""
    told = any(NO_OPERATOR.fullmatch(word) for name in names for word in key(name).split())
    return "" if told else " ".join(names)


OWN_TOOL = re.compile(
    r"(?:tools?|werkzeuge?)\s+(?:(?:of|for|für|fuer|von)\s+(?:the\s+|den\s+|die\s+)?)?(.+)",
    re.IGNORECASE,
)
"""A tool, and whose."""


def own_tool(header: str, known: Collection[str] | None) -> Meaning | None:
    """The tool of an operator, of a group, or of one within a group: "tool anna", "tool anna +
    cobot", "tool anna with cobot". None when the header speaks of anybody who is not known, where
    it is known who there is.
    """
    text, quoted = _without_quotes(clean(header))
    if (found := OWN_TOOL.fullmatch(text)) is None:
        return None
    who, human = _who(re.findall(r"[+&]|[^\s+&]+", found[1]), quoted, tuple(known or ()))
    strangers = known is not None and not all(name in known for name in who)
    return Meaning("tool", who, human) if who and not strangers else None


SCALE = re.compile(
    r"(\d+([.,]\d+)?)?\s*(-|–|—|\.\.+|…|/|bis|to|%|‰)\s*(\d+([.,]\d+)?)?|pkte?|punkten?|pts?|prozent|percent|pct|skala|scale|n|nm|kg|kcal|bpm|watt|w"
)
"""Words that say in what a stress is counted: "0-10", "%", "Pkt."; a plain number may be
somebody's.
"""


def without_scale(header: str) -> tuple[str, str]:
    """The header without what stands in brackets and without words of scale, and those: `Stress
    (0-10)` -> "Stress", "0-10".
    """
    taken: list[str] = []

    def keep(found: re.Match[str]) -> str:
        taken.append(found[0].strip("[](){}<> "))
        return " "

    rest = re.sub(r"\[[^\]]*\]?|\([^)]*\)?|\{[^}]*\}?|<[^>]*>?", keep, clean(header))
    words = rest.split()
    taken += [word for word in words if SCALE.fullmatch(word.casefold().rstrip("."))]
    kept = [word for word in words if not SCALE.fullmatch(word.casefold().rstrip("."))]
    return " ".join(kept), ", ".join(taken)


def _stem(plain: str) -> str | None:
    """Lists of tasks under a longer header: "Predecessors (row)", "alle Vorgänger laut Graph",
    "Pred. 2"; their number or kind is none.
    """
    if re.search(ABOUT_LINKS, plain):
        return None
    numbered = re.fullmatch(r"(.+?) ?\d+", plain)
    if numbered and MEANS.get(numbered[1]) in ("after", "after rows", "before"):
        return MEANS[numbered[1]]
    if re.search(
        r"\b(predecess|vorgaenger|vorlaeufer|preceding|precedence|prerequis|vorrangbez|depends"
        r" on|dependenc|abhaengig von|abhaengigk)",
        plain,
    ):
        return "after rows" if re.search(r"\b(rows?|zeilen?(nr|nummern?)?)\b", plain) else "after"
    return (
        "before"
        if re.search(r"\b(success|nachfolger|precedes|followed by|gefolgt von|folgevorg)", plain)
        else None
    )


def _without_quotes(text: str) -> tuple[str, list[str]]:
    """Names in double quotes stand for themselves, whatever words they hold."""
    quoted: list[str] = []

    def keep(found: re.Match[str]) -> str:
        quoted.append(found[1])
        return f" \x00{len(quoted) - 1} "

    return tidy_marks(QUOTES.sub(keep, text)), quoted


def _with_quotes(text: str, quoted: list[str]) -> str:
    return re.sub("\x00(\\d+)", lambda found: f'"{quoted[int(found[1])]}"', text)


def tidy_marks(text: str) -> str:
    """Single blanks; unlike `tidy` it keeps the marks that stand for quoted names."""
    return re.sub(r"[ \t\n]+", " ", text).strip()


def _measures(text: str) -> tuple[set[str], list[str]]:
    """The measures that the words name, and the words that are left, as written; "+" and "with"
    stay as words.
    """
    if " " not in text:
        text = text.replace("_", " ")
    measures, rest = set(), []
    for word in re.findall(r"[+&]|[^\s\[\](),;:+&]+", text):
        pieces = [word]
        if re.search(r"[-_./]", word) and any(
            _measure(key(piece)) for piece in re.split(r"[-_./]", word)
        ):
            pieces = [piece for piece in re.split(r"[-_./]", word) if piece]
        for piece in pieces:
            plain = key(piece)
            if what := _measure(plain):
                measures.add(what)
            elif who := _compound(plain):
                measures.add("time")
                rest.append(piece[: len(who)])
            elif plain not in FILLERS or piece.lower() in ("mit",):
                rest.append(piece)
    return measures, rest


def _compound(word: str) -> str | None:
    """The operator in a German compound: "roboterzeit", "maschinenzeit"."""
    if not (found := re.fullmatch(r"(..+)(zeit|dauer)", word)):
        return None
    return next(
        (
            found[1].removesuffix(link)
            for link in ("n", "en", "s", "")
            if found[1].removesuffix(link) in KINDS.keys() | APPLIANCES
        ),
        None,
    )


def _measure(word: str) -> str | None:
    return next((what for what, pattern in MEASURES.items() if re.fullmatch(pattern, word)), None)


def _who(rest: list[str], quoted: list[str], known: tuple[str, ...]) -> tuple[tuple[str, ...], str]:
    """The operators named by the words, and for "anna with ben" the one that is meant."""
    groups: list[list[str]] = [[]]
    human_of_joint = False
    for word in rest:
        if word.startswith("\x00"):
            groups[-1].append(quoted[int(word[1:])])
        elif word in "+&" or word.casefold() in ("und", "and", "with", "mit"):
            human_of_joint |= word.casefold() in ("with", "mit")
            groups.append([])
        else:
            groups[-1].append(word.strip("-–_./"))
    names = tuple(_known(" ".join(group), known) for group in groups if any(group))
    return names, names[0] if human_of_joint and len(names) > 1 else ""


def _known(name: str, known: tuple[str, ...]) -> str:
    return next(
        (other for other in known if other == name),
        next((other for other in known if key(other) == key(name)), name),
    )
