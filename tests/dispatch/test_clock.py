"""Deciders and the clock: whatever they are at, they stop when the time is over. The clocks here
count looks, not seconds.
"""

from __future__ import annotations

import gc
import threading
import weakref
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf

import pytest
from tests.dispatch.cells import GEARBOX, Plain, in_time
from tests.dispatch.stations import THESIS

from tandem.cell.model import Cell
from tandem.dispatch.deciders.memory import settled_memory
from tandem.dispatch.deciders.policy import Decision, Options
from tandem.dispatch.deciders.replan import Robust, plain, robust
from tandem.dispatch.lookahead.branch_and_bound import (
    EVERY,
    MOST_KNOWN,
    BranchAndBound,
    OutOfTimeError,
)
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.lookahead.residual import rest, solve
from tandem.dispatch.lookahead.transitions import Moves
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.pace import estimates
from tandem.files.generators import layered

WIDE = layered(30, 2, 2, seed=3)
"""At its beginning 3,507 sets of ways can be begun, each of which is a step of the search."""


@dataclass
class Looks:
    """A clock that goes on by one whenever somebody looks at it."""

    at: int = 0

    def __call__(self) -> float:
        self.at += 1
        return float(self.at)


def wide_search(clock: Looks, until: float) -> BranchAndBound:
    return BranchAndBound(Moves.of(WIDE), (1.0, 0.0), clock=clock).by(until)


@pytest.mark.parametrize("until", [0, 1, 17, 200])
def test_a_search_makes_no_more_than_a_few_positions_after_its_time(until: int) -> None:
    clock = Looks()
    search = wide_search(clock, until)
    with pytest.raises(OutOfTimeError):
        search.value(search.moves.root())
    assert clock.at == until + 1, "the first look that is too late ends it"
    assert search._made <= EVERY * (until + 1), "so few positions lie between two looks"


def test_putting_the_choices_together_looks_at_the_clock_too() -> None:
    """Before the first of thousands of choices is there."""
    clock = Looks()
    search = wide_search(clock, 5)
    with pytest.raises(OutOfTimeError):
        next(search.moves.choices(search.moves.root(), look=search.look))
    assert clock.at == 6


def test_a_search_that_has_time_is_not_changed_by_its_looks() -> None:
    def value(search: BranchAndBound) -> float:
        return search.value(search.moves.root())

    assert (
        value(BranchAndBound(Moves.of(THESIS), (0.001, 0.0)))
        == value(BranchAndBound(Moves.of(THESIS), (0.001, 0.0), clock=Looks()).by(inf))
        == 23
    )


@pytest.mark.parametrize("until", [0, 3, 40])
def test_valuing_choices_under_many_beliefs_stops_in_time(until: int) -> None:
    """Numbers for each belief, bounds for each choice, values: a look at the clock everywhere
    between.
    """
    clock = Looks()
    decider = robust_without_warming_up(WIDE, clock)
    situation = Situation.of(WIDE)
    with pytest.raises(OutOfTimeError):
        decider.ranked(situation, estimates(situation, Options().prior), until)
    assert clock.at == until + 1


def robust_without_warming_up(cell: Cell, clock: Looks, **known: float) -> Robust:
    made = plain(cell, SECONDS, Options(budget_ms=1000.0 * 10))
    return Robust(made.models, SECONDS, made.options, made.rule, clock=clock, **known)


def test_a_decision_without_time_is_a_rule_s() -> None:
    """Ten looks are the whole budget: no belief is valued to its end, no plan is made, the rule
    answers.
    """
    decision = robust_without_warming_up(WIDE, Looks()).decide(Situation.of(WIDE))
    assert "by a rule" in decision.why
    assert decision.asks or decision.starts


@pytest.mark.parametrize("known", [{"building_s": 1e6}, {"building_s": 1e6, "moves_s": 1e6}])
def test_what_cannot_be_cut_short_is_not_begun_without_the_time_for_it(
    known: dict[str, float],
) -> None:
    clock = Looks()
    decision = robust_without_warming_up(WIDE, clock, **known).decide(Situation.of(WIDE))
    assert "by a rule" in decision.why
    if "moves_s" in known:
        assert clock.at == 2, "when it began, and whether there is time to plan: nothing was valued"


def test_a_plan_without_time_is_none() -> None:
    moves = Moves.of(THESIS)
    left = rest(moves, moves.root())
    assert left is not None
    assert solve(left, (1.0, 0.0), seconds=0.0) is None
    found = solve(left, (1.0, 0.0), seconds=20.0)
    assert found is not None
    assert found.ticks == 23 * moves.instance.per_second


def test_the_memory_of_searches_is_forgotten_bit_by_bit() -> None:
    """Forgetting all at once takes longer than a decision may."""
    decider = robust(GEARBOX, SECONDS, Options(budget_ms=1000.0))
    situation = Situation.of(GEARBOX)
    before = 0
    for factor in range(100):
        decider._under(situation, (("anna", 1.0 + factor / 100),), inf)
        assert len(decider._searches) >= before, "one goes when one comes"
        before = len(decider._searches)
    assert before <= 40
    assert MOST_KNOWN <= 50_000


def test_what_exists_before_a_shift_is_left_out_of_collections_within_it() -> None:
    assert gc.isenabled()
    with settled_memory() as settle:
        before = gc.get_freeze_count()
        assert before > 1000, "what exists is set aside"
        assert not gc.isenabled(), "no collection comes by itself"
        made = [[number] for number in range(5000)]
        settle()
        assert gc.get_freeze_count() > before + 4000, "and so is what came since"
        assert len(made) == 5000
    assert (gc.isenabled(), gc.get_freeze_count()) == (True, 0)


def test_circles_of_garbage_are_collected_between_decisions() -> None:
    class Circle:
        def __init__(self) -> None:
            self.own = self

    with settled_memory() as settle:
        gone = weakref.ref(Circle())
        assert gone() is not None
        settle()
        assert gone() is None


def test_memory_is_as_it_was_when_a_shift_is_interrupted() -> None:
    with pytest.raises(KeyboardInterrupt), settled_memory():
        raise KeyboardInterrupt
    assert (gc.isenabled(), gc.get_freeze_count()) == (True, 0)


@dataclass
class Slow:
    """Answers when it is let go."""

    name: str = "slow"
    go: threading.Event = field(default_factory=threading.Event)

    def decide(self, situation: Situation) -> Decision:
        self.go.wait(30)
        return Plain().decide(situation)


def deciding() -> Iterator[threading.Thread]:
    return (thread for thread in threading.enumerate() if thread.name == "decider")


def test_no_thread_is_left_behind_by_decisions_in_time() -> None:
    assert list(deciding()) == []
    for _ in range(30):
        asker = in_time()
        assert [asker.decide(Situation.of(GEARBOX)).instead for _ in range(3)] == ["", "", ""]
    assert list(deciding()) == []


def test_a_late_decider_has_one_thread_which_ends_with_its_answer() -> None:
    slow = Slow()
    asker = in_time(slow, budget_ms=20.0)
    assert [asker.decide(Situation.of(GEARBOX)).instead for _ in range(5)] == ["late"] * 5
    [thread] = deciding()
    slow.go.set()
    thread.join(30)
    assert list(deciding()) == []
    asker.budget_ms = 60_000.0
    assert asker.decide(Situation.of(GEARBOX)).instead == ""


def test_a_decider_that_fails_leaves_no_thread_either() -> None:
    class Failing:
        name = "failing"

        def decide(self, situation: Situation) -> Decision:
            raise ValueError("no idea")

    assert in_time(Failing()).decide(Situation.of(GEARBOX)).instead == "failed"
    assert list(deciding()) == []
