"""Whole episodes of a cell beside people who do what is asked, in NumPy: what a decider reaches. No
JAX is loaded.
"""

from __future__ import annotations

import numpy as np

from tandem.cell.model import Cell, plain
from tandem.learn.results import Reached, cost, paid
from tandem.schedule.model import Schedule
from tandem.world.arrays import Array, Arrays, Names
from tandem.world.episode import Decider, Shift, play_one
from tandem.world.people import Person, crew, led
from tandem.world.population import crowd
from tandem.world.randomness import OFF, Draw, scenario
from tandem.world.state import legal_of


def played(
    cell: Cell,
    stress_factor: float,
    decide: Decider,
    episodes: int = 1,
    *,
    people: str = "compliant",
    seed: int = 0,
) -> list[Reached]:
    """What the decider reaches in each of so many episodes.

    Args:
      people: who the humans are, in words. They begin what they are told; their pace, fatigue and
        slips are their own. `compliant`: the stated times hold, and nothing goes wrong.
      seed: of who they are, and of their slips; the same seed, the same people and slips.

    Raises UsageError, or CellError for a population file, where the description is wrong.
    """
    names = Names.of(cell)
    who = crowd(people, names, names.arrays())
    arrays = names.arrays(undo=OFF.undo if who.makes_mistakes else None)
    draws = np.random.default_rng(seed)
    persons, draw = who.draw(draws, episodes), Draw.of(names, arrays)
    found = []
    for number in range(episodes):
        person = crew(arrays, led(Person(*(part[number] for part in persons))))
        chances = scenario(draw, arrays, draws.random(draw.numbers, np.float32))
        ended = play_one(names, arrays, chances, person, decide)
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
