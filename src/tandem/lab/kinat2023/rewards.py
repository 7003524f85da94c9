"""The thesis's two sets of rewards, as data. Its text (table 5-2) and its code (appendix E)
disagree; both are kept by name.

Only the appendix explains the published results: by dynamic programming (`optimal.py`) its values,
without the idle penalty, make exactly the published schedules return-optimal at the ergonomic
factors 0, 1 and 5; table 5-2's do not.
"""

from __future__ import annotations

from difflib import get_close_matches

from tandem.errors import UsageError
from tandem.lab.kinat2023.world import Rewards

REWARDS: dict[str, Rewards] = {
    "appendix": Rewards(
        step=-10.0, task_done=0.0, illegal=-10.0, idle=-10.0, all_done=50.0, stress_factor=0.0
    ),
    "table_5_2": Rewards(
        step=-1.0, task_done=1.0, illegal=-10.0, idle=-11.0, all_done=50.0, stress_factor=0.0
    ),
}
"""Name -> what is paid in stage 1 of the thesis's training, at ergonomic factor 0. After stage 1
`idle` is 0.
"""


def reward_set(name: str = "appendix", *, stress_factor: float = 0.0, stage: int = 2) -> Rewards:
    """The rewards of that name at an ergonomic factor. Stage 1 punishes idling, later stages (the
    default) do not.

    Raises UsageError for a name that `REWARDS` does not hold.
    """
    if name not in REWARDS:
        meant = "".join(
            f" Did you mean {close!r}?" for close in get_close_matches(name, REWARDS, 1)
        )
        raise UsageError(
            f"rewards {name!r}: there is no such set.{meant} There are: {', '.join(REWARDS)}."
        )
    paid = REWARDS[name]._replace(stress_factor=float(stress_factor))
    return paid if stage == 1 else paid._replace(idle=0.0)
