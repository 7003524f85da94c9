"""A lot in a shift: an idle robot or person begins the next product while the others finish the
last. A lot is a cell, so every decider that can hold its size takes it.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from tests.dispatch.cells import GEARBOX, line
from tests.dispatch.test_decisions_agree import agrees
from tests.dispatch.test_repeats import ODD, ROUGH, events

from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import POLICIES
from tandem.dispatch.journal import Journal
from tandem.dispatch.shift.deadline import InTime
from tandem.dispatch.shift.documents import Document
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.shift.replay import replay
from tandem.dispatch.shift.simulated import SimulatedFloor
from tandem.dispatch.situation.model import Situation
from tandem.files.lot import lot

PAIR = lot({"1": GEARBOX, "2": GEARBOX})
"""Eight tasks. One gearbox takes 11 s, and the cobot is idle while anna ends the shaft."""
OPTIONS = Options(budget_ms=20.0, steps_per_ms=20.0)


def decider(settings: Settings) -> InTime:
    """The decider of single gearboxes and of pairs, with a guard that a busy machine never
    needs.
    """
    made = settings.decider(GEARBOX, {"pair": PAIR})
    return InTime(made.policy, made.rule, 60_000.0)


def opened(journal: Journal, settings: Settings) -> Shift:
    shift = Shift.open(
        GEARBOX, journal, settings, decider=decider(settings), variants={"pair": PAIR}
    )
    assert isinstance(shift, Shift)
    return shift


def overlap(there: Situation) -> bool:
    """Each of the two has begun before the other is done."""
    spans = [
        [(work.start, work.end) for task, work in there.done.items() if task.startswith(product)]
        for product in ("1/", "2/")
    ]
    begins = [min(start for start, _ in span) for span in spans]
    return max(begins) < min(max(end for _, end in span) for span in spans)


@pytest.mark.parametrize("name", [name for name in POLICIES if name != "learned"])
def test_who_is_idle_begins_the_next_product(name: str) -> None:
    """Beside somebody who does as asked, at the stated times; two alone would take 22 s."""
    with Journal() as journal:
        shift = opened(journal, Settings(name, options=OPTIONS, products=0))
        shift.take(line("product", 0, variant="pair", order="A-17, A-18"))
        floor = SimulatedFloor(PAIR, "compliant")
        for text in events(shift, floor):
            for document in shift.take(text)[1:]:
                agrees(shift, document)
        assert shift.situation.is_over
        assert overlap(shift.situation)
        if name not in ("random", "minimax", "least-stress", "weighted", "balanced"):
            assert shift.situation.makespan < 22


@pytest.mark.parametrize("name", ["auto", "replan", "replan-robust", "fixed", "longest-tail"])
def test_pairs_and_single_ones_cut_off_again_and_again_are_decided_identically(
    name: str, tmp_path: Path
) -> None:
    """A single one, a pair, a single one; each process takes ten lines, then is gone."""
    settings = Settings(name, options=OPTIONS)
    lines = [line("product", 0, variant="pair", id="mes-1"), line("product", 0, id="mes-2")]
    with Journal() as journal:
        whole = opened(journal, settings)
        for text in lines:
            whole.take(text)
        floor = SimulatedFloor(GEARBOX, ODD, ROUGH, 5, {"pair": PAIR})
        for text in events(whole, floor):
            lines.append(text)
            whole.take(text)
        assert whole.situation.products_done == 3
        decisions = [told(entry.decision) for entry in journal.entries()]
    path = tmp_path / "shift.db"
    for first in range(0, len(lines), 10):
        with Journal(path) as journal:
            shift = opened(journal, settings)
            for text in lines[first : first + 10]:
                shift.take(text)
    assert shift.situation == whole.situation
    with Journal(path, read_only=True) as journal:
        assert [told(entry.decision) for entry in journal.entries()] == decisions
        assert replay(GEARBOX, journal, decider=decider(settings)).differences == ()


def told(decision: Mapping[str, Any] | None) -> Document:
    """The decision without how long it took."""
    return {key: value for key, value in (decision or {}).items() if key != "latency_ms"}
