"""One picture: the fronts of several cells under six measures, and how many of the plans differ.

    python benchmarks/measures.py CELL ... [--time-limit 60] [-o tandem-out/measures.png]

Which six goes by what the cell states: facts on the scale `reba` and a dose, a Strain Index of each
task, or its own stress alone. Levels are the middle of the values of the tasks that a robot could
do as well, and one below it; the dose is that of the method by which most of these are assessed,
and then most tasks: what nothing in a cell moves has no front. In a row of panels the same letter
stands for the same allocation. The table says, for each measure, how many points its front has and
how many of their plans are on none of the other fronts by values: no plan of another front of the
cell has both its makespan or less and its value or less.
"""

from __future__ import annotations

import argparse
import sys
from decimal import Decimal
from pathlib import Path

from tandem.cell.burdens import named, scales, worth
from tandem.cell.exposures import kind
from tandem.cell.model import Cell
from tandem.cell.written import number
from tandem.draw.axes import draw_axes
from tandem.draw.saving import save
from tandem.files.load import load
from tandem.plan.axes.search import AxesFront, plan_axes
from tandem.schedule.exposure import value


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cells", nargs="+", type=Path)
    parser.add_argument("--time-limit", type=float, default=60.0, help="seconds for each front")
    parser.add_argument("-o", "--output", type=Path, default=Path("tandem-out", "measures.png"))
    options = parser.parse_args()
    fronts: list[AxesFront] = []
    print("| cell | measure | points | proven | not reached by the plans of other measures |")
    print("|---|---|---:|---|---:|")
    for path in options.cells:
        cell = load(path)
        cell = cell if cell.name else cell.replace(name=path.stem)
        mine = [
            plan_axes(cell, ["makespan", name], time_limit=options.time_limit)
            for name in measures_for(cell)
        ]
        for front in mine:
            print(
                f"| {cell.name} | {front.axes[1]} | {len(front.points)} |"
                f" {'yes' if front.complete else 'no'} | {alone(front, mine)} |",
                flush=True,
            )
        fronts += mine
    options.output.parent.mkdir(parents=True, exist_ok=True)
    print(f"\n{save(draw_axes(fronts), options.output, dpi=80)}")
    return 0


def measures_for(cell: Cell) -> list[str]:
    """Six names."""
    movable = {scale: moved(cell, scale) for scale in scales(cell)}
    doses = [scale for scale in cell.exposures if kind(scale) == "dose"]
    if "strain_index_1995" in movable:
        scale = "strain_index_1995"
        middle, below = levels(movable[scale])
        return [
            "stress",
            f"peak:{scale}",
            f"time-above:{scale}:{number(middle)}",
            f"time-above:{scale}:{number(below)}",
            f"time-weighted:{scale}",
            f"fatigue:{scale}:0.05:0.1",
        ]
    if "reba" in movable and doses:
        most = max(doses, key=lambda dose: (len(movable[dose]), len(cell.exposures[dose])))
        return [
            "stress",
            "peak:reba",
            f"time-above:reba:{number(levels(movable['reba'])[1])}",
            "time-weighted:reba",
            f"dose:{most}",
            "fatigue:reba:0.01:0.1",
        ]
    return [
        "stress",
        "worst:stress",
        "peak:stress",
        f"time-above:stress:{number(levels(movable['stress'])[0])}",
        "time-weighted:stress",
        "fatigue:stress:0.05:0.1",
    ]


def moved(cell: Cell, scale: str) -> list[Decimal]:
    """The values, in order, of the tasks that a robot could do as well."""
    found = []
    for task in cell.tasks:
        modes = cell.modes(task)
        if any(not mode.stress for mode in modes):
            values = [v for mode in modes for v in worth(cell, scale, task, mode).values()]
            found += [max(values)] if values else []
    return sorted(found)


def levels(values: list[Decimal]) -> tuple[float, float]:
    """The middle one of different values, of two the higher one, and one below it."""
    each = sorted({float(value) for value in values}) or [1.0]
    return each[len(each) // 2], each[len(each) // 4]


def alone(front: AxesFront, others: list[AxesFront]) -> int:
    """Points that no plan of another measure's front is as good as."""
    cell, measure = front.cell, named(front.axes[1], front.cell)
    reached = [
        (point.values[0], value(cell, point.schedule, measure))
        for other in others
        if other is not front
        for point in other.points
    ]
    return sum(
        not any(t <= point.values[0] and v <= point.values[1] + 1e-12 for t, v in reached)
        for point in front.points
    )


if __name__ == "__main__":
    sys.exit(main())
