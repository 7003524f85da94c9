"""One wrong column is one message: faults that are alike are told once, with the rows that they
stand in; a few unlike values each at its cell.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from tandem.errors import Fault

FEWEST = 3
"""Faults of the same words that are told as one; fewer are told each at its place."""
MANY = 8
"""Faults alike but for the value that are told as one: so many are no slips of the pen, the column
is not what it was taken for.
"""
PLACE = re.compile(r"(?P<sheet>.+)!(?P<letter>[A-Z]+)(?P<row>\d+)", re.DOTALL)


def once_a_column(
    faults: Iterable[Fault], headers: Mapping[tuple[str, str], str]
) -> tuple[Fault, ...]:
    """The faults, those that are alike in one column as one: at the first of them, with all their
    rows.

    Args:
      headers: sheet and column letters -> what stands above the column.
    """
    groups: dict[tuple[str, ...], list[tuple[int, Fault]]] = {}
    for number, fault in enumerate(faults):
        at = PLACE.fullmatch(fault.place)
        groups.setdefault(
            (at["sheet"], at["letter"], _kind(fault.message)) if at else (str(number),), []
        ).append((number, fault))
    told: list[tuple[int, Fault]] = []
    for key, alike in groups.items():
        said = {fault.message for _, fault in alike}
        if len(alike) >= MANY or (len(alike) >= FEWEST and len(said) == 1):
            header = headers.get((key[0], key[1]), "")
            alike = [(alike[0][0], _as_one([fault for _, fault in alike], key[1], header))]
        told += alike
    return tuple(fault for _, fault in sorted(told, key=lambda entry: entry[0]))


def _as_one(alike: Sequence[Fault], letter: str, header: str) -> Fault:
    rows = sorted({int(at["row"]) for fault in alike if (at := PLACE.fullmatch(fault.place))})
    column = f"column {letter} {header!r}" if header else f"column {letter}"
    return Fault(
        f"{column}, rows {_spans(rows)}, as here: {alike[0].message}", alike[0].path, alike[0].place
    )


def _spans(rows: Sequence[int]) -> str:
    """3, 4, 5, 9 -> "3 to 5 and 9"."""
    spans: list[list[int]] = []
    for row in rows:
        if spans and row == spans[-1][1] + 1:
            spans[-1][1] = row
        else:
            spans.append([row, row])
    texts = [f"{first} to {last}" if last > first else str(first) for first, last in spans]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} and {texts[-1]}"


def _kind(message: str) -> str:
    """What the fault is about, whatever the value: its first sentence without what stands in
    quotes, and without numbers.
    """
    first = re.split(
        r"[.?;] |[.?]$", re.sub(r"'(?:[^'\\]|\\.)*'|\"[^\"]*\"", "…", message), maxsplit=1
    )[0]
    return re.sub(r"[-−]?\d[\d.,:/-]*", "#", first)
