"""Where learning wins: learned deciders, re-planning and rules beside people, on cells of 20, 30
and 50 tasks, the same episodes for all of them.

    python benchmarks/beside_people.py [--sizes 20 30 50] [--cells 5] [--seeds 5] [--episodes 200]
        [--recipes response tandem] [--minutes 60] [-o benchmarks/results/beside_people.json]
    python benchmarks/beside_people.py --show benchmarks/results/beside_people.json

Random layered cells of one robot and one human, seeds 0, 1, ... `response` is trained beside the
people of its recipe, who are as quick and as random as they like, `tandem` (the default recipe)
beside somebody who does all that is asked; both for the same number of steps, all seeds side by
side. A decision of theirs is a look or two, whatever the budget. Re-planning counts its work, so
many steps for a millisecond. The best rule is the schedule of `tandem.learn.baseline.best_rule`,
carried out as `fixed` carries out the exact plan. `auto` is `replan-robust` where no trained policy
is given, and `learned` where one is: it decides as they do and is not played again.

The work is a list of jobs, the smallest first, and a file for each that is done in --folder: what
was stopped goes on where it was, and --minutes ends it before the next job. Differences are of the
makespan, paired by episode, in shares of the mean of `response`; their 95 % intervals are
percentiles of a bootstrap over cells, then over training seeds and episodes. Those who take long
play the first episodes only. A decision's time is its own on a core.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.cli.compiled import keep_compiled
from tandem.dispatch.deciders.fixed import fixed
from tandem.dispatch.deciders.learned import learned
from tandem.dispatch.deciders.memory import settled_memory
from tandem.dispatch.deciders.policy import Basis, Chosen, Decision, Options, Policy
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.evaluation.batch import EpisodeBatch
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.situation.model import Situation
from tandem.errors import UsageError
from tandem.files.atomic import store
from tandem.files.generators import layered
from tandem.learn.baseline import best_rule
from tandem.learn.ppo.recipes import RESPONSE, TANDEM, Recipe, longer
from tandem.learn.training.runs import RunFolder, versions
from tandem.world.arrays import Names
from tandem.world.people import Person
from tandem.world.population import crowd
from tandem.world.randomness import Draw

ROOT = Path(__file__).resolve().parents[1]
POPULATION = ROOT / "benchmarks" / "people.yaml"
PEOPLE = {
    "pace": "pace:0.6..2.5",
    "random": "random:0.5",
    "population": f"population:{POPULATION}",
}
"""Name -> description. Of the population the part that is held out."""
LEARNERS = ("response", "tandem")
RULES = ("fixed", "longest-tail", "best rule")
PLANNERS = ("replan", "replan-robust")
REFERENCE = "response"
STEPS = {"response": 786_432, "tandem": 327_680}
"""Of the recipes as they are."""
DRAWS, EDGES = 10_000, (2.5, 97.5)
"""Of the bootstrap."""


@dataclass(frozen=True)
class Settings:
    """What is measured. What changes a result stands here; how far to go does not.

    Attributes:
      sizes: tasks of the cells. `cells`, `seeds`: so many of each, from seed 0 on.
      training: steps of a training, as a share of the recipe `response`'s own.
      episodes: of learners and rules. `planned`: of re-planning by budget, ms -> episodes.
      recipes: of the learners, `REFERENCE` first.
    """

    sizes: tuple[int, ...] = (20, 30, 50)
    cells: int = 5
    seeds: int = 5
    training: float = 1.0
    episodes: int = 200
    planned: tuple[tuple[int, int], ...] = ((50, 200), (500, 200))
    recipes: tuple[str, ...] = LEARNERS

    @classmethod
    def told(cls, document: dict[str, Any]) -> Settings:
        """As a result file holds them, where tuples are lists."""
        lists = {
            key: tuple(map(tuple, value)) if key == "planned" else tuple(value)
            for key, value in document.items()
            if isinstance(value, list | tuple)
        }
        return cls(**document | lists)


@dataclass(frozen=True)
class Job:
    """One thing to do, and the name of its file: a training, what came of it beside all people, or
    a decider beside some.
    """

    tasks: int
    cell: int
    what: str
    people: str = ""
    budget_ms: int = 0

    @property
    def file(self) -> str:
        parts = [self.what, self.people, f"{self.budget_ms}ms" if self.budget_ms else ""]
        return f"{self.tasks}-{self.cell}/" + "-".join(p.replace(" ", "-") for p in parts if p)


def jobs(settings: Settings) -> Iterator[Job]:
    """All of them, the smallest cells first; the long budgets last, for they take ten times as
    long.
    """
    budgets = [budget for budget, _ in settings.planned]
    for tasks in settings.sizes:
        for cell in range(settings.cells):
            yield from (Job(tasks, cell, what) for what in (f"train-{REFERENCE}", REFERENCE))
            for people in PEOPLE:
                yield from (Job(tasks, cell, rule, people) for rule in RULES)
                yield from (Job(tasks, cell, one, people, budgets[0]) for one in PLANNERS)
            for recipe in settings.recipes[1:]:
                yield from (Job(tasks, cell, what) for what in (f"train-{recipe}", recipe))
    for budget in budgets[1:]:
        for tasks in settings.sizes:
            for cell in range(settings.cells):
                for people in PEOPLE:
                    yield from (Job(tasks, cell, one, people, budget) for one in PLANNERS)


# ---------------------------------------------------------------- doing them


def done(job: Job, settings: Settings, folder: Path) -> dict[str, Any]:
    """What the job's file is to hold."""
    if job.what.startswith("train-"):
        return trained(job, settings, folder)
    if job.what in LEARNERS:
        return played_by_learner(job, settings, folder)
    return played_by_decider(job, settings)


def recipe_of(name: str, training: float) -> Recipe:
    """The recipe for that share of `response`'s steps, whichever it is."""
    if name == "response":
        return longer(RESPONSE, training)
    return longer(TANDEM, training * STEPS["response"] / STEPS["tandem"])


def trained(job: Job, settings: Settings, folder: Path) -> dict[str, Any]:
    """Trains all seeds side by side; goes on with a training that was stopped."""
    from tandem.learn.training.trainer import resume, train

    name = job.what.removeprefix("train-")
    run = folder / f"{job.tasks}-{job.cell}" / name
    if RunFolder(run).checkpoint.exists():
        document = resume(run)
    else:
        # what was stopped before its first checkpoint begins anew
        shutil.rmtree(run, ignore_errors=True)
        document = train(
            layered(job.tasks, seed=job.cell),
            recipe_name=name,
            own_recipe=recipe_of(name, settings.training),
            seeds=range(settings.seeds),
            folder=run,
            front_limit=0.5,
        )
    if document["interrupted"]:
        raise KeyboardInterrupt
    rows = document["seeds"]
    return {"steps": rows[0]["steps"], "cpu_s": [row["cpu_s"] for row in rows]}


def stage_of(cell: Cell, people: str, settings: Settings) -> EpisodeBatch:
    """The episodes: the same people and chances whoever decides, and however many are played."""
    names = Names.of(cell)
    arrays = names.arrays()
    persons = crowd(PEOPLE[people], names, arrays).draw(np.random.default_rng(0), settings.episodes)
    return EpisodeBatch.of(names, arrays, Draw.of(names, arrays), persons, 0)


def played_by_learner(job: Job, settings: Settings, folder: Path) -> dict[str, Any]:
    """All seeds of a recipe beside all people at once, in JAX; and how long a decision takes at the
    station, in NumPy, in two episodes.
    """
    import jax

    from tandem.learn.policy import Policy as Network
    from tandem.learn.ppo.decider import decider
    from tandem.world import episode
    from tandem.world.people import crew

    cell = layered(job.tasks, seed=job.cell)
    stages = [stage_of(cell, people, settings) for people in PEOPLE]
    run = RunFolder(folder / f"{job.tasks}-{job.cell}" / job.what)
    networks = [Network.load(run.policy(seed)) for seed in range(settings.seeds)]
    arrays = stages[0].arrays

    def makespans(actor: Any, scenarios: Any, people: Any) -> Any:
        decide = decider(replace(networks[0], actor=actor))

        def one(scenario: Any, person: Person) -> Any:
            played = episode.play(arrays, scenario, crew(arrays, person), decide)
            return played.makespan, played.done

        return jax.vmap(one)(scenarios, people)

    def joined(parts: Sequence[Any]) -> Any:
        return jax.tree.map(lambda *rows: np.concatenate([np.asarray(row) for row in rows]), *parts)

    actors = jax.tree.map(lambda *rows: np.stack(rows), *(one.actor for one in networks))
    found, ended = jax.jit(jax.vmap(makespans, (0, None, None)))(
        actors, joined([one.scenarios for one in stages]), joined([one.people for one in stages])
    )
    assert bool(np.all(ended))
    seconds = np.asarray(found) / stages[0].names.per_second
    seconds = seconds.reshape(settings.seeds, len(PEOPLE), settings.episodes)
    timed = Timed(learned(cell, SECONDS, Options(learned=str(run.policy(0)))))
    stages[0].play(timed, min(2, settings.episodes))
    return {
        "makespans": {
            people: [rounded(row) for row in seconds[:, place]]
            for place, people in enumerate(PEOPLE)
        },
        "cpu_ms": quantiles(timed.own_ms),
    }


@dataclass
class Timed:
    """A decider whose decisions are timed, in their own time on a core."""

    policy: Policy
    own_ms: list[float] = field(default_factory=list)

    @property
    def name(self) -> str:
        """As the decider's."""
        return self.policy.name

    def decide(self, situation: Situation) -> Decision:
        """As the decider."""
        began = time.thread_time()
        said = self.policy.decide(situation)
        self.own_ms.append(1000 * (time.thread_time() - began))
        return said


@lru_cache(maxsize=4)
def made(tasks: int, cell: int, what: str, budget_ms: int) -> Policy:
    """The decider; made once for all people, for its plans before the shift take seconds."""
    station = layered(tasks, seed=cell)
    if what == "best rule":
        found = best_rule(station, lambda makespan, stress: makespan)
        assert found is not None
        chosen = Chosen(found.result.schedule, Basis.of(found.result, proven=False))
        return fixed(station, SECONDS, Options(plan=chosen))
    return policy(what, station, SECONDS, Options(budget_ms=budget_ms or Options.budget_ms))


def played_by_decider(job: Job, settings: Settings) -> dict[str, Any]:
    """A rule's or a planner's episodes."""
    count = dict(settings.planned).get(job.budget_ms, settings.episodes)
    timed = Timed(made(job.tasks, job.cell, job.what, job.budget_ms))
    with settled_memory() as settle:
        stage = stage_of(layered(job.tasks, seed=job.cell), job.people, settings)
        outcome = stage.play(timed, min(count, settings.episodes), between=settle)
    assert outcome.done.all()
    return {"makespans": rounded(outcome.makespan), "cpu_ms": quantiles(timed.own_ms)}


def rounded(seconds: Any) -> list[float]:
    """To a hundredth of a second."""
    return [round(float(one), 2) for one in seconds]


def quantiles(numbers: Sequence[float]) -> dict[str, float]:
    """Median and 99 % of so many decisions, ms."""
    p50, p99 = (round(float(np.percentile(numbers, share)), 2) for share in (50, 99))
    return {"p50": p50, "p99": p99, "decisions": len(numbers)}


def work_off(
    settings: Settings, folder: Path, minutes: float, tell: Callable[[str], None]
) -> dict[str, Any]:
    """Does what is not done yet, until the minutes are over, and gives all results that there are,
    job file -> what it holds.

    Raises UsageError for a folder that holds jobs of other settings.
    """
    asked, file = json.loads(json.dumps(asdict(settings))), folder / "settings.json"
    folder.mkdir(parents=True, exist_ok=True)
    if file.exists() and json.loads(file.read_text(encoding="utf-8")) != asked:
        raise UsageError(f"{folder}: holds jobs of other settings. Name another --folder.")
    store(file, json.dumps(asked) + "\n")
    began, results = time.perf_counter(), dict[str, Any]()
    for job in jobs(settings):
        path = folder / f"{job.file}.json"
        if not path.exists():
            if time.perf_counter() - began > 60 * minutes:
                continue
            tell(f"{time.perf_counter() - began:.0f} s: {job.file}")
            path.parent.mkdir(exist_ok=True)
            store(path, json.dumps(done(job, settings, folder)) + "\n")
        results[job.file] = json.loads(path.read_text(encoding="utf-8"))
    return results


# ---------------------------------------------------------------- showing them


def seconds_of(results: dict[str, Any], tasks: int, cell: int, people: str, who: str) -> Any:
    """`[S, E]`, a row for each training seed (one for those who do not learn); None where it was
    not played. `who` is a policy, with its budget where it plans: `replan 50 ms`.
    """
    if who in LEARNERS:
        found = results.get(Job(tasks, cell, who).file)
        return None if found is None else np.array(found["makespans"][people])
    name, _, budget = who.removesuffix(" ms").rpartition(" ")
    job = (
        Job(tasks, cell, name, people, int(budget))
        if who.endswith(" ms")
        else Job(tasks, cell, who, people)
    )
    found = results.get(job.file)
    return None if found is None else np.array([found["makespans"]])


def played(results: dict[str, Any], settings: Settings, who: str) -> bool:
    """Whether there is anything of it: who never played has no column."""
    return any(
        seconds_of(results, tasks, cell, people, who) is not None
        for tasks in settings.sizes
        for cell in range(settings.cells)
        for people in PEOPLE
    )


def difference(
    results: dict[str, Any], settings: Settings, tasks: int, people: str, who: str
) -> dict[str, Any] | None:
    """How much longer than `response`, as a share of its mean: the mean over the cells where both
    were played, and a 95 % interval of it; None where there is no such cell.
    """
    of_cells = []
    for cell in range(settings.cells):
        mine = seconds_of(results, tasks, cell, people, who)
        base = seconds_of(results, tasks, cell, people, REFERENCE)
        if mine is None or base is None:
            continue
        episodes = min(mine.shape[1], base.shape[1])
        # seed by seed: those of two recipes have nothing to do with each other
        of_cells.append((mine[:, :episodes], base[:, :episodes]))
    return paired(of_cells) if of_cells else None


def paired(of_cells: Sequence[tuple[Any, Any]]) -> dict[str, Any]:
    """How much longer the first of two takes than the second, as a share of the second's mean: the
    mean over the cells, a 95 % interval of it, and how many episodes it rests on.

    Args:
      of_cells: for each cell the seconds of both, `[S, E]` each, the same episodes.
    """
    rng = np.random.default_rng(0)
    drawn = np.zeros(DRAWS)
    which = rng.integers(len(of_cells), size=(DRAWS, len(of_cells)))
    for place in range(len(of_cells)):
        for cell, (mine, base) in enumerate(of_cells):
            rows = which[:, place] == cell
            # the same episodes for both, for they are pairs
            kept = shares(rng, rows.sum(), mine.shape[1])
            mean_mine, mean_base = (
                (shares(rng, rows.sum(), len(part)) @ part * kept).sum(1) for part in (mine, base)
            )
            drawn[rows] += (mean_mine / mean_base - 1) / len(of_cells)
    low, high = np.percentile(drawn, EDGES)
    mean = float(np.mean([mine.mean() / base.mean() - 1 for mine, base in of_cells]))
    return {
        "mean": mean, "ci95": (float(low), float(high)), "cells": len(of_cells),
        "episodes": of_cells[0][0].shape[1],
    }  # fmt: skip


def shares(rng: np.random.Generator, draws: int, number: int) -> Any:
    """`[draws, number]`, how often each was drawn when as many are drawn as there are; shares."""
    return rng.multinomial(number, np.full(number, 1 / number), size=draws) / number


def contestants(settings: Settings) -> list[str]:
    """All but the reference, as the tables name them."""
    planners = [f"{one} {budget} ms" for budget, _ in settings.planned for one in PLANNERS]
    return [*settings.recipes[1:], *planners, *RULES]


def tables(document: dict[str, Any]) -> Iterator[str]:
    """The Markdown lines: differences, then times and trainings."""
    settings, results = Settings.told(document["settings"]), document["results"]
    others = [who for who in contestants(settings) if played(results, settings, who)]
    yield "| tasks | people | cells | `response` [s] | " + " | ".join(map(title, others)) + " |"
    yield "|---|---|---|---|" + "---|" * len(others)
    for tasks in settings.sizes:
        for people, spec in PEOPLE.items():
            found = [difference(results, settings, tasks, people, who) for who in others]
            base = [
                rows.mean()
                for cell in range(settings.cells)
                if (rows := seconds_of(results, tasks, cell, people, REFERENCE)) is not None
            ]
            if base:
                shown = " | ".join(map(difference_words, found))
                name = f"`{spec}`" if people != "population" else "held-out population"
                yield f"| {tasks} | {name} | {len(base)} | {np.mean(base):.1f} | {shown} |"
    yield ""
    yield (
        "| tasks | training, CPU s a seed | "
        + " | ".join(title(who) for who in (REFERENCE, *others))
        + " |"
    )
    yield "|---|---|---|" + "---|" * len(others)
    for tasks in settings.sizes:
        files = {file: one for file, one in results.items() if file.startswith(f"{tasks}-")}
        if not files:
            continue
        spent = ", ".join(
            f"`{recipe}` {np.mean([s for f in mine for s in f['cpu_s']]):.0f}"
            for recipe in settings.recipes
            if (mine := [one for file, one in files.items() if file.endswith(f"train-{recipe}")])
        )
        times = " | ".join(time_words(files, who) for who in (REFERENCE, *others))
        yield f"| {tasks} | {spent} | {times} |"


def title(who: str) -> str:
    """A policy as a column's heading."""
    if who == "best rule":
        return who
    name, _, budget = who.removesuffix(" ms").rpartition(" ")
    return f"`{name}` {budget} ms" if who.endswith(" ms") else f"`{who}`"


def difference_words(found: dict[str, Any] | None) -> str:
    """A difference in per cent, its interval, and how many episodes it rests on."""
    if found is None:
        return "–"
    low, high = found["ci95"]
    return f"{found['mean']:+.1%} [{low:+.1%}, {high:+.1%}] ({found['episodes']})"


def time_words(files: dict[str, Any], who: str) -> str:
    """Median and 99 % of a decision, means over the files."""
    name, _, budget = who.removesuffix(" ms").rpartition(" ")
    if who.endswith(" ms"):
        wanted = {f"{name}-{people}-{budget}ms" for people in PEOPLE}
    elif who in LEARNERS:
        wanted = {who}
    else:
        wanted = {f"{who.replace(' ', '-')}-{people}" for people in PEOPLE}
    mine = [one["cpu_ms"] for file, one in files.items() if file.partition("/")[2] in wanted]
    if not mine:
        return "–"
    return " / ".join(f"{np.mean([one[part] for one in mine]):.1f}" for part in ("p50", "p99"))


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    plain = Settings()
    parser.add_argument("--sizes", type=int, nargs="+", default=plain.sizes)
    parser.add_argument("--cells", type=int, default=plain.cells)
    parser.add_argument("--seeds", type=int, default=plain.seeds)
    parser.add_argument("--episodes", type=int, default=plain.episodes)
    parser.add_argument(
        "--planned", type=int, nargs=2, default=[count for _, count in plain.planned],
        metavar=("AT_50_MS", "AT_500_MS"), help="episodes of re-planning at its two budgets",
    )  # fmt: skip
    parser.add_argument(
        "--recipes", nargs="+", choices=LEARNERS, default=plain.recipes,
        help=f"of the learners; {REFERENCE} is always one",
    )  # fmt: skip
    parser.add_argument(
        "--training", type=float, default=plain.training, help="share of `response`'s own steps"
    )
    parser.add_argument("--minutes", type=float, default=1e9, help="begin no job after these")
    parser.add_argument("--folder", type=Path, default=Path("tandem-out/beside_people"))
    parser.add_argument("--show", type=Path, help="only print the tables of an earlier run")
    parser.add_argument("-o", "--output", type=Path)
    asked = parser.parse_args()
    keep_compiled()
    if asked.show:
        document = json.loads(asked.show.read_text(encoding="utf-8"))
    else:
        budgets = [budget for budget, _ in plain.planned]
        settings = Settings(
            tuple(asked.sizes), asked.cells, asked.seeds, asked.training, asked.episodes,
            tuple(zip(budgets, asked.planned, strict=True)),
            tuple(one for one in LEARNERS if one in {REFERENCE, *asked.recipes}),
        )  # fmt: skip
        document = {
            "benchmark": "beside_people",
            "settings": asdict(settings),
            "steps_per_ms": Options.steps_per_ms,
            "versions": versions(),
            "load": round(os.getloadavg()[2], 1),
            "results": work_off(
                settings, asked.folder, asked.minutes,
                lambda line: print(line, file=sys.stderr, flush=True),
            ),
        }  # fmt: skip
    if asked.output:
        store(asked.output, json.dumps(document) + "\n")
    print("\n".join(tables(document)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
