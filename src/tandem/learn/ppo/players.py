"""What PPO has learned as it plays a cell, and who plays at random: episodes in NumPy beside
somebody who does what is asked. No JAX is loaded.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tandem.cell.model import Cell, plain
from tandem.learn.networks import masked_log_softmax, sample
from tandem.learn.policy import Policy
from tandem.learn.ppo.decider import policy_for, worth
from tandem.learn.results import Reached, cost, paid
from tandem.schedule.model import Schedule
from tandem.world.arrays import Array, Arrays, Names
from tandem.world.episode import Decider, Shift, play_one
from tandem.world.people import compliant, crew
from tandem.world.randomness import Draw, fate
from tandem.world.state import legal_of

if TYPE_CHECKING:
    from tandem.learn.algorithm import Order


def players(
    path: Path, cell: Cell, order: Order, *, seed: int, episodes: int
) -> dict[str, list[Reached]]:
    """How the decider plays the cell: what it thinks best, what it draws, and the best of that.

    Raises:
      CellError: the file is no policy, or none of the run's own cell. UsageError: the cell has
        another shape than the one that was learned.
    """
    policy = policy_for(path, cell, trained_on=order.cell.digest)
    draws = np.random.default_rng(seed)
    greedy = _played(
        cell, order.stress_factor, _chooser(policy, lambda logits: int(np.argmax(logits))), 1
    )
    sampled = _played(
        cell, order.stress_factor, _chooser(policy, lambda logits: _drawn(logits, draws)), episodes
    )
    return {
        "greedy": greedy,
        "sampled": sampled,
        f"best of {episodes}": [min(sampled, key=lambda one: one.cost)],
    }


def at_random(cell: Cell, stress_factor: float, *, seed: int, episodes: int) -> list[Reached]:
    """Episodes in which everybody begins any legal task, each as likely as the others, and waits
    only where there is none.
    """
    draws = np.random.default_rng(seed)

    def decide(arrays: Arrays, shift: Shift) -> Array:
        legal = np.flatnonzero(legal_of(arrays, shift.mask, shift.turn))
        return np.int32(draws.choice(legal) if len(legal) else -1)

    return _played(cell, stress_factor, decide, episodes)


def _chooser(policy: Policy, choose: Callable[[Array], int]) -> Decider:
    def decide(arrays: Arrays, shift: Shift) -> Array:
        action = choose(worth(policy, arrays, shift.state, shift.mask, shift.turn))
        return np.int32(-1 if action == arrays.way_ticks.shape[0] else action)

    return decide


def _drawn(logits: Array, draws: np.random.Generator) -> int:
    legal = np.isfinite(logits)
    return int(
        sample(np, masked_log_softmax(np, np.where(legal, logits, 0.0), legal), draws.random(()))
    )


def _played(cell: Cell, stress_factor: float, decide: Decider, episodes: int) -> list[Reached]:
    names = Names.of(cell)
    arrays = names.arrays()
    obedient = crew(arrays, compliant(arrays))
    nothing_happens = Draw.of(names, arrays)
    found = []
    for _ in range(episodes):
        chance = fate(nothing_happens, arrays, np.full(nothing_happens.numbers, 0.5, np.float32))
        played = play_one(names, arrays, chance, obedient, decide)
        spent = cost(played.makespan, played.stress, **paid(stress_factor))
        if played.done:
            found.append(
                Reached(
                    plain(played.makespan),
                    plain(round(played.stress, 6)),
                    0,
                    spent,
                    Schedule(played.work),
                )
            )
        else:
            found.append(Reached(None, None, 0, float("inf"), None))
    return found
