"""What a decision makes begin, as people say it."""

from __future__ import annotations

from collections.abc import Sequence

from tandem.dispatch.deciders.policy import Start
from tandem.dispatch.situation.model import Situation

NOTHING = "nothing begins now"


def phrase(situation: Situation, starts: Sequence[Start]) -> str:
    """What begins now: "robot does 4, human is asked for 3"; "nothing begins now".

    What is mounted wrongly is taken apart: "robot takes 4 apart". Where a human takes part, all are
    asked.
    """
    return ", ".join(_of_one(situation, task, operators) for task, operators in starts) or NOTHING


def _of_one(situation: Situation, task: str, operators: Sequence[str]) -> str:
    several, comes_off = len(operators) > 1, task in situation.wrong
    who = " and ".join(operators)
    if any(situation.cell.operators[one].kind == "human" for one in operators):
        return (
            f"{who} {'are' if several else 'is'} asked"
            f" {f'to take {task} apart' if comes_off else f'for {task}'}"
        )
    if comes_off:
        return f"{who} {'take' if several else 'takes'} {task} apart"
    return f"{who} {'do' if several else 'does'} {task}"
