"""With which keys a cell says more than somebody knows: the world of a paper, or a format that it
is to be written in.

Whoever asks lists the keys that they know; every other one is found, those too that a later version
of the cell file will bring.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from pydantic import BaseModel

from tandem.cell.model import Cell

Path = tuple[str, ...]

NAMES = frozenset({"format", "name", "label", "part", "kind", "ergonomics", "cycles_per_shift"})
"""Keys that call things by name, or tell what is known of the work and move no schedule; anyone can
stand them.
"""
TABLES = frozenset({"operators", "tasks", "tools", "zones"})
"""Keys of a cell under which the others stand; tools and zones say nothing until a task names
one. Who knows zones still knows none that keep kinds of operators apart.
"""


def beyond(
    cell: Cell, *, operator: Collection[str] = (), task: Collection[str] = ()
) -> Iterator[Path]:
    """Where the cell says something with a key that is not among these, in the cell's order.

    Args:
      operator, task: the keys of an operator and of a task that are known.
    """
    for name, one in cell.operators.items():
        yield from (("operators", name, key) for key in _stated(one, operator))
    for name, step in cell.tasks.items():
        yield from (("tasks", name, key) for key in _stated(step, task))
        if "tool" not in task and step.tool is None and any(step.tools_named()):
            yield ("tasks", name, "tool")
    for name, zone in cell.zones.items():
        if zone.apart and "zone" in task:
            yield ("zones", name, "apart")
    yield from ((key,) for key in _stated(cell, TABLES))


def _stated(part: BaseModel, known: Collection[str]) -> Iterator[str]:
    """Keys whose values are not those that they have when they are left out."""
    for key, field in type(part).model_fields.items():
        if key in NAMES or key in known:
            continue
        if getattr(part, key) != field.get_default(call_default_factory=True):
            yield key
