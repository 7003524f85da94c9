"""Whether one question has one answer: `tandem plan CELL --json` again and again, with one, two and
four workers, each run a fresh process. All that is printed must be the same but for `wall_s`
and, of more than 30 tasks, `proved_by`.

    python benchmarks/same_plan.py [--runs 20] [--cells 10] [--tasks 20] [-o
    benchmarks/results/same_plan.json]

A run that is stopped goes on where it was, unless the code has changed since.

The cells are all examples and random ones (layered, one robot with one and two humans in turn,
seeds 0, 1, ...). Of each, the front is asked for, the quickest schedule, and the least sum of
makespan and stress.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from hashlib import sha256
from itertools import product
from pathlib import Path
from typing import Any

import tandem
from tandem.files import atomic
from tandem.files.generators import layered
from tandem.plan.cpsat import SOLVER
from tandem.plan.race import SMALL

EXAMPLES = Path(__file__).parents[1] / "examples"
WORKERS = (1, 2, 4)
QUESTIONS = {
    "front": (),
    "quickest": ("--minimize", "makespan"),
    "least sum": ("--weights", "1,1"),
}


def cells(count: int, tasks: int, folder: Path) -> Iterator[Path]:
    """The files of all examples and of so many random cells."""
    yield from sorted(EXAMPLES.glob("*.yaml"))
    for seed in range(count):
        humans = 1 + seed % 2
        path = folder / f"random-{tasks}-{humans}-1-{seed}.json"
        cell = layered(tasks, humans, 1, seed=seed)
        path.write_text(json.dumps(cell.to_dict()), encoding="utf-8")
        yield path


def answer(path: Path, asked: tuple[str, ...], workers: int, limit: float) -> dict[str, Any]:
    """What a fresh process prints."""
    command = ["plan", str(path), "--json", "-q", "--workers", str(workers), *asked]
    ran = subprocess.run(
        [sys.executable, "-m", "tandem.cli", *command, "--time-limit", str(limit)],
        capture_output=True,
        text=True,
        check=True,
    )
    document: dict[str, Any] = json.loads(ran.stdout)
    return document


def compared(path: Path, name: str, runs: int, limit: float) -> dict[str, Any]:
    """One question to one cell, so many times, the numbers of workers in turn."""
    documents = [
        answer(path, QUESTIONS[name], WORKERS[run % len(WORKERS)], limit) for run in range(runs)
    ]
    times = [document.pop("wall_s") for document in documents]
    # of larger cells several tools race for the same bound: who was first may differ
    for document in documents if len(documents[0]["cell_document"]["tasks"]) > SMALL else ():
        for point in document["front"]:
            point.pop("proved_by", None)
    prints = {sha256(json.dumps(document).encode()).hexdigest()[:12] for document in documents}
    points = documents[0]["front"]
    return {
        "cell": path.name,
        "question": name,
        "points": len(points),
        "complete": all(document["complete"] for document in documents),
        "canonical": all(
            point["canonical"] for document in documents for point in document["front"]
        ),
        "documents": sorted(prints),
        "digests": [point["digest"] for point in points],
        "wall_s": {"least": min(times), "most": max(times)},
    }


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=20, help="of each question to each cell")
    parser.add_argument("--cells", type=int, default=10, help="random ones")
    parser.add_argument("--tasks", type=int, default=20, help="of each random cell")
    parser.add_argument("--questions", nargs="+", choices=QUESTIONS, default=list(QUESTIONS))
    parser.add_argument("--time-limit", type=float, default=300.0, help="seconds of a run")
    parser.add_argument("-o", "--output", type=Path)
    asked = parser.parse_args()
    made = {
        "benchmark": "same_plan",
        "runs": asked.runs,
        "workers": list(WORKERS),
        "time_limit_s": asked.time_limit,
        "solver": SOLVER,
        "code": code(),
    }
    rows = kept(asked.output, made)
    with tempfile.TemporaryDirectory() as folder:
        paths = list(cells(asked.cells, asked.tasks, Path(folder)))
        for name, path in product(asked.questions, paths):
            row = rows.get((path.name, name))
            if row is None:
                row = rows[path.name, name] = compared(path, name, asked.runs, asked.time_limit)
                store(asked.output, made, list(rows.values()))
            print(told(row, asked.runs), flush=True)
    differ = [row for row in rows.values() if len(row["documents"]) != 1]
    print(f"{len(rows) - len(differ)} of {len(rows)} questions have one answer.")
    return 1 if differ else 0


def code() -> str:
    """A digest of the code that answers: what another made is made again."""
    files = sorted(Path(tandem.__file__).parent.rglob("*.py"))
    return sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:12]


def kept(path: Path | None, made: dict[str, Any]) -> dict[tuple[str, str], dict[str, Any]]:
    """The rows of an earlier run that was made alike, by cell and question."""
    if path is None or not path.exists():
        return {}
    document = json.loads(path.read_text(encoding="utf-8"))
    if any(document.get(key) != value for key, value in made.items()):
        return {}
    return {(row["cell"], row["question"]): row for row in document["rows"]}


def store(path: Path | None, made: dict[str, Any], rows: list[dict[str, Any]]) -> None:
    """Written after each row: a run that is stopped goes on there."""
    if path is None:
        return
    same = sum(len(row["documents"]) == 1 for row in rows)
    document = {**made, "questions_with_one_answer": same, "questions": len(rows), "rows": rows}
    atomic.store(path, json.dumps(document, indent=1) + "\n")


def told(row: dict[str, Any], runs: int) -> str:
    """A row in a line."""
    return (
        f"{row['cell']:<24} {row['question']:<10} {row['points']:>3} points"
        f"  {'complete' if row['complete'] else 'NOT COMPLETE'}"
        f"  {'canonical' if row['canonical'] else 'NOT CANONICAL'}"
        f"  {runs} runs, {len(row['documents'])} document{'s' * (len(row['documents']) != 1)}"
        f"  {row['wall_s']['least']:.2f} to {row['wall_s']['most']:.2f} s"
    )


if __name__ == "__main__":
    sys.exit(main())
