"""One look for everything: colours that can be told apart, letters that are one's own, numbers as
people write them.
"""

from __future__ import annotations

import pytest
from tests.draw.cells import gearbox, layered, thesis

from tandem.cell.model import Cell
from tandem.cell.written import number, share
from tandem.draw.style import FAINT_INK, INK, contrast, looks, shorten


def cell_of(*operators: tuple[str, str]) -> Cell:
    return Cell.model_validate(
        {
            "operators": {name: {"kind": kind} for name, kind in operators},
            "tasks": {"a": {"time": {name: 1 for name, _ in operators}}},
        }
    )


def test_an_operators_look_does_not_depend_on_the_tasks() -> None:
    other = thesis().replace(tasks={"x": {"time": {"human": 1, "robot": 2}}})
    assert looks(other) == looks(thesis())


def test_looks_of_many_operators_are_all_different() -> None:
    shown = looks(cell_of(*((f"{kind}{i}", kind) for kind in ("human", "robot") for i in range(8))))
    assert len({(look.kind, look.colour, look.hatch) for look in shown.values()}) == 16
    assert len({look.letters for look in shown.values()}) == 16


def test_letters_are_short_and_ones_own() -> None:
    assert [look.letters for look in looks(gearbox()).values()] == ["A", "B", "C1", "C2"]
    assert [look.letters for look in looks(layered(3)).values()] == ["H1", "R1", "H2", "R2"]
    assert [
        look.letters
        for look in looks(cell_of(("robot", "robot"), ("rita", "human"), ("R1", "human"))).values()
    ] == ["R1", "R2", "R3"]


def test_robots_are_hatched_and_text_reads_on_every_fill() -> None:
    shown = looks(cell_of(*((f"{kind}{i}", kind) for kind in ("human", "robot") for i in range(4))))
    assert all(bool(look.hatch) for look in shown.values() if look.kind == "robot")
    assert looks(thesis())["human"].hatch == ""
    assert all(contrast(INK, look.tint) >= 4.5 for look in shown.values())
    assert contrast(FAINT_INK, "#FFFFFF") >= 4.5
    assert contrast("#000000", "#FFFFFF") == pytest.approx(21)


def test_numbers_are_written_as_people_write_them() -> None:
    assert [number(x) for x in (23.0, 4.65, 0.1 + 0.2, 1e7, 0.0)] == [
        "23",
        "4.65",
        "0.3",
        "10000000",
        "0",
    ]
    assert [share(x) for x in (0.5, 0.043, 1.0, 0.0, 0.9999)] == [
        "50 %",
        "4.3 %",
        "100 %",
        "0 %",
        "100 %",
    ]
    assert [shorten(x, 5) for x in ("short", "longer")] == ["short", "long…"]
