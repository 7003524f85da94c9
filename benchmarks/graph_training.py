"""Trains the policy for any cell that Tandem ships: imitation of decisions on nearly optimal ways,
then of those in states that the policy itself comes to. A run that is stopped goes on in its
folder, to the bit, whatever the number of processes that look up labels.

    python benchmarks/graph_training.py FOLDER [-o FILE] [--seed 0] [--workers 1]
    python benchmarks/graph_training.py FOLDER --ablations [--only NAME ...] [--seeds 5]
                                        [--workers 1] [-o FILE]

`-o FILE` writes the weights; those that are shipped are
`src/tandem/learn/graph/weights.npz`. A line a round is printed, as JSON.

With `--ablations` small policies are trained, each with something left out, and `-o FILE` gets how
far above good schedules theirs are: of twenty cells of 20 tasks (seeds from 500,000 on, neither
trained nor tested on), of which a search by insertion says what is good; mean in per cent over the
seeds of the training and its 95 % interval, and the mean processor time of a training, what is
compiled included. `--only` asks for some rows, by the names in `ablations`. Each training is a
process of its own, `--workers N` of them at once, and is kept in `FOLDER/NAME-SEED` with what came
of it: what is finished is neither trained nor judged again, what was stopped goes on.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import resource
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from statistics import mean, stdev
from typing import Any

# one thread: sums in the same order, whatever the machine, and no waiting for each other over
# small arrays
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("MKL_NUM_THREADS", "1")
os.environ.setdefault(
    "XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
)

# as a module of the folder, so that all processes know it by one name
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from benchmarks import graph_ppo

from tandem.files import atomic
from tandem.files.generators import layered
from tandem.learn.graph.candidates import GROUPS, columns
from tandem.learn.graph.labels import Looks, layout_of, searched
from tandem.learn.graph.making import Maker
from tandem.learn.graph.network import Weights
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.training import Config, Told, train
from tandem.learn.graph.weights import write_weights
from tandem.plan.list_scheduling import Layout

SMALL = Config(
    first=120, first_large=60, most_tasks=24, first_steps=600, rounds=1, drawn=60, drawn_large=40,
    steps=800,
)  # fmt: skip
"""What all ablations have in common."""
BY_PPO = graph_ppo.Config()
"""No labels: the same cells' sizes, and no less processor time than `SMALL` takes."""
TUNED, CELLS, SAMPLES, VISITS = 500_000, 20, 16, 500_000
STUDENT = {2: 12.71, 3: 4.30, 4: 3.18, 5: 2.78}
"""Half a 95 % interval of a mean of so many, in standard errors."""


@dataclass(frozen=True)
class Ablation:
    """A way of training with something left out.

    Attributes:
      name: what `--only` and the folders of its runs call it.
      without: what is left out.
      config: how the policy is trained then.
    """

    name: str
    without: str
    config: Config | graph_ppo.Config

    def train(self, seed: int, folder: Path) -> tuple[Weights, float]:
        """The weights, and the processor seconds that they took, those before a stop included."""
        clock = _Clock(folder / "cpu.json")
        config = replace(self.config, seed=seed)
        if isinstance(config, Config):
            return train(config, folder, clock.keep), clock.seconds()
        return graph_ppo.train(config, folder, clock.keep), clock.seconds()


class _Clock:
    """Processor seconds of a training that may be stopped: those up to what was kept last are in
    the file.
    """

    def __init__(self, file: Path) -> None:
        self.file, self.begun = file, time.process_time()
        self.before = float(json.loads(file.read_text())) if file.exists() else 0.0

    def seconds(self) -> float:
        """Of the training so far."""
        return self.before + time.process_time() - self.begun

    def keep(self, _told: object) -> None:
        """Writes them down."""
        atomic.store(self.file, json.dumps(self.seconds()))


def ablations() -> Iterator[Ablation]:
    """Each leaves out one thing, but the first."""
    yield Ablation("nothing", "nothing", SMALL)
    cells = {
        "first": SMALL.first + SMALL.drawn,
        "first_large": SMALL.first_large + SMALL.drawn_large,
    }
    steps = SMALL.first_steps + SMALL.steps
    imitated = replace(SMALL, **cells, first_steps=steps, rounds=0)
    yield Ablation("own-states", "its own states (imitation only)", imitated)
    yield Ablation("losses", "losses (one right choice)", replace(SMALL, sharp=-1.0, regret=0.0))
    yield Ablation("regret", "what is lost in the mean", replace(SMALL, regret=0.0))
    own = replace(SMALL, looks=Looks(own=32))
    yield Ablation("search", "search (self-labelling only)", own)
    yield Ablation("ppo", "labels (PPO instead)", BY_PPO)
    for name, values in GROUPS.items():
        blind = replace(SMALL, blind=columns(values))
        yield Ablation(name.replace(" ", "-"), f"features: {name}", blind)
    yield Ablation("crowd", "features: operators and what is left", replace(SMALL, crowd=False))


def tuned() -> Iterator[Layout]:
    """The cells that ablations are judged on."""
    return (layout_of(layered(20, seed=seed)) for seed in range(TUNED, TUNED + CELLS))


def good() -> list[int]:
    """Ticks of a good schedule of each of them."""
    found = []
    for seed, layout in enumerate(tuned(), TUNED):
        ways, starts = layout.instance.ways, searched(layout, 0.0, VISITS, seed)
        ends = (begin + ways[task][way].ticks for task, (way, begin) in enumerate(starts))
        found.append(max(ends))
    return found


def gaps(weights: Weights, goods: Sequence[int]) -> tuple[float, float]:
    """Per cent above the good schedules: greedy, and the best of `SAMPLES`."""
    greedy, best = list[float](), list[float]()
    for layout, least in zip(tuned(), goods, strict=True):
        maker, random = Maker.of(weights, Outlook.of(layout, 0.0)), np.random.default_rng(0)
        made = [maker.build(random if sample else None) for sample in range(SAMPLES)]
        ends = [state.makespan for state in made if state is not None]
        greedy.append(100 * (ends[0] / least - 1))
        best.append(100 * (min(ends) / least - 1))
    return mean(greedy), mean(best)


@dataclass(frozen=True)
class Job:
    """One training of an ablation, kept in `folder`."""

    ablation: Ablation
    seed: int
    folder: Path

    def kept(self) -> dict[str, float] | None:
        """What came of it; None where it is not finished, or was of another configuration."""
        file = self.folder / "judged.json"
        if not file.exists():
            return None
        found = json.loads(file.read_text())
        return found["found"] if found["config"] == self._config() else None

    def done(self, goods: Sequence[int]) -> dict[str, float]:
        """Trains, judges and keeps that."""
        weights, seconds = self.ablation.train(self.seed, self.folder)
        greedy, best = gaps(weights, goods)
        found = {"greedy": greedy, f"best of {SAMPLES}": best, "cpu_s": seconds}
        document = {"config": self._config(), "found": found}
        atomic.store(self.folder / "judged.json", json.dumps(document))
        return found

    def _config(self) -> Any:
        return json.loads(json.dumps(asdict(replace(self.ablation.config, seed=self.seed))))


def judged(
    folder: Path, asked: Sequence[Ablation], seeds: int, workers: int
) -> Iterator[dict[str, Any]]:
    """A row for each ablation, of so many seeds, trained by so many processes."""
    jobs = [
        Job(one, seed, folder / f"{one.name}-{seed}")
        for one in asked
        for seed in range(1, seeds + 1)
    ]
    results = [job.kept() for job in jobs]
    left = [job for job, found in zip(jobs, results, strict=True) if found is None]
    goods = good() if left else []
    # a process for each, so that each compiles for itself and none is quicker for the one before
    fresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, fresh, max_tasks_per_child=1) as pool:
        try:
            coming = pool.map(partial(Job.done, goods=goods), left)
            for at, one in enumerate(asked):
                mine = results[at * seeds : (at + 1) * seeds]
                row = _row(one, [next(coming) if found is None else found for found in mine])
                print(json.dumps(row), flush=True)
                yield row
        finally:
            pool.shutdown(cancel_futures=True)


def _row(ablation: Ablation, found: Sequence[dict[str, float]]) -> dict[str, Any]:
    """Means over the seeds."""
    seeds = len(found)
    row: dict[str, Any] = {"without": ablation.without, "seeds": seeds}
    for kind in ("greedy", f"best of {SAMPLES}"):
        values = [one[kind] for one in found]
        half = STUDENT[seeds] * stdev(values) / seeds**0.5
        row[kind] = {"gap": round(mean(values), 2), "half": round(half, 2)}
    return row | {"cpu_s": round(mean(one["cpu_s"] for one in found), 1)}


def say(told: Told) -> None:
    """A line for the round. Processes that look up labels count, for they have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = time.process_time() + used.ru_utime + used.ru_stime
    print(json.dumps({**asdict(told), "cpu_s": round(spent, 1)}), flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="where the run is kept")
    parser.add_argument("-o", "--output", type=Path, help="file for the weights, or the results")
    parser.add_argument("--seed", type=int, default=Config().seed)
    parser.add_argument(
        "--workers", type=int, default=1, help="processes that look up labels, or train ablations"
    )
    parser.add_argument("--ablations", action="store_true", help="train with things left out")
    rows = {one.name: one for one in ablations()}
    parser.add_argument("--only", nargs="+", choices=rows, metavar="NAME", help="of the ablations")
    parser.add_argument("--seeds", type=int, default=5, choices=STUDENT, help="of each ablation")
    asked = parser.parse_args()
    if asked.only and not asked.ablations:
        parser.error("--only names ablations; add --ablations.")
    if asked.ablations:
        wanted = [one for name, one in rows.items() if name in (asked.only or rows)]
        found = list(judged(asked.folder, wanted, asked.seeds, asked.workers))
        if asked.output is not None:
            document = {"benchmark": "graph_ablations", "rows": found}
            atomic.store(asked.output, json.dumps(document, indent=1) + "\n")
        return 0
    weights = train(Config(seed=asked.seed), asked.folder, say, asked.workers)
    if asked.output is not None:
        write_weights(asked.output, weights)
    return 0


if __name__ == "__main__":
    sys.exit(main())
