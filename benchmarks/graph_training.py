"""Trains the policy for any cell that Tandem ships: imitation of decisions on nearly optimal ways,
then of those in states that the policy itself comes to. A run that is stopped goes on in its
folder, to the bit, whatever the number of processes that look up labels.

    python benchmarks/graph_training.py FOLDER [-o FILE] [--seed 0] [--workers 1]

`-o FILE` writes the weights; those that are shipped are
`src/tandem/learn/graph/weights.npz`. A line a round is printed, as JSON.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import sys
import time
from dataclasses import asdict
from pathlib import Path

# one thread: sums in the same order, whatever the machine
os.environ.setdefault(
    "XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
)

from tandem.learn.graph.training import Config, Told, train
from tandem.learn.graph.weights import write_weights


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="where the run is kept")
    parser.add_argument("-o", "--output", type=Path, help="file for the weights")
    parser.add_argument("--seed", type=int, default=Config().seed)
    parser.add_argument("--workers", type=int, default=1, help="processes that look up labels")
    asked = parser.parse_args()

    def say(told: Told) -> None:
        # processes that look up labels count when they have ended
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = time.process_time() + used.ru_utime + used.ru_stime
        print(json.dumps({**asdict(told), "cpu_s": round(spent, 1)}), flush=True)

    weights = train(Config(seed=asked.seed), asked.folder, say, asked.workers)
    if asked.output is not None:
        write_weights(asked.output, weights)
    return 0


if __name__ == "__main__":
    sys.exit(main())
