"""What the best response to a known person comes to: the exact optimum that deciders are held
against, where it can be computed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.deciders.by_value import MOST_TASKS
from tandem.dispatch.lookahead.dynamic_programming import SLIGHTLY, Human, values
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.residual import rest, solve
from tandem.dispatch.lookahead.transitions import Moves
from tandem.errors import CellError, InfeasibleError, NothingFoundError
from tandem.plan.methods import plan
from tandem.world.people import Person

PLANNING_WORK = 6.0
"""For proving the optimum of a cell that is too large for dynamic programming, beside somebody who
does all that is asked: CP-SAT's deterministic seconds, so that it repeats exactly.
"""


def optimum(
    cell: Cell, objective: Objective, person: Person, work: float = PLANNING_WORK
) -> float | None:
    """The least expected cost beside this person, of a decider who knows all about it; times
    certain. None where it cannot be computed.

    People whose times or habits change during the shift, or who make mistakes or refuse for good,
    have none. Beside whoever complies it is the cell's proven optimum at their pace, whatever the
    size, where so much `work` proves it (CP-SAT's deterministic seconds); beside others the cell
    must be small.
    """
    human = as_modelled(person)
    if human is None:
        return None
    pace = dict.fromkeys(cell.humans, float(person.pace))
    if len(cell.tasks) > MOST_TASKS:
        return _planned(cell, objective, pace, work) if complies(human) else None
    try:
        found = values(cell, human, objective, pace=pace)
        return found.value(found.moves.root())
    except (CellError, NothingFoundError):
        return _planned(cell, objective, pace, work) if complies(human) else None


def as_modelled(person: Person) -> Human | None:
    """The person as the exact methods model it; None when they cannot."""
    changes = (
        person.learning,
        person.forgets,
        person.refuses,
        person.slows * (person.fatigue + np.max(person.tires, initial=0.0)),
    )
    if any(float(one) > 0 for one in changes):
        return None
    taste: Any = np.asarray(person.taste, float)
    return Human(
        random=float(person.random),
        taste=tuple(taste.tolist()) if np.ptp(taste) else (),
        follows=float(person.follows),
        obeys=bool(person.obeys > 0),
        postpones=float(person.postpones),
    )


def complies(human: Human) -> bool:
    """Does all that is asked."""
    free = not human.random and not human.postpones and not human.spoils and human.obeys
    return free and human.follows + SLIGHTLY > (
        max(human.taste) - min(human.taste) if human.taste else 0.0
    )


def _planned(cell: Cell, objective: Objective, pace: dict[str, float], work: float) -> float | None:
    """The proven optimum of the plan at this pace, deadlines aside; None when it was not proven in
    time.
    """
    if all(factor == 1 for factor in pace.values()):
        return _as_stated(cell, objective, work)
    moves = Moves.of(cell, pace, max_stress=objective.max_stress)
    left = rest(moves, moves.root())
    assert left is not None  # a cell has a task
    found = solve(
        left,
        (objective.time / moves.instance.per_second, objective.stress / moves.instance.per_stress),
        work_s=work,
    )
    if found is None or not found.proven:
        return None
    return objective.cost(
        found.ticks / moves.instance.per_second, moves.instance.stress(found.units)
    )


def _as_stated(cell: Cell, objective: Objective, work: float) -> float | None:
    """The same at the stated times, for which the planner itself can be asked. Deadlines rule out
    nothing on the floor.
    """
    free = cell.replace(
        tasks={
            name: task.model_copy(
                update={
                    "deadline": None,
                    "wait": tuple(w.model_copy(update={"at_most": None}) for w in task.wait),
                }
            )
            for name, task in cell.tasks.items()
        }
    )
    try:
        best = plan(
            free,
            objective.question(),
            work=work,
            workers=1,
            confirm=False,
        )[0]
    except (InfeasibleError, NothingFoundError):
        return None
    return objective.cost(best.makespan, best.stress) if objective.is_proven(best) else None
