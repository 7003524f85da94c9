"""How far insertion alone brings a large cell in so many processor seconds of one thread, by how
warm the search is and how many tasks are taken out at once.

    python benchmarks/insertion.py [--tasks 50 200 500 1000] [--seeds 2] [--seconds 2]
        [--levels 1x3,2x3,4x3 1x3] [--level-visits 2500000]
    python benchmarks/insertion.py --data DIR [--seconds 1] [--levels ...]

From the schedule of the rule "balanced". Of random layered cells gaps are to the bounds that need
no search; with --data, of a dozen public cells, to the best known. Levels are factors of the first
warmth and tasks taken out at most; a search that finds nothing goes on to the next. Processor time
is counted, so that a busy machine changes little.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from random import Random

sys.path.insert(0, str(Path(__file__).parent))
from public_sets import instances
from tandem.files.generators import layered
from tandem.files.load import load
from tandem.plan import insertion, insertion_moves
from tandem.plan.bounds import least_makespan
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.rules import SPECS, build

PUBLIC = {
    "fjsp_barnes": ("mt10xyz", "setb4xyz"),
    "fjsp_dauzere": ("01a", "13a"),
    "fjsp_hurink_edata": ("abz5",),
    "fjsp_hurink_rdata": ("la32",),
    "fjsp_dag_birgin": ("YFJS17", "DAFJS30", "DAFJS10"),
    "fjsp_brandimarte": ("mk10",),
    "fjsp_behnke": ("med03_4",),
}
"""Sets and instances of --data: job shops with little choice and with much."""
Levels = tuple[tuple[float, int], ...]


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, nargs="+", default=[50, 200, 500, 1000])
    parser.add_argument("--operators", type=int, default=4)
    parser.add_argument("--data", type=Path, help="the folder of the public sets")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument(
        "--levels", type=_levels, nargs="+", default=[insertion.LEVELS], metavar="FACTORxOUT,..."
    )
    parser.add_argument("--level-visits", type=int, default=insertion.LEVEL_VISITS)
    options = parser.parse_args()
    insertion.LEVEL_VISITS = options.level_visits
    insertion_moves.warm()
    for insertion.LEVELS in options.levels:
        print(", ".join(f"{factor:g}x{out}" for factor, out in insertion.LEVELS))
        means = []
        for name, cells in _cells(options):
            rows = [_run(*cell, options.seconds, seed) for seed, cell in enumerate(cells)]
            rule, early, end, rate = map(statistics.mean, zip(*rows, strict=True))
            means.append((early, end))
            print(
                f"  {name:<14} rule {rule:7.2%}, after {options.seconds / 4:g} s {early:7.2%},"
                f" after {options.seconds:g} s {end:7.2%};"
                f" {rate / 1e6:.0f} million visits a second",
                flush=True,
            )
        early, end = map(statistics.mean, zip(*means, strict=True))
        print(f"  mean {early:.2%}, {end:.2%}", flush=True)
    return 0


def _levels(text: str) -> Levels:
    pairs = (level.split("x") for level in text.split(","))
    return tuple((float(factor), int(out)) for factor, out in pairs)


def _cells(options: argparse.Namespace) -> Iterator[tuple[str, list[tuple[Layout, float]]]]:
    """Name, and for each seed a layout and the ticks that gaps are counted from."""
    if options.data is None:
        humans = options.operators - options.operators // 2
        for tasks in options.tasks:
            cells = (
                layered(tasks, humans, options.operators // 2, seed=seed)
                for seed in range(options.seeds)
            )
            layouts = (Layout.of(Instance.of(cell)) for cell in cells)
            yield f"{tasks} tasks", [(layout, least_makespan(layout)) for layout in layouts]
        return
    for folder, wanted in PUBLIC.items():
        for name, _, upper, path in instances(options.data / folder):
            if name in wanted:
                layout = Layout.of(Instance.of(load(path)))
                known = upper * layout.instance.per_second
                yield name, [(layout, known)] * options.seeds


def _run(
    layout: Layout, least: float, seconds: float, seed: int
) -> tuple[float, float, float, float]:
    """Gaps by the rule, after a quarter of the time and at its end, and visits a second."""
    state = build(layout, SPECS["balanced"], Random(0))
    search = insertion.Insertion(layout, insertion_moves, Random(seed))
    search.aim(1, 0, None, None)
    search.begin(tuple(state.starts()))
    began, visits, early = time.thread_time(), 0, None
    while (spent := time.thread_time() - began) < seconds:
        visits += search.go(100_000)
        if early is None and spent >= seconds / 4:
            early = search.value
    return (
        state.makespan / least - 1,
        (early or search.value) / least - 1,
        search.value / least - 1,
        visits / spent,
    )


if __name__ == "__main__":
    sys.exit(main())
