"""The exact plan for the stated times, carried out: who does what in which order stays, only the
clock gives way.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from time import perf_counter

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import Models, numbered, position
from tandem.dispatch.deciders.policy import Basis, Chosen, Decision, Options, Start
from tandem.dispatch.deciders.reply import Ranked, reply
from tandem.dispatch.deciders.words import phrase
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.transitions import Moves
from tandem.dispatch.situation.legal import legal, next_change
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.transitions import beginning
from tandem.errors import UnsoundScheduleError
from tandem.plan.methods import plan
from tandem.schedule.checker import faults
from tandem.schedule.measures import exact, made_ready

PLANNING_WORK = 5.0
"""The plan is made once, before the shift, and takes until it is proven; so much work at the most,
in CP-SAT's deterministic seconds, some 10 s of a processor. Limited by a clock, it would be another
plan on another machine.
"""


def fixed(cell: Cell, objective: Objective, options: Options) -> Fixed:
    """Carries out `options.plan`; where that is None, plans the cell as `tandem plan` does, once.

    Raises:
      CellError: as `Moves.of` does.
      InfeasibleError: no plan keeps the limits and deadlines.
      NothingFoundError: none was found by `PLANNING_WORK`.
    """
    models = Models(cell, objective.max_stress)
    models.of(Situation.of(cell), 1.0)
    if options.plan is not None:
        return carried_out(models, options.plan)
    best = plan(
        cell,
        objective.question(),
        work=PLANNING_WORK,
        seed=options.seed,
        workers=1,
        confirm=False,
    )[0]
    basis = Basis.of(best, proven=objective.is_proven(best))
    return carried_out(models, Chosen(best.schedule, basis))


def carried_out(models: Models, chosen: Chosen) -> Fixed:
    """The chosen plan, to be carried out or followed. Raises UnsoundScheduleError when it breaks
    the cell.
    """
    if wrong := faults(models.cell, chosen.schedule):
        raise UnsoundScheduleError(wrong)
    return Fixed(models, chosen, tuple((one.task, one.operators) for one in chosen.schedule))


@dataclass(frozen=True)
class Fixed:
    """A fixed plan, carried out as soon as it can be.

    A task waits until every task planned before it that wants one of its operators, its tool or its
    zone has begun. So, while times are as stated and people do as they are asked, each task
    begins no later than planned: by induction over the plan, what it needs is free by then. A task
    that another one must follow within a time does not begin before its planned start.

    Attributes:
      chosen: the plan.
      order: its tasks with their operators, in order of their planned starts.
    """

    models: Models
    chosen: Chosen
    order: tuple[Start, ...]
    name: str = "fixed"

    @property
    def basis(self) -> Basis:
        """What the plan comes to."""
        return self.chosen.basis

    @property
    def title(self) -> str:
        """What the plan is called in a sentence."""
        return f"the plan {self.chosen.schedule.digest}"

    def decide(self, situation: Situation) -> Decision:
        """Each operator's next task of the plan, as soon as it may begin."""
        began = perf_counter()
        moves = self.models.of(situation, 1.0)
        due = self.due(moves, situation)
        if due is not None:
            return self.unquestioned(self.name, moves, situation, due, began)
        choice = numbered(moves, situation, self._anything(situation))
        because = f"what {self.title} leads to cannot begin, and nothing else would"
        return self._replied(self.name, moves, situation, choice, began, because)

    def due(self, moves: Moves, situation: Situation) -> tuple[int, ...] | None:
        """The ways that the plan begins now, perhaps none; None where it leads nowhere any more."""
        begins = self._due(moves, situation)
        if not begins and not self.held_back(situation) and _stands_still(situation):
            return None
        return tuple(sorted(numbered(moves, situation, begins)))

    def held_back(self, situation: Situation) -> dict[str, float]:
        """Open task that another one must follow within a time -> when its operators begin it in
        the plan, getting ready included, s, while that is to come.
        """
        followed = {
            wait.after
            for task in situation.cell.tasks.values()
            for wait in task.wait
            if wait.at_most is not None
        }
        return {
            task: begin
            for task, begin in (self._begins(situation.cell) if followed else {}).items()
            if task in followed and task in situation.open and begin > situation.now
        }

    def _begins(self, cell: Cell) -> dict[str, float]:
        """Task -> when the first of its operators begins to walk or to take up a tool for it, or it
        starts, s.
        """
        begins = {a.task: a.start for a in self.chosen.schedule}
        for name in cell.operators:
            rows = self.chosen.schedule.of(name)
            for a, ready in zip(rows, made_ready(cell, name, rows), strict=True):
                begin = float(exact(a.start) - exact(ready.seconds))
                begins[a.task] = min(begins[a.task], begin)
        return begins

    def unquestioned(
        self, by: str, moves: Moves, situation: Situation, due: tuple[int, ...], began: float
    ) -> Decision:
        """The decision to do as the plan has it, nothing else having been valued."""
        return self._replied(by, moves, situation, due, began, f"as {self.title} has it")

    def stands(
        self,
        moves: Moves,
        situation: Situation,
        ranked: Ranked,
        due: tuple[int, ...],
        objective: Objective,
    ) -> str:
        """What is said of the plan before the reasons of a choice, the first of `ranked`: that it
        follows the plan, or what of the plan it leaves and for how much.
        """
        (choice, cost), *others = ranked
        if choice == due:
            return f"as {self.title} has it, "
        planned = phrase(situation, beginning(situation, [moves.named(way) for way in due]))
        left = f"it leaves {self.title}, by which {planned}"
        by_plan = dict(others).get(due)
        if by_plan is None or cost is None or not isfinite(by_plan):
            return f"{left}, for that leads nowhere now, "
        return f"{left}, and gains {objective.words(by_plan - cost, 3)}, "

    def later(self, situation: Situation) -> dict[str, str]:
        """Busy human -> the first open task that the plan holds for them."""
        busy = {who for at in situation.running.values() for who in at.operators}
        here = busy.intersection(situation.cell.humans) - situation.absent
        found: dict[str, str] = {}
        for task, operators in self.order:
            if task in situation.open:
                found |= {who: task for who in operators if who in here and who not in found}
        return found

    def _replied(
        self,
        by: str,
        moves: Moves,
        situation: Situation,
        choice: tuple[int, ...],
        began: float,
        because: str,
    ) -> Decision:
        return reply(
            by,
            moves,
            situation,
            position(moves, situation, {}),
            choice,
            [(choice, None)],
            began=began,
            because=because,
            later=self.later(situation),
            look_again=min(self.held_back(situation).values(), default=None),
        )

    def _due(self, moves: Moves, situation: Situation) -> list[Start]:
        """What is next for all that it needs, and may begin now; wrong work comes off first, last
        in the plan first.
        """
        order = [start for start in self.order if start[0] in situation.open]
        comes_off = [start for start in reversed(order) if start[0] in situation.wrong]
        begins: list[Start] = []
        awaited: set[Need] = set()
        held_back = self.held_back(situation)
        for task, planned in [*comes_off, *(start for start in order if start not in comes_off)]:
            start = (task, _willing(situation, task, planned))
            needs = set(_needs(moves, *start))
            is_due = task not in held_back or task in situation.wrong
            if (
                is_due
                and not needs & awaited
                and beginning(situation, [*begins, start]) == [*begins, start]
            ):
                begins.append(start)
            else:
                awaited |= needs
        return begins

    def _anything(self, situation: Situation) -> list[Start]:
        """The first of the plan's tasks that may begin at all, as planned or else."""
        may = legal(situation)
        return [start for task, _ in self.order for start in may if start[0] == task][:1]


Need = tuple[str, str | int]
"""Something that one task at a time, or only so many, can have: an operator by name, a tool or a
zone by number.
"""


def _willing(situation: Situation, task: str, planned: tuple[str, ...]) -> tuple[str, ...]:
    """Who is planned; where somebody of them refuses, the quickest others who can, if there are
    any.
    """

    def refuses(operators: tuple[str, ...]) -> bool:
        return any(situation.is_refused(who, task) for who in operators)

    if not refuses(planned):
        return planned
    others = [way for way in situation.facts.ways[task] if not refuses(way.operators)]
    return min(others, key=lambda way: way.time).operators if others else planned


def _needs(moves: Moves, task: str, operators: tuple[str, ...]) -> Iterator[Need]:
    """Its operators, the machines that hold a part from it on or until then, and its tool and zone
    where these have fewer places than there are
    operators, or keep some apart.
    """
    yield from (("operator", who) for who in operators)
    number, instance = moves.instance.tasks.index(task), moves.instance
    for hold in (*instance.held_from[number], *instance.held_until[number]):
        yield "operator", instance.operators[instance.holds[hold][0]]
    way, zone = moves.flat(task, operators), instance.zone[number]
    yield from (("tool", tool) for tool, _ in (moves.scarce[way] if way is not None else ()))
    if zone is not None and (instance.zone_room[zone] or instance.keeps_apart[zone]):
        yield "zone", zone


def _stands_still(situation: Situation) -> bool:
    """Nothing is under way or to come, not even the return of somebody: people have done what the
    plan did not foresee.
    """
    return (
        not situation.running
        and not situation.absent
        and not situation.failed
        and next_change(situation) is None
    )
