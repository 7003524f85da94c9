"""The little Markdown that our tables are written in, as HTML: paragraphs, tables, headings, lists,
`code`. Everything else is plain text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import groupby

from tandem.report.markup import Markup, join, tag
from tandem.report.tables import table

NUMBER = re.compile(r"^[-+]?[\d,.]+( ?(s|%|ms))?$")
"""What stands to the right of its column."""


def html_of(text: str, label: str) -> Markup:
    """The text as HTML; `label` is what a screen reader calls its tables."""
    return join(piece for kind, lines in _blocks(text) for piece in _block(kind, lines, label))


def _blocks(text: str) -> Iterator[tuple[str, list[str]]]:
    for kind, lines in groupby(text.splitlines(), _kind):
        if kind != "empty":
            yield kind, list(lines)


def _kind(line: str) -> str:
    if not line.strip():
        return "empty"
    return (
        "table"
        if line.startswith("|")
        else "heading"
        if line.startswith("#")
        else "list"
        if line.startswith("- ")
        else "text"
    )


def _block(kind: str, lines: list[str], label: str) -> Iterator[Markup]:
    if kind == "heading":
        yield from (tag("h3", _inline(line.lstrip("# "))) for line in lines)
    elif kind == "list":
        yield tag("ul", *(tag("li", _inline(line[2:])) for line in lines))
    elif kind == "text":
        yield from (tag("p", _inline(line)) for line in lines)
    else:
        rows = [
            [cell.strip() for cell in line.strip().strip("|").split("|")]
            for line in lines
            if not re.fullmatch(r"[|:\- ]+", line)
        ]
        head, body = rows[0], rows[1:]
        yield table([(name, "") for name in head], (tag("tr", *_cells(row)) for row in body), label)


def _cells(row: list[str]) -> Iterator[Markup]:
    yield tag("th", _inline(row[0]), scope="row")
    yield from (
        tag("td", _inline(cell), class_="number" if NUMBER.match(cell) else None)
        for cell in row[1:]
    )


def _inline(text: str) -> Markup:
    """`code` and **strong** words; the rest as it stands."""
    pieces = re.split(r"(`[^`]+`|\*\*[^*]+\*\*)", text)
    made = (
        tag("code", p[1:-1])
        if p.startswith("`") and p.endswith("`") and len(p) > 2
        else tag("strong", p[2:-2])
        if _strong(p)
        else p
        for p in pieces
    )
    return join(made)


def _strong(piece: str) -> bool:
    return len(piece) > 4 and piece.startswith("**") and piece.endswith("**")
