"""Kinat (2023): its table 6-1 and figures 6-1 to 6-8, published beside the thesis's recipe run
here, our recipe, and the exact optimum.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.kinat2023.optimal import return_optimal
from tandem.lab.kinat2023.recipe import STATION
from tandem.lab.kinat2023.rewards import REWARDS, reward_set
from tandem.lab.kinat2023.runs import (
    FACTORS,
    OURS,
    PUBLISHED,
    VARIANTS,
    run_all,
    run_ours,
    run_thesis,
)
from tandem.lab.kinat2023.station import station, whole_ticks
from tandem.lab.kinat2023.world import State, Station
from tandem.lab.origin import origin
from tandem.lab.records import read_record, stored_document, write_document
from tandem.lab.systems import Features, Played
from tandem.learn.baseline import best_rule
from tandem.learn.ppo.recipes import longer
from tandem.learn.training.runs import versions
from tandem.plan.methods import plan
from tandem.plan.rules import RULES

SEEDS_OF_THE_THESIS, SEEDS_OF_OURS = 10, 20
QUICK = 0.02
"""The share of every budget that a quick run has."""

STORED = "thesis.json"


def reproduce(
    folder: Path,
    *,
    quick: bool = False,
    seeds: int | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Trains, plays and returns the document, which is also written to `folder/thesis.json`.

    The records of the thesis's recipe are kept in `folder/records` as they come; a run that was
    stopped goes on from there.

    Args:
      quick: two seeds and a fiftieth of the budgets.
      seeds: of the thesis's recipe; 10 when absent. Ours has 20.
    """
    if quick:
        records = list(_quick_records(seeds or 1))
    else:
        tell(f"our recipe: {SEEDS_OF_OURS} seeds at {len(FACTORS)} factors, side by side")
        records = run_ours(range(SEEDS_OF_OURS))
        for file in run_all(
            folder / "records", list(VARIANTS), range(seeds or SEEDS_OF_THE_THESIS)
        ):
            tell(f"{file.name}")
            records.append(read_record(file))
    document = assemble(records, quick=quick)
    return write_document(folder / STORED, document)


def stored() -> dict[str, Any]:
    """The document of the long run that ships with the package. Raises CellError when this copy has
    none, or a damaged one.
    """
    return stored_document("kinat2023/results.json", "thesis")


def assemble(records: Sequence[Mapping[str, Any]], *, quick: bool = False) -> dict[str, Any]:
    """The document: what is published and what is exact, a summary per recipe and factor, and every
    record.
    """
    front = [list(point) for point in plan(thesis_cell(), time_limit=120, seed=0).points]
    variants = [OURS, *VARIANTS]
    return {
        "schema_version": 1,
        "command": "tandem reproduce thesis" + " --quick" * quick,
        "quick": quick,
        "versions": versions(),
        "published": {str(factor): list(PUBLISHED[factor]) for factor in FACTORS},
        "exact_front": front,
        "return_optimal": {
            name: {str(factor): _optimal_pairs(name, factor) for factor in FACTORS}
            for name in ("appendix", "table_5_2")
        },
        "summary": [
            summary(variant, factor, own, front)
            for variant in variants
            for factor in FACTORS
            if (
                own := [
                    record
                    for record in records
                    if record["variant"] == variant and record["factor"] == factor
                ]
            )
        ],
        "watched": watched(records),
        "records": [
            {name: value for name, value in record.items() if name != "every_episode"}
            for record in records
        ],
    }


@cache
def rule_beside(rewards: str, factor: float) -> str:
    """The best dispatch rule and the best of a hundred drawn schedules, by what the rewards of that
    name come to: a second is paid to both agents, and a unit of stress on the human costs twice the
    factor (the human's -e and the +e that the robot would have had).
    """
    cost = partial(_cost, second=-2 * float(REWARDS[rewards].step), unit=2 * factor)
    best, drawn = (best_rule(thesis_cell(), cost, among=among) for among in (RULES, ("best-of-n",)))
    assert best is not None  # the thesis's cell knows no limits
    assert drawn is not None
    told = [_show((one.result.makespan, one.result.stress)) for one in (best, drawn)]
    return f"{told[0]} ({best.name}); best-of-n {told[1]}"


def _cost(makespan: float, stress: float, *, second: float, unit: float) -> float:
    return second * makespan + unit * stress


def watched(records: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Of the recipe as it is written, for each factor the first run, with every episode: what
    figure 6-2 shows. The other runs keep their curves only.
    """
    own = {
        record["factor"]: record
        for record in reversed(records)
        if record["variant"] == "thesis" and record.get("every_episode")
    }
    return [
        {name: own[factor][name] for name in ("variant", "factor", "seed", "every_episode")}
        for factor in FACTORS
        if factor in own and own[factor]["every_episode"]["returns"]
    ]


def summary(
    variant: str,
    factor: float,
    records: Sequence[Mapping[str, Any]],
    front: Sequence[Sequence[float]],
) -> dict[str, Any]:
    """Over the seeds: how often the greedy and the sampled policies finish, reach the published
    pair, a return-optimal one, the front.

    A share comes with its 95 % interval (Wilson), a mean with the half width of its 95 % interval.
    """
    number = len(records)
    greedy = [_pair(record["greedy"]) for record in records]
    best = [_pair(record["best_of_n"]) if record["best_of_n"] else None for record in records]
    rewards = "table_5_2" if "table 5-2" in variant else "appendix"
    optimal = [tuple(pair) for pair in _optimal_pairs(rewards, factor)]
    points = [tuple(point) for point in front]

    def reach(
        pairs: Sequence[tuple[float, float] | None], wanted: Sequence[tuple[float, ...]]
    ) -> dict[str, Any]:
        count = sum(pair in wanted for pair in pairs if pair)
        return {"count": count, "share": count / number, "ci95": wilson(count, number)}

    return {
        "variant": variant,
        "factor": factor,
        "seeds": number,
        "greedy": {
            "finished": reach(greedy, [pair for pair in greedy if pair]),
            "published": reach(greedy, [PUBLISHED[int(factor)]]),
            "return_optimal": reach(greedy, optimal),
            "front": reach(greedy, points),
            "pairs": _counts(greedy),
            "makespan": mean([pair[0] for pair in greedy if pair]),
            "stress": mean([pair[1] for pair in greedy if pair]),
            "illegal": mean(
                [
                    record["greedy"]["illegal"]
                    for record in records
                    if record["greedy"]["makespan"] is not None
                ]
            ),
        },
        "sampled": {
            "finished": mean([record["sampled"]["done"] for record in records]),
            "makespan": mean(
                [
                    record["sampled"]["makespan"]
                    for record in records
                    if record["sampled"]["makespan"] is not None
                ]
            ),
            "stress": mean(
                [
                    record["sampled"]["stress"]
                    for record in records
                    if record["sampled"]["stress"] is not None
                ]
            ),
        },
        "best_of_n": {
            "published": reach(best, [PUBLISHED[int(factor)]]),
            "return_optimal": reach(best, optimal),
            "front": reach(best, points),
        },
        "steps": mean([record["steps"] for record in records]),
        "cpu_s": mean([record["cpu_s"] for record in records]),
        "ended_early": sum(record["ended_early"] for record in records),
    }


def wilson(count: int, number: int) -> list[float]:
    """95 % interval of a share (Wilson 1927)."""
    z, share = 1.959964, count / number
    middle = (share + z * z / (2 * number)) / (1 + z * z / number)
    half = (
        z
        / (1 + z * z / number)
        * math.sqrt(share * (1 - share) / number + z * z / (4 * number * number))
    )
    return [round(max(0.0, middle - half), 4), round(min(1.0, middle + half), 4)]


def mean(values: Sequence[float]) -> dict[str, float | None]:
    """Mean and half width of its 95 % interval (normal approximation); None where there are too few
    values.
    """
    number = len(values)
    if not number:
        return {"mean": None, "ci95": None}
    centre = sum(values) / number
    spread = (
        math.sqrt(sum((value - centre) ** 2 for value in values) / (number - 1))
        if number > 1
        else None
    )
    return {
        "mean": round(centre, 4),
        "ci95": None if spread is None else round(1.96 * spread / math.sqrt(number), 4),
    }


def table(document: Mapping[str, Any]) -> str:
    """Table 6-1 and what stands beside it, as Markdown."""
    lines = [
        (
            "| factor | recipe | seeds | published | greedy: most frequent | greedy reaches"
            " published | reaches return-optimal | reaches the front | greedy finishes | sampled"
            " makespan | sampled stress | best of 100 return-optimal | return-optimal (DP) |"
            " best rule |"
        ),
        "|" + "---|" * 14,
    ]
    for row in sorted(document["summary"], key=lambda row: row["factor"]):
        rewards = "table_5_2" if "table 5-2" in row["variant"] else "appendix"
        greedy, sampled = row["greedy"], row["sampled"]
        pairs = [f"{_show(pair[:2])} {pair[2]} times" for pair in greedy["pairs"][:2]]
        cells = [
            row["factor"], row["variant"], row["seeds"],
            _show(document["published"][str(row["factor"])]), "; ".join(pairs) or "none finished",
            *(_share(greedy[name]) for name in ("published", "return_optimal", "front",
            "finished")),
            _mean(sampled["makespan"], " s"), _mean(sampled["stress"]),
            _share(row["best_of_n"]["return_optimal"]),
            ", ".join(
                _show(pair) for pair in document["return_optimal"][rewards][str(row["factor"])]
            ),
            rule_beside(rewards, row["factor"]),
        ]  # fmt: skip
        lines.append("| " + " | ".join(str(cell) for cell in cells) + " |")
    exact = ", ".join(_show(point) for point in document["exact_front"])
    lines += [
        "",
        (
            f"Exact front: {exact}. Pairs are makespan in seconds / stress. Shares with their 95 %"
            " interval (Wilson), means with the half width of theirs. The best rule learns nothing:"
            " the dispatch rule, or the best of a hundred drawn schedules, of the largest return."
        ),
        _beyond(document),
        *origin(document),
    ]
    return "\n".join(lines)


def draw_figures(document: Mapping[str, Any], folder: Path) -> list[Path]:
    """Figures 6-1 to 6-8 redrawn, as SVG and PNG; returns the files."""
    from tandem.draw.saving import save
    from tandem.lab.kinat2023.figures import figures

    folder.mkdir(parents=True, exist_ok=True)
    return [
        save(figure, folder / f"{name}{form}", dpi=110)
        for name, figure in figures(document)
        for form in (".svg", ".png")
    ]


def runs_on(cell: Cell) -> Station:
    """The cell as the thesis's station holds it. Raises CellError that names every feature that it
    cannot express.
    """
    return station(cell, per_second=whole_ticks(cell))


def _quick_records(seeds: int) -> Iterator[dict[str, Any]]:
    yield from run_ours(range(seeds), recipe=longer(STATION, QUICK))
    for variant, recipe in VARIANTS.items():
        for seed in range(seeds):
            yield run_thesis(
                variant,
                FACTORS[seed % len(FACTORS)],
                seed,
                longer(recipe, QUICK / 4),
                most_steps=5_000,
            )


def _optimal_pairs(rewards: str, factor: float) -> list[list[float]]:
    return [
        list(pair)
        for pair in return_optimal(thesis_cell(), reward_set(rewards, stress_factor=factor)).pairs
    ]


def _pair(played: Mapping[str, Any]) -> tuple[float, float] | None:
    return None if played["makespan"] is None else (played["makespan"], played["stress"])


def _counts(pairs: Sequence[tuple[float, float] | None]) -> list[list[float]]:
    found = [pair for pair in pairs if pair]
    return [
        [*pair, found.count(pair)]
        for pair in sorted(set(found), key=lambda pair: (-found.count(pair), pair))
    ]


def _show(pair: Sequence[float]) -> str:
    return f"{pair[0]:g}/{pair[1]:g}"


def _beyond(document: Mapping[str, Any]) -> str:
    """Which published pairs are as quick as can be, and beaten in stress by a point of the
    front.
    """
    told = []
    for factor, (makespan, stress) in document["published"].items():
        least = min(
            (point[1] for point in document["exact_front"] if point[0] <= makespan), default=stress
        )
        if least < stress:
            told.append(
                f"Published at factor {factor}: makespan-optimal, stress +{stress - least:g}"
                f" ({_show((makespan, least))} exists)."
            )
    return " ".join(told)


def _share(reached: Mapping[str, Any]) -> str:
    low, high = reached["ci95"]
    return f"{reached['count']} ({low:.0%}–{high:.0%})"


def _mean(value: Mapping[str, float | None], unit: str = "") -> str:
    if value["mean"] is None:
        return "–"
    return f"{value['mean']:.2f}{unit}" + (
        f" ± {value['ci95']:.2f}" if value["ci95"] is not None else ""
    )


# --- What it can do: for the laboratory ---

STRESS_FACTOR = 1.0
"""Of the probes: stress counts."""
SHORT = 0.01
"""The share of our recipe's budget that a policy of the probes has."""


def _least_cost(cell: Cell) -> float:
    """What the rewards cost at least, robot and human together."""
    return -return_optimal(
        cell, reward_set("appendix", stress_factor=STRESS_FACTOR), per_second=whole_ticks(cell)
    ).value


def _carry(trained_on: Cell, played_on: Cell, seed: int) -> Played:
    from tandem.lab.kinat2023.episode import play, seconds
    from tandem.lab.kinat2023.players import chooser
    from tandem.learn.training.agents import PPO

    agents = PPO(trained_on, recipe_name="station", stress_factor=STRESS_FACTOR, seed=seed)
    agents.recipe = longer(STATION, SHORT)
    policy = agents.learn().policy
    assert policy is not None
    decide, times = chooser(policy, "decisions"), []

    def timed(data: Station, state: State) -> Any:
        began = time.perf_counter()
        action = decide(data, state)
        times.append(1000 * (time.perf_counter() - began))
        return action

    per_second = whole_ticks(played_on)
    episode = play(
        played_on, reward_set("appendix", stress_factor=STRESS_FACTOR), timed, per_second=per_second
    )
    return Played(seconds(episode.ticks, per_second) if episode.done else None, tuple(times))


def _agents() -> Sequence[str]:
    from tandem.lab.kinat2023.learn_env import StationWorld

    return StationWorld.of(thesis_cell(), STATION, stress_factor=STRESS_FACTOR).agents


def _trains() -> Callable[..., Any]:
    from tandem.learn.ppo import ppo

    return ppo.train


FEATURES = Features(
    trains=_trains,
    agents=_agents,
    cost=_least_cost,
    play=lambda cell, seed: _carry(cell, cell, seed),
    carry=_carry,
    exact=lambda document: [value for point in document["exact_front"] for value in point],
)
