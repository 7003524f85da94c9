"""Whole episodes of a cell beside somebody who does what is asked, in NumPy: what a decider
reaches. No JAX is loaded.
"""

from __future__ import annotations

import numpy as np

from tandem.cell.model import Cell, plain
from tandem.learn.results import Reached, cost, paid
from tandem.schedule.model import Schedule
from tandem.world.arrays import Array, Arrays, Names
from tandem.world.episode import Decider, Shift, play_one
from tandem.world.people import compliant, crew
from tandem.world.randomness import Draw, scenario
from tandem.world.state import legal_of


def played(cell: Cell, stress_factor: float, decide: Decider, episodes: int = 1) -> list[Reached]:
    """What the decider reaches in each of so many episodes; the stated times hold, and nothing goes
    wrong.
    """
    names = Names.of(cell)
    arrays = names.arrays()
    obedient = crew(arrays, compliant(arrays))
    draw = Draw.of(names, arrays)
    nothing_happens = scenario(draw, arrays, np.full(draw.numbers, 0.5, np.float32))
    found = []
    for _ in range(episodes):
        ended = play_one(names, arrays, nothing_happens, obedient, decide)
        if not ended.done:
            found.append(Reached(None, None, 0, float("inf"), None))
            continue
        makespan, stress = plain(ended.makespan), plain(round(ended.stress, 6))
        spent = cost(ended.makespan, ended.stress, **paid(stress_factor))
        found.append(Reached(makespan, stress, 0, spent, Schedule(ended.work)))
    return found


def at_random(cell: Cell, stress_factor: float, *, seed: int, episodes: int) -> list[Reached]:
    """Episodes in which everybody begins any legal task, each as likely as the others, and waits
    only where there is none.
    """
    draws = np.random.default_rng(seed)

    def decide(arrays: Arrays, shift: Shift) -> Array:
        legal = np.flatnonzero(legal_of(arrays, shift.mask, shift.turn))
        return np.int32(draws.choice(legal) if len(legal) else -1)

    return played(cell, stress_factor, decide, episodes)
