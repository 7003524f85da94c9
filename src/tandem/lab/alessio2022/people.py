"""Humans on the grid that learn nothing: one that moves by chance, one that pursues a terminal
state.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tandem.lab.alessio2022.layout import RIGHT, WRONG, Layout
from tandem.lab.alessio2022.world import HUMAN, Array, namespace

FAR = 1 << 20
"""Moves to a square from which no way leads."""


def goals(layout: Layout, *, of: str = WRONG + RIGHT) -> Any:
    """`[M, S]` int32: per terminal state that the human may pursue the moves to it from each
    square; `of` names their kinds, `W`, `G` or both.
    """
    far = np.array(
        [layout.distances(place) for kind in of for place in layout.squares(kind)], np.int32
    )
    return np.where(far < 0, FAR, far).astype(np.int32)


def wanders(legal: Array, moment: Array) -> Array:
    """`[]` int: any legal action, each as likely as the others. `legal` `[K]` bool, `moment` `[]`
    in [0, 1).
    """
    xp = namespace(legal)
    place = xp.floor(moment * xp.sum(legal)) + 1
    return xp.argmax(xp.cumsum(legal) >= place)


def pursues(
    neighbour: Array,
    distances: Array,
    position: Array,
    legal: Array,
    goal: Array,
    moment: Array,
    mistakes: Array,
) -> Array:
    """`[]` int: the legal action that leads nearest to the goal, as if nobody had closed a square;
    with probability `mistakes` any legal action.

    Args:
      neighbour: `[S, 5]` of the grid. distances: `[M, S]` of `goals`. position: `[2]`. legal: `[5]`
        bool.
      goal: `[]` in [0, 1), which of the M it pursues, kept for the episode. moment: `[]` in [0, 1),
        new at each move.
    """
    xp = namespace(distances)
    wanted = distances[
        xp.minimum(xp.floor(goal * distances.shape[0]), distances.shape[0] - 1).astype(xp.int32)
    ]
    far = xp.where(legal, wanted[neighbour[position[HUMAN]]], 4 * FAR)
    errs = moment < mistakes
    return xp.where(errs, wanders(legal, moment / xp.maximum(mistakes, 1e-9)), xp.argmin(far))
