"""The round of each operator: what is done where in the cycle, and that nothing of a cycle is
lost.
"""

from __future__ import annotations

from collections.abc import Iterable
from decimal import Decimal

import pytest
from tests.draw.cycles import bench, bench_pattern, thesis_cycles
from tests.fuzz.cycles import drawn

from tandem.errors import CellError, InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan.cycle.methods import plan_cycle
from tandem.schedule.cycle import copied, start_up
from tandem.schedule.cycle_checker import faults
from tandem.schedule.measures import Changeover, Walk, changeovers, exact, walks, working
from tandem.schedule.steady import rounds


def test_the_bench_is_sound_so_that_what_is_drawn_of_it_means_something() -> None:
    assert faults(bench(), bench_pattern()) == []
    assert bench_pattern().in_process == 2


def test_a_round_is_in_the_order_of_the_cycle_and_says_of_which_product() -> None:
    ben = rounds(bench(), bench_pattern())["ben"]
    assert [(turn.assignment.task, turn.begin, turn.lap) for turn in ben.turns] == [
        ("label", 16, 1),
        ("check", 22, 0),
    ]


def test_the_first_changeover_of_a_cycle_is_from_the_last_tool_of_the_cycle_before() -> None:
    """The cobot begins a day with the gripper in hand and a cycle with the driver."""
    cobot = rounds(bench(), bench_pattern())["cobot"]
    assert [(turn.assignment.task, turn.ready.change, turn.ready.tool) for turn in cobot.turns] == [
        ("place", 2, "gripper"),
        ("lift", 0, ""),
        ("screw", 3, "driver"),
    ]
    assert (cobot.working, cobot.changing, cobot.idle) == (18, 5, 1)
    assert cobot.share(cobot.working) == 0.75


def test_who_does_nothing_is_idle_all_the_cycle() -> None:
    front = thesis_cycles()
    cell = front.cell.replace(
        operators={**front.cell.to_dict()["operators"], "spare": {"kind": "robot"}}
    )
    spare = rounds(cell, front[0].periodic)["spare"]
    assert (spare.turns, spare.working, spare.idle) == ((), 0, 19)


@pytest.mark.parametrize("seed", range(40))
def test_rounds_are_what_many_products_on_one_clock_do_in_the_middle(seed: int) -> None:
    """Work, walks and changeovers of one cycle, counted by the measures of schedules in the
    last cycle of many.
    """
    try:
        cell = cell_of(drawn(seed)[1])
        front = plan_cycle(cell, time_limit=20, workers=1)
    except (CellError, InfeasibleError):
        return
    for result in front:
        count = result.in_process + 3
        many = result.periodic.products(count, start_up(cell))
        several = copied(cell.replace(stress_of_set=None), count)
        begin = exact(start_up(cell)) + (count - 2) * exact(result.cycle_time)
        end = begin + exact(result.cycle_time)
        changes = _within(changeovers(several, many), begin, end)
        ways = _within(walks(several, many), begin, end)
        for name, own in rounds(cell, result.periodic).items():
            assert own.working == working(cell, result.schedule)[name]
            spent = own.working + own.walking + own.changing + own.idle
            assert spent == pytest.approx(result.cycle_time)
            assert own.idle >= 0
            assert own.changing == pytest.approx(changes.get(name, 0.0))
            assert own.walking == pytest.approx(ways.get(name, 0.0))


def _within(found: Iterable[Changeover | Walk], begin: Decimal, end: Decimal) -> dict[str, float]:
    """Seconds per operator of what ends in a span of time."""
    spent: dict[str, float] = {}
    for piece in found:
        if begin <= exact(piece.end) < end:
            spent[piece.operator] = spent.get(piece.operator, 0.0) + piece.end - piece.start
    return spent
