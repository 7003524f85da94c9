"""Two schedules over each other: what moved is marked, what stayed is not."""

from __future__ import annotations

from tests.draw.cells import gearbox, gearbox_front, thesis, thesis_schedules

from tandem.draw.compare import changes, plot_compare, summary
from tandem.schedule.model import Schedule

QUICK, KNEE, GENTLE = thesis_schedules()


def kinds(before: Schedule, after: Schedule) -> dict[str, str]:
    return {change.task: change.kind for change in changes(before, after)}


def test_every_task_is_said_to_have_moved_shifted_or_stayed() -> None:
    assert kinds(QUICK, KNEE) == {
        "1": "same",
        "2": "same",
        "3": "same",
        "4": "same",
        "5": "moved",
        "6": "same",
        "7": "shifted",
    }
    assert set(kinds(QUICK, QUICK).values()) == {"same"}
    without = Schedule(tuple(a for a in QUICK if a.task != "7"))
    assert kinds(QUICK, without)["7"] == "dropped"
    assert kinds(without, QUICK)["7"] == "added"


def test_the_summary_says_what_it_costs_and_gains() -> None:
    assert (
        summary(thesis(), QUICK, KNEE)
        == "makespan 23 → 24 s (+1), stress 7 → 3 (−4); tasks: 1 moved, 1 shifted"
    )
    assert (
        summary(thesis(), KNEE, KNEE)
        == "makespan 24 s as before, stress 3 as before; tasks: none changed"
    )


def test_moved_tasks_are_marked_in_both_and_joined_by_an_arrow() -> None:
    ax = plot_compare(thesis(), QUICK, GENTLE)
    gids = [patch.get_gid() for patch in ax.patches if patch.get_gid()]
    assert sorted(g for g in gids if g.startswith("move ")) == ["move 5", "move 6"]
    assert {g for g in gids if g.startswith("changed ")} == {
        "changed 5 human",
        "changed 5 robot",
        "changed 6 human",
        "changed 6 robot",
    }
    assert len([g for g in gids if g.startswith("task ")]) == 14
    assert len(ax.get_yticks()) == 4


def test_joint_tasks_count_once() -> None:
    front = gearbox_front()
    ax = plot_compare(gearbox(), front[0].schedule, front[len(front) - 1].schedule)
    moved = [
        change.task
        for change in changes(front[0].schedule, front[len(front) - 1].schedule)
        if change.kind == "moved"
    ]
    assert sorted(
        patch.get_gid() for patch in ax.patches if (patch.get_gid() or "").startswith("move ")
    ) == sorted(f"move {task}" for task in moved)
    assert moved


def test_it_speaks_german_and_names_both_plans() -> None:
    ax = plot_compare(thesis(), QUICK, KNEE, language="de")
    said = [ax.get_title(loc="left"), *(text.get_text() for text in ax.texts)]
    assert said[0].startswith("Dauer 23 → 24 s (+1), Belastung 7 → 3 (−4)")
    for schedule in (QUICK, KNEE):
        assert any(f"Plan {schedule.digest}" in text for text in said)
    assert ax.get_xlabel() == "Zeit [s]"
