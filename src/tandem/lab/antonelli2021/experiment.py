"""Antonelli, Zeng, Aliev, Liu (2021): a robot that learns to take apart what was mounted wrongly;
as described, ours, and exact.

Their numbers are not public. The product, the times, the human's slips and the settings of "as
described" are ours (ASSUMPTION).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.files.validate import cell_of
from tandem.lab.antonelli2021 import Repair, qlearning, repair
from tandem.lab.antonelli2021.cells import cells, own_cell
from tandem.lab.antonelli2021.markov import (
    Process,
    policy_values,
    reaching_states,
    sure_states,
    value_iteration,
)
from tandem.lab.antonelli2021.qlearning import Config
from tandem.lab.antonelli2021.world import WRONG, legal
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.origin import origin
from tandem.lab.records import kept_record, stored_document, write_document
from tandem.lab.systems import Features, Played
from tandem.learn.baseline import best_rule
from tandem.learn.training.runs import versions
from tandem.plan.methods import plan
from tandem.plan.question import Question

STORED = "antonelli2021.json"
SEEDS = 10
CHANCES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5)
"""p of the human who is played with."""

DESCRIBED = Config(
    steps=20_000,
    rate=0.1,
    epsilon=0.1,
    epsilon_end=0.1,
    gamma=0.9,
    bonus=100.0,
    limit=100,
    initial=1e-3,
)
"""ASSUMPTION, every number of it: common settings of tabular Q-learning; episodes begin with the
empty table.
"""
TRAINED_AT = (0.0, 0.05, 0.2)
"""p of the human whom "as described" is trained with."""

OURS = Config(
    steps=1_000_000,
    horizon=40.0,
    epsilon=0.3,
    epsilon_end=0.3,
    limit=30,
    exploring_starts=True,
    stratified=True,
)
"""Episodes begin anywhere, the rate falls with the visits, nothing is discounted, slips come in an
even order; trained with the p that is played with.
"""

PRECISE = Config(steps=2_000_000, stratified=True)
"""For the last digits: every pair in every round, in double precision."""
PRECISE_AT = {0.0: 5.0, 0.1: 5.0, 0.2: 10.0, 0.3: 15.0, 0.5: 60.0}
"""p -> horizon of the rate: about as many as the operations that an assembly takes then; with less,
the first guesses fade too slowly.
"""
LONGER_AT = {0.5: 15}
"""p -> how many times as many rounds bring even draws within a thousandth of a second."""

PATIENCE = 200
"""Operations after which an assembly counts as not finished."""
EPISODES = 1000


def runs_on(cell: Cell) -> Repair:
    """The cell as a product that can be taken apart.

    Raises CellError that names what the system cannot express.
    """
    return repair(cell)


def reproduce(
    folder: Path,
    *,
    quick: bool = False,
    seeds: int | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Trains, solves and returns the document, which is also written to
    `folder/antonelli2021.json`.

    What was found for a cell or a p is kept in `folder/records`; a run that was stopped goes on
    from there.

    Args:
      quick: 2 seeds, a twentieth of our budgets, three values of p.
      seeds: 10 when absent.
    """
    count = seeds or (2 if quick else SEEDS)
    ours, precise = (
        (replace(config, steps=config.steps // 20) for config in (OURS, PRECISE))
        if quick
        else (OURS, PRECISE)
    )
    chances = CHANCES[:1] + CHANCES[2:5:2] if quick else CHANCES
    document: dict[str, Any] = {
        "schema_version": 1,
        "command": " ".join(
            [
                "tandem reproduce antonelli2021",
                *["--quick"] * quick,
                *([f"--seeds {seeds}"] if seeds else []),
            ]
        ),
        "quick": quick,
        "seeds": list(range(count)),
        "versions": versions(),
        "settings": {
            "as described": asdict(DESCRIBED),
            "ours": asdict(ours),
            "precise": asdict(precise),
            "patience": PATIENCE,
        },
        "cells": {},
    }
    records = folder / "records"
    asked = {"chances": chances, "seeds": count, "settings": document["settings"]}
    for name, cell in cells().items():
        tell(f"{name}: {count} seeds at p = {', '.join(f'{p:g}' for p in chances)}")
        make = partial(on_cell, cell, chances, range(count), ours)
        document["cells"][name] = kept_record(
            records / f"{name}.json", make, {**asked, "cell": cell.digest}
        )
    document["precision"] = []
    for p, horizon in ({0.1: PRECISE_AT[0.1]} if quick else PRECISE_AT).items():
        tell(f"precision at p = {p:g}: {precise.steps:,} rounds")
        make_rows = partial(precision, own_cell(), {p: horizon}, precise)
        document["precision"] += kept_record(
            records / f"precision-{p:g}.json", make_rows, {**asked, "horizon": horizon}
        )
    for p in () if quick else LONGER_AT:
        tell(f"precision at p = {p:g}: {LONGER_AT[p]} times as many rounds")
        document["precision"] += kept_record(
            records / f"precision-{p:g}-longer.json",
            partial(longer_precision, own_cell(), p),
            {**asked, "times": LONGER_AT[p]},
        )
    document["speed"] = speed(thesis_cell())
    return write_document(folder / STORED, document)


def stored() -> dict[str, Any]:
    """The document of the long run that ships with the package. Raises CellError when this copy has
    none, or a damaged one.
    """
    return stored_document("antonelli2021/results.json", "antonelli2021")


def on_cell(
    cell: Cell, chances: Sequence[float], seeds: Sequence[int], ours: Config = OURS
) -> dict[str, Any]:
    """One cell: its states, the exact values at every p, and how each player does at every p.

    The planner's makespan when every operation is a joint one stands beside the value at p = 0:
    another method, the same number.
    """
    world = runs_on(cell)
    return {
        "cell": cell.name,
        "tasks": len(cell.tasks),
        "states": len(world.nodes),
        "wrong_states": int(world.wrong.sum()),
        "with_a_way_to_the_goal": int(reaching_states(world.halfway).sum()),
        "planned_one_at_a_time": plan(joint(cell), question=Question(minimize="makespan"),
        time_limit=30, seed=0).points[0][0],
        "planned_side_by_side": plan(cell, question=Question(minimize="makespan"), time_limit=30,
        seed=0).points[0][0],
        "exact": [exact_row(world, p) for p in chances],
        "players": [
            *(player_row(world, f"as described, trained at p = {at:g}", p, tables)
              for at in TRAINED_AT for tables in [tables_of(world, at, DESCRIBED,
              seeds)] for p in chances),
            *(player_row(world, "ours", p, tables_of(world, p, ours, seeds)) for p in chances),
        ],
    }  # fmt: skip


def exact_row(world: Repair, p: float) -> dict[str, Any]:
    """Value iteration at one p: the expected seconds, a proven bound of their error, and from how
    many states its policy gets there.
    """
    process = world.process(p)
    found = value_iteration(process)
    return {
        "p": p,
        "expected_s": round(float(found.values[0]), 6),
        "error": found.error,
        "reaches_as_asked": int(reaching_states(process, found.policy).sum()),
        "sure": int(sure_states(process, found.policy).sum()),
    }


MOUNT_FIRST: dict[str, Callable[[float], float]] = {
    "in the cell's order": lambda _: 0.0,
    "shortest first": lambda seconds: seconds,
    "longest first": lambda seconds: -seconds,
}
"""Rules that learn nothing: what sits wrongly comes off first, the last part first; which part is
mounted next is by the least of these.
"""


def rule_policy(world: Repair, rank: Callable[[float], float]) -> np.ndarray:
    """`[S]` int, the operation that the rule asks for in each state (0 in the goal)."""
    parts = len(world.product.names)

    def choose(node: Sequence[int]) -> int:
        allowed = legal(world.product, tuple(node))
        wrong = [part for part in allowed if part >= parts and node[part - parts] == WRONG]
        if wrong:
            return max(wrong)
        mounts = [part for part in allowed if part < parts]
        if mounts:
            return min(mounts, key=lambda part: rank(world.product.mount[part]))
        return max(allowed, default=0)

    return np.array([choose(node) for node in world.nodes])


def best_rule_at(world: Repair, p: float) -> tuple[str, float]:
    """The rule of the least expected seconds from the empty table, solved exactly."""
    process = world.process(p)
    found = {
        name: float(policy_values(process, rule_policy(world, rank))[0])
        for name, rank in MOUNT_FIRST.items()
    }
    name = min(found, key=lambda one: found[one])
    return name, found[name]


def player_row(world: Repair, player: str, p: float, tables: np.ndarray) -> dict[str, Any]:
    """How the greedy policies of some tables (`[N, S, A]`, one a seed) do at one p.

    `expected_s`: per seed, solved exactly; None where the policy may go on for ever.
    `reaches_as_asked`: the share of states, per seed, from which it gets to the goal when the human
    slips no more. `finished`: the share of 1,000 episodes that end within 200 operations, from the
    empty table and, `finished_from_anywhere`, from states drawn alike from all. `error_s`: the
    largest difference of a learned value from the exact one, where the table says seconds.
    """
    import jax
    import jax.numpy as jnp

    process, rows = world.process(p), []
    anywhere = np.random.default_rng(0).integers(len(world.nodes), size=EPISODES)
    starts = jnp.asarray(np.concatenate([np.zeros(EPISODES, np.int64), anywhere]), jnp.int32)
    for seed, policy in enumerate(np.argmin(tables, axis=2)):
        value = float(policy_values(process, policy)[0])
        reached = np.asarray(
            _play(jax.random.key(seed), process, jnp.asarray(policy), starts, PATIENCE).reached
        )
        rows.append((
            round(value, 4) if np.isfinite(value) else None, float(reaching_states(process,
            policy).mean()),
            float(reached[:EPISODES].mean()), float(reached[EPISODES:].mean()),
        ))  # fmt: skip
    expected, as_asked, finished, from_anywhere = (
        list(column) for column in zip(*rows, strict=True)
    )
    row = {
        "player": player,
        "p": p,
        "expected_s": expected,
        "reaches_as_asked": as_asked,
        "finished": finished,
    }
    row["finished_from_anywhere"] = from_anywhere
    if player == "ours":
        exact = value_iteration(process).values
        row["error_s"] = [
            round(float(np.abs(np.where(process.goal, 0.0, table.min(axis=1)) - exact).max()), 5)
            for table in tables
        ]
    return row


def tables_of(world: Repair, p: float, config: Config, seeds: Sequence[int]) -> np.ndarray:
    """`[N, S, A]`, a table per seed, all learned side by side."""
    import jax

    keys = jax.vmap(jax.random.key)(np.asarray(seeds, np.uint32))
    return np.asarray(qlearning.train_seeds(keys, world.process(p), config).table)


def precision(cell: Cell, horizons: Mapping[float, float], config: Config) -> list[dict[str, Any]]:
    """How near learned values come to the exact ones, largest difference over all states: along
    episodes, and in rounds by either draw.

    Along episodes five times as many updates are made as there are rounds; a round updates every
    pair, and costs about as much as that.
    """
    world, rows = runs_on(cell), []
    for p, horizon in horizons.items():
        process, config = world.process(p), replace(config, horizon=horizon)
        ways = {
            "episodes": (
                qlearning.train_seeds,
                replace(OURS, steps=5 * config.steps, reports=config.reports),
                False,
            ),
            "rounds, independent draws": (
                qlearning.sweep_seeds,
                replace(config, stratified=False),
                True,
            ),
            "rounds, even draws": (qlearning.sweep_seeds, config, True),
            "rounds, even draws, single precision": (qlearning.sweep_seeds, config, False),
        }
        rows += [_precision_row(process, way, p, *told) for way, told in ways.items()]
    return rows


def longer_precision(cell: Cell, p: float) -> list[dict[str, Any]]:
    """The row of even draws in double precision with `LONGER_AT` times as many rounds."""
    config = replace(PRECISE, steps=PRECISE.steps * LONGER_AT[p], horizon=PRECISE_AT[p])
    way = f"rounds, even draws, {LONGER_AT[p]} times as many"
    return [_precision_row(runs_on(cell).process(p), way, p, qlearning.sweep_seeds, config, True)]


def _precision_row(
    process: Process,
    way: str,
    p: float,
    learn: Callable[..., Any],
    settings: Config,
    double: bool,
) -> dict[str, Any]:
    """How far one way of learning is from the exact values, after every report."""
    import jax

    began = time.process_time()
    with jax.enable_x64(double):
        learned = learn(jax.random.split(jax.random.key(0), 1), process, settings)
        curve = np.asarray(learned.curve[0])
    pairs = 1 if way == "episodes" else int(process.legal.sum())
    each = -(-settings.steps // settings.reports) * pairs
    exact = value_iteration(process).values
    return {
        "way": way,
        "p": p,
        "updates": [each * (index + 1) for index in range(settings.reports)],
        "error_s": [float(f"{error:.3g}") for error in np.abs(curve - exact).max(axis=1)],
        "cpu_s": round(time.process_time() - began, 1),
    }


def speed(cell: Cell) -> dict[str, Any]:
    """How long the learning itself takes, compiled before: 100,000 updates on the cell at p = 0,
    and how far its value is from exact.
    """
    import jax

    world, config = (
        runs_on(cell),
        Config(steps=100_000, epsilon=0.2, epsilon_end=0.2, exploring_starts=True, limit=30),
    )
    process = world.process(0.0)
    keys = jax.random.split(jax.random.key(0), 1)
    jax.block_until_ready(qlearning.train_seeds(keys, process, config))
    began = time.perf_counter()
    learned = jax.block_until_ready(qlearning.train_seeds(keys, process, config))
    wall_s = time.perf_counter() - began
    error = np.abs(np.asarray(learned.curve[0, -1]) - value_iteration(process).values).max()
    return {
        "cell": cell.name,
        "updates": config.steps,
        "wall_s": round(wall_s, 3),
        "error_s": round(float(error), 5),
    }


def joint(cell: Cell) -> Cell:
    """The cell in which every task occupies all operators for as long as its quickest way takes:
    one operation at a time.
    """
    everybody = tuple(cell.operators)
    if len(everybody) == 1:
        return cell
    tasks = {
        name: {
            "together": [
                {
                    "operators": everybody,
                    "time": min(mode.time for mode in cell.modes(name)),
                    "stress": 0,
                }
            ],
            "after": task.after,
        }
        for name, task in cell.tasks.items()
    }
    return cell_of(
        {
            "format": 1,
            "operators": {
                name: {"kind": operator.kind} for name, operator in cell.operators.items()
            },
            "tasks": tasks,
        }
    )


def table(document: Mapping[str, Any]) -> str:
    """Expected seconds per p: published, as described, ours, exact; and how near the learned values
    come. Markdown.
    """
    lines, known = [], {cell.name: cell for cell in cells().values()}
    for found in document["cells"].values():
        world = runs_on(known[found["cell"]])
        side_by_side = best_rule(known[found["cell"]], lambda makespan, _: makespan)
        assert side_by_side is not None  # neither cell knows limits
        lines += [
            (
                f"{found['cell']}: {found['states']} states, {found['wrong_states']} of them with a"
                " part that sits wrongly."
            ),
            "",
        ]
        players = list(dict.fromkeys(row["player"] for row in found["players"]))
        lines += [
            f"| p | published | {' | '.join(players)} | best rule | exact |",
            "|" + "---|" * (len(players) + 4),
        ]
        for exact in found["exact"]:
            rows = {row["player"]: row for row in found["players"] if row["p"] == exact["p"]}
            entries = [_entry(rows[player]) for player in players]
            lines.append(
                f"| {exact['p']:g} | not public | {' | '.join(entries)} |"
                f" {_by_rule(world, exact)} | {exact['expected_s']:.2f} s |"
            )
        lines += [
            "",
            (
                f"States with a way to the goal: {found['with_a_way_to_the_goal']} of"
                f" {found['states']}; those from which the exact policy gets there:"
                f" {min(row['sure'] for row in found['exact'])}. The planner, one operation at a"
                f" time: {found['planned_one_at_a_time']:g} s; side by side:"
                f" {found['planned_side_by_side']:g} s; the best dispatch rule side by side:"
                f" {side_by_side.result.makespan:g} s ({side_by_side.name})."
            ),
            "",
        ]
    fast = document["speed"]
    lines += [
        *_precision_lines(document["precision"]),
        "",
        (
            f"{fast['updates']:,} updates on the thesis's cell at p = 0 take {fast['wall_s']:g} s,"
            f" compiled before; largest difference {fast['error_s']:g} s."
        ),
        (
            "Expected times of greedy policies, mean over the seeds that finish for certain (how"
            " many do); in brackets the share of all states from which they get to the goal when"
            " the human slips no more. The best rule learns nothing: what sits wrongly comes off"
            " first, then parts are mounted by the order that it names; its time is solved exactly."
        ),
        *origin(document, f"{len(document['seeds'])} seeds"),
    ]
    return "\n".join(lines)


def _by_rule(world: Repair, exact: Mapping[str, Any]) -> str:
    name, expected = best_rule_at(world, exact["p"])
    over = expected / exact["expected_s"] - 1
    return f"{expected:.2f} s ({name}), {max(over, 0.0):.1%}"


def _precision_lines(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Per way and p the largest difference of a learned value from the exact one, and after how
    many updates.
    """
    chances = list(dict.fromkeys(row["p"] for row in rows))
    lines = [
        (
            "| largest difference from the exact value |"
            f" {' | '.join(f'p = {p:g}' for p in chances)} |"
        ),
        "|" + "---|" * (len(chances) + 1),
    ]
    for way in dict.fromkeys(row["way"] for row in rows):
        own = {row["p"]: row for row in rows if row["way"] == way}
        updates = next(iter(own.values()))["updates"][-1]
        errors = [f"{own[p]['error_s'][-1]:.2g} s" if p in own else "–" for p in chances]
        lines.append(f"| {way}, {updates:,} updates | {' | '.join(errors)} |")
    return lines


def _entry(row: Mapping[str, Any]) -> str:
    sure = [value for value in row["expected_s"] if value is not None]
    mean = f"{np.mean(sure):.2f} s" if sure else "never for certain"
    return (
        f"{mean} ({len(sure)} of {len(row['expected_s'])}) [{np.mean(row['reaches_as_asked']):.1%}]"
    )


def draw_figures(document: Mapping[str, Any], folder: Path) -> list[Path]:
    """Time against p, what is reached from where, precision, and the product: SVG and PNG."""
    from tandem.draw.saving import save
    from tandem.lab.antonelli2021.figures import figures

    folder.mkdir(parents=True, exist_ok=True)
    return [
        save(figure, folder / f"{name}{form}", dpi=110)
        for name, figure in figures(document)
        for form in (".svg", ".png")
    ]


# --- What it can do: for the laboratory ---

SHORT = replace(OURS, steps=50_000)


def episode(cell: Cell, seed: int, *, p: float, config: Config = SHORT) -> Played:
    """One episode, robot's table learned on the cell at this p, from the empty table to the goal
    (or 200 operations).
    """
    world = runs_on(cell)
    process, parts = world.process(p), len(world.product.names)
    tables = tables_of(world, p, config, [seed])[0]
    random = np.random.default_rng(seed)
    state, clock, deviations, undone = 0, 0.0, 0, 0
    decisions: list[float] = []
    while not process.goal[state] and len(decisions) < PATIENCE:
        began = time.perf_counter()
        operation = int(np.argmin(tables[state]))
        decisions.append(1000 * (time.perf_counter() - began))
        happens = int(random.choice(process.chance.shape[2], p=process.chance[state, operation]))
        clock += float(process.cost[state, operation, happens])
        deviations += happens != 0
        undone += happens == 0 and operation >= parts
        state = int(process.after[state, operation, happens])
    return Played(clock if process.goal[state] else None, tuple(decisions), deviations, undone)


def _until_it_happens(cell: Cell, seed: int, happened: Callable[[Played], bool]) -> Played:
    """The first of a few episodes in which it did; a human who deviates with p = 0.3 soon does
    anything.
    """
    played: Iterator[Played] = (episode(cell, seed + index, p=0.3) for index in range(5))
    first = next(played)
    return first if happened(first) else next((one for one in played if happened(one)), first)


def _exact_values(document: Mapping[str, Any]) -> list[float]:
    return [row["expected_s"] for found in document["cells"].values() for row in found["exact"]]


FEATURES = Features(
    trains=lambda: qlearning.train,
    agents=lambda: ["robot"],  # one table: the human does what is asked for, or slips
    cost=lambda cell: float(value_iteration(runs_on(cell).process(0.0)).values[0]),
    play=lambda cell, seed: episode(cell, seed, p=0.0),
    deviate=lambda cell, seed: _until_it_happens(cell, seed, lambda played: played.deviations > 0),
    mistake=lambda cell, seed: _until_it_happens(cell, seed, lambda played: played.undone > 0),
    exact=_exact_values,
)


@cache
def _compiled_play() -> Any:
    import jax

    return partial(jax.jit, static_argnames="limit")(qlearning.play)


def _play(key: Any, process: Any, policy: Any, starts: Any, limit: int) -> Any:
    return _compiled_play()(key, process, policy, starts, limit=limit)
