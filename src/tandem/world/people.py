"""The people at the station: what they choose when they are asked, and how long they really take.
Parameters as data; `vmap` maps over people.

A decider suggests a task to a person, or asks it to wait; `choose` answers with a way that is
legal, or with waiting. What is known of a person to nobody but itself stands in `Person`; how tired
it is and how much it has done, in the episode (`episode.py`). Persons are made from a text
(`crowd.py`): "compliant", "random:0.5", "pace:2+forgetful:0.1", ...
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tandem.world.arrays import Array, Arrays, namespace
from tandem.world.state import State, legal_of


class Person(NamedTuple):
    """One person, or one in each row; floats are float32. The default person of `compliant` does
    what it is asked, in the stated time.

    random: `[]`, probability, tossed at each decision, of picking uniformly among the legal tasks
    whatever was suggested. follows: `[]`, what a suggestion is worth to it, on the scale of
    `taste`. obeys: `[]`, 1 when it waits if asked to, else 0. taste: `[W]`, how much it likes each
    way; it takes the legal one of the largest taste plus `follows` where it was suggested. pace:
    `[]`, factor on its times, told to nobody: 2 is twice as slow. learning: `[]`, exponent b of the
    power law: the n-th task takes n ** -b of the first's time; `experience`: `[]`, tasks done
    before the episode. fatigue: `[]`, F in 0..1 at the start. tires: `[W]`, rate at which F grows
    while it works in this way, per tick: F <- 1 - (1 - F) exp(-rate ticks). recovers: `[]`, rate at
    which it falls at rest, per tick: F <- F exp(-rate ticks). slows: `[]`, work takes 1 + slows F
    of its time. forgets: `[]`, probability that a task goes wrong. refuses: `[]`, probability, at
    each suggestion, of refusing the task for good, where there is another way to do it; else it is
    put off. postpones: `[]`, probability of putting a suggested task off: nothing until the next
    event, where that is possible.
    """

    random: Array
    follows: Array
    obeys: Array
    taste: Array
    pace: Array
    learning: Array
    experience: Array
    fatigue: Array
    tires: Array
    recovers: Array
    slows: Array
    forgets: Array
    refuses: Array
    postpones: Array


class Answer(NamedTuple):
    """What a person does when asked. way: `[]` int32, -1 when it begins nothing. refuses: `[]`
    bool, it will not do the suggested task any more, and is asked again at once; else with a way of
    -1 it waits until the next event.
    """

    way: Array
    refuses: Array


def compliant(arrays: Arrays) -> Person:
    """Does what is suggested, waits when asked to, takes the stated time, errs never."""
    none, one = np.float32(0), np.float32(1)
    free = np.zeros(arrays.way_ticks.shape[0], np.float32)
    return Person(none, one, one, free, one, none, none, none, free, none, one, none, none, none)


def stacked(people: list[Person]) -> Person:
    """Several persons as one, with a leading axis."""
    return Person(
        *(np.stack([np.asarray(value) for value in values]) for values in zip(*people, strict=True))
    )


def led(person: Person) -> Person:
    """The same person, who begins what it is told and nothing else: its pace, its fatigue and its
    slips are left to it.
    """
    zero, one = np.float32(0), np.float32(1)
    return person._replace(
        random=zero,
        follows=one,
        obeys=one,
        taste=person.taste * zero,
        refuses=zero,
        postpones=zero,
    )


def crew(arrays: Arrays, person: Person) -> Person:
    """`[O]` persons: this one for each human; a robot does what it is told and takes the stated
    time.
    """
    xp = namespace(person.taste)
    robot = compliant(arrays)

    def each(mine: Array, robots: Array) -> Array:
        mine = xp.asarray(mine)
        human = arrays.human.reshape((-1, *[1] * mine.ndim))
        return xp.where(human, mine[None], robots)

    return Person(*map(each, person, robot))


def of(people: Person, operator: Array) -> Person:
    """One person of a crew (`operator`: `[]` int)."""
    xp = namespace(people.taste)
    mine = xp.arange(people.pace.shape[0]) == operator

    def pick(values: Array) -> Array:
        return xp.where(mine.reshape((-1, *[1] * (values.ndim - 1))), values, 0).sum(axis=0)

    return Person(*map(pick, people))


def choose(
    arrays: Arrays,
    state: State,
    person: Person,
    operator: Array,
    legal: Array,
    suggested: Array,
    can_wait: Array,
    mood: Array,
) -> Answer:
    """What the person does.

    Args:
      person: one person.
      operator: `[]` int, who that is.
      legal: `[W]` bool, the ways that it may begin now; at least one.
      suggested: `[]` int, a way, or -1 for waiting; what is not legal counts as waiting.
      can_wait: `[]` bool, it may let its turn pass.
      mood: `[3]` float32 in 0..1, see `randomness.Scenario`.
    """
    xp = namespace(legal)
    asked = (xp.arange(legal.shape[0]) == suggested) & legal
    is_asked = asked.any()
    astray = mood[0] < person.random
    liked = xp.where(legal, person.taste + (person.follows + SLIGHTLY) * asked, -xp.inf)
    own = xp.where(astray, _any_task(xp, arrays, legal, mood[1]), liked.argmax())
    declines, puts_off = mood[2] < person.refuses, mood[2] < person.refuses + person.postpones
    for_good = declines & is_asked & ~astray & _someone_else(xp, arrays, state, operator, asked)
    rests = ~astray & can_wait & xp.where(is_asked, puts_off, person.obeys > 0)
    return Answer(xp.where(rests | for_good, -1, own).astype(xp.int32), for_good)


SLIGHTLY = 1e-4
"""Between two ways that a person likes the same, a suggestion decides."""


def time_factor(person: Person, fatigue: Array, done: Array) -> Array:
    """What the times of a person, or of each of a crew, are multiplied by at this fatigue and after
    so many tasks.

    Source of the power law: Wright (1936), J. Aeronautical Sciences 3(4). That fatigue slows in
    proportion is an ASSUMPTION.
    """
    xp = namespace(person.taste)
    return (
        person.pace
        * xp.exp(-person.learning * xp.log(1 + person.experience + done))
        * (1 + person.slows * fatigue)
    )


def rested(person: Person, fatigue: Array, ticks: Array) -> Array:
    """Fatigue of a person, or of each of a crew, after so many ticks of rest."""
    return fatigue * namespace(person.taste).exp(-person.recovers * ticks)


def tired(person: Person, fatigue: Array, way: Array, ticks: Array) -> Array:
    """Fatigue of a person, or of each of a crew, after so many ticks of work in that way (`[W]`
    bool, True at it).
    """
    xp = namespace(person.taste)
    rate = xp.where(way, person.tires, 0).sum(axis=-1)
    return 1 - (1 - fatigue) * xp.exp(-rate * ticks)


def _any_task(xp: Any, arrays: Arrays, legal: Array, number: Array) -> Array:
    """`[]` int, a legal way: each task is as likely as another, and so is each way of a task.
    `number` in [0, 1).
    """
    ways_of_task = xp.where(arrays.of_task & legal[:, None], 1, 0).sum(axis=0)
    share = xp.where(
        legal,
        1.0 / xp.maximum(1, xp.where(arrays.of_task, ways_of_task[None, :], 0).sum(axis=1)),
        0.0,
    )
    heap = share.cumsum()
    return ((heap > number * heap[-1] * (1 - 1e-6)) & legal).argmax()


def _someone_else(xp: Any, arrays: Arrays, state: State, operator: Array, asked: Array) -> Array:
    """`[]` bool, the task can still be done without the operator."""
    task = (arrays.of_task & asked[:, None]).any(axis=0)
    left = arrays.way_open & ~state.refused & (arrays.of_task & task[None, :]).any(axis=1)
    return (left & ~legal_of(arrays, left, operator)).any()


def harm(arrays: Arrays) -> Array:
    """`[W]` float32, how much harm a way does by an adversary's rule: its time beyond the quickest
    other way, less half the task's chain.

    Whoever does what suits others better, and what nobody waits for, does the team the most harm
    that a plain rule can find.
    """
    lost = np.zeros(len(arrays.way_ticks))
    for way, task in enumerate(arrays.way_task):
        rest = [
            ticks
            for other, ticks in enumerate(arrays.way_ticks)
            if arrays.way_task[other] == task and other != way and arrays.way_open[other]
        ]
        lost[way] = (
            arrays.way_ticks[way]
            - min(rest, default=arrays.way_ticks[way])
            - 0.5 * arrays.tail[task]
        )
    return (lost / max(1, int(arrays.way_ticks.max()))).astype(np.float32)
