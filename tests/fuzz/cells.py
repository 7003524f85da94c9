"""Random small cells with every feature, from a number: plain data, as a cell file holds it.

Deadlines and releases stand in half of them each, since they are what methods get wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import combinations
from random import Random
from typing import Any

STEPS = (1.0, 1.0, 0.5, 0.25, 0.1, 0.05)
"""Seconds that all times of one cell are multiples of."""
SMALL = {1: 1, 2: 3, 3: 5, 4: 4, 5: 1}
FEW = {1: 2, 2: 6, 3: 2}
KINDS = ("human", "robot", "machine")
Data = dict[str, Any]


def cell(random: Random, sizes: Mapping[int, int] = SMALL, crews: Mapping[int, int] = FEW) -> Data:
    """One cell of one to five tasks and one to three operators, or of other sizes. It may have no
    schedule; it may even be refused as a cell.

    Args:
      sizes, crews: number of tasks, of operators -> how often it is drawn, as a weight.
    """
    fine = random.random() < 0.1
    step = 0.000001 if fine else random.choice(STEPS)
    clock = _Clock(random, step, 8_000_000 if fine else 8)
    operators = _operators(random, clock, crews)
    tools, zones = _tools(random, clock, list(operators)), _zones(random)
    count = random.choices(list(sizes), list(sizes.values()))[0]
    names = [f"t{place}" for place in range(count)]
    tasks: Data = {}
    for place, name in enumerate(names):
        tasks[name] = _task(random, clock, operators, names[:place], fine)
        for key, things in (("tool", tools), ("zone", zones)):
            if things and random.random() < 0.5:
                tasks[name][key] = random.choice(list(things))
    if len(names) > 1 and random.random() < 0.15:
        tasks[names[-1]] = dict(tasks[names[-2]])  # twins, which searches like to tell apart or not
    for operator in operators.values():
        if tools and random.random() < 0.3:
            operator["tool"] = random.choice(list(tools))
    _windows(random, clock, tasks)
    data: Data = {"operators": operators, "tasks": tasks, "tools": tools, "zones": zones}
    if len(names) > 1 and random.random() < 0.2:
        data["same_operator"] = [random.sample(names, 2)]
    if random.random() < 0.12:
        data["stress_of_set"] = _table(random, tasks, operators)
    elif random.random() < 0.3:
        data["tasks"] = {name: tasks[name] for name in random.sample(names, len(names))}
    if len(names) > 1 and random.random() < 0.25:
        _waits(random, clock, names, tasks, fine)
    _own_tools(random, data)
    _places(random, clock, data)
    _machines_and_zones_apart(data)
    _limits(data)
    return data


class _Clock:
    """Draws times of one cell: multiples of its step."""

    def __init__(self, random: Random, step: float, most: int) -> None:
        self.random, self.step, self.most = random, step, most

    def seconds(self, low: float = 0.125, high: float = 1.0) -> float:
        """From `low` to `high` of the longest time that a task takes, at least one step unless low
        is 0.
        """
        first = max(round(low * self.most), 1 if low else 0)
        return self.at(self.random.randint(first, max(first, round(high * self.most))))

    def at(self, steps: int) -> float:
        return round(steps * self.step, 6)


def _operators(random: Random, clock: _Clock, crews: Mapping[int, int]) -> Data:
    operators: Data = {}
    for place in range(random.choices(list(crews), list(crews.values()))[0]):
        kind = random.choice(("human", "human", "robot"))
        operator: Data = {"kind": kind}
        if random.random() < 0.3:
            off = clock.seconds(0)
            back = round(off + clock.seconds(0.125, 0.5), 6)
            operator["breaks"] = [[off, back]]
            if random.random() < 0.3:
                later = round(back + clock.seconds(0.125), 6)
                operator["breaks"].append([later, round(later + clock.seconds(0.125, 0.25), 6)])
        if random.random() < 0.35:
            operator["setup"] = clock.seconds(0, 0.6)
        if kind == "human" and random.random() < 0.25:
            operator["stress_limit"] = random.choice((0, 2, 3, 4.5, 6, 9))
        operators[f"{kind}{place}"] = operator
    return operators


def _machines_and_zones_apart(data: Data) -> None:
    """Makes a machine of one robot in two: it takes part in tasks as a robot does, and may hold
    parts. One zone in three keeps kinds apart. Drawn from the cell itself, so that all else of a
    seed stays what it was.
    """
    random = Random(repr(data))
    for operator in data["operators"].values():
        if operator["kind"] == "robot" and random.random() < 0.5:
            operator["kind"] = "machine"
    for name, operator in data["operators"].items():
        chains = _chains(data["tasks"]) if operator["kind"] == "machine" else []
        if chains and random.random() < 0.8:
            pairs = random.sample(chains, min(len(chains), random.choice((1, 1, 2))))
            operator["holds"] = [list(pair) for pair in pairs]
            for pair in pairs:
                _make_room(random, data["tasks"], name, pair)
    for zone in data["zones"].values():
        if random.random() < 0.35:
            zone["apart"] = random.sample(KINDS, random.choice((2, 2, 3)))
            zone["capacity"] = random.choice((1, 2, 3))


def _limits(data: Data) -> None:
    """In one cell of four tasks are assessed, and people have limits on that. Drawn from the cell
    itself, so that all else of a seed stays what it was.
    """
    random = Random(f"limits {data!r}")
    people = [name for name, entry in data["operators"].items() if entry["kind"] == "human"]
    if not people or random.random() >= 0.25:
        return
    for task in data["tasks"].values():
        doers = {
            *task["time"],
            *(who for way in task.get("together", ()) for who in way["operators"]),
        }
        able = [who for who in people if who in doers]
        if able and random.random() < 0.85:
            task["ergonomics"] = [*_assessed(random), *_of_one(random, able)]
    names = _names_of_limits(data)
    for name in people:
        if names and random.random() < 0.8:
            few = random.sample(list(names), min(len(names), random.choice((1, 1, 2, 3))))
            data["operators"][name]["limits"] = {one: names[one](random) for one in few}
    data["cycles_per_shift"] = random.choice((1, 7, 420.5))


def _assessed(random: Random) -> list[Data]:
    rows: list[Data] = [{"method": "reba", "score": random.randint(1, 12)}]
    if random.random() < 0.5:
        rows += [{"method": "lifft", "score": random.randint(0, 90) / 1e5} for _ in range(2)]
    if random.random() < 0.5:
        hands = random.sample(("left", "right", "both"), random.choice((1, 2)))
        rows += [
            {"method": "duet", "score": random.randint(1, 90) / 1e7, "side": hand} for hand in hands
        ]
    return rows


def _of_one(random: Random, able: list[str]) -> list[Data]:
    """People differ: somebody may have an assessment of their own."""
    if random.random() >= 0.3:
        return []
    who = random.sample(able, 1)
    return [{"method": "reba", "score": random.randint(1, 12), "operators": who}]


def _names_of_limits(data: Data) -> dict[str, Callable[[Random], float]]:
    """Limits that the cell can have -> how much is drawn of each."""
    rows = [row for task in data["tasks"].values() for row in task.get("ergonomics", ())]
    scales = {row["method"] for row in rows}
    sided = {row.get("side") for row in rows} & {"left", "right"}
    longest = max(time for task in data["tasks"].values() for time in (*task["time"].values(), 0.1))
    found: dict[str, Callable[[Random], float]] = {}
    if "reba" in scales:
        found["peak:reba"] = lambda random: random.randint(2, 12)
        found["time-above:reba:6"] = lambda random: round(longest * random.uniform(0, 3), 6)
        found["time-above:reba:9.5"] = lambda random: random.choice((0, longest))
    if "lifft" in scales:
        found["dose:lifft"] = lambda random: round(random.uniform(0, 0.002) * 7, 6)
    if "duet" in scales:
        found["dose:duet"] = lambda random: round(random.uniform(0, 2e-5) * 420.5, 6)
    if sided:
        found["dose:duet-left"] = lambda random: round(random.uniform(0, 2e-5) * 420.5, 6)
    if "stress_of_set" not in data:
        found["peak:stress"] = lambda random: random.choice((0, 2.5, 4, 6))
        found["time-above:stress:3"] = lambda random: round(longest * random.uniform(0, 3), 6)
        found["dose:stress"] = lambda random: random.choice((0, 5, 9, 60, 2000))
    return found


def _chains(tasks: Data) -> list[tuple[str, str]]:
    """Pairs of tasks of which the second comes after the first."""

    def ahead(name: str) -> set[str]:
        waits = tasks[name].get("wait", ())
        waits = [waits] if isinstance(waits, dict) else waits
        ended = (wait["after"] for wait in waits if wait.get("between") != "start-start")
        direct = {*tasks[name].get("after", ()), *ended}
        return direct.union(*(ahead(first) for first in direct))

    return [(first, name) for name in tasks for first in tasks if first in ahead(name)]


def _make_room(random: Random, tasks: Data, machine: str, pair: tuple[str, str]) -> None:
    """In half of all cases others can put the part in and take it out without the machine."""
    for name in pair:
        others = {who: time for who, time in tasks[name]["time"].items() if who != machine}
        if others and random.random() < 0.5:
            tasks[name]["time"] = others


def _tools(random: Random, clock: _Clock, operators: list[str]) -> Data:
    tools: Data = {}
    for name in ("driver", "wrench", "press")[: random.choices((0, 1, 2, 3), (5, 2, 3, 1))[0]]:
        changing = random.sample(operators, random.randint(0, len(operators)))
        tools[name] = {
            "capacity": random.choice((1, 1, 2)),
            "changeover": {who: clock.seconds(0, 0.5) for who in changing},
        }
    return tools


def _zones(random: Random) -> Data:
    count = random.choices((0, 1, 2), (5, 2, 1))[0]
    return {name: {"capacity": random.choice((1, 1, 2))} for name in ("jig", "bench")[:count]}


def _task(random: Random, clock: _Clock, operators: Data, earlier: list[str], fine: bool) -> Data:
    groups = [
        group for size in range(2, len(operators) + 1) for group in combinations(operators, size)
    ]
    joint = (
        random.sample(groups, random.randint(1, min(2, len(groups))))
        if groups and random.random() < 0.25
        else []
    )
    alone = random.sample(list(operators), random.randint(0 if joint else 1, len(operators)))
    task: Data = {
        "time": {who: clock.seconds() for who in alone},
        "stress": _stress(random, operators, fine),
    }
    if joint:
        task["together"] = [_together(random, clock, operators, group, fine) for group in joint]
    if earlier and random.random() < 0.5:
        task["after"] = random.sample(earlier, random.randint(1, min(2, len(earlier))))
    return task


def _together(
    random: Random, clock: _Clock, operators: Data, group: tuple[str, ...], fine: bool
) -> Data:
    joint: Data = {"operators": random.sample(group, len(group)), "time": clock.seconds()}
    if random.random() < 0.5:
        joint["stress"] = _stress(random, {who: operators[who] for who in group}, fine)
    return joint


def _own_tools(random: Random, data: Data) -> None:
    """In some cells, what one operator needs another one need not; a group may need what nobody
    needs alone.
    """
    if data["tools"] and random.random() < 0.4:
        for task in data["tasks"].values():
            _own_tools_of(random, task, list(data["tools"]))


def _own_tools_of(random: Random, task: Data, tools: list[str]) -> None:
    def drawn(who: list[str]) -> Any:
        if random.random() < 0.3:
            return random.choice(tools)
        return {name: random.choice(tools) for name in who if random.random() < 0.6}

    groups = task.get("together", ())
    if random.random() < 0.6:
        everybody = dict.fromkeys((*task["time"], *(who for j in groups for who in j["operators"])))
        task["tool"] = drawn(list(everybody))
    for joint in groups:
        if random.random() < 0.4:
            joint["tool"] = drawn(joint["operators"])


def _places(random: Random, clock: _Clock, data: Data) -> None:
    """In some cells, where tasks are done, and how long it takes who to walk there; never longer
    than by another place.
    """
    if random.random() < 0.7:
        return
    names = ["bench", "press", "shelf"][: random.choice((2, 2, 3))]
    for part in (*data["tasks"].values(), *data["operators"].values()):
        if random.random() < (0.7 if "kind" not in part else 0.3):
            part["place"] = random.choice(names)
    used = {part.get("place") for table in ("tasks", "operators") for part in data[table].values()}
    names = [name for name in names if name in used]
    walk: Data = {}
    for who in data["operators"]:
        if len(names) < 2 or random.random() < 0.25:
            continue
        ways = {(a, b): clock.seconds(0, 0.5) for a in names for b in names if a != b}
        if random.random() < 0.6:
            ways |= {(b, a): ways[a, b] for a, b in ways if a < b}
        for by in names:
            for a, b in ways:
                if by not in (a, b):
                    ways[a, b] = min(ways[a, b], round(ways[a, by] + ways[by, b], 6))
        walk[who] = {f"{a}-{b}": seconds for (a, b), seconds in ways.items()}
    if walk:
        data["walk"] = walk


def _stress(random: Random, operators: Data, fine: bool) -> float | dict[str, float]:
    def amount() -> float:
        if fine:
            return round(random.random() * 10, 6)
        return random.choice((0, 1, 2, 3, 4, 0.5, 1.25, 0.1, 0.3))

    humans = [name for name, operator in operators.items() if operator["kind"] == "human"]
    if humans and random.random() < 0.25:
        return {name: amount() for name in random.sample(humans, random.randint(1, len(humans)))}
    return amount()


def _windows(random: Random, clock: _Clock, tasks: Data) -> None:
    """Releases in half of all cells, deadlines in half of all cells, tight and loose ones."""
    if random.random() < 0.5:
        for task in tasks.values():
            if random.random() < 0.4:
                task["release"] = clock.seconds(0, 1.25)
    if random.random() < 0.5:
        for task in tasks.values():
            if random.random() < 0.5:
                quickest = min(
                    [*task["time"].values(), *(joint["time"] for joint in task.get("together", ()))]
                )
                spare = clock.seconds(0, random.choice((0.25, 1.0, 2.0, 3.0)))
                task["deadline"] = round(task.get("release", 0) + quickest + spare, 6)


def _waits(random: Random, clock: _Clock, names: list[str], tasks: Data, fine: bool) -> None:
    """One or two waits, between ends and starts and between starts, tight and loose ones; where
    ticks are fine without a most, which a brute force could not try all moments for.
    """
    for _ in range(random.choice((1, 1, 2))):
        place = random.randint(1, len(names) - 1)
        wait: Data = {"after": random.choice(names[:place])}
        if random.random() < 0.4:
            wait["between"] = "start-start"
        if random.random() < 0.7:
            wait["at_least"] = clock.seconds(0, 0.6)
        if random.random() < 0.65 and not fine:
            more = clock.seconds(0, 1.0) if random.random() < 0.6 else 0.0
            wait["at_most"] = round(wait.get("at_least", 0.0) + more, 6)
        kept = tasks[names[place]].setdefault("wait", [])
        if all(
            (wait["after"], wait.get("between")) != (other["after"], other.get("between"))
            for other in kept
        ):
            kept.append(wait)


def _table(random: Random, tasks: Data, operators: Data) -> dict[str, float]:
    """Stress of every set of tasks that humans may do, not additive; a few sets are left out and so
    forbidden.
    """
    weights = {
        name: random.randint(0, 6)
        for name, task in tasks.items()
        if any(
            operators[who]["kind"] == "human"
            for who in (
                *task["time"],
                *(w for j in task.get("together", ()) for w in j["operators"]),
            )
        )
    }
    sets = [names for size in range(len(weights) + 1) for names in combinations(weights, size)]
    missing = random.sample(sets, min(len(sets) - 1, random.randint(0, 2)))
    bend = random.choice((0, 0.5, 1.5))
    return {
        ",".join(names): sum(weights[name] for name in names)
        + bend * max((weights[name] for name in names), default=0) * len(names)
        for names in sets
        if names not in missing
    }
