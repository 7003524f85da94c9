"""Names of tools, zones and places that name none, or several: "keins", "dito", "drill; press".

Taken as they stand they would be things of their own: all tasks without a tool would wait for the
one tool "none", and a press in a list would keep nobody from the press.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from tandem.cell.names import key
from tandem.files.spreadsheet.findings import Findings, Path

NONE = frozenset(
    ("none", "nothing", "no", "without", "na", "n a", "k a", "kein", "keine", "keiner", "keins")
) | {"nein", "ohne", "nichts", "entfaellt"}
"""What says that a task needs none, folded."""
NO_NAME = re.compile(
    r"[\"'„“”″〃]{1,2}|-\"-|ditt?o\.?|do\.|same( as above)?|(as|see) above|s\. ?o\.|siehe oben"
    r"|wie (oben|vor|vorher|zuvor)|ebenso|\?+|tbd|tba|t\.b\.d\.|offen",
    re.IGNORECASE,
)
"""What stands for the one above, or for one that is still open."""
LIST = re.compile(r"\s*[,;|+&]\s*|\s*(?<!\d)/\s*|\s*/(?!\d)\s*|\s+(?:und|and|oder|or)\s+")


@dataclass(frozen=True)
class Name:
    """What a task says it needs: `owner[at]`, at that path in the cell."""

    owner: dict[str, Any]
    at: str
    path: Path

    @property
    def text(self) -> str:
        return str(self.owner[self.at])


def settle_things(
    tasks: Mapping[str, dict[str, Any]], known: Mapping[str, Iterable[str]], findings: Findings
) -> None:
    """Takes the names away that say "none", and asks about those that are no name, or that list
    things which have names of their own.

    Args:
      known: "tool", "zone" and "place" -> those that sheets of their own name; they are names
        whatever they look like.
    """
    for what, own in known.items():
        named = {key(name) for name in own}
        stated = [name for name in _stated(tasks, what) if key(name.text) not in named]
        single = named | {key(name.text) for name in stated if len(_parts(name.text)) < 2}
        listed = Counter(part for text in {n.text for n in stated} for part in _parts(text))
        for name in stated:
            parts = [part for part in LIST.split(name.text) if key(part)]
            others = [part for part in parts if key(part) in single or listed[key(part)] > 1]
            if key(name.text) in NONE:
                del name.owner[name.at]
            elif NO_NAME.fullmatch(name.text):
                findings.fault(
                    f"holds {name.text!r}, which names no {what}: write the name, or leave the cell"
                    " empty if the task needs none.",
                    findings.place_of(name.path),
                )
            elif others and len(parts) > 1:
                findings.fault(
                    f"holds {name.text!r}, which would be one {what} of its own, and"
                    f" {others[0]!r} stands elsewhere, too. A task has one {what}: write the one"
                    " that others wait for, or part the task into rows.",
                    findings.place_of(name.path),
                )
        for task in tasks.values():
            if task.get(what) == {}:
                del task[what]


def _stated(tasks: Mapping[str, dict[str, Any]], what: str) -> Iterator[Name]:
    """Of all who do the task, or of each."""
    for name, task in tasks.items():
        stated = task.get(what)
        if isinstance(stated, str):
            yield Name(task, what, ("tasks", name, what))
        elif isinstance(stated, dict):
            yield from (Name(stated, who, ("tasks", name, what, who)) for who in list(stated))


def _parts(text: str) -> list[str]:
    """Folded, the names of a list; a text that is none has one part."""
    return [folded for part in LIST.split(text) if (folded := key(part))]
