"""A shift of many products beside a person who is slower than stated, killed with `kill -9` again
and again: is anything lost or doubled, is the pace known, does the journal replay?

    python benchmarks/long_shift.py [--policies longest-tail,replan-robust] [--products 50]
        [--kills 20] [--pace 1.6] [--cv 0.1] [--tasks 7] [--seed 0] [--learned FILE] [-o FILE]

For each policy: the shift once undisturbed and once killed, by real processes and real SIGKILL at
random moments, on the same simulated floor; events, decisions and situations held against each
other; `--replay` by the program; and the pace that is believed after each product. Exit code 1 when
anything differs, or the pace is off by more than 5 % after five products. `--tasks 7` is the
thesis's cell, any other number a random one. `learned` needs what `tandem train` left.
"""

from __future__ import annotations

import argparse
import json
import platform
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from tandem import __version__, load
from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.journal import Entry, Journal
from tandem.dispatch.shift.documents import event_of, told
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.pace import estimate
from tandem.dispatch.situation.transitions import after, ordered
from tandem.files.generators import layered
from tandem.files.load import dump

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.kill import Life, Lives, judged

AFTER = 5
"""So many products are enough to know the pace, within `WITHIN`."""
WITHIN = 0.05


def command(cell: Path, journal: Path, *more: str) -> list[str]:
    """The program on a journal."""
    base = ("-m", "tandem.cli", "dispatch", str(cell), "--journal", str(journal), "--json")
    return [sys.executable, *base, *more]


def shift_of(
    cell: Path, journal: Path, policy: str, products: int, pace: float, seed: int, learned: str
) -> list[str]:
    """The program on a shift of so many products with its simulated floor."""
    settings = ["--policy", policy, "--products", str(products), "--budget", "5000"]
    if policy == "learned":
        settings += ["--learned", learned]
    floor = ("--simulate", f"pace:{pace:g}", "--seed", str(seed))
    return command(cell, journal, *settings, *floor)


def killed(
    program: list[str], kills: int, seconds: float, makespan: float, chance: random.Random
) -> Lives:
    """Starts the program again and again and kills it, a life lasting `seconds` on average once it
    has begun; then lets it come to its end.
    """
    lives, speed = Lives(), str(makespan / (kills * seconds))
    while lives.kills < kills:
        with Life([*program, "--speed", speed]) as life:
            if life.line() is not None:
                time.sleep(chance.uniform(0, 2 * seconds))
            ended = life.killed()
            lives.said += life.said
            if ended:
                break
            lives.kills += 1
    subprocess.run(program, check=True, stdout=subprocess.DEVNULL)
    return lives


def paces(cell: Cell, entries: list[Entry], products: int) -> list[float]:
    """The pace that is believed of the first human after each product, from the journal."""
    situation = Situation.of(cell, products=products)
    human, prior, found = cell.humans[0], Options().prior, list[float]()
    for entry in entries:
        if entry.event is not None:
            before = situation.products_done
            situation = after(situation, event_of(entry.event))
            if situation.products_done > before:
                found.append(estimate(situation, human, prior).mean)
        if entry.decision is not None:
            situation = ordered(situation, told(entry.decision), entry.number)
    return found


def run(
    policies: list[str],
    products: int,
    kills: int,
    pace: float,
    tasks: int,
    seed: int,
    folder: Path,
    *,
    cv: float = 0.1,
    learned: str = "",
    seconds: float = 0.5,
) -> dict[str, Any]:
    """Every policy's shift, undisturbed and killed; the document that is printed. `seconds`: that a
    life lasts on average.
    """
    chance = random.Random(seed)
    cell = load("examples/thesis.yaml") if tasks == 7 else layered(tasks, seed=seed)
    file = folder / "cell.yaml"
    cell = cell.replace(
        tasks={name: task.model_copy(update={"spread": cv}) for name, task in cell.tasks.items()}
    )
    dump(cell, file)
    rows = []
    for policy in policies:
        whole, cut = (folder / f"{policy}-{name}.db" for name in ("whole", "cut"))
        program = shift_of(file, whole, policy, products, pace, seed, learned)
        subprocess.run(program, check=True, stdout=subprocess.DEVNULL)
        reference = _entries(whole)
        makespan = reference[-1].decision["at"] if reference[-1].decision else 0.0
        program = shift_of(file, cut, policy, products, pace, seed, learned)
        lives = killed(program, kills, seconds, makespan, chance)
        lives.entries = _entries(cut)
        believed = paces(cell, lives.entries, products)
        events = [entry for entry in lives.entries if entry.event is not None]
        replay = subprocess.run(
            command(file, cut, "--replay"), capture_output=True, text=True, check=False
        )
        rows.append(
            {
                "policy": policy,
                "kills": lives.kills,
                "products": len(believed),
                "events": len(events),
                "events_without_kills": sum(entry.event is not None for entry in reference),
                "shift_s": makespan,
                "pace_after": {
                    str(count): round(believed[count - 1], 4)
                    for count in (1, 2, AFTER, 10, 20, products)
                    if count <= len(believed)
                },
                "replay_is_the_same": replay.returncode == 0,
                "replay": replay.stdout.splitlines()[:4],
                "wrong": judged(reference, lives)[:20],
            }
        )
    return {**_empty(products, pace, cv, tasks, seed), "rows": rows}


def _empty(products: int, pace: float, cv: float, tasks: int, seed: int) -> dict[str, Any]:
    """The document before any policy."""
    return {
        "benchmark": "long_shift",
        "tandem": __version__,
        "python": platform.python_version(),
        "products": products,
        "pace": pace,
        "cv": cv,
        "tasks": tasks,
        "seed": seed,
        "rows": [],
    }


def faults(document: dict[str, Any]) -> list[str]:
    """What is not as it must be."""
    found = []
    for row in document["rows"]:
        name, true = row["policy"], document["pace"]
        found += [f"{name}: {wrong}" for wrong in row["wrong"]]
        if row["products"] != document["products"]:
            found.append(f"{name}: {row['products']} products are done.")
        if not row["replay_is_the_same"]:
            found.append(f"{name}: the replay differs: {' '.join(row['replay'])}")
        believed = row["pace_after"].get(str(AFTER), true)
        if abs(believed / true - 1) > WITHIN:
            found.append(f"{name}: a pace of {believed} is believed after {AFTER} products.")
    return found


def _entries(journal: Path) -> list[Entry]:
    with Journal(journal, read_only=True) as opened:
        return list(opened.entries())


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--policies", default="longest-tail,replan-robust")
    parser.add_argument("--products", type=int, default=50)
    parser.add_argument("--kills", type=int, default=20, help="for each policy")
    parser.add_argument("--pace", type=float, default=1.6)
    parser.add_argument("--cv", type=float, default=0.1, help="how far times scatter")
    parser.add_argument("--tasks", type=int, default=7)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--learned", default="", help="policy of `learned`, a file or a folder")
    parser.add_argument("-o", "--output", type=Path, help="file of results")
    asked = parser.parse_args()
    document = _empty(asked.products, asked.pace, asked.cv, asked.tasks, asked.seed)
    for policy in asked.policies.split(","):
        with tempfile.TemporaryDirectory() as folder:
            made = run(
                [policy],
                asked.products,
                asked.kills,
                asked.pace,
                asked.tasks,
                asked.seed,
                Path(folder),
                cv=asked.cv,
                learned=asked.learned,
            )
        document["rows"] += made["rows"]
        if asked.output:
            asked.output.write_text(json.dumps(document, indent=1) + "\n")
    print(json.dumps(document, indent=1))
    for fault in (wrong := faults(document)):
        print(fault, file=sys.stderr)
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
