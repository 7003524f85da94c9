"""The policy for any cell, live: schedules of what is left by the network that comes with Tandem,
and what starts at once in the best of them begins. It is what `learned` does where no trained
policy is named.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from random import Random
from time import perf_counter

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import Models, allowed, position, start_by
from tandem.dispatch.deciders.by_rule import ByRule
from tandem.dispatch.deciders.policy import Decision, Options
from tandem.dispatch.deciders.replan import told, weights_in_ticks
from tandem.dispatch.deciders.reply import reply
from tandem.dispatch.deciders.robust import DEAR, MOVES
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.residual import FIRST, Plan, Rest, as_plan, rest, sketch
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.pace import estimates
from tandem.learn.graph.making import Maker
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.weights import shipped
from tandem.plan.list_scheduling import Layout
from tandem.plan.rules import SWEEP, drawn_together, exchange_of

PLACED, LOOKED = 24.0, 150.0
"""Steps that are counted for each task that a schedule places, and for looking at what is left."""
MOST_SAMPLES = 64


def any_cell(cell: Cell, objective: Objective, options: Options) -> AnyCell:
    """The shipped policy for this cell. Raises CellError as `Moves.of` does."""
    models = Models(cell, objective.max_stress)
    models.of(Situation.of(cell), 1.0)
    shipped()  # read before the shift, no decision waits for the file
    rule = ByRule("longest-tail", models, objective, options.seed)
    return AnyCell(models, objective, options, rule)


@dataclass(frozen=True)
class AnyCell:
    """Plans the rest at each event by the network, with each person's estimated pace: one greedy
    schedule and as many drawn ones as the budget buys, beside those of four rules. A budget that
    buys none leaves the choice to these.
    """

    models: Models
    objective: Objective
    options: Options
    rule: ByRule
    name: str = "learned"

    def decide(self, situation: Situation) -> Decision:
        """What begins now in the best of the schedules."""
        began, paces = perf_counter(), dict[str, float]()
        # a pace is worth a model of its own only where that leaves work for schedules
        if self._price() <= DEAR * self.options.work:
            known = estimates(situation, self.options.prior)
            paces = {name: round(pace.mean, 1) for name, pace in known.items()}
        moves = self.models.of(situation, paces)
        here = position(moves, situation, paces)
        if not allowed(moves, situation).intersection(moves.legal(here)):
            because = "nothing can begin before something has ended or somebody is there"
            return reply(
                self.name, moves, situation, here, (), [((), None)], began=began, because=because
            )
        plan, found = self._plan(moves, here, situation)
        return told(self, moves, situation, here, plan, began, found)

    def _plan(self, moves: Moves, here: Position, situation: Situation) -> tuple[Plan | None, str]:
        """The best schedule of the rest, and what it is in words; the network's of equals."""
        by = start_by(moves.instance, situation) if moves.instance.has_most_lags else None
        left = rest(moves, here, with_running=False, due=by)
        if left is None:
            return None, ""
        weights, seed = weights_in_ticks(self.objective, moves), self.options.seed
        own = list(self._own(left, here, weights, situation.now))
        ruled = sketch(moves, here, weights, samples=len(FIRST), seed=seed, due=by)
        plans = [*own, *([] if ruled is None else [ruled])]
        best = min(
            plans, key=lambda one: weights[0] * one.ticks + weights[1] * one.units, default=None
        )
        if best is None or best is ruled:
            return best, "the best plan found, by a rule"
        many = f"the best of {len(own)} plans" if len(own) > 1 else "the one plan"
        return best, f"{many} by the network for any cell"

    def _own(
        self, left: Rest, here: Position, weights: tuple[float, float], now: float
    ) -> Iterator[Plan]:
        """The network's schedules of the rest, the greedy one first."""
        samples, layout = self.samples(len(left.tasks)), Layout.of(left.instance)
        if not samples or layout.impossible():
            return
        dear = SWEEP[-2] * exchange_of(layout)
        exchange = min(weights[1] / weights[0], dear) if weights[0] else dear
        maker = Maker.of(shipped(), Outlook.of(layout, exchange))
        # drawn anew from seed and moment, so that the same situation is decided alike in a replay
        random = np.random.default_rng(Random(f"{self.options.seed} {now!r}").getrandbits(64))
        going = [ticks for _, ticks in here.running]
        for sample in range(samples):
            state = drawn_together(layout, maker.build(random if sample else None))
            if state is not None:
                yield as_plan(left, state, max([state.makespan, *going]), 0.0, False)

    def samples(self, tasks: int) -> int:
        """How many schedules of so many tasks the budget buys; 0 where it leaves all to rules."""
        free = self.options.work - LOOKED - self._price()
        return max(0, min(MOST_SAMPLES, int(free / (PLACED * tasks))))

    def _price(self) -> float:
        """Steps that are counted for the numbers of the cell under one pace."""
        return MOVES * self.models.count
