"""Whatever stands in a file of facts, it is scored and told, or refused in sentences."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random
from typing import Any

import pytest
from tests.ergonomics.test_ranges_and_order import ONE

from tandem.assessment import pages
from tandem.assessment.sentences import words
from tandem.cell.stated import Conditions
from tandem.ergonomics import METHODS, FactsError
from tandem.ergonomics.tasks import scored, totals
from tandem.errors import CellError, Fault
from tandem.files.facts.load import load_facts

ODD: tuple[Any, ...] = (
    None, [], {}, [1, 2], {"value": 3}, {"value": [1]}, {"value": 3, "unit": "xx"},
    {"value": 3, "source": 5}, {"value": None}, True, "x", "1e9", "nan", 1e308, -0.0, "12 lb",
    "=1+1", "", "ja", 10**30, "3 rad", "\u202e",
)  # fmt: skip


def document(draw: Random) -> dict[str, Any]:
    """Sound facts of some tasks, of which some are replaced by odd ones."""
    tasks: dict[str, Any] = {}
    for _ in range(draw.randint(1, 3)):
        method = draw.choice(list(METHODS))
        row: dict[str, Any] = {"method": method, **ONE[method]}
        if METHODS[method].sided:
            row["side"] = draw.choice(["left", "right", "both"])
        for _ in range(draw.choice([0, 0, 1, 2])):
            keys = [*row, "side", "minutes", "source", "date", "reps_per_cycle", "unit", "zzz"]
            row[draw.choice(keys)] = draw.choice(ODD)
        name = draw.choice(["a", "b", "c left", "1", "é"])
        tasks[name] = draw.choice([row, row, [row], [row], [row, row], []])
    found: dict[str, Any] = {"tasks": tasks}
    if draw.random() < 0.2:
        found[draw.choice(["name", "date", "cycles_per_shift", "operators"])] = draw.choice(ODD)
    return found


@pytest.mark.parametrize("block", range(4))
def test_odd_facts_are_told_or_refused_in_sentences(block: int, tmp_path: Path):
    draw, told = Random(block), 0
    faults: list[Fault] = []
    file = tmp_path / "facts.json"
    for _ in range(120):
        file.write_text(json.dumps(document(draw)))
        given = Conditions(cautious=draw.random() < 0.3, cycles=draw.choice([None, 420.0]))
        try:
            found = load_facts(file, given)
        except (FactsError, CellError) as error:
            faults += error.faults
            continue
        told += 1
        rows = [scored(task) for task in found.tasks]
        assert rows
        made = {"version": "0", "command": "tandem score"}
        whole = pages.Assessment(found.name, rows, totals(rows), made)
        t = words(draw.choice(["en", "de"]))
        assert pages.html(t, whole)
        assert pages.markdown(t, whole)
        json.loads(pages.json_text(t, whole), parse_constant=pytest.fail)
    assert told > 10
    assert len(faults) > 40
    assert all(fault.message and fault.place for fault in faults)
