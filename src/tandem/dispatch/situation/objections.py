"""Which events cannot have happened, as far as the shift is known. Pure functions.

An event that contradicts what is known is refused and changes nothing (`objections`). One that
breaks a rule of the cell but may well have happened, a person working in their break or before a
task's turn for instance, is taken as it is; `remarks` says what is odd.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from tandem.dispatch.situation.events import Event
from tandem.dispatch.situation.legal import hindrances, is_ready
from tandem.dispatch.situation.model import Situation, exact, mode
from tandem.dispatch.situation.transitions import stock_of, task_of


def objections(situation: Situation, event: Event) -> list[str]:
    """Why the event cannot have happened, as far as is known; empty when nothing contradicts it."""
    if event.at < situation.clock:
        return [
            f"it happened at {event.at:.10g} s, but the shift has come to {situation.clock:.10g} s;"
            " time does not run backwards."
        ]
    if situation.product is None and event.task is not None and event.kind in RULES_OF_WORK:
        return ["no product is under way; order one with `product`."]
    rule = RULES.get(event.kind)
    return list(rule(situation, event)) if rule else []


def remarks(situation: Situation, event: Event) -> list[str]:
    """What is odd about an event that is taken all the same. Assumes that there are no
    `objections`.
    """
    if event.kind != "started":
        return []
    task = task_of(event)
    early = (
        []
        if is_ready(situation, task)
        else [
            f"{_not_ready(situation, task)}. What is mounted before its turn will have to come off"
        ]
    )
    way = mode(situation.cell, task, event.operators)
    there = replace(situation, now=exact(event.at - situation.began))
    return [f"{odd}." for odd in (*early, *hindrances(there, task, way))]


def _against_started(situation: Situation, event: Event) -> Iterator[str]:
    task = task_of(event)
    if task in situation.running:
        at = situation.running[task]
        yield (
            f"task {task!r} is under way since {situation.on_clock(at.start):g} s, by"
            f" {_and(at.operators)}."
        )
    elif task in situation.done:
        yield (
            f"task {task!r} is done since {situation.on_clock(situation.done[task].end):g} s. If it"
            " is mounted wrongly, report it as wrong first."
        )
    elif not is_ready(situation, task) and (
        task in situation.wrong or not any(who in situation.cell.humans for who in event.operators)
    ):
        yield f"{_not_ready(situation, task)}."
    groups = [way.operators for way in situation.cell.modes(task)]
    if not any(set(group) == set(event.operators) for group in groups):
        yield (
            f"{_and(event.operators)} cannot do task {task!r}; {' or '.join(map(_and, groups))}"
            " can."
        )
    for who in event.operators:
        for other, busy in situation.running.items():
            if who in busy.operators and other != task:
                yield (
                    f"{who!r} is still at task {other!r}; report that as"
                    f" {'undone' if busy.undoing else 'done'} or failed first."
                )
        yield from _not_there(situation, who)


def _not_ready(situation: Situation, task: str) -> str:
    if task in situation.wrong:
        return (
            f"task {task!r} is mounted wrongly and cannot be taken apart before"
            f" {_and(map(repr, _above(situation, task)))}"
        )
    before = situation.cell.tasks[task].predecessors
    missing = [first for first in before if first not in situation.done]
    if not missing:
        return (
            f"task {task!r} goes below {_and(map(repr, _above(situation, task)))}, begun before its"
            " turn: that has to come off first"
        )
    return (
        f"task {task!r} comes after {_and(map(repr, missing))}, which"
        f" {'are' if len(missing) > 1 else 'is'} not done"
    )


def _against_done(situation: Situation, event: Event) -> Iterator[str]:
    task = task_of(event)
    at = situation.running.get(task)
    if at is None:
        ordered = " It was ordered only." if task in situation.orders else ""
        yield (
            f"task {task!r} is done already."
            if task in situation.done
            else f"task {task!r} has not been reported as started.{ordered}"
        )
    elif at.undoing:
        yield f"task {task!r} is being taken apart; report that as undone."
    else:
        if event.operators and set(event.operators) != set(at.operators):
            yield (
                f"task {task!r} is being done by {_and(at.operators)}, not by"
                f" {_and(event.operators)}."
            )
        for who in at.operators:
            yield from _not_there(situation, who)


def _against_refused(situation: Situation, event: Event) -> Iterator[str]:
    task, [who] = task_of(event), event.operators
    if task in situation.done:
        yield f"task {task!r} is done already."
    elif task in situation.running and who in situation.running[task].operators:
        yield f"{who!r} is at task {task!r}; report it as failed to give it up."
    if not any(who in way.operators for way in situation.cell.modes(task)):
        yield f"{who!r} cannot do task {task!r} anyway."


def _against_failed(situation: Situation, event: Event) -> Iterator[str]:
    if event.task is None:
        for who in event.operators:
            yield from _against_leaving(situation, who, False, situation.failed)
        return
    at = situation.running.get(event.task)
    if at is None:
        done = event.task in situation.done
        so = "is done; report it as wrong" if done else "is not under way"
        yield f"task {event.task!r} {so}."
    elif not set(event.operators) <= set(at.operators):
        yield (
            f"task {event.task!r} is being done by {_and(at.operators)}, not by"
            f" {_and(event.operators)}."
        )


def _against_absent(situation: Situation, event: Event) -> Iterator[str]:
    yield from _against_leaving(situation, event.operators[0], True, situation.absent)


def _against_leaving(
    situation: Situation, who: str, human: bool, gone: frozenset[str]
) -> Iterator[str]:
    kind = situation.cell.operators[who].kind
    if (kind == "human") != human:
        yield (
            f"{who!r} is a {kind}; report a {kind} as {'absent' if kind == 'human' else 'failed'}."
        )
    elif who in gone:
        yield f"{who!r} was reported as {'absent' if human else 'failed'} already."


def _against_coming(situation: Situation, event: Event) -> Iterator[str]:
    [who] = event.operators
    kind = situation.cell.operators[who].kind
    human = kind == "human"
    if human == (event.kind == "repaired"):
        yield f"{who!r} is a {kind}; report a {kind} as {'back' if human else 'repaired'}."
    elif who not in situation.failed | situation.absent:
        yield f"{who!r} was not reported as {'absent' if human else 'failed'}."


def _against_wrong(situation: Situation, event: Event) -> Iterator[str]:
    task = task_of(event)
    if task in situation.wrong:
        yield f"task {task!r} was reported as wrong already, or stands on one that was."
    elif task not in situation.running and task not in situation.done:
        yield f"task {task!r} is not done."


def _against_undone(situation: Situation, event: Event) -> Iterator[str]:
    task = task_of(event)
    if task in situation.running:
        if not situation.running[task].undoing:
            yield (
                f"task {task!r} is being done; report it as failed when nothing is mounted, else as"
                " wrong."
            )
    elif task not in situation.done and task not in situation.wrong:
        yield f"task {task!r} is not done."
    elif above := _above(situation, task):
        yield (
            f"{_and(map(repr, above))} {'stand' if len(above) > 1 else 'stands'} on task {task!r};"
            " report that as undone first."
        )


def _against_product(situation: Situation, event: Event) -> Iterator[str]:
    if situation.ended:
        yield (
            "the shift has ended; no further product begins. Open the next shift with a new"
            " journal."
        )


def _against_end(situation: Situation, event: Event) -> Iterator[str]:
    if situation.ended:
        yield "the end of the shift was reported already."


def _against_lacking(situation: Situation, event: Event) -> Iterator[str]:
    for kind, name in stock_of(event):
        if (kind, name) in situation.stock:
            since = situation.stock[kind, name]
            yield (f"{_stock(kind, name)} was reported as {event.kind} already, at {since:g} s.")


def _against_having(situation: Situation, event: Event) -> Iterator[str]:
    gone = "broken" if event.kind == "mended" else "missing"
    for kind, name in stock_of(event):
        if (kind, name) not in situation.stock:
            yield f"{_stock(kind, name)} was not reported as {gone}."


def _stock(kind: str, name: str) -> str:
    return f"what task {name!r} needs" if kind == "task" else f"{kind} {name!r}"


def _against_person(situation: Situation, event: Event) -> Iterator[str]:
    [who] = event.operators
    if situation.cell.operators[who].kind != "human":
        kind = situation.cell.operators[who].kind
        yield f"{who!r} is a {kind}; a person stands at a human's place."
        return
    for human in situation.cell.humans:
        if situation.person(human) == event.person:
            yield f"{event.person!r} stands at the place of {human!r} already."


RULES: dict[str, Callable[[Situation, Event], Iterator[str]]] = {
    "started": _against_started,
    "done": _against_done,
    "refused": _against_refused,
    "failed": _against_failed,
    "repaired": _against_coming,
    "wrong": _against_wrong,
    "undone": _against_undone,
    "absent": _against_absent,
    "back": _against_coming,
    "product": _against_product,
    "end": _against_end,
    "broken": _against_lacking,
    "missing": _against_lacking,
    "mended": _against_having,
    "there": _against_having,
    "person": _against_person,
}
"""Kind of event -> what speaks against it, in sentences. Only time speaks against a kind that is
not here.
"""

RULES_OF_WORK = ("started", "done", "refused", "failed", "wrong", "undone")
"""Kinds that tell of work at a task of the product under way."""


def _above(situation: Situation, task: str) -> list[str]:
    """What stands on the task, or is being put there."""
    places = (situation.done, situation.wrong, situation.running)
    return [
        name
        for name in situation.cell.tasks
        if name in situation.facts.above[task] and any(name in place for place in places)
    ]


def _not_there(situation: Situation, who: str) -> Iterator[str]:
    if who in situation.absent:
        yield f"{who!r} was reported as absent; report them as back first."
    if who in situation.failed:
        yield f"{who!r} was reported as failed; report it as repaired first."


def _and(names: Iterable[str]) -> str:
    *most, last = list(names) or ["nobody"]
    return f"{', '.join(most)} and {last}" if most else last
