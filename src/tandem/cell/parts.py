"""The parts of a cell, and what a single value must look like; what values must be to each other is
said in `soundness.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property, lru_cache
from typing import Annotated, Any, Literal, NamedTuple, TypeVar

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
)
from pydantic_core import PydanticCustomError

from tandem.cell.names import clean, clean_title, harm_in

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
    """A human or a robot."""

    kind: Literal["human", "robot"] = Field(description="Stress counts for humans only.")
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
    tool: Name | None = Field(
        default=None,
        description=(
            "The tool in hand at the start. When absent, the first tool is at hand and costs no"
            " changeover."
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
    after: tuple[Name, ...] = Field(
        default=(), description="Tasks that must have ended before this one starts."
    )
    tool: Name | None = Field(
        default=None, description="The tool that every operator who does the task needs in hand."
    )
    zone: Name | None = Field(default=None, description="The shared space in which it is done.")
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

    @property
    def scatters(self) -> bool:
        """Whether a spread of its time is stated."""
        stated = self.spread.values() if isinstance(self.spread, Mapping) else (self.spread,)
        return any(spread > 0 for spread in stated)


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
    """

    operators: tuple[str, ...]
    time: float
    stress: Mapping[str, float]


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
    def tool_names(self) -> tuple[str, ...]:
        """All tools, those included that are only named: in this order they are counted."""
        named = [
            *(task.tool for task in self.tasks.values()),
            *self.tools,
            *(operator.tool for operator in self.operators.values()),
        ]
        return tuple(dict.fromkeys(name for name in named if name is not None))

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

    @cached_property
    def _modes(self) -> dict[str, tuple[Mode, ...]]:
        return {name: tuple(self._modes_of(task)) for name, task in self.tasks.items()}

    def _modes_of(self, task: Task) -> Iterator[Mode]:
        order = {name: place for place, name in enumerate(self.operators)}
        for name in sorted(task.time, key=order.__getitem__):
            yield Mode((name,), task.time[name], self._stress((name,), task.stress))
        for joint in task.together:
            operators = tuple(sorted(joint.operators, key=order.__getitem__))
            yield Mode(
                operators,
                joint.time,
                self._stress(operators, task.stress if joint.stress is None else joint.stress),
            )

    def _stress(
        self, operators: Iterable[str], stress: float | Mapping[str, float]
    ) -> dict[str, float]:
        humans = [name for name in operators if self.operators[name].kind == "human"]
        return {
            name: stress.get(name, 0.0) if isinstance(stress, Mapping) else stress
            for name in humans
        }
