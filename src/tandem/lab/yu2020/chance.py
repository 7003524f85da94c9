"""Random robot failures and human errors, the question that Kinat (2023, chapter 4) puts to this
game. Ours: the authors' game has neither.

Everything that can go wrong is drawn before the game, piece by piece, so that two deciders meet the
same troubles (common random numbers).
"""

from __future__ import annotations

from dataclasses import dataclass

from tandem.errors import UsageError
from tandem.lab.yu2020.world import Array, Fate, Layout, namespace

MOST_MISTAKES = 9
"""How often in a row the human may do one piece wrong."""


@dataclass(frozen=True)
class Chance:
    """How likely trouble is. ASSUMPTION: nobody has published such numbers for this game; the
    defaults are round ones.

    Attributes:
      robot_fails: probability that the robot's work on a piece fails; it shows at the end, and the
        robot repairs it.
      repair_s: mean seconds of a repair (exponential, rounded up to whole seconds).
      human_errs: probability that the human's work on a piece is wrong; it shows at the end, and
        the piece has to be done again.
    """

    robot_fails: float = 0.05
    repair_s: float = 10.0
    human_errs: float = 0.05

    def __post_init__(self) -> None:
        for name in ("robot_fails", "human_errs"):
            if not 0 <= getattr(self, name) < 1:
                raise UsageError(
                    f"{name}={getattr(self, name)!r}: a probability from 0 to less than 1."
                )
        if not self.repair_s > 0:
            raise UsageError(f"repair_s={self.repair_s!r}: more than 0 seconds.")


def fate(layout: Layout, chance: Chance, numbers: Array) -> Fate:
    """What goes wrong on the board, from `numbers` `[3, h, w]`, uniform on [0, 1):
    `random.random((3, h, w))`, `jax.random.uniform`.

    The same numbers with a higher probability bring the same troubles and more.
    """
    xp = namespace(numbers)
    starts = layout.who > 0
    least = xp.maximum(1 - numbers, 1e-12)
    repair = xp.where(
        numbers[0] < chance.robot_fails, xp.ceil(-chance.repair_s * xp.log(least[1])), 0
    )
    if chance.human_errs > 0:
        mistakes = xp.minimum(
            xp.floor(xp.log(least[2]) / xp.log(xp.asarray(chance.human_errs))), MOST_MISTAKES
        )
    else:
        mistakes = xp.zeros_like(repair)
    return Fate((repair * starts).astype(xp.int32), (mistakes * starts).astype(xp.int32))
