"""What one operator does, turn by turn: what to wait for, with whom, and who waits for it."""

from __future__ import annotations

from dataclasses import dataclass

from tandem.cell.model import Cell
from tandem.draw.style import looks, task_label
from tandem.report.language import Words
from tandem.schedule.critical import Link, links
from tandem.schedule.model import Assignment, Schedule


@dataclass(frozen=True)
class Turn:
    """One task of one operator.

    Attributes:
      number: counted from 1.
      task, does: its name, and what people call it.
      part, tool, zone: empty when there is none.
      together_with: who takes part too.
      wait: what to wait for before it begins, each a short sentence.
      hands_to: who can begin what when it is done, if it is the last thing that they waited for.
      start, end: seconds since the start of the assembly.
    """

    number: int
    task: str
    does: str
    part: str
    tool: str
    zone: str
    together_with: str
    wait: tuple[str, ...]
    hands_to: tuple[str, ...]
    start: float
    end: float


def turns(cell: Cell, schedule: Schedule, operator: str, t: Words) -> tuple[Turn, ...]:
    """The operator's tasks in order. Assumes a sound schedule."""
    why, rows = links(cell, schedule), {a.task: a for a in schedule}
    found = []
    for number, a in enumerate(schedule.of(operator), 1):
        task = cell.tasks[a.task]
        found.append(
            Turn(
                number=number,
                task=a.task,
                does=task_label(cell, a.task),
                part=task.part or "",
                tool=task.tool or "",
                zone=task.zone or "",
                together_with=", ".join(_label(cell, who) for who in a.operators if who != operator),
                wait=tuple(dict.fromkeys(_wait(cell, rows, link, operator, t) for link in why[a.task])),
                hands_to=tuple(
                    _hand(cell, rows[name], t) for name in cell.tasks if operator not in rows[name].operators and _released(cell, rows, a, name)
                ),
                start=a.start,
                end=a.end,
            )
        )
    return tuple(found)


def _label(cell: Cell, operator: str) -> str:
    return looks(cell)[operator].label


def _names(cell: Cell, a: Assignment) -> str:
    return " + ".join(_label(cell, who) for who in a.operators)


def _wait(cell: Cell, rows: dict[str, Assignment], link: Link, operator: str, t: Words) -> str:
    """One reason to wait, as the operator sees it."""
    before = rows.get(link.waited_for or "")
    if before is not None and operator in before.operators:
        return t("steps.wait.previous")
    match link.reason:
        case "predecessor" if before is not None:
            return t("steps.wait.task", task=task_label(cell, before.task), who=_names(cell, before))
        case "operator" | "changeover" if link.by != operator:
            return t("steps.wait.other", who=_label(cell, link.by))
        case "tool":
            return t("steps.wait.tool", tool=link.by)
        case "zone":
            return t("steps.wait.zone", zone=link.by)
        case "break" if link.by == operator:
            return t("steps.wait.break")
        case "break":
            return t("steps.wait.other", who=_label(cell, link.by))
        case "start":
            return t("steps.wait.start")
    return t("steps.wait.release")


def _released(cell: Cell, rows: dict[str, Assignment], a: Assignment, follower: str) -> bool:
    """The follower comes after this task, and no other of its predecessors ends later."""
    after = cell.tasks[follower].after
    return a.task in after and a.end == max(rows[first].end for first in after)


def _hand(cell: Cell, a: Assignment, t: Words) -> str:
    return t("steps.hand", task=task_label(cell, a.task), who=_names(cell, a))
