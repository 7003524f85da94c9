"""The parts of a cell, and what a single value must look like; what values must be to each other is
said in `soundness.py`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from functools import cached_property, lru_cache
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Strict,
    Tag,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import PydanticCustomError

from tandem.cell.names import clean, clean_title, harm_in
from tandem.cell.walking import Pair, walking_times

V = TypeVar("V")


class Table(dict[str, V]):
    """A dictionary that stays as it was made, so that a frozen cell is frozen all the way down."""

    def _refuse(self, *_: object, **__: object) -> Any:
        raise TypeError("a cell is frozen; make a variant with cell.replace(...)")

    __setitem__ = __delitem__ = __ior__ = update = pop = popitem = clear = setdefault = _refuse

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(sorted(self.items())))

    def __reduce__(self) -> tuple[type[Table[V]], tuple[dict[str, V]]]:
        return type(self), (dict(self),)


def _spelled(value: object, spelling: Callable[[str], str] = clean) -> object:
    """Text in its one spelling; a whole number is taken as its digits, so that `after: [1, 2]` need
    no quotes.
    """
    if not isinstance(value, str):
        return str(value) if isinstance(value, int) and not isinstance(value, bool) else value
    text = spelling(value)
    if (harm := harm_in(text)) is not None:
        raise PydanticCustomError("harmful_sign", "{harm}", {"harm": harm})
    return text


def _titled(value: object) -> object:
    return _spelled(value, clean_title)


def _each_name_once(value: object) -> object:
    """Two keys that are spelled alike once they are clean would silently become one."""
    if isinstance(value, Mapping):
        seen: dict[str, object] = {}
        for key in value:
            first = seen.setdefault(clean(str(key)), key)
            if first is not key:
                raise PydanticCustomError(
                    "twins",
                    "{name}: {first}, {again}",
                    {"first": ascii(first), "again": ascii(key), "name": clean(str(key))},
                )
    return value


OneEntryAName = BeforeValidator(_each_name_once)

Name = Annotated[
    str,
    BeforeValidator(_spelled),
    Field(min_length=1, max_length=200, pattern=r"\S"),
    WithJsonSchema(
        {"type": ["string", "number"], "minLength": 1, "maxLength": 200, "pattern": r"\S"}
    ),
]
"""A name. Files may write one without quotes though it looks like a number; it is taken as it is
written, in the one spelling of `names.clean`.
"""
Text = Annotated[
    str,
    BeforeValidator(_titled),
    Field(max_length=500),
    WithJsonSchema({"type": ["string", "number"], "maxLength": 500}),
]
"""A title for people; it may look like a number, too."""
Seconds = Annotated[float, Strict(), Field(gt=0, le=1e7, allow_inf_nan=False)]
"""A duration: more than 0 s."""
Moment = Annotated[float, Strict(), Field(ge=0, le=1e7, allow_inf_nan=False)]
"""A point on the clock, or a duration that may be 0 s."""
Amount = Annotated[float, Strict(), Field(ge=0, le=1e7, allow_inf_nan=False)]
"""Ergonomic stress, difficulty or a spread: 0 or more."""
Metres = Annotated[float, Strict(), Field(ge=-1e4, le=1e4, allow_inf_nan=False)]
"""A coordinate."""
MOST_BREAKS = 2_000
"""Times off of one operator: more than a year of shifts has."""
Places = Annotated[int, Strict(), Field(ge=1, le=10_000)]

PerOperator = Annotated[Mapping[Name, Amount], OneEntryAName, AfterValidator(Table)]


def _form(value: object) -> str:
    return "table" if isinstance(value, Mapping) else "number"


OneOrEach = Annotated[
    Annotated[Amount, Tag("number")] | Annotated[PerOperator, Tag("table")], Discriminator(_form)
]
"""One number for all, or a number for each by name; 0 for who is not named."""


def _named(value: object) -> str:
    return "table" if isinstance(value, Mapping) else "name"


ToolPerOperator = Annotated[Mapping[Name, Name], OneEntryAName, AfterValidator(Table)]
ToolOrEach = Annotated[
    Annotated[Name, Tag("name")] | Annotated[ToolPerOperator, Tag("table")], Discriminator(_named)
]
"""One tool for all, or a tool for each by name; none for who is not named."""
Kind = Literal["human", "robot", "machine"]
"""What an operator is."""
KINDS: tuple[Kind, ...] = get_args(Kind)


class TimeOff(NamedTuple):
    """A span in which an operator neither works nor takes up a tool, seconds, and what it is."""

    start: float
    end: float
    what: Literal["break", "setup"]

    def __str__(self) -> str:
        if self.what == "setup":
            return f"is set up only at {self.end:g} s"
        return f"has a break from {self.start:g} s to {self.end:g} s"


class Frozen(BaseModel):
    """Unknown keys are refused, values stay as they are."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", ser_json_inf_nan="strings", validate_default=True
    )


class Operator(Frozen):
    """A human, a robot, or a machine such as a press, an oven or a test stand."""

    kind: Kind = Field(
        description=(
            "human, robot or machine. Stress counts for humans only; a machine is given no sheet of"
            " instructions."
        )
    )
    label: Text | None = Field(
        default=None,
        description="What charts and messages call the operator; the name when absent.",
    )
    breaks: tuple[tuple[Moment, Seconds], ...] = Field(
        default=(),
        max_length=MOST_BREAKS,
        description=(
            "Times off, each `[from, to]` in seconds since the start. No task and no changeover"
            " runs into one."
        ),
    )
    setup: Moment = Field(
        default=0.0,
        description=(
            "Seconds that the operator needs once, from the start on, to get ready. In one piece:"
            " where a break would fall into it, behind that break. No task and no changeover begins"
            " before."
        ),
    )
    stress_limit: Amount | None = Field(
        default=None, description="The most stress that this human may collect in all."
    )
    limits: PerOperator = Field(
        default_factory=Table,
        description=(
            "The most that this human may have of further measures: `peak:SCALE` (highest value of"
            " a task), `time-above:SCALE:LEVEL` (seconds in tasks at the level and above) and"
            " `dose:SCALE` (of a shift, see `cycles_per_shift`), such as `{peak:reba: 7}`. Scales"
            " are those of the tasks' `ergonomics`, and `stress`."
        ),
    )
    tool: Name | None = Field(
        default=None,
        description=(
            "The tool in hand at the start. When absent, the first tool is at hand and costs no"
            " changeover."
        ),
    )
    place: Name | None = Field(
        default=None,
        description=(
            "Where the operator stands at the start. When absent, at the place of its first task."
        ),
    )

    holds: tuple[tuple[Name, Name], ...] = Field(
        default=(),
        description=(
            "Of a machine: pairs `[FIRST, LAST]` of tasks. From the start of FIRST to the end of"
            " LAST it holds the part, and does nothing but these two and the tasks between them."
        ),
    )

    @property
    def setting_up(self) -> tuple[float, float] | None:
        """From when to when it gets ready, seconds: at once, or behind the breaks that would fall
        into it. None when it need not.
        """
        return _setting_up(self.setup, self.breaks)

    @property
    def times_off(self) -> tuple[TimeOff, ...]:
        """When it cannot work, in order; they do not overlap in a sound cell.

        All that lies before it is ready is one time off: breaks in it make no difference.
        """
        return _times_off(self.setup, self.breaks)


@lru_cache(maxsize=4096)
def _setting_up(
    setup: float, breaks: tuple[tuple[float, float], ...]
) -> tuple[float, float] | None:
    if not setup:
        return None
    start, length = Decimal(0), Decimal(repr(setup))
    for off, back in sorted(breaks):
        if Decimal(repr(off)) < start + length:
            start = max(start, Decimal(repr(back)))
    return float(start), float(start + length)


# by the values, since a copy of a model with other values takes the model's own memory along
@lru_cache(maxsize=4096)
def _times_off(setup: float, breaks: tuple[tuple[float, float], ...]) -> tuple[TimeOff, ...]:
    span = _setting_up(setup, breaks)
    ready = 0.0 if span is None else span[1]
    rest = tuple(
        TimeOff(start, end, "break") for start, end in sorted(breaks) if not ready or start >= ready
    )
    return (TimeOff(0.0, ready, "setup"), *rest) if ready else rest


class Together(Frozen):
    """A way of doing a task that occupies several operators at once."""

    operators: tuple[Name, ...] = Field(
        min_length=2, description="All who take part, from start to end."
    )
    time: Seconds = Field(description="Seconds.")
    stress: OneOrEach | None = Field(
        default=None,
        description=(
            "Stress on each human who takes part: one number for each of them, or a number per"
            " human (0 for who is not named). The task's own when absent."
        ),
    )
    tool: ToolOrEach | None = Field(
        default=None,
        description=(
            "The tool that each of them needs in hand, or a table of operator to tool (none for who"
            " is not named; `{}` when nobody needs one). The task's own when absent."
        ),
    )


Between = Literal["end-start", "start-start"]


class Wait(Frozen):
    """A time that passes between two tasks, such as curing, open time or cooling; nobody is busy
    meanwhile.
    """

    after: Name = Field(description="The task that comes first.")
    between: Between = Field(
        default="end-start",
        description=(
            "What the wait is counted from: the end of that task (it must have ended then), or its"
            " start; up to the start of this one."
        ),
    )
    at_least: Moment = Field(
        default=0.0, description="Seconds that must have passed when this task starts."
    )
    at_most: Moment | None = Field(
        default=None,
        description="Seconds within which this task must start; any time when absent.",
    )


def _as_list(value: object) -> object:
    return [value] if isinstance(value, Mapping | Wait) else value


Waits = Annotated[
    tuple[Wait, ...], BeforeValidator(_as_list, json_schema_input_type=Wait | tuple[Wait, ...])
]
"""Waits of a task; one may stand there without a list around it."""


MOST_OF_A_FACT = 10**15


def _fact(value: object) -> object:
    """A fact as it was written: a number, a word, yes or no; or a mapping that says besides in
    which unit it is and where it came from.
    """
    if isinstance(value, Mapping):
        try:
            return Table({str(name): _fact(one) for name, one in value.items() if one is not None})
        except PydanticCustomError as error:  # told of the fact as a whole
            raise PydanticCustomError("fact_type", "a value that is no fact") from error
    if isinstance(value, str):
        return _titled(value)
    if isinstance(value, float) and not math.isfinite(value):
        raise PydanticCustomError("finite_number", "Input should be a finite number")
    if isinstance(value, int) and abs(value) > MOST_OF_A_FACT:
        raise PydanticCustomError("int_parsing_size", "a smaller number is needed")
    if isinstance(value, int | float):
        return value
    raise PydanticCustomError("fact_type", "a number, a word, true or false is needed")


_PLAIN_FACT = ("number", "string", "boolean")
FactAsWritten = Annotated[
    Any,
    BeforeValidator(_fact),
    WithJsonSchema(
        {
            "type": [*_PLAIN_FACT, "object", "null"],
            "properties": {
                "value": {"type": [*_PLAIN_FACT], "description": "The fact."},
                "unit": {"type": "string", "description": "In which it is counted."},
                "source": {
                    "type": "string",
                    "description": "measured, video, estimated, default or stated.",
                },
                "assessor": {"type": ["string", "number"], "description": "Who assessed it."},
                "date": {"type": ["string", "number"], "description": "When."},
            },
            "required": ["value"],
            "additionalProperties": False,
        }
    ),
]


class Assessment(Frozen):
    """What is known about the work of a task for one ergonomic method: facts of one execution, by
    their published names or as people write them in English or German, or a number from outside.
    Beside the facts may stand side, source, assessor, date, minutes and reps_per_cycle.
    """

    model_config = ConfigDict(
        frozen=True, extra="allow", ser_json_inf_nan="strings", validate_default=True
    )
    __pydantic_extra__: dict[str, FactAsWritten]

    method: Name = Field(
        description=(
            "The method that scores the facts beside it: a name that `tandem score --list` shows."
            " Of methods that are licensed or not verified (eaws, ocra, kim_lhc) only the `score`."
        )
    )
    operators: tuple[Name, ...] = Field(
        default=(),
        description="The humans for whom it was assessed; every human who can do it when absent.",
    )
    score: Amount | None = Field(
        default=None,
        description=(
            "The number that the method gives. With facts it is what they come to; without, a"
            " number from outside. Of a method that gives doses it is that of one execution."
        ),
    )

    @model_validator(mode="before")
    @classmethod
    def _without_empty_keys(cls, value: Any) -> Any:
        """A key without a value states no fact."""
        if not isinstance(value, Mapping):
            return value
        return {
            name: item
            for name, item in value.items()
            if item is not None or name in cls.model_fields
        }

    @property
    def facts(self) -> Mapping[str, Any]:
        """What stands beside method, operators and score, as it was written."""
        return self.model_extra or {}


def _as_assessments(value: object) -> object:
    return [value] if isinstance(value, Mapping | Assessment) else value


Assessments = Annotated[
    tuple[Assessment, ...],
    BeforeValidator(_as_assessments, json_schema_input_type=Assessment | tuple[Assessment, ...]),
]
"""Assessments of a task; one may stand there without a list around it."""


class Task(Frozen):
    """One assembly step. It can be done by each operator in `time` alone, or by each group in
    `together`.
    """

    label: Text | None = Field(
        default=None, description="What charts and messages call the task; its name when absent."
    )
    part: Text | None = Field(default=None, description="The part or product that it mounts.")
    time: Annotated[Mapping[Name, Seconds], OneEntryAName, AfterValidator(Table)] = Field(
        default_factory=Table,
        description="Operator to seconds. An operator that is missing cannot do the task.",
    )
    together: tuple[Together, ...] = Field(
        default=(), description="Alternatives that occupy several operators at once."
    )
    stress: OneOrEach = Field(
        default=0.0,
        description=(
            "Ergonomic stress on the human who does it: one number, or a number per human (0 for"
            " who is not named)."
        ),
    )
    ergonomics: Assessments = Field(
        default=(),
        description=(
            "What is known about the work for ergonomic methods: one assessment `{method: reba,"
            " trunk: 45, ...}`, or a list of them. It is not added to `stress`: ordinal scores are"
            " never summed."
        ),
    )
    after: tuple[Name, ...] = Field(
        default=(), description="Tasks that must have ended before this one starts."
    )
    wait: Waits = Field(
        default=(),
        description=(
            "How long after another task this one may start, at least and at most: one wait, or a"
            " list of them."
        ),
    )
    tool: ToolOrEach | None = Field(
        default=None,
        description=(
            "The tool that every operator who does the task needs in hand, or a table of operator"
            " to tool; who is not named in it needs none."
        ),
    )
    zone: Name | None = Field(default=None, description="The shared space in which it is done.")
    place: Name | None = Field(
        default=None,
        description=(
            "Where it is done. Who stands at another place walks there directly before, as `walk`"
            " says; a task without a place is done wherever its operators stand."
        ),
    )
    difficulty: PerOperator = Field(
        default_factory=Table,
        description="How hard the task is for an operator: operator to a number; 0 when absent.",
    )
    release: Moment = Field(default=0.0, description="Earliest start, seconds.")
    deadline: Seconds | None = Field(default=None, description="Latest end, seconds.")
    spread: OneOrEach = Field(
        default=0.0,
        description=(
            "Coefficient of variation of the time, for simulation: one number, or a number per"
            " operator."
        ),
    )

    def tools_named(self) -> Iterator[tuple[tuple[str | int, ...], str]]:
        """Every tool that it names, and the keys that lead to it; a tool may come several times."""
        stated: list[tuple[tuple[str | int, ...], str | Mapping[str, str] | None]] = [
            (("tool",), self.tool),
            *(
                (("together", place, "tool"), joint.tool)
                for place, joint in enumerate(self.together)
            ),
        ]
        for path, tool in stated:
            if isinstance(tool, Mapping):
                yield from (((*path, who), name) for who, name in tool.items())
            elif tool is not None:
                yield path, tool

    @property
    def predecessors(self) -> tuple[str, ...]:
        """Tasks that must have ended before this one starts: those in `after`, then those whose
        end it waits from; each once.
        """
        if not self.wait:
            return tuple(dict.fromkeys(self.after))
        ended = (wait.after for wait in self.wait if wait.between == "end-start")
        return tuple(dict.fromkeys((*self.after, *ended)))

    @property
    def begun_first(self) -> tuple[str, ...]:
        """Tasks that must have begun before this one starts, or begin with it: its predecessors,
        and those whose start it waits from; each once.
        """
        if not self.wait:
            return self.predecessors
        return tuple(dict.fromkeys((*self.after, *(wait.after for wait in self.wait))))

    @property
    def scatters(self) -> bool:
        """Whether a spread of its time is stated."""
        stated = self.spread.values() if isinstance(self.spread, Mapping) else (self.spread,)
        return any(spread > 0 for spread in stated)


def tools_of(tool: str | Mapping[str, str] | None, operators: Iterable[str]) -> dict[str, str]:
    """Operator to tool, of these who need one: each the same, or what the table says."""
    stated = tool if isinstance(tool, Mapping) else {who: tool for who in operators if tool}
    return {who: stated[who] for who in operators if who in stated}


class Tool(Frozen):
    """A tool that tasks name."""

    capacity: Places = Field(
        default=1,
        description="How many of it there are: so many operators can work with it at once.",
    )
    changeover: PerOperator = Field(
        default_factory=Table,
        description=(
            "Operator to seconds needed to take it up when another tool was in hand; 0 when absent."
        ),
    )


class Zone(Frozen):
    """A shared space that tasks name."""

    capacity: Places = Field(default=1, description="How many operators it holds at once.")
    apart: tuple[Kind, ...] = Field(
        default=(),
        description=(
            "Kinds of operators that are never in it at once, such as `[human, robot]`: several of"
            " one kind may be, as far as there are places. Kinds that are not named mind nobody."
        ),
    )


NAMED = ("after", "operators", "tool", "zone", "place", "label", "part")
"""Keys of a task whose values are names, where digits need no quotes."""


def _frozen(value: Any, named: bool = False) -> Any:
    """Plain values that stay as they are, all the way down; names in their one spelling."""
    if isinstance(value, Mapping):
        return Table(
            {clean(str(key)): _frozen(item, named=key in NAMED) for key, item in value.items()}
        )
    if isinstance(value, list | tuple):
        return tuple(_frozen(item, named) for item in value)
    return _spelled(value) if named else value


class Cost(Frozen):
    """What an hour of the station costs, in whatever currency."""

    operators: PerOperator = Field(
        default_factory=Table, description="Operator to the cost of an hour; 0 when absent."
    )
    station: Amount = Field(
        default=0.0, description="Cost of an hour of everything else: floor, energy, maintenance."
    )
    invest: Amount = Field(default=0.0, description="Money invested once.")
    hours: Seconds | None = Field(
        default=None, description="Working hours over which `invest` is spread."
    )


class Variant(Frozen):
    """Another product of the same station: the cell plus these changes."""

    share: Seconds = Field(
        default=1.0,
        description="How often it is made beside the other variants: a weight of the mix.",
    )
    tasks: Annotated[
        Mapping[Name, Mapping[str, Any] | None], OneEntryAName, AfterValidator(_frozen)
    ] = Field(
        default_factory=Table,
        description=(
            "Changes to tasks, as a merge patch (RFC 7396): keys that are named replace those of"
            " the cell's task, a new name is a new task, and null takes a key or a task out."
        ),
    )


@dataclass(frozen=True)
class Mode:
    """One way of doing a task.

    Attributes:
      operators: who takes part, in the cell's order.
      time: seconds.
      stress: human -> stress on that human; humans who take part only.
      tools: operator -> the tool that it needs in hand; who needs none is not in it.
    """

    operators: tuple[str, ...]
    time: float
    stress: Mapping[str, float]
    tools: Mapping[str, str] = field(default_factory=dict)


class Fields(Frozen):
    """All that a cell holds, each value well formed; whether they fit together is not known yet.
    The rules of soundness read it.
    """

    format: Literal[1] = Field(default=1, description="Version of this file format.")
    name: Text = Field(default="", description="What charts and reports call the cell.")
    operators: Annotated[Mapping[Name, Operator], OneEntryAName, AfterValidator(Table)] = Field(
        min_length=1, description="Who works here: name to operator."
    )
    tasks: Annotated[Mapping[Name, Task], OneEntryAName, AfterValidator(Table)] = Field(
        min_length=1, description="What is to be done: name to task."
    )
    tools: Annotated[Mapping[Name, Tool], OneEntryAName, AfterValidator(Table)] = Field(
        default_factory=Table,
        description=(
            "What is special about a tool. One that is not listed exists once and costs no"
            " changeover."
        ),
    )
    zones: Annotated[Mapping[Name, Zone], OneEntryAName, AfterValidator(Table)] = Field(
        default_factory=Table,
        description=(
            "What is special about a zone. One that is not listed holds one operator at a time."
        ),
    )
    places: Annotated[
        Mapping[Name, tuple[Metres, Metres]], OneEntryAName, AfterValidator(Table)
    ] = Field(
        default_factory=Table,
        description=(
            "Where places are: name to `[x, y]` in metres. Needed where `walk` states a speed."
        ),
    )
    walk: Annotated[
        Mapping[Name, Annotated[Mapping[Name, Amount], OneEntryAName, AfterValidator(Table)]],
        OneEntryAName,
        AfterValidator(Table),
    ] = Field(
        default_factory=Table,
        description=(
            "How long operators walk between places: operator to a table. `FROM-TO: seconds` counts"
            " for both directions, unless `TO-FROM` is stated too; `speed`, in metres a second,"
            " gives the other ways by the coordinates in `places`, rounded up to tenths of a"
            " second. What is not stated takes 0 s."
        ),
    )
    same_operator: tuple[tuple[Name, Name], ...] = Field(
        default=(), description="Pairs of tasks that must be done by the same operators."
    )
    stress_of_set: (
        Annotated[
            Mapping[Annotated[str, BeforeValidator(_spelled)], Amount],
            OneEntryAName,
            AfterValidator(Table),
        ]
        | None
    ) = Field(
        default=None,
        description=(
            "Stress by table instead of by sum, for methods that do not add up (such as the Strain"
            " Index): the tasks done by humans, in the cell's order and joined by commas, to the"
            " stress of doing just these. A set that is not listed is not allowed."
        ),
    )
    cycles_per_shift: Seconds | None = Field(
        default=None,
        description="How many products a shift makes; a dose of a shift counts that many.",
    )
    cost: Cost | None = Field(
        default=None,
        description="What an hour costs; then each plan says what a piece costs.",
    )
    variants: Annotated[Mapping[Name, Variant], OneEntryAName, AfterValidator(Table)] = Field(
        default_factory=Table,
        description="Other products of the station: name to what is different about it.",
    )

    @cached_property
    def humans(self) -> tuple[str, ...]:
        """Names of the humans, in the cell's order."""
        return tuple(name for name, operator in self.operators.items() if operator.kind == "human")

    @cached_property
    def robots(self) -> tuple[str, ...]:
        """Names of the robots, in the cell's order."""
        return tuple(name for name, operator in self.operators.items() if operator.kind == "robot")

    @cached_property
    def machines(self) -> tuple[str, ...]:
        """Names of the machines, in the cell's order."""
        return tuple(n for n, operator in self.operators.items() if operator.kind == "machine")

    @cached_property
    def crew(self) -> dict[Kind, tuple[str, ...]]:
        """Names of the operators by kind, humans first, in the cell's order; kinds that are not
        there are left out.
        """
        groups: dict[Kind, tuple[str, ...]] = {
            "human": self.humans,
            "robot": self.robots,
            "machine": self.machines,
        }
        return {kind: names for kind, names in groups.items() if names}

    @cached_property
    def tool_names(self) -> tuple[str, ...]:
        """All tools, those included that are only named: in this order they are counted."""
        named = [
            *(name for task in self.tasks.values() for _, name in task.tools_named()),
            *self.tools,
            *(operator.tool for operator in self.operators.values()),
        ]
        return tuple(dict.fromkeys(name for name in named if name is not None))

    @cached_property
    def place_names(self) -> tuple[str, ...]:
        """All places, those included that are only named: in this order they are counted."""
        named = [
            *(task.place for task in self.tasks.values()),
            *self.places,
            *(operator.place for operator in self.operators.values()),
        ]
        return tuple(dict.fromkeys(name for name in named if name is not None))

    @cached_property
    def walking(self) -> Mapping[str, Mapping[Pair, float]]:
        """Operator to seconds from one place to another, pairs of places that take none left
        out.
        """
        return walking_times(self.walk, self.places, self.place_names)

    @cached_property
    def zone_names(self) -> tuple[str, ...]:
        """All zones, those included that are only named: in this order they are counted."""
        named = [*(task.zone for task in self.tasks.values()), *self.zones]
        return tuple(dict.fromkeys(name for name in named if name is not None))

    def modes(self, task: str) -> tuple[Mode, ...]:
        """Every way of doing the task: each operator alone in the cell's order, then the joint ways
        as given.
        """
        return self._modes[task]

    def tools_for(self, task: str, operators: Iterable[str]) -> Mapping[str, str]:
        """Operator to tool, of these who do the task and need one for it. Should they have no way
        of doing it, the tools that the task states.
        """
        if not self.tool_names:
            return {}
        who = frozenset(operators)
        known = self._tools_of_groups[task].get(who)
        return tools_of(self.tasks[task].tool, sorted(who)) if known is None else known

    def takes(
        self, kind: Literal["tool", "zone"], task: str, operators: Iterable[str]
    ) -> Mapping[str, str]:
        """Operator to the tool or the zone of which it takes one place while these do the task."""
        if kind == "tool":
            return self.tools_for(task, operators)
        zone = self.tasks[task].zone
        return {} if zone is None else dict.fromkeys(operators, zone)

    @cached_property
    def _tools_of_groups(self) -> dict[str, dict[frozenset[str], Mapping[str, str]]]:
        return {
            task: {frozenset(mode.operators): mode.tools for mode in modes}
            for task, modes in self._modes.items()
        }

    @cached_property
    def _modes(self) -> dict[str, tuple[Mode, ...]]:
        order = {name: place for place, name in enumerate(self.operators)}
        return {name: tuple(self._modes_of(task, order)) for name, task in self.tasks.items()}

    def _modes_of(self, task: Task, order: Mapping[str, int]) -> Iterator[Mode]:
        for name in sorted(task.time, key=order.__getitem__):
            yield Mode(
                (name,),
                task.time[name],
                self._stress((name,), task.stress),
                tools_of(task.tool, (name,)),
            )
        for joint in task.together:
            operators = tuple(sorted(joint.operators, key=order.__getitem__))
            yield Mode(
                operators,
                joint.time,
                self._stress(operators, task.stress if joint.stress is None else joint.stress),
                tools_of(task.tool if joint.tool is None else joint.tool, operators),
            )

    def _stress(
        self, operators: Iterable[str], stress: float | Mapping[str, float]
    ) -> dict[str, float]:
        humans = [name for name in operators if self.operators[name].kind == "human"]
        if isinstance(stress, Mapping):
            return {name: stress.get(name, 0.0) for name in humans}
        return dict.fromkeys(humans, stress)
