"""Whatever happens by chance and by people, in any cell: nothing is used twice at once, and every
episode ends.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.schedule.model import Assignment
from tandem.world.arrays import Arrays, Names
from tandem.world.episode import Episode, Shift, play_one
from tandem.world.people import Person, crew
from tandem.world.population import crowd
from tandem.world.randomness import Chance, Draw, scenario
from tandem.world.state import legal_of

CHANCE = Chance(
    "lognormal",
    cv=0.3,
    failure_s=15.0,
    repair_s=3.0,
    absence_s=20.0,
    away_s=4.0,
    wrong_order=0.5,
    later=0.5,
    notice_s=5.0,
)


def wild(cell: Cell, seed: int) -> Episode:
    """An episode of people who do everything that can be wrong, beside a decider who picks at
    random.
    """
    names = Names.of(cell)
    people = crowd(
        "random:0.3+forgetful:0.3+refusing:0.2+postponing:0.1+pace:0.6..2", names, names.arrays()
    )
    arrays, rng = names.arrays(undo=CHANCE.undo), np.random.default_rng(seed)
    draw = Draw.of(names, arrays, CHANCE)
    person = Person(*(value[0] for value in people.draw(rng, 1)))

    def decide(arrays: Arrays, shift: Shift) -> Any:
        return np.int32(rng.choice([-1, *np.flatnonzero(legal_of(arrays, shift.mask, shift.turn))]))

    return play_one(
        names,
        arrays,
        scenario(draw, arrays, rng.random(draw.numbers, np.float32)),
        crew(arrays, person),
        decide,
        limit=3000,
    )


def crowded(work: Iterable[Assignment], places: int) -> bool:
    """More operators are at it at once than there are places."""
    rows = list(work)
    return any(
        sum(len(b.operators) for b in rows if b.start <= a.start < b.end) > places for a in rows
    )


@settings(max_examples=60)
@given(cells(), st.integers(0, 10_000))
def test_nothing_is_used_twice_at_once_and_every_episode_ends(cell: Cell, seed: int) -> None:
    episode = wild(cell, seed)
    assert episode.decisions + episode.events < 3000
    for who in cell.operators:
        assert not crowded(
            (
                Assignment(a.start, a.end, a.task, (who,))
                for a in episode.work
                if who in a.operators
            ),
            1,
        )
    for kind, table in (("tool", cell.tools), ("zone", cell.zones)):
        for name in cell.tool_names if kind == "tool" else cell.zone_names:
            places = table[name].capacity if name in table else 1
            taken = ((a, cell.takes(kind, a.task, a.operators)) for a in episode.work)
            users = (
                replace(a, operators=tuple(who for who in takes if takes[who] == name))
                for a, takes in taken
            )
            assert not crowded((a for a in users if a.operators), places)
    if episode.done:
        assert {a.task for a in episode.work} == set(cell.tasks)
