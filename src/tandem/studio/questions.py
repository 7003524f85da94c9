"""What the page asks about plans that are there already: how each operator fares, what is critical,
what differs from another plan or cell, which point is recommended. Answered at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from tandem.cell.language import Words, spoken
from tandem.errors import UnsoundScheduleError, UsageError
from tandem.studio.asked import Json, cell_in

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.schedule.changes import Changes
    from tandem.schedule.model import Schedule

Tell = Callable[[Json], None]
"""Takes what is known while a job goes on."""


def measures(request: Json, tell: Tell) -> Json:
    """What a schedule is worth: the lanes of its Gantt chart and, where it keeps its cell, the
    balance of its operators and why each task starts when it does. With `before`, what differs from
    that schedule.
    """
    from tandem.schedule.changes import changes
    from tandem.schedule.checker import faults

    cell, language = cell_in(request["cell"]), request.get("lang", "en")
    schedule = schedule_of(request["assignments"])
    sound = not faults(cell, schedule)
    told: Json = {
        "sound": sound,
        "lanes": _lanes(cell, schedule),
        "operators": _balance(cell, schedule) if sound else None,
        "tasks": _waiting(cell, schedule, language) if sound else None,
        "path": _path(cell, schedule) if sound else None,
        "changed": None,
    }
    if "before" in request:
        old = schedule_of(request["before"])
        found = changes(old, schedule, tolerance=0.0)
        t = spoken(language, "tandem.studio")
        told["changed"] = {
            "tasks": [one.to_dict() for one in found.changed],
            "sentence": moved(found, cell, old, schedule, t),
        }
    return told


def _lanes(cell: Cell, schedule: Schedule) -> list[Json] | None:
    """Per operator, what every Gantt chart of the package shows besides bars: see `draw.lanes`.
    None for a schedule of another set of tasks or operators.
    """
    from tandem.cell.model import plain
    from tandem.draw.lanes import lanes

    who = {name for a in schedule for name in a.operators}
    if {a.task for a in schedule} != set(cell.tasks) or not who <= set(cell.operators):
        return None
    # breaks are not cut at the makespan: a bar may be dragged beyond it
    return [
        {
            "operator": lane.look.operator,
            "busy": plain(lane.busy),
            "share": lane.utilisation,
            "shaded": [
                {"kind": off.kind, "what": off.what, "start": off.start, "end": off.end}
                for off in lane.shaded
            ],
            "waits": [
                {"task": bar.task, "start": since, "end": bar.start}
                for bar in lane.bars
                for since in bar.since
            ],
        }
        for lane in lanes(cell, schedule, until=math.inf, critical=False)
    ]


def _balance(cell: Cell, schedule: Schedule) -> list[Json]:
    """Per operator, how the time to the makespan is spent, and the stress collected."""
    from tandem.cell.model import plain
    from tandem.schedule import measures as of

    spent = {
        "working": of.working(cell, schedule),
        "changing": of.changing(cell, schedule),
        "resting": of.resting(cell, schedule),
        "idle": of.idle(cell, schedule),
        "share": of.utilisation(cell, schedule),
    }
    loads = of.stress_by_human(cell, schedule)
    return [
        {
            "operator": name,
            "tasks": len(schedule.of(name)),
            **{key: plain(each[name]) for key, each in spent.items()},
            "stress": plain(loads.get(name)),
            "stress_limit": plain(operator.stress_limit),
        }
        for name, operator in cell.operators.items()
    ]


def _waiting(cell: Cell, schedule: Schedule, language: str) -> list[Json]:
    """Per task, why it starts when it does and by how much it may slip."""
    from tandem.explain.waiting import waiting

    return [
        {"task": task, **held.to_dict(), "sentence": held.sentence(language)}
        for task, held in waiting(cell, schedule).items()
    ]


def _path(cell: Cell, schedule: Schedule) -> list[str]:
    """The tasks of the critical path, from its beginning."""
    from tandem.schedule.critical import critical_path

    return [link.assignment.task for link in critical_path(cell, schedule)]


def moved(changes: Changes, cell: Cell, old: Schedule, new: Schedule, t: Words) -> str:
    """How many tasks moved, how many of them to other operators, and what that costs."""
    from tandem.schedule.measures import exact, makespan, stress

    others = changes.count("operator")
    parts = [
        t.count("moved", len(changes.changed)) if changes.changed else t("moved.none"),
        *(
            [t.count("operator", others) if others else t("operator.none")]
            if changes.changed
            else []
        ),
    ]
    seconds = exact(makespan(new)) - exact(makespan(old))
    parts.append(t("time", seconds=t.signed(float(seconds))) if seconds else t("time.same"))
    try:
        more = exact(stress(cell, new)) - exact(stress(cell, old))
    except (UnsoundScheduleError, KeyError):
        return ", ".join(parts)  # the old plan is none of this cell
    return ", ".join([*parts, *([t("stress", stress=t.signed(float(more)))] if more else [])])


def compare(request: Json, tell: Tell) -> Json:
    """What differs between two cells, and what becomes of each point of the first one's front."""
    from tandem.explain.compare import compare_cells
    from tandem.explain.fronts import changes_of

    language = request.get("lang", "en")
    found = compare_cells(cell_in(request["cell"]), cell_in(request["other"]))
    base, others = (
        [(time, load) for time, load in request.get(key, ())] for key in ("points", "other_points")
    )
    return {
        "changes": [change.to_dict(language) for change in found],
        "front_changes": [one.to_dict() for one in changes_of(base, others)] if others else [],
    }


def recommend(request: Json, tell: Tell) -> Json:
    """Which of the points that keep the limits is recommended: by a share of attention for stress,
    else the knee.
    """
    from tandem.cell.model import plain
    from tandem.plan.choice import best_of, weights_of, within

    points = [(time, load) for time, load in request["points"]]
    if not points:
        raise UsageError("points is empty: give the (makespan, stress) of at least one.")
    if any(second[0] < first[0] for first, second in pairwise(points)):
        raise UsageError("points must be sorted by makespan, as a front is.")
    limits = (request.get("max_makespan"), request.get("max_stress"))
    share = request.get("share")
    weights = None if share is None else weights_of(points, share)
    best = best_of(points, weights, *limits)
    return {
        "point": None if best is None else best + 1,
        "weights": None if weights is None else [plain(weight) for weight in weights],
        "within": [place + 1 for place in within(points, *limits)],
    }


def graph(request: Json, tell: Tell) -> Json:
    """Where the precedence graph's tasks stand and how its arrows run, in columns and rows, as in
    every other picture of it. Circles are opened: the cell may be one that is being mended.
    """
    from tandem.draw.graph import HALF_HEIGHT, HALF_WIDTH, arrow_curve
    from tandem.draw.layers import arranged, without_circles, without_implied

    at, arrows = arranged(without_implied(without_circles(dict(request["after"]))))
    return {
        "node": [2 * HALF_WIDTH, 2 * HALF_HEIGHT],
        "at": [{"task": task, "at": list(place)} for task, place in at.items()],
        "arrows": [
            {"task": task, "after": first, "curve": [list(point) for point in arrow_curve(points)]}
            for (first, task), points in arrows.items()
        ],
    }


def schedule_of(rows: list[Mapping[str, Any]]) -> Schedule:
    """The schedule of `assignments`. Raises CellError with each row that is none."""
    from tandem.report.results import schedules_of

    return schedules_of({"front": [{"assignments": rows}]})[0]
