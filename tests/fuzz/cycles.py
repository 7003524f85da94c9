"""Random small cells as stations that repeat, to four judges: CP-SAT, the search over differences,
a brute force that knows neither, and the event world.

Each cell is drawn from its own seed, so that one cell is repeated by `--seed SEED --cells 1`. What
stands at a fixed time is left out of it. It is asked for its front with and without a limit on the
products in process, for a takt, and for single answers. The pattern behind each point is launched
twenty times and played in the event world, where the last product must leave on the tick.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import time
from collections import Counter
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from importlib.metadata import version
from pathlib import Path
from random import Random
from typing import Any

from tests.fuzz.cells import cell as random_cell
from tests.fuzz.judges import uses
from tests.plan.cycle_brute_force import Repeating, TooLarge

from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError, NothingFoundError
from tandem.files.validate import cell_of
from tandem.plan.cycle.methods import CYCLE_METHODS
from tandem.plan.cycle.question import FRONT, CycleQuestion
from tandem.plan.cycle.result import CycleFront, CycleResult
from tandem.plan.instance import Instance
from tandem.schedule import checker, cycle_checker
from tandem.schedule.cycle import copied, start_up
from tandem.schedule.measures import exact, makespan
from tandem.world.replay import replay

FEWER = (20, 3, 2)
"""So many products are launched and played; fewer where the world cannot count the ticks."""
AT_FIXED_TIMES = {"operators": ("breaks",), "tasks": ("release", "deadline")}
"""Keys that no cycle repeats."""
SECONDS = 10.0
"""For one question; a small cell takes milliseconds."""
FINE = 10_000
"""Ticks in a second from which on a search may move a bound tick by tick, and end by time."""
SLICE = 20
"""Cells that a process does at once."""
FOUND = Path("tandem-out", "fuzz")


@dataclass(frozen=True)
class Finding:
    """A question to which a judge gave a wrong answer, or none."""

    seed: int
    question: Mapping[str, Any]
    said: str
    cell: Mapping[str, Any]

    def store(self, folder: Path) -> Path:
        """Writes it to a file of its own; the cell in it is a cell file as it stands."""
        folder.mkdir(parents=True, exist_ok=True)
        place = folder / f"cycles-{self.seed}.json"
        place.write_text(json.dumps(vars(self), indent=1, default=dict) + "\n", encoding="utf-8")
        return place


@dataclass
class Tally:
    """What was asked, and what was found."""

    cells: int = 0
    refused: int = 0
    infeasible: int = 0
    too_long: int = 0
    by_brute_force: int = 0
    replayed: int = 0
    questions: Counter[str] = field(default_factory=Counter)
    findings: list[Finding] = field(default_factory=list)

    def add(self, other: Tally) -> None:
        """Takes in the tally of another slice."""
        for name, value in vars(other).items():
            setattr(self, name, getattr(self, name) + value)


def drawn(seed: int, key: str | None = None) -> tuple[Random, dict[str, Any]]:
    """The cell of this seed without what stands at a fixed time, and the draws behind it."""
    random = Random(seed)
    while True:
        data = random_cell(random)
        for table, keys in AT_FIXED_TIMES.items():
            for entry in data[table].values():
                for fixed in keys:
                    entry.pop(fixed, None)
        if key is None or uses(data, key):
            return random, data


def judge(seed: int, key: str | None = None) -> Tally:
    """Draws the cell of this seed and asks the judges."""
    random, data = drawn(seed, key)
    tally = Tally(cells=1)
    try:
        cell = cell_of(data)
    except CellError:
        tally.refused = 1
        return tally
    laps = random.choice((None, 1, 2, 3))
    fronts = {}
    for question in (FRONT, CycleQuestion(max_in_process=laps or 1)):
        fronts[question] = _judged(seed, data, cell, question, tally)
    whole = fronts[FRONT]
    tally.infeasible += whole is None
    if whole is not None:
        for question in _single(random, whole, laps):
            _judged(seed, data, cell, question, tally)
    return tally


def _single(random: Random, front: CycleFront, laps: int | None) -> list[CycleQuestion]:
    """Questions for one pattern, at, below and above the front's points."""
    time, stress = random.choice(front.points)
    takt = random.choice((time, round(time * 1.3, 6), round(time * 0.9, 6)))
    minimize: Any = random.choice(("cycle_time", "stress"))
    return [CycleQuestion(takt=takt), CycleQuestion(minimize, None, laps, stress)]


def _judged(
    seed: int, data: Mapping[str, Any], cell: Cell, question: CycleQuestion, tally: Tally
) -> CycleFront | None:
    """The front of both proofs; what is wrong goes into the tally."""

    def found(said: str) -> None:
        tally.findings.append(Finding(seed, question.to_dict(), said, data))

    answers: dict[str, CycleFront | None] = {}
    for name, method in CYCLE_METHODS.items():
        tally.questions[f"{name} {question.minimize}"] += 1
        try:
            answers[name] = method(
                cell,
                question,
                time_limit=SECONDS,
                work=None,
                seed=0,
                workers=1 + seed % 2,
                on_point=None,
            )
        except InfeasibleError:
            answers[name] = None
        except NothingFoundError as error:
            if name == "exact" and Instance.of(cell).per_second < FINE:
                found(f"{name}: {error}")
            tally.too_long += 1
            return None
    front = answers["exact"]
    if front is not None and not front.complete and Instance.of(cell).per_second >= FINE:
        tally.too_long += 1
        return None
    values = {name: _values(front) for name, front in answers.items()}
    if values["exact"] != values["exhaustive"]:
        found(f"{values}")
    if front is not None and not front.complete:
        found("exact is not complete")
    if question.is_front and question.minimize == "front":
        _beside_brute_force(data, question, values["exhaustive"], tally, found)
    for result in front or ():
        tally.replayed += 1
        if wrong := wrong_on_the_floor(cell, result, question):
            found(wrong)
    return front


def _values(front: CycleFront | None) -> list[tuple[float, float, int]] | None:
    if front is None:
        return None
    return [(point.cycle_time, point.stress, point.in_process) for point in front]


def _beside_brute_force(
    data: Mapping[str, Any],
    question: CycleQuestion,
    values: list[tuple[float, float, int]] | None,
    tally: Tally,
    found: Any,
) -> None:
    yardstick = Repeating(data)
    try:
        front = yardstick.front(question.max_in_process)
        right = [
            (length / yardstick.per_second, float(stress), yardstick.fewest(length, stress))
            for length, stress in front.items()
        ]
    except TooLarge:
        return
    tally.by_brute_force += 1
    if right != (values or []):
        found(f"the brute force says {right}, the methods {values}")


def wrong_on_the_floor(cell: Cell, result: CycleResult, question: CycleQuestion) -> str:
    """What is wrong with a pattern, as its checker, the checker of twenty products on one clock and
    the event world see it; empty when nothing is.
    """
    if wrong := cycle_checker.faults(
        cell,
        result.periodic,
        max_in_process=question.max_in_process,
        max_cycle_time=question.takt,
        max_stress=question.max_stress,
    ):
        return wrong[0]
    for products in FEWER:
        many = copied(cell, products)
        schedule = result.periodic.products(products, start_up(cell))
        if wrong := checker.faults(many, schedule):
            steady = [fault for fault in wrong if not is_run_in(fault, result.in_process)]
            return f"{products} products: {steady[0]}" if steady else ""
        leaves = exact(start_up(cell)) + exact(result.makespan)
        leaves += (products - 1) * exact(result.cycle_time)
        try:
            played = replay(_effortless(many), schedule)
        except CellError:
            continue  # more ticks than the world counts, in cells of a millionth of a second
        if not exact(played) == exact(makespan(schedule)) == leaves:
            return f"in the world product {products} leaves at {played} instead of {leaves}"
        return ""
    return "no count of products can be played"


def is_run_in(fault: str, in_process: int) -> bool:
    """Whether a fault of many products on one clock is about the first cycles alone: the tool in
    hand there is another than in the steady state, and a task without a tool stands where it would
    be changed.
    """
    said = re.search(r"(?:needs .* before|gets ready for) task '[^']* #(\d+)'", fault)
    return said is not None and int(said[1]) <= in_process


def _effortless(cell: Cell) -> Cell:
    """The cell without stress: the sums of so many products may be more than the world counts."""
    document = cell.to_dict()
    for operator in document["operators"].values():
        operator.pop("stress_limit", None)
    for task in document["tasks"].values():
        task.pop("stress", None)
        for joint in task.get("together", ()):
            joint.pop("stress", None)
    return cell_of(document)


def slice_of(seeds: list[int], key: str | None) -> Tally:
    """The tally of a few cells."""
    tally = Tally()
    for seed in seeds:
        tally.add(judge(seed, key))
    return tally


def main(arguments: list[str] | None = None) -> int:
    """Judges so many cells; 1 when judges differ."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--cells", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1, help="of the first cell")
    parser.add_argument("--with", dest="key", help="only cells that use this key")
    parser.add_argument("--minutes", type=float, default=30.0, help="stop after so long")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path, help="write the tally to this file")
    asked = parser.parse_args(arguments)
    began, tally = time.monotonic(), Tally()
    seeds = list(range(asked.seed, asked.seed + asked.cells))
    slices = [seeds[at : at + SLICE] for at in range(0, len(seeds), SLICE)]
    with ProcessPoolExecutor(asked.workers) as pool:
        for part in pool.map(partial(slice_of, key=asked.key), slices):
            tally.add(part)
            if time.monotonic() - began > 60 * asked.minutes:
                pool.shutdown(cancel_futures=True)
                break
    for finding in tally.findings:
        place = finding.store(FOUND)
        print(f"{place}: {finding.said}")
        print(f"  python -m tests.fuzz.cycles --cells 1 --seed {finding.seed}")
    summary = {
        **{name: value for name, value in vars(tally).items() if name != "findings"},
        "questions": dict(sorted(tally.questions.items())),
        "differ": len(tally.findings),
        "first_seed": asked.seed,
        "seconds": round(time.monotonic() - began),
        "versions": {name: version(name) for name in ("tandem", "ortools")},
    }
    text = json.dumps(summary, indent=1)
    print(text)
    if asked.output:
        asked.output.write_text(text + "\n", encoding="utf-8")
    return 1 if tally.findings else 0


if __name__ == "__main__":
    sys.exit(main())
