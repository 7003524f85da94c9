"""Random assessed cells, and a judge of fronts over their measures that shares nothing with the
planner: all allocations in all orders, from plain data, in fractions.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from random import Random
from typing import Any

MEASURES = (
    "stress",
    "worst:stress",
    "peak:reba",
    "time-above:reba:6",
    "worst:time-above:reba:6",
    "time-weighted:reba",
    "dose:shoulder_tool",
    "worst:dose:shoulder_tool",
)


def assessed(random: Random, tasks: int = 4) -> dict[str, Any]:
    """A cell of two people and a robot, assessed on two scales; some tasks are done together, and
    one task lacks a value.
    """
    rows: dict[str, Any] = {}
    for place in range(tasks):
        name = f"t{place}"
        row: dict[str, Any] = {
            "time": {who: random.randint(1, 9) for who in ("anna", "ben")},
            "stress": {"anna": random.randint(0, 6), "ben": random.randint(0, 6)},
            "ergonomics": [
                {"method": "reba", "score": random.randint(1, 12)},
                {"method": "shoulder_tool", "score": random.randint(1, 30) / 1e6},
            ],
        }
        if random.random() < 0.7:
            row["time"]["robot"] = random.randint(1, 14)
        if random.random() < 0.3:
            row["together"] = [{"operators": ["anna", "robot"], "time": random.randint(1, 5)}]
        if place and random.random() < 0.5:
            row["after"] = [f"t{random.randrange(place)}"]
        rows[name] = row
    rows["t0"]["ergonomics"] = [{"method": "reba", "score": 5, "operators": ["anna"]}]
    operators = {"robot": {"kind": "robot"}, "anna": {"kind": "human"}, "ben": {"kind": "human"}}
    return {"operators": operators, "tasks": rows}


def by_hand(data: dict[str, Any], ways: dict[str, tuple[tuple[str, ...], int]]) -> dict[str, Any]:
    """What the measures of a cycle come to, before the makespan, said once more from plain data."""
    people = ("anna", "ben")
    zero = {who: Fraction(0) for who in people}
    stress, above, dose, weighted = dict(zero), dict(zero), dict(zero), dict(zero)
    peak = 0
    for name, (who_all, seconds) in ways.items():
        for who in set(who_all) & set(people):
            row = data["tasks"][name]
            stress[who] += row["stress"][who]
            for one in row["ergonomics"]:
                if who not in one.get("operators", people):
                    continue
                if one["method"] == "shoulder_tool":
                    dose[who] += Fraction(repr(one["score"]))
                    continue
                peak = max(peak, one["score"])
                above[who] += seconds * (one["score"] >= 6)
                weighted[who] += seconds * one["score"]
    return {
        "stress": sum(stress.values()),
        "worst:stress": max(stress.values()),
        "peak:reba": peak,
        "time-above:reba:6": sum(above.values()),
        "worst:time-above:reba:6": max(above.values()),
        "time-weighted:reba": sum(weighted.values()) / 2,
        "dose:shoulder_tool": sum(dose.values()) * 28_800,
        "worst:dose:shoulder_tool": max(dose.values()) * 28_800,
    }


def of_all(data: dict[str, Any]) -> list[tuple[int, dict[str, Any]]]:
    """Of every allocation its least makespan and what its measures come to."""
    names = list(data["tasks"])
    options = []
    for name in names:
        row = data["tasks"][name]
        alone = [((who,), seconds) for who, seconds in row["time"].items()]
        options.append(
            [*alone, *((tuple(j["operators"]), j["time"]) for j in row.get("together", ()))]
        )
    found = []
    for chosen in product(*options):
        ways = dict(zip(names, chosen, strict=True))
        found.append((_quickest(data, ways), by_hand(data, ways)))
    return found


def _quickest(data: dict[str, Any], ways: dict[str, tuple[tuple[str, ...], int]]) -> int:
    """The least makespan of an allocation: every order, each task as early as it can be."""

    def best(left: frozenset[str], ends: dict[str, int], free: dict[str, int]) -> int:
        if not left:
            return max(ends.values())
        found = []
        for name in left:
            first = data["tasks"][name].get("after", [])
            if any(one in left for one in first):
                continue
            who, seconds = ways[name]
            end = seconds + max([0, *(ends[f] for f in first), *(free[w] for w in who)])
            found.append(
                best(left - {name}, {**ends, name: end}, {**free, **dict.fromkeys(who, end)})
            )
        return min(found)

    return best(frozenset(ways), {}, dict.fromkeys(("anna", "ben", "robot"), 0))


def least(points: set[tuple[Any, ...]]) -> set[tuple[Any, ...]]:
    return {
        p
        for p in points
        if not any(q != p and all(a <= b for a, b in zip(q, p, strict=True)) for q in points)
    }


def expected(
    everything: list[tuple[int, dict[str, Any]]], names: tuple[str, ...]
) -> list[tuple[float, ...]]:
    """The front over the makespan and these measures, sorted: a dose of a shift and a mean over
    time are what the allocation decides, over the makespan.
    """
    over = [
        name.split(":")[-2] in ("dose", "time-weighted") if ":" in name else False for name in names
    ]
    rows = least({(t, *(values[name] for name in names)) for t, values in everything})
    return sorted(
        (float(t), *(float(v / t if by else v) for v, by in zip(values, over, strict=True)))
        for t, *values in rows
    )
