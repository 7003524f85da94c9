"""Plain text in columns."""

from __future__ import annotations


def aligned(rows: list[tuple[str, ...]]) -> list[str]:
    """Rows of a table in columns, the first row being the header."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return [
        "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def indented(rows: list[tuple[str, ...]]) -> list[str]:
    """The same, two spaces in."""
    return [f"  {line}" for line in aligned(rows)]
