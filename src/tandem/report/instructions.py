"""What one operator does, turn by turn: everything to wait for, with whom, and who must be told
when it is done.

A sheet holds on paper too, where nobody is on the planned second: it names every condition of a
turn, not only the one that binds in the plan. What the operator did before is implied, because the
turns are done in the order of the sheet.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from tandem.cell.model import Cell
from tandem.draw.style import looks
from tandem.report.language import Words
from tandem.report.tables import named
from tandem.schedule.critical import HandOver, hand_overs
from tandem.schedule.measures import changeovers
from tandem.schedule.model import Assignment, Schedule


@dataclass(frozen=True)
class Turn:
    """One task of one operator.

    Attributes:
      number: counted from 1.
      task, does: its name; name and label.
      part, tool, zone: empty when there is none. A tool that must be taken up first says so, with
        the seconds that it takes.
      together_with: who takes part too.
      wait: everything that must be so before it begins, each a short sentence.
      hands_to: whom to tell when it is done, each a short sentence: who waits for the task, or for
        its tool or zone.
      start, end: seconds since the start of the assembly.
      deadline: the latest end in seconds; None when there is none.
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
    deadline: float | None


def turns(cell: Cell, schedule: Schedule, operator: str, t: Words) -> tuple[Turn, ...]:
    """The operator's tasks in order. Assumes a sound schedule."""
    sheet = _Sheet(cell, schedule, operator, t)
    return tuple(sheet.turn(number) for number in range(1, len(sheet.own) + 1))


def rules(cell: Cell, operator: str, t: Words) -> tuple[str, ...]:
    """How to read the operator's sheet, and when the operator has a break; sentences that stand
    above the turns.
    """
    off = [
        t("steps.span", start=t.number(start), end=t.number(end))
        for start, end in cell.operators[operator].breaks
    ]
    return (
        t(f"steps.rule.{cell.operators[operator].kind}"),
        *([t("steps.breaks", breaks=", ".join(off))] if off else []),
    )


def times(found: tuple[Turn, ...]) -> tuple[str, ...]:
    """The fields of a turn that hold seconds, without those that no turn of the sheet has."""
    return (
        ("start", "end", "deadline")
        if any(turn.deadline is not None for turn in found)
        else ("start", "end")
    )


class _Sheet:
    """One operator's part in a sound schedule."""

    def __init__(self, cell: Cell, schedule: Schedule, operator: str, t: Words):
        self.cell, self.operator, self.t = cell, operator, t
        self.rows = {a.task: a for a in schedule}
        self.own = schedule.of(operator)
        self.hand_overs = hand_overs(cell, schedule)
        self.take_up = {
            change.task: change
            for change in changeovers(cell, schedule)
            if change.operator == operator
        }

    def turn(self, number: int) -> Turn:
        a = self.own[number - 1]
        task = self.cell.tasks[a.task]
        return Turn(
            number=number,
            task=a.task,
            does=named(self.cell, a.task),
            part=task.part or "",
            tool=self._tool(a.task),
            zone=task.zone or "",
            together_with=", ".join(self._label(who) for who in self._partners(a)),
            wait=tuple(dict.fromkeys(self._conditions(number))),
            hands_to=tuple(dict.fromkeys(self._to_tell(a))),
            start=a.start,
            end=a.end,
            deadline=task.deadline,
        )

    def _conditions(self, number: int) -> Iterator[str]:
        """All that must be so before a turn begins, or the one sentence that nothing else need be
        waited for.
        """
        a, before = self.own[number - 1], self.own[: number - 1]
        found = [
            *self._predecessors(a, {row.task for row in before}),
            *self._places(a, {row.task for row in before}),
            *(self.t("steps.wait.partner", who=self._label(who)) for who in self._partners(a)),
            *(() if before else self._setup()),
            *self._breaks(before[-1].end if before else 0.0, a.start),
            *self._release(a),
        ]
        yield from found or [self.t("steps.wait.previous" if before else "steps.wait.start")]

    def _predecessors(self, a: Assignment, own: set[str]) -> Iterator[str]:
        for name in self.cell.tasks[a.task].after:
            if name not in own:
                yield self.t(
                    f"steps.wait.task.{self._sign(name)}",
                    task=named(self.cell, name),
                    who=self._names(name),
                )

    def _places(self, a: Assignment, own: set[str]) -> Iterator[str]:
        """From whom the tool comes, and who must have left the zone."""
        for given in self.hand_overs:
            if given.after == a.task and given.before not in own:
                yield self.t(
                    f"steps.wait.{given.reason}",
                    name=given.name,
                    who=self._names(given.before),
                    task=named(self.cell, given.before),
                )

    def _setup(self) -> Iterator[str]:
        """What the operator needs before its first turn."""
        if (span := self.cell.operators[self.operator].setting_up) is not None:
            start, end = map(self.t.number, span)
            seconds = self.t.seconds(self.cell.operators[self.operator].setup)
            yield self.t(
                "steps.wait.setup", seconds=seconds, span=self.t("steps.span", start=start, end=end)
            )

    def _breaks(self, free: float, start: float) -> Iterator[str]:
        """The operator's own breaks between the last turn and this one."""
        for off, back in self.cell.operators[self.operator].breaks:
            if free <= off and back <= start:
                yield self.t(
                    "steps.wait.break",
                    span=self.t("steps.span", start=self.t.number(off), end=self.t.number(back)),
                )

    def _release(self, a: Assignment) -> Iterator[str]:
        if release := self.cell.tasks[a.task].release:
            yield self.t("steps.wait.release", release=self.t.seconds(release))

    def _to_tell(self, a: Assignment) -> Iterator[str]:
        for name, task in self.cell.tasks.items():
            if a.task in task.after and self.operator not in self.rows[name].operators:
                yield self.t("steps.hand", who=self._names(name), task=named(self.cell, name))
        for given in self.hand_overs:
            if given.before == a.task and self.operator not in self.rows[given.after].operators:
                yield self._hands(given)

    def _hands(self, given: HandOver) -> str:
        return self.t(
            f"steps.hand.{given.reason}",
            name=given.name,
            who=self._names(given.after),
            task=named(self.cell, given.after),
        )

    def _tool(self, task: str) -> str:
        tool, change = self.cell.tasks[task].tool or "", self.take_up.get(task)
        return (
            self.t("steps.take_up", tool=tool, seconds=self.t.seconds(change.end - change.start))
            if change
            else tool
        )

    def _sign(self, task: str) -> str:
        """How the end of a task is noticed: a human calls it out, a robot alone shows it."""
        return (
            "human"
            if any(self.cell.operators[who].kind == "human" for who in self.rows[task].operators)
            else "robot"
        )

    def _partners(self, a: Assignment) -> tuple[str, ...]:
        return tuple(who for who in a.operators if who != self.operator)

    def _names(self, task: str) -> str:
        return " + ".join(self._label(who) for who in self.rows[task].operators)

    def _label(self, operator: str) -> str:
        return looks(self.cell)[operator].label
