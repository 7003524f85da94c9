"""The policy for any cell, live: schedules of what is left by the network that comes with Tandem,
and what starts at once in the best of them begins. It is what `learned` does where no trained
policy is named, or one that was tuned from it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from random import Random
from time import perf_counter
from typing import NamedTuple

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import Factors, Models, allowed, position, start_by
from tandem.dispatch.deciders.by_rule import ByRule
from tandem.dispatch.deciders.policy import Decision, Options
from tandem.dispatch.deciders.replan import SKETCH, starting, told, weights_in_ticks
from tandem.dispatch.deciders.reply import reply
from tandem.dispatch.deciders.robust import DEAR, GUIDING, MOVES
from tandem.dispatch.deciders.sampled import READ, SAMPLES, TRIED, best_on_average, samples_of
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.residual import FIRST, Plan, Rest, as_plan, rest, resumed, sketches
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.pace import estimates
from tandem.learn.graph.making import Maker
from tandem.learn.graph.network import Weights
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.trained import weights_of
from tandem.plan.list_scheduling import Layout
from tandem.plan.rules import SWEEP, drawn_together, exchange_of

PLACED, LOOKED = 24.0, 150.0
"""Steps that are counted for each task that a schedule places, and for looking at what is left."""
MOST_SAMPLES = 64
MOST_DRAWN = 12
"""Schedules by rules whose priorities are shaken, where durations are sampled."""
TRYING, DRAWING = 0.4, 0.15
"""Shares of the work for plans under sampled durations, and for schedules by shaken rules."""
FEWEST = 3
"""Fewer samples of durations than this say nothing, and are not drawn."""
_NOBODY: Factors = ()


def any_cell(
    cell: Cell, objective: Objective, options: Options, file: Path | None = None
) -> AnyCell:
    """The policy for any cell on this one: with the tuned weights of a file, or those that come
    with Tandem. Plans the whole cell before the shift begins.

    Raises CellError as `Moves.of` does, and for a file without such weights.
    """
    weights = weights_of(file)  # read before the shift, no decision waits for the file
    models = Models(cell, objective.max_stress)
    models.of(Situation.of(cell), 1.0)
    rule = ByRule("longest-tail", models, objective, options.seed)
    made = AnyCell(models, objective, options, rule, weights)
    return replace(made, guides=made.first_plans())


class Bought(NamedTuple):
    """What a decision's work buys: schedules by the network, draws of durations, and schedules by
    rules in all.
    """

    own: int
    samples: int
    ruled: int


@dataclass(frozen=True)
class AnyCell:
    """Plans the rest at each event by the network, with each person's estimated pace: one greedy
    schedule and as many drawn ones as the budget buys, beside those of rules and what is left of
    the plans that were made before the shift. Where people's times are open, what begins now is
    what is best on average under sampled durations; else what begins in the shortest plan.

    Attributes:
      weights: of the network.
      guides: the network's plans of the whole cell, made before the shift.
    """

    models: Models
    objective: Objective
    options: Options
    rule: ByRule
    weights: Weights = field(repr=False, compare=False)
    guides: tuple[Plan, ...] = ()
    name: str = "learned"

    def first_plans(self) -> tuple[Plan, ...]:
        """The network's best plans of the whole cell, for the stated times and for the pace that is
        expected.
        """
        situation, found = Situation.of(self.models.cell), list[Plan]()
        for paces in dict.fromkeys((self._known(situation), ())):
            moves = self.models.of(situation, dict(paces))
            here = position(moves, situation, dict(paces))
            left = rest(moves, here, with_running=False)
            if left is not None:
                weights = weights_in_ticks(self.objective, moves)
                most = max(1, min(MOST_SAMPLES, int(GUIDING / (PLACED * len(left.tasks)))))
                plans = self._own(left, here, weights, 0.0, most)
                found += sorted(plans, key=partial(_cost, weights))[:1]
        return tuple(found)

    def decide(self, situation: Situation) -> Decision:
        """What begins now."""
        return self.within(self.options.work, situation)

    def within(self, work: float, situation: Situation) -> Decision:
        """What begins now, decided by so much work."""
        began, known = perf_counter(), _NOBODY
        # a pace is worth a model of its own only where that leaves work for schedules
        if self._price() <= DEAR * work:
            known = self._known(situation)
        paces = dict(known)
        moves = self.models.of(situation, paces)
        here = position(moves, situation, paces)
        if not allowed(moves, situation).intersection(moves.legal(here)):
            because = "nothing can begin before something has ended or somebody is there"
            return reply(
                self.name, moves, situation, here, (), [((), None)], began=began, because=because
            )
        bought = self.bought(len(situation.open), work)
        plan, found = self._plan(moves, here, situation, paces, bought)
        return told(self, moves, situation, here, plan, began, found)

    def _known(self, situation: Situation) -> Factors:
        """The pace that is expected of each human."""
        known = estimates(situation, self.options.prior)
        return tuple((name, round(pace.mean, 1)) for name, pace in sorted(known.items()))

    def _plan(
        self,
        moves: Moves,
        here: Position,
        situation: Situation,
        paces: Mapping[str, float],
        bought: Bought,
    ) -> tuple[Plan | None, str]:
        """The plan whose beginning is taken, and what it is in words; the network's of equals."""
        by = start_by(moves.instance, situation) if moves.instance.has_most_lags else None
        left = rest(moves, here, with_running=False, due=by)
        if left is None:
            return None, ""
        weights, seed = weights_in_ticks(self.objective, moves), self.options.seed
        own = list(self._own(left, here, weights, situation.now, bought.own))
        own += [one for guide in self.guides if (one := resumed(left, guide)) is not None]
        plans = [*own, *sketches(moves, here, weights, samples=bought.ruled, seed=seed, due=by)]
        if not plans:
            return None, ""
        best, how = min(plans, key=partial(_cost, weights)), "the best"
        legal = allowed(moves, situation)
        begun = [(starting(moves, here, one, legal), one) for one in plans]
        among = [(choice, one) for choice, one in begun if choice is not None]
        if bought.samples and len({choice for choice, _ in among}) > 1:
            drawn = samples_of(
                moves, situation, paces, self.options.prior, by, bought.samples, seed
            )
            best, how = best_on_average(among, list(drawn), weights), "the best on average"
        if not any(best is one for one in own):
            return best, f"{how} plan found, by a rule"
        return best, f"{how} of {len(plans)} plans, by the network for any cell"

    def _own(
        self,
        left: Rest,
        here: Position,
        weights: tuple[float, float],
        now: float,
        samples: int,
    ) -> Iterator[Plan]:
        """The network's schedules of the rest, the greedy one first."""
        layout = Layout.of(left.instance)
        if not samples or layout.impossible():
            return
        dear = SWEEP[-2] * exchange_of(layout)
        exchange = min(weights[1] / weights[0], dear) if weights[0] else dear
        maker = Maker.of(self.weights, Outlook.of(layout, exchange))
        # drawn anew from seed and moment, so that the same situation is decided alike in a replay
        random = np.random.default_rng(Random(f"{self.options.seed} {now!r}").getrandbits(64))
        going = [ticks for _, ticks in here.running]
        for sample in range(samples):
            state = drawn_together(layout, maker.build(random if sample else None))
            if state is not None:
                yield as_plan(left, state, max([state.makespan, *going]), 0.0, False)

    def bought(self, tasks: int, work: float) -> Bought:
        """What so much work buys where so many tasks are left. Work that buys no schedule by the
        network leaves all to rules.
        """
        free, ruled = work - LOOKED - self._price(), len(FIRST)
        samples = int(TRYING * free / ((READ + TRIED * (ruled + MOST_DRAWN)) * tasks))
        samples = 0 if samples < FEWEST or not self.models.cell.humans else min(samples, SAMPLES)
        if samples:
            free -= samples * (READ + TRIED * (ruled + MOST_DRAWN)) * tasks
            drawn = max(0, min(MOST_DRAWN, int(DRAWING * free / (SKETCH * tasks))))
            free -= drawn * SKETCH * tasks
            ruled += drawn
        return Bought(max(0, min(MOST_SAMPLES, int(free / (PLACED * tasks)))), samples, ruled)

    def _price(self) -> float:
        """Steps that are counted for the numbers of the cell under one pace."""
        return MOVES * self.models.count


def _cost(weights: tuple[float, float], plan: Plan) -> float:
    return weights[0] * plan.ticks + weights[1] * plan.units
