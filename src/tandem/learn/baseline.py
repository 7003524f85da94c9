"""What learns nothing: the best dispatch rule for a cell, which all learners are held against."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from tandem.cell.model import Cell
from tandem.errors import NothingFoundError
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.plan.result import Result
from tandem.plan.rules import RULES

DRAWN = ("random",)
"""A single schedule that is drawn is no rule; the best of many (`best-of-n`) is one."""


@dataclass(frozen=True)
class BestRule:
    """The rule, and the schedule of it that costs least."""

    name: str
    result: Result


def best_rule(
    cell: Cell,
    cost: Callable[[float, float], float],
    *,
    seed: int = 0,
    among: Iterable[str] = RULES,
    question: Question | None = None,
) -> BestRule | None:
    """The dispatch rule whose schedule costs least, `best-of-n` among them, which draws a hundred:
    it takes 0.03 to 0.8 s a cell and learns nothing.

    Of equal costs the quicker schedule is taken, then the one of less stress, then a rule that
    draws nothing. None when no rule found a schedule.

    Args:
      cost: of a makespan (s) and a stress.
      among: names of rules; all of them when absent.
      question: what every rule is asked; all compromises when not given.
    """
    found = []
    for name in among:
        if name in DRAWN:
            continue
        try:
            front = plan(cell, question, method=name, seed=seed)
        except NothingFoundError:
            continue
        for result in front:
            at = (cost(result.makespan, result.stress), result.makespan, result.stress)
            found.append((*at, name == "best-of-n", name, result))
    if not found:
        return None
    *_, name, result = min(found, key=lambda one: one[:-1])
    return BestRule(name, result)
