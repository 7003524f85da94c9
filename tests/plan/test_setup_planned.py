"""Plans of cells in which operators get ready first: every planner waits for it, and none is
refused for it.
"""

from __future__ import annotations

from typing import Any

import pytest

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan.bounds import chain_bound
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.lower_bound import prove_makespan
from tandem.plan.methods import METHODS, plan
from tandem.plan.question import Question
from tandem.world.replay import replay


def bench(**anna: Any) -> Cell:
    """Anna could do it all in 6 s, were she ready; the cobot needs twice as long and is."""
    return cell_of({
        "operators": {"anna": {"kind": "human", **anna}, "cobot": {"kind": "robot"}},
        "tasks": {"base": {"time": {"anna": 4, "cobot": 8}, "stress": 1},
        "cover": {"time": {"anna": 2, "cobot": 4}, "after": ["base"]}},
    })  # fmt: skip


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("anna", "least"),
    [
        ({"setup": 2.5}, 8.5),
        ({"setup": 2.5, "breaks": [[2, 3]]}, 10),
        ({"setup": 7}, 10),
        ({"setup": 20}, 12),
    ],
    ids=["at once", "behind a break", "the cobot begins", "the cobot does all"],
)
def test_every_planner_waits_until_an_operator_is_ready(
    method: str, anna: dict[str, Any], least: float
) -> None:
    cell = bench(**anna)
    best = METHODS[method](cell, Question("makespan"), time_limit=30)[0]
    assert replay(cell, best.schedule) == best.makespan
    assert best.makespan >= least
    if method in ("exact", "exhaustive"):
        assert best.makespan == least


def test_the_bounds_without_search_know_when_operators_come() -> None:
    instance = Instance.of(bench(setup=7))
    assert instance.arrival == (70, 0) or instance.arrival == (7, 0)
    late = Instance.of(cell_of({"operators": {"anna": {"kind": "human", "setup": 7}},
    "tasks": {"base": {"time": {"anna": 4}}}}))  # fmt: skip
    assert chain_bound(Layout.of(late)) == 11


def test_the_search_for_a_lower_bound_proves_the_optimum_behind_a_setup() -> None:
    """Breaks are no part of that search; that nobody works before they are ready is."""
    tasks = {f"t{number}": {"time": {"anna": 3, "ben": 3}} for number in range(4)}
    cell = cell_of({"operators": {who: {"kind": "human", "setup": 5} for who in ("anna", "ben")},
    "tasks": tasks})  # fmt: skip
    proof = prove_makespan(Instance.of(cell), 11, 30.0)
    assert (proof.bound, proof.upper, proof.starts) == (11, 11, None)


def test_who_comes_too_late_to_help_does_not_raise_the_bound() -> None:
    cell = cell_of({
        "operators": {"anna": {"kind": "human"}, "ben": {"kind": "human", "setup": 50}},
        "tasks": {"base": {"time": {"anna": 2, "ben": 2}}, "cover": {"time": {"anna": 3,
        "ben": 1}}},
    })  # fmt: skip
    proof = prove_makespan(Instance.of(cell), 9, 30.0)
    assert (proof.bound, proof.upper) == (5, 5)


def test_a_setup_that_leaves_no_time_is_named_among_what_could_be_lifted() -> None:
    cell = cell_of({
        "operators": {"anna": {"kind": "human", "setup": 5}},
        "tasks": {"base": {"time": {"anna": 3}, "deadline": 9}, "cover": {"time": {"anna": 3},
        "deadline": 9}},
    })  # fmt: skip
    with pytest.raises(InfeasibleError, match="the setup of anna"):
        plan(cell)
