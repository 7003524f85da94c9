"""Random facts to each method of ergonomics and to its second implementation in the tests.

`python -m tests.fuzz.ergonomics --inputs 1000000` asks both for so many inputs each. Angles, loads
and rates fall on the limits of the bands in a third of the draws, where mistakes would be.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tests.ergonomics.second import fatigue, niosh, reba, rula, strain

from tandem.ergonomics import METHODS, score
from tandem.ergonomics.facts import about
from tandem.ergonomics.methods import published
from tandem.ergonomics.outcome import Outcome

Array = NDArray[np.float64]
BATCH = 10_000
LIMITS = (-20, -15, 0, 2, 4, 5, 10, 15, 20, 30, 45, 60, 75, 90, 100)
"""Where bands of the methods end."""


@dataclass(frozen=True)
class Judge:
    """A method beside its second implementation.

    Attributes:
      words: fact -> the words that its numbers stand for in the second implementation.
      second: arrays of facts to scores.
      tolerance: relative; 0 where scores are whole.
      draws: fact -> its range where that of the model is wider than what is of interest.
    """

    second: Callable[[Mapping[str, Array]], Array]
    words: Mapping[str, tuple[str, ...]]
    tolerance: float = 0.0
    draws: Mapping[str, tuple[float, float]] | None = None


JUDGES = {
    "rula": Judge(
        rula.grand,
        {
            "load_pattern": ("intermittent", "static", "repeated", "shock"),
            "wrist_twist": ("mid", "end"),
        },
        draws={"load_kg": (0, 15), "repeats_per_min": (0, 8)},
    ),
    "reba": Judge(
        reba.reba,
        {"coupling": ("good", "fair", "poor", "unacceptable")},
        draws={"load_kg": (0, 15), "repeats_per_min": (0, 8)},
    ),
    "niosh": Judge(
        lambda f: f["L"] / niosh.rwl(f),
        {"duration": ("short", "moderate", "long"), "coupling": ("good", "fair", "poor")},
        1e-9,
        {
            "H": (0, 70), "V": (0, 190), "D": (0, 190), "A": (0, 150), "F": (0, 17), "L": (0.1, 60),
        },
    ),
    "rsi": Judge(
        strain.rsi, {}, 1e-9, {"E": (0.1, 120), "D": (0.05, 100), "I": (0.01, 1), "H": (0.01, 12)}
    ),
    "lifft": Judge(fatigue.lifft, {}, 1e-6, {"load_kg": (0, 40), "lever_cm": (0, 100)}),
    "duet": Judge(fatigue.duet, {}, 0.02),
    "shoulder_tool": Judge(
        fatigue.shoulder,
        {"type": ("handling", "horizontal_push_pull", "push_pull_down")},
        1e-9,
        {"load_kg": (0, 20)},
    ),
}  # fmt: skip


def drawn(name: str, count: int, rng: np.random.Generator) -> dict[str, Array]:
    """`count` random facts of a method, as numbers."""
    judge, found = JUDGES[name], {}
    for key, field in METHODS[name].model.model_fields.items():
        if field.annotation is bool:
            if key != "significant_control":
                found[key] = rng.integers(0, 2, count).astype(float)
        elif key in judge.words:
            found[key] = rng.integers(0, len(judge.words[key]), count).astype(float)
        elif about(field)["asked"] or key in (judge.draws or {}):
            low, high = (judge.draws or {}).get(key) or _range(field)
            values = rng.uniform(low, high, count)
            if field.annotation is int:
                values = rng.integers(int(low), int(high) + 1, count).astype(float)
            elif name != "rsi":
                on = rng.random(count) < 1 / 3
                values[on] = np.clip(rng.choice(LIMITS, count)[on], max(low, 0.1 * (low > 0)), high)
            found[key] = values
    if name == "rsi":  # no more exertion than the minute has
        found["D"] = np.minimum(found["D"], 60 / found["E"])
    return found


def _range(field: Any) -> tuple[float, float]:
    ends = {
        end: getattr(rule, end)
        for rule in field.metadata
        for end in ("ge", "gt", "le")
        if getattr(rule, end, None) is not None
    }
    return float(ends.get("ge", ends.get("gt", 0))), float(ends["le"])


def named(name: str, facts: Mapping[str, Array], place: int) -> dict[str, Any]:
    """One of the facts as people state them."""
    judge, fields = JUDGES[name], METHODS[name].model.model_fields
    found: dict[str, Any] = {}
    for key, values in facts.items():
        value = float(values[place])
        if key in judge.words:
            found[key] = judge.words[key][int(value)]
        elif fields[key].annotation is bool:
            found[key] = bool(value)
        else:
            found[key] = int(value) if fields[key].annotation is int else value
    return found


def disagreements(name: str, inputs: int, seed: int) -> list[str]:
    """Asks both for so many inputs; what they do not agree on, in sentences."""
    judge, rng, found = JUDGES[name], np.random.default_rng(seed), []
    left = inputs
    while left > 0:
        count = min(left, BATCH)
        facts = drawn(name, count, rng)
        with np.errstate(divide="ignore", invalid="ignore"):
            second = judge.second(facts)
        for place in range(count):
            asked = named(name, facts, place)
            ours, theirs = score(name, asked).score, float(second[place])
            if ours is None:
                same = not np.isfinite(theirs)
            else:
                same = abs(ours - theirs) <= judge.tolerance * abs(theirs)
            if not same:
                found.append(f"{name} {asked}: {ours}, the second implementation {theirs}")
        left -= count
    return found


def composites(inputs: int, seed: int) -> list[str]:
    """The same for jobs of several lifts (CLI) and days of several tasks (COSI, CUSI): so many of
    each.
    """
    rng, found = np.random.default_rng(seed), []
    left = inputs
    while left > 0:
        count = min(left, BATCH)
        for ours, theirs, asked in chain(_jobs(count, rng), _days(count, rng)):
            if ours is None:
                same = not np.isfinite(theirs)
            else:
                same = abs(ours - theirs) <= 1e-9 * abs(theirs)
            if not same:
                found.append(f"{asked}: {ours}, the second implementation {theirs}")
        left -= count
    return found


Compared = tuple[float | None, float, dict[str, Any]]
LIFTS, TASKS, SUBTASKS = 4, 4, 3
"""The most kinds of lift of a job, tasks of a day and subtasks of a task."""


def _jobs(count: int, rng: np.random.Generator) -> Iterator[Compared]:
    kinds = rng.integers(1, LIFTS + 1, count)
    facts = {
        key: each.reshape(count, LIFTS) for key, each in drawn("niosh", count * LIFTS, rng).items()
    }
    facts["F"] = facts["F"] / kinds[:, None]
    facts["duration"] = np.repeat(facts["duration"][:, :1], LIFTS, axis=1)
    second = niosh.cli(facts, np.arange(LIFTS) < kinds[:, None])
    flat = {key: each.ravel() for key, each in facts.items()}
    for place in range(count):
        first = place * LIFTS
        tasks = [named("niosh", flat, one) for one in range(first, first + int(kinds[place]))]
        outcome = published("niosh", "niosh_cli", {"tasks": tasks})
        assert isinstance(outcome, Outcome)
        yield outcome.score, float(second[place]), {"tasks": tasks}


def _days(count: int, rng: np.random.Generator) -> Iterator[Compared]:
    shape = (count, TASKS, SUBTASKS)
    tasks = rng.integers(1, TASKS + 1, count)
    kinds = rng.integers(1, SUBTASKS + 1, (count, TASKS))
    there = (np.arange(SUBTASKS) < kinds[:, :, None]) & (np.arange(TASKS) < tasks[:, None])[
        :, :, None
    ]
    facts = {key: each.reshape(shape) for key, each in drawn("rsi", there.size, rng).items()}
    hours = np.minimum(facts["H"][:, :, 0], 24 / tasks[:, None])
    facts["H"] = np.repeat(hours[:, :, None], SUBTASKS, axis=2)
    of_each = strain.stacked(
        np.where(there, strain.rsi(facts), 0.0), np.where(there, facts["E"], 0.0), strain.efforts
    )
    second = strain.stacked(of_each, np.where(there[:, :, 0], hours, 0.0), strain.hours)
    for place in range(count):
        days = []
        for task in range(int(tasks[place])):
            its = {key: each[place, task] for key, each in facts.items()}
            rows = [named("rsi", its, kind) for kind in range(int(kinds[place, task]))]
            days.append({"H": rows[0]["H"], "subtasks": [_less(row, "H") for row in rows]})
        outcome = published("rsi", "cusi", {"tasks": days})
        assert isinstance(outcome, Outcome)
        yield outcome.score, float(second[place]), {"tasks": days}


def _less(row: Mapping[str, Any], key: str) -> dict[str, Any]:
    return {name: value for name, value in row.items() if name != key}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--inputs", type=int, default=20_000, help="random inputs to each method")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--method", choices=[*JUDGES, "composites"], help="one method alone")
    given = parser.parse_args()
    wrong: list[str] = []
    for name in [given.method] if given.method else [*JUDGES, "composites"]:
        began = time.process_time()
        found = (
            composites(given.inputs, given.seed)
            if name == "composites"
            else disagreements(name, given.inputs, given.seed)
        )
        spent = time.process_time() - began
        print(
            f"{name}: {given.inputs:,} inputs, {len(found)} disagreements, {spent:.0f} s",
            flush=True,
        )
        wrong += found
    for sentence in wrong[:20]:
        print(sentence)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
