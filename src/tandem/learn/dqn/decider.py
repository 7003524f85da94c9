"""What deep Q-learning has learned as it decides, in NumPy on the station's PC."""

from __future__ import annotations

from pathlib import Path

from tandem.cell.model import Cell
from tandem.learn.algorithm import Learnt
from tandem.learn.alphazero.decider import worth_of
from tandem.learn.dqn.network import ValueNetworks


def learnt(path: Path, cell: Cell) -> Learnt:
    """The networks in the file, for `tandem.learn.training.algorithms.DECIDERS`: costs, not
    beliefs.
    """
    return Learnt(worth_of(path, cell, ValueNetworks), believes=False)
