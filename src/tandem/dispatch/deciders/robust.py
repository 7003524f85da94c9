"""Re-planning with each person's estimated pace: of the choices that are as good as each other by
a plan, the one that is best on average over what may come.

Ties are many and matter: plans that are equally short for the stated times differ by a quarter when
the human is slower than stated. So this decider does not take a plan but values every choice that
is open now: under each pace that is still believed, the least cost of the rest after that choice (a
hindsight optimum: Littman et al. 1995 call it QMDP), weighed by belief. Where too much is open for
that, it plans the rest.

It counts its work and looks at no clock: what it decides follows from the situation and what was
set, now as in a replay, in a new process as in an old one.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from math import inf, log
from time import perf_counter
from typing import Protocol

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import (
    Factors,
    Key,
    Models,
    allowed,
    cost_so_far,
    numbered,
    position,
)
from tandem.dispatch.deciders.by_rule import ByRule
from tandem.dispatch.deciders.fixed import Fixed, carried_out
from tandem.dispatch.deciders.policy import Chosen, Decision, Options
from tandem.dispatch.deciders.replan import by_plan, models_of, planned, weights_in_ticks
from tandem.dispatch.deciders.reply import reply
from tandem.dispatch.lookahead.branch_and_bound import NOTHING, BranchAndBound, Known
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.residual import Plan
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.dispatch.lookahead.work import OutOfWorkError, Work
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.pace import Pace, estimates

TIE = 1e-6
"""Costs closer than this are equal."""
STRETCHED = (0.85, 1.2)
"""Equally good choices are compared under these further factors on the humans' times.
ASSUMPTION.
"""
ALL_PACES, ONE_PACE = 0.5, 0.65
"""Shares of the work by which the choices must be valued under every belief, or else under the mean
pace alone; what is left is for a plan.
"""
BRIEFLY = 0.1
"""The same share where too much is open to be valued anew: what was valued before the shift is
found within it, and a plan gets the rest.
"""
GROWTH, FREE = 1.7, 3.0
"""ASSUMPTION: each further open task takes so many times the steps to value; and so many fewer than
the steps buy by that are tried.
"""
MOVES = 2.0
"""Steps that are counted for the numbers of the cell under one pace, for each way."""
DEAR = 0.2
"""Where the numbers of the cell under one pace take a larger share of the work, stated times have
to do.
"""
WARMING = 150_000
"""Steps before the shift, for valuing its first choices; a second or two."""
GUIDING = 150_000
"""Steps before the shift for each plan of the whole cell that re-planning then begins from; some
seconds at the most.
"""
OVERDUE_TICKS = 2
"""A robot looks again so many ticks after a human could have finished: who finishes just then is
heard of first.
"""
MOST_SCENARIOS = 7
"""So many beliefs about several humans' paces are looked at."""


def robust(cell: Cell, objective: Objective, options: Options) -> Robust:
    """Re-planning with estimated paces and ties broken; with `options.plan` it follows that while
    it is good. Raises CellError as `Moves.of` does. Values the first choices before the shift
    begins.
    """
    models = models_of(cell, objective)
    models.prepare()
    rule = ByRule("longest-tail", models, objective, options.seed)
    follows = None if options.plan is None else carried_out(models, options.plan)
    made = Robust(models, objective, options, rule, follows)
    return replace(made, before=made.first_values(), guides=made.first_plans())


class Proposer(Protocol):
    """A decider that can be told how much work it may do."""

    def within(self, work: float, situation: Situation) -> Decision: ...


@dataclass(frozen=True)
class Robust:
    """Values every choice that is open now under each pace that is still believed, and takes the
    one that is best on average.

    Attributes:
      follows: the plan that is followed while it is good; None for none.
      before: what was valued before the shift, by the model that it was valued in.
      guides: plans of the whole cell, made before the shift.
      proposer: who decides, with the work that is left, where too much is open for the choices to
        be valued; re-planning does when None.
    """

    models: Models
    objective: Objective
    options: Options
    rule: ByRule
    follows: Fixed | None = None
    before: Mapping[Key, Known] = field(default_factory=dict)
    guides: tuple[Plan, ...] = ()
    proposer: Proposer | None = None
    name: str = "replan-robust"

    @property
    def chosen(self) -> Chosen | None:
        """The plan that is followed; None for none."""
        return None if self.follows is None else self.follows.chosen

    def first_values(self) -> dict[Key, Known]:
        """Values of the first choices and of what may follow them, by model, so that the shift's
        first decisions are as good as the others.
        """
        situation = Situation.of(self.models.cell)
        searches: dict[Key, BranchAndBound] = {}
        with contextlib.suppress(OutOfWorkError):
            self.ranked(
                situation, estimates(situation, self.options.prior), Work(WARMING), None, searches
            )
        return {key: search.learned() for key, search in searches.items()}

    def tried(self, situation: Situation, steps: float) -> tuple[float, float]:
        """Shares of the work by which the choices must be valued under every belief, or else under
        the mean pace alone. Where too much is open for so many steps, both are small, and a plan
        gets what they would have cost.
        """
        most = log(steps) / log(GROWTH) - FREE
        return (ALL_PACES, ONE_PACE) if len(situation.open) <= most else (BRIEFLY, BRIEFLY)

    def first_plans(self) -> tuple[Plan, ...]:
        """Plans of the whole cell, from which re-planning begins: a few milliseconds do not find
        them again. One for the stated times and one for the pace that is expected; none where a
        plan is followed.
        """
        if self.follows is not None:
            return ()
        situation, found = Situation.of(self.models.cell), list[Plan]()
        expected = estimates(situation, self.options.prior)
        for paces in ({}, {name: pace.mean for name, pace in expected.items()}):
            moves = self.models.of(situation, paces)
            here = position(moves, situation, paces)
            plan = planned(self, moves, situation, here, Work(GUIDING), found)
            found += [] if plan is None else [plan]
        return tuple(found)

    def decide(self, situation: Situation) -> Decision:
        """What begins now."""
        began, work = perf_counter(), Work(self.options.work)
        paces = estimates(situation, self.options.prior)
        is_dear = self._price() > DEAR * work.limit
        likely = {name: 1.0 if is_dear else pace.mean for name, pace in paces.items()}
        moves = self.models.of(situation, likely)
        here = position(moves, situation, likely)
        if not allowed(moves, situation).intersection(moves.legal(here)):
            because = "nothing can begin before something has ended or somebody is there"
            return reply(
                self.name, moves, situation, here, (), [((), None)], began=began, because=because
            )
        due = None if self.follows is None else self.follows.due(moves, situation)
        # the values of choices know nothing of what a wait may last at most; a plan does
        by_plans = is_dear or moves.instance.has_most_lags
        total, ranked = work.limit, None
        as_one = {name: _as_one(pace) for name, pace in paces.items()}
        for beliefs, share in zip((paces, as_one), self.tried(situation, total), strict=True):
            work.limit = share * total
            with contextlib.suppress(OutOfWorkError):
                ranked = None if by_plans else self.ranked(situation, beliefs, work, due)
            if ranked is not None:
                break
        work.limit = total
        if ranked is None:
            if self.follows is not None and due:
                return self.follows.unquestioned(self.name, moves, situation, due, began)
            if self.proposer is not None:
                return self.proposer.within(work.left, situation)
            return by_plan(self, moves, situation, here, work, began, self.guides)
        choices, look = ranked
        look_again = None if look is None else situation.now + look / moves.instance.per_second
        return reply(
            self.name,
            moves,
            situation,
            here,
            choices[0][0],
            choices,
            began=began,
            because=self._because(moves, situation, choices, paces, due),
            later=self._later(situation, choices[0][0], due),
            look_again=look_again,
        )

    def ranked(
        self,
        situation: Situation,
        paces: Mapping[str, Pace],
        work: Work,
        due: tuple[int, ...] | None = None,
        searches: dict[Key, BranchAndBound] | None = None,
    ) -> tuple[list[tuple[tuple[int, ...], float]], int | None]:
        """The choices that matter, best first, each with the expected cost of the whole assembly;
        and the ticks after which a robot that waits in the best one should look again although
        nothing has happened (None: it need not).

        Args:
          due: the choice of a plan that is followed. It stands first unless another one's cost is
            lower by more than the change penalty.
          searches: by model, filled with those that were made.

        Raises OutOfWorkError when it takes more work than is allowed.
        """
        searches = {} if searches is None else searches
        beliefs = [
            (share, *self._under(situation, factor, work, searches))
            for factor, share in pace_scenarios(paces)
        ]
        found = self._values(situation, beliefs, None, due)
        if len(found) > 1 and found[1][1] <= found[0][1] + TIE:
            ties = [choice for choice, cost in found if cost <= found[0][1] + TIE]
            found = self._untied(situation, paces, found, ties, work, searches)
        if due is not None:
            found = self._following(found, due)
        base = cost_so_far(self.objective, situation)
        return [(choice, base + cost) for choice, cost in found], (
            _look(beliefs, found[0][0]) if found else None
        )

    def _under(
        self,
        situation: Situation,
        factor: Factors,
        work: Work,
        searches: dict[Key, BranchAndBound],
    ) -> tuple[BranchAndBound, Position]:
        """The search under one belief, and where the assembly stands under it."""
        paces = dict(factor)
        key = self.models.key(situation, paces)
        search = searches.get(key)
        if search is None:
            before = self.before.get(key, NOTHING)
            if key not in self.before:
                work.spend(self._price())
            moves = self.models.of(situation, paces)
            search = BranchAndBound(moves, weights_in_ticks(self.objective, moves), work, before)
            searches[key] = search
        return search, position(search.moves, situation, paces)

    def _price(self) -> float:
        """Steps that are counted for the numbers of the cell under one pace."""
        return MOVES * self.models.count

    def _following(
        self, found: list[tuple[tuple[int, ...], float]], due: tuple[int, ...]
    ) -> list[tuple[tuple[int, ...], float]]:
        """The same list, the plan's choice first unless the best one gains more than the penalty of
        a change.
        """
        cost = dict(found).get(due, inf)
        if cost == inf or cost > found[0][1] + self.options.change_penalty * self._second() + TIE:
            return found
        return [(due, cost), *(row for row in found if row[0] != due)]

    def _second(self) -> float:
        """What a second is worth in the objective; where time weighs nothing, a unit of stress."""
        return self.objective.time or self.objective.stress

    def _values(
        self,
        situation: Situation,
        beliefs: Sequence[Belief],
        among: Iterable[tuple[int, ...]] | None,
        due: tuple[int, ...] | None = None,
    ) -> list[tuple[tuple[int, ...], float]]:
        """(choice, expected cost still to come), best first; a choice that is surely worse than the
        best may be missing or stand with a bound, but `due` has its own cost.
        """
        _, leading, here = beliefs[0]
        first = leading.moves
        # the search calls legal what the situation may not let begin now; both have to agree
        if among is None:
            legal = allowed(first, situation)
            among = (
                choice
                for choice in first.choices(here, look=leading.look)
                if legal.issuperset(choice)
            )
        announced = self._announced(situation, first, here)
        # bounds cost little and values much, so every choice gets its bound before any gets a value
        bounds = []
        for choice in self._kept(announced, list(among)):
            leading.work.spend(len(beliefs))
            steps = _steps(beliefs, choice)
            if steps is not None:
                floor = sum(share * bound for share, _, bound, _, _ in steps)
                bounds.append((floor + self._penalty(announced, choice), choice, steps))
        # the most promising first: a good value early rules out all that comes behind it; before
        # it the plan's, against which the others have to gain
        bounds.sort(key=lambda row: (row[1] != due, row[0], [-way for way in row[1]]))
        best, found = inf, []
        for bound, choice, steps in bounds:
            if bound > best + TIE:
                break
            # scenario after scenario the bound's share is exchanged for the value's, so that the
            # sum stays a lower bound and may be left as soon as it is too high
            cost = bound
            for share, search, floor, paid, after in steps:
                # no search need know more than whether it stays below what would still tie with the
                # best
                room = inf if best == inf else (best + 2 * TIE - cost) / share + floor - paid
                cost += share * (paid + search.value(after, room) - floor)
                if cost > best + TIE:
                    break
            best = min(best, cost)
            found.append((choice, cost))
        found.sort(key=lambda row: row[1])
        return found

    def _untied(
        self,
        situation: Situation,
        paces: Mapping[str, Pace],
        found: list[tuple[tuple[int, ...], float]],
        ties: list[tuple[int, ...]],
        work: Work,
        searches: dict[Key, BranchAndBound],
    ) -> list[tuple[tuple[int, ...], float]]:
        """The same list, equally good choices in the order of what they come to when people are
        somewhat quicker or slower than believed.
        """
        extra: dict[tuple[int, ...], float] = dict.fromkeys(ties, 0.0)
        try:
            for stretch in STRETCHED:
                factor = tuple(
                    (name, round(pace.mean * stretch, 3)) for name, pace in paces.items()
                )
                search, there = self._under(situation, factor, work, searches)
                costs = dict(self._values(situation, [(1.0, search, there)], ties))
                extra = {choice: cost + costs.get(choice, 1e9) for choice, cost in extra.items()}
        except OutOfWorkError:
            pass
        moves = self.models.of(situation, 1.0)
        told = self._announced(situation, moves, position(moves, situation, {}))
        # what robots were told and have not begun is not taken back for nothing either
        told |= set(
            numbered(
                moves, situation, ((task, one.operators) for task, one in situation.orders.items())
            )
        )
        keeps = {choice: _changes(told, choice) for choice in ties}
        stress = {choice: sum(moves.units[way] for way in choice) for choice in ties}
        first = sorted(
            ties, key=lambda choice: (extra[choice], keeps[choice], stress[choice], -len(choice))
        )
        value = dict(found)
        return [
            *((choice, value[choice]) for choice in first),
            *(row for row in found if row[0] not in extra),
        ]

    def _announced(self, situation: Situation, moves: Moves, here: Position) -> frozenset[int]:
        """The ways that were announced to idle humans and could begin now."""
        asked = {(task, (human,)) for human, task in situation.announced.items()}
        return frozenset(way for way in moves.legal(here) if moves.named(way) in asked)

    def _kept(
        self, announced: frozenset[int], choices: list[tuple[int, ...]]
    ) -> list[tuple[int, ...]]:
        """Without the choices that change what was announced to a human and is due within the
        frozen horizon.
        """
        if not self.options.frozen_s:
            return choices
        return [choice for choice in choices if announced.issubset(choice)] or choices

    def _penalty(self, announced: frozenset[int], choice: tuple[int, ...]) -> float:
        changes = _changes(announced, choice) if self.options.change_penalty else 0
        return self.options.change_penalty * self.objective.time * changes

    def _because(
        self,
        moves: Moves,
        situation: Situation,
        ranked: Sequence[tuple[tuple[int, ...], float]],
        paces: Mapping[str, Pace],
        due: tuple[int, ...] | None,
    ) -> str:
        _, cost = ranked[0]
        known = ", ".join(f"{name} takes {pace.words}" for name, pace in paces.items() if pace.seen)
        ground = f"with what is known ({known})" if known else "over the paces that are likely"
        others = [other for _, other in ranked[1:] if other > cost + TIE]
        gain = (
            f", {self.objective.words(others[0] - cost, 3)} less than the next best"
            if others
            else ", as good as any other choice"
        )
        reckoned = f"expected cost {self.objective.words(cost)} {ground}"
        if self.follows is None or due is None:
            return reckoned + gain
        return f"{self.follows.stands(moves, situation, ranked, due, self.objective)}{reckoned}"

    def _later(
        self, situation: Situation, choice: tuple[int, ...], due: tuple[int, ...] | None
    ) -> dict[str, str]:
        """What busy humans are told comes next, while the plan is followed."""
        return {} if self.follows is None or choice != due else self.follows.later(situation)


def _changes(announced: frozenset[int], choice: tuple[int, ...]) -> int:
    """How many tasks that were announced to idle humans, and could begin now, they are not to begin
    now.
    """
    return len(announced.difference(choice))


def _as_one(pace: Pace) -> Pace:
    """The pace as if it were surely its mean."""
    return replace(pace, shares=((round(pace.mean, 3), 1.0),))


def pace_scenarios(paces: Mapping[str, Pace]) -> list[tuple[Factors, float]]:
    """Beliefs about all humans together: (human and factor for each, probability); the most likely
    ones where there are many.
    """
    rows = [
        [(name, factor, share) for factor, share in pace.shares] for name, pace in paces.items()
    ]
    joint = [
        (
            tuple((name, factor) for name, factor, _ in combo),
            _product(share for _, _, share in combo),
        )
        for combo in product(*rows)
    ]
    joint.sort(key=lambda row: -row[1])
    kept = joint[:MOST_SCENARIOS]
    total = sum(share for _, share in kept)
    return [(factors, share / total) for factors, share in kept]


Belief = tuple[float, BranchAndBound, Position]
"""(probability, the search under it, where the assembly stands under it)."""
Step = tuple[float, BranchAndBound, float, float, Position]
"""(probability, search, bound, cost until then, position then) of a choice under one belief."""


def _steps(beliefs: Sequence[Belief], choice: tuple[int, ...]) -> list[Step] | None:
    """Where the choice leads under each belief; None when nothing would ever happen.

    Until the next event; when a robot is left idle, until the next event of whichever belief has it
    soonest, for then it may look again.
    """
    begun = [_begun(search.moves, here, choice) for _, search, here in beliefs]
    ticks = [
        search.moves.next_event(after)
        for (_, search, _), (after, _) in zip(beliefs, begun, strict=True)
    ]
    if any(one is None for one in ticks):
        return None
    if _is_robot_idle(beliefs[0][1].moves, begun[0][0]):
        ticks = [min(one for one in ticks if one is not None)] * len(ticks)
    steps = []
    for (share, search, _), (after, units), one in zip(beliefs, begun, ticks, strict=True):
        paid = search.weights[0] * (one or 0) + search.weights[1] * units
        then = search.moves.after(after, one or 0)
        steps.append((share, search, paid + search.floor(then), paid, then))
    return steps


def _look(beliefs: Sequence[Belief], choice: tuple[int, ...]) -> int | None:
    """Ticks after which a robot that is left idle should look again: a human could have finished by
    then, or is overdue.
    """
    ends = []
    for _, search, here in beliefs:
        after, _ = _begun(search.moves, here, choice)
        ends += [
            left
            for way, left in after.running
            if search.moves.who[way] & search.moves.instance.humans
        ]
        if not _is_robot_idle(search.moves, after):
            return None
    return None if not ends else min(ends) + OVERDUE_TICKS


def _begun(moves: Moves, here: Position, choice: tuple[int, ...]) -> tuple[Position, int]:
    """The position when the choice has begun, and its units of stress."""
    units = 0
    for way in choice:
        here, units = moves.begin(here, way), units + moves.units[way]
    return here, units


def _is_robot_idle(moves: Moves, here: Position) -> bool:
    """A robot is idle though it could begin something."""
    return any(not moves.who[way] & moves.instance.humans for way in moves.legal(here))


def _product(shares: Iterable[float]) -> float:
    result = 1.0
    for share in shares:
        result *= share
    return result
