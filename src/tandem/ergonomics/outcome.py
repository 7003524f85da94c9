"""What a method answers: a score, a level of action, and every step that led to them.

A step is data, not a sentence: `words_en.json` and `words_de.json` hold the sentences, and whoever
shows an outcome puts the two together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

Band = tuple[float | None, float | None]
"""The lower and the upper end of the stretch of a scale that a value fell into; None is open."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Why a step came out as it did.

    Attributes:
      key: of the sentence, `reason.KEY`.
      amount: the fact that was given, if it is a number or a word.
      band: the stretch of the method's scale that it fell into, where the method has stretches.
      points: what it gave, or added.
      added: `points` came on top of what another reason gave.
      neutral: it is as good as the scale has it, and not worth telling in one sentence.
    """

    key: str
    amount: float | str | None = None
    band: Band | None = None
    points: float | None = None
    added: bool = False
    neutral: bool = False


@dataclass(frozen=True, slots=True)
class Step:
    """One line of the calculation.

    Attributes:
      part: of the sentence, `part.PART`; the published name of what was worked out.
      value: what came out.
      reasons: why.
      weight: how far it worsened the result, on a scale that is the same for all steps of one
        outcome; 0 when it did not, or only sums up.
    """

    part: str
    value: float | str | None
    reasons: tuple[Reason, ...] = ()
    weight: float = 0.0


@dataclass(frozen=True, slots=True)
class Outcome:
    """What one method says about one task and side.

    Attributes:
      method: its name in `METHODS`.
      score: the number that the method is known by. None when it has none, such as a lifting index
        of a lift that the equation does not allow at all.
      level: the place of the score among the method's levels of action, 0 is the best.
      outputs: every published quantity by its published name.
      steps: the calculation in order.
    """

    method: str
    score: float | None
    level: int
    outputs: Mapping[str, Any]
    steps: tuple[Step, ...] = field(default=())


def banded(value: float, limits: tuple[float, ...]) -> int:
    """Which stretch a value falls into, counted from 0; a value on a limit takes the lower one."""
    return sum(value > limit for limit in limits)


@dataclass(frozen=True, slots=True)
class Published:
    """A step that a method publishes, under its published name.

    Attributes:
      run: facts in, an `Outcome`, a mapping of outputs or a single number out.
      model: of the facts that `run` takes; None when it takes named numbers.
      unverified: its numbers were recalled, not read in the source. They are marked so wherever
        they are shown.
    """

    run: Callable[..., Any]
    model: type[Any] | None = None
    unverified: bool = False
