"""Whole episodes: JAX and NumPy agree, the same key gives the same history, and with chance off the
world is the planner's.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import jax
import numpy as np
import pytest

from tandem.cell.model import Cell
from tandem.files.validate import cell_of
from tandem.plan.methods import plan
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule
from tandem.world.arrays import Arrays, Names, namespace
from tandem.world.episode import (
    Episode,
    Played,
    Shift,
    begin,
    expected_ends,
    is_over,
    play_many,
    play_one,
    step,
)
from tandem.world.people import Person, compliant
from tandem.world.people import crew as crew_of
from tandem.world.population import crowd
from tandem.world.randomness import OFF, Chance, Draw, Scenario, nominal_scenario, scenarios
from tandem.world.state import legal_of

EVERYTHING = Chance(
    "lognormal", cv=0.2, failure_s=60.0, repair_s=4.0, absence_s=60.0, away_s=5.0, later=0.5
)


def first(arrays: Arrays, shift: Shift) -> Any:
    """The first legal way of whose turn it is."""
    return namespace(shift.mask).argmax(legal_of(arrays, shift.mask, shift.turn))


def last(arrays: Arrays, shift: Shift) -> Any:
    """The last legal way of whose turn it is."""
    mine = legal_of(arrays, shift.mask, shift.turn)
    return mine.shape[0] - 1 - namespace(mine).argmax(mine[::-1])


def row(values: Any, place: int) -> Any:
    return type(values)(*(part[place] for part in values))


def prepared(
    cell: Cell, spec: str, chance: Chance, episodes: int, seed: int = 0
) -> tuple[Names, Arrays, Draw, Person]:
    names = Names.of(cell)
    people = crowd(spec, names, names.arrays())
    arrays = names.arrays(undo=chance.undo if people.makes_mistakes else None)
    return (
        names,
        arrays,
        Draw.of(names, arrays, chance),
        people.draw(np.random.default_rng(seed), episodes),
    )


def played_in_numpy(
    cell: Cell, spec: str, chance: Chance, decide: Any = first, episodes: int = 10, seed: int = 0
) -> list[Episode]:
    names, arrays, draw, people = prepared(cell, spec, chance, episodes, seed)
    chances = scenarios(jax.random.key(seed), draw, arrays, episodes)
    return [
        play_one(names, arrays, row(chances, e), crew_of(arrays, row(people, e)), decide)
        for e in range(episodes)
    ]


WILD = "forgetful:0.3+random:0.3+tiring:weak,after=5+refusing:0.1+pace:0.8..1.6"


@pytest.fixture(scope="module")
def everything(rich: Cell) -> tuple[Names, Played, list[Episode]]:
    """The same episodes in JAX and in NumPy."""
    names, arrays, draw, people = prepared(rich, WILD, EVERYTHING, 40)
    return (
        names,
        play_many(jax.random.key(0), draw, arrays, people, first),
        played_in_numpy(rich, WILD, EVERYTHING, episodes=40),
    )


def test_jax_and_numpy_play_the_same_episodes(
    everything: tuple[Names, Played, list[Episode]],
) -> None:
    """To a tick in a few: floats of the two differ in the last bit, and a duration may round the
    other way.
    """
    names, played, one_by_one = everything
    assert played.done.all()
    for place, episode in enumerate(one_by_one):
        assert episode.done
        assert episode.makespan == pytest.approx(
            names.seconds(int(played.makespan[place])), abs=0.005
        )
        assert episode.stress == names.stress(int(played.stress[place]))
        assert episode.decisions == int(played.shift.decisions[place])


def test_mistakes_are_in_the_record(everything: tuple[Names, Played, list[Episode]]) -> None:
    names, _, one_by_one = everything
    assert any(episode.undone for episode in one_by_one)
    for episode in one_by_one:
        for task in names.tasks:
            work = [a for a in episode.work if a.task == task]
            assert len(work) == 1 + 2 * len([a for a in episode.undone if a.task == task]), (
                "done, taken apart, done, ..."
            )


def test_whoever_often_strays_gets_there_in_the_end(thesis: Cell) -> None:
    """Once the same slip came again at every new attempt: the task that was meant has to count as
    tried, not only the one that was begun.
    """
    for episode in played_in_numpy(
        thesis, "forgetful:0.5", Chance(wrong_order=1.0), last, episodes=12
    ):
        assert episode.done
        assert len(episode.undone) < 30


def test_nobody_is_at_two_tasks_whatever_happens(
    everything: tuple[Names, Played, list[Episode]],
) -> None:
    names, _, one_by_one = everything
    for episode in one_by_one:
        for who in names.operators:
            spans = sorted((a.start, a.end) for a in episode.work if who in a.operators)
            assert all(end <= start for (_, end), (start, _) in pairwise(spans))


def test_the_same_key_gives_the_same_history_whoever_decides(thesis: Cell) -> None:
    """Task 3, which only the human can do, takes as long under one decider as under the other;
    another key brings another time.
    """

    def task_3(decide: Any, seed: int) -> list[float]:
        played = played_in_numpy(
            thesis, "compliant", Chance("lognormal", cv=0.3), decide, seed=seed
        )
        return [
            round(a.end - a.start, 6) for episode in played for a in episode.work if a.task == "3"
        ]

    assert task_3(first, 0) == task_3(last, 0)
    assert task_3(first, 0) != task_3(first, 1)


def test_with_chance_off_a_plan_is_played_to_the_tick(thesis: Cell) -> None:
    best = plan(thesis, method="exact", minimize="makespan")[0]
    names = Names.of(thesis)
    arrays = names.arrays()
    start = {names.way(a.task, a.operators): names.ticks(a.start) for a in best.schedule}

    def planned(arrays: Arrays, shift: Shift) -> Any:
        due = [
            way
            for way in np.flatnonzero(legal_of(arrays, shift.mask, shift.turn))
            if start.get(int(way)) == int(shift.state.clock)
        ]
        return np.int32(due[0] if due else -1)

    scenario = nominal_scenario(Draw.of(names, arrays, OFF), arrays)
    episode = play_one(names, arrays, scenario, crew_of(arrays, compliant(arrays)), planned)
    assert Schedule(episode.work) == best.schedule
    assert (episode.makespan, episode.changes, episode.done) == (23.0, 0, True)


def test_no_play_of_random_people_beats_the_exact_bound(thesis: Cell) -> None:
    for episode in played_in_numpy(thesis, "random:1", OFF, last, episodes=60):
        assert episode.makespan >= 23.0
        assert faults(thesis, Schedule(episode.work)) == []


def test_an_untold_pace_is_not_seen_in_advance(thesis: Cell) -> None:
    """What a decider may know of running work is the stated end, until that has passed."""
    names = Names.of(thesis)
    arrays = names.arrays()
    scenario = nominal_scenario(Draw.of(names, arrays, OFF), arrays)
    slow = crew_of(arrays, compliant(arrays)._replace(pace=np.float32(2)))
    shift = begin(arrays, slow)
    while shift.turn >= 0:
        shift = step(arrays, scenario, slow, shift, first(arrays, shift))
    human = np.flatnonzero((shift.state.way >= 0) & arrays.way_uses[shift.state.way, 1])[0]
    stated = arrays.way_ticks[shift.state.way[human]]
    assert shift.state.end_at[human] == 2 * stated
    assert expected_ends(arrays, shift.state)[human] == stated


def test_slow_people_make_it_longer_by_their_pace(thesis: Cell) -> None:
    assert played_in_numpy(thesis, "pace:2", OFF, episodes=1)[0].makespan == 52.0
    assert played_in_numpy(thesis, "compliant", OFF, episodes=1)[0].makespan == 26.0


def test_what_is_asked_and_not_legal_counts_as_waiting(thesis: Cell) -> None:
    names, arrays, draw, people = prepared(thesis, "compliant", OFF, 1)
    crew, scenario = crew_of(arrays, row(people, 0)), nominal_scenario(draw, arrays)
    shift = step(arrays, scenario, crew, begin(arrays, crew), np.int32(names.way("7", ["human"])))
    assert (int(shift.illegal), shift.state.waits.tolist(), bool((shift.state.way < 0).all())) == (
        1,
        [False, True],
        True,
    )


def test_whoever_refused_is_asked_again_when_nothing_else_is_left(thesis: Cell) -> None:
    """The robot and the human could both do most tasks; a human who refuses whatever it can still
    lets the assembly end.
    """
    assert all(episode.done for episode in played_in_numpy(thesis, "refusing:1", OFF, episodes=3))


def test_an_episode_in_which_nothing_more_can_be_done_ends(thesis: Cell) -> None:
    """Only the human can do task 3; a limit on stress below the least that tasks put on it leaves
    no way.
    """
    tight = cell_of(
        {
            "operators": {
                "robot": {"kind": "robot"},
                "human": {"kind": "human", "stress_limit": 1.0},
            },
            "tasks": {"1": {"time": {"human": 3.0}, "stress": 2.0}, "2": {"time": {"robot": 2.0}}},
        }
    )
    names = Names.of(tight)
    arrays = names.arrays()
    scenario: Scenario = nominal_scenario(Draw.of(names, arrays, OFF), arrays)
    episode = play_one(names, arrays, scenario, crew_of(arrays, compliant(arrays)), first)
    assert not episode.done
    assert [a.task for a in episode.work] == ["2"]
    assert not is_over(arrays, begin(arrays, crew_of(arrays, compliant(arrays))))
