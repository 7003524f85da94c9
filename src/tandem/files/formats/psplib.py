"""Projects of PSPLIB and MMLIB: `.sm` with one mode for each activity, `.mm` with several (Kolisch
and Sprecher, EJOR 96, 1997, 205-216; Van Peteghem and Vanhoucke, EJOR 235, 2014, 62-72).

Sections with headings: the precedence relations (activity, modes, number of successors,
successors), the requests and durations (activity, mode, duration, what it needs of each resource; a
further mode leaves out the activity's number), the availabilities. Renewable resources come first
in every row, then nonrenewable ones.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from tandem.errors import CellError, Fault
from tandem.files.formats.lines import Row, Translated, broken, shown, whole
from tandem.files.formats.shared_capacity import Activity, Project, Way, as_cell

HEADINGS = {
    "precedence": re.compile(r"\s*precedence\s+relations\s*:?\s*", re.IGNORECASE),
    "requests": re.compile(r"\s*requests/durations\s*:?\s*", re.IGNORECASE),
    "capacities": re.compile(r"\s*resource\s*availabilities\s*:?\s*", re.IGNORECASE),
}
WORDS = {
    "precedence": "PRECEDENCE RELATIONS:",
    "requests": "REQUESTS/DURATIONS:",
    "capacities": "RESOURCEAVAILABILITIES:",
}
COUNT = re.compile(r"\s*-?\s*(projects|jobs|renewable|nonrenewable|doubly constrained)\b[^:]*:(.*)")


def looks_like(text: str) -> bool:
    """Whether it has the headings of precedence and of requests."""
    lines = text.splitlines()
    return all(
        any(HEADINGS[name].fullmatch(line) for line in lines) for name in ("precedence", "requests")
    )


def read(text: str, source: str) -> Translated:
    """The project as a cell; source and sink, which take no time, are left out.

    Raises:
      CellError: the file is not of this form, with the line where it ceases to be; or a cell cannot
        hold it, with every reason.
    """
    counts = _counts(text, source)
    sections = _sections(text, source)
    kinds = [("R", counts.get("renewable", 0)), ("N", counts.get("nonrenewable", 0))]
    resources = [f"{sign}{number}" for sign, many in kinds for number in range(1, many + 1)]
    stated, capacities = _capacities(sections["capacities"], source, len(resources))
    requests = _requests(sections["requests"], source, resources)
    after = _precedence(sections["precedence"], source, requests)
    activities = {
        name: Activity(ways[0].line, tuple(ways), tuple(after[name]))
        for name, ways in requests.items()
    }
    if counts.get("jobs", len(activities)) != len(activities):
        raise broken(
            source,
            sections["requests"][-1].line,
            f"{counts['jobs']} jobs are stated, source and sink among them, but"
            f" {len(activities)} have a duration here.",
        )
    units = dict(zip(resources, capacities, strict=True))
    renewable = {name: number for name, number in units.items() if name.startswith("R")}
    consumed = {name: number for name, number in units.items() if name.startswith("N")}
    return as_cell(Project(source, stated, renewable, consumed, activities))


def _counts(text: str, source: str) -> dict[str, int]:
    found: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if (stated := COUNT.match(line.lower())) and (words := stated[2].split()):
            found[stated[1]] = whole(source, number, words[0], f"the number of {stated[1]}")
            _refuse(stated[1], found[stated[1]], source, number)
    return found


def _refuse(what: str, count: int, source: str, line: int) -> None:
    if what == "projects" and count > 1:
        raise broken(
            source,
            line,
            f"{count} projects share the resources; a cell holds one. Save each in a file of its"
            " own.",
        )
    if what == "doubly constrained" and count:
        raise broken(
            source,
            line,
            f"{count} resources are doubly constrained (at any moment and over the project): a cell"
            " holds what is free again when a task ends, and no stock.",
        )


def _sections(text: str, source: str) -> dict[str, list[Row]]:
    """The rows of numbers under each heading."""
    sections: dict[str, list[Row]] = {}
    here: list[Row] | None = None
    for number, line in enumerate(text.splitlines(), 1):
        name = next((name for name, form in HEADINGS.items() if form.fullmatch(line)), None)
        if name is not None:
            here = sections.setdefault(name, [])
        elif line.strip().startswith("*"):
            here = None
        elif here is not None and line.split() and not _is_decoration(line):
            here.append(Row(number, line.split()))
    last = max(1, len(text.splitlines()))
    if missing := [name for name in HEADINGS if not sections.get(name)]:
        raise CellError(
            [
                Fault(f"the section {WORDS[name]} is missing or empty.", (), f"{source}:{last}")
                for name in missing
            ]
        )
    return sections


def _is_decoration(line: str) -> bool:
    """Column titles such as `jobnr. mode duration R 1`, and rulers."""
    first = line.split(maxsplit=1)[0]
    return first.lower().startswith("jobnr") or set(first) <= {"-"} or first in ("R", "N", "R1")


def _capacities(lines: list[Row], source: str, count: int) -> tuple[int, list[int]]:
    row = lines[0]
    if len(row.words) != count:
        raise broken(
            source,
            row.line,
            f"{len(row.words)} availabilities stand here, but {count} resources are stated.",
        )
    return row.line, [whole(source, row.line, word, "an availability") for word in row.words]


def _requests(lines: list[Row], source: str, resources: list[str]) -> dict[str, list[Way]]:
    found: dict[str, list[Way]] = {}
    name = ""
    for row in lines:
        words = row.words
        if len(words) == 3 + len(resources):
            name = str(whole(source, row.line, words[0], "an activity"))
            if name in found:
                raise broken(source, row.line, f"activity {name} is stated twice.")
            words = words[1:]
        mode = str(len(found.get(name, [])) + 1)
        if len(words) != 2 + len(resources) or not name or words[0] != mode:
            raise broken(
                source,
                row.line,
                f"a mode is the activity (left out from its second mode on), the mode, counted from"
                f" 1, its duration and {len(resources)} demands, but this line is"
                f" {shown(' '.join(row.words))}.",
            )
        _, duration, *needs = (
            whole(source, row.line, word, f"a number of activity {name}") for word in words
        )
        found.setdefault(name, []).append(
            Way(row.line, duration, dict(zip(resources, needs, strict=True)))
        )
    return found


def _precedence(
    lines: list[Row], source: str, activities: dict[str, list[Way]]
) -> dict[str, list[str]]:
    after: dict[str, list[str]] = {name: [] for name in activities}
    for row, first, then in _arcs(lines, source):
        for name in (first, then):
            if name not in after:
                raise broken(
                    source,
                    row.line,
                    f"there is no activity {shown(name)}: no duration is stated for it.",
                )
        after[then].append(first)
    return after


def _arcs(lines: list[Row], source: str) -> Iterator[tuple[Row, str, str]]:
    for row in lines:
        if len(row.words) < 3:
            raise broken(
                source,
                row.line,
                "activity, number of modes and number of successors are needed, but this line has"
                f" {len(row.words)} words.",
            )
        first, _, count, *successors = (
            whole(source, row.line, word, "a number of the precedence") for word in row.words
        )
        if count != len(successors):
            raise broken(
                source,
                row.line,
                f"activity {first} states {count} successors, but {len(successors)} follow.",
            )
        yield from ((row, str(first), str(then)) for then in successors)
