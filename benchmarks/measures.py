"""One picture: the fronts of several cells under six measures, and how many of the plans differ.

    python benchmarks/measures.py CELL ... [--time-limit 60] [-o tandem-out/measures.png]

A cell with facts on the scale `reba` and a dose is asked about these, any other about its own
stress. In a row of panels the same letter stands for the same allocation. The table says, for each
measure, how many points its front has and how many of their plans are on none of the other fronts
by values: no plan of another front of the cell has both its makespan or less and its value or less.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tandem.cell.burdens import named, scales
from tandem.cell.model import Cell
from tandem.draw.axes import draw_axes
from tandem.draw.saving import save
from tandem.files.load import load
from tandem.plan.axes import AxesFront, plan_axes
from tandem.schedule.exposure import value

OWN = (
    "stress",
    "worst:stress",
    "peak:stress",
    "time-above:stress:4",
    "time-weighted:stress",
    "fatigue:stress:0.05:0.1",
)


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
    known = scales(cell)
    doses = [scale for scale in ("shoulder_tool", "lifft", "duet", "energy") if scale in known]
    if "reba" not in known or not doses:
        return list(OWN)
    return [
        "stress",
        "peak:reba",
        "time-above:reba:4",
        "time-weighted:reba",
        f"dose:{doses[0]}",
        "fatigue:reba:0.01:0.1",
    ]


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
