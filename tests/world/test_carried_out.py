"""A plan carried out by the world's rules: never later than planned, never in another order."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from tests.fuzz.judges import drawn

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError
from tandem.plan.result import Front
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule
from tandem.world import people
from tandem.world.arrays import Names
from tandem.world.carried_out import Plan, carry_on
from tandem.world.episode import Episode, play_one
from tandem.world.randomness import Chance, Draw, nominal_scenario, scenario

SEEDS = range(60)


def front_of(seed: int) -> Front | None:
    try:
        return tandem.plan(tandem.load(drawn(seed, None)[1]), time_limit=None, workers=1)
    except (CellError, InfeasibleError):
        return None


def carried_out(cell: Cell, schedule: Schedule, cv: float, seed: int) -> Episode:
    names = Names.of(cell)
    arrays = names.arrays()
    draw = Draw.of(names, arrays, Chance("lognormal", cv) if cv else Chance())
    chance = (
        scenario(draw, arrays, np.random.default_rng(seed).random(draw.numbers, np.float32))
        if cv
        else nominal_scenario(draw, arrays)
    )
    crew = people.crew(arrays, people.compliant(arrays))
    plan = Plan.of(names, schedule)
    return play_one(names, plan.held_back(arrays), chance, crew, partial(carry_on, plan))


@pytest.mark.parametrize("seed", SEEDS)
def test_at_the_stated_times_it_takes_what_was_planned(seed: int) -> None:
    for result in front_of(seed) or ():
        played = carried_out(result.cell, result.schedule, 0.0, seed)
        assert played.done
        assert played.makespan == pytest.approx(result.makespan)
        assert faults(result.cell, Schedule(tuple(played.work))) == []
        assert played.stress == pytest.approx(result.stress)
        planned = {row.task: row for row in result.schedule}
        assert all(row.start <= planned[row.task].start + 1e-9 for row in played.work)


@pytest.mark.parametrize("seed", SEEDS)
def test_where_times_scatter_who_does_what_in_which_order_stays(seed: int) -> None:
    for result in front_of(seed) or ():
        if result.cell.humans and any(op.breaks for op in result.cell.operators.values()):
            continue  # a late task may have to wait for a break that the plan had it begin before
        played = carried_out(result.cell, result.schedule, 0.5, seed)
        assert played.done
        found = Schedule(tuple(played.work))
        for who in result.cell.operators:
            assert [row.task for row in found.of(who)] == [
                row.task for row in result.schedule.of(who)
            ]
