"""JSON Schemas of what the studio answers, and short ways to write them."""

from __future__ import annotations

from typing import Any

Json = dict[str, Any]

ANYTHING: Json = {}


def string(**more: Any) -> Json:
    """A text."""
    return {"type": "string", **more}


def or_null(schema: Json) -> Json:
    """The same, or null."""
    return {"anyOf": [schema, {"type": "null"}]}


def rows(schema: Json) -> Json:
    """A list of these."""
    return {"type": "array", "items": schema}


def table(**keys: Json) -> Json:
    """An object with exactly these keys; one that ends with `?` may be missing."""
    return {
        "type": "object",
        "properties": {name.rstrip("?"): schema for name, schema in keys.items()},
        "required": [name for name in keys if not name.endswith("?")],
        "additionalProperties": False,
    }


def refer(name: str) -> Json:
    """The schema of this name among those of the document."""
    return {"$ref": f"#/components/schemas/{name}"}


ASSIGNMENTS = refer("Assignments")
POINT = refer("Point")
PLAN = refer("Plan")
ERRORS = refer("Errors")

NUMBER: Json = {"type": "number"}
MEASURES = table(
    sound={"type": "boolean"},
    lanes=or_null(
        rows(
            table(
                operator=string(),
                busy=NUMBER,
                share=NUMBER,
                shaded=rows(
                    table(
                        kind=string(description="break, setup, walk, changeover or hold"),
                        what=string(),
                        start=NUMBER,
                        end=NUMBER,
                    )
                ),
                waits=rows(table(task=string(), start=NUMBER, end=NUMBER)),
            )
        )
    ),
    operators=or_null(
        rows(
            table(
                operator=string(),
                tasks={"type": "integer"},
                working=NUMBER,
                changing=NUMBER,
                resting=NUMBER,
                idle=NUMBER,
                share=NUMBER,
                stress=or_null(NUMBER),
                stress_limit=or_null(NUMBER),
            )
        )
    ),
    tasks=or_null(
        rows(
            table(
                task=string(),
                waits_for=rows(table(reason=string(), by=string(), task=or_null(string()))),
                slack=NUMBER,
                critical={"type": "boolean"},
                sentence=string(),
            )
        )
    ),
    path=or_null(rows(string())),
    changed=or_null(table(tasks=rows(table(task=string(), what=string())), sentence=string())),
)
"""How a schedule fares."""
COMPARED = table(
    changes=rows(table(path=rows(string()), before=ANYTHING, after=ANYTHING, sentence=string())),
    front_changes=rows(
        table(
            makespan=NUMBER,
            stress=NUMBER,
            makespan_then=or_null(NUMBER),
            stress_then=or_null(NUMBER),
            seconds=or_null(NUMBER),
            more_stress=or_null(NUMBER),
        )
    ),
)
"""What differs between two cells."""
NAMED: dict[str, Json] = {
    "Assignments": rows(table(task=string(), operators=rows(string()), start=NUMBER, end=NUMBER)),
    "Errors": rows(
        table(
            place=rows(string()),
            message=string(),
            value=ANYTHING,
            **{"where?": string(description="File, line and column; or sheet and field.")},
        )
    ),
    "Failure": {
        "type": "object",
        "description": "What is refused, and why.",
        "properties": {
            "error": string(),
            "exit": {"type": "integer", "description": "What the command line ends with."},
            "errors": ERRORS,
            "faults": rows(string()),
            "infeasible": {"type": "object"},
            "seen": {"type": "object", "description": "Of a workbook: sheets, columns, rows."},
        },
        "required": ["error"],
    },
    "Point": {
        "type": "object",
        "properties": {
            "makespan": NUMBER,
            "stress": NUMBER,
            "status": {"enum": ["optimal", "feasible"]},
            "bound": table(makespan=NUMBER, stress=NUMBER),
            "digest": string(),
            "assignments": ASSIGNMENTS,
        },
        "required": ["makespan", "stress", "status", "bound", "digest", "assignments"],
    },
    "Plan": {
        "type": "object",
        "description": "The result document of `tandem plan --json`.",
        "properties": {
            "schema_version": {"const": 1},
            "cell_digest": string(),
            "complete": {"type": "boolean"},
            "interrupted": {"type": "boolean"},
            "front": rows(POINT),
            "cell_document": {"type": "object"},
        },
        "required": ["schema_version", "complete", "interrupted", "front", "cell_document"],
    },
}
"""The schemas that others refer to."""


def fails(*statuses: int) -> dict[int, Json]:
    """The answers that say what is refused."""
    return {status: refer("Failure") for status in statuses}
