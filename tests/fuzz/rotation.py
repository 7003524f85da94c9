"""Random crews over random roles: CP-SAT's job rotations beside an enumeration of all of them.

`python -m tests.fuzz.rotation --crews 1000` asks both for so many crews. The enumeration reads what
was drawn as plain data and shares nothing with the search or its judge; it goes period by period
and keeps, of all ways to the same loads, the one with the fewest stays.
"""

from __future__ import annotations

import argparse
import itertools
import random
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from typing import Any

from tandem.cell.crew import Crew, Person
from tandem.cell.model import Cell
from tandem.errors import InfeasibleError
from tandem.plan.rotation import Rotated, rotate
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.rotation import Period, Shift, faults, rotation_measure

MEASURES = ("dose:stress", "peak:stress", "time-above:stress:5", "time-weighted:stress")


@dataclass(frozen=True)
class Drawn:
    """A shift as plain data.

    Attributes:
      tasks: name -> who does it, seconds, stress.
      products: of each period; every one has 60 minutes.
      people: name -> roles, tasks they cannot do, periods from 1, limits; None where all is free.
    """

    tasks: Mapping[str, tuple[str, int, int]]
    products: Sequence[int]
    people: Mapping[str, Mapping[str, Any]]
    limits: Mapping[str, int]
    measures: Sequence[str]

    @property
    def roles(self) -> list[str]:
        return list(dict.fromkeys(who for who, _, _ in self.tasks.values() if who != "robot"))


def drawn(chance: random.Random, *, people: int, roles: int, periods: int) -> Drawn:
    """A random shift with that many of each."""
    names = [f"role{n}" for n in range(roles)]
    doers = [*names, *chance.choices([*names, "robot"], k=chance.randint(0, 4))]
    chance.shuffle(doers)
    tasks = {
        f"t{n}": (who, chance.randint(1, 9), chance.randint(0, 9)) for n, who in enumerate(doers)
    }
    even = chance.randint(1, 9)
    products = [even if chance.random() < 0.6 else chance.randint(1, 9) for _ in range(periods)]
    measures = chance.sample(MEASURES, chance.choice((1, 1, 2)))

    def limits() -> dict[str, int]:
        return {
            measure: chance.randint(0, 9 if measure.startswith("peak") else 60 * periods)
            for measure in MEASURES[:3]
            if chance.random() < 0.25
        }

    crew = {
        f"p{n}": {
            "roles": chance.sample(names, chance.randint(1, roles))
            if chance.random() < 0.3
            else None,
            "cannot": chance.sample(list(tasks), 1) if chance.random() < 0.15 else [],
            "periods": sorted(chance.sample(range(1, periods + 1), chance.randint(1, periods)))
            if chance.random() < 0.2
            else None,
            "limits": limits(),
        }
        for n in range(people)
    }
    return Drawn(tasks, products, crew, limits() if chance.random() < 0.4 else {}, measures)


def shift_of(one: Drawn) -> Shift:
    """What the search is given."""
    operators = {who: {"kind": "human"} for who in one.roles} | {"robot": {"kind": "robot"}}
    tasks = {
        name: {"time": {who: seconds}, "stress": stress}
        for name, (who, seconds, stress) in one.tasks.items()
    }
    cell = Cell.model_validate({"operators": operators, "tasks": tasks})
    rows, clock = [], 0.0
    for name, (who, seconds, _) in one.tasks.items():
        rows.append(Assignment(clock, clock + seconds, name, (who,)))
        clock += seconds

    def limits(stated: Mapping[str, int]) -> dict[str, Decimal]:
        return {measure: Decimal(most) for measure, most in stated.items()}

    crew = Crew(
        tuple(
            Person(
                name,
                None if who["roles"] is None else tuple(who["roles"]),
                tuple(who["cannot"]),
                None if who["periods"] is None else tuple(who["periods"]),
                limits(who["limits"]),
            )
            for name, who in one.people.items()
        ),
        limits(one.limits),
    )
    periods = tuple(Period(60.0, count) for count in one.products)
    return Shift(cell, Schedule(tuple(rows)), periods, crew, clock)


# --- the second judge -----------------------------------------------------------------------------


def each(one: Drawn, measure: str, role: str) -> int:
    """What a product adds in this role; of a peak the highest."""
    mine = [(seconds, stress) for who, seconds, stress in one.tasks.values() if who == role]
    if measure == "dose:stress":
        return sum(stress for _, stress in mine)
    if measure == "peak:stress":
        return max(stress for _, stress in mine)
    if measure == "time-above:stress:5":
        return sum(seconds for seconds, stress in mine if stress >= 5)
    return sum(seconds * stress for seconds, stress in mine)


def ways(one: Drawn, period: int) -> list[tuple[int | None, ...]]:
    """Every way to fill the roles of a period: of each person the number of their role."""
    people = list(one.people.values())
    found = []
    for chosen in itertools.permutations(range(len(people)), len(one.roles)):
        if all(
            _can(one, people[p], role, period) for role, p in zip(one.roles, chosen, strict=True)
        ):
            row: list[int | None] = [None] * len(people)
            for role, p in enumerate(chosen):
                row[p] = role
            found.append(tuple(row))
    return found


def _can(one: Drawn, person: Mapping[str, Any], role: str, period: int) -> bool:
    mine = {name for name, (who, _, _) in one.tasks.items() if who == role}
    return (
        (person["roles"] is None or role in person["roles"])
        and not mine & set(person["cannot"])
        and (person["periods"] is None or period + 1 in person["periods"])
    )


def best(one: Drawn, *, with_stays: bool = True) -> list[Fraction] | None:
    """The aims of the best rotation, by going through all of them; None when there is none."""
    table = {m: [each(one, m, role) for role in one.roles] for m in MEASURES}
    limits = [{**one.limits, **person["limits"]} for person in one.people.values()]
    zero = tuple(tuple(0 for _ in one.people) for _ in MEASURES)
    states: dict[Any, int] = {(zero, None): 0}
    for period, count in enumerate(one.products):
        now: dict[Any, int] = {}
        rows = ways(one, period)
        for (loads, before), stays in states.items():
            for row in rows:
                after = _after(table, loads, row, count)
                if not _kept(after, limits):
                    continue
                same = sum(
                    a is not None and a == b for a, b in zip(row, before or (), strict=False)
                )
                key = (after, row if with_stays else None)
                now[key] = min(now.get(key, stays + same), stays + same)
        states = now
    scale = {m: Fraction(1, 3600 * len(one.products)) for m in MEASURES if "weighted" in m}
    found = [[*_aims(one, loads, scale), Fraction(s)] for (loads, _), s in states.items()]
    chosen = min(found, default=None)
    return chosen if chosen is None or with_stays else chosen[:-1]


def _after(table: Any, loads: Any, row: Any, count: int) -> Any:
    after = []
    for measure, of in zip(MEASURES, loads, strict=True):
        add = [0 if role is None else table[measure][role] for role in row]
        if measure == "peak:stress":
            after.append(tuple(max(a, b) for a, b in zip(of, add, strict=True)))
        else:
            after.append(tuple(a + b * count for a, b in zip(of, add, strict=True)))
    return tuple(after)


def _kept(loads: Any, limits: Any) -> bool:
    return all(
        loads[MEASURES.index(measure)][p] <= most
        for p, stated in enumerate(limits)
        for measure, most in stated.items()
    )


def _aims(one: Drawn, loads: Any, scale: Mapping[str, Fraction]) -> list[Fraction]:
    found = []
    for measure in one.measures:
        of, unit = loads[MEASURES.index(measure)], scale.get(measure, Fraction(1))
        found += [max(of) * unit, (max(of) - min(of)) * unit]
    return found


# --- both -----------------------------------------------------------------------------------------


def searched(one: Drawn) -> Rotated | None:
    """What the search finds; None when it says that there is none."""
    shift = shift_of(one)
    try:
        return rotate(shift, [rotation_measure(name, shift.cell) for name in one.measures])
    except InfeasibleError:
        return None


def difference(one: Drawn) -> str | None:
    """How the two differ; None when they agree."""
    wanted, found = best(one), searched(one)
    if wanted is None or found is None:
        return None if wanted is None and found is None else f"{wanted} is {found and found.aims}"
    if wrong := faults(found.rotation):
        return f"unsound: {wrong}"
    got = [Fraction(aim.value) for aim in found.aims]
    close = all(abs(a - b) <= Fraction(1, 10**11) for a, b in zip(got, wanted, strict=True))
    return None if found.proven and close else f"wanted {wanted}, got {got}"


SIZES = [(2, 1, 3), (3, 2, 3), (3, 3, 3), (4, 2, 3), (4, 3, 2), (5, 2, 3)]
"""People, roles, periods of the random crews."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs both on random crews and prints how often they differ."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--crews", type=int, default=100)
    parser.add_argument("--large", type=int, default=0, help="crews of 5 people and 4 periods")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args(arguments)
    wrong, none = 0, 0
    for number in range(asked.crews + asked.large):
        chance = random.Random(f"{asked.seed}-{number}")
        sizes = chance.choice(SIZES) if number < asked.crews else (5, 2, 4)
        one = drawn(chance, people=sizes[0], roles=sizes[1], periods=sizes[2])
        if number >= asked.crews:
            one = replace(one, products=[one.products[0]] * 4)
        said = difference(one)
        none += best(one) is None if number < asked.crews else 0
        if said is not None:
            wrong += 1
            print(f"crew {number} of seed {asked.seed}: {said}\n  {one}")
    print(
        f"rotation: {asked.crews} crews ({none} without a rotation) and {asked.large} of 5 people"
        f" and 4 periods, {wrong} disagreements"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
