"""What one job comes to: a result that is the same wherever it is worked out, and beside it the
seconds that it took.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter, process_time
from typing import Any, Literal

from tandem.bench.jobs import BEST_RULE, OPTIMUM, RANDOM, Job
from tandem.bench.trained import digest_of_file
from tandem.cell.model import Cell, plain
from tandem.dispatch.lookahead.objective import Objective
from tandem.errors import InfeasibleError, NothingFoundError, TandemError, UsageError
from tandem.learn.forms import Form
from tandem.plan.methods import METHODS, plan
from tandem.plan.rules import RULES

SCHEMA_VERSION = 1
FIXED = "fixed"
"""The policy that carries out a plan made before the shift."""


class Record(Form):
    """A job's result, as its file holds it.

    Attributes:
      job: all that it depends on.
      outcome: "done"; "none", nothing was found; "infeasible", which is proven; "refused", whoever
        was asked cannot hold the cell.
      cost, makespan, stress: of what was found; of dispatch, means over the episodes. None where
        there is nothing.
      bound: of the optimum: no cost is less, beside people on average; None where nothing is
        proven.
      proven: no cost is less than this one.
      chosen: of the best rule, which one it is.
      reason: why there is no cost.
    """

    schema_version: Literal[1] = 1
    job: dict[str, Any]
    outcome: Literal["done", "none", "infeasible", "refused"]
    cost: float | None = None
    makespan: float | None = None
    stress: float | None = None
    bound: float | None = None
    proven: bool = False
    chosen: str | None = None
    reason: str | None = None


class Took(Form):
    """What it cost on the machine that did it, which is no part of the result.

    Attributes:
      wall_s, cpu_s: of the whole job.
      p50_ms, p99_ms: of a policy's decisions.
    """

    wall_s: float
    cpu_s: float
    p50_ms: float | None = None
    p99_ms: float | None = None


@dataclass(frozen=True)
class Answer:
    """A job that was done."""

    job: Job
    record: Record
    took: Took


@dataclass(frozen=True)
class Failure:
    """A job that ended in a fault of somebody's code; it is not kept, so that it is done again."""

    job: Job
    message: str


def answered(job: Job, cell: Cell) -> Answer | Failure:
    """Does the job. It asks no clock where its limit is one of work, and runs in one thread."""
    began, cpu = perf_counter(), process_time()
    try:
        found = WORK[job.kind](job, cell)
    except UsageError as error:
        return Failure(job, str(error))
    except InfeasibleError as error:
        found = {"outcome": "infeasible", "reason": _line(error)}
    except NothingFoundError as error:
        found = {"outcome": "none", "reason": _line(error)}
    except TandemError as error:
        found = {"outcome": "refused", "reason": _line(error)}
    latency = found.pop("latency_ms", {})
    took = Took(
        wall_s=round(perf_counter() - began, 4),
        cpu_s=round(process_time() - cpu, 4),
        p50_ms=latency.get("p50"),
        p99_ms=latency.get("p99"),
    )
    return Answer(job, Record(job=job.to_dict(), **{"outcome": "done", **found}), took)


def _line(error: TandemError) -> str:
    return " ".join(str(error).split())


def _cost(objective: Objective, makespan: float, stress: float) -> dict[str, Any]:
    return {
        "makespan": _rounded(makespan),
        "stress": _rounded(stress),
        "cost": _rounded(objective.cost(makespan, stress)),
    }


def _rounded(value: float) -> float:
    """What adding in another order may change is left out."""
    return float(plain(round(value, 6)))


# ------------------------------------------------------------------ planning


def _planned(job: Job, cell: Cell) -> dict[str, Any]:
    objective = Objective(*job.weights)
    if job.who == BEST_RULE:
        from tandem.learn.baseline import best_rule

        rule = best_rule(cell, objective.cost, seed=job.seed or 0, question=objective.question())
        if rule is None:
            return {"outcome": "none", "reason": "no rule found a schedule"}
        reached = rule.result
        return {**_cost(objective, reached.makespan, reached.stress), "chosen": rule.name}
    front = plan(
        cell,
        objective.question(),
        method="exact" if job.who == OPTIMUM else job.who,
        seed=job.seed or 0,
        workers=1,
        settle=False,
        confirm=False,
        **_limits(job),
    )
    if front.interrupted:
        raise KeyboardInterrupt
    if not len(front):
        return {"outcome": "none", "reason": "an empty front"}
    best = min(front, key=lambda result: objective.cost(result.makespan, result.stress))
    found = _cost(objective, best.makespan, best.stress)
    proven = objective.is_proven(best)
    least = objective.cost(best.bound.makespan, best.bound.stress)
    bound = found["cost"] if proven else min(_rounded(least), found["cost"])
    return {**found, "proven": proven, "bound": bound}


def _limits(job: Job) -> Mapping[str, Any]:
    """Work, or seconds. Whoever knows no limit of work goes on until the end."""
    if job.who == RANDOM:
        return {"time_limit": None}
    if job.who != OPTIMUM and job.setting("time_limit") is not None:
        return {"time_limit": job.setting("time_limit")}
    method = METHODS["exact" if job.who == OPTIMUM else job.who].solve
    wants = inspect.signature(getattr(method, "solve", method)).parameters.values()
    if any(one.name == "work" or one.kind == one.VAR_KEYWORD for one in wants):
        return {"work": job.setting("work")}
    return {"time_limit": None}


# ------------------------------------------------------------------ dispatch


def _dispatched(job: Job, cell: Cell) -> dict[str, Any]:
    from tandem.dispatch.evaluation.best_response import PLANNING_WORK
    from tandem.dispatch.evaluation.trial import mean_optimum

    assert job.people is not None
    objective, episodes = Objective(*job.weights), int(job.setting("episodes") or 0)
    if job.who == OPTIMUM:
        least = mean_optimum(
            cell,
            job.people[0],
            episodes,
            job.seed or 0,
            objective=objective,
            work=job.setting("work") or PLANNING_WORK,
        )
        if least is None:
            reason = "it cannot be computed beside these people"
            return {"outcome": "none", "reason": reason}
        return {"cost": _rounded(least), "bound": _rounded(least), "proven": True}
    named = [name for name in RULES if name != RANDOM] if job.who == BEST_RULE else [job.who]
    rows = _judged(job, cell, objective, named)
    costs = {
        row["policy"]: objective.cost(row["makespan"]["mean"], row["stress"]["mean"])
        for row in rows
    }
    best = min(rows, key=lambda row: costs[row["policy"]])
    unfinished = [row["policy"] for row in rows if row["done"] < 1]
    if best["policy"] in unfinished:
        return {
            "outcome": "none",
            "reason": f"{1 - best['done']:.1%} of the episodes came to no end",
        }
    found = _cost(objective, best["makespan"]["mean"], best["stress"]["mean"])
    if job.who == BEST_RULE:
        return {**found, "chosen": best["policy"]}
    return {**found, "latency_ms": best["latency_ms"]}


def _judged(job: Job, cell: Cell, objective: Objective, named: list[str]) -> list[dict[str, Any]]:
    """The judge's rows. `fixed` carries out a plan that is made by work: by its own clock it would
    have another one on a busy machine.
    """
    from tandem.dispatch.deciders.policy import Basis, Chosen, Options
    from tandem.dispatch.evaluation.trial import judge

    assert job.people is not None
    chosen, learned = None, None
    if job.learned is not None:
        learned, digest = job.learned
        if digest_of_file(learned) != digest:
            raise UsageError(f"{learned}: was changed since the sweep began. Begin it again.")
    if job.who == FIXED:
        question, work = objective.question(), job.setting("work")
        seed = job.seed or 0
        (best,) = plan(cell, question, seed=seed, workers=1, confirm=False, work=work)
        chosen = Chosen(best.schedule, Basis.of(best, proven=objective.is_proven(best)))
    (document,) = judge(
        cell,
        named,
        job.people[0],
        int(job.setting("episodes") or 0),
        job.seed or 0,
        objective=objective,
        options=Options(
            budget_ms=job.setting("budget") or 0.0,
            seed=job.seed or 0,
            plan=chosen,
            learned=learned,
        ),
        yardstick=False,
    )
    rows: list[dict[str, Any]] = document["policies"]
    return rows


WORK: Mapping[str, Callable[[Job, Cell], dict[str, Any]]] = {
    "plan": _planned,
    "dispatch": _dispatched,
}
"""Kind of a job -> what does it."""
