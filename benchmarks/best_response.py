"""A learned best response beside people it has never met: Best-Response Proximity next to
self-play's, re-planning's and a rule's.

    python benchmarks/best_response.py [--seeds 3] [--episodes 1000]
        [-o benchmarks/results/best_response.json]
    python benchmarks/best_response.py --show benchmarks/results/best_response.json
    python benchmarks/best_response.py --show FILE --add learned [--others 10] [-o FILE]

Cells: the thesis's, and a random layered cell of 12 tasks. Trained with the training part of
`benchmarks/people.yaml`, judged beside each person of the held-out part. Self-play is the same
learner trained beside somebody who does all that is asked, in the stated times. Proximity is the
mean makespan of the person's own best response (exact, by dynamic programming) divided by the
decider's: 1 is the best there is. `--add` plays one more decider, without training any anew:
`learned` is the policy for any cell as it is shipped.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import jax
import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.deciders.learned import learned
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import POLICIES, policy
from tandem.dispatch.evaluation.batch import EpisodeBatch
from tandem.dispatch.evaluation.best_response import optimum
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.situation.model import Situation
from tandem.files.atomic import store
from tandem.files.generators import layered
from tandem.files.load import load
from tandem.learn.policy import Policy
from tandem.learn.ppo.decider import decider
from tandem.learn.ppo.recipes import RESPONSE
from tandem.learn.training.runs import RunFolder, versions
from tandem.learn.training.trainer import train
from tandem.world import episode
from tandem.world.arrays import Names
from tandem.world.people import Person
from tandem.world.population import crowd
from tandem.world.population import load as population
from tandem.world.randomness import Draw

ROOT = Path(__file__).resolve().parents[1]
PEOPLE = ROOT / "benchmarks" / "people.yaml"
TRAINED = {"best response": f"population:{PEOPLE}", "self-play": "compliant"}
OTHERS = ("replan-robust", "longest-tail")


def cells() -> dict[str, Cell]:
    return {
        "thesis": load(ROOT / "examples" / "thesis.yaml"),
        "layered, 12 tasks, seed 3": layered(12, seed=3),
    }


def policies(cell: Cell, people: str, seeds: int) -> tuple[list[Policy], float, float]:
    """The trained policies, CPU seconds of all, and milliseconds of a decision in NumPy (median
    over a plain shift's situations).
    """
    with tempfile.TemporaryDirectory() as scratch:
        run, began = Path(scratch) / "run", time.process_time()
        train(
            cell,
            recipe_name="response",
            own_recipe=replace(RESPONSE, people=people),
            seeds=range(seeds),
            folder=run,
        )
        cpu_s = time.process_time() - began
        decide = learned(cell, SECONDS, Options(learned=str(run))).decide
        took = []
        for _ in range(200):
            took.append(decide(Situation.of(cell)).latency_ms)
        folder = RunFolder(run)
        return (
            [Policy.load(folder.policy(seed)) for seed in folder.seeds],
            cpu_s,
            float(np.median(took)),
        )


def rows_of(
    name: str, cell: Cell, seeds: int, episodes: int, other_episodes: int
) -> Iterator[dict[str, Any]]:
    """One row per held-out person and decider; `makespans` has one mean per seed."""
    names = Names.of(cell)
    arrays = names.arrays()
    groups = population(str(PEOPLE), names)["held_out"]
    made = {title: policies(cell, people, seeds) for title, people in TRAINED.items()}
    # one each: what is compiled is kept by it
    deciders = {title: [decider(one) for one in trained] for title, (trained, _, _) in made.items()}
    others = {title: policy(title, cell, SECONDS, Options()) for title in OTHERS}
    draw = Draw.of(names, arrays)
    for group in groups:
        people = crowd(group.spec, names, arrays).draw(np.random.default_rng(0), episodes)
        best = optimum(cell, SECONDS, Person(*(part[0] for part in people)))
        print(f"{name}: beside {group.spec}, optimum {best}", file=sys.stderr)
        for title, (_, cpu_s, decision_ms) in made.items():
            found = [
                episode.play_many(jax.random.key(0), draw, arrays, people, decide)
                for decide in deciders[title]
            ]
            assert all(bool(np.all(played.done)) for played in found)
            means = [float(np.mean(played.makespan)) / names.per_second for played in found]
            yield {
                "cell": name,
                "person": group.spec,
                "decider": title,
                "optimum": best,
                "makespans": means,
                "cpu_s": cpu_s,
                "decision_ms": decision_ms,
            }
        stage = EpisodeBatch.of(names, arrays, draw, people, 0)
        for title, one in others.items():
            outcome = stage.play(one, episodes if title == "longest-tail" else other_episodes)
            yield {
                "cell": name, "person": group.spec, "decider": title, "optimum": best,
                "makespans": [float(outcome.makespan.mean())],
                "cpu_s": 0.0, "decision_ms": float(np.median(outcome.latency_ms)),
            }  # fmt: skip


def added(document: dict[str, Any], title: str, episodes: int) -> None:
    """Plays one more decider beside the same people, and puts its rows behind the others."""
    document["rows"] = [row for row in document["rows"] if row["decider"] != title]
    optimum = {(row["cell"], row["person"]): row["optimum"] for row in document["rows"]}
    for name, cell in cells().items():
        names = Names.of(cell)
        arrays = names.arrays()
        draw, one = Draw.of(names, arrays), policy(title, cell, SECONDS, Options())
        for group in population(str(PEOPLE), names)["held_out"]:
            everybody = crowd(group.spec, names, arrays)
            people = everybody.draw(np.random.default_rng(0), document["episodes"])
            stage = EpisodeBatch.of(names, arrays, draw, people, 0)
            outcome = stage.play(one, episodes)
            print(f"{name}: {title} beside {group.spec}", file=sys.stderr)
            document["rows"].append(
                {
                    "cell": name, "person": group.spec, "decider": title,
                    "optimum": optimum[name, group.spec],
                    "makespans": [float(outcome.makespan.mean())],
                    "cpu_s": 0.0, "episodes": episodes,
                }
            )  # fmt: skip


def show(document: dict[str, Any]) -> None:
    rows = document["rows"]
    deciders = list(dict.fromkeys(row["decider"] for row in rows))
    for cell in dict.fromkeys(row["cell"] for row in rows):
        print(f"\n{cell}: Best-Response Proximity, mean over seeds (lowest seed)\n")
        print(
            "| person held out | optimum [s] | "
            + " | ".join(deciders)
            + " |\n|---|---|"
            + "---|" * len(deciders)
        )
        all_of: dict[str, list[float]] = {one: [] for one in deciders}
        for person in dict.fromkeys(row["person"] for row in rows):
            here = {
                row["decider"]: row
                for row in rows
                if (row["cell"], row["person"]) == (cell, person)
            }
            best = next(iter(here.values()))["optimum"]
            cells_ = []
            for one in deciders:
                if best is None:
                    cells_.append(f"{np.mean(here[one]['makespans']):.2f} s")
                    continue
                each = [best / makespan for makespan in here[one]["makespans"]]
                all_of[one].append(float(np.mean(each)))
                cells_.append(
                    f"{np.mean(each):.3f}" + (f" ({min(each):.3f})" if len(each) > 1 else "")
                )
            print(
                f"| `{person}` | {'–' if best is None else f'{best:.2f}'} | "
                + " | ".join(cells_)
                + " |"
            )
        print(
            "| **mean** | | "
            + " | ".join(
                f"**{np.mean(values):.3f}**" if values else "–" for values in all_of.values()
            )
            + " |"
        )
        here = {row["decider"]: row for row in rows if row["cell"] == cell}
        print(
            "\nMedian milliseconds of a decision: "
            + ", ".join(
                f"{one} {here[one]['decision_ms']:.2f}"
                for one in deciders
                if "decision_ms" in here[one]
            )
            + "."
        )
        spent = ", ".join(
            f"{one} {here[one]['cpu_s']:.0f}" for one in deciders if here[one]["cpu_s"]
        )
        print(f"CPU seconds of all {document['seeds']} trainings: {spent}.")
    print(f"\n{document['command']}; versions: {document['versions']}")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--episodes", type=int, default=1000)
    parser.add_argument(
        "--others", type=int, default=50, help="episodes of the re-planning decider"
    )
    parser.add_argument("--show", type=Path)
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--add", choices=list(POLICIES), help="one more decider for that result")
    given = parser.parse_args()
    if given.show:
        document = json.loads(given.show.read_text(encoding="utf-8"))
        if given.add:
            added(document, given.add, given.others)
        if given.output:
            store(given.output, json.dumps(document, indent=1) + "\n")
        show(document)
        return
    rows = [
        row
        for name, cell in cells().items()
        for row in rows_of(name, cell, given.seeds, given.episodes, given.others)
    ]
    command = (
        f"python benchmarks/best_response.py --seeds {given.seeds} --episodes {given.episodes}"
        f" --others {given.others}"
    )
    document = {
        "command": command,
        "seeds": given.seeds,
        "episodes": given.episodes,
        "versions": versions(),
        "rows": rows,
    }
    if given.output:
        store(given.output, json.dumps(document, indent=1) + "\n")
    show(document)


if __name__ == "__main__":
    main()
