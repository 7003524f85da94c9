"""What the floor hears and the journal keeps: decisions as plain values, and back again."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Decision, Start
from tandem.dispatch.journal import Entry
from tandem.dispatch.shift.deadline import Answered
from tandem.dispatch.situation.events import NAMES, Event, EventError, read_event
from tandem.dispatch.situation.legal import hindrances, is_ready, legal, next_change
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.transitions import ordered, revoked

SCHEMA_VERSION = 2
"""Of events, answers and decisions."""

MOST_ALTERNATIVES = 20
"""So many are told with a decision."""

Document = dict[str, Any]


def document(
    situation: Situation, answered: Answered, number: int, forecast: Document | None = None
) -> Document:
    """A decision as the floor hears it and as the journal keeps it, times on the shift's clock.

    `forecast`: see `forecast.py`; None where nothing is under way.
    """
    decision = answered.decision
    now = ordered(situation, decision, number)
    looks = [
        situation.on_clock(time)
        for time in (decision.look_again, next_change(situation))
        if time is not None and time > situation.now
    ]
    made = {
        "type": "decision",
        "number": number,
        "at": situation.clock,
        "product": named(situation),
        "queued": len(situation.queued),
        "starts": [
            {"task": task, "operators": list(order.operators), "order": order.number}
            for task, order in now.orders.items()
        ],
        "announced": dict(now.announced),
        "asks": [
            {"task": task, "operators": list(who)} for task, who in _asked(situation, decision)
        ],
        "take_apart": [
            task for task in situation.wrong if task in now.orders or task in now.announced.values()
        ],
        "revoked": [
            {"task": task, "operators": list(order.operators), "order": order.number}
            for task, order in revoked(situation, now).items()
        ],
        "alternatives": [
            {
                "starts": [{"task": task, "operators": list(who)} for task, who in other.starts],
                "expected_cost": _number(other.expected_cost),
            }
            for other in decision.alternatives[:MOST_ALTERNATIVES]
        ],
        "expected_cost": _number(decision.expected_cost),
        "bound": _number(decision.bound),
        "why": decision.why,
        "by": decision.by,
        "instead": answered.instead,
        "look_again": min(looks, default=None),
        "over": is_over(situation),
        "forecast": forecast,
        "latency_ms": round(decision.latency_ms, 3),
    }
    return {
        **made,
        **({"fault": answered.fault} if answered.fault else {}),
        **({"stuck": held} if (held := stuck(situation)) else {}),
        **({"open": what_is_open(situation)} if situation.ended else {}),
    }


def named(situation: Situation) -> Document | None:
    """The product under way, or the last one; None before the first."""
    product = situation.product
    if product is None:
        return None
    return {
        "number": product.number,
        "order": product.order,
        "variant": product.variant,
        "began": situation.began,
    }


def is_over(situation: Situation) -> bool:
    """Nothing is left to do: the product is done, and none is to begin after it."""
    return situation.is_over and (situation.ended or not situation.queued)


def what_is_open(situation: Situation) -> Document:
    """What the end of the shift leaves: tasks of the product under way that are not done, and
    products that have not begun.
    """
    tasks = (
        [] if situation.is_over else [t for t in situation.cell.tasks if t not in situation.done]
    )
    return {
        "tasks": tasks,
        "products": [
            {"order": product.order, "variant": product.variant} for product in situation.queued
        ],
    }


def _asked(situation: Situation, decision: Decision) -> Iterable[Start]:
    """What humans are asked to begin now, also where a robot was told to begin it with them."""
    humans = set(situation.cell.humans)
    return dict.fromkeys(
        (*decision.asks, *(start for start in decision.starts if humans.intersection(start[1])))
    )


def over(situation: Situation) -> Answered:
    """What is decided where there is nothing to do: a product is done, or none has begun."""
    return Answered(Decision((), {}, (), 0.0, _why_over(situation), "shift"))


def _why_over(situation: Situation) -> str:
    left = what_is_open(situation)["products"] if situation.ended else []
    then = (
        (
            f"The shift has ended; {len(left)} product{'s' if len(left) > 1 else ''} that"
            f" {'were' if len(left) > 1 else 'was'} ordered {'have' if len(left) > 1 else 'has'}"
            " not begun."
            if left
            else "The shift has ended."
        )
        if situation.ended
        else "The next one begins with the event `product`."
    )
    if situation.product is None:
        return f"No product is under way. {then.replace('The next one', 'The first one')}"
    words = situation.product.words
    return (
        f"{words[0].upper()}{words[1:]} is done, after {situation.makespan:g} s; the humans have"
        f" collected {situation.stress:g} of stress. {then}"
    )


def summary(situation: Situation, entries: Iterable[Entry]) -> Document:
    """The last line of a shift, or of the part of it that was seen: how it went, and how quickly it
    was decided upon.
    """
    rows = list(entries)
    decisions = [
        entry.decision
        for entry in rows
        if entry.decision is not None and entry.decision["by"] != "shift"
    ]
    spent = sorted(decision["latency_ms"] for decision in decisions)
    return {
        "type": "summary",
        "over": is_over(situation),
        "at": situation.clock,
        "products": situation.products_done,
        "makespan": situation.makespan,
        "stress": situation.stress,
        "lines": len(rows) - 1,
        "events": sum(entry.event is not None for entry in rows),
        "refused": sum(entry.answer is not None and not entry.answer["accepted"] for entry in rows),
        "decisions": len(decisions),
        "late": sum(decision["instead"] == "late" for decision in decisions),
        "failed": sum(decision["instead"] == "failed" for decision in decisions),
        "latency_ms": {
            "p50": _quantile(spent, 0.5),
            "p99": _quantile(spent, 0.99),
            "max": max(spent, default=0.0),
        },
    }


def _quantile(ordered_numbers: list[float], share: float) -> float:
    """The smallest number that at least this share of them does not exceed; 0 when there are
    none.
    """
    return (
        ordered_numbers[max(0, math.ceil(share * len(ordered_numbers)) - 1)]
        if ordered_numbers
        else 0.0
    )


def stuck(situation: Situation) -> list[str]:
    """Why nothing goes on, where nobody is at anything, nothing may begin, and the clock alone will
    not change that; else an empty list.
    """
    if (
        situation.is_over
        or situation.running
        or legal(situation)
        or next_change(situation) is not None
    ):
        return []
    idle, reasons = set(situation.idle), dict[str, None]()
    for task in situation.open:
        if is_ready(situation, task):
            for way in situation.facts.ways[task]:
                away = [
                    f"{who!r} is {'down' if who in situation.failed else 'absent'}"
                    for who in way.operators
                    if who not in idle
                ]
                held = [*away, *hindrances(situation, task, way)]
                reasons[f"task {task!r} by {' and '.join(way.operators)}: {'; '.join(held)}."] = (
                    None
                )
    return list(reasons)


def digest(situation: Situation) -> str:
    """Sixteen hexadecimal digits that change when anything in the situation does."""
    return hashlib.sha256(json.dumps(situation.to_dict(), sort_keys=True).encode()).hexdigest()[:16]


@dataclass(frozen=True)
class Told:
    """What a document of a decision tells; see `after.Choice`."""

    starts: tuple[tuple[str, tuple[str, ...]], ...]
    announced: Mapping[str, str]


def told(decision: Mapping[str, Any]) -> Told:
    """The part of the document that becomes part of the situation."""
    return Told(
        tuple((row["task"], tuple(row["operators"])) for row in decision["starts"]),
        decision["announced"],
    )


def event_of(data: Mapping[str, Any]) -> Event:
    """The inverse of `Event.to_dict`."""
    operators = data.get("operators", [data["operator"]] if "operator" in data else [])
    return Event(
        data["event"],
        data["at"],
        data.get("task"),
        tuple(operators),
        data.get("until"),
        data.get("id"),
        **{key: data.get(key) for key in NAMES},
    )


def kept_event(
    data: Mapping[str, Any], cell: Cell, variants: Mapping[str, Cell] | None = None
) -> Event | None:
    """The event as a journal keeps it; None when it is none of this cell."""
    try:
        return read_event(json.dumps(data), cell, variants=variants)
    except EventError:
        return None


def is_of(choice: Told, cell: Cell) -> bool:
    """Whether every task, operator and human that is told of is one of the cell."""
    tasks = {*(task for task, _ in choice.starts), *choice.announced.values()}
    operators = {who for _, group in choice.starts for who in group}
    return (
        tasks <= set(cell.tasks)
        and operators <= set(cell.operators)
        and set(choice.announced) <= set(cell.humans)
    )


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)
