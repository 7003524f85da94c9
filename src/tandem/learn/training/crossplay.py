"""Cross-play: the robots of one trained policy beside the humans of another, every pair of them.

Who was trained together may have agreed on habits that nobody else understands: what a policy is
worth shows beside partners that it has never met (Hu et al. (2020), "Other-Play" for zero-shot
coordination, ICML, arXiv:2003.02979).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from tandem.cell.model import Cell, plain
from tandem.errors import CellError, UsageError
from tandem.learn.algorithm import Learnt, Pairs, TrainingOrder
from tandem.learn.episodes import played
from tandem.learn.ppo.players import drawn
from tandem.learn.results import Reached, paid
from tandem.learn.training.algorithms import DECIDERS, FORMERLY, decider_of, trainee
from tandem.learn.training.evaluate import Line, exact_front, line_of
from tandem.learn.training.runs import RunFolder, asked_cell
from tandem.learn.training.trainer import order_of
from tandem.plan.result import Front
from tandem.world.arrays import Array, Arrays
from tandem.world.episode import Shift

DRAWS = 2000
"""Of the bootstrap."""
FEWEST = 3
"""Seeds that every run needs for an interval: two say nothing of a third."""


@dataclass(frozen=True)
class Partner:
    """One policy of a run.

    Attributes:
      run: what the run is called. path: of the policy. order: what was trained.
    """

    run: str
    seed: int
    path: Path
    order: TrainingOrder

    @property
    def name(self) -> str:
        """Run and seed."""
        return f"{self.run}:{self.seed}"

    @property
    def algorithm(self) -> str:
        """Its name in `ALGORITHMS`."""
        name = self.order.recipe.algorithm
        return FORMERLY.get(name, name)


@dataclass(frozen=True)
class Mean:
    """Over pairs of policies.

    Attributes:
      robots, humans: run whose robots and humans play; `which`: "own partner", "other seeds" of the
        same run, or "other run".
      pairs, done: how many, and the mean share of their episodes that came to an end.
      makespan, gap: means over the pairs that ended; `gap_ci95`: an interval that says what other
        seeds would bring, None with fewer than `FEWEST` of each run.
    """

    robots: str
    humans: str
    which: str
    pairs: int
    done: float
    makespan: float | None
    gap: float | None
    gap_ci95: tuple[float, float] | None


@dataclass(frozen=True)
class CrossPlay:
    """All pairs on a cell: `lines[i][j]` has the robots of partner i, the humans of partner j."""

    cell: Cell
    front: Front | None
    partners: tuple[Partner, ...]
    lines: tuple[tuple[Line, ...], ...]
    stress_factor: float
    people: str
    episodes: int
    draws: bool
    seed: int

    @property
    def runs(self) -> tuple[str, ...]:
        """Their names, each once."""
        return tuple(dict.fromkeys(partner.run for partner in self.partners))

    def means(self) -> list[Mean]:
        """Of each two runs: partners of a run with themselves, with each other, and with another
        run's.
        """
        return [
            self._mean(robots, humans, which)
            for robots in self.runs
            for humans in self.runs
            for which in (("own partner", "other seeds") if robots == humans else ("other run",))
            if which != "other seeds" or len(self._of(robots)) > 1
        ]

    def _of(self, run: str) -> list[int]:
        return [place for place, partner in enumerate(self.partners) if partner.run == run]

    def _mean(self, robots: str, humans: str, which: str) -> Mean:
        rows, columns = self._of(robots), self._of(humans)
        counts = {
            "own partner": np.eye(len(rows)),
            "other seeds": 1 - np.eye(len(rows)),
            "other run": np.ones((len(rows), len(columns))),
        }[which]
        picked = [
            self.lines[i][j]
            for i, row in zip(rows, counts, strict=True)
            for j, counted in zip(columns, row, strict=True)
            if counted
        ]
        gaps = np.array([[_number(self.lines[i][j].gap) for j in columns] for i in rows])
        makespans = [line.makespan for line in picked if line.makespan is not None]
        interval = None
        if min(len(rows), len(columns)) >= FEWEST:
            interval = _interval(gaps, counts, same=robots == humans, seed=self.seed)
        return Mean(
            robots,
            humans,
            which,
            len(picked),
            round(float(np.mean([line.done for line in picked])), 6),
            None if not makespans else plain(round(float(np.mean(makespans)), 4)),
            _rounded(_weighted(gaps, counts)),
            interval,
        )

    def to_dict(self) -> dict[str, Any]:
        """The document of `tandem crossplay --json`."""
        front = self.front
        return {
            "schema_version": 1,
            "cell": self.cell.name,
            "cell_digest": self.cell.digest,
            "stress_factor": plain(self.stress_factor),
            "people": self.people,
            "episodes": self.episodes,
            "drawn": self.draws,
            "seed": self.seed,
            "exact_front": [] if front is None else [list(map(plain, at)) for at in front.points],
            "exact_front_complete": front is not None and front.complete,
            "partners": [
                {
                    "name": partner.name,
                    "run": partner.run,
                    "seed": partner.seed,
                    "recipe": partner.order.name,
                }
                for partner in self.partners
            ],
            "pairs": [
                {"robots": robots.name, "humans": humans.name, **line.to_dict()}
                for robots, row in zip(self.partners, self.lines, strict=True)
                for humans, line in zip(self.partners, row, strict=True)
            ],
            "means": [vars(mean) for mean in self.means()],
        }


def crossplay(
    runs: Sequence[str | Path],
    cell: Cell | None = None,
    *,
    people: str = "compliant",
    episodes: int = 100,
    draws: bool = False,
    seed: int = 0,
    stress_factor: float | None = None,
    front_limit: float = 30.0,
    tell: Callable[[str], None] = lambda _: None,
) -> CrossPlay:
    """Plays every policy's robots beside every policy's humans.

    Who decides is settled by whose turn it is: the humans' policy for a human, the robots' for a
    robot or a machine; a joint task is begun by whoever names it first.

    Args:
      runs: folders of `tandem train`; all their seeds take part.
      cell: another cell than the first run's own.
      people: whose pace, fatigue and slips the humans have, in words; every pair meets the same.
      episodes: of each pair; one where nothing is drawn, neither people nor actions.
      draws: actions are drawn from what the policies believe, instead of the most probable.
      stress_factor: what a unit of stress counts in the gap; the runs' own when absent.

    Raises:
      CellError: a folder holds no run, or an algorithm cannot hold the cell.
      UsageError: with every reason why the policies cannot play together.
    """
    partners = _partners(runs)
    played_on = cell or asked_cell(RunFolder(Path(runs[0])), RunFolder(Path(runs[0])).asked())
    factor = _factor(partners, stress_factor)
    told = {one.name: replace(one.order, cell=played_on, stress_factor=factor) for one in partners}
    play = _together(partners, played_on, told, people, episodes, draws, seed)
    costs = _costs(partners[0], played_on, told[partners[0].name])
    front, rows = exact_front(played_on, front_limit), []
    for robots in partners:
        tell(f"robots of {robots.name}")
        rows.append(
            tuple(
                line_of(played_on, front, costs, f"{robots.name} | {humans.name}", found)
                for humans in partners
                for found in [play(robots, humans)]
            )
        )
    return CrossPlay(played_on, front, partners, tuple(rows), factor, people, episodes, draws, seed)


Play = Callable[[Partner, Partner], list[Reached]]
"""Robots and humans -> their episodes."""


def _partners(runs: Sequence[str | Path]) -> tuple[Partner, ...]:
    """Every policy of every run. Raises CellError, and UsageError for a run without one."""
    found, faults = list[Partner](), list[str]()
    names = [Path(run).resolve().name for run in runs]
    if twice := {str(run) for run in runs if [*map(str, runs)].count(str(run)) > 1}:
        faults.append(f"{', '.join(sorted(twice))}: named twice. Name each run once.")
    for name, path in zip(names, runs, strict=True):
        run = RunFolder(Path(path))
        order = order_of(run)
        if not run.seeds:
            faults.append(f"{path}: holds no trained policy. Go on with: tandem train --resume")
        label = name if names.count(name) == 1 else str(path)
        found += [Partner(label, seed, run.policy(seed), order) for seed in run.seeds]
    if faults:
        raise UsageError("\n".join(faults))
    return tuple(found)


def _factor(partners: Sequence[Partner], given: float | None) -> float:
    factors = {partner.order.stress_factor for partner in partners}
    if given is not None:
        if not (np.isfinite(given) and given >= 0):
            raise UsageError(f"stress factor {given}: must be a number, 0 or more.")
        return given
    if len(factors) > 1:
        told = ", ".join(f"{one:g}" for one in sorted(factors))
        raise UsageError(
            f"the runs were trained at the stress factors {told}: say by which one costs are"
            " compared, with --stress-factor."
        )
    return factors.pop()


def _costs(first: Partner, cell: Cell, order: TrainingOrder) -> dict[str, Any]:
    """What time and stress cost: by the event world, or as the world of the partners' own says."""
    if first.algorithm in DECIDERS:
        return paid(order.stress_factor)
    return trainee(first.algorithm).costs(cell, order)


def _together(
    partners: Sequence[Partner],
    cell: Cell,
    told: Mapping[str, TrainingOrder],
    people: str,
    episodes: int,
    draws: bool,
    seed: int,
) -> Play:
    """How any two of them are played. Raises UsageError with every reason why they cannot be."""
    algorithms = dict.fromkeys(partner.algorithm for partner in partners)
    own = [name for name in algorithms if name not in DECIDERS]
    if not own:
        return _in_the_event_world(partners, cell, told, people, episodes, draws, seed)
    faults = [
        f"{name}: its two sides are one policy, which cannot be taken apart."
        for name in own
        if not hasattr(trainee(name), "pair")
    ]
    if len(algorithms) > 1:
        faults.append(
            f"policies of {', '.join(algorithms)} play in different worlds. Take runs of one of"
            f" them, or of {', '.join(DECIDERS)}."
        )
    if people != "compliant":
        faults.append(f"people {people!r}: the world of {own[0]} knows no paces. Leave it out.")
    if faults:
        raise UsageError("\n".join(faults))
    apart = cast("type[Pairs]", trainee(own[0]))

    def play(robots: Partner, humans: Partner) -> list[Reached]:
        return apart.pair(
            robots.path,
            humans.path,
            cell,
            told[robots.name],
            seed=seed,
            episodes=episodes,
            draws=draws,
        )

    return play


def _in_the_event_world(
    partners: Sequence[Partner],
    cell: Cell,
    told: Mapping[str, TrainingOrder],
    people: str,
    episodes: int,
    draws: bool,
    seed: int,
) -> Play:
    """Raises CellError and UsageError, with every policy that does not fit the cell."""
    learnt, faults = dict[str, Learnt](), list[str]()
    for partner in partners:
        try:
            learnt[partner.name] = decider_of(partner.path, cell)
        except CellError:
            raise
        except UsageError as error:
            faults.append(f"{partner.name}: {error}")
            continue
        if draws and not learnt[partner.name].believes:
            faults.append(
                f"{partner.name}: a policy of {partner.algorithm} tells costs, not how sure it is;"
                " nothing can be drawn from it. Leave out --draw."
            )
    if faults:
        raise UsageError("\n".join(faults))
    number = episodes if draws or people != "compliant" else 1

    def play(robots: Partner, humans: Partner) -> list[Reached]:
        decide = _decider(
            learnt[robots.name], learnt[humans.name], np.random.default_rng(seed) if draws else None
        )
        factor = told[robots.name].stress_factor
        return played(cell, factor, decide, number, people=people, seed=seed)

    return play


def _decider(
    robots: Learnt, humans: Learnt, generator: np.random.Generator | None
) -> Callable[[Arrays, Shift], Array]:
    def decide(arrays: Arrays, shift: Shift) -> Array:
        mine = humans if arrays.human[int(shift.turn)] else robots
        worth = mine.worth(arrays, shift.state, shift.mask, shift.turn)
        action = int(np.argmax(worth)) if generator is None else drawn(worth, generator)
        return np.int32(-1 if action == arrays.way_ticks.shape[0] else action)

    return decide


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def _weighted(values: Array, weights: Array) -> float:
    """The mean of what there is; not a number where there is nothing."""
    weights = np.where(np.isnan(values), 0.0, weights)
    whole = weights.sum()
    return float((np.nan_to_num(values) * weights).sum() / whole) if whole else np.nan


def _interval(values: Array, counts: Array, *, same: bool, seed: int) -> tuple[float, float] | None:
    """95 % of a bootstrap that draws policies anew: a policy that is drawn twice brings all its
    pairs twice, but never one with itself as if that were another.
    """
    generator = np.random.default_rng(seed)
    rows, columns = values.shape
    found = []
    for _ in range(DRAWS):
        robots = generator.multinomial(rows, np.full(rows, 1 / rows))
        humans = robots if same else generator.multinomial(columns, np.full(columns, 1 / columns))
        weights = counts * robots[:, None] * humans[None, :]
        # a policy and itself are one pair, however often it was drawn
        weights = np.where(np.eye(rows, columns) * counts * same > 0, robots[:, None], weights)
        mean = _weighted(values, weights)
        found += [] if np.isnan(mean) else [mean]
    if not found:
        return None
    low, high = np.quantile(found, [0.025, 0.975])
    return round(float(low), 6), round(float(high), 6)


def _rounded(value: float) -> float | None:
    return None if np.isnan(value) else round(value, 6)
