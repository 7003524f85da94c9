"""The property tests of the suite, with draws that nobody has seen yet, round after round.

    python -m tests.fuzz.properties [--minutes 10] [--rounds N] [--workers 1] [TESTS ...]

The suite itself draws the same in every run. What refutes a property is shown with the line that
repeats it, and kept in `.hypothesis`, from where the next round tries it first.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time


def main() -> int:
    """Ends with 1 when a property was refuted."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tests", nargs="*", default=["tests"], metavar="TESTS")
    parser.add_argument("--minutes", type=float, default=10.0, help="no round begins after these")
    parser.add_argument("--rounds", type=int, help="so many at most")
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args()
    until, rounds = time.monotonic() + 60 * options.minutes, 0
    while time.monotonic() < until and (options.rounds is None or rounds < options.rounds):
        rounds += 1
        if ended := _round(options.tests, options.workers):
            return ended
    print(f"{rounds} round{'s' * (rounds != 1)}, nothing found")
    return 0


def _round(tests: list[str], workers: int) -> int:
    together = ["-n", str(workers), "--dist", "loadfile"] if workers > 1 else ["-n", "0"]
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *together]
    return subprocess.run(
        [*command, "-m", "hypothesis", *tests], env=os.environ | {"TANDEM_DRAWS": "anew"}
    ).returncode


if __name__ == "__main__":
    sys.exit(main())
