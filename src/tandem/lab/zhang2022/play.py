"""One episode on any cell of two agents, decided in NumPy as a station's PC would: how long
decisions take, and what comes of deviations.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.lab.systems import Played
from tandem.lab.zhang2022.change import Change
from tandem.lab.zhang2022.pairs import Networks, choose
from tandem.lab.zhang2022.runs import OURS
from tandem.lab.zhang2022.setting import HUMAN, Duo, duo, setting
from tandem.lab.zhang2022.world import (
    State,
    choices,
    is_done,
    narrow,
    observation_size,
    observe,
    reset,
    step,
)
from tandem.learn.networks import init
from tandem.world.arrays import NEVER


def play_on(
    cell: Cell, seed: int, deviates: float = 0.0, networks: Networks | None = None
) -> Played:
    """One assembly at nominal times.

    Args:
      deviates: probability, at each of the human's decisions, that it begins one of the operations
        it could begin, each equally likely.
      networks: of a training on this cell; fresh ones when absent: masks alone see to it that the
        work is finished.

    Raises CellError for a cell that two agents cannot express.
    """
    data, draw = duo(cell)[0], np.random.default_rng(seed)
    networks = networks or fresh(data, draw)
    numbers, seconds, spent, strays = setting(), 0.0, [], 0
    state = reset(
        data,
        np.ones(len(cell.tasks), np.float32),
        Change(np.int32(NEVER), np.float32(0), np.float32(0)),
    )
    while not is_done(state):
        began = time.perf_counter()
        pairs = pairs_of(data, state)
        seen = observe(data, state)
        action = choose(
            np, networks, np.stack([seen, seen]), pairs, OURS.candidates, OURS.activation
        )
        spent.append(1000 * (time.perf_counter() - began))
        begins = np.flatnonzero(pairs.any(0)[1:]) + 1
        if (
            len(begins)
            and draw.random() < deviates
            and (own := draw.choice(begins)) != action[HUMAN]
        ):
            strays += 1
            left = pairs & (np.arange(len(pairs)) == own)[None, :]
            action = choose(
                np, networks, np.stack([seen, seen]), left, OURS.candidates, OURS.activation
            )
        state, paid = step(data, numbers, state, action)
        seconds += float(paid.seconds)
    return Played(round(seconds, 3), tuple(spent), strays)


def pairs_of(data: Duo, state: State) -> Any:
    """`[K, K]` bool as `learn.ddpg.legal_pairs` gives it, in NumPy."""
    legal = choices(data, state)
    rows = [
        narrow(data, state, legal, np.int32(human)) & legal[HUMAN, human]
        for human in range(legal.shape[1])
    ]
    return np.stack(rows, axis=1)


def fresh(data: Duo, draw: np.random.Generator) -> Networks:
    """Networks that have learned nothing yet."""
    seen, number = observation_size(data), data.pick.shape[1]

    def network(sizes: tuple[int, ...]) -> Any:
        return init(lambda shape: draw.uniform(-1, 1, shape).astype(np.float32), sizes, 0.1)

    pair = [network((seen, *OURS.hidden, number)) for _ in range(2)]
    actors = {
        layer: {part: np.stack([one[layer][part] for one in pair]) for part in parts}
        for layer, parts in pair[0].items()
    }
    return {"actors": actors, "critic": network((2 * seen + 2 * number, *OURS.hidden, 1))}
