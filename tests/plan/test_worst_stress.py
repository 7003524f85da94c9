"""The least stress of whoever has most, against every schedule that there is."""

from __future__ import annotations

from itertools import product
from random import Random

import pytest
from tests.fuzz.cells import cell as random_cell

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError
from tandem.files.generators import layered
from tandem.files.validate import cell_of
from tandem.plan.question import Question
from tandem.schedule.checker import faults


def _worst_of_all(cell: Cell) -> float:
    """The least worst stress of any allocation that keeps the cell's rules on who does what; for
    cells in which every allocation has a schedule.
    """
    worst = []
    for modes in product(*(cell.modes(name) for name in cell.tasks)):
        sums = dict.fromkeys(cell.humans, 0.0)
        for mode in modes:
            for who, load in mode.stress.items():
                sums[who] += load
        limits = {who: cell.operators[who].stress_limit for who in cell.humans}
        teams = dict(zip(cell.tasks, (set(mode.operators) for mode in modes), strict=True))
        if any(teams[a] != teams[b] for a, b in cell.same_operator):
            continue
        if all(limits[who] is None or sums[who] <= limits[who] + 1e-9 for who in sums):
            worst.append(max(sums.values(), default=0.0))
    return min(worst)


def _without_what_may_rule_out_an_allocation(data: dict) -> None:
    data.pop("stress_of_set", None)
    for task in data["tasks"].values():
        for key in ("deadline", "wait", "tool", "zone"):
            task.pop(key, None)
        for joint in task.get("together", ()):
            joint.pop("tool", None)
    for operator in data["operators"].values():
        operator.pop("holds", None)


@pytest.mark.parametrize("method", ["exact", "exhaustive"])
def test_no_allocation_is_fairer(method: str):
    seen = 0
    for seed in range(120):
        data = random_cell(Random(seed))
        _without_what_may_rule_out_an_allocation(data)
        try:
            cell = cell_of(data)
            front = tandem.plan(cell, minimize="worst-stress", method=method, workers=1)
        except (CellError, InfeasibleError):
            continue
        assert front.complete
        assert front[0].worst_stress == pytest.approx(_worst_of_all(cell), abs=1e-9)
        assert not faults(cell, front[0].schedule)
        seen += len(cell.humans) > 1
    assert seen > 20


def test_a_limit_on_the_makespan_costs_fairness():
    cell = layered(9, 2, 1, seed=4)
    free = tandem.plan(cell, minimize="worst-stress")[0]
    quickest = tandem.plan(cell, minimize="makespan")[0]
    assert free.worst_stress < quickest.worst_stress
    limits = [quickest.makespan, (quickest.makespan + free.makespan) / 2, free.makespan]
    found = [tandem.plan(cell, minimize="worst-stress", max_makespan=limit)[0] for limit in limits]
    assert [point.makespan <= limit for point, limit in zip(found, limits, strict=True)] == [
        True
    ] * 3
    stresses = [point.worst_stress for point in found]
    assert stresses == sorted(stresses, reverse=True)
    assert stresses[-1] == free.worst_stress
    other = tandem.plan(
        cell, Question("worst-stress", max_makespan=limits[1]), method="exhaustive"
    )[0]
    assert (other.worst_stress, other.makespan) == (found[1].worst_stress, found[1].makespan)


def test_the_document_tells_it():
    front = tandem.plan(layered(6, 2, 1, seed=1), minimize="worst-stress")
    document = front.to_dict()
    assert document["question"]["minimize"] == "worst-stress"
    assert document["front"][0]["worst_stress"] == front[0].worst_stress
    assert document["front"][0]["canonical"] is True
