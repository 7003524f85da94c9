"""Handles by which the laboratory finds out what the system of Alessio et al. (2022) can do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from tandem.cell.model import Cell
from tandem.dispatch.lookahead.dynamic_programming import minimax
from tandem.lab.alessio2022 import adversarial, cells
from tandem.lab.alessio2022.layout import layout
from tandem.lab.alessio2022.learn_env import GridWorld
from tandem.lab.kinat2023.recipe import STATION
from tandem.lab.kinat2023.station import station, whole_ticks
from tandem.lab.systems import Features, Played
from tandem.learn.ppo.recipes import longer

SHORT = longer(STATION, cells.QUICK)


def _guaranteed(cell: Cell) -> float:
    """Seconds within which the cell is done whatever the human does."""
    station(cell, per_second=whole_ticks(cell))
    return minimax(cell)


def _episode(cell: Cell, seed: int, *, hostile: bool) -> Played:
    """One game of a robot that learned for a moment against an adversary, on this very cell."""
    actor = cells.learn(cell, adversary=True, seeds=[seed], recipe=SHORT)[0]
    game = cells.play(cell, cells.learned_robot(cell, actor), hostile=hostile)
    return Played(game.makespan, game.asked_ms, game.spoiled)


def _exact_values(document: Mapping[str, Any]) -> Sequence[float]:
    grids = [
        float(grid["exact"]["minimax"])
        for grid in document["grids"]
        if grid["exact"]["minimax"] is not None
    ]
    return [*grids, *(point[0] for row in document["cells"] for point in row["trade"])]


FEATURES = Features(
    trains=lambda: adversarial.together,
    agents=lambda: GridWorld.of(layout("crossing")).agents,
    cost=_guaranteed,
    play=lambda cell, seed: _episode(cell, seed, hostile=False),
    deviate=lambda cell, seed: _episode(cell, seed, hostile=True),
    exact=_exact_values,
)
