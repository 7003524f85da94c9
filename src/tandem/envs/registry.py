"""Every world's standard faces by name: one line a world, for PettingZoo and for Gymnasium."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import gymnasium

from tandem.errors import UsageError
from tandem.extensions import extended, resolved

if TYPE_CHECKING:
    from pettingzoo import ParallelEnv

PARALLEL = extended("environments", {"events": "tandem.envs.parallel:EventsParallel"})
"""Name -> the PettingZoo face, `module:class`. A new one is a line here, or an entry point of the
group `tandem.environments`.
"""

SINGLE = extended(
    "gymnasium", {"tandem/RobotBesideHuman-v0": "tandem.envs.single:RobotBesideHuman"}
)
"""Gymnasium id -> the single-agent face, `module:class`. A new one is a line here, or an entry
point of the group `tandem.gymnasium`.
"""


def parallel_env(name: str, *arguments: Any, **options: Any) -> ParallelEnv[str, Any, Any]:
    """The PettingZoo face of a world, made with its own arguments: `parallel_env("thesis", cell,
    stress_factor=5)`.

    Raises UsageError for an unknown name, and what the world raises for arguments that do not fit.
    """
    if name not in PARALLEL:
        meant = "".join(f" Did you mean {near!r}?" for near in get_close_matches(name, PARALLEL, 1))
        raise UsageError(
            f"environment {name!r}: there is none.{meant} There are: {', '.join(PARALLEL)}."
        )
    made: ParallelEnv[str, Any, Any] = resolved(PARALLEL[name])(*arguments, **options)
    return made


def register() -> None:
    """Makes the single-agent faces known to `gymnasium.make`; `import tandem.envs` does it."""
    for name, face in SINGLE.items():
        if name not in gymnasium.registry:
            gymnasium.register(id=name, entry_point=face)
