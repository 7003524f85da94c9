"""Task times worked out for tasks that nobody has timed yet, and the cell that has them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import ROUND_CEILING, Decimal
from typing import Any

from pydantic import ValidationError

from tandem.cell.language import Words
from tandem.cell.model import Cell, plain
from tandem.cell.names import Known
from tandem.ergonomics import task_times
from tandem.ergonomics.facts import Facts, refusals
from tandem.errors import CellError, Fault

SCHEMA_VERSION = 1
TOP = ("tasks", "name")


@dataclass(frozen=True)
class Way:
    """A way to a time.

    Attributes:
      key: by which it is told in a file.
      step: its published name.
      kinds: of operators that it is for.
    """

    key: str
    step: str
    model: type[Facts]
    kinds: tuple[str, ...]


WAYS = (
    Way("moves", "robot_task", task_times.RobotFacts, ("robot", "machine")),
    Way("tmu", "tmu", task_times.TmuFacts, ("human",)),
    Way("first", "wright", task_times.LearningFacts, ("human",)),
)
"""Ways to a time, told apart by a key that only they have."""


@dataclass(frozen=True)
class Timed:
    """The time of one task for one operator.

    Attributes:
      seconds: as worked out; `outputs` has the terms.
    """

    task: str
    operator: str
    way: Way
    facts: Facts
    seconds: float
    outputs: Mapping[str, Any]

    @property
    def rounded(self) -> float:
        """As it is written into a cell: whole tenths of a second, rounded up."""
        return float(Decimal(repr(round(self.seconds, 9))).quantize(Decimal("0.1"), ROUND_CEILING))


def timed(document: Any) -> tuple[Timed, ...]:
    """Every time that a document's `tasks` describe: task -> operator -> facts.

    Raises:
      CellError: with every fault, each with the path to it.
    """
    if not isinstance(document, dict) or not isinstance(document.get("tasks"), dict):
        raise CellError(
            [
                Fault(
                    "`tasks` is missing. Write `tasks: {screw: {cobot: {moves: [...]}, anna: {tmu:"
                    " 280}}}`."
                )
            ]
        )
    faults = [
        Fault(f"unknown key `{name}`. {Known(TOP).hint(str(name))}", (name,))
        for name in document
        if name not in TOP
    ]
    found = []
    for task, of_task in document["tasks"].items():
        if not isinstance(of_task, dict) or not of_task:
            message = f"task {task!r}: a mapping from operators to facts is needed."
            faults.append(Fault(message, ("tasks", task)))
            continue
        for who, facts in of_task.items():
            one = _one(str(task), str(who), facts)
            if isinstance(one, Timed):
                found.append(one)
            else:
                faults += one
    if faults:
        raise CellError(faults)
    return tuple(found)


def _one(task: str, who: str, facts: Any) -> Timed | list[Fault]:
    at = ("tasks", task, who)
    ways = [way for way in WAYS if isinstance(facts, dict) and way.key in facts]
    if len(ways) != 1:
        told = ", ".join(f"`{way.key}`" for way in WAYS)
        message = (
            f"task {task!r}, {who!r}: one of {told} is needed, and says how the time is found."
        )
        return [Fault(message, at)]
    way = ways[0]
    given = {"n" if way.key == "tmu" and key == "tmu" else key: v for key, v in facts.items()}
    try:
        read = way.model.model_validate(given)
    except ValidationError as error:
        return refusals(error, way.model, way.step, at)
    outputs = task_times.FUNCTIONS[way.step].run(read)
    seconds = outputs["seconds"] if way.key == "tmu" else outputs["t_s"]
    return Timed(task, who, way, read, seconds, outputs)


def filled(cell: Cell, times: tuple[Timed, ...]) -> Cell:
    """The cell with these times. Raises CellError when a task or an operator is not in it, or the
    way is not one for that kind of operator.
    """
    faults, data = [], cell.to_dict()
    for one in times:
        at = ("tasks", one.task, one.operator)
        if one.task not in cell.tasks:
            hint = Known(cell.tasks).hint(one.task)
            faults.append(Fault(f"the cell has no task {one.task!r}. {hint}", at[:2]))
        elif one.operator not in cell.operators:
            hint = Known(cell.operators).hint(one.operator)
            faults.append(Fault(f"the cell has no operator {one.operator!r}. {hint}", at))
        elif (kind := cell.operators[one.operator].kind) not in one.way.kinds:
            message = (
                f"task {one.task!r}: {one.operator!r} is a {kind}, but `{one.way.key}` is for"
                f" {' and '.join(one.way.kinds)}s."
            )
            faults.append(Fault(message, at))
        else:
            stated = data["tasks"][one.task].setdefault("time", {})
            stated[one.operator] = plain(one.rounded)
    if faults:
        raise CellError(dict.fromkeys(faults))
    return Cell.model_validate(data)


def document_of(t: Words, times: tuple[Timed, ...], made: Mapping[str, str]) -> dict[str, Any]:
    """All of it as plain data."""
    return {
        "schema_version": SCHEMA_VERSION,
        "kind": "times",
        **made,
        "times": [
            {
                "task": one.task,
                "operator": one.operator,
                "seconds": one.seconds,
                "rounded": plain(one.rounded),
                "way": one.way.step,
                "facts": one.facts.model_dump(),
                "outputs": dict(one.outputs),
                "error": t(f"times.error.{one.way.step}"),
            }
            for one in times
        ],
    }


def sentences(t: Words, times: tuple[Timed, ...]) -> Iterator[str]:
    """A line for each time, then what each way does not see."""
    for one in times:
        told = {name: t.number(round(float(v), 3)) for name, v in one.outputs.items()}
        how = t(f"times.how.{one.way.step}", **told, **_facts(t, one.facts))
        yield t(
            "times.one", task=one.task, who=one.operator, seconds=t.number(one.rounded), how=how
        )
    for way in WAYS:
        if any(one.way == way for one in times):
            yield t(f"times.error.{way.step}")


def _facts(t: Words, facts: Facts) -> dict[str, str]:
    if isinstance(facts, task_times.RobotFacts):
        return {"number": t.number(sum(one.times for one in facts.moves))}
    if isinstance(facts, task_times.LearningFacts):
        return {
            "first": t.number(facts.first),
            "rate": t.share(facts.rate),
            "unit": str(facts.unit),
        }
    assert isinstance(facts, task_times.TmuFacts)
    return {"n": t.number(facts.n)}
