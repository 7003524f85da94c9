"""Handles by which the laboratory finds out what the system of Alessio et al. (2022) can do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from tandem.cell.model import Cell
from tandem.dispatch.values.exact import minimax
from tandem.envs.grid.layout import layout
from tandem.envs.thesis.station import station, whole_ticks
from tandem.experiments import alessio_cells
from tandem.experiments.systems import Features, Played
from tandem.learn import adversarial
from tandem.learn.grids import GridWorld
from tandem.learn.recipes import TANDEM, longer

SHORT = longer(TANDEM, alessio_cells.QUICK)


def _guaranteed(cell: Cell) -> float:
    """Seconds within which the cell is done whatever the human does."""
    station(cell, per_second=whole_ticks(cell))
    return minimax(cell)


def _episode(cell: Cell, seed: int, *, hostile: bool) -> Played:
    """One game of a robot that learned for a moment against an adversary, on this very cell."""
    actor = alessio_cells.learn(cell, adversary=True, seeds=[seed], recipe=SHORT)[0]
    game = alessio_cells.play(cell, alessio_cells.learned_robot(cell, actor), hostile=hostile)
    return Played(game.makespan, game.asked_ms, game.spoiled)


def _exact_values(document: Mapping[str, Any]) -> Sequence[float]:
    grids = [float(grid["exact"]["minimax"]) for grid in document["grids"] if grid["exact"]["minimax"] is not None]
    return [*grids, *(point[0] for row in document["cells"] for point in row["trade"])]


FEATURES = Features(
    trains=lambda: adversarial.together,
    agents=lambda: GridWorld.of(layout("crossing")).agents,
    cost=_guaranteed,
    play=lambda cell, seed: _episode(cell, seed, hostile=False),
    deviate=lambda cell, seed: _episode(cell, seed, hostile=True),
    exact=_exact_values,
)
