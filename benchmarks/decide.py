"""How long a trained policy takes to decide in NumPy: microseconds per joint decision of robot and
human.

    python benchmarks/decide.py [--tasks 7 50] [--repeats 2000]

The target is a median under 200 microseconds for 50 tasks on one core. No JAX is imported.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import itertools

import numpy as np

from tandem.lab.kinat2023.recipe import STATION
from tandem.learn.policy import Policy


def policy(tasks: int) -> Policy:
    """Untrained actors of our recipe's size for so many tasks."""
    rng = np.random.default_rng(0)
    sizes = [6 * tasks + 4 + tasks * tasks, *STATION.config.hidden, tasks + 1]
    actor = {
        str(index): {
            "weight": rng.standard_normal((2, *shape), np.float32) / shape[0] ** 0.5,
            "bias": np.zeros((2, shape[1]), np.float32),
        }
        for index, shape in enumerate(itertools.pairwise(sizes))
    }
    return Policy(("robot_0", "human_0"), actor, STATION.config.activation, True, False, {})


def measure(tasks: int, repeats: int) -> dict[str, float]:
    agents, rng = policy(tasks), np.random.default_rng(1)
    seen = rng.random((repeats, 2, agents.observation_size), np.float32)
    masks = np.ones((2, tasks + 1), np.int8)
    spent = []
    for index in range(repeats):
        began = time.perf_counter()
        agents.predict(seen[index], action_masks=masks)
        spent.append(1e6 * (time.perf_counter() - began))
    return {
        "tasks": tasks,
        "median_us": round(float(np.median(spent)), 1),
        "p99_us": round(float(np.percentile(spent, 99)), 1),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, nargs="+", default=[7, 50])
    parser.add_argument("--repeats", type=int, default=2000)
    asked = parser.parse_args()
    rows = [measure(tasks, asked.repeats) for tasks in asked.tasks]
    assert "jax" not in sys.modules
    print(
        json.dumps(
            {
                "benchmark": "decide",
                "python": platform.python_version(),
                "numpy": np.__version__,
                "machine": platform.machine(),
                "rows": rows,
            },
            indent=1,
        )
    )


if __name__ == "__main__":
    main()
