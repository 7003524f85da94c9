"""Deciders and their time: they limit their work, which is counted, and whoever waits for them
does not wait for ever.
"""

from __future__ import annotations

import gc
import threading
import weakref
from collections.abc import Iterator
from dataclasses import dataclass, field

import pytest
from tests.dispatch.cells import GEARBOX, Plain, in_time
from tests.dispatch.stations import THESIS

from tandem.cell.model import Cell
from tandem.dispatch.deciders.memory import settled_memory
from tandem.dispatch.deciders.policy import Decision, Options
from tandem.dispatch.deciders.replan import plain
from tandem.dispatch.deciders.robust import WARMING, Robust
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.lookahead.branch_and_bound import (
    A_SET,
    QUICKEST,
    SLOWEST,
    BranchAndBound,
    measured,
)
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.lookahead.residual import rest, sketch, solve
from tandem.dispatch.lookahead.transitions import Moves
from tandem.dispatch.lookahead.work import OutOfWorkError, Work
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.pace import estimates
from tandem.errors import UsageError
from tandem.files.generators import layered

WIDE = layered(30, 2, 2, seed=3)
"""At its beginning 3,507 sets of ways can be begun, each of which is a step of the search."""


@pytest.mark.parametrize("limit", [0, 1, 17, 200, 2000])
def test_a_search_does_no_more_work_than_it_may(limit: int) -> None:
    moves, work = Moves.of(WIDE), Work(limit)
    with pytest.raises(OutOfWorkError):
        BranchAndBound(moves, (1.0, 0.0), work).value(moves.root())
    assert limit - A_SET * 4000 <= work.done <= limit, "it stops before the step that is too much"


def test_putting_the_choices_together_is_counted_too() -> None:
    """Before the first of thousands of choices is there."""
    moves = Moves.of(WIDE)
    search = BranchAndBound(moves, (1.0, 0.0), Work(5))
    with pytest.raises(OutOfWorkError):
        next(moves.choices(moves.root(), look=search.look))


def test_a_search_that_may_do_enough_is_not_changed_by_counting() -> None:
    moves = Moves.of(THESIS)
    free, counted = (BranchAndBound(moves, (0.001, 0.0), Work(*limit)) for limit in ((), (500,)))
    assert free.value(moves.root()) == counted.value(moves.root()) == 23
    assert 0 < free.work.done == counted.work.done < 500


def test_what_is_known_before_is_read_and_never_changed() -> None:
    moves = Moves.of(THESIS)
    first = BranchAndBound(moves, (0.001, 0.0))
    first.value(moves.root())
    known = first.learned()
    sizes = [len(part) for part in known]
    again = BranchAndBound(moves, (0.001, 0.0), Work(0), known)
    assert again.value(moves.root()) == 23
    assert again.work.done == 0
    assert [len(part) for part in known] == sizes


@pytest.mark.parametrize("limit", [0, 3, 400, 1000])
def test_valuing_choices_under_many_beliefs_stops_at_its_limit(limit: int) -> None:
    """Numbers for each belief, bounds for each choice, values: all of it is counted."""
    work = Work(limit)
    situation = Situation.of(WIDE)
    with pytest.raises(OutOfWorkError):
        cold(WIDE).ranked(situation, estimates(situation, Options().prior), work)
    assert work.done <= limit


def cold(cell: Cell, **options: float) -> Robust:
    """A decider that valued nothing before the shift."""
    made = plain(cell, SECONDS, Options(**options))
    return Robust(made.models, SECONDS, made.options, made.rule)


def test_a_decision_with_hardly_any_work_is_the_plan_of_a_rule() -> None:
    """No belief is valued to its end; one list schedule there always is."""
    decision = cold(WIDE, budget_ms=1.0, steps_per_ms=1.0).decide(Situation.of(WIDE))
    assert "the best plan found" in decision.why
    assert decision.asks or decision.starts


def test_a_plan_with_hardly_any_work_is_the_one_it_began_with() -> None:
    moves = Moves.of(layered(20, seed=5))
    left = rest(moves, moves.root())
    assert left is not None
    hint = sketch(moves, moves.root(), (1.0, 0.0), samples=1)
    assert hint is not None
    assert solve(left, (1.0, 0.0), work_s=1e-9, hint=hint) == hint
    assert solve(left, (1.0, 0.0), work_s=1e-9) is None


def test_a_plan_of_the_thesis_s_cell_is_the_optimum_and_repeats() -> None:
    moves = Moves.of(THESIS)
    left = rest(moves, moves.root())
    assert left is not None
    plans = [solve(left, (1.0, 0.0), work_s=0.01) for _ in range(2)]
    assert plans[0] == plans[1]
    assert plans[0] is not None
    assert (plans[0].ticks, plans[0].proven) == (23 * moves.instance.per_second, True)


def test_more_list_schedules_are_never_worse_and_repeat() -> None:
    moves = Moves.of(layered(30, 2, 2, seed=3))
    ticks = []
    for samples in (1, 4, 10, 40):
        plans = [sketch(moves, moves.root(), (1.0, 0.0), samples=samples, seed=7) for _ in range(2)]
        assert plans[0] == plans[1]
        assert plans[0] is not None
        ticks.append(plans[0].ticks)
    assert ticks == sorted(ticks, reverse=True)
    assert ticks[-1] < ticks[0]


def test_what_a_millisecond_buys_is_measured_within_reason() -> None:
    assert SLOWEST <= measured() <= QUICKEST
    with pytest.raises(UsageError, match="0 steps in a millisecond"):
        Options(steps_per_ms=0.0)


def test_values_from_before_the_shift_are_those_of_that_work_alone() -> None:
    """They are the same in every process, and so are the decisions that read them."""
    made = [policy("replan-robust", GEARBOX) for _ in range(2)]
    first, second = (one for one in made if isinstance(one, Robust))
    assert first.before == second.before
    assert first.before
    assert sum(len(known.values) for known in first.before.values()) < WARMING


@pytest.fixture
def nothing_aside() -> Iterator[None]:
    """As a command finds its process: `tests/conftest.py` sets the objects of the suite aside."""
    gc.unfreeze()
    yield
    gc.freeze()


@pytest.mark.usefixtures("nothing_aside")
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


def test_what_a_program_had_set_aside_stays_aside() -> None:
    gc.freeze()
    before = gc.get_freeze_count()
    with settled_memory():
        made = [[number] for number in range(5000)]
    assert gc.get_freeze_count() >= before
    assert (gc.isenabled(), len(made)) == (True, 5000)


@pytest.mark.usefixtures("nothing_aside")
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
    asker.settle()
    assert not thread.is_alive()
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
