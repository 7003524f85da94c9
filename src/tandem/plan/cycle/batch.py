"""So many products from an empty station to an empty one: the start-up and the run-out are counted,
and each product may be assembled in its own way.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.errors import CellError, Fault, InfeasibleError, NothingFoundError, UsageError
from tandem.plan.cycle import exact
from tandem.plan.cycle.question import CycleQuestion
from tandem.plan.cycle.result import CycleResult
from tandem.plan.method import Progress
from tandem.plan.methods import MOST_TASKS, plan
from tandem.plan.result import Front, Status
from tandem.schedule.cycle import copied, start_up
from tandem.schedule.cycle_checker import not_periodic

STEADY = 0.2
"""The share of the time limit that the steady state may take, whose pattern is a plan to begin
with.
"""


def plan_batch(
    cell: Cell,
    products: int,
    *,
    time_limit: float | None = 60.0,
    work: float | None = None,
    seed: int = 0,
    workers: int | None = None,
    on_solution: Callable[[Progress], None] | None = None,
) -> Front:
    """The least time for so many products, with its bound: one schedule of the cell that makes them
    all (`copied`), proven where time allows.

    The pattern of the least cycle time, launched so often, is the plan to begin with.

    Raises:
      UsageError: fewer than one product.
      CellError: the cell has something at a fixed time, a table of stress by sets of tasks, or too
        many tasks in so many products.
      InfeasibleError, NothingFoundError: as `tandem.plan`.
    """
    if products < 1:
        raise UsageError(f"a batch of {products} products: must be 1 or more.")
    wrong = [Fault(sentence, place) for place, sentence in not_periodic(cell)]
    if cell.stress_of_set is not None:
        said = "says what sets of one product's tasks stress, and nothing about a batch. Leave it"
        wrong.append(Fault(f"{said} out.", ("stress_of_set",)))
    if len(cell.tasks) * products > MOST_TASKS:
        said = (
            f"{products:,} products of {len(cell.tasks):,} tasks are {len(cell.tasks) * products:,}"
            f" tasks, and at most {MOST_TASKS:,} can be planned. Ask for the cycle time instead."
        )
        wrong.append(Fault(said, ("tasks",)))
    if wrong:
        raise CellError(wrong)
    steady = _steady(cell, None if time_limit is None else STEADY * time_limit, work, seed, workers)
    return plan(
        copied(cell, products),
        minimize="makespan",
        time_limit=time_limit,
        work=work,
        seed=seed,
        workers=workers,
        hint=None if steady is None else steady.periodic.products(products, start_up(cell)),
        on_solution=on_solution,
    )


def _steady(
    cell: Cell, time_limit: float | None, work: float | None, seed: int, workers: int | None
) -> CycleResult | None:
    """The pattern of the least cycle time; None where none was found soon."""
    try:
        return exact.solve(
            cell,
            CycleQuestion("cycle_time"),
            time_limit=None if work is not None else time_limit,
            work=None if work is None else STEADY * work,
            seed=seed,
            workers=workers,
        )[0]
    except (InfeasibleError, NothingFoundError):
        return None


def told(front: Front, products: int) -> dict[str, Any]:
    """The batch as a result document tells it."""
    (result,) = front
    # the least stress at this time is the plan's business, and may be open
    proven = result.bound.makespan >= result.makespan
    return {
        "products": products,
        "makespan": plain(result.makespan),
        "bound": plain(result.bound.makespan),
        "status": str(Status.OPTIMAL if proven else Status.FEASIBLE),
        "per_product": plain(round(result.makespan / products, 4)),
    }
