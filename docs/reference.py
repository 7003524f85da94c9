"""Writes the parts of the documentation that the code itself knows: keys of a cell file, formats,
methods, commands.

A page asks for one with a line of its own such as `<!-- cell reference -->`.
"""

from __future__ import annotations

import inspect
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tandem.cell.model import Cell
from tandem.cell.parts import Assessment, Operator, Task, Together, Tool, Wait, Zone
from tandem.files.schema import schema
from tandem.lab.published import PUBLISHED, published

if TYPE_CHECKING:
    from sphinx.application import Sphinx

PLAIN = {
    "string": "text",
    "number": "number",
    "integer": "whole number",
    "boolean": "true or false",
}


def fill_in(app: Sphinx, page: str, source: list[str]) -> None:
    """Sphinx calls this for each page it has read."""
    for name, write in REFERENCES.items():
        if (mark := f"<!-- {name} reference -->") in source[0]:
            source[0] = source[0].replace(mark, write())


# ---------------------------------------------------------------- the cell file


def cell_reference() -> str:
    """One table for the cell and one for each thing in it, as Markdown, from the model's JSON
    Schema.
    """
    document = schema()
    parts = {"Cell": document, **document["$defs"]}
    titles = {
        "Cell": "The file",
        "Operator": "An operator",
        "Task": "A task",
        "Together": "A group in `together`",
        "Wait": "A wait",
        "Assessment": "An assessment in `ergonomics`",
        "Tool": "A tool",
        "Zone": "A zone",
        "Cost": "What a piece costs",
        "Variant": "A variant",
    }
    missing = [
        name for name, part in parts.items() if name not in titles and part.get("properties")
    ]
    if missing:
        raise LookupError(f"docs/reference.py has no title for {missing}.")
    return "\n\n".join(_table(titles[name], parts[name]) for name in titles)


def _table(title: str, part: Mapping[str, Any]) -> str:
    needed = set(part.get("required", ()))
    rows = ["| key | what it holds | when left out | meaning |", "|---|---|---|---|"]
    for key, field in part["properties"].items():
        absent = "**needed**" if key in needed else _absent(field)
        rows.append(
            f"| `{key}` | {_kind(field)} | {absent} | {_cell(field.get('description', ''))} |"
        )
    return "\n".join([f"### {title}", "", *rows])


def _absent(field: Mapping[str, Any]) -> str:
    value = field.get("default")
    return "" if value in (None, [], {}, "") else f"`{json.dumps(value).removesuffix('.0')}`"


def _kind(field: Mapping[str, Any]) -> str:
    """What a value may be, in words."""
    if "$ref" in field:
        return f"*{field['$ref'].rpartition('/')[2].lower()}*"
    if "const" in field:
        return f"`{field['const']}`"
    if "enum" in field:
        return " or ".join(f"`{value}`" for value in field["enum"])
    if options := field.get("anyOf", field.get("oneOf")):
        return " or ".join(
            dict.fromkeys(_kind(option) for option in options if option.get("type") != "null")
        )
    if field.get("type") == ["string", "number"]:  # a name; a number is taken as its digits
        return "text"
    if field.get("type") == "object":
        held = field["additionalProperties"]
        return "{key: value}" if held is True else f"{{name: {_kind(held)}}}"
    if field.get("type") == "array":
        if "prefixItems" in field:
            return f"[{', '.join(_kind(item) for item in field['prefixItems'])}]"
        return f"[{_kind(field['items'])}, …]"
    return PLAIN[field["type"]] + _range(field)


def _range(field: Mapping[str, Any]) -> str:
    low = field.get("minimum", field.get("exclusiveMinimum"))
    if low is None:
        return ""
    return f" ≥ {low:g}" if "minimum" in field else f" > {low:g}"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def keys() -> Iterator[str]:
    """Every key that a cell file may hold."""
    for model in (Cell, Operator, Task, Together, Wait, Assessment, Tool, Zone):
        yield from model.model_fields


# ---------------------------------------------------------------- tables of things


def format_reference() -> str:
    """Every format that can be read, as a Markdown table."""
    from tandem.files.formats.table import FORMATS

    return "\n".join(
        [
            "| name | what |",
            "|---|---|",
            *(f"| `{name}` | {_cell(one.what)} |" for name, one in FORMATS.items()),
        ]
    )


def method_reference() -> str:
    """Every planning method, as a Markdown table."""
    from tandem.plan.methods import METHODS, describe

    return "\n".join(
        [
            "| name | what it does |",
            "|---|---|",
            *(f"| `{name}` | {_cell(describe(name))} |" for name in METHODS),
        ]
    )


# ---------------------------------------------------------------- the commands


def command_reference() -> str:
    """One section a command, as Markdown, from the command tree."""
    return "\n\n".join(_section(path, command) for path, command in commands())


def commands() -> Iterator[tuple[str, click.Command]]:
    """`tandem` and every command below it, with the words that call it."""
    from tandem.cli import tandem

    yield from _walk("tandem", tandem)


def _walk(path: str, command: click.Command) -> Iterator[tuple[str, click.Command]]:
    yield path, command
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            below = command.get_command(context, name)
            if below and not below.hidden:
                yield from _walk(f"{path} {name}", below)


def _section(path: str, command: click.Command) -> str:
    context = click.Context(command, info_name=path)
    usage = " ".join([path, *command.collect_usage_pieces(context)])
    lines = [f"## {path}", "", "```text", usage, "```", "", _prose(command.help or "")]
    rows = [
        _option(context, option)
        for option in command.params
        if isinstance(option, click.Option) and not option.hidden
    ]
    if rows:
        lines += ["", "| option | meaning |", "|---|---|", *rows]
    return "\n".join(lines)


def _option(context: click.Context, option: click.Option) -> str:
    names, help_text = option.get_help_record(context) or (
        ", ".join(option.opts),
        option.help or "",
    )
    return f"| `{_cell(names)}` | {_cell(help_text).replace('<', '&lt;')} |"


def _prose(help_text: str) -> str:
    """A help text as paragraphs; what it marks with \\b keeps its lines."""
    paragraphs = []
    for paragraph in inspect.cleandoc(help_text).split("\n\n"):
        if paragraph.startswith("\b"):
            paragraphs.append(
                "```text\n" + inspect.cleandoc(paragraph.removeprefix("\b")) + "\n```"
            )
        else:
            paragraphs.append(paragraph.strip())
    return "\n\n".join(paragraphs)


def published_reference() -> str:
    """What is published of each system beside what our version did, feature by feature; the latter
    from `benchmarks/results/features.json`.
    """
    stored = json.loads(FEATURES.read_text("utf-8"))
    rows = ["| feature | system | published | rebuilt here |", "|---|---|---|---|"]
    systems = stored["features"]
    for feature in next(iter(systems.values())):
        for place, system in enumerate(PUBLISHED):
            entry = systems.get(system, {}).get(feature, {"value": "see the page"})
            claim = published(system, feature)
            source = f" ({claim.source})" if claim.source else ""
            named = f"**{feature}**" if place == 0 else ""
            rows.append(
                f"| {named} | `{system}` | {_cell(claim.value + source)}"
                f" | {_cell(entry['value'])} |"
            )
    made = f"Right column: `{stored['command']}`, tandem {stored['tandem']}."
    return "\n".join([*rows, "", made])


FEATURES = Path(__file__).resolve().parents[1] / "benchmarks" / "results" / "features.json"

REFERENCES = {
    "published": published_reference,
    "cell": cell_reference,
    "format": format_reference,
    "method": method_reference,
    "command": command_reference,
}
