"""People in words: "compliant", "random:0.5", "pace:2+forgetful:0.1", "tiring:weak,after=10",
"population:FILE".

Kinds joined by `+` are one person. A number may be a range, "pace:0.8..1.5": every person drawn has
its own. What a kind is, which numbers it takes and what they do stands in one line of `KINDS`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from tandem.cell.names import Known, clean
from tandem.errors import UsageError
from tandem.extensions import Table, is_dotted
from tandem.world.arrays import Arrays, Names
from tandem.world.people import Person, compliant, harm

WORKERS = {"strong": 0.8, "normal": 1.0, "weak": 1.2}
"""Kind of worker -> factor on how fast it tires. Source: the public code of Xue et al. (human
fatigue in a multi-agent production cell).
"""

LIGHT, HEAVY, REST = 0.05, 0.15, 0.05
"""How fast fatigue grows with the lightest and with the heaviest task, and falls at rest. Source:
as above (light handling 0.04 to 0.06, loading 0.12 to 0.15, waiting 0.05). ASSUMPTION: per minute;
between them in proportion to a task's stress.
"""


class Range(NamedTuple):
    """A number, or all numbers from `low` to `high`."""

    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.low:g}" if self.low == self.high else f"{self.low:g}..{self.high:g}"


class Setting(NamedTuple):
    """A number that a kind takes: from `low` to `high`, and what it is when it is not stated; None:
    it must be.
    """

    default: float | None
    low: float
    high: float


class Made(NamedTuple):
    """What a kind is made from.

    words: the names that were given. numbers: setting -> value. weights: "task.NAME" and the like
    -> value.
    """

    names: Names
    arrays: Arrays
    words: tuple[str, ...]
    numbers: Mapping[str, float]
    weights: Mapping[str, float]


@dataclass(frozen=True)
class Kind:
    """What a person can be.

    Attributes:
      what: in words.
      example: how it is written.
      make: the fields of `Person` that it sets.
      settings: the numbers that it takes by name; the first one may be given without.
      words: "tasks" or "workers": what names it takes.
      weighs: it takes weights by "task.NAME", "part.NAME", "tool.NAME".
    """

    what: str
    example: str
    make: Callable[[Made], dict[str, Any]]
    settings: Mapping[str, Setting] = field(default_factory=dict)
    words: str | None = None
    weighs: bool = False


@dataclass(frozen=True)
class Trait:
    """One kind with what was given to it."""

    kind: str
    words: tuple[str, ...]
    numbers: Mapping[str, Range]
    weights: Mapping[str, Range]


def traits(spec: str, names: Names, *, dotted: bool = True) -> tuple[Trait, ...]:
    """What a text says of a person: the kinds that it joins by `+`.

    Args:
      dotted: a kind of your own may be named by where it stands, `package.module:KIND`; not so in
        a file, since no file makes code run.

    Raises:
      UsageError: with everything that is wrong with it, and how to mend it.
    """
    found, wrong = list[Trait](), list[str]()
    for part in clean(spec).split("+"):
        kind, rest = kind_of(part.strip())
        if not dotted and kind not in tuple(KINDS) and is_dotted(kind):
            wrong.append(
                f"{part.strip()!r}: there is no such kind of person."
                f" {Known(KINDS).hint(kind.partition(':')[0])} One of your own is named here by an"
                " entry point of the group tandem.people, since no file makes code run."
            )
            continue
        try:
            KINDS[kind]
        except (KeyError, UsageError) as error:
            said = "" if isinstance(error, KeyError) else f" {error}"
            wrong.append(
                f"{part.strip()!r}: there is no such kind of person."
                f" {Known(KINDS).hint(kind.partition(':')[0])}{said}"
            )
            continue
        if kind in [trait.kind for trait in found]:
            wrong.append(f"{spec!r}: {kind!r} stands there twice. Keep one of them.")
        trait, faults = _trait(
            kind, [word.strip() for word in rest.split(",")] if rest else [], names
        )
        wrong += faults
        found.append(trait)
    tasting = [trait.kind for trait in found if trait.kind in TASTES]
    if len(set(tasting)) > 1:
        wrong.append(
            f"{spec!r}: {' and '.join(map(repr, tasting))} each say what the person likes. Keep one"
            " of them."
        )
    if wrong:
        raise UsageError("\n".join(f"people {sentence}" for sentence in wrong))
    return tuple(found)


def kind_of(text: str) -> tuple[str, str]:
    """The kind, and what stands behind its colon: ("random", "0.5"). A kind of your own is named by
    where it stands: ("mine.people:careful", "0.5") of "mine.people:careful:0.5".
    """
    kind, _, rest = text.partition(":")
    name, _, behind = rest.partition(":")
    if kind not in (*KINDS, "population") and is_dotted(f"{kind}:{name}"):
        return f"{kind}:{name}", behind
    return kind, rest


def person(
    traits: tuple[Trait, ...], names: Names, arrays: Arrays, draw: Callable[[], float] = lambda: 0.5
) -> Person:
    """The person; `draw` gives a number in 0..1 for each range (its middle when absent)."""
    made = compliant(arrays)
    for trait in traits:

        def drawn(ranges: Mapping[str, Range]) -> dict[str, float]:
            return {
                key: (
                    value.low
                    if value.low == value.high
                    else value.low + (value.high - value.low) * draw()
                )
                for key, value in ranges.items()
            }

        fields = KINDS[trait.kind].make(
            Made(names, arrays, trait.words, drawn(trait.numbers), drawn(trait.weights))
        )
        made = made._replace(
            **{key: np.asarray(value, np.float32) for key, value in fields.items()}
        )
    return made


@dataclass(frozen=True)
class Group:
    """People of one description, and which share of all they are."""

    spec: str
    traits: tuple[Trait, ...]
    share: float = 1.0

    @property
    def varies(self) -> bool:
        """Two of them can differ."""
        return any(
            value.low != value.high
            for trait in self.traits
            for value in (*trait.numbers.values(), *trait.weights.values())
        )


def _trait(kind: str, words: list[str], names: Names) -> tuple[Trait, list[str]]:
    """Reads what stands behind the colon; the second part holds what is wrong with it."""
    line, wrong, plain = KINDS[kind], [], list[str]()
    numbers: dict[str, Range] = {}
    weights: dict[str, Range] = {}
    for index, word in enumerate(words):
        key, equals, text = word.rpartition("=")
        if not equals and line.words is not None:
            plain.append(word)
            continue
        key = key.strip() if equals else next(iter(line.settings), "") if index == 0 else ""
        if key in line.settings:
            wrong += _number(kind, key, text, line.settings[key], numbers)
        elif line.weighs and "." in key:
            wrong += _unknown_weight(kind, key, names) or _number(
                kind, key, text, Setting(None, -1000.0, 1000.0), weights
            )
        else:
            known = [
                *line.settings,
                *(["task.NAME", "part.NAME", "tool.NAME"] if line.weighs else []),
            ]
            hint = f"It takes {', '.join(known)}." if known else "It takes nothing."
            wrong.append(
                f"{kind}: {word!r} says nothing here. {hint} Write {line.example!r}, for example."
            )
    for key, setting in line.settings.items():
        if setting.default is None and key not in numbers and not wrong:
            wrong.append(f"{kind}: {key} is missing. Write {line.example!r}, for example.")
        elif setting.default is not None:
            numbers.setdefault(key, Range(setting.default, setting.default))
    wrong += _unknown_words(kind, line, plain, names)
    return Trait(kind, tuple(plain), numbers, weights), wrong


def _number(kind: str, key: str, text: str, setting: Setting, into: dict[str, Range]) -> list[str]:
    low, dots, high = text.partition("..")
    try:
        ends = Range(float(low), float(high) if dots else float(low))
    except ValueError:
        return [f"{kind}: {key} is {text!r}, which is no number and no range such as 0.2..0.5."]
    if not setting.low <= ends.low <= ends.high <= setting.high:
        return [
            f"{kind}: {key} is {text}; it goes from {setting.low:g} to {setting.high:g}, the"
            " smaller number first."
        ]
    if key in into:
        return [f"{kind}: {key} stands there twice. Keep one of them."]
    into[key] = ends
    return []


def _unknown_weight(kind: str, key: str, names: Names) -> list[str]:
    what, _, name = key.partition(".")
    tasks = names.cell.tasks
    known: dict[str, set[str | None]] = {
        "task": {*tasks},
        "part": {task.part for task in tasks.values()},
        "tool": {tool for task in tasks.values() for _, tool in task.tools_named()},
    }
    if what not in known:
        return [f"{kind}: {key!r} weighs nothing. Write task.NAME, part.NAME or tool.NAME."]
    here = Known(sorted(filter(None, known[what])))
    return [] if name in here else [f"{kind}: there is no {what} {name!r}. {here.hint(name)}"]


def _unknown_words(kind: str, line: Kind, words: list[str], names: Names) -> Iterator[str]:
    if line.words is None:
        return
    known = Known(names.tasks if line.words == "tasks" else WORKERS)
    yield from (
        f"{kind}: there is no {line.words[:-1]} {word!r}. {known.hint(word)}"
        for word in words
        if word not in known
    )
    if not words:
        yield f"{kind}: no {line.words[:-1]} is named. Write {line.example!r}, for example."
    if line.words == "workers" and len(words) > 1:
        yield f"{kind}: {len(words)} workers are named. Keep one."
    yield from (
        f"{kind}: {word!r} stands there twice."
        for word in dict.fromkeys(words)
        if words.count(word) > 1
    )


def _prefers(made: Made) -> dict[str, Any]:
    """Named tasks first, in their order; then the others in the cell's."""
    order = [*made.words, *(name for name in made.names.tasks if name not in made.words)]
    taste = np.array(
        [-10.0 * order.index(task) for task, _ in made.names.ways]
    ) - made.arrays.way_ticks / max(1, made.arrays.way_ticks.max())
    return {"taste": taste, "follows": 0.0, "obeys": 0.0}


def _utility(made: Made) -> dict[str, Any]:
    """Minus weight times time and stress, each in units of its mean over the ways, plus the weights
    of the task, its part and the tools that humans take in hand for it.
    """
    ticks, load = (
        made.arrays.way_ticks.astype(float),
        made.arrays.way_load.sum(axis=1).astype(float),
    )
    taste = -made.numbers["time"] * ticks / ticks.mean() - made.numbers["stress"] * load / (
        load.mean() or 1.0
    )
    cell = made.names.cell
    for way, (name, mode) in enumerate(made.names.ways):
        tools = {tool for who, tool in mode.tools.items() if who in cell.humans}
        keys = (
            f"task.{name}",
            f"part.{cell.tasks[name].part}",
            *(f"tool.{tool}" for tool in sorted(tools)),
        )
        taste[way] += sum(made.weights.get(key, 0.0) for key in keys)
    follow = made.numbers["follow"]
    return {"taste": taste, "follows": follow, "obeys": float(follow > 0)}


def _tiring(made: Made) -> dict[str, Any]:
    minute = 60 * made.names.per_second
    load = made.arrays.way_load.sum(axis=1)
    rate = WORKERS[made.words[0]] * (LIGHT + (HEAVY - LIGHT) * load / max(1, load.max()))
    before = 1 - math.exp(-float(rate.mean()) * made.numbers["after"])
    return {
        "tires": rate / minute,
        "recovers": REST / minute,
        "slows": made.numbers["slows"],
        "fatigue": before,
    }


def _same(person_field: str, setting: str) -> Callable[[Made], dict[str, Any]]:
    return lambda made: {person_field: made.numbers[setting]}


_SHARE = Setting(None, 0.0, 1.0)


def theirs(home: str, found: Any) -> Kind:
    """A kind that others add. Raises UsageError for what is none."""
    if not isinstance(found, Kind):
        raise UsageError(
            f"{home}: is {found!r}, and no kind of person. Make a tandem.world.behaviour.Kind."
        )
    return found


KINDS: Table[Kind] = Table(
    "people",
    {
        "compliant": Kind(
            "does what is suggested, in the stated time", "compliant", lambda made: {}
        ),
        "random": Kind(
            "with probability p picks any legal task instead",
            "random:0.5",
            _same("random", "p"),
            {"p": _SHARE},
        ),
        "prefers": Kind(
            "takes the first legal task of an own list, whatever is suggested, and never waits",
            "prefers:3,1",
            _prefers,
            words="tasks",
        ),
        "utility": Kind(
            "takes what it likes best: weights against time and stress, for tasks, parts and"
            " tools; a suggestion is worth `follow`",
            "utility:stress=1,time=0.5,follow=0.3,task.4=-2",
            _utility,
            {
                "stress": Setting(0.0, -1000.0, 1000.0),
                "time": Setting(0.0, -1000.0, 1000.0),
                "follow": Setting(0.5, 0.0, 1000.0),
            },
            weighs=True,
        ),
        "pace": Kind(
            "takes the stated times times a factor that nobody is told",
            "pace:1.5",
            _same("pace", "factor"),
            {"factor": Setting(None, 0.05, 20.0)},
        ),
        "learning": Kind(
            "gets quicker: the n-th task takes n ** -b of the time",
            "learning:0.2",
            lambda made: {"learning": made.numbers["b"], "experience": made.numbers["experience"]},
            {"b": Setting(None, 0.0, 2.0), "experience": Setting(0.0, 0.0, 1e6)},
        ),
        "tiring": Kind(
            "tires at work and recovers at rest; `after` so many minutes without rest; at full"
            " fatigue a task takes 1 + `slows` of its time",
            "tiring:weak,after=10",
            _tiring,
            {"after": Setting(0.0, 0.0, 10_000.0), "slows": Setting(0.5, 0.0, 20.0)},
            words="workers",
        ),
        "forgetful": Kind(
            "a task goes wrong with probability p",
            "forgetful:0.1",
            _same("forgets", "p"),
            {"p": _SHARE},
        ),
        "refusing": Kind(
            "refuses a suggested task with probability p, for good where others can do it",
            "refusing:0.2",
            _same("refuses", "p"),
            {"p": _SHARE},
        ),
        "postponing": Kind(
            "puts a suggested task off with probability p",
            "postponing:0.2",
            _same("postpones", "p"),
            {"p": _SHARE},
        ),
        "adversarial": Kind(
            "takes the legal task that harms the team most, as far as a plain rule can tell; never"
            " waits",
            "adversarial",
            lambda made: {"taste": harm(made.arrays), "follows": 0.0, "obeys": 0.0},
        ),
    },
    theirs,
)
"""Every kind of person by name; `population:FILE` stands beside them. A new one is a line here, an
entry point of the group `tandem.people`, or anybody's by its dotted name.
"""

TASTES = ("prefers", "utility", "adversarial")
