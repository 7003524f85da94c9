"""What a decider may see of a simulated episode: a row of the event world's state as a `Situation`.
Ends that are still to come stay hidden.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from tandem.dispatch.situation.facts import Facts
from tandem.dispatch.situation.model import Running, Situation, Work
from tandem.world.arrays import NEVER, Arrays, Names

Row = dict[str, Any]
"""One episode's fields as lists and numbers, keyed as in `State`, with `asked` (per operator, the
task last announced, -1 for none) and `off` (per task, it must come off).
"""


@dataclass(frozen=True)
class Observer:
    """Turns rows into situations.

    Attributes:
      names, arrays: of the cell. `taking_apart`: the share of its time that taking a task apart
        takes.
    """

    names: Names
    arrays: Arrays
    taking_apart: float = 1.0

    @cached_property
    def facts(self) -> Facts:
        """What follows from the cell, worked out once for all situations."""
        return Facts.of(self.names.cell)

    def situation(self, row: Row) -> Situation:
        """What can be seen: work that ended with its real times, work in hand by its stated times,
        who is there, what was refused and announced.
        """
        cell, clock = self.names.cell, row["clock"]
        done, running, wrong, past = {}, {}, {}, []
        for number, task in enumerate(self.names.tasks):
            way, start, end = row["way"][number], row["start_at"][number], row["end_at"][number]
            # not begun, or taken off again: nothing of it can be seen
            if way < 0:
                continue
            operators = self.names.ways[way][1].operators
            undoing = bool(row["undoing"] and row["undoing"][number])
            ticks = int(self.arrays.undo[way] if undoing else self.arrays.way_ticks[way])
            # work in hand shows its stated time only: when it will really end is chance's secret
            if end > clock or undoing:
                away = any(
                    row["away_until"][self.names.operators.index(who)] > clock for who in operators
                )
                # while somebody is away the work rests, and the decider may know that
                since = self.names.seconds(clock) if away else None
                running[task] = Running(
                    operators,
                    self.names.seconds(start),
                    self.names.seconds(start + ticks),
                    undoing,
                    rests_since=since,
                )
                continue
            work = Work(
                task,
                operators,
                self.names.seconds(start),
                self.names.seconds(end),
                self.names.seconds(ticks),
                0.0,
                "done",
            )
            # who watches knows that a wrong task is wrong only once it has to come off
            past.append(work)
            if row["off"] and row["off"][number]:
                wrong[task] = work
            else:
                done[task] = work
        # a robot that is away has failed, a human is absent: the two are told apart by their kind
        off = [
            name
            for number, name in enumerate(self.names.operators)
            if row["away_until"][number] > clock
        ]
        return Situation(
            cell,
            now=self.names.seconds(clock),
            done=done,
            running=running,
            past=tuple(sorted(past, key=lambda work: (work.end, work.task))),
            absent=frozenset(name for name in off if name in cell.humans),
            failed=frozenset(name for name in off if name not in cell.humans),
            refused=self._refused(row),
            announced={
                name: self.names.tasks[task]
                for name, task in zip(self.names.operators, row["asked"], strict=True)
                if task >= 0
            },
            wrong=wrong,
            in_hand={
                name: self.names.tools[tool]
                for name, tool in zip(self.names.operators, row["in_hand"], strict=True)
                if 0 <= tool < NEVER
            },
            stands={
                name: self.names.places[place]
                for name, place in zip(self.names.operators, row["stands"], strict=True)
                if 0 <= place < NEVER
            },
            taking_apart=self.taking_apart,
            known=self.facts,
        )

    def _refused(self, row: Row) -> dict[tuple[str, str], float | None]:
        humans = set(self.names.cell.humans)
        ways = [self.names.ways[way] for way, refused in enumerate(row["refused"]) if refused]
        return {(who, task): None for task, mode in ways for who in mode.operators if who in humans}
