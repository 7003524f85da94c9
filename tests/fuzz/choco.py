"""Random cells of 20 to 30 tasks to a second engine: is each optimum that the exact method proves
one for Choco too, and each infeasibility?

Of each cell four things are asked: whether the proven optimum can be reached, whether anything is
quicker, whether anything is gentler in the same time, and whether the cell can be done within
random limits of time and of each person's stress. The model (`tests/plan/choco.py`) is written from
the page about cell files and shares nothing with Tandem. What Choco cannot settle within its limits
is counted apart; it is no agreement.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from importlib.metadata import version
from math import inf
from pathlib import Path
from random import Random
from typing import Any

from tests.plan.choco import Question as Second

from tandem.errors import InfeasibleError, NothingFoundError
from tandem.files.validate import cell_of
from tandem.plan.methods import METHODS
from tandem.plan.question import Question
from tandem.plan.result import Front

NODES = 40_000
SECONDS = 600
"""Choco gives up by nodes, so that a busy machine changes nothing; this only ends what hangs."""
FOUND = Path("tandem-out", "fuzz")
Data = dict[str, Any]


@dataclass(frozen=True)
class Asked:
    """A question, and what the exact method says.

    Attributes:
      allocation: who does what in its schedule, when it has one.
    """

    kind: str
    cell: Data
    makespan: int
    stress: int | None
    right: bool
    allocation: Mapping[str, list[str]] | None = None


def drawn(random: Random) -> Data:
    """A cell of 20 to 30 tasks and two or three operators, in whole seconds. Most tasks can be done
    by one of them only, so that both engines can settle what is asked.
    """
    kinds = random.choice((["human", "robot"], ["human", "human"], ["human", "human", "robot"]))
    crew = [f"{kind}{place}" for place, kind in enumerate(kinds)]
    operators = {name: {"kind": kind} for name, kind in zip(crew, kinds, strict=True)}
    tasks: Data = {}
    for place in range(random.randint(20, 30)):
        can = random.sample(crew, 1 if random.random() < 0.6 else random.randint(1, len(crew)))
        before = random.sample(range(place), min(place, random.choice((0, 1, 1, 2))))
        task: Data = {
            "time": {name: random.randint(2, 12) for name in can},
            "stress": random.randint(0, 9),
            "after": [f"t{other}" for other in before],
        }
        if random.random() < 0.1:
            both = random.sample(crew, 2)
            task["together"] = [{"operators": both, "time": random.randint(2, 8)}]
        if random.random() < 0.2:
            task["zone"] = "fixture"
        if random.random() < 0.2:
            task["tool"] = "driver"
        if random.random() < 0.1:
            task["release"] = random.randint(1, 20)
        tasks[f"t{place}"] = task
    return {
        "operators": operators,
        "tasks": tasks,
        "zones": {"fixture": {"capacity": 2}},
        "tools": {"driver": {"capacity": random.choice((1, 2))}},
    }


def exact(cell: Data, question: Question) -> Front | None:
    """What the exact method gives, proven; None when it is proven that there is nothing. Raises
    NothingFoundError when it proves neither.
    """
    try:
        front = METHODS["exact"](cell_of(cell), question, time_limit=20, workers=1)
    except InfeasibleError:
        return None
    if not front.complete:
        raise NothingFoundError("not proven in time.")
    return front


def questions(random: Random) -> Iterator[Asked]:
    """Four about one random cell; fewer when the exact method has proven less."""
    cell = drawn(random)
    best = exact(cell, Question("makespan"))
    if best is None:
        return
    makespan, stress = round(best[0].makespan), round(best[0].stress)
    who = {a.task: list(a.operators) for a in best[0].schedule}
    yield Asked("the optimum", cell, makespan, stress, True, who)
    yield Asked("anything quicker", cell, makespan - 1, None, False)
    yield Asked("anything gentler", cell, makespan, stress - 1, False)
    limited, latest = deepcopy(cell), round(makespan * random.uniform(1.0, 1.2))
    most = best[0].worst_stress
    for operator in limited["operators"].values():
        if operator["kind"] == "human":
            operator["stress_limit"] = round(most * random.uniform(0.75, 1.4))
    within = exact(limited, Question("makespan", max_makespan=latest))
    who = {a.task: list(a.operators) for a in within[0].schedule} if within is not None else {}
    yield Asked("random limits", limited, latest, None, within is not None, who)


def settled(asked: Asked) -> bool | None:
    """What Choco says; where it finds nothing in its time but there should be something, whether it
    accepts who does what.
    """
    limits = {"nodes": NODES, "seconds": SECONDS}
    said = Second(asked.cell, asked.makespan, asked.stress).answer(**limits)
    if said is None and asked.right:
        given = Second(asked.cell, asked.makespan, asked.stress, asked.allocation).answer(**limits)
        # with a given allocation "no" is no answer to the question but a disagreement all the same
        return given
    return said


def main(arguments: list[str] | None = None) -> int:
    """Asks, and says how often the two agreed; 1 when they differed once."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--questions", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--store", type=Path, help="where the counts go, as JSON")
    parser.add_argument("--minutes", type=float, help="stop after so many")
    asked_for = parser.parse_args(arguments)
    tally, seed = Tally(asked_for.seed), asked_for.seed
    while tally.settled < asked_for.questions and tally.minutes < (asked_for.minutes or inf):
        tally.take(seed)
        seed += 1
        if asked_for.store is not None:
            # as far as it has come, so that a run may be stopped
            text = json.dumps(tally.to_dict(), indent=1) + "\n"
            asked_for.store.write_text(text, encoding="utf-8")
    print("\n".join(tally.sentences()))
    return int(tally.count("differ") > 0)


@dataclass
class Tally:
    """What was asked of cells from the first seed on, and how it came out."""

    first: int
    began: float = field(default_factory=time.monotonic)
    kinds: dict[str, Counter[str]] = field(default_factory=dict)
    cells: int = 0
    not_proven: int = 0

    def take(self, seed: int) -> None:
        """Asks about the cell of this seed; what differs is stored."""
        self.cells += 1
        try:
            for asked in questions(Random(seed)):
                said = settled(asked)
                agreed = "agreed" if said == asked.right else "differ"
                outcome = "not settled" if said is None else agreed
                kind = f"{asked.kind}: {'yes' if asked.right else 'no'}"
                self.kinds.setdefault(kind, Counter())[outcome] += 1
                if outcome == "differ":
                    FOUND.mkdir(parents=True, exist_ok=True)
                    place = FOUND / f"choco-{seed}-{asked.kind.replace(' ', '-')}.json"
                    place.write_text(json.dumps(vars(asked), indent=1) + "\n", encoding="utf-8")
                    print(f"seed {seed}: {asked.kind}: Choco says {said}. Stored as {place}.")
        except NothingFoundError:
            self.not_proven += 1

    def count(self, outcome: str) -> int:
        """Questions that came out so."""
        return sum(row[outcome] for row in self.kinds.values())

    @property
    def settled(self) -> int:
        """Questions that both engines have answered."""
        return self.count("agreed") + self.count("differ")

    @property
    def minutes(self) -> float:
        """Since it began."""
        return (time.monotonic() - self.began) / 60

    def sentences(self) -> list[str]:
        """What is printed."""
        rows = [
            f"  {kind:<24} {row['agreed']} agreed, {row['differ']} differ,"
            f" {row['not settled']} not settled by Choco"
            for kind, row in sorted(self.kinds.items())
        ]
        return [
            f"{self.cells} cells, {self.settled} questions settled by both engines:",
            *rows,
            f"{self.count('differ')} differ. {60 * self.minutes:.0f} s.",
        ]

    def to_dict(self) -> dict[str, Any]:
        """What is stored."""
        return {
            "command": f"python3 dev.py fuzz choco --questions {self.settled} --seed {self.first}",
            "engines": [f"ortools {version('ortools')}", f"pychoco {version('pychoco')}"],
            "tasks": [20, 30],
            "nodes": NODES,
            "cells": self.cells,
            "cells_not_proven": self.not_proven,
            "questions_settled": self.settled,
            "differ": self.count("differ"),
            "not_settled": self.count("not settled"),
            "by_kind": {kind: dict(row) for kind, row in sorted(self.kinds.items())},
            "wall_s": round(60 * self.minutes),
        }


if __name__ == "__main__":
    sys.exit(main())
