"""Projects in the form of Patterson (`.rcp`): numbers alone.

Number of activities and of resources; the capacities; then for each activity its duration, what it
needs of each resource, how many successors it has, and their numbers, counted from 1. Lines may be
broken anywhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from tandem.files.formats.lines import Translated, broken, few_enough, rows, whole
from tandem.files.formats.shared_capacity import Activity, Project, Way, as_cell


class _Word(NamedTuple):
    line: int
    text: str


def looks_like(text: str) -> bool:
    """Never by its content: it is numbers as many others are. Its ending or `--format` says so."""
    return False


def read(text: str, source: str) -> Translated:
    """The project as a cell; activities without a duration, such as source and sink, are left out.

    Raises:
      CellError: the file is not of this form, with the line where it ceases to be; or a cell cannot
        hold it, with every reason.
    """
    words = iter([_Word(row.line, word) for row in rows(text) for word in row.words])
    last = max(1, len(text.splitlines()))

    def number(what: str) -> tuple[int, int]:
        found = next(words, None)
        if found is None:
            raise broken(source, last, f"the file ends before {what}.")
        return found.line, whole(source, found.line, found.text, what)

    _, count = number("the number of activities")
    line, many = number("the number of resources")
    few_enough(source, line, many, count)
    resources = [f"R{place}" for place in range(1, many + 1)]
    capacities = [number(f"the capacity of {name}") for name in resources]
    ways: dict[str, Way] = {}
    after: dict[str, list[str]] = {str(place): [] for place in range(1, count + 1)}
    for name in after:
        line, duration = number(f"the duration of activity {name}")
        needs = {key: number(f"what activity {name} needs of {key}")[1] for key in resources}
        ways[name] = Way(line, duration, needs)
        _, successors = number(f"the number of successors of activity {name}")
        for _ in range(successors):
            line, then = number(f"a successor of activity {name}")
            if str(then) not in after:
                raise broken(
                    source,
                    line,
                    f"there is no activity {then}: {count} are stated, counted from 1.",
                )
            after[str(then)].append(name)
    if (more := next(words, None)) is not None:
        raise broken(source, more.line, f"{count} activities are stated, but more numbers follow.")
    return as_cell(
        Project(
            source,
            capacities[0][0] if capacities else 1,
            {name: units for name, (_, units) in zip(resources, capacities, strict=True)},
            {},
            dict(_activities(ways, after)),
        )
    )


def _activities(
    ways: dict[str, Way], after: dict[str, list[str]]
) -> Iterator[tuple[str, Activity]]:
    for name, way in ways.items():
        yield name, Activity(way.line, (way,), tuple(after[name]))
