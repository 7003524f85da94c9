"""Deciders that do not stand in Tandem: made, asked and heard so that a mistake in them is told
with its place, and nobody takes it for a bug of ours.
"""

from __future__ import annotations

import traceback
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Chosen, Decision, Options, Policy, plan_of
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.transitions import beginning
from tandem.errors import TandemError, UsageError

FORM = (
    "A policy has `name` and `decide(situation) -> Decision`; a maker of one takes a cell, an"
    " Objective and Options."
)


class OwnPolicyError(UsageError):
    """A decider of somebody else failed, or said what is not allowed."""


@dataclass(frozen=True)
class Own:
    """A decider of somebody else. Whatever it raises, and whatever it says that is no decision or
    is not allowed, is an `OwnPolicyError` that says where and when.
    """

    policy: Policy
    name: str

    @property
    def chosen(self) -> Chosen | None:
        """The plan that it carries out or follows, if any is."""
        return plan_of(self.policy)

    def decide(self, situation: Situation) -> Decision:
        """What it says."""
        began = perf_counter()
        try:
            said: Any = self.policy.decide(situation)
        except TandemError:
            raise
        except Exception as error:
            raise OwnPolicyError(
                f"{self.name}, asked at {situation.now:g} s: {_told(error)}."
            ) from error
        if not isinstance(said, Decision):
            raise OwnPolicyError(
                f"{self.name}, asked at {situation.now:g} s: answered {said!r}, which is no"
                f" Decision. {FORM}"
            )
        if fault := fault_of(situation, said):
            raise OwnPolicyError(
                f"at {situation.now:g} s: {fault} What may begin is"
                " tandem.dispatch.situation.legal.legal(situation)."
            )
        return replace(said, latency_ms=1000 * (perf_counter() - began))


def made_by(source: Any, home: str, cell: Cell, objective: Objective, options: Options) -> Policy:
    """The decider that a maker makes for the cell, or that the source is itself.

    Raises UsageError when the maker fails, or makes something else.
    """
    is_maker = not callable(getattr(source, "decide", None)) or isinstance(source, type)
    try:
        policy = source(cell, objective, options) if is_maker else source
    except TandemError:
        raise
    except Exception as error:
        raise UsageError(f"{home}: {_told(error)}. {FORM}") from error
    if not callable(getattr(policy, "decide", None)):
        raise UsageError(f"{home}: made {policy!r}, and no policy. {FORM}")
    return Own(policy, str(getattr(policy, "name", home or type(policy).__name__)))


def _told(error: Exception) -> str:
    """What was raised, and the line that did."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    place = "" if last.filename == __file__ else f" ({last.filename}:{last.lineno})"
    return f"{type(error).__name__}: {' '.join(str(error).split())}{place}"


def fault_of(situation: Situation, decision: Decision) -> str:
    """What is not allowed about the decision, in a sentence; empty when all of it is."""
    begins = list(dict.fromkeys((*decision.asks, *decision.starts)))
    possible = beginning(situation, begins)
    for task, operators in begins:
        if (task, operators) not in possible:
            return (
                f"{decision.by} wants {' and '.join(operators)} to begin task {task!r}, which is"
                " not allowed now."
            )
    for human, task in decision.announced.items():
        if human not in situation.cell.humans or task not in situation.cell.tasks:
            return f"{decision.by} announces task {task!r} to {human!r}, which makes no sense."
        other = next(
            (name for name, operators in begins if human in operators and name != task), None
        )
        if other is not None:
            return f"{decision.by} asks {human!r} for task {other!r} and announces task {task!r}."
    return ""
