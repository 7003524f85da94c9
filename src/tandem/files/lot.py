"""Several products in one cell, begun together: whoever is idle may begin the next one while the
others finish the last.

A lot is a cell like any other, so that all that plans, judges, prints and decides live takes it: no
rule of a cell is stated a second time here. Each product keeps its tasks, named after it
(`A-17/4`), and its precedence; operators, tools, zones and places are those of the station, once.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from tandem.cell.measures import adds_up
from tandem.cell.model import Cell
from tandem.cell.names import clean
from tandem.cell.parts import Fields, Operator, Tool, Zone
from tandem.errors import CellError, Fault, NotReadWarning
from tandem.files.validate import cell_of

BETWEEN = "/"
"""Stands between the product's name and the task's."""

OF_THE_PRODUCT = ("holds", "stress_limit", "limits")
"""What an operator has for a product's tasks, and a lot's operator for the tasks of all."""

OF_THE_STATION = ("places", "walk", "cost", "cycles_per_shift")
"""Tables that all products of a lot must state alike."""


def lot(products: Mapping[str, Cell]) -> Cell:
    """One cell that makes all these products, begun together.

    Operators, and the tools, zones, places, walks and costs that they name, must be the same. The
    limits of a human add up, but for those of one task, which must be the same. Releases, deadlines
    and breaks count from the beginning of the lot. Variants are left out, with a
    `NotReadWarning`.

    Args:
      products: name -> its cell, in the order in which they stand in the lot.

    Raises:
      CellError: they are not of one station, a name cannot be one, or stress does not add up over
        them (`stress_of_set`); with every fault.
    """
    if faults := [*_of_names(products), *_of_station(products), *_of_stress(products)]:
        raise CellError(faults)
    for name, cell in products.items():
        if cell.variants:
            warnings.warn(
                f"product {name!r}: its variants ({', '.join(cell.variants)}) are left out; the lot"
                " makes the cell as it stands.",
                NotReadWarning,
                stacklevel=2,
            )
    documents = {name: cell.to_dict() for name, cell in products.items()}
    first = next(iter(documents.values()))
    tables = {
        "operators": _operators(products, documents),
        "tasks": {
            _joined(name, task): _task(name, told)
            for name, document in documents.items()
            for task, told in document["tasks"].items()
        },
        "tools": {key: told for one in documents.values() for key, told in _table(one, "tools")},
        "zones": {key: told for one in documents.values() for key, told in _table(one, "zones")},
        "same_operator": [
            [_joined(name, task) for task in pair]
            for name, document in documents.items()
            for pair in document.get("same_operator", ())
        ],
        **{key: first.get(key) for key in OF_THE_STATION},
    }
    return cell_of(
        {
            "format": first["format"],
            "name": _title(products),
            **{key: table for key, table in tables.items() if table},
        }
    )


def _joined(product: str, task: str) -> str:
    return f"{product}{BETWEEN}{task}"


def _table(document: Mapping[str, Any], key: str) -> Iterator[tuple[str, Any]]:
    yield from document.get(key, {}).items()


def _title(products: Mapping[str, Cell]) -> str:
    """What is made, each kind once with how many of it: "2 x pump, lid"."""
    titles = [cell.name or name for name, cell in products.items()]
    counted = {title: titles.count(title) for title in titles}
    text = ", ".join(
        f"{count} x {title}" if count > 1 else title for title, count in counted.items()
    )
    return text if len(text) <= 500 else f"{len(products)} products"


def _operators(
    products: Mapping[str, Cell], documents: Mapping[str, Mapping[str, Any]]
) -> dict[str, Any]:
    made = {}
    first = next(iter(documents.values()))["operators"]
    for who, told in first.items():
        cells = products.items()
        holds = [
            [_joined(name, task) for task in pair]
            for name, cell in cells
            for pair in cell.operators[who].holds
        ]
        made[who] = {key: value for key, value in told.items() if key not in OF_THE_PRODUCT}
        made[who] |= {"holds": holds} if holds else {}
        made[who] |= _limits([cell.operators[who] for _, cell in cells])
    return made


def _limits(same: Sequence[Operator]) -> dict[str, Any]:
    """What a person may have of all products together: the same limits stand at each of them."""
    made: dict[str, Any] = {}
    # without the dust that adding floats leaves
    if same[0].stress_limit is not None:
        made["stress_limit"] = round(sum(one.stress_limit or 0.0 for one in same), 6)
    limits = {
        name: round(sum(one.limits[name] for one in same), 6) if adds_up(name) else most
        for name, most in same[0].limits.items()
    }
    return made | ({"limits": limits} if limits else {})


def _task(product: str, told: Mapping[str, Any]) -> dict[str, Any]:
    """The task in the lot: what it comes after is of its own product."""
    made = dict(told)
    if "label" in made:
        made["label"] = f"{product}: {made['label']}"
    if "after" in made:
        made["after"] = [_joined(product, task) for task in made["after"]]
    if "wait" in made:
        made["wait"] = [{**wait, "after": _joined(product, wait["after"])} for wait in made["wait"]]
    return made


def _of_names(products: Mapping[str, Cell]) -> Iterator[Fault]:
    if len(products) < 2:
        yield Fault(f"a lot needs two products at least; {len(products)} was given.")
    for name in products:
        if not name or name != clean(name) or BETWEEN in name:
            yield Fault(
                f"product {name!r}: the name stands before the names of its tasks. Give it one"
                f" without {BETWEEN} and without blanks at its ends."
            )


def _of_station(products: Mapping[str, Cell]) -> Iterator[Fault]:
    """Where the products are not of one station."""
    first = next(iter(products), "")
    for name, cell in list(products.items())[1:]:
        station = products[first]
        if list(cell.operators) != list(station.operators):
            yield Fault(
                f"its operators are {', '.join(cell.operators)}; those of product {first!r} are"
                f" {', '.join(station.operators)}. Give both the same, in the same order.",
                (name, "operators"),
            )
            continue
        for who, operator in cell.operators.items():
            for key in _that_differ(operator, station.operators[who]):
                yield _differs((name, "operators", who, key), first)
        for key in OF_THE_STATION:
            if getattr(cell, key) != getattr(station, key):
                yield _differs((name, key), first)
    kinds: tuple[tuple[str, Callable[[Fields], tuple[str, ...]], Tool | Zone], ...] = (
        ("tools", lambda cell: cell.tool_names, Tool()),
        ("zones", lambda cell: cell.zone_names, Zone()),
    )
    for key, named, unlisted in kinds:
        seen: dict[str, tuple[str, Tool | Zone]] = {}
        for product, cell in products.items():
            for one in named(cell):
                stated = getattr(cell, key).get(one, unlisted)
                before, as_before = seen.setdefault(one, (product, stated))
                if stated != as_before:
                    yield _differs((product, key, one), before)


def _that_differ(one: Operator, other: Operator) -> list[str]:
    """Keys of the station that two operators of a name do not state alike; whether a limit is
    stated is one, how high it is belongs to the product, but for a limit of one task.
    """
    keys = [key for key in Operator.model_fields if key not in OF_THE_PRODUCT]
    found = [key for key in keys if getattr(one, key) != getattr(other, key)]
    if (one.stress_limit is None) != (other.stress_limit is None):
        found.append("stress_limit")
    peaks = [{k: most for k, most in x.limits.items() if not adds_up(k)} for x in (one, other)]
    if one.limits.keys() != other.limits.keys() or peaks[0] != peaks[1]:
        found.append("limits")
    return found


def _differs(path: tuple[str, ...], first: str) -> Fault:
    return Fault(
        f"is not as product {first!r} states it. A lot is made at one station: write the same in"
        " both.",
        path,
    )


def _of_stress(products: Mapping[str, Cell]) -> Iterator[Fault]:
    for name, cell in products.items():
        if cell.stress_of_set is not None:
            yield Fault(
                "stress by table does not add up over products, so that nobody knows the stress of"
                " a lot. Leave this product out, or state `stress` at its tasks.",
                (name, "stress_of_set"),
            )
