"""The JSON Schemas of what goes into a shift and what comes out of it, made from the tables that
the code itself goes by.
"""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from tandem.dispatch.shift.documents import SCHEMA_VERSION
from tandem.dispatch.situation.events import (
    KINDS,
    LONGEST_ID,
    LONGEST_SHIFT,
    NAMES,
    EventKind,
)

SHIPPED = {
    "events": files("tandem.dispatch.shift") / "events.schema.json",
    "decisions": files("tandem.dispatch.shift") / "decisions.schema.json",
}
"""The same schemas as files of the package; a test keeps both equal."""

HEAD = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
NAME = {
    "type": ["string", "integer"],
    "description": "A name; a whole number is taken as its digits.",
}
MOMENT: dict[str, Any] = {
    "anyOf": [
        {"type": "number", "minimum": 0, "maximum": LONGEST_SHIFT},
        {"type": "string", "format": "date-time"},
    ],
    "description": "Seconds since the start of the shift, or a time with its zone as ISO 8601.",
}
TASK_NAMES: dict[str, Any] = {"type": "array", "items": {"type": "string"}}
TEXT_OR_NULL: dict[str, Any] = {"type": ["string", "null"]}


def event_schema() -> dict[str, Any]:
    """Of one event, a line from the floor. Whether it fits the cell and the shift only the shift
    can tell.
    """
    return {
        **HEAD,
        "$id": f"urn:tandem:event:{SCHEMA_VERSION}",
        "title": "Tandem event",
        "description": "What the floor reports, one line each.",
        "oneOf": [_event(name, kind) for name, kind in KINDS.items()],
    }


def decision_schema() -> dict[str, Any]:
    """Of one line that comes out of a shift."""
    start = _table({"task": {"type": "string"}, "operators": TASK_NAMES})
    order = _table(
        {
            "task": {"type": "string"},
            "operators": TASK_NAMES,
            "order": _whole("Number of the decision that gave the order first."),
        }
    )
    alternative = _table({"starts": _list(start), "expected_cost": {"type": ["number", "null"]}})
    decision = _table(
        {
            "type": {"const": "decision"},
            "number": _whole("Of the line that led to it; 0 for the opening."),
            "at": _seconds("When."),
            "product": _product(),
            "queued": _whole("Products that were ordered and have not begun."),
            "starts": _list(
                order,
                "What robots are to begin now, alone or with others, if they have not. Replaces all"
                " orders of before.",
            ),
            "announced": {
                "type": "object",
                "additionalProperties": {"type": "string"},
                "description": "Human to the task they are asked for.",
            },
            "asks": _list(
                start, "What humans are asked to begin now, with all who are to take part."
            ),
            "take_apart": {
                **TASK_NAMES,
                "description": (
                    "Of the tasks named above those that are to be taken apart, being mounted"
                    " wrongly."
                ),
            },
            "revoked": _list(
                order, "Orders of before that do not hold any more and that no start has followed."
            ),
            "alternatives": _list(
                alternative, "Choices that were open, best first, this one included."
            ),
            "expected_cost": {
                "type": ["number", "null"],
                "description": (
                    "Of the whole assembly by this choice; null when it was not reckoned."
                ),
            },
            "bound": {
                "type": ["number", "null"],
                "description": "Seconds that the rest takes at least, from `at` on.",
            },
            "why": {"type": "string", "description": "For the people beside the robot."},
            "by": {"type": "string", "description": "Who decided."},
            "instead": {
                "enum": ["", "late", "failed"],
                "description": "Why a rule decided and not the policy: it was late, or failed.",
            },
            "look_again": {
                "type": ["number", "null"],
                "description": "When to send a `tick` should nothing else happen before, seconds.",
            },
            "over": {
                "type": "boolean",
                "description": "The product is done, and no other one is to begin after it.",
            },
            "forecast": {
                "anyOf": [
                    _table(
                        {
                            "p50": _seconds("Not exceeded in half of all cases."),
                            "p90": _seconds("Not exceeded in 90 % of all cases."),
                            "plan": _seconds("By the stated times."),
                        }
                    ),
                    {"type": "null"},
                ],
                "description": "When this product will be done; null when none is under way.",
            },
            "latency_ms": {"type": "number", "minimum": 0, "description": "What deciding took."},
            "fault": {"type": "string", "description": "How the policy failed."},
            "stuck": {
                "type": "array",
                "items": {"type": "string"},
                "description": "Why nothing can go on, and time alone will not change it.",
            },
            "open": {
                **_table(
                    {
                        "tasks": TASK_NAMES,
                        "products": _list(_table({"order": TEXT_OR_NULL, "variant": TEXT_OR_NULL})),
                    }
                ),
                "description": "When the shift has ended: what is not done, what has not begun.",
            },
        },
        optional=("fault", "stuck", "open"),
    )
    answer = _table(
        {
            "type": {"const": "answer"},
            "number": _whole("Of the line in the journal."),
            "event": {"enum": list(KINDS)},
            "id": {
                "type": "string",
                "description": "The event's own, should it have one that could be read.",
            },
            "accepted": {"type": "boolean"},
            "reasons": {
                "type": "array",
                "items": {"type": "string"},
                "description": "Why it was not; it has changed nothing.",
            },
            "remarks": {
                "type": "array",
                "items": {"type": "string"},
                "description": "What is odd about an event that was taken.",
            },
            "duplicate_of": _whole(
                "The number under which the same event was taken before; nothing has changed."
            ),
        },
        optional=("event", "id", "reasons", "remarks", "duplicate_of"),
    )
    return {
        **HEAD,
        "$id": f"urn:tandem:decision:{SCHEMA_VERSION}",
        "title": "Tandem dispatch output",
        "description": (
            "What a shift tells the floor, one line each: `shift` first, then `answer` and"
            " `decision` by turns, `summary` at the end."
        ),
        "oneOf": [_hello(), answer, decision, _summary()],
    }


def schema_text(name: str) -> str:
    """The schema "events" or "decisions" as the shipped file holds it."""
    made = event_schema() if name == "events" else decision_schema()
    return json.dumps(made, indent=1, ensure_ascii=False) + "\n"


def _event(name: str, kind: EventKind) -> dict[str, Any]:
    keys: dict[str, Any] = {
        "event": {"const": name},
        "at": MOMENT,
        "id": {
            "type": ["string", "integer"],
            "maxLength": LONGEST_ID,
            "description": "The same id again is known for a repetition and changes nothing.",
        },
    }
    if kind.task != "no":
        keys["task"] = NAME
    if kind.operators != "no":
        keys["operator"] = NAME
    if kind.operators in ("may", "some"):
        keys["operators"] = {"type": "array", "items": NAME, "minItems": 1, "uniqueItems": True}
    if kind.until != "no":
        keys["until"] = MOMENT
    keys |= {key: {**NAME, "description": f"Names {NAMES[key]}."} for key in kind.names}
    required = [
        "event",
        "at",
        *(["task"] if kind.task == "must" else []),
        *(["operator"] if kind.operators == "one" else []),
        *(key for key, presence in kind.names.items() if presence == "must"),
    ]
    one_of = (
        {"oneOf": [{"required": ["operator"]}, {"required": ["operators"]}]}
        if kind.operators == "some"
        else {}
    )
    either = (
        {"anyOf": [{"required": ["task"]}, {"required": ["operator"]}, {"required": ["operators"]}]}
        if name == "failed"
        else {"oneOf": [{"required": ["part"]}, {"required": ["task"]}]}
        if "part" in kind.names
        else {}
    )
    return {
        "description": kind.what,
        "type": "object",
        "properties": keys,
        "required": required,
        "additionalProperties": False,
        **one_of,
        **either,
    }


def _hello() -> dict[str, Any]:
    people = {
        "type": "object",
        "additionalProperties": TASK_NAMES,
        "description": "Task to who is at it.",
    }
    return _table(
        {
            "type": {"const": "shift"},
            "schema_version": {"const": SCHEMA_VERSION},
            "cell": {"type": "string"},
            "digest": {"type": "string", "description": "Of the cell."},
            "policy": {"type": "string"},
            "budget_ms": {"type": "number"},
            "seed": {"type": "integer"},
            "weights": _list({"type": "number"}, "What a second and a unit of stress weigh."),
            "plan": {
                "type": ["string", "null"],
                "description": "Digest of the plan that is carried out or followed.",
            },
            "start": {
                "type": ["string", "null"],
                "description": "The moment that is 0 s, ISO 8601; null while none was told.",
            },
            "resumed": {"type": "boolean", "description": "The journal held the shift already."},
            "number": _whole("Of the last line in the journal."),
            "at": _seconds("How far the shift has come."),
            "variants": {**TASK_NAMES, "description": "Cells besides the shift's own, by name."},
            "product": _product(),
            "products": _whole("How many are done."),
            "queued": _whole("Products that were ordered and have not begun."),
            "persons": {
                "type": "object",
                "additionalProperties": {"type": "string"},
                "description": "Human to the person who stands at that place.",
            },
            "lacking": {
                **TASK_NAMES,
                "description": "Broken tools, missing parts, tasks that lack something.",
            },
            "done": TASK_NAMES,
            "running": people,
            "wrong": TASK_NAMES,
            "absent": TASK_NAMES,
            "failed": TASK_NAMES,
        }
    )


def _product() -> dict[str, Any]:
    product = _table(
        {
            "number": _whole("Counting from 1."),
            "order": TEXT_OR_NULL,
            "variant": TEXT_OR_NULL,
            "began": _seconds("When it began."),
        }
    )
    return {
        "anyOf": [product, {"type": "null"}],
        "description": "The product under way, or the last one; null before the first.",
    }


def _summary() -> dict[str, Any]:
    counts = {
        name: {"type": "integer", "minimum": 0}
        for name in ("products", "lines", "events", "refused", "decisions", "late", "failed")
    }
    spent = _table({name: {"type": "number"} for name in ("p50", "p99", "max")})
    numbers = {name: {"type": "number"} for name in ("at", "makespan", "stress")}
    return _table(
        {
            "type": {"const": "summary"},
            "over": {"type": "boolean"},
            **numbers,
            **counts,
            "latency_ms": spent,
        }
    )


def _table(keys: dict[str, Any], optional: tuple[str, ...] = ()) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": keys,
        "required": [key for key in keys if key not in optional],
        "additionalProperties": False,
    }


def _list(items: dict[str, Any], what: str = "") -> dict[str, Any]:
    return {"type": "array", "items": items, **({"description": what} if what else {})}


def _whole(what: str) -> dict[str, Any]:
    return {"type": "integer", "minimum": 0, "description": what}


def _seconds(what: str) -> dict[str, Any]:
    return {
        "type": "number",
        "minimum": 0,
        "description": f"{what} Seconds since the start of the shift.",
    }
