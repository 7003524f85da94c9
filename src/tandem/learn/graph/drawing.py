"""Schedules drawn from what the policy likes, none of them twice, and none that what is known
already beats.

The decisions looked at so far are kept as a tree. A schedule that was drawn takes its chance away
from every choice on the way to it, so that the next one is drawn from the rest (Shi, Bieber and
Sutton 2020, "Incremental Sampling Without Replacement for Sequence Models"). So does a choice
behind which no schedule can be better than one that was found, by the bounds that the policy sees
anyway. Where the tree holds a decision, the network is not asked again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tandem.learn.graph.candidates import Choices, Making, sight
from tandem.learn.graph.making import Maker, temperature_of
from tandem.plan.list_scheduling import PartialSchedule
from tandem.plan.starts import in_time

MOST_DECISIONS = 20_000
"""So many decisions are kept, which bounds the memory: schedules of large cells hardly meet again
below their first decisions.
"""
TICK, EXACT = 0.01, 1e-6
"""A bound that lacks no more than this of a tick, or this share of itself, counts as reached."""

Numbers = np.ndarray[Any, np.dtype[Any]]
Mask = np.ndarray[Any, np.dtype[np.bool_]]


@dataclass(slots=True)
class Decision:
    """A decision that was looked at.

    Attributes:
      likes: `[K]` logits of its choices.
      chance: `[K]` of each choice, less what was drawn or given up behind it; `left` their sum when
        it was last told to the decision before.
      ticks, units, worth: `[K]` what no schedule behind the choice comes below: makespan, stress,
        and makespan plus stress at the drawing's weight, in ticks.
      behind: the decisions behind choices that were taken.
    """

    choices: Choices
    likes: Numbers
    chance: Numbers
    left: float
    ticks: Numbers
    units: Numbers
    worth: Numbers
    behind: dict[int, Decision] = field(default_factory=dict)


@dataclass
class Known:
    """The points found so far, by drawings at any weight of stress.

    Attributes:
      whole: whether a front is asked for: then a schedule is beaten only where a point has no more
        of makespan and of stress; else by any that is as good at the drawing's own weight.
      points: ticks and units, those that none of the others beats.
    """

    whole: bool = False
    points: list[tuple[int, int]] = field(default_factory=list)

    def take(self, state: PartialSchedule) -> None:
        """A schedule that was made, if it keeps its deadlines and waits."""
        ticks, units = state.makespan, state.stress
        if any(t <= ticks and u <= units for t, u in self.points):
            return
        if in_time(state.instance, tuple(state.starts())):
            others = [(t, u) for t, u in self.points if t < ticks or u < units]
            self.points = [*others, (ticks, units)]

    def beats(self, decision: Decision, exchange: float) -> Mask:
        """`[K]`: behind which choices there is nothing better."""
        if not self.points:
            return np.zeros(len(decision.chance), bool)
        ticks, units = np.array(self.points, float).T
        if not self.whole:
            return _reached(decision.worth, (ticks + exchange * units).min())
        late = _reached(decision.ticks[:, None], ticks)
        found: Mask = (late & (decision.units[:, None] >= units)).any(1)
        return found


def _reached(bound: Numbers, value: Any) -> Mask:
    found: Mask = bound >= value - np.maximum(TICK, EXACT * np.abs(value))
    return found


@dataclass
class Drawing:
    """Schedules by the policy at one weight of stress, one after the other.

    Attributes:
      heat: what logits are divided by; `temperature_of` has the usual.
      known: what was found, also at other weights.
    """

    maker: Maker
    random: np.random.Generator
    heat: float
    known: Known
    _first: dict[int, Decision] = field(default_factory=dict)
    _looked: int = 0

    @classmethod
    def of(cls, maker: Maker, random: np.random.Generator) -> Drawing:
        """For the best schedule at the maker's weight, with the usual temperature."""
        return cls(maker, random, temperature_of(len(maker.outlook.tasks)), Known())

    def greedy(
        self, is_late: Callable[[], bool] = lambda: False
    ) -> tuple[PartialSchedule | None, float | None]:
        """The schedule in which each choice is the one that the network likes best, which will not
        be drawn; None where it runs into a limit, or it `is_late` before it is done. And the chance
        that the network gives that choice, mean over the decisions that had another one; None where
        there was none or the schedule is not done.
        """
        chances = list[float]()

        def best(decision: Decision) -> int:
            if len(decision.likes) < 2:
                return len(decision.likes) - 1
            at = int(decision.likes.argmax())
            chances.append(float(1 / np.exp(decision.likes - decision.likes[at]).sum()))
            return at

        state = self._made(best, is_late)
        return state, float(np.mean(chances)) if state is not None and chances else None

    def drawn(
        self, samples: int, is_late: Callable[[], bool] = lambda: False
    ) -> Iterator[PartialSchedule]:
        """Up to so many schedules that were not drawn before, as long as decisions are left that
        may lead to a better one. What is given up on the way is no schedule, but its decisions
        count: no more are looked at than so many schedules have.
        """
        most, made = self._looked + samples * len(self.maker.outlook.tasks), 0
        while made < samples and self._looked < most and not is_late():
            state = self._made(self._drawn, is_late)
            if state is not None:
                made += 1
                yield state
            elif self._first and not self._first[0].chance.any():
                return

    def _drawn(self, decision: Decision) -> int:
        """One of the choices by what is left of their chances; -1 where that falls to one behind
        which there is nothing better. To go on with what is left there would be to follow unlikely
        ways to their ends.
        """
        decision.chance[self.known.beats(decision, self.maker.outlook.exchange)] = 0.0
        sums = decision.chance.cumsum()
        at = int(sums.searchsorted(self.random.random() * decision.left, "right"))
        return at if at < len(sums) else -1

    def _made(
        self, chosen: Callable[[Decision], int], is_late: Callable[[], bool]
    ) -> PartialSchedule | None:
        """A schedule; `chosen` says which choice is taken, -1 for none."""
        outlook = self.maker.outlook
        making, units = Making.of(outlook), float(sum(outlook.layout.easiest))
        way, place, at = list[tuple[Decision, int]](), self._first, 0
        is_kept = True
        while making.left:
            if is_late():
                return None
            decision = place.get(at)
            if decision is None:
                decision = self._seen(making, units)
                is_kept = is_kept and self._looked < MOST_DECISIONS
                if is_kept:
                    place[at] = decision
            at = chosen(decision)
            if at < 0:
                _tell(way, _left(decision) if is_kept else 1.0)
                return None
            if is_kept:
                way.append((decision, at))
            place = decision.behind
            row = int(decision.choices.rows[at])
            task, step = outlook.step_of[row]
            units += step.stress - outlook.layout.easiest[task]
            making.put(row, int(decision.choices.starts[at]))
        _tell(way, 0.0 if is_kept else 1.0)
        self.known.take(making.state)
        return making.state

    def _seen(self, making: Making, units: float) -> Decision:
        """The next decision. `units`: of stress, placed and at least to come."""
        self._looked += 1
        choices = making.choices()
        if not len(choices.rows):
            none = np.zeros(0)
            return Decision(choices, none, none, 0.0, none, none, none)
        outlook = self.maker.outlook
        seen = sight(making, choices)
        likes = self.maker.judged(making, seen, choices).astype(float)
        chance = np.exp((likes - likes.max()) / self.heat)
        chance /= chance.sum()
        return Decision(
            choices,
            likes,
            chance,
            1.0,
            seen.makespan * outlook.scale,
            units + outlook.harder[choices.rows],
            seen.worth * outlook.scale + outlook.exchange * units,
        )


def _tell(way: list[tuple[Decision, int]], share: float) -> None:
    """Tells each decision on the way what share is left of the chance of the choice taken there."""
    for decision, at in reversed(way):
        decision.chance[at] *= share
        share = _left(decision)


def _left(decision: Decision) -> float:
    """What share of its chances is left since it was last told."""
    before, decision.left = decision.left, float(decision.chance.sum())
    return decision.left / before if before else 0.0
