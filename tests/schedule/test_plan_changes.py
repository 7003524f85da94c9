"""What counts as a change between two plans."""

from __future__ import annotations

import pytest

from tandem.schedule.changes import changes
from tandem.schedule.model import Assignment, Schedule


def plan(**rows: tuple[str, float]) -> Schedule:
    """Tasks of two seconds: `a=("anna", 0)`; operators joined by a plus."""
    return Schedule(
        tuple(
            Assignment(start, start + 2, task, tuple(who.split("+")))
            for task, (who, start) in rows.items()
        )
    )


OLD = plan(a=("anna", 0), b=("anna", 2), c=("anna", 4), d=("cobot", 0))


def whats(before: Schedule, after: Schedule, tolerance: float = 5.0) -> dict[str, str]:
    return {changed.task: changed.what for changed in changes(before, after, tolerance).changed}


def test_a_plan_is_the_same_as_itself() -> None:
    found = changes(OLD, OLD)
    assert (found.changed, found.new, found.gone, found.same) == ((), (), (), 4)


def test_neighbours_that_swap_have_both_changed_order() -> None:
    swapped = plan(a=("anna", 2), b=("anna", 0), c=("anna", 4), d=("cobot", 0))
    assert whats(OLD, swapped) == {"a": "order", "b": "order"}


def test_who_goes_to_another_operator_changes_nobodys_order() -> None:
    given_away = plan(a=("anna", 0), b=("cobot", 2), c=("anna", 2), d=("cobot", 0))
    assert whats(OLD, given_away) == {"b": "operator"}


def test_a_task_done_together_now_has_other_operators_and_still_orders_those_who_stay() -> None:
    together = plan(a=("anna+cobot", 4), b=("anna", 0), c=("anna", 2), d=("cobot", 0))
    assert whats(OLD, together) == {"a": "operator", "b": "order", "c": "order"}


@pytest.mark.parametrize(("tolerance", "moved"), [(0, True), (0.5, True), (0.6, False), (5, False)])
def test_a_start_may_move_by_the_tolerance(tolerance: float, moved: bool) -> None:
    later = plan(a=("anna", 0), b=("anna", 2), c=("anna", 4.6), d=("cobot", 0))
    assert whats(OLD, later, tolerance) == ({"c": "start"} if moved else {})


def test_new_tasks_and_gone_ones_are_named_and_not_counted() -> None:
    other = plan(e=("anna", 0), b=("anna", 2), c=("anna", 4), d=("cobot", 0))
    found = changes(OLD, other)
    assert (found.new, found.gone) == (("e",), ("a",))
    assert found.counts == (0, 0, 0)
