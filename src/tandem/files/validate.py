"""Plain values in, a sound cell out; or every fault at once, each at its place."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from pydantic import ValidationError

from tandem.cell.model import Cell
from tandem.cell.names import clean
from tandem.cell.variants import at_variant, left_out_in_vain, merged
from tandem.errors import CellError, Fault
from tandem.files.messages import Flaw, flaws
from tandem.files.positions import Path, Place
from tandem.files.repair import repaired

MOST = 50
"""Faults told of one by one; nobody reads more before mending some."""
MOST_FLAWS = 2_000
"""Values that are not well formed which are put into words; of a file that holds more, the rest is
only counted.
"""


def cell_of(
    data: Any, place: Callable[[Path], Place] | None = None, faults: Iterable[Fault] = ()
) -> Cell:
    """The cell that plain values describe.

    Args:
      data: mappings, lists and scalars, keyed as in a cell file.
      place: where the value at a path stands; its `text` goes into the message, line and column
        sort the faults.
      faults: what was already found wrong, placed; it is reported together with the rest.

    Raises:
      CellError: with every fault, of form and of fit, in the order of their places; at most `MOST`
        and how many more there are.
    """
    found = [(_written_place(fault), fault) for fault in faults]
    uncounted = 0
    try:
        cell = Cell.model_validate(_named(data))
    except CellError as error:
        own = [fault for fault in error.faults if fault.path[:1] != ("variants",)]
        # of variants the form is told here too, where there are words for it
        found += _placed(own or _faults_of_variants(data) or error.faults, place)
    except ValidationError as error:
        known = flaws(error, MOST_FLAWS)
        uncounted = max(0, error.error_count() - MOST_FLAWS)
        found += _placed(
            [flaw.fault for flaw in known] + ([] if uncounted else _misfits(data, known)), place
        )
    else:
        if not found:
            return cell
    found.sort(key=lambda entry: entry[0])
    raise CellError(_cut(list(dict.fromkeys(fault for _, fault in found)), uncounted))


def _misfits(data: Any, known: list[Flaw]) -> list[Fault]:
    """What does not fit together although, or because, other values are not well formed."""
    # mending one flaw can lay open another, in a group that was unreadable for example
    for _ in range(3):
        mended = repaired(data, known) if isinstance(data, Mapping) else None
        if mended is None:
            return []
        try:
            Cell.model_validate(mended.data)
        except CellError as error:
            return [
                Fault(fault.message, mended.original(fault.path))
                for fault in error.faults
                if not (
                    mended.roomless
                    and fault.path[:1] == ("tasks",)
                    and fault.path[2:] in (("zone",), ("tool",))
                )
            ]
        except ValidationError as error:
            known = known + [
                Flaw(flaw.kind, mended.original(flaw.path), flaw.fault, flaw.meant)
                for flaw in flaws(error)
            ]
        else:
            return []
    return []


def _faults_of_variants(data: Any) -> list[Fault]:
    """What is wrong with the variants of a cell that is sound itself, in the words of a cell."""
    found: list[Fault] = []
    named = _named(data)
    for name, variant in named["variants"].items():
        found += left_out_in_vain(named, str(name))
        try:
            cell_of(merged(named, variant.get("tasks", {})))
        except CellError as error:
            found += [at_variant(str(name), fault) for fault in error.faults]
    return found


def _placed(
    faults: Iterable[Fault], place: Callable[[Path], Place] | None
) -> list[tuple[tuple[int, int], Fault]]:
    """Each fault with line and column to sort by; without places they keep their order."""
    if place is None:
        return [((0, 0), fault) for fault in faults]
    places = ((place(fault.path), fault) for fault in faults)
    return [((where.line, where.column), fault.at(where.text)) for where, fault in places]


def _written_place(fault: Fault) -> tuple[int, int]:
    """Line and column of a fault that already has a place such as `cell.yaml:7:3`."""
    line, column = ["0", *fault.place.rsplit(":", 2)][-2:]
    return (int(line), int(column)) if line.isdigit() and column.isdigit() else (0, 0)


def _cut(faults: list[Fault], uncounted: int) -> list[Fault]:
    if len(faults) + uncounted <= MOST + 1:
        return faults
    return [*faults[:MOST], Fault(f"and {len(faults) - MOST + uncounted} more. Mend these first.")]


def _named(data: Any) -> Any:
    """Keys become names, so that `{1: ...}` in Python means what it means in a file. Two that would
    become one are left for the model to refuse.
    """
    if isinstance(data, Mapping):
        names = {key: clean(str(key)) if type(key) in (int, str) else key for key in data}
        kept = names if len(set(names.values())) == len(names) else {key: key for key in data}
        return {kept[key]: _named(item) for key, item in data.items()}
    return [_named(item) for item in data] if type(data) in (list, tuple) else data
