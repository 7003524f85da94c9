"""Cells that deciders are tried on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.files.load import load
from tandem.files.validate import cell_of

ROOT = Path(__file__).resolve().parents[2]

THESIS = load(ROOT / "examples" / "thesis.yaml")


def station(*, together: bool = False, zone: bool = False, limit: bool = False) -> Cell:
    """Four tasks for a robot and a human; with a joint way, a zone for one, or a limit of
    stress.
    """
    tasks: dict[str, Any] = {
        "a": {"time": {"robot": 3.0, "human": 4.0}, "stress": 2},
        "b": {"time": {"robot": 5.0, "human": 3.0}, "stress": 3},
        "c": {"time": {"robot": 4.0, "human": 2.0}, "after": ["a"], "stress": 1},
        "d": {"time": {"human": 3.0}, "after": ["b"], "stress": 1},
    }
    if together:
        tasks["d"]["together"] = [{"operators": ["robot", "human"], "time": 1.0}]
    if zone:
        tasks["a"]["zone"] = tasks["b"]["zone"] = "bench"
    human = {"kind": "human", "stress_limit": 4} if limit else {"kind": "human"}
    return cell_of(
        {
            "name": "Small station",
            "operators": {"robot": {"kind": "robot"}, "human": human},
            "tasks": tasks,
        }
    )
