"""One meaning of a second: what the planner proves, the thesis's world does, and dynamic
programming over it agrees.
"""

from __future__ import annotations

import pytest
from tests.lab.conftest import THESIS, cell_of, random_cell

import tandem
from tandem.lab.kinat2023 import reward_set, station
from tandem.lab.kinat2023.episode import actions_of, follow, play
from tandem.lab.kinat2023.optimal import return_optimal

CELLS = {
    "thesis": cell_of(THESIS),
    **{f"random {seed}": random_cell(seed, 5, 6) for seed in range(6)},
}


@pytest.mark.parametrize("name", CELLS)
def test_a_planned_schedule_takes_its_makespan_in_ticks(name):
    cell = CELLS[name]
    for result in tandem.plan(cell, time_limit=30, seed=0):
        episode = play(cell, reward_set(), follow(actions_of(cell, result.schedule)), by="ticks")
        assert (episode.done, episode.ticks, episode.stress, episode.illegal) == (
            True,
            result.makespan,
            result.stress,
            0,
        )
        assert episode.schedule == result.schedule


@pytest.mark.parametrize("factor", [0, 1, 2.5, 5, 40])
@pytest.mark.parametrize("name", CELLS)
def test_the_best_return_is_the_front_weighed_by_the_rewards(name, factor):
    """Without an idle penalty the sum of both returns is -20 makespan + 100 + f (all e - 2 stress):
    the exact front holds its maximum.
    """
    cell = CELLS[name]
    front, total = tandem.plan(cell, time_limit=30, seed=0), float(station(cell).stress.sum())
    assert front.complete
    worth = {
        point: -20 * point[0] + 100 + factor * (total - 2 * point[1]) for point in front.points
    }
    optimum = return_optimal(cell, reward_set("appendix", stress_factor=factor))
    assert optimum.value == max(worth.values())
    assert {point for point, value in worth.items() if value == optimum.value} <= set(optimum.pairs)
