"""Every world's standard faces by name: one line a world, for PettingZoo and for Gymnasium."""

from __future__ import annotations

import importlib
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import gymnasium

from tandem.errors import UsageError

if TYPE_CHECKING:
    from pettingzoo import ParallelEnv

PARALLEL = {
    "duo": "tandem.lab.zhang2022.parallel:DuoParallel",
    "chessboard": "tandem.lab.yu2020.parallel:ChessboardParallel",
    "thesis": "tandem.lab.kinat2023.parallel:ThesisParallel",
    "events": "tandem.envs.parallel:EventsParallel",
    "grid": "tandem.lab.alessio2022.parallel:GridParallel",
}
"""Name -> the PettingZoo face, `module:class`."""

SINGLE = {
    "tandem/Thesis-v0": "tandem.lab.kinat2023.single:ThesisEnv",
    "tandem/RobotBesideHuman-v0": "tandem.envs.single:RobotBesideHuman",
    "tandem/Repair-v0": "tandem.lab.antonelli2021.single:RepairEnv",
}
"""Gymnasium id -> the single-agent face, `module:class`."""


def parallel_env(name: str, *arguments: Any, **options: Any) -> ParallelEnv[str, Any, Any]:
    """The PettingZoo face of a world, made with its own arguments: `parallel_env("thesis", cell, stress_factor=5)`.

    Raises UsageError for an unknown name, and what the world raises for arguments that do not fit.
    """
    if name not in PARALLEL:
        meant = "".join(f" Did you mean {near!r}?" for near in get_close_matches(name, PARALLEL, 1))
        raise UsageError(f"environment {name!r}: there is none.{meant} There are: {', '.join(PARALLEL)}.")
    module, face = PARALLEL[name].split(":")
    made: ParallelEnv[str, Any, Any] = getattr(importlib.import_module(module), face)(*arguments, **options)
    return made


def register() -> None:
    """Makes the single-agent faces known to `gymnasium.make`; `import tandem.envs` does it."""
    for name, face in SINGLE.items():
        if name not in gymnasium.registry:
            gymnasium.register(id=name, entry_point=face)
