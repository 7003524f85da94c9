"""The OpenAPI document, made of the table of routes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import tandem
from tandem.studio.asked import Kind
from tandem.studio.guard import READING
from tandem.studio.jobs import JOBS, OPTIONS, PLACE
from tandem.studio.route import Route
from tandem.studio.schemas import NAMED

Json = dict[str, Any]

MEANINGS = {
    200: "Done.",
    400: "The request is not of its form.",
    403: "Foreign host or origin, no token, or a file outside of the folder.",
    404: "There is no such file.",
    409: "The file on the disk is newer.",
    413: "The body is too large.",
    422: "The cell or the schedule is not sound, or nothing answers the question.",
    503: "Too many searches go on; try again later.",
}
INSIDE = {"options": (OPTIONS, ()), "place": (PLACE, tuple(PLACE))}
"""Keys whose objects have keys of their own, and those they need."""


def document(routes: Iterable[Route]) -> Json:
    """OpenAPI 3.1 of every route."""
    paths: dict[str, Json] = {}
    for route in routes:
        paths.setdefault(route.path, {})[route.method.lower()] = _operation(route)
    return {
        "openapi": "3.1.0",
        "info": {"title": "Tandem studio", "version": tandem.__version__},
        "paths": paths,
        "components": {
            "schemas": NAMED,
            "securitySchemes": {
                "token": {"type": "apiKey", "in": "header", "name": "X-Tandem-Token"}
            },
        },
    }


def _operation(route: Route) -> Json:
    told: Json = {
        "summary": route.what,
        "responses": {
            str(status): {
                "description": MEANINGS[status],
                "content": (
                    {answer: {}}
                    if isinstance(answer, str)
                    else {"application/json": {"schema": answer}}
                ),
            }
            for status, answer in sorted(route.answers.items())
        },
    }
    if route.query:
        told["parameters"] = [
            {"name": name, "in": "query", "description": what, "schema": schema}
            for name, (schema, what) in route.query.items()
        ]
    if route.asks is not None:
        told["requestBody"] = {"content": _content(route)}
    if route.method not in READING:
        told["security"] = [{"token": []}]
    return told


def _content(route: Route) -> Json:
    if isinstance(route.asks, str) and route.asks not in JOBS:
        return {route.asks: {}}
    if isinstance(route.asks, str):
        keys, needed = JOBS[route.asks].all_keys, JOBS[route.asks].needed
    else:
        assert route.asks is not None
        keys, needed = dict(route.asks[0]), route.asks[1]
    return {"application/json": {"schema": _schema(keys, needed)}}


def _schema(keys: dict[str, Kind], needed: tuple[str, ...]) -> Json:
    properties = {
        name: _schema(*INSIDE[name]) if name in INSIDE else kind.schema
        for name, kind in keys.items()
    }
    return {
        "type": "object",
        "properties": properties,
        "required": list(needed),
        "additionalProperties": False,
    }
