"""What pydantic found wrong, in the words of a cell: what, where, which value, how to mend."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from tandem.cell.model import Cell
from tandem.cell.names import Known, clean, harm_in
from tandem.cell.parts import (
    KINDS,
    Assessment,
    Cost,
    Operator,
    Task,
    Together,
    Tool,
    Variant,
    Wait,
    Zone,
)
from tandem.cell.written import number
from tandem.errors import Fault

Path = tuple[str | int, ...]

LARGEST_SHOWN, LONGEST_SHOWN = 10**16, 60
"""Numbers above the one are too long to be read; of a text a message shows so many characters at
most.
"""
MEANT = {
    "predecessors": "after", "depends_on": "after", "needs": "after", "requires": "after",
    "before": "after", "lag": "wait", "lags": "wait", "waits": "wait", "min": "at_least",
    "max": "at_most", "least": "at_least", "most": "at_most", "task": "after",
    "duration": "time", "durations": "time", "seconds": "time", "joint": "together", "type": "kind",
    "strain": "stress", "assessment": "ergonomics", "assessments": "ergonomics", "due": "deadline",
    "machines": "operators", "agents": "operators",
}  # fmt: skip
"""Words of neighbouring fields for our keys, where spelling alone would not lead there."""


@dataclass(frozen=True)
class Flaw:
    """One value that is not well formed.

    Attributes:
      kind: pydantic's name for what is wrong, or "key" or "comma".
      path: keys from the top of the document to the value.
      meant: for an unknown key, the known one that was probably meant.
    """

    kind: str
    path: Path
    fault: Fault
    meant: str | None = None


def flaws(error: ValidationError, most: int | None = None) -> list[Flaw]:
    """Everything that pydantic found, or so much of it, one entry for each place."""
    found: dict[Path, Flaw] = {}
    for item in error.errors(include_url=False)[:most]:
        path = _path(item["loc"])
        kind = "key" if item["loc"][-1:] == ("[key]",) else item["type"]
        if kind == "too_short" and path in (("operators",), ("tasks",)) and item["input"]:
            continue  # it only became empty because none of its names is one
        if (
            kind in ("extra_forbidden", "float_type")
            and item["input"] is None
            and isinstance(path[-1], str)
            and path[-1].isdigit()
        ):
            kind = "comma"  # `{human: 1,5}` is read as a time of 1 and an empty key 5
        meant = _meant(path) if kind == "extra_forbidden" else None
        sentence = _SENTENCES.get(kind, _other)(path, item)
        found.setdefault(
            path,
            Flaw(
                kind,
                path,
                Fault(f"{_subject(path)}: {sentence}" if _subject(path) else sentence, path),
                meant,
            ),
        )
    return list(found.values())


def _path(loc: Path) -> Path:
    """Keys of the document alone: without pydantic's signs for a key and for which form of
    `stress`, `spread` or `tool` it tried.
    """
    path: list[str | int] = []
    skip = False
    for place, step in enumerate(loc):
        if skip or (step == "[key]" and place == len(loc) - 1):
            skip = False
            continue
        path.append(step)
        skip = _has_two_forms(tuple(path))
    return tuple(path)


def _has_two_forms(path: Path) -> bool:
    match path:
        case ("tasks", _, "stress" | "spread" | "tool"):
            return True
        case ("tasks", _, "together", _, "stress" | "tool"):
            return True
    return False


def _model(path: Path) -> tuple[type[Any], str]:
    """The part of a cell that a path leads into, and what a person calls it."""
    match path:
        case ("operators", name, _, *_):
            return Operator, f"operator {shown(name)}"
        case ("tasks", name, "together", int(), _, *_):
            return Together, f"task {shown(name)}: together"
        case ("tasks", name, "wait", int(), _, *_):
            return Wait, f"task {shown(name)}: wait"
        case ("tasks", name, "ergonomics", int(), _, *_):
            return Assessment, f"task {shown(name)}: ergonomics"
        case ("tasks", name, _, *_):
            return Task, f"task {shown(name)}"
        case ("tools", name, _, *_):
            return Tool, f"tool {shown(name)}"
        case ("zones", name, _, *_):
            return Zone, f"zone {shown(name)}"
        case ("cost", _, *_):
            return Cost, "cost"
        case ("variants", name, _, *_):
            return Variant, f"variant {shown(name)}"
        case ("walk", who, _):
            return Cell, f"walk of {shown(who)}"
    return Cell, ""


def _subject(path: Path) -> str:
    return _model(path)[1]


def _what(path: Path) -> str:
    """What a value is called: "time of 'robot'", "after", "the 2nd break"."""
    match path:
        case (
            *_,
            "time" | "stress" | "difficulty" | "spread" | "changeover" | "tool" as key,
            str(who),
        ) if len(path) > 3:
            return f"{key} of {shown(who)}"
        case ("stress_of_set" | "walk" as table, name):
            return f"{table} of {shown(name)}"
        case ("operators" | "tasks" | "tools" | "zones" | "places" as table, name):
            return f"{table[:-1]} {shown(name)}"
        case ("tasks", _, "wait", int(place)):
            return f"wait {place + 1}"
        case ("tasks", _, "ergonomics", int(place)):
            return f"assessment {place + 1}"
        case ("places", name, int(side)):
            return f"the {'xy'[min(side, 1)]} of place {shown(name)}"
        case (*_, "breaks", int(place)):
            return f"break {place + 1}"
        case (*_, "breaks", int(place), int(side)):
            return f"the {('beginning', 'end')[min(side, 1)]} of break {place + 1}"
    words = [str(step) for step in path if not isinstance(step, int)]
    return words[-1] if words else "the file"


def _meant(path: Path) -> str | None:
    key = str(path[-1])
    keys = _model(path)[0].model_fields
    return MEANT[key] if MEANT.get(key) in keys else Known(keys).nearest(key)


def shown(value: object) -> str:
    """A value as a message shows it: as a file has it, short, and telling text from numbers."""
    match value:
        case None:
            return "empty"
        case bool():
            return str(value).lower()
        case int() | float() if abs(value) < LARGEST_SHOWN or (
            isinstance(value, float) and not math.isfinite(value)
        ):
            return number(value) if isinstance(value, float) else str(value)
        case int() | float():
            return "a number of more than 16 digits"
        case str():
            return repr(
                value if len(value) <= LONGEST_SHOWN else f"{value[: LONGEST_SHOWN - 3]}..."
            )
        case Mapping():
            return "a mapping"
        case list() | tuple():
            return "a list"
    return f"neither text nor a number ({type(value).__name__})"


def _short(text: str) -> str:
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 3]}..."


def _unknown_key(path: Path, _: Any) -> str:
    key, keys = str(path[-1]), _model(path)[0].model_fields
    meant = _meant(path)
    return f"{shown(key)} is no key that is known here. " + (
        f"Did you mean {meant!r}?" if meant else f"Known: {', '.join(keys)}."
    )


def _comma(path: Path, _: Any) -> str:
    remedy = "If it is the rest of a number with a decimal comma, write the number with a point."
    return f"{shown(path[-1])} stands here like a key without a value. {remedy}"


def _missing(path: Path, item: Any) -> str:
    match path:
        case ("operators" | "tasks",):
            example = (
                "{robot: {kind: robot}, human: {kind: human}}"
                if path[0] == "operators"
                else "{1: {time: {robot: 9, human: 10}}}"
            )
            return f"`{path[0]}` is missing. Write `{path[0]}: {example}`, for example."
        case ("operators", _, "kind"):
            return "`kind` is missing. Write `kind: human`, `kind: robot` or `kind: machine`."
        case ("operators", _, "breaks", _, _):
            return "a break needs two numbers, `[from, to]` in seconds."
        case ("tasks", _, "wait", _, "after"):
            return (
                "`after` is missing: which task is waited for? Write it, as in `{after: 1,"
                " at_least: 40}`."
            )
        case ("tasks", _, "ergonomics", _, "method"):
            return "`method` is missing. Write it, as in `{method: reba, trunk: 45}`."
        case ("places", name, _):
            return f"place {shown(name)} needs two numbers, `[x, y]` in metres."
        case ("operators", _, "holds", _, _):
            return "`holds` holds pairs of tasks, such as `[[1, 2]]`; here the second is missing."
        case ("same_operator", _, _):
            return (
                "same_operator holds pairs of tasks, such as `[[1, 2]]`; here the second is"
                " missing."
            )
    return f"`{path[-1]}` is missing. Write it, as in `{{operators: [robot, human], time: 12}}`."


def _too_small(path: Path, item: Any) -> str:
    value = f"{_what(path)} is {shown(item['input'])}"
    match path:
        case ("tasks", _, "time", who):
            return (
                f"{value}, but a time is more than 0 s. Leave {shown(who)} out of `time` if they"
                " cannot do it."
            )
        case ("tasks", _, "together", _, "time"):
            return f"{value}, but a time is more than 0 s. Leave the group out if it cannot do it."
        case ("tasks", _, "deadline"):
            return f"{value}, but a deadline is later than 0 s. Leave it out if there is none."
    limit = item["ctx"].get("gt", item["ctx"].get("ge"))
    wanted = f"more than {shown(limit)}" if "gt" in item["ctx"] else f"{shown(limit)} or more"
    return f"{value}, but must be {wanted}."


def _too_large(path: Path, item: Any) -> str:
    return (
        f"{_what(path)} is {shown(item['input'])}, but at most {shown(item['ctx']['le'])} can be"
        " planned."
    )


def _too_large_to_count(path: Path, item: Any) -> str:
    return (
        f"{_what(path)} is {shown(item['input'])}, more than can be counted. Write a smaller"
        " number."
    )


def _not_finite(path: Path, item: Any) -> str:
    return (
        f"{_what(path)} is {item['input']}, but must be a number. Write the number, or leave it out"
        " if there is none."
    )


def _no_number(path: Path, item: Any) -> str:
    value, whole = item["input"], item["type"].startswith("int")
    needed = f"a {'whole ' if whole else ''}number is needed"
    if value is None:
        return f"{_what(path)} is empty, but {needed}. Write it, or leave the key out."
    if isinstance(value, str):
        unquoted = value.strip().replace(",", ".", 1).replace("_", "")
        if _is_number(unquoted):
            remedy = f"Write {_short(unquoted)}{'' if unquoted != value else ' without quotes'}."
            return f"{_what(path)} is {shown(value)}, which is text, but {needed}. {remedy}"
    return (
        f"{_what(path)} is {shown(value)}, but {needed}. Write it in digits, such as"
        f" {3 if whole else 2.5}."
    )


def _is_number(text: str) -> bool:
    try:
        return float(text) < float("inf")
    except ValueError:
        return False


def _no_choice(path: Path, item: Any) -> str:
    value = item["input"]
    if path == ("format",):
        return (
            f"format is {shown(value)}, but this version of Tandem reads format 1. A newer version"
            " may read it."
        )
    allowed = ("end-start", "start-start") if path[-1] == "between" else KINDS
    near = Known(allowed).nearest(value) if isinstance(value, str) else None
    words = f"{', '.join(allowed[:-1])} or {allowed[-1]}"
    return f"{_what(path)} is {shown(value)}, but must be {words}." + (
        f" Did you mean {near!r}?" if near else ""
    )


def _no_mapping(path: Path, item: Any) -> str:
    examples = {
        "operators": "{robot: {kind: robot}}", "tasks": "{1: {time: {robot: 9}}}",
        "time": "{robot: 9, human: 10}",
        "tools": "{driver: {capacity: 1}}",
        "zones": "{press: {capacity: 1}}", "stress_of_set": '{"": 0, "1": 2.5}',
        "difficulty": "{human: 2}", "changeover": "{human: 3}",
        "wait": "{after: 1, at_least: 40}",
        "places": "{bench: [0, 0]}", "walk": "{human: {bench-press: 3}}",
        "ergonomics": "{method: reba, trunk: 45}",
    }  # fmt: skip
    if not path:
        held = "nothing" if item["input"] is None else _of(item["input"])
        return (
            f"the file holds {held}. A cell file is a mapping with the keys `operators` and"
            " `tasks`."
        )
    key = str(path[-1])
    if len(path) == 2:
        example = {
            "operators": "{kind: human}",
            "tasks": "{time: {human: 10}}",
            "walk": "{bench-press: 3}",
        }.get(str(path[0]), "{capacity: 1}")
    else:
        key = str(path[-2]) if path[-2:-1] in (("wait",), ("ergonomics",)) else key
        example = examples.get(key, "{operators: [robot, human], time: 12}")
    return f"{_what(path)} is {_of(item['input'])}, but a mapping is needed, such as `{example}`."


def _no_list(path: Path, item: Any) -> str:
    examples = {
        "after": "[1, 2]",
        "breaks": "[[60, 90]]",
        "operators": "[robot, human]",
        "same_operator": "[[1, 2]]",
        "apart": "[human, robot]",
        "holds": "[[1, 2]]",
        "together": "[{operators: [a, b], time: 12}]",
        "wait": "[{after: 1, at_least: 40}]",
        "ergonomics": "[{method: reba, trunk: 45}]",
    }
    key = next((str(step) for step in reversed(path) if isinstance(step, str)), "")
    value = item["input"]
    if path[0] == "places":
        return f"{_what(path)} is {_of(value)}, but two numbers are needed, `[x, y]` in metres."
    remedy = f"`{key}: {examples.get(key, '[]')}`"
    if key == "after" and isinstance(value, str | int) and not isinstance(value, bool):
        remedy = f"`after: [{_short(str(value))}]`"
    return f"{_what(path)} is {_of(value)}, but a list is needed, such as {remedy}" + (
        ", or leave the key out." if value is None else "."
    )


def _of(value: object) -> str:
    return f"the text {shown(value)}" if isinstance(value, str) else shown(value)


def _no_text(path: Path, item: Any) -> str:
    return f"{_what(path)} is {_of(item['input'])}, but a name is needed."


def _no_fact(path: Path, item: Any) -> str:
    return (
        f"{_what(path)} is {shown(item['input'])}, but a fact is a number, a word, true or false."
        " Write one, such as `trunk: 45`, or `trunk: {value: 45, source: video}`."
    )


def _too_few(path: Path, item: Any) -> str:
    match path:
        case ("operators",) | ("tasks",):
            return f"`{path[0]}` is empty. A cell needs one at least."
        case ("tasks", _, "together", _, "operators"):
            return (
                "a group in `together` needs two operators at least. What one operator does alone"
                " belongs in `time`."
            )
    return f"{_what(path)} is empty, but a name is needed."


def _too_many(path: Path, item: Any) -> str:
    most = item["ctx"]["max_length"]
    if path[-1] == "breaks":
        return (
            f"{_what(path)} holds {item['ctx'].get('actual_length') or 'more'}, at most {most:,}"
            " can be planned. Keep those of one shift."
        )
    if isinstance(item["input"], str):
        return (
            f"{_what(path)} has {len(item['input'])} characters, at most {most} are kept."
            " Shorten it."
        )
    return (
        f"{_what(path)} holds {item['ctx'].get('actual_length') or 'more'} values, but {most} are"
        " needed."
    )


def _harmful(path: Path, item: Any) -> str:
    return (
        f"{_what(path)} is {shown(item['input'])} and holds {item['ctx']['harm']}, which no name"
        " may have. Take it out."
    )


def _twins(path: Path, item: Any) -> str:
    found = item["ctx"]
    return (
        f"{_what(path)} states {found['name']!r} twice, as {found['first']} and as"
        f" {found['again']}. Keep one of them, or rename one."
    )


def _bad_key(path: Path, item: Any) -> str:
    key = item["input"]
    # from Python alone: keys of files are text
    if item["type"] == "invalid_key" or not isinstance(key, str):
        return f"the key {str(path[-1]).lower()} is no name. Write it as text."
    if (harm := harm_in(clean(key))) is not None:
        return f"the name {shown(key)} holds {harm}, which no name may have. Take it out."
    if len(key) > 60:
        return (
            f"the name {key[:57]!r}... has {len(key)} characters, at most 200 are kept. Shorten it."
        )
    return f"{key!r} is no name. A name has at least one visible sign."


def _other(path: Path, item: Any) -> str:
    """A kind that has no sentence yet: pydantic's own, and its name so that one can be written."""
    return f"{_what(path)} is {shown(item['input'])}, which cannot stand here ({item['msg']})."


_SENTENCES: dict[str, Callable[[Path, Any], str]] = {
    "key": _bad_key,
    "invalid_key": _bad_key,
    "comma": _comma,
    "extra_forbidden": _unknown_key,
    "missing": _missing,
    "greater_than": _too_small,
    "greater_than_equal": _too_small,
    "less_than_equal": _too_large,
    "finite_number": _not_finite,
    "float_type": _no_number,
    "float_parsing": _no_number,
    "int_type": _no_number,
    "int_parsing": _no_number,
    "int_parsing_size": _too_large_to_count,
    "int_from_float": _no_number,
    "literal_error": _no_choice,
    "dict_type": _no_mapping,
    "mapping_type": _no_mapping,
    "model_type": _no_mapping,
    "model_attributes_type": _no_mapping,
    "tuple_type": _no_list,
    "list_type": _no_list,
    "string_type": _no_text,
    "string_pattern_mismatch": _no_text,
    "too_short": _too_few,
    "string_too_short": _too_few,
    "too_long": _too_many,
    "string_too_long": _too_many,
    "fact_type": _no_fact,
    "harmful_sign": _harmful,
    "twins": _twins,
}
