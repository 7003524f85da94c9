"""Random cells to people who have nothing but their printed instruction sheets.

Each cell is planned, its page is printed, and everybody works by the text of their own sheet:
whoever may begin does, while every task, changeover and set-up takes a time of its own, the planned
one multiplied by 0.3 to 3. What comes of it is judged by the checker, with a cell in which
everything takes as long as it really took and nothing is due.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import permutations
from pathlib import Path
from random import Random
from typing import Any

from tests.draw.cells import front_of
from tests.fuzz.cells import cell as random_cell
from tests.report.paper import Row, Sheet, Worked, sheets_of, work_by

from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError, NothingFoundError
from tandem.files.validate import cell_of
from tandem.plan.methods import METHODS, plan
from tandem.report.html import html
from tandem.report.instruction_sheet import sheet
from tandem.report.language import words
from tandem.schedule.checker import faults
from tandem.schedule.model import Assignment, Schedule

SIZES = {2: 1, 3: 1, 4: 2, 5: 3, 6: 4, 7: 4, 8: 3, 9: 2, 10: 2, 12: 1}
CREWS = {1: 1, 2: 4, 3: 5, 4: 3}
SHIFTS = 3
"""So often the crew works by the same sheets, every time with other delays."""
SLOWEST, QUICKEST = 3.0, 0.3
WALK = " -> "
"""What stands between two places, in a step that leads from one to the other."""
FEATURES = (
    *("together", "tool", "zone", "capacity", "changeover", "place", "walk", "breaks", "setup"),
    *("release", "deadline", "same_operator", "stress_of_set", "stress_limit", "after", "wait"),
    *("label", "apart", "holds"),
)
FOUND = Path("tandem-out", "fuzz")


@dataclass(frozen=True)
class Finding:
    """A cell and a plan whose sheets do not hold."""

    seed: int
    said: str
    cell: Mapping[str, Any]
    assignments: list[dict[str, Any]]

    def store(self, folder: Path) -> Path:
        """Writes it to a file of its own."""
        folder.mkdir(parents=True, exist_ok=True)
        place = folder / f"sheets-{self.seed}.json"
        place.write_text(json.dumps(vars(self), indent=1, default=dict) + "\n", encoding="utf-8")
        return place


@dataclass
class Tally:
    """What was tried, and what was found.

    Attributes:
      cells: planned and printed. `left_out` more had no plan, or were no sound cells.
      steps: of all sheets; conditions: sentences of each kind under "begin when".
      findings: (seed, what is wrong, the cell and the plan).
    """

    cells: int = 0
    left_out: int = 0
    shifts: int = 0
    steps: int = 0
    features: Counter[str] = field(default_factory=Counter)
    conditions: Counter[str] = field(default_factory=Counter)
    findings: list[Finding] = field(default_factory=list)


def planned(random: Random) -> tuple[Cell, Schedule] | None:
    """A cell with a plan; half of them by the exact method, half by a rule, so that plans are there
    that nobody would call good.
    """
    data = random_cell(random, SIZES, CREWS)
    if random.random() < 0.3:
        _crowd(data, random)
    if random.random() < 0.5:
        for place, task in enumerate(data["tasks"].values()):
            task["label"] = random.choice(("Fit lid", "Press in", f"Check {place} (twice)"))
    rules = [name for name in METHODS if name not in ("exact", "exhaustive")]
    method = random.choice(("exact", random.choice(rules)))
    try:
        cell = cell_of(data)
        front = plan(cell, method=method, minimize="makespan", time_limit=5, workers=1)
        return cell, front[0].schedule
    except (CellError, InfeasibleError, NothingFoundError):
        return None


def _crowd(data: dict[str, Any], random: Random) -> None:
    """Sends most tasks to one zone, or has them need one tool, of which there are several."""
    kind = random.choice(("tool", "zone"))
    data[f"{kind}s"]["busy"] = {"capacity": random.choice((2, 2, 3))}
    for task in data["tasks"].values():
        if random.random() < 0.8:
            task[kind] = "busy"


def judge(seed: int) -> Tally:
    """Draws the cell of this seed, plans it, and lets the crew work by the sheets."""
    random, tally = Random(seed), Tally()
    while (found := planned(random)) is None:
        tally.left_out += 1
    cell, schedule = found
    language = random.choice(("en", "de"))
    sheets = all_sheets(cell, schedule, language)
    tally.cells = 1
    text = json.dumps(cell.to_dict())
    tally.features.update(key for key in FEATURES if f'"{key}"' in text)
    for one in sheets.values():
        tally.steps += len(one.rows)
        for row in one.rows:
            tally.conditions.update({kind: len(row.conditions[kind]) for kind in row.conditions})
    for _ in range(SHIFTS):
        tally.shifts += 1
        tally.findings += [
            Finding(seed, said, cell.to_dict(), schedule.to_list())
            for said in wrong(cell, schedule, sheets, random)
        ]
    return tally


def all_sheets(cell: Cell, schedule: Schedule, language: str) -> dict[str, Sheet]:
    """The sheets of the page; and for each machine, which reads none, what its control must
    know.
    """
    front = front_of(cell, [schedule])
    control = (sheet(front[0], name, "plan", words(language)) for name in cell.machines)
    page = html(front, language=language) + "".join(map(str, control))
    return sheets_of(page, language)


def wrong(cell: Cell, schedule: Schedule, sheets: Mapping[str, Sheet], random: Random) -> list[str]:
    """Lets the crew work once with delays by chance. Returns what breaks the cell."""
    factors: dict[tuple[str, str], Decimal] = {}

    def factor(*key: str) -> Decimal:
        drawn = Decimal(random.uniform(QUICKEST, SLOWEST)).quantize(Decimal("0.01"))
        if key[-1] == WALK:  # all ways alike and exactly, so that no detour becomes shorter
            drawn = Decimal(random.choice((1, 2, 3)))
        return factors.setdefault(key, drawn)

    lengths = {a.task: exact(a.end) - exact(a.start) for a in schedule}

    def seconds(who: str, row: Row) -> Decimal:
        if row.change is None:
            return stretched(lengths[row.task], factor("task", row.task))
        tool, length = row.change
        return stretched(length, factor(who, WALK if WALK in tool else tool))

    try:
        worked = work_by(sheets, seconds)
    except AssertionError as error:
        return [str(error)]
    return judged(cell, schedule, worked, factors) + breaks_kept(cell, worked)


def judged(
    cell: Cell,
    schedule: Schedule,
    worked: list[Worked],
    factors: Mapping[tuple[str, str], Decimal],
) -> list[str]:
    """What the checker says to the work, by a cell in which all takes as long as it took. Breaks
    are looked at apart: the checker takes a changeover to be done directly before its task.
    """
    order = {name: place for place, name in enumerate(cell.operators)}
    done = {w.task: w for w in worked if w.task}
    rows = [
        Assignment(
            float(w.start), float(w.end), w.task, tuple(sorted(w.who, key=order.__getitem__))
        )
        for w in done.values()
    ]

    def took(seconds: float, who: str, tool: str) -> float:
        return float(stretched(exact(seconds), factors.get((who, tool), Decimal(1))))

    data = cell.to_dict()
    for key in ("stress_of_set", "same_operator"):
        data.pop(key, None)
    for name, operator in data["operators"].items():
        for key in ("breaks", "stress_limit", "limits"):
            operator.pop(key, None)
        if "setup" in operator:
            operator["setup"] = took(operator["setup"], name, "")
    for tool, entry in data.get("tools", {}).items():
        entry["changeover"] = {
            who: took(seconds, who, tool) for who, seconds in entry.get("changeover", {}).items()
        }
    data["walk"] = {
        who: {
            f"{a}-{b}": took(table.get((a, b), 0.0), who, WALK)
            for a, b in permutations(cell.place_names, 2)
        }
        for who, table in cell.walking.items()
    }
    for a in schedule:
        task, length = data["tasks"][a.task], float(done[a.task].end - done[a.task].start)
        tools = dict(cell.tools_for(a.task, a.operators))
        for key in ("deadline", "together", "time", "stress", "difficulty", "tool", "ergonomics"):
            task.pop(key, None)
        for wait in task.get("wait", ()):
            wait.pop("at_most", None)  # no sheet can force it on who is slow
        task["tool"] = tools
        if len(a.operators) > 1:
            task["together"] = [{"operators": list(a.operators), "time": length}]
        else:
            task["time"] = {a.operators[0]: length}
    return faults(cell_of(data), Schedule(tuple(rows)))


def stretched(seconds: Decimal, factor: Decimal) -> Decimal:
    """As exact as a cell can say it."""
    return (seconds * factor).quantize(Decimal("0.000001"))


def breaks_kept(cell: Cell, worked: list[Worked]) -> list[str]:
    """Who worked in a break of theirs."""
    return [
        f"{who} does {w.task or 'a changeover'} from {w.start} to {w.end}, in the break"
        for w in worked
        for who in w.who
        for off, back in cell.operators[who].breaks
        if exact(off) < w.end and w.start < exact(back)
    ]


def exact(seconds: float) -> Decimal:
    return Decimal(repr(float(seconds)))


def run(cells: int, seed: int) -> Tally:
    """Judges so many cells from this seed on."""
    total = Tally()
    for one in range(seed, seed + cells):
        for name, value in vars(judge(one)).items():
            setattr(total, name, getattr(total, name) + value)
        if sys.stderr.isatty():
            print(f"\r{total.cells} cells, {len(total.findings)} findings", end="", file=sys.stderr)
    return total


def summary(total: Tally, seed: int, took: float) -> dict[str, Any]:
    return {
        **vars(total),
        "findings": [f"seed {finding.seed}: {finding.said}" for finding in total.findings],
        "seeds": [seed, seed + total.cells - 1],
        "features": dict(total.features.most_common()),
        "conditions": dict(total.conditions.most_common()),
        "minutes": round(took / 60, 1),
    }


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="dev.py fuzz sheets", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--cells", type=int, default=1000, help="how many cells (1000)")
    parser.add_argument(
        "--seed", type=int, default=1, help="seed of the first cell; the others follow (1)"
    )
    asked = parser.parse_args()
    began = time.time()
    total = run(asked.cells, asked.seed)
    print(json.dumps(summary(total, asked.seed, time.time() - began), indent=1))
    for finding in total.findings:
        print(
            f"{finding.store(FOUND)}: python3 dev.py fuzz sheets --cells 1 --seed {finding.seed}",
            file=sys.stderr,
        )
    return 1 if total.findings else 0


if __name__ == "__main__":
    sys.exit(main())
