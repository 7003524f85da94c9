"""A small cell with facts for limits of people: what each limit costs can be worked out by hand."""

from __future__ import annotations

from typing import Any

from tandem.cell.model import Cell
from tandem.files.validate import cell_of


def data(cycles: float | None = 100, **limits: float) -> dict[str, Any]:
    """Free, it takes 6 s: anna does base, the cobot close, anna cover. `limits` are anna's; names
    are spelled with `_` for `:` and `-` for nothing else.
    """
    named = {
        name.replace("_", ":").replace("time:above", "time-above"): limits[name] for name in limits
    }
    anna: dict[str, Any] = {"kind": "human", **({"limits": named} if named else {})}
    tasks = {
        "base": ({"anna": 4, "ben": 6, "cobot": 8}, 9, 0.001),
        "cover": ({"anna": 2, "ben": 3}, 4, 0.002),
        "close": ({"anna": 3, "cobot": 4}, 11, 0.003),
    }
    rows: dict[str, Any] = {
        name: {
            "time": times,
            "stress": 1,
            "ergonomics": [
                {"method": "reba", "score": reba},
                {"method": "lifft", "score": lifft},
            ],
        }
        for name, (times, reba, lifft) in tasks.items()
    }
    rows["cover"]["after"] = ["base"]
    return {
        "operators": {"anna": anna, "ben": {"kind": "human"}, "cobot": {"kind": "robot"}},
        "tasks": rows,
        **({} if cycles is None else {"cycles_per_shift": cycles}),
    }


def cell(cycles: float | None = 100, **limits: float) -> Cell:
    """The same as a cell."""
    return cell_of(data(cycles, **limits))


PRICES = (
    ({}, 6),
    ({"peak_reba": 8}, 8),  # anna lifts neither base nor close; ben takes 6 s for base
    ({"peak_reba": 9}, 6),
    ({"time_above_reba_9": 3.5}, 8),  # close alone would be allowed
    ({"time_above_reba_9": 4}, 6),
    ({"dose_lifft": 0.25}, 7),  # base or cover, not both: ben covers in 3 s
    ({"dose_lifft": 0.3}, 6),  # exactly both
    ({"dose_stress": 50}, 9),  # nothing at all: ben does base and cover
)
"""Limits of anna, and the least makespan that keeps them, s."""
