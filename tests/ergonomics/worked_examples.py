"""The published worked examples, and what we make of them.

`python -m tests.ergonomics.worked_examples` prints the table of docs/ergonomics.md.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tandem.ergonomics.methods import published
from tandem.ergonomics.outcome import Outcome

FILE = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))
EXAMPLES: list[dict[str, Any]] = FILE["examples"]
NOT_REPRODUCED: list[dict[str, str]] = FILE["not_reproduced"]
PRINTED = ("published", "software_output")
"""Kinds of examples whose result somebody else has printed. Others are regression values, or inputs
that were printed without the result of that step.
"""


def answer(example: Mapping[str, Any]) -> Mapping[str, Any]:
    """Our outputs, by their published names."""
    found = published(example["method"], example["function"], example["inputs"])
    return found.outputs if isinstance(found, Outcome) else found


@dataclass(frozen=True)
class Compared:
    """One printed number and ours."""

    name: str
    printed: Any
    ours: Any
    agrees: bool


def compared(example: Mapping[str, Any]) -> Iterator[Compared]:
    """Every expected output beside ours, within the example's tolerance."""
    ours, tolerance = answer(example), example["tolerance"]
    for name, printed in example["expected"].items():
        found = ours.get(name)
        yield Compared(name, printed, found, close(printed, found, tolerance))


def close(printed: Any, found: Any, tolerance: Mapping[str, float]) -> bool:
    if isinstance(printed, dict):
        return all(close(value, found[key], tolerance) for key, value in printed.items())
    if isinstance(printed, str) or found is None:
        return bool(printed == found)
    allowed = tolerance.get("abs", tolerance.get("rel", 0.0) * abs(printed))
    return bool(abs(found - printed) <= allowed)


def shown(value: Any) -> str:
    """A number to five digits."""
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def table() -> str:
    """Markdown: the examples whose result somebody printed, and what was not reproduced."""
    lines = [
        "| method | example | printed by | printed | ours |",
        "|---|---|---|---|---|",
    ]
    for example in EXAMPLES:
        if example["kind"] not in PRINTED:
            continue
        found = list(compared(example))
        recalled = " (recalled)" if example["provenance"] == "RECALLED" else ""
        lines.append(
            f"| {example['method']} | {example['id']} | {example['reference']}{recalled} |"
            f" {', '.join(f'{c.name} {shown(c.printed)}' for c in found)} |"
            f" {', '.join(shown(c.ours) for c in found)} |"
        )
    lines += ["", "Printed, and not what we get:", ""]
    lines += ["| method | example | printed | ours | because |", "|---|---|---|---|---|"]
    lines += [
        f"| {row['method']} | {row['id']} | {row['printed']} | {row['ours']} | {row['because']} |"
        for row in NOT_REPRODUCED
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    print(table())  # noqa: T201
