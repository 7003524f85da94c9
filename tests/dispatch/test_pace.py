"""What is learned of a person's pace."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dispatch.stations import THESIS

from tandem.dispatch.situation.model import Running, Situation, Work
from tandem.dispatch.situation.pace import estimate

PRIOR = {0.6: 0.2, 1.0: 0.2, 1.5: 0.2, 2.0: 0.2, 3.0: 0.2}
START = Situation.of(THESIS)


def after_work(*ratios: float) -> Situation:
    work = tuple(Work("3", ("human",), 0.0, 10 * ratio, 10.0, 0.0, "done") for ratio in ratios)
    return replace(START, now=100.0, past=work)


def test_before_anything_is_seen_the_prior_is_believed() -> None:
    pace = estimate(START, "human", PRIOR)
    assert dict(pace.shares) == pytest.approx(PRIOR)
    assert (pace.seen, pace.words) == (0, "not known yet")


def test_one_task_tells_the_pace_where_times_are_certain() -> None:
    assert estimate(after_work(2.0), "human", PRIOR).shares == ((2.0, 1.0),)


def test_what_is_still_going_on_rules_out_who_would_be_done() -> None:
    running = replace(START, now=16.0, running={"3": Running(("human",), 0.0, 10.0)})
    assert [factor for factor, _ in estimate(running, "human", PRIOR).shares] == [2.0, 3.0]


def test_slower_than_was_thought_possible_is_believed_too() -> None:
    running = replace(START, now=50.0, running={"3": Running(("human",), 0.0, 10.0)})
    assert estimate(running, "human", PRIOR).mean > 5


def test_rests_and_broken_work_say_nothing_of_the_pace() -> None:
    rested = replace(START, past=(Work("3", ("human",), 0.0, 30.0, 10.0, 20.0, "done"),))
    assert estimate(rested, "human", PRIOR).mean == pytest.approx(1.0, abs=0.01)
    broken = replace(START, past=(Work("3", ("human",), 0.0, 30.0, 10.0, 0.0, "broken off"),))
    assert estimate(broken, "human", PRIOR).seen == 0


def test_where_times_scatter_one_task_says_less() -> None:
    tasks = {name: task.model_copy(update={"spread": 0.3}) for name, task in THESIS.tasks.items()}
    vague = replace(after_work(2.0), cell=THESIS.replace(tasks=tasks))
    pace = estimate(vague, "human", PRIOR)
    assert pace.low < pace.mean < 2.0 < pace.high
    assert len(pace.shares) == 3


@settings(max_examples=50)
@given(st.lists(st.floats(0.3, 4.0), min_size=1, max_size=6))
def test_shares_are_probabilities_around_the_mean(ratios: list[float]) -> None:
    pace = estimate(after_work(*ratios), "human", PRIOR)
    assert sum(share for _, share in pace.shares) == pytest.approx(1.0)
    assert pace.low <= pace.mean <= pace.high
