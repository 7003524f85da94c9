"""What the exact planner begins from beside the dispatch rules: the policy for any cell."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from time import monotonic

import pytest

from tandem.errors import UsageError
from tandem.files.generators import layered
from tandem.files.validate import cell_of
from tandem.learn.graph import method
from tandem.plan import opening
from tandem.plan.exact import solve
from tandem.plan.goal import Meter
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.method import Progress
from tandem.plan.opening import (
    EACH_S,
    LEAST_OF_FRONT_S,
    LEAST_S,
    OF_ONE,
    OPENINGS,
    SHARE,
    WORK_S,
    opened,
)
from tandem.plan.question import Question
from tandem.plan.starts import Starts, measures
from tandem.schedule.checker import faults

QUICKEST, FRONT = Question("makespan"), Question()
LARGE = layered(OF_ONE.start, 2, 2, seed=3)
LAYOUT = Layout.of(Instance.of(LARGE))


def never() -> bool:
    return False


def asked(layout: Layout, question: Question, work: float = 1000.0) -> int:
    """How many schedules are made within so much work."""
    return len(list(opened(layout, question, None, Meter(work))))


def values(question: Question) -> list[tuple[int, int]]:
    return [measures(LAYOUT.instance, starts) for starts in method.opening(LAYOUT, question, never)]


@pytest.mark.parametrize(("question", "least"), [(QUICKEST, LEAST_S), (FRONT, LEAST_OF_FRONT_S)])
def test_it_is_asked_where_there_is_time_for_it(question: Question, least: float) -> None:
    assert list(OPENINGS) == ["learned"]
    enough = least * len(LARGE.tasks)
    assert asked(LAYOUT, question, 0.9 * enough / WORK_S) == 0
    assert asked(LAYOUT, question, 1.1 * enough / WORK_S) >= 1
    assert len(list(opened(LAYOUT, question, None, None))) == asked(LAYOUT, question)
    assert list(opened(LAYOUT, question, monotonic() + 0.9 * enough, None)) == []


def test_what_it_takes_is_work_that_counts() -> None:
    meter, tasks = Meter(0.5), len(LARGE.tasks)
    made = len(list(opened(LAYOUT, FRONT, None, meter)))
    assert made == int(SHARE * WORK_S * 0.5 / (EACH_S * tasks))
    assert meter.left == pytest.approx(0.5 - made * EACH_S * tasks / WORK_S)


@pytest.mark.parametrize(("sizes", "question"), [("OF_ONE", QUICKEST), ("OF_FRONT", FRONT)])
def test_each_question_has_its_sizes(
    monkeypatch: pytest.MonkeyPatch, sizes: str, question: Question
) -> None:
    assert getattr(opening, sizes).start <= len(LARGE.tasks) < getattr(opening, sizes).stop
    monkeypatch.setattr(opening, sizes, range(len(LARGE.tasks) + 1, 1000))
    assert asked(LAYOUT, question) == 0


def test_a_front_gets_a_schedule_at_each_weight_the_first_ones_far_from_each_other() -> None:
    found = values(FRONT)
    assert len(found) == 14
    quick, middle = found[:2]
    assert quick == min(found)
    assert quick[0] < middle[0]
    assert middle[1] < quick[1]
    # those between come later: both sides of the middle are seen before any neighbours
    assert found[2][1] > middle[1] > found[3][1]


def test_where_all_ways_have_the_same_stress_one_schedule_is_made() -> None:
    data = LARGE.to_dict()
    for task in data["tasks"].values():
        task.pop("stress", None)
    layout = Layout.of(Instance.of(cell_of(data)))
    assert asked(layout, FRONT) == asked(layout, QUICKEST) == 1


def test_a_weight_of_stress_is_its_weight_and_open_limits_are_left_to_the_rules() -> None:
    (quick,), (easy,) = values(QUICKEST), values(Question("weighted", (1.0, 5.0)))
    assert easy[1] < quick[1]
    assert quick[0] < easy[0]
    assert values(Question("makespan", max_stress=100.0)) == []
    assert values(Question("stress")) == []


def test_the_exact_planner_begins_no_worse_than_the_policy(monkeypatch: pytest.MonkeyPatch) -> None:
    ((ticks, _),) = values(QUICKEST)
    makespan = LAYOUT.instance.seconds(ticks)
    assert soonest(lambda found: found <= makespan) == makespan
    # by the rules alone it begins from something else
    monkeypatch.setattr(opening, "OF_ONE", range(0))
    assert soonest(lambda _: True) > makespan


def soonest(stops: Callable[[float], bool]) -> float:
    """The least makespan when it stops for the first time."""

    def hear(progress: Progress) -> None:
        if stops(progress.found[0].makespan):
            raise KeyboardInterrupt

    return solve(LARGE, QUICKEST, work=0.2, on_solution=hear)[0].makespan


def test_a_front_begins_from_all_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    front = solve(LARGE, FRONT, work=1.0)
    found = [(round(one.makespan), round(one.stress)) for one in front]
    unit = LAYOUT.instance.per_second, LAYOUT.instance.per_stress
    for ticks, units in values(FRONT):
        makespan, stress = ticks / unit[0], units / unit[1]
        assert any(m <= makespan and s <= stress for m, s in found)
    monkeypatch.setattr(opening, "OF_FRONT", range(0))
    assert len(solve(LARGE, FRONT, work=1.0)) < len(front)


def test_what_the_checker_refuses_is_no_beginning(monkeypatch: pytest.MonkeyPatch) -> None:
    def all_at_once(*_: object) -> Iterator[Starts]:
        yield ((0, 0),) * len(LARGE.tasks)

    monkeypatch.setattr(opening, "OPENINGS", {"mine": all_at_once})
    # it would be the quickest by far
    (found,) = solve(LARGE, QUICKEST, work=0.2)
    assert faults(LARGE, found.schedule) == []


def test_a_package_that_cannot_be_loaded_keeps_nobody_from_planning(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Broken(dict[str, Callable[..., Iterator[Starts]]]):
        def __getitem__(self, name: str) -> Callable[..., Iterator[Starts]]:
            raise UsageError(f"{name} cannot be loaded")

    monkeypatch.setattr(opening, "OPENINGS", Broken(mine=method.opening))
    assert asked(LAYOUT, QUICKEST) == 0
