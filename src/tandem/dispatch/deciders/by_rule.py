"""Dispatch rules live: the rule builds a schedule of the rest at each event, and what starts at
once in it begins.
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass, field
from random import Random
from time import perf_counter

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import Models, allowed, position
from tandem.dispatch.deciders.policy import Decision, Options
from tandem.dispatch.deciders.reply import reply
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.residual import rest
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.dispatch.situation.model import Situation
from tandem.plan.list_scheduling import Layout, PartialSchedule
from tandem.plan.rules import SPECS, build


def by_rule(name: str, cell: Cell, objective: Objective, options: Options) -> ByRule:
    """The dispatch rule of this name, live. Raises CellError as `Moves.of` does."""
    models = Models(cell, objective.max_stress)
    models.of(Situation.of(cell), 1.0)
    return ByRule(name, models, objective, options.seed)


@dataclass(frozen=True)
class ByRule:
    """A dispatch rule as a policy. It knows the stated times only."""

    name: str
    models: Models
    objective: Objective
    seed: int
    _known: dict[tuple[int, Position], tuple[int, ...]] = field(default_factory=dict)

    def decide(self, situation: Situation) -> Decision:
        """What begins now."""
        began = perf_counter()
        moves = self.models.of(situation, 1.0)
        here = position(moves, situation, {})
        choice = self.choose(moves, here, situation)
        return reply(
            self.name,
            moves,
            situation,
            here,
            choice,
            [(choice, None)],
            began=began,
            because=f"by the rule {self.name!r}",
        )

    def choose(self, moves: Moves, here: Position, situation: Situation) -> tuple[int, ...]:
        """The ways that start at once in the rule's schedule; the best of those that may when it
        starts none and nothing runs.
        """
        left = rest(moves, here, with_running=False)
        if left is None:
            return ()
        layout = Layout.of(left.instance)
        rule = SPECS[self.name]
        legal = allowed(moves, situation)
        # drawn anew from seed and moment, so that the same situation is decided alike in a replay
        random = Random(f"{self.seed} {situation.now!r}")
        found: list[PartialSchedule] = []
        for sample in range(rule.samples):
            state = build(
                layout,
                rule,
                random,
                stress=self._stress(layout) if rule.sweeps else None,
                temperature=rule.temperature if sample else 0.0,
            )
            if state is not None:
                found.append(state)
        if not found:
            return _anything(moves, here, legal)
        # a rule that draws makes several schedules; the objective, which no rule knows, picks one
        best = min(
            found,
            key=lambda state: self.objective.cost(
                state.makespan / moves.instance.per_second, moves.instance.stress(state.stress)
            ),
        )
        begins = tuple(
            left.ways[t][way]
            for t, (way, start) in enumerate(best.starts())
            if _begins(layout, t, way, start)
        )
        # the plan may begin what the situation does not allow, or what no longer fits together
        kept = _compatible(moves, here, [_apart(moves, here, way) for way in begins], legal)
        return kept or (() if here.running else _anything(moves, here, legal))

    def _stress(self, layout: Layout) -> float:
        """What a unit of stress weighs against a tick, by the objective."""
        if not self.objective.time:
            return 1e6
        return (
            self.objective.stress
            / self.objective.time
            * layout.instance.per_second
            / layout.instance.per_stress
        )


def _begins(layout: Layout, task: int, way: int, start: int) -> bool:
    """The task starts now, but for what its operators need first to get ready."""
    preparations = layout.instance.preparations(task, layout.instance.ways[task][way])
    return start == 0 or 0 < start <= max(
        (max(preparation.lengths) for preparation in preparations), default=0
    )


def _apart(moves: Moves, here: Position, way: int) -> int:
    """A task that is mounted wrongly is taken apart first."""
    return way + moves.count if here.wrong >> moves.task[way] & 1 else way


def _compatible(moves: Moves, here: Position, ways: list[int], legal: Set[int]) -> tuple[int, ...]:
    """Those of the ways that may begin together now, the first ones first."""
    kept: list[int] = []
    for way in ways:
        if way in legal and way in moves.legal(here):
            here = moves.begin(here, way)
            kept.append(way)
    return tuple(sorted(kept))


def _anything(moves: Moves, here: Position, legal: Set[int]) -> tuple[int, ...]:
    """The legal way with the longest chain behind it: better than standing still."""
    return (
        ()
        if not legal or here.running
        else (
            max(
                legal, key=lambda way: (moves.layout.tail[moves.task[way]], -moves.ticks[way], -way)
            ),
        )
    )
