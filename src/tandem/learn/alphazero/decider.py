"""Networks of games of turns as they decide alone, without a search: in NumPy, on the station's
PC.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from tandem.cell.model import Cell
from tandem.learn.algorithm import Learnt, Worth
from tandem.learn.alphazero.network import Network, Scorer
from tandem.learn.alphazero.trained import Trained
from tandem.learn.forms import parsed
from tandem.learn.policy import Notes
from tandem.learn.results import SECOND
from tandem.learn.turns import choices, least_to_come, observe, static_features
from tandem.world.arrays import Array, Arrays, Names
from tandem.world.state import State


def learnt(path: Path, cell: Cell) -> Learnt:
    """The network in the file, for `tandem.learn.training.algorithms.DECIDERS`."""
    return Learnt(worth_of(path, cell, Scorer))


def worth_of(path: Path, cell: Cell, form: type[Network]) -> Worth:
    """The logits of the network in the file, on any cell, as it was told of costs in its training.

    Raises CellError when the file holds no network of that form.
    """
    trained = Trained.load(path, form)
    notes = parsed(path, json.dumps(dict(trained.notes)), Notes, "is no network: notes")
    names, network, parameters = Names.of(cell), trained.network, trained.parameters
    known = static_features(
        names, names.arrays(), time_weight=SECOND, stress_weight=notes.stress_factor
    )
    tick = np.float32(SECOND / (names.per_second * known.unit))

    def worth(arrays: Arrays, state: State, mask: Array, turn: Array) -> Array:
        legal = choices(arrays, state, mask, turn, waiting=notes.waiting)
        seen = observe(known.ahead, arrays, state, mask, turn, tick=tick, waiting=notes.waiting)
        least = least_to_come(known.ahead, arrays, state, tick)
        logits = network.read(parameters, seen, least, turn).logits
        if not notes.waiting:  # it never learned to; it waits where it can do nothing else
            legal, logits = np.append(legal, not legal.any()), np.append(logits, np.float32(0.0))
        return np.where(legal, logits, -np.inf)

    return worth
