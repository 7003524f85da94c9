"""How a shift moves on: what an event or a decision makes of a situation. Pure functions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Protocol

from tandem.dispatch.situation.events import Event
from tandem.dispatch.situation.legal import may_begin, seconds
from tandem.dispatch.situation.model import (
    Order,
    Outcome,
    Product,
    Running,
    Situation,
    Stock,
    Work,
    exact,
)
from tandem.dispatch.situation.pace import learnt


def after(situation: Situation, event: Event) -> Situation:
    """The situation once the event has happened. Assumes that there are no `objections`.

    Where it ends a product, or orders one while none is under way, the next one has begun.
    """
    return _next_begun(_happened(situation, event))


def _happened(situation: Situation, event: Event) -> Situation:
    now = replace(situation, now=exact(event.at - situation.began))
    match event.kind:
        case "started":
            return _started(now, task_of(event), event.operators)
        case "done":
            return _ended(now, task_of(event), "done")
        case "failed":
            if event.task is not None:
                return _ended(now, event.task, "broken off")
            return _rested(replace(now, failed=now.failed.union(event.operators)))
        case "repaired":
            return _there_again(
                replace(now, failed=now.failed.difference(event.operators)), event.operators
            )
        case "absent":
            return _rested(replace(now, absent=now.absent.union(event.operators)))
        case "back":
            return _there_again(
                replace(now, absent=now.absent.difference(event.operators)), event.operators
            )
        case "refused":
            [who] = event.operators
            until = None if event.until is None else exact(event.until - now.began)
            return replace(now, refused={**now.refused, (who, task_of(event)): until})
        case "wrong":
            return _wrong(now, task_of(event))
        case "undone":
            return _undone(now, task_of(event))
    return _of_the_shift(now, event)


def _of_the_shift(now: Situation, event: Event) -> Situation:
    """What an event does that tells of the shift, and of no work."""
    match event.kind:
        case "product":
            return _queued(now, event.order, event.variant)
        case "end":
            return replace(now, ended=True)
        case "broken" | "missing":
            return replace(now, stock={**dict.fromkeys(stock_of(event), event.at), **now.stock})
        case "mended" | "there":
            back = stock_of(event)
            kept = {name: since for name, since in now.stock.items() if name not in back}
            return replace(now, stock=kept)
        case "person":
            return _taken_over(now, event.operators[0], event.person or event.operators[0])
    return now


def begun(situation: Situation) -> Situation:
    """The next of the queued products has begun, at this moment; what belongs to the one before is
    put away, and what its work told of people's paces is kept.

    Time before a product's beginning takes up no tool for it, and nobody walks to it then: where to
    was not known.
    """
    product, *queued = situation.queued
    cell, facts = situation.cells.get(product.variant, (situation.cell, situation.facts))
    paces = {situation.person(human): learnt(situation, human) for human in situation.cell.humans}
    return replace(
        situation,
        cell=cell,
        known=facts,
        product=product,
        queued=tuple(queued),
        began=situation.clock,
        now=0.0,
        done={},
        running={},
        past=(),
        orders={},
        announced={},
        wrong={},
        since={},
        joined={},
        refused={
            pair: None if until is None else exact(until - situation.now)
            for pair, until in situation.refused.items()
            if until is None or until > situation.now
        },
        learnt={**situation.learnt, **{who: known for who, known in paces.items() if known.seen}},
    )


def stock_of(event: Event) -> list[tuple[Stock, str]]:
    """The tool, part or task that an event of what is broken or missing names."""
    named: list[tuple[Stock, str | None]] = [
        ("tool", event.tool),
        ("part", event.part),
        ("task", event.task),
    ]
    return [(kind, name) for kind, name in named if name is not None]


def _next_begun(situation: Situation) -> Situation:
    if situation.is_over and situation.queued and not situation.ended:
        return begun(situation)
    return situation


def _queued(situation: Situation, order: str | None, variant: str | None) -> Situation:
    before = [product.number for product in (situation.product, *situation.queued) if product]
    product = Product(max(before, default=0) + 1, order, variant)
    return replace(situation, queued=(*situation.queued, product))


def _taken_over(situation: Situation, human: str, person: str) -> Situation:
    """Somebody else stands at the human's place. What the former one's work told is kept under
    their name; what is under way tells of neither.
    """
    known = learnt(situation, human)
    kept = {situation.person(human): known} if known.seen else {}
    return replace(
        situation,
        learnt={**situation.learnt, **kept},
        persons={**situation.persons, human: person},
        joined={**situation.joined, human: situation.now},
    )


class Choice(Protocol):
    """The part of a decision that becomes part of the situation."""

    @property
    def starts(self) -> tuple[tuple[str, tuple[str, ...]], ...]: ...
    @property
    def announced(self) -> Mapping[str, str]: ...


def ordered(situation: Situation, choice: Choice, number: int) -> Situation:
    """The situation once the decision of this number has been told: robots and machines have their
    orders, and humans know what they are asked for.

    What robots or machines take part in is an order; what only humans take part in is announced. An
    order that was there before keeps its number.
    """
    orders, announced = {}, dict(choice.announced)
    for task, operators in choice.starts:
        before = situation.orders.get(task)
        if any(situation.cell.operators[who].kind != "human" for who in operators):
            orders[task] = (
                before
                if before is not None and before.operators == operators
                else Order(operators, number)
            )
        announced |= {
            who: task for who in operators if situation.cell.operators[who].kind == "human"
        }
    return replace(situation, orders=orders, announced=announced)


def beginning(
    situation: Situation, starts: Iterable[tuple[str, tuple[str, ...]]]
) -> list[tuple[str, tuple[str, ...]]]:
    """Of these (task, operators), in their order, what may begin together now: each when those kept
    before it have begun.
    """
    kept = []
    for task, operators in starts:
        if may_begin(situation, task, operators):
            situation = _started(situation, task, operators)
            kept.append((task, operators))
    return kept


def revoked(before: Situation, now: Situation) -> dict[str, Order]:
    """Orders that do not hold any more and that no start has followed."""
    return {
        task: order
        for task, order in before.orders.items()
        if now.orders.get(task) != order
        and (task not in now.running or now.running[task].operators != order.operators)
    }


def _started(situation: Situation, task: str, operators: tuple[str, ...]) -> Situation:
    now, place = situation.now, situation.cell.tasks[task].place
    at = Running(
        operators,
        now,
        exact(now + seconds(situation, task, operators)),
        undoing=task in situation.wrong,
    )
    return replace(
        situation,
        running={**situation.running, task: at},
        orders={name: order for name, order in situation.orders.items() if name != task},
        announced={
            human: asked for human, asked in situation.announced.items() if human not in operators
        },
        refused={
            pair: until
            for pair, until in situation.refused.items()
            if pair[1] != task or pair[0] not in operators
        },
        in_hand={**situation.in_hand, **situation.cell.tools_for(task, operators)},
        stands=situation.stands
        if place is None
        else {**situation.stands, **dict.fromkeys(operators, place)},
    )


def _ended(situation: Situation, task: str, outcome: Outcome, *, wrong: bool = False) -> Situation:
    """The task's work ends now. What was done while something beneath it is not in place has been
    mounted wrongly.
    """
    at = situation.running[task]
    rested = exact(
        at.rested + (situation.now - at.rests_since if at.rests_since is not None else 0.0)
    )
    work = Work(task, at.operators, at.start, situation.now, at.stated, rested, outcome)
    running = {name: other for name, other in situation.running.items() if name != task}
    since = {**situation.since, **dict.fromkeys(at.operators, situation.now)}
    situation = replace(situation, running=running, past=(*situation.past, work), since=since)
    if outcome == "taken apart":
        return replace(
            situation,
            wrong={name: other for name, other in situation.wrong.items() if name != task},
        )
    if outcome == "broken off":
        return situation
    before = situation.cell.tasks[task].predecessors
    if wrong or any(first not in situation.done for first in before):
        return replace(situation, wrong={**situation.wrong, task: work})
    return replace(situation, done={**situation.done, task: work})


def _wrong(situation: Situation, task: str) -> Situation:
    if task in situation.running:
        return _ended(situation, task, "done", wrong=True)
    off = situation.facts.above[task] | {task}
    done = {name: work for name, work in situation.done.items() if name not in off}
    wrong = {
        **situation.wrong,
        **{name: work for name, work in situation.done.items() if name in off},
    }
    return replace(situation, done=done, wrong=wrong)


def _undone(situation: Situation, task: str) -> Situation:
    if task in situation.running:
        return _ended(situation, task, "taken apart")
    done = {name: work for name, work in situation.done.items() if name != task}
    wrong = {name: work for name, work in situation.wrong.items() if name != task}
    return replace(situation, done=done, wrong=wrong)


def _rested(situation: Situation) -> Situation:
    """Work rests while one of those at it is away or down, and goes on when all are there."""
    gone, now = situation.absent | situation.failed, situation.now
    running = {}
    for task, at in situation.running.items():
        if gone.intersection(at.operators) and at.rests_since is None:
            at = replace(at, rests_since=now)
        elif not gone.intersection(at.operators) and at.rests_since is not None:
            rest = now - at.rests_since
            at = replace(
                at,
                rests_since=None,
                rested=exact(at.rested + rest),
                expected_end=exact(at.expected_end + rest),
            )
        running[task] = at
    return replace(situation, running=running)


def _there_again(situation: Situation, operators: tuple[str, ...]) -> Situation:
    return _rested(
        replace(situation, since={**situation.since, **dict.fromkeys(operators, situation.now)})
    )


def task_of(event: Event) -> str:
    """The task that an event of a kind with a task names."""
    assert event.task is not None, f"{event.kind} names no task"
    return event.task
