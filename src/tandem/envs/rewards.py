"""What the faces of the event world pay: numbers, or a function of what passed between two
decisions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from tandem.cell.names import Known
from tandem.errors import UsageError
from tandem.extensions import Table


@dataclass(frozen=True)
class Happening:
    """What passed between two decisions.

    Attributes:
      seconds: that passed. `stress`: that was taken on.
      started, finished: operator -> the task that it began, or ended.
      idle: seconds that operators had no work, all together.
      done: the assembly is complete with it.
      illegal: an illegal action was named.
    """

    seconds: float
    stress: float
    started: Mapping[str, str]
    finished: Mapping[str, str]
    idle: float = field(default=0.0, compare=False)
    done: bool = False
    illegal: bool = False


Reward = Callable[[Happening], float]

NUMBERS = ("second", "stress", "idle", "task", "done", "illegal")
"""What numbers may pay for: a second that passes, a unit of stress, a second that somebody has no
work, a task that ends, the end of the assembly, an illegal action.
"""


def theirs(home: str, found: Any) -> Reward:
    """A reward that others add. Raises UsageError for what is no function of a `Happening`."""
    if not callable(found):
        raise UsageError(
            f"{home}: is {found!r}, and no reward. A reward is a function of a"
            " tandem.envs.rewards.Happening that gives a number."
        )
    made: Reward = found
    return made


REWARDS: Table[Reward] = Table("rewards", {}, theirs)
"""Rewards by name, all by others: entry points of the group `tandem.rewards`, and dotted names."""


def reward_of(given: Any, stress_factor: float) -> Reward:
    """What is paid: by a function, a table of `NUMBERS`, a name of `REWARDS`, or, for None, minus
    the seconds that passed less `stress_factor` for each unit of stress.

    Raises UsageError, with all faults at once.
    """
    if given is None:
        return lambda happening: -happening.seconds - stress_factor * happening.stress
    if stress_factor:
        raise UsageError(
            f"reward={given!r}, stress_factor={stress_factor!r}: the factor is part of the default"
            " reward. Leave one of them out."
        )
    if isinstance(given, str):
        if given not in REWARDS:
            raise UsageError(
                f"reward={given!r}: there is none of that name. {Known(REWARDS).hint(given)} One of"
                " your own is package.module:function."
            )
        return _checked(REWARDS[given], given)
    if isinstance(given, Mapping):
        return _of_numbers(given)
    if callable(given):
        return _checked(given, getattr(given, "__name__", repr(given)))
    raise UsageError(
        f"reward={given!r}: give a function of a Happening, or numbers for {', '.join(NUMBERS)}."
    )


def _of_numbers(given: Mapping[str, Any]) -> Reward:
    known, faults = Known(NUMBERS), []
    for name, value in given.items():
        if name not in known:
            faults.append(f"reward: {name!r} is nothing that is paid for. {known.hint(str(name))}")
        elif not isinstance(value, int | float) or not math.isfinite(value):
            faults.append(f"reward: {name} is {value!r}; give a number.")
    if faults:
        raise UsageError("\n".join(faults))
    pays = {name: float(given.get(name, 0.0)) for name in NUMBERS}

    def reward(happening: Happening) -> float:
        return (
            pays["second"] * happening.seconds
            + pays["stress"] * happening.stress
            + pays["idle"] * happening.idle
            + pays["task"] * len({*happening.finished.values()})
            + pays["done"] * happening.done
            + pays["illegal"] * happening.illegal
        )

    return reward


def _checked(reward: Reward, name: str) -> Reward:
    def paid(happening: Happening) -> float:
        amount = reward(happening)
        if not isinstance(amount, int | float) or not math.isfinite(amount):
            raise UsageError(f"reward {name}: gave {amount!r} for {happening}; give a number.")
        return float(amount)

    return paid
