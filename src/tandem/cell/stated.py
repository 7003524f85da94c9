"""One row of facts, as people write them, to a task that a method can score.

Names and words may be those of the methods, or what people write in English and German
(`spellings.json`); units are converted; what was not stated is never assumed silently.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib import resources
from typing import Any, Literal, cast, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from tandem.cell.names import Known, clean, key
from tandem.ergonomics.facts import Facts, about, refusals, shown
from tandem.ergonomics.methods import LICENSED, METHODS, unknown
from tandem.ergonomics.tasks import SIDES, SOURCES, Origin, Side, TaskFacts
from tandem.ergonomics.units import converted, unit_named
from tandem.errors import Fault

SPELLINGS: dict[str, dict[str, list[str]]] = json.loads(
    resources.files(__package__).joinpath("spellings.json").read_text("utf-8")
)
"""What facts, the keys of a row and their words may be called."""

ROW_KEYS = ("method", "side", "source", "assessor", "date", "minutes", "reps_per_cycle")
"""What a row says beside the facts of its method."""
OWN = ("value", "unit", "source", "assessor", "date")
"""Keys of a fact that says where it came from: `trunk: {value: 45, source: video}`."""
ALIASES = {"energy": "garg_energy"}
"""Further names of methods: the scale that one's numbers are on."""


def _by_spelling(*tables: str) -> dict[str, list[str]]:
    """A folded spelling -> the names that it may mean, in the order of the tables."""
    found: dict[str, list[str]] = {}
    for table in tables:
        for name, spellings in SPELLINGS[table].items():
            for spelling in spellings:
                found.setdefault(spelling, []).append(name)
    return found


SPELLED = _by_spelling("facts", "rows of facts")
"""Which of the facts a spelling means, the method of the row decides."""
WORDS = _by_spelling("words of facts")
FACTS = {name for method in METHODS.values() for name in method.model.model_fields}
EXACT: dict[str, list[str]] = {}
"""A folded name -> the keys of a row and the facts that are spelled so but for case and marks."""
for _name in (*ROW_KEYS, *sorted(FACTS)):
    EXACT.setdefault(key(_name), []).append(_name)
OTHER_SIGN = {("rsi", "wrist_flexion_deg"): "P"}
"""Facts that a method counts the other way round: the Strain Index takes extension as positive."""
SIDED = (("left", r"\b(left|links|linke[rnms]?)\b"), ("right", r"\b(right|rechts|rechte[rnms]?)\b"))
NUMBER = re.compile(r"([-+−]?\d+(?:[.,]\d+)?)\s*(\D.*)?")


@dataclass(frozen=True)
class Given:
    """One thing that was stated.

    Attributes:
      value: a number, a word, a truth value.
      place: where it stands.
      unit: it is in, when that was said.
      origin: where it came from, as far as it was said of this one fact.
    """

    value: Any
    place: str
    unit: str | None = None
    origin: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Conditions:
    """What holds for all rows of a file.

    Attributes:
      method: of rows that name none.
      cycles: products a shift; with it, repetitions per cycle become those of a day.
      cautious: take the cautious value of what is missing, and say so.
      assessor, date: of rows that name none.
      of_one: the rows tell of one execution of a task, as those of a cell do: how often it is done
        a day is then no fact, but follows from the plan.
    """

    method: str = ""
    cycles: float | None = None
    cautious: bool = False
    assessor: str = ""
    date: str = ""
    of_one: bool = False


def meanings(name: str) -> list[str]:
    """The facts, or keys of a row, that a name may mean; none when it means nothing known."""
    if name in FACTS or name in ROW_KEYS:
        return [name]
    folded = key(name)
    return list(dict.fromkeys([*EXACT.get(folded, []), *SPELLED.get(folded, [])]))


def with_unit(name: str) -> tuple[str, str | None]:
    """A heading without its unit, and the unit: "Rumpf [°]", "load (lb)", "Hebelarm in cm"."""
    for found in re.finditer(r"[\[(]([^\[\]()]*)[\])]", name):
        if unit := unit_named(re.sub(r"^in ", "", found[1].strip())):
            return " ".join((name[: found.start()] + " " + name[found.end() :]).split()), unit
    tail = re.search(r"(?:\s+in\s+|\s*[,;/:]\s*)(\S+)$", name)
    if tail and (unit := unit_named(tail[1])):
        return name[: tail.start()].strip(), unit
    return name, None


def entry(
    task: str, row: Mapping[str, Given], place: str, whole: Conditions
) -> tuple[TaskFacts | None, list[Fault]]:
    """The task that a row describes, or all that is wrong with it.

    Args:
      row: a name as it was written -> what was stated.
      place: of the row as a whole.
    """
    return _Entry(task, row, place, whole).read()


def row_of(
    task: str, row: Mapping[str, Given], method: str
) -> tuple[Side, Origin, float | None, list[Fault]]:
    """Side, origin and minutes of a row that states no facts, and all that is wrong with them."""
    found = _Entry(task, row, "", Conditions())
    found.method = method
    found.sort_row_keys()
    side = found.word("side", list(SIDES), "")
    if method in METHODS:
        found.check_side(side)
    return cast(Side, side), found.row_origin(), found.amount("minutes", 0, 1440), found.faults


class _Entry:
    def __init__(self, task: str, row: Mapping[str, Given], place: str, whole: Conditions):
        self.task, self.row, self.place, self.whole = task, row, place, whole
        self.faults: list[Fault] = []
        self.stated: dict[str, Given] = {}
        self.about: dict[str, Given] = {}
        self.method = ""

    def read(self) -> tuple[TaskFacts | None, list[Fault]]:
        self.sort_row_keys()
        self.method = self.word("method", list(METHODS), self.whole.method)
        side = self.word("side", list(SIDES), "")
        row_origin = self.row_origin()
        if not self.method:
            if "method" not in self.about:
                self.fault(
                    f"no method is named. Write one of {', '.join(METHODS)}, or give --method."
                )
            return None, self.faults
        self.check_side(side)
        model = METHODS[self.method].model
        self.sort_facts(model)
        facts = {
            name: self.value(name, given, model.model_fields[name])
            for name, given in self.stated.items()
        }
        self.repetitions(facts, model)
        minutes = self.amount("minutes", 0, 1440)
        taken = self.fill(facts, model)
        found = self.model(model, facts)
        if found is None or self.faults:
            return None, self.faults
        origins = {
            name: self.origin(name, row_origin, name in facts and name not in taken)
            for name in model.model_fields
        }
        sided = cast(Side, side)
        return (
            TaskFacts(self.task, self.method, sided, found, origins, minutes, self.place),
            self.faults,
        )

    def row_origin(self) -> Origin:
        return Origin(
            self.word("source", list(SOURCES), "stated"),
            self.text("assessor") or self.whole.assessor,
            self.text("date") or self.whole.date,
        )

    def fault(self, message: str, place: str = "") -> None:
        self.faults.append(Fault(f"task {self.task!r}: {message}", place=place or self.place))

    # --- what is meant ----------------------------------------------------------------------------

    def sort_row_keys(self) -> None:
        for name, given in self.row.items():
            means = [meaning for meaning in meanings(name) if meaning in ROW_KEYS]
            if means:
                self.about[means[0]] = given

    def sort_facts(self, model: type[Facts]) -> None:
        for name, given in self.row.items():
            means = meanings(name)
            if any(meaning in ROW_KEYS for meaning in means):
                continue
            fits = [meaning for meaning in means if meaning in model.model_fields]
            turned = [OTHER_SIGN.get((self.method, meaning)) for meaning in means]
            if fits:
                self.state(fits[0], name, given)
            elif turned and turned[0]:
                self.state(turned[0], name, self.turned_round(given))
            else:
                self.stranger(name, given, means, model)

    def turned_round(self, given: Given) -> Given:
        number, unit = _number(given.value)
        value = given.value if number is None else -number
        return Given(value, given.place, unit or given.unit, given.origin)

    def state(self, fact: str, name: str, given: Given) -> None:
        before = self.stated.get(fact)
        if before is None:
            self.stated[fact] = given
        elif METHODS[self.method].model.model_fields[fact].annotation is bool:
            # two columns for what the method counts once: twisted, bent to a side
            both = [truth(one.value) for one in (before, given)]
            self.stated[fact] = given if both[1] else before
        else:
            self.fault(f"{fact} is stated twice, here as {name!r}. Keep one.", given.place)

    def stranger(self, name: str, given: Given, means: list[str], model: type[Facts]) -> None:
        owners = [m for m in METHODS if set(means) & set(METHODS[m].model.model_fields)]
        if owners:
            self.fault(
                f"{name!r} is a fact of {' and '.join(owners[:3])}, but the row is scored by"
                f" {self.method}. Scales are not mixed: leave it out here, or give the task a row"
                f" of its own for {owners[0]}.",
                given.place,
            )
            return
        near = Known([*model.model_fields, *ROW_KEYS]).nearest(name)
        hint = (
            f"Did you mean {near!r}?" if near else f"Write one of {', '.join(model.model_fields)}."
        )
        self.fault(f"{self.method} knows no fact {shown(name)}. {hint}", given.place)

    # --- values -----------------------------------------------------------------------------------

    def word(self, name: str, known: list[str], otherwise: str) -> str:
        given = self.about.get(name)
        if given is None:
            return otherwise
        found = _word(given.value, known)
        if found is None:
            if name == "method":
                self.fault(unknown(str(given.value)), given.place)
            else:
                self.fault(
                    f"{name} is {shown(given.value)}, but must be {', '.join(known)}.", given.place
                )
            return ""
        return found

    def text(self, name: str) -> str:
        given = self.about.get(name)
        return "" if given is None else str(given.value)[:60]

    def amount(self, name: str, low: float, high: float) -> float | None:
        given = self.about.get(name)
        if given is None:
            return None
        number, _ = _number(given.value)
        if number is None or not low <= number <= high:
            self.fault(
                f"{name} is {shown(given.value)}, but must be a number from {low:g} to {high:g}.",
                given.place,
            )
            return None
        return number

    def value(self, name: str, given: Given, info: FieldInfo) -> Any:
        """The stated value in the fact's unit; as it is when it cannot be understood, so that the
        model refuses it.
        """
        if info.annotation is bool:
            found = truth(given.value)
            return given.value if found is None else found
        choices = _choices(info)
        if choices:
            return _word(given.value, choices) or given.value
        number, own = _number(given.value)
        if number is None:
            return given.value
        wanted, unit = about(info)["unit"], own or given.unit
        if "unit" in self.stated and self.stated["unit"].value == "in":
            wanted = {"cm": "in", "kg": "lb"}.get(wanted, wanted)  # the equation's US system
        if unit and wanted:
            try:
                number = converted(number, unit, wanted)
            except (ValueError, KeyError) as error:
                self.fault(
                    f"{name} is {shown(given.value)}: {error}. Correct the unit.", given.place
                )
        if int in (info.annotation, *get_args(info.annotation)) and number == int(number):
            return int(number)
        return number

    def repetitions(self, facts: dict[str, Any], model: type[Facts]) -> None:
        each = self.amount("reps_per_cycle", 0, 10_000)
        if "reps" not in model.model_fields:
            return
        if self.whole.of_one and "reps" in self.stated:
            self.fault(
                "reps counts a day, but how often the task is done a day follows from the plan."
                " State reps_per_cycle instead: how often in one execution of the task.",
                self.stated["reps"].place,
            )
            facts.setdefault("reps", 0.0)
            return
        if each is None:
            return
        place = self.about["reps_per_cycle"].place
        if "reps" in facts:
            self.fault("reps and reps_per_cycle are both stated. Keep one.", place)
        elif self.whole.cycles is None:
            self.fault(
                "reps_per_cycle is stated, but not how many cycles a shift has. State"
                " cycles_per_shift at the top of the file, or give --cycles N.",
                place,
            )
        else:
            facts["reps"] = each * self.whole.cycles
            self.stated["reps"] = self.about["reps_per_cycle"]

    # --- what is missing --------------------------------------------------------------------------

    def fill(self, facts: dict[str, Any], model: type[Facts]) -> set[str]:
        """Takes cautious values for what must be stated and is not, where that is allowed; the
        names of those. Else each is a fault.
        """
        missing = [
            name
            for name, info in model.model_fields.items()
            if about(info)["asked"] and name not in facts
        ]
        taken = set()
        for name in missing:
            if name == "reps" and "reps_per_cycle" in self.about:
                continue  # told already
            if name == "reps" and self.whole.of_one:
                self.fault(
                    "reps_per_cycle is missing (how often in one execution of the task). State it;"
                    " 1 where it is done once."
                )
                continue
            info = model.model_fields[name]
            cautious = about(info)["cautious"]
            if self.whole.cautious and cautious is not None:
                facts[name] = cautious
                taken.add(name)
                continue
            self.fault(f"{name} is missing ({info.description}). {self.remedy(info, cautious)}")
        return taken

    def remedy(self, info: FieldInfo, cautious: Any) -> str:
        if cautious is None:
            return "State it."
        value = f"{_plain(cautious)} {about(info)['unit']}".rstrip()
        if self.whole.of_one:
            return (
                f"State it; where nothing is known, a cautious value is {value}, as in `{{value:"
                f" {_plain(cautious)}, source: default}}`."
            )
        return f"State it; a cautious value would be {value}, which --cautious takes and marks."

    def model(self, model: type[Facts], facts: dict[str, Any]) -> Facts | None:
        try:
            return model.model_validate(facts)
        except ValidationError as error:
            for refusal in refusals(error, model, self.method):
                name = str(refusal.path[0]) if refusal.path else ""
                if name in model.model_fields and name not in facts and not self.faults:
                    self.fault(refusal.message)
                if name in model.model_fields and name not in facts:
                    continue  # told already
                given = self.stated.get(name)
                self.fault(refusal.message, given.place if given else "")
            return None

    # --- sides, origins ---------------------------------------------------------------------------

    def check_side(self, side: str) -> None:
        named = [word for word, pattern in SIDED if re.search(pattern, self.task, re.IGNORECASE)]
        if side in ("left", "right") and len(named) == 1 and named[0] != side:
            self.fault(
                f"the task's name says {named[0]}, but side says {side}. Were the sides swapped?"
                " Correct one of them.",
                self.about["side"].place,
            )
        if side and not METHODS[self.method].sided and side != "both":
            self.fault(
                f"{self.method} scores the whole body and knows no {side} side. Leave side out.",
                self.about["side"].place,
            )

    def origin(self, name: str, row: Origin, stated: bool) -> Origin:
        if not stated:
            return Origin("default", row.assessor, row.date)
        given = self.stated.get(name)
        own = given.origin if given else {}
        source = _word(own.get("source", row.source), list(SOURCES)) or row.source
        return Origin(source, own.get("assessor", row.assessor), own.get("date", row.date))


def as_given(name: str, value: Any, place: str) -> Given | str:
    """What was stated of a fact: a value alone, or a mapping that says besides where it came from;
    what is wrong with it when it is neither.
    """
    if not isinstance(value, Mapping):
        return Given(value, place)
    if any(name not in OWN for name in value) or isinstance(value.get("value"), Mapping | None):
        return f"`{name}` is a mapping. Write its `value`, and beside it only {', '.join(OWN[1:])}."
    origin = {key: str(value[key]) for key in OWN[2:] if value.get(key) is not None}
    return Given(value["value"], place, value.get("unit"), origin)


def method_in(text: str) -> str | None:
    """The method, or the licensed one, that a name means, in whatever spelling."""
    return _word(text, [*METHODS, *LICENSED]) or ALIASES.get(key(text))


YES = ("x", "✓", "✔", "☑", "●", "•", "*", "true", "wahr", "yes", "y", "ja", "j")
NO = (
    "",
    "-",
    "–",
    "—",
    "−",
    "/",
    "n/a",
    "no",
    "nein",
    "none",
    "keine",
    "false",
    "falsch",
    "n",
    "☐",
)


def truth(value: Any) -> bool | None:
    """Whether a yes or no such as 1, TRUE, ja or x is a yes; None when it is neither."""
    if isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        return bool(value) if value in (0, 1) else None
    if not isinstance(value, str):
        return None
    word = clean(value).casefold()
    return True if word in (*YES, "1") else False if word in (*NO, "0") else None


def twice(rows: Iterable[TaskFacts]) -> Iterator[Fault]:
    """Rows of one task, method and side, of which one is probably the other side."""
    seen: dict[tuple[str, str, str], TaskFacts] = {}
    for row in rows:
        first = seen.setdefault((row.task, row.method, row.side), row)
        if first is not row:
            side = f", side {row.side}" if row.side else ""
            yield Fault(
                f"task {row.task!r}: {row.method}{side} is stated twice, first at {first.place}. Is"
                " one of them the other side? Correct it, or keep one.",
                place=row.place,
            )


def _word(value: Any, known: list[str]) -> str | None:
    if not isinstance(value, str):
        return None
    folded = key(value)
    exact = [word for word in known if key(word) == folded or word == value]
    return next(iter([*exact, *(word for word in WORDS.get(folded, []) if word in known)]), None)


def _choices(info: FieldInfo) -> list[str]:
    """The words of a Literal, also one that may be left out."""
    for annotation in (info.annotation, *get_args(info.annotation)):
        if getattr(annotation, "__origin__", None) is Literal:
            return [word for word in get_args(annotation) if isinstance(word, str)]
    return []


def _number(value: Any) -> tuple[float | None, str | None]:
    """A number and its unit, when the value is one: 45, "45", "12,5 lb", "0.8 rad"."""
    if isinstance(value, bool) or value is None:
        return None, None
    if isinstance(value, int | float):
        return (float(value), None) if math.isfinite(value) else (None, None)
    found = NUMBER.fullmatch(str(value).strip())
    if found is None:
        return None, None
    unit = unit_named(found[2]) if found[2] else None
    if found[2] and unit is None:
        return None, None
    return float(found[1].replace(",", ".").replace("−", "-")), unit


def _plain(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
