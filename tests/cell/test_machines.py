"""Machines among the operators: they work as robots do and feel as little; what they hold."""

from __future__ import annotations

from typing import Any

import pytest

from tandem.errors import CellError
from tandem.files.validate import cell_of


def press(**machine: Any) -> dict[str, Any]:
    """Anna loads and unloads the press, which runs alone."""
    return {
        "operators": {"anna": {"kind": "human"}, "press": {"kind": "machine", **machine}},
        "tasks": {
            "load": {"together": [{"operators": ["anna", "press"], "time": 4}], "stress": 3},
            "run": {"time": {"press": 20}, "stress": 9, "after": ["load"]},
            "unload": {"time": {"anna": 3}, "stress": 1, "after": ["run"]},
        },
    }


def test_a_machine_feels_no_stress_and_is_neither_a_human_nor_a_robot() -> None:
    cell = cell_of(press())
    assert (cell.humans, cell.robots, cell.machines) == (("anna",), (), ("press",))
    assert cell.crew == {"human": ("anna",), "machine": ("press",)}
    assert [dict(cell.modes(name)[0].stress) for name in cell.tasks] == [
        {"anna": 3},
        {},
        {"anna": 1},
    ]


def test_stress_that_is_put_on_a_machine_is_refused() -> None:
    data = press(stress_limit=3)
    data["tasks"]["run"]["stress"] = {"press": 2}
    with pytest.raises(CellError) as caught:
        cell_of(data)
    limit, stress = sorted(fault.message for fault in caught.value.faults)
    assert limit == (
        "operator 'press' is a machine and has a stress_limit. Only humans have stress; take it"
        " out."
    )
    assert stress == (
        "task 'run': stress is stated for 'press', a machine. Only humans have stress; take"
        " 'press' out."
    )
