"""When an operator gets ready: at once, in one piece, behind the breaks that would fall into it."""

from __future__ import annotations

from typing import Any

import pytest

from tandem.cell.parts import Operator
from tandem.errors import CellError
from tandem.files.validate import cell_of


@pytest.mark.parametrize(
    ("setup", "breaks", "when"),
    [
        (5, [], (0, 5)),
        (5, [[5, 9]], (0, 5)),
        (5, [[4, 9]], (9, 14)),
        (5, [[0, 2]], (2, 7)),
        (5, [[20, 30], [3, 4], [8.5, 9]], (9, 14)),
        (0.3, [[0.1, 0.2]], (0.2, 0.5)),
        (5, [[1, 3], [3, 7]], (7, 12)),
    ],
)
def test_it_is_ready_behind_the_first_piece_of_time_that_is_long_enough(
    setup: float, breaks: list[list[float]], when: tuple[float, float]
) -> None:
    operator = Operator(
        kind="human", setup=float(setup), breaks=[(float(a), float(b)) for a, b in breaks]
    )
    assert operator.setting_up == when
    first, *later = operator.times_off
    assert first == (0, when[1], "setup")
    assert [off[:2] for off in later] == sorted((a, b) for a, b in breaks if a >= when[1])


def test_who_needs_no_time_to_get_ready_is_off_in_breaks_alone() -> None:
    operator = Operator(kind="robot", breaks=[(5.0, 6.0), (1.0, 2.0)])
    assert operator.setting_up is None
    assert operator.times_off == ((1, 2, "break"), (5, 6, "break"))


def cell_with(setup: Any, **task: Any) -> dict[str, Any]:
    return {
        "operators": {"anna": {"kind": "human", "setup": setup}},
        "tasks": {"base": {"time": {"anna": 3}, **task}},
    }


@pytest.mark.parametrize(
    ("setup", "sentence"),
    [
        (-1, "setup is -1, but must be 0 or more"),
        ("soon", "setup is 'soon', but a number is needed"),
        (1.0000001, "1.0000001 has more than 6 decimals"),
    ],
)
def test_a_setup_that_is_no_time_is_refused_at_its_place(setup: Any, sentence: str) -> None:
    with pytest.raises(CellError, match=f"^- operators.anna.setup: .*{sentence}"):
        cell_of(cell_with(setup))


def test_a_deadline_before_anybody_is_ready_is_refused() -> None:
    with pytest.raises(CellError, match=r"ends at 7 s at the soonest around the setups"):
        cell_of(cell_with(4, deadline=6))
    assert cell_of(cell_with(4, deadline=7)).operators["anna"].setup == 4


def test_a_cell_without_setup_stays_the_same_cell() -> None:
    assert (
        cell_of(cell_with(0)).digest
        == cell_of({**cell_with(0), "operators": {"anna": {"kind": "human"}}}).digest
    )
