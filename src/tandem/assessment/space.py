"""Space that people share with robots: which pairs of places are far enough apart, at which a robot
has to slow down, and which may not be used at once; and the cell with what follows from that.

Places are points. How far a robot and a person reach beyond theirs, together, is stated as `reach`
and taken off each distance. Advice for laying out work, and no safety function.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, Decimal
from math import dist
from typing import Any, Literal

from tandem.cell.language import Words
from tandem.cell.model import Cell, plain
from tandem.ergonomics.facts import fact
from tandem.ergonomics.ssm import (
    CLOSE_M,
    HAND,
    DistanceFacts,
    SeparationFacts,
    separation,
    slowed,
)
from tandem.errors import UsageError

SCHEMA_VERSION = 1
Verdict = Literal["free", "slow", "apart"]
SHARED = "shared space"


class LayoutFacts(SeparationFacts):
    """What is known of a robot, and how far it and a person reach beyond their places."""

    reach: float = fact(
        "how far robot and person, together, reach beyond their places", "m", 0, 10, cautious=2.0
    )


@dataclass(frozen=True)
class Near:
    """A place of a robot's tasks and one of people's tasks.

    Attributes:
      distance: in metres, what both reach taken off; never below 0.
      needed: the protective separation distance at the robot's full speed, metres.
      factor: how much longer motions take at the speed that the distance allows; None when even a
        robot that stands still is too near.
      verdict: `free` at full speed, `slow` by that factor, or `apart`: not at once.
    """

    robot: str
    robot_place: str
    human_place: str
    distance: float
    needed: float
    v_max: float
    factor: float | None
    verdict: Verdict


@dataclass(frozen=True)
class Space:
    """What was judged.

    Attributes:
      terms: robot -> the terms of its protective separation distance.
      joint: tasks that a person and a robot do together: not judged, they are in contact.
      nowhere: tasks without a place: not judged.
    """

    cell: Cell
    facts: Mapping[str, LayoutFacts]
    terms: Mapping[str, Mapping[str, float]]
    pairs: tuple[Near, ...]
    joint: tuple[str, ...]
    nowhere: tuple[str, ...]

    @property
    def is_close(self) -> bool:
        """A distance counts with a walking person although a hand is quicker there."""
        return any(
            sum(of.values()) < CLOSE_M and self.facts[robot].v_h < HAND
            for robot, of in self.terms.items()
        )


def judged(cell: Cell, facts: Mapping[str, LayoutFacts], *, most_factor: float = 3.0) -> Space:
    """Every pair of a place where a robot works and one where people do, told apart by robot.

    Args:
      facts: robot -> what is known of it; every robot of the cell.
      most_factor: a robot that would have to be slower still is kept apart.

    Raises:
      UsageError: a place has no coordinates.
    """
    kinds = {name: operator.kind for name, operator in cell.operators.items()}
    at: dict[str, dict[str, None]] = {}
    joint, nowhere = [], []
    for task, stated in cell.tasks.items():
        modes = cell.modes(task)
        if any({"human", "robot"} <= {kinds[who] for who in mode.operators} for mode in modes):
            joint.append(task)
        if stated.place is None:
            nowhere.append(task)
            continue
        for who in dict.fromkeys(who for mode in modes for who in mode.operators):
            at.setdefault(who, {})[stated.place] = None
    humans = dict.fromkeys(p for who in cell.humans for p in at.get(who, {}))
    robots = {who: list(at.get(who, {})) for who in facts}
    _need_coordinates(cell, [*humans, *(p for of in robots.values() for p in of)])
    pairs = tuple(
        _near(cell, robot, one, other, facts[robot], most_factor)
        for robot, places in robots.items()
        for one in places
        for other in humans
    )
    terms = {who: _terms(given) for who, given in facts.items()}
    return Space(cell, facts, terms, pairs, tuple(joint), tuple(nowhere))


def _terms(given: SeparationFacts) -> dict[str, float]:
    found = separation(given)
    return {name: value for name, value in found.items() if name != "S_p"}


def _need_coordinates(cell: Cell, places: Sequence[str]) -> None:
    if missing := [name for name in dict.fromkeys(places) if name not in cell.places]:
        example = f"{missing[0]}: [0, 0]"
        raise UsageError(
            f"places without coordinates: {', '.join(map(repr, missing))}. State them in metres,"
            f" `places: {{{example}}}`, so that distances are known."
        )


def _near(
    cell: Cell, robot: str, one: str, other: str, given: LayoutFacts, most_factor: float
) -> Near:
    distance = max(0.0, dist(cell.places[one], cell.places[other]) - given.reach)
    known = given.model_dump(exclude={"reach"})
    found = slowed(DistanceFacts(**known, distance=distance))
    factor = found["factor"]
    is_apart = factor is None or factor > most_factor
    verdict: Verdict = "apart" if is_apart else "free" if factor == 1 else "slow"
    return Near(robot, one, other, distance, found["S_p"], found["v_max"], factor, verdict)


# --- what follows for the cell --------------------------------------------------------------------


@dataclass(frozen=True)
class Applied:
    """The cell with what follows from the distances.

    Attributes:
      zones: zone -> its places: never a person and a robot in them at once.
      times: (task, robot) -> seconds before and after, of robots that are slowed down.
      stricter: pairs of places that would be far enough apart, and are in one zone all the same.
      left: tasks that belong into a zone and are not, since they have a joint way.
    """

    cell: Cell
    zones: Mapping[str, tuple[str, ...]]
    times: Mapping[tuple[str, str], tuple[float, float]]
    stricter: tuple[tuple[str, str], ...]
    left: tuple[str, ...]


def applied(space: Space, *, slow: Literal["zone", "times"] = "zone") -> Applied:
    """The cell in which pairs that are `apart` share a zone with `apart: [human, robot]`.

    Args:
      slow: pairs that are `slow` get such a zone too, or longer times of the robot: every second of
        its tasks there times the factor, which is more than slowing its motions costs.

    Raises:
      UsageError: a task there is in another zone already.
    """
    kept = [one for one in space.pairs if one.verdict == "apart" or one.verdict == slow_as(slow)]
    groups = _groups([(one.robot_place, one.human_place) for one in kept])
    data, zones, left = space.cell.to_dict(), {}, []
    for number, places in enumerate(groups, 1):
        tasks = [t for t, stated in space.cell.tasks.items() if stated.place in places]
        left += [task for task in tasks if task in space.joint]
        name = _zone_of(space.cell, [t for t in tasks if t not in space.joint], number, len(groups))
        zones[name] = places
        stated = data.setdefault("zones", {}).setdefault(
            name, {"capacity": len(space.cell.operators)}
        )
        stated["apart"] = list(dict.fromkeys([*stated.get("apart", []), "human", "robot"]))
        for task in tasks:
            if task not in space.joint:
                data["tasks"][task]["zone"] = name
    times = dict(_longer(space, data)) if slow == "times" else {}
    needed = {frozenset((one.robot_place, one.human_place)) for one in kept}
    stricter = [
        (one.robot_place, one.human_place)
        for one in space.pairs
        if frozenset((one.robot_place, one.human_place)) not in needed
        and any(one.robot_place in of and one.human_place in of for of in zones.values())
    ]
    return Applied(
        Cell.model_validate(data), zones, times, tuple(dict.fromkeys(stricter)), tuple(left)
    )


def slow_as(slow: Literal["zone", "times"]) -> Verdict:
    """The verdict that gets a zone besides `apart`."""
    return "slow" if slow == "zone" else "apart"


def _groups(pairs: Sequence[tuple[str, str]]) -> list[tuple[str, ...]]:
    """Places that hang together by pairs: a task can be in one zone only."""
    groups: list[dict[str, None]] = []
    for pair in pairs:
        met = [group for group in groups if set(pair) & set(group)]
        joined = dict.fromkeys([*(p for group in met for p in group), *pair])
        groups = [*(group for group in groups if group not in met), joined]
    return [tuple(group) for group in groups]


def _zone_of(cell: Cell, tasks: Sequence[str], number: int, of: int) -> str:
    """The zone of these tasks: the one that all of them have, or a new one."""
    stated = {task: cell.tasks[task].zone for task in tasks}
    used = {zone for zone in stated.values() if zone is not None}
    if len(used) == 1 and None not in stated.values():
        return used.pop()
    if used:
        told = ", ".join(f"{task!r} in {zone!r}" for task, zone in stated.items() if zone)
        raise UsageError(
            f"tasks are in a zone already ({told}), and a task has one zone. State `apart: [human,"
            f" robot]` there by hand, for {', '.join(map(repr, tasks))}."
        )
    names = [SHARED if of == 1 else f"{SHARED} {number}", *(f"{SHARED} {n}" for n in range(2, 999))]
    return next(name for name in names if name not in cell.zone_names)


def _longer(
    space: Space, data: dict[str, Any]
) -> Iterator[tuple[tuple[str, str], tuple[float, float]]]:
    """Lengthens the times of robots at places where they are slowed down."""
    factors: dict[tuple[str, str], float] = {}
    for one in space.pairs:
        if one.verdict == "slow" and one.factor is not None:
            at = one.robot, one.robot_place
            factors[at] = max(factors.get(at, 1.0), one.factor)
    for task, stated in space.cell.tasks.items():
        for (robot, place), factor in factors.items():
            if stated.place == place and robot in stated.time:
                before = stated.time[robot]
                longer = Decimal(repr(round(before * factor, 9)))
                after = float(longer.quantize(Decimal("0.1"), ROUND_CEILING))
                data["tasks"][task]["time"][robot] = plain(after)
                yield (task, robot), (before, after)


# --- told -----------------------------------------------------------------------------------------


def document(t: Words, space: Space, found: Applied, made: Mapping[str, str]) -> dict[str, Any]:
    """All of it as plain data; every term of the distances is in it."""
    return {
        "schema_version": SCHEMA_VERSION,
        "kind": "separation",
        "cell": space.cell.name,
        "cell_digest": space.cell.digest,
        **made,
        "robots": {
            who: {
                "facts": given.model_dump(),
                "stated": sorted(given.model_fields_set),
                "terms": dict(space.terms[who]),
                "S_p": sum(space.terms[who].values()),
            }
            for who, given in space.facts.items()
        },
        "pairs": [
            {
                "robot": one.robot,
                "robot_place": one.robot_place,
                "human_place": one.human_place,
                "distance": one.distance,
                "needed": one.needed,
                "v_max": one.v_max,
                "factor": one.factor,
                "verdict": one.verdict,
            }
            for one in space.pairs
        ],
        "zones": {name: list(places) for name, places in found.zones.items()},
        "times": [
            {"task": task, "operator": who, "before": plain(before), "after": plain(after)}
            for (task, who), (before, after) in found.times.items()
        ],
        "stricter": [list(pair) for pair in found.stricter],
        "not_judged": {"joint": list(space.joint), "without_place": list(space.nowhere)},
        "advice": t("space.advice"),
    }


def sentences(t: Words, space: Space, found: Applied) -> Iterator[str]:
    """What the distances say, and what follows, line by line."""

    def metres(value: float) -> str:
        return t.number(round(value, 3))

    for who, terms in space.terms.items():
        told = " + ".join(f"{name} {metres(value)}" for name, value in terms.items())
        yield t("space.needed", robot=who, metres=metres(sum(terms.values())), terms=told)
        given = space.facts[who]
        unstated = [name for name in type(given).model_fields if name not in given.model_fields_set]
        if unstated:
            taken = ", ".join(f"{name} {t.number(getattr(given, name))}" for name in unstated)
            yield t("space.unstated", facts=taken)
    for one in space.pairs:
        factor = None if one.factor is None else t.number(round(one.factor, 2))
        yield t(
            f"space.{one.verdict}" if factor is not None else "space.apart.still",
            robot=one.robot,
            one=one.robot_place,
            other=one.human_place,
            metres=metres(one.distance),
            factor=factor,
            speed=metres(one.v_max),
        )
    for name, places in found.zones.items():
        yield t("space.zone", zone=name, places=", ".join(places))
    for (task, who), (before, after) in found.times.items():
        yield t("space.time", task=task, robot=who, old=t.number(before), new=t.number(after))
    for robot_place, human_place in found.stricter:
        yield t("space.stricter", one=robot_place, other=human_place)
    if space.joint:
        yield t("space.joint", tasks=", ".join(space.joint))
    if space.nowhere:
        yield t("space.nowhere", tasks=", ".join(space.nowhere))
    if space.is_close:
        yield t("space.close")
    yield t("space.advice")
