"""Variants of a product: the cell plus their changes to tasks, so that mending a time of the cell
mends it in every variant.

Changes are a merge patch (RFC 7396): what is named replaces what stands there, `null` takes it out.
A task that is taken out is bridged: what came after it comes after what it came after.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tandem.errors import Fault


def merged(document: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The cell as plain values with these changes to its tasks, and no variants any more."""
    changed = {key: value for key, value in document.items() if key != "variants"}
    tasks = dict(document["tasks"])
    for name, change in changes.items():
        if change is not None:
            tasks[name] = _patched(tasks.get(name, {}), change)
    for name in [name for name, change in changes.items() if change is None]:
        tasks = _without(tasks, name)
    changed["tasks"] = tasks
    pairs = document.get("same_operator", ())
    if kept := [pair for pair in pairs if all(name in tasks for name in pair)]:
        changed["same_operator"] = kept
    else:
        changed.pop("same_operator", None)
    return changed


def left_out_in_vain(document: Mapping[str, Any], name: str) -> list[Fault]:
    """Faults of a variant that takes out tasks which the cell does not have."""
    tasks = document["tasks"]
    return [
        Fault(
            f"variant {name!r} takes out task {task!r}, which is no task of the cell. Leave the"
            " line out, or spell the name as the cell does.",
            ("variants", name, "tasks", task),
        )
        for task, change in document["variants"][name].get("tasks", {}).items()
        if change is None and task not in tasks
    ]


def at_variant(name: str, fault: Fault) -> Fault:
    """A fault of a variant's cell, placed where the variant stands."""
    return Fault(f"variant {name!r}: {fault.message}", ("variants", name, *fault.path), fault.place)


def _patched(value: Any, change: Any) -> Any:
    if not isinstance(change, Mapping):
        return change
    patched = dict(value) if isinstance(value, Mapping) else {}
    for key, item in change.items():
        if item is None:
            patched.pop(key, None)
        else:
            patched[key] = _patched(patched.get(key), item)
    return patched


def _without(tasks: Mapping[str, Any], left_out: str) -> dict[str, Any]:
    bridged = tasks.get(left_out, {}).get("after", [])
    kept = {}
    for name, task in tasks.items():
        after = task.get("after", []) if isinstance(task, Mapping) else []
        if name == left_out:
            continue
        if left_out in after:
            firsts = [
                other for first in after for other in (bridged if first == left_out else [first])
            ]
            task = {**task, "after": list(dict.fromkeys(firsts))}
        kept[name] = task
    return kept
