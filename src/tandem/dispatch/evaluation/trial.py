"""The judge: deciders beside people, many episodes, the same chances for all of them.

Every decider meets the same episodes (common random numbers), so differences between deciders are
known far better than their means.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tandem.cell.model import Cell, plain
from tandem.cell.names import Known
from tandem.dispatch.deciders.memory import settled_memory
from tandem.dispatch.deciders.own import OwnPolicyError
from tandem.dispatch.deciders.policy import Chosen, Options, Policy, plan_of
from tandem.dispatch.deciders.table import POLICIES, theirs
from tandem.dispatch.evaluation.batch import EpisodeBatch, Outcome
from tandem.dispatch.evaluation.best_response import PLANNING_WORK, optimum
from tandem.dispatch.lookahead.objective import SECONDS, Objective
from tandem.errors import CellError, TandemError, UsageError
from tandem.extensions import is_dotted
from tandem.world.arrays import Names
from tandem.world.people import Person
from tandem.world.population import Crowd, crowd
from tandem.world.randomness import OFF, Chance, Draw

Maker = Callable[[Cell, Objective, Options], Policy]
"""Makes a decider for a cell."""

MOST_PERSONS = 64
"""A crowd of more different people gets no exact optimum: it would be one dynamic programme for
each.
"""
Z = 1.96
"""Half the width of a 95 % interval in standard errors."""


@dataclass(frozen=True)
class Trial:
    """What is to be judged; `judge` says what each of it means.

    Attributes:
      policies: name -> what makes the decider for a cell.
      people: one or more descriptions, each judged by itself.
      episodes: per description and decider. `seed`: of chance, and of who is drawn from a crowd.
      objective, chance, options: see there. Where all people of a description pick at random alike,
        `expected` is told how often.
      fewer: decider -> its own, smaller number of episodes, for those who take long; they are
        compared over these.
      yardstick: the exact optimum is computed, too.
    """

    policies: Mapping[str, Maker]
    people: tuple[str, ...] = ("compliant",)
    episodes: int = 1000
    seed: int = 0
    objective: Objective = SECONDS
    chance: Chance = OFF
    options: Options = field(default_factory=Options)
    fewer: Mapping[str, int] = field(default_factory=dict)
    yardstick: bool = True

    def __post_init__(self) -> None:
        if not self.policies or not self.people:
            raise UsageError("name at least one policy and one kind of people.")
        if min([self.episodes, *self.fewer.values()]) < 2:
            raise UsageError(f"episodes {self.episodes}: an interval needs 2 at least.")


def makers(policies: Iterable[Any]) -> dict[str, Maker]:
    """Name -> what makes the decider for a cell, of names of the table, dotted names, deciders that
    are made already, and makers.

    Raises UsageError, with all faults at once, for what is none of these or stands there twice.
    """
    found, faults, doubled = dict[str, Maker](), list[str](), list[str]()
    for one in policies:
        try:
            name, maker = _maker(one)
        except UsageError as error:
            faults.append(str(error))
            continue
        doubled += [name] if name in found else []
        found[name] = maker
    if doubled:
        faults.append(f"policy {', '.join(sorted(set(doubled)))}: named twice. Name each once.")
    if faults:
        raise UsageError(" ".join(faults))
    return found


def _maker(one: Any) -> tuple[str, Maker]:
    if isinstance(one, str):
        if one not in POLICIES:
            raise UsageError(
                f"There is no policy {one!r}. {Known(POLICIES).hint(one)} `tandem policies` lists"
                " them."
            )
        return one, POLICIES[one]
    name = getattr(one, "name", None) or getattr(one, "__name__", None) or type(one).__name__
    return str(name), theirs(str(name), one)


class NobodyLeftError(TandemError):
    """No decider of a trial can hold the cell. Ends as the first of them would have."""

    def __init__(self, causes: Mapping[str, TandemError]):
        self.exit_code = next(iter(causes.values())).exit_code
        super().__init__(
            "\n".join(f"- {name}: {_reason(name, error)}" for name, error in causes.items())
        )


def judge(
    cell: Cell,
    policies: Iterable[str | Policy | Maker],
    people: str | Iterable[str] = "compliant",
    episodes: int = 1000,
    seed: int = 0,
    *,
    objective: Objective = SECONDS,
    chance: Chance = OFF,
    options: Options | None = None,
    fewer: Mapping[str, int] | None = None,
    tell: Callable[[str], None] = lambda _: None,
    yardstick: bool = True,
) -> list[dict[str, Any]]:
    """One document for each description of people; see `docs/dispatch.md` for what stands in it.

    A decider that cannot hold the cell is left out, and the document says why.

    Args:
      policies: names that `tandem policies` lists, dotted names (`package.module:attribute`),
        deciders of your own for this cell, and makers of such, which take a cell, an `Objective`
        and `Options`. The others are compared with the first one.
      people: one or more descriptions, each judged by itself.
      episodes: per description and decider. `seed`: of chance, and of who is drawn from a crowd;
        the same seed gives every decider the same episodes.
      objective: what is to be small. `chance`: what may happen besides. `options`: of the deciders.
        Where all people of a description pick at random alike, `expected` is told how often.
      fewer: decider -> its own, smaller number of episodes, for those who take long; they are
        compared over these.
      tell: hears whose turn it is.
      yardstick: the exact optimum is computed where it can be. Leave it out where it is known:
        `mean_optimum` gives it alone.

    Raises:
      UsageError: an unknown decider or description, or a decider of your own that fails, with the
        place.
      CellError: the cell is too large to be simulated.
      NobodyLeftError: all deciders were left out.
    """
    trial = Trial(
        makers([policies] if isinstance(policies, str) else policies),
        (people,) if isinstance(people, str) else tuple(people),
        episodes,
        seed,
        objective,
        chance,
        options or Options(),
        fewer or {},
        yardstick,
    )
    names = Names.of(cell)
    crowds = [crowd(spec, names, names.arrays()) for spec in trial.people]
    made: dict[tuple[str, float], Policy] = {}
    return [_document(cell, names, trial, one, made, tell) for one in crowds]


def _document(
    cell: Cell,
    names: Names,
    trial: Trial,
    people: Crowd,
    made: dict[tuple[str, float], Policy],
    tell: Callable[[str], None],
) -> dict[str, Any]:
    arrays = names.arrays(undo=trial.chance.undo if people.makes_mistakes else None)
    draw = Draw.of(names, arrays, trial.chance)
    # people and chances are drawn before anybody decides, so that all deciders meet the same ones
    persons = people.draw(np.random.default_rng(trial.seed), trial.episodes)
    best = best_of(cell, trial.objective, trial.chance, persons) if trial.yardstick else None
    stage = EpisodeBatch.of(names, arrays, draw, persons, trial.seed)
    told = replace(
        trial.options,
        random=float(persons.random[0]) if np.ptp(persons.random) == 0 else trial.options.random,
    )
    costs: dict[str, Any] = {}
    rows, left_out = [], dict[str, TandemError]()
    for name, maker in trial.policies.items():
        tell(f"{people.spec}: {name}")
        count = min(trial.episodes, trial.fewer.get(name, trial.episodes))
        # a decider is built once for all groups of people; only "expected" is told of their
        # randomness
        key = (name, told.random if name == "expected" else 0.0)
        # who cannot decide on this cell is left out with its reason, and the others are still
        # judged
        try:
            if key not in made:
                made[key] = maker(cell, trial.objective, told)
            with settled_memory() as settle:
                found = stage.play(made[key], count, between=settle)
        except OwnPolicyError:
            raise
        except TandemError as error:
            left_out[name] = error
            continue
        # kept by episode, because deciders are compared pair by pair
        costs[name] = trial.objective.time * found.makespan + trial.objective.stress * found.stress
        row = _row(name, found, costs, None if best is None else best[:count])
        rows.append(row | _planned(plan_of(made[key])))
    if not rows:
        raise next(iter(left_out.values())) if len(left_out) == 1 else NobodyLeftError(left_out)
    return {
        "schema_version": 1,
        "cell": cell.name,
        "cell_digest": cell.digest,
        "people": people.spec,
        "episodes": trial.episodes,
        "seed": trial.seed,
        "weights": [plain(trial.objective.time), plain(trial.objective.stress)],
        "spread": trial.chance.spread,
        "optimum": None if best is None else _rounded(best.mean()),
        "compared_with": rows[0]["policy"],
        "policies": rows,
        "left_out": [
            {"policy": name, "reason": _reason(name, error)} for name, error in left_out.items()
        ],
    }


def _reason(name: str, error: TandemError) -> str:
    """Why the decider cannot take part, in one line; it is named elsewhere."""
    said = (
        "; ".join(map(str, error.faults))
        if isinstance(error, CellError)
        else " ".join(str(error).split("\n"))
    )
    return said.removeprefix(f"{name}: ")


def _planned(chosen: Chosen | None) -> dict[str, Any]:
    """What is said of the plan that a decider carries out or follows, as in a plan's own document;
    nothing of who has none.
    """
    if chosen is None:
        return {}
    basis = chosen.basis
    return {
        "plan": {
            "digest": chosen.schedule.digest,
            "makespan": plain(basis.makespan),
            "stress": plain(basis.stress),
            "status": "optimal" if basis.proven else "feasible",
            "bound": {"makespan": plain(basis.least_makespan), "stress": plain(basis.least_stress)},
        }
    }


def mean_optimum(
    cell: Cell,
    people: str,
    episodes: int,
    seed: int,
    *,
    objective: Objective = SECONDS,
    work: float = PLANNING_WORK,
) -> float | None:
    """The exact optimum that `judge` holds deciders against, mean over its episodes; None where it
    cannot be computed.

    Args:
      work: the limit for proving what is too large for dynamic programming, CP-SAT's deterministic
        seconds; None for the judge's own limit, which asks a clock.
    """
    names = Names.of(cell)
    persons = crowd(people, names, names.arrays()).draw(np.random.default_rng(seed), episodes)
    best = best_of(cell, objective, OFF, persons, work)
    return None if best is None else float(best.mean())


def best_of(
    cell: Cell,
    objective: Objective,
    chance: Chance,
    persons: Person,
    work: float = PLANNING_WORK,
) -> Any:
    """`[E]`, per episode the exact optimum beside its person; None where it cannot be computed.
    `work`: as `optimum` takes it.
    """
    if chance.spread != "off" or chance.failure_s is not None or chance.absence_s is not None:
        return None
    rows = np.concatenate(
        [np.asarray(part, np.float64).reshape(len(persons.pace), -1) for part in persons], axis=1
    )
    distinct, which = np.unique(rows, axis=0, return_inverse=True)
    if len(distinct) > MOST_PERSONS:
        return None
    found = []
    for number in range(len(distinct)):
        first = int(np.flatnonzero(which == number)[0])
        found.append(optimum(cell, objective, Person(*(part[first] for part in persons)), work))
    return None if any(one is None for one in found) else np.array(found, float)[which]


def _row(name: str, found: Outcome, costs: Mapping[str, Any], best: Any) -> dict[str, Any]:
    """What is said of one decider. `costs`: of all so far; it is compared with the first."""
    cost, compared_with = costs[name], next(iter(costs))
    row: dict[str, Any] = {
        "policy": name,
        "episodes": len(cost),
        "done": _rounded(found.done.mean()),
        "makespan": _measure(found.makespan),
        "stress": _measure(found.stress),
        "changes": _rounded(found.changes.mean()),
        "latency_ms": {
            "p50": _quantile(found.latency_ms, 0.5),
            "p99": _quantile(found.latency_ms, 0.99),
            "decisions": len(found.latency_ms),
        },
        "regret": None,
        "regret_ci95": None,
        "regret_share": None,
        "proximity": None,
    }
    # regret against the exact optimum of the same person, where there is one
    if best is not None:
        mean = best.mean()
        low, high = _interval(cost - best)
        row |= {
            "regret": _rounded((cost - best).mean()),
            "regret_ci95": [_rounded(low), _rounded(high)],
            "regret_share": _rounded((cost - best).mean() / mean, 5),
            "proximity": _rounded(mean / cost.mean(), 5),
        }
    # paired by episode: both had the same people and chances, so little noise is left
    if name != compared_with:
        count = min(len(cost), len(costs[compared_with]))
        difference = cost[:count] - costs[compared_with][:count]
        row["difference"] = {
            "mean": _rounded(difference.mean()),
            "ci95": [_rounded(edge) for edge in _interval(difference)],
        }
    return row


def _measure(values: Any) -> dict[str, Any]:
    quantiles = {
        f"p{round(100 * share)}": _quantile(values, share)
        for share in (0.05, 0.25, 0.5, 0.75, 0.95)
    }
    return {
        "mean": _rounded(values.mean()),
        "ci95": [_rounded(edge) for edge in _interval(values)],
        **quantiles,
    }


def _interval(values: Any) -> tuple[float, float]:
    """95 % interval of the mean, by the normal approximation."""
    half = Z * float(np.std(values, ddof=1)) / len(values) ** 0.5
    return float(values.mean()) - half, float(values.mean()) + half


def _quantile(values: Any, share: float) -> float | None:
    return _rounded(float(np.quantile(values, share))) if len(values) else None


def _rounded(value: float, digits: int = 4) -> float:
    return plain(round(float(value), digits))


def split_people(text: Sequence[str]) -> tuple[str, ...]:
    """Descriptions of people from the command line: several options, or one with commas. A comma
    within a description stays in it.

    `("compliant,prefers:3,1",)` -> `("compliant", "prefers:3,1")`.
    """
    from tandem.world.behaviour import KINDS, kind_of

    found: list[str] = []
    for one in text:
        for index, part in enumerate(one.split(",")):
            kind = part.strip().partition("+")[0]
            if index == 0 or kind_of(kind)[0] in (*KINDS, "population") or is_dotted(kind):
                found.append(part)
            else:
                found[-1] += f",{part}"
    return tuple(part.strip() for part in found)
