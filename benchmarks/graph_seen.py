"""Counts what the cells are like that the policy for any cell learns on: the ranges by which a plan
of `--method learned` says whether a cell is like them.

    python benchmarks/graph_seen.py [--cells 1000] [-o src/tandem/learn/graph/seen.json]

To be run anew whenever `training_cells` or the sizes in `training.Config` change.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from tandem.files.atomic import store
from tandem.learn.graph.familiar import ranges
from tandem.learn.graph.labels import layout_of
from tandem.learn.graph.training import Config
from tandem.learn.graph.training_cells import training_cell


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cells", type=int, default=1000)
    parser.add_argument("-o", "--output", type=Path)
    asked = parser.parse_args()
    most = Config().most_tasks
    found = ranges(layout_of(training_cell(number, most)) for number in range(asked.cells))
    document = {"cells": asked.cells, "most_tasks": most, "ranges": found}
    text = json.dumps(document, indent=1) + "\n"
    if asked.output is not None:
        store(asked.output, text)
    print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
