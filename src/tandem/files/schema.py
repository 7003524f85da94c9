"""The JSON Schema of a cell file, made from the model: editors complete and check with it."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from tandem.cell.model import Cell

ID = "urn:tandem:cell:1"
SHIPPED = files("tandem.files") / "cell.schema.json"
"""The same schema as a file of the package, for editors; a test keeps both equal."""


def schema() -> dict[str, Any]:
    """The schema, draft 2020-12. It says what each value must look like; what values must be to
    each other, only loading can tell.
    """
    made = _tidy(Cell.model_json_schema())
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": ID,
        "title": "Tandem cell",
    }
    return {
        **head,
        "description": "One workstation: its operators and the tasks of one product.",
        **{k: v for k, v in made.items() if k not in ("title", "description")},
    }


def schema_text() -> str:
    """The schema as the shipped file holds it."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


def _tidy(value: Any) -> Any:
    """Without the titles that pydantic makes of field names, with descriptions in one line, and
    with the rule for names said once for all keys of a mapping.
    """
    if isinstance(value, list):
        return [_tidy(item) for item in value]
    if not isinstance(value, dict):
        return value
    tidy = {
        key: _tidy(item)
        for key, item in value.items()
        if not (key == "title" and isinstance(item, str))
    }
    if isinstance(said := tidy.get("description"), str):
        tidy["description"] = " ".join(said.split())
    patterns = tidy.pop("patternProperties", None)
    if isinstance(patterns, dict) and len(patterns) == 1:
        [(pattern, item)] = patterns.items()
        tidy["additionalProperties"] = item
        tidy["propertyNames"] = {"pattern": pattern, "maxLength": 200}
    return tidy
