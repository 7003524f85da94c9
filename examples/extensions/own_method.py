"""A method of planning of your own: the cell's order, each task by whoever ends it first.

    tandem plan examples/thesis.yaml --method own_method:plan
    python examples/extensions/own_method.py

In the folder of this file, or with it on PYTHONPATH. Nothing of Tandem is changed.
"""

from __future__ import annotations

from time import perf_counter

import tandem
from tandem.plan.bounds import least_makespan, least_stress
from tandem.plan.door import Door
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.question import Question
from tandem.plan.result import Bound, Front
from tandem.plan.rules import Keeper


def plan(
    cell: tandem.Cell, question: Question = Question(), *, seed: int = 0, **_: object
) -> Front:
    """The cell's order, each task by whoever ends it first: an example of a method of one's own."""
    began, instance = perf_counter(), Instance.of(cell)
    layout = Layout.of(instance)
    free = dict.fromkeys(range(len(instance.operators)), 0)
    ends: dict[int, int] = {}
    starts = [(0, 0)] * len(instance.tasks)  # per task, the index of its way and its first tick
    names = [*cell.tasks]
    for task in instance.order:
        ready = max((ends[names.index(one)] for one in cell.tasks[names[task]].after), default=0)
        found = []
        for number, way in enumerate(instance.ways[task]):
            start = max([ready, *(free[who] for who in way.operators)])
            found.append((start + way.ticks, start, number))
        end, start, number = min(found)
        starts[task], ends[task] = (number, start), end
        free |= dict.fromkeys(instance.ways[task][number].operators, end)
    bound = Bound(
        instance.seconds(least_makespan(layout)), instance.stress(least_stress(layout) or 0)
    )
    keeper = Keeper(Door(cell, instance, question), bound)
    if not keeper.offer(starts):  # the checker stands behind this door
        raise tandem.NothingFoundError(f"own_method: its schedule does not keep {keeper.limits()}.")
    wall_s = perf_counter() - began
    return Front(cell, keeper.results(), False, "own", "own", seed, wall_s, False, question)


if __name__ == "__main__":
    for result in tandem.plan(tandem.load("examples/thesis.yaml"), method="own_method:plan"):
        print(f"{result.makespan:g} s, stress {result.stress:g}")
