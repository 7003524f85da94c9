"""Why no schedule exists, in the cell's own words: a minimal set of limits that cannot be kept
together, each confirmed by planning anew.

Limits are lifted as a user would: by leaving a key out of the cell or an option out of the call.
What is found is therefore something the user can do, and not a statement about a model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from time import monotonic
from typing import Any, NamedTuple

from tandem.cell.model import Cell, plain
from tandem.cell.parts import Operator, Table, Task, Tool, Wait, Zone
from tandem.errors import CellError, InfeasibleError, NothingFoundError
from tandem.plan import exact
from tandem.plan.least_limits import first_schedule, least_limit
from tandem.plan.question import Question
from tandem.schedule.measures import exact as exact_number
from tandem.schedule.said import Said, said


def in_words(key: str, **values: object) -> Said:
    """A sentence, or a part of one, that can be said in other languages too."""
    return said(key, "tandem.plan", **values)


def _and(names: Sequence[str]) -> str:
    """All of them, with an "and" between each two."""
    whole = names[0]
    for name in names[1:]:
        whole = in_words("both", one=whole, other=name)
    return whole


def _kinds(kinds: Iterable[str]) -> list[str]:
    return [in_words(f"kind.{kind}") for kind in kinds]


EACH_S = 5.0
"""Seconds for one question "is there a schedule without this?"."""


@dataclass(frozen=True)
class Limit:
    """Something that can be lifted.

    Attributes:
      words: what it says, to stand in a sentence.
      where: `question`, `limit` (of the call), or the key of the cell that holds it, with the names
        below it.
    """

    words: str
    where: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        return {"words": self.words, "where": list(self.where)}


class Core(NamedTuple):
    """Limits that cannot be kept together.

    Attributes:
      needed: per limit, whether the others alone have been shown to be possible. Where all are, the
        set is minimal; otherwise time was too short to tell.
    """

    items: tuple[Limit, ...]
    needed: tuple[bool, ...]

    @property
    def is_minimal(self) -> bool:
        """Each of them was shown to be needed."""
        return all(self.needed)

    def doubt(self) -> list[str]:
        """A sentence about those that were not shown to be needed, where there are any."""
        words = [x.words for x, needed in zip(self.items, self.needed, strict=True) if not needed]
        return [in_words("doubt", limits=_and(words))] if words else []

    def to_dict(self) -> dict[str, Any]:
        """As a document holds it."""
        return {
            "together": [
                {**limit.to_dict(), "needed": needed}
                for limit, needed in zip(self.items, self.needed, strict=True)
            ],
            "minimal": self.is_minimal,
        }


def minimal_core(
    items: Sequence[Limit], possible: Callable[[Sequence[Limit]], bool | None]
) -> Core:
    """Of limits that cannot all be kept together, a set that cannot either and would not be one
    without any of its members.

    They are left out from the first to the last as long as the rest stays impossible (the deletion
    filter of Chinneck and Dravnieks 1991, ORSA Journal on Computing 3(2), 157-168); of many
    first whole blocks are, then halves of those. What was needed among more is needed among
    fewer.

    Args:
      possible: whether these can be kept together, all others left out; None when that is
        not known, and then nothing is concluded.
    """
    kept, size = list(items), max(1, len(items) // 2)
    known: dict[Limit, bool | None] = {}
    while True:
        place = 0
        while place < len(kept):
            rest = [*kept[:place], *kept[place + size :]]
            answer = possible(rest)
            if answer is False:
                kept = rest
                continue
            if size == 1:
                known[kept[place]] = answer
            place += size
        if size == 1:
            return Core(tuple(kept), tuple(known[limit] is True for limit in kept))
        size //= 2


@dataclass(frozen=True)
class Gain:
    """What planning without one limit gives: a schedule's makespan and stress; None when there is
    none, or none was found in time.
    """

    limit: Limit
    makespan: float | None
    stress: float | None

    def sentence(self) -> str:
        """In words."""
        if self.makespan is None or self.stress is None:
            return in_words("gain.none", limit=self.limit.words)
        return in_words(
            "gain",
            limit=self.limit.words,
            makespan=exact_number(self.makespan),
            stress=exact_number(self.stress),
        )


@dataclass(frozen=True)
class Conflict:
    """Limits that cannot be kept together, and what lifting each one of them would give.

    Attributes:
      core: the limits, and which of them were shown to be needed.
      least: people -> the least limit of stress that all of them can keep at once, and who keeps
        their own limit meanwhile.
      gains: per limit. One that is needed in the set may not help alone, where other limits
        contradict each other too.
    """

    core: Core
    least: tuple[LeastLimit, ...]
    gains: tuple[Gain, ...]

    def sentences(self) -> list[str]:
        """In words. Each that says "without it there is a schedule" was found by planning so."""
        names = [limit.words for limit in self.core.items]
        together = in_words("alone" if len(names) == 1 else "together", limits=tuple(names))
        least = [one.sentence() for one in self.least]
        return [together, *self.core.doubt(), *least, *(gain.sentence() for gain in self.gains)]

    def to_dict(self) -> dict[str, Any]:
        """The `infeasible` of a document."""
        return {
            **self.core.to_dict(),
            "least": [one.to_dict() for one in self.least],
            "without": [
                {
                    **gain.limit.to_dict(),
                    "helps": gain.makespan is not None,
                    "makespan": plain(gain.makespan),
                    "stress": plain(gain.stress),
                }
                for gain in self.gains
            ],
        }


@dataclass(frozen=True)
class LeastLimit:
    """The least limit of stress that these people can keep at once, `beside` naming the limits that
    others keep.
    """

    people: tuple[str, ...]
    limit: float
    beside: str

    def sentence(self) -> str:
        """In words."""
        who = in_words("each") if len(self.people) > 1 else self.people[0]
        least = exact_number(self.limit)
        return in_words("least", who=who, beside=self.beside, limit=least)

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        return {"people": list(self.people), "stress_limit": plain(self.limit)}


def conflict(cell: Cell, question: Question, *, seconds: float = 30.0) -> Conflict | None:
    """The limits that cannot be kept together, and what lifting each would give; None when lifting
    all limits would not help. Assumes that no schedule keeps them all.
    """
    until = monotonic() + seconds

    def possible(lifted: Sequence[Limit]) -> bool | None:
        return _possible(cell, question, lifted, until)

    core = core_of(list(limits(cell, question)), possible, until)
    if not core.items:
        return None
    least = _least_stress_limits(cell, question, core.items, until)
    return Conflict(core, tuple(least), tuple(_gain(cell, question, x) for x in core.items))


def core_of(
    everything: Sequence[Limit],
    possible: Callable[[Sequence[Limit]], bool | None],
    until: float,
) -> Core:
    """The `minimal_core` of all these, asked until `monotonic()` seconds; `possible` is told what
    is lifted, in place of what is kept.
    """

    def is_kept(kept: Sequence[Limit]) -> bool | None:
        lifted = [limit for limit in everything if limit not in kept]
        return possible(lifted) if monotonic() < until else None

    return minimal_core(everything, is_kept)


def infeasible(message: str, cell: Cell, question: Question) -> InfeasibleError:
    """The error that says why nothing answers the question."""
    found = conflict(cell, question)
    if found is None:
        return InfeasibleError(message)
    return InfeasibleError(message, found.sentences(), found.to_dict())


KEEP_AWAY = ("breaks", "setup")
"""Keys of an operator that say when they cannot work."""


def limits(cell: Cell, question: Question) -> Iterator[Limit]:
    """Everything that could be lifted: the question's limits first, then the cell's."""
    if question.max_makespan is not None:
        words = in_words("max_makespan", limit=exact_number(question.max_makespan))
        yield Limit(words, ("question", "max_makespan"))
    if question.max_stress is not None:
        words = in_words("max_stress", limit=exact_number(question.max_stress))
        yield Limit(words, ("question", "max_stress"))
    for rule in (on_people, _on_ends, _on_who_does_what, _on_who_and_what_is_there, _on_room):
        yield from rule(cell)


def on_people(cell: Cell) -> Iterator[Limit]:
    """What people may have at most."""
    for name, operator in cell.operators.items():
        if operator.stress_limit is not None:
            limit = exact_number(operator.stress_limit)
            words = in_words("stress_limit", name=name, limit=limit)
            yield Limit(words, ("operators", name, "stress_limit"))
        for measure, most in operator.limits.items():
            words = in_words("limits", name=name, measure=measure, limit=exact_number(most))
            yield Limit(words, ("operators", name, "limits", measure))


def _on_ends(cell: Cell) -> Iterator[Limit]:
    for name, task in cell.tasks.items():
        if task.deadline is not None:
            words = in_words("deadline", task=name, limit=exact_number(task.deadline))
            yield Limit(words, ("tasks", name, "deadline"))


def _on_who_does_what(cell: Cell) -> Iterator[Limit]:
    if cell.stress_of_set is not None:
        yield Limit(in_words("stress_of_set"), ("stress_of_set",))
    for one, two in cell.same_operator:
        words = in_words("same_operator", one=one, two=two)
        yield Limit(words, ("same_operator", one, two))


def _on_who_and_what_is_there(cell: Cell) -> Iterator[Limit]:
    for name, operator in cell.operators.items():
        for key in KEEP_AWAY:
            if getattr(operator, key):
                yield Limit(in_words(key, name=name), ("operators", name, key))
        for pair in operator.holds:
            words = in_words("holds", name=name, first=pair[0], last=pair[1])
            yield Limit(words, ("operators", name, "holds", *pair))
    for name, times in cell.walking.items():
        if times:
            yield Limit(in_words("walk", name=name), ("walk", name))
    for name, task in cell.tasks.items():
        if task.release > 0:
            words = in_words("release", task=name, limit=exact_number(task.release))
            yield Limit(words, ("tasks", name, "release"))
        for place, wait in enumerate(task.wait):
            if wait.at_most is not None:
                words = in_words(
                    f"at_most.{wait.between}",
                    task=name,
                    limit=exact_number(wait.at_most),
                    other=wait.after,
                )
                yield Limit(words, ("tasks", name, "wait", str(place), "at_most"))
            if wait.at_least:
                words = in_words(
                    f"at_least.{wait.between}",
                    task=name,
                    limit=exact_number(wait.at_least),
                    other=wait.after,
                )
                yield Limit(words, ("tasks", name, "wait", str(place), "at_least"))


def _with_longer_wait(task: Task, place: int, key: str) -> Task:
    """The task without one end of one of its waits."""
    free = task.wait[place].model_copy(update={key: Wait.model_fields[key].default})
    return task.model_copy(update={"wait": (*task.wait[:place], free, *task.wait[place + 1 :])})


def _on_room(cell: Cell) -> Iterator[Limit]:
    tasks = cell.tasks.values()
    zones = {task.zone for task in tasks if task.zone is not None}
    tools = {tool for task in tasks for _, tool in task.tools_named()}
    for kind, used in (("zones", zones), ("tools", tools)):
        for name in sorted(used):
            shared = getattr(cell, kind).get(name)
            words = in_words(kind, name=name, capacity=shared.capacity if shared else 1)
            yield Limit(words, (kind, name))
    for name in sorted(x for x in zones if x in cell.zones):
        if apart := cell.zones[name].apart:
            words = in_words("apart", name=name, kinds=_and(_kinds(apart)))
            yield Limit(words, ("zones", name, "apart"))


def _without_key(operator: Operator, key: str, *pair: str) -> Operator:
    if key == "limits":
        kept = {name: most for name, most in operator.limits.items() if name not in pair}
        return operator.model_copy(update={key: Table(kept)})
    if pair:
        rest = tuple(other for other in operator.holds if other != pair)
        return operator.model_copy(update={key: rest})
    return operator.model_copy(update={key: Operator.model_fields[key].default})


def lift(cell: Cell, question: Question, lifted: Sequence[Limit]) -> tuple[Cell, Question]:
    """The cell and the question without these limits."""
    operators, tasks = dict(cell.operators), dict(cell.tasks)
    changes: dict[str, Any] = {}
    same = list(cell.same_operator)
    tools, zones, walk = dict(cell.tools), dict(cell.zones), dict(cell.walk)
    for limit in lifted:
        room, *names = limit.where
        if room == "question":
            question = replace(question, **{names[0]: None})  # type: ignore[arg-type]
        elif room == "operators":
            operators[names[0]] = _without_key(operators[names[0]], *names[1:])
        elif room == "tasks" and names[1] == "wait":
            tasks[names[0]] = _with_longer_wait(tasks[names[0]], int(names[2]), names[3])
        elif room == "tasks":
            tasks[names[0]] = tasks[names[0]].model_copy(
                update={names[1]: 0.0 if names[1] == "release" else None}
            )
        elif room == "same_operator":
            same.remove((names[0], names[1]))
        elif room == "walk":
            del walk[names[0]]
        elif room == "zones":
            zone = zones.get(names[0], Zone())
            lighter = {"apart": ()} if names[1:] else {"capacity": max(len(operators), 1)}
            zones[names[0]] = zone.model_copy(update=lighter)
        elif room == "tools":
            tools[names[0]] = Tool(capacity=max(len(operators), 1))
        else:
            changes[room] = None
    return (
        cell.replace(
            operators=operators,
            tasks=tasks,
            same_operator=tuple(same),
            tools=tools,
            zones=zones,
            walk=walk,
            **changes,
        ),
        question,
    )


def _least_stress_limits(
    cell: Cell, question: Question, group: Sequence[Limit], until: float
) -> Iterator[LeastLimit]:
    """Of people's limits of stress in the group: the least that all of them can keep alike, and the
    least of each beside those of the others.
    """
    people = [limit.where[1] for limit in group if limit.where[-1] == "stress_limit"]
    for some in [*([people] if len(people) > 1 else []), *([name] for name in people)]:
        left = min(EACH_S, until - monotonic())
        least = least_limit(cell, question, some, seconds=left) if left > 0 else None
        if least is not None:
            beside = "" if len(some) > 1 else _beside(cell, people, some[0])
            yield LeastLimit(tuple(some), least, beside)


def _beside(cell: Cell, people: Sequence[str], name: str) -> str:
    others = [
        in_words("at", name=other, limit=exact_number(cell.operators[other].stress_limit or 0.0))
        for other in people
        if other != name
    ]
    return in_words("beside", others=_and(others)) if others else ""


def _possible(cell: Cell, question: Question, lifted: Sequence[Limit], until: float) -> bool | None:
    """Whether there is a schedule without these limits; None when time was too short to tell. The
    first one that is found is enough.
    """
    try:
        variant, asked = lift(cell, question, lifted)
        first_schedule(variant, asked, min(EACH_S, max(until - monotonic(), 0.2)))
    except InfeasibleError:
        return False
    except (NothingFoundError, CellError):
        return None
    return True


def _gain(cell: Cell, question: Question, limit: Limit) -> Gain:
    """What is gained by lifting this one limit, found by planning without it."""
    try:
        variant, asked = lift(cell, question, [limit])
        result = exact.solve(variant, replace(asked, minimize="makespan"), time_limit=EACH_S)[0]
    except (InfeasibleError, NothingFoundError, CellError):
        return Gain(limit, None, None)
    return Gain(limit, result.makespan, result.stress)
