"""Random small cells to three judges: the exact method, the exhaustive search and a brute force
that knows neither.

Each cell is drawn from its own seed, so that one cell is repeated by `--seed SEED --cells 1`. A
cell is asked for its front and for a few single answers: least makespan, least stress, a weighted
sum, each with and without limits that cut the front. Every schedule that comes back is looked at by
the brute force too, and played in the event world, where it must take exactly its makespan.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from importlib.metadata import version
from pathlib import Path
from random import Random
from typing import Any

from tests.fuzz.cells import cell as random_cell
from tests.plan.brute_force import Point, front_in_order, front_of_all, moments, worth

from tandem.cell.model import Cell
from tandem.errors import (
    CellError,
    InfeasibleError,
    NothingFoundError,
    UnsoundScheduleError,
    UsageError,
)
from tandem.files.validate import cell_of
from tandem.plan.door import RefusedScheduleWarning
from tandem.plan.methods import METHODS
from tandem.plan.question import Question
from tandem.plan.result import Front
from tandem.world.replay import replay

JUDGES = ("exact", "exhaustive")
WEIGHTS = (
    (1.0, 1.0),
    (1.0, 0.5),
    (0.25, 3.0),
    (1.0, 0.0),
    (0.0, 1.0),
    (1e-6, 1e6),
    (1e6, 1e-6),
    (0.001, 7.0),
)
MOST_MOMENTS = 20_000
"""Up to so many ways of placing all tasks on their grid, every one is tried besides."""
SLICE = 20
"""Cells that a process does at once."""
FOUND = Path("tandem-out", "fuzz")


@dataclass(frozen=True)
class Finding:
    """A question to which a judge gave a wrong answer, or none."""

    seed: int
    method: str
    question: Mapping[str, Any]
    said: str
    right: str
    cell: Mapping[str, Any]

    def store(self, folder: Path) -> Path:
        """Writes it to a file of its own; the cell in it is a cell file as it stands."""
        folder.mkdir(parents=True, exist_ok=True)
        place = folder / f"judges-{self.seed}-{self.method}-{self.question['minimize']}.json"
        place.write_text(json.dumps(vars(self), indent=1, default=dict) + "\n", encoding="utf-8")
        return place


@dataclass
class Tally:
    """What was asked, and what was found.

    Attributes:
      cells: drawn. `refused` of them are no sound cells, which is right when they have no schedule.
      infeasible: cells without a schedule, as the brute force says.
      replayed: schedules that were played in the event world.
      every_moment: cells small enough for the second brute force, which tries all moments.
    """

    cells: int = 0
    infeasible: int = 0
    refused: int = 0
    with_deadlines: int = 0
    with_releases: int = 0
    with_setups: int = 0
    with_waits: int = 0
    replayed: int = 0
    every_moment: int = 0
    questions: Counter[str] = field(default_factory=Counter)
    findings: list[Finding] = field(default_factory=list)

    def add(self, other: Tally) -> None:
        """Takes in the tally of another slice."""
        for name, value in vars(other).items():
            setattr(self, name, getattr(self, name) + value)


def drawn(seed: int, key: str | None) -> tuple[Random, dict[str, Any]]:
    """The cell of this seed, and the draws behind it; the first one with the key where one is asked
    for.
    """
    random = Random(seed)
    data = random_cell(random)
    while key is not None and not uses(data, key):
        data = random_cell(random)
    return random, data


def uses(data: Mapping[str, Any], key: str) -> bool:
    """Whether the cell says something with this key, be it its own or that of an operator, a task,
    a tool or a zone; or has an operator of this kind. "own_tools" stands for tools by operator or
    by group.
    """
    parts = [
        entry
        for table in ("operators", "tasks", "tools", "zones")
        for entry in data[table].values()
    ]
    if key == "own_tools":
        return any(isinstance(task.get("tool"), dict) for task in data["tasks"].values()) or any(
            "tool" in joint for task in data["tasks"].values() for joint in task.get("together", ())
        )
    return any(part.get(key) or part.get("kind") == key for part in (data, *parts))


def judge(seed: int, key: str | None = None) -> Tally:
    """Draws the cell of this seed and asks the judges."""
    random, data = drawn(seed, key)
    features = {
        f"with_{name}s": int(uses(data, name)) for name in ("deadline", "release", "setup", "wait")
    }
    tally = Tally(cells=1, **features)
    right = front_in_order(data)
    tally.infeasible = int(not right)
    if moments(data) ** len(data["tasks"]) * _choices(data) <= MOST_MOMENTS:
        tally.every_moment = 1
        if (everywhere := front_of_all(data)) != right:
            tally.findings.append(
                Finding(
                    seed, "brute force", {"minimize": "front"}, str(right), str(everywhere), data
                )
            )
    try:
        cell = cell_of(data)
    except CellError as error:
        tally.refused = 1
        if right:
            tally.findings.append(
                Finding(seed, "cell", {"minimize": "front"}, str(error), str(right), data)
            )
        return tally
    for question in questions(random, right):
        for method in JUDGES:
            tally.questions[f"{method} {_kind(question)}"] += 1
            said, schedules = wrong(data, cell, method, question, right, workers=1 + seed % 2)
            tally.replayed += schedules
            if said is not None:
                wanted = str(wanted_points(question, right))
                tally.findings.append(Finding(seed, method, question.to_dict(), said, wanted, data))
    return tally


def questions(random: Random, front: list[Point]) -> Iterator[Question]:
    """The whole front, and two of the other questions, with limits on, between and beyond the
    front's points.
    """
    yield Question()
    for minimize in random.sample(("front", "makespan", "stress", "weighted"), 2):
        weights = random.choice(
            (
                *WEIGHTS,
                (round(random.random(), 15), random.random()),
                (random.random() * 1e6, round(random.random() * 1e-4, 9)),
            )
        )
        time = load = None
        if front and (minimize == "front" or random.random() < 0.6):
            time = _limit(random, [time for time, _ in front])
            load = _limit(random, [load for _, load in front])
        yield Question(minimize, weights, time, load)


def _limit(random: Random, values: list[float]) -> float | None:
    if random.random() < 0.4:
        return None
    value = random.choice(values)
    return max(
        0.0,
        random.choice(
            (
                value,
                value,
                round(value + 0.01, 6),
                round(value - 0.01, 6),
                round(value * random.random() * 2, 6),
            )
        ),
    )


def wanted_points(question: Question, front: list[Point]) -> list[Point]:
    """What answers the question, read off the whole front; of a weighted sum every best point."""
    time, load = question.max_makespan, question.max_stress
    kept = [p for p in front if (time is None or p[0] <= time) and (load is None or p[1] <= load)]
    if question.minimize == "front" or not kept:
        return kept
    if question.minimize == "makespan":
        return kept[:1]
    if question.minimize == "stress":
        return kept[-1:]
    first, second = (Fraction(repr(weight)) for weight in question.weights)
    if not first or not second:
        return kept[:1] if first else kept[-1:]
    cost = [first * Fraction(repr(p[0])) + second * Fraction(repr(p[1])) for p in kept]
    return [p for p, value in zip(kept, cost, strict=True) if value == min(cost)]


def wrong(
    data: Mapping[str, Any],
    cell: Cell,
    method: str,
    question: Question,
    front: list[Point],
    workers: int = 1,
) -> tuple[str | None, int]:
    """What the method said that is not right, None when all of it is; and how many of its schedules
    were played.
    """
    wanted = wanted_points(question, front)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RefusedScheduleWarning)
            said = METHODS[method](cell, question, time_limit=60, workers=workers)
    except InfeasibleError:
        return ("infeasible" if wanted else None), 0
    except NothingFoundError as error:
        return str(error), 0
    except UsageError as error:
        return (None if "digits" in str(error) else str(error)), 0
    except Exception as error:  # noqa: BLE001  whatever it is, it is a finding
        return f"{type(error).__name__}: {error}", 0
    if said.points not in ([[p] for p in wanted] if question.minimize == "weighted" else [wanted]):
        return f"{said.points}, {'complete' if said.complete else 'not complete'}", 0
    return _unproven(data, said) or _unlike_in_the_world(cell, said), len(said)


def _unproven(data: Mapping[str, Any], front: Front) -> str | None:
    """What is missing in an answer whose points are right."""
    if not front.complete:
        return f"{front.points}, but not complete"
    for result in front:
        rows = [(a.task, a.start, a.end, a.operators) for a in result.schedule]
        if worth(data, rows) != (result.makespan, result.stress):
            return f"a schedule that is not what it says: {rows}"
        if (result.status, result.bound.makespan, result.bound.stress) != (
            "optimal",
            result.makespan,
            result.stress,
        ):
            return (
                f"a point that is not proven: {result.makespan, result.stress}, {result.status},"
                f" {result.bound}"
            )
    return None


def _unlike_in_the_world(cell: Cell, front: Front) -> str | None:
    """A schedule that the event world does not let be played, or that takes another time there."""
    for result in front:
        try:
            took = replay(cell, result.schedule)
        except UnsoundScheduleError as error:
            return f"the world: {error}"
        if took != result.makespan:
            return f"the world: it takes {took} s, not {result.makespan} s"
    return None


def _choices(data: Mapping[str, Any]) -> int:
    count = 1
    for task in data["tasks"].values():
        count *= len(task["time"]) + len(task.get("together", ()))
    return count


def _kind(question: Question) -> str:
    limited = question.max_makespan is not None or question.max_stress is not None
    return question.minimize + (" with limits" if limited else "")


def judge_all(seeds: range, until: float, key: str | None = None) -> Tally:
    """Judges the cells of these seeds, until the time is up (`time.time()`)."""
    tally = Tally()
    for seed in seeds:
        if time.time() > until:
            break
        tally.add(judge(seed, key))
    return tally


def run(cells: int, seed: int, minutes: float, workers: int, key: str | None = None) -> Tally:
    """The tally of so many cells, or of as many as there is time for; progress and findings are
    printed.
    """
    until, total = time.time() + 60 * minutes, Tally()
    slices = [
        range(first, min(first + SLICE, seed + cells)) for first in range(seed, seed + cells, SLICE)
    ]
    with ProcessPoolExecutor(workers) as pool:
        work = partial(judge_all, until=until, key=key)
        done = pool.map(work, slices) if workers > 1 else map(work, slices)
        for tally in done:
            total.add(tally)
            for finding in tally.findings:
                report(finding, key)
            print(
                f"\r{total.cells} cells, {len(total.findings)} differ",
                end="",
                file=sys.stderr,
                flush=True,
            )
    print(file=sys.stderr)
    return total


def report(finding: Finding, key: str | None = None) -> None:
    """Prints a finding, where it is stored and how it is repeated."""
    print(
        "\n"
        f"{finding.method}, {json.dumps(finding.question)}\n"
        f"  says  {finding.said}\n"
        f"  right {finding.right}"
    )
    print(
        f"  {finding.store(FOUND)}\n"
        f"  python3 dev.py fuzz judges --cells 1 --seed {finding.seed}{_with(key)}",
        flush=True,
    )


def _with(key: str | None) -> str:
    return "" if key is None else f" --with {key}"


def summary(total: Tally, seed: int, wall_s: float, key: str | None = None) -> dict[str, Any]:
    """What was asked, of which versions, and how often they differed."""
    kept = {
        name: value for name, value in vars(total).items() if name not in ("findings", "questions")
    }
    return {
        "command": f"python3 dev.py fuzz judges --cells {total.cells} --seed {seed}{_with(key)}",
        "first_seed": seed,
        "judged": total.cells - total.refused,
        **kept,
        "questions": dict(sorted(total.questions.items())),
        "differ": len(total.findings),
        "wall_s": round(wall_s, 1),
        "versions": {
            "tandem": version("tandem"),
            "ortools": version("ortools"),
            "python": sys.version.split()[0],
        },
    }


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="dev.py fuzz judges", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--cells", type=int, default=300, help="how many cells (300)")
    parser.add_argument(
        "--seed", type=int, default=1, help="seed of the first cell; the others follow (1)"
    )
    parser.add_argument(
        "--with",
        dest="key",
        metavar="KEY",
        help="draw only cells that use this key, such as setup or own_tools",
    )
    parser.add_argument("--minutes", type=float, default=600.0, help="stop after so many minutes")
    parser.add_argument("--workers", type=int, default=1, help="processes (1)")
    parser.add_argument("--out", type=Path, help="write the summary to this file as well")
    asked = parser.parse_args()
    began = time.time()
    total = run(asked.cells, asked.seed, asked.minutes, asked.workers, asked.key)
    text = json.dumps(summary(total, asked.seed, time.time() - began, asked.key), indent=1)
    print(text)
    if asked.out:
        asked.out.write_text(text + "\n", encoding="utf-8")
    return 1 if total.findings else 0


if __name__ == "__main__":
    sys.exit(main())
