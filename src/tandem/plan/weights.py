"""Weights of time and stress in whole numbers, as small as they can be without changing what is
better.

A weighted sum is only ever used to compare schedules. So weights may be exchanged for others that
put every two schedules in the same order, and for long decimals that must be done: CP-SAT counts in
64 bits, and tells what it counted in floating point.
"""

from __future__ import annotations

from fractions import Fraction

from tandem.plan.instance import Instance
from tandem.plan.question import Question
from tandem.schedule.measures import exact

MOST_COUNTED = 1 << 52
"""Up to here CP-SAT counts, and says what it counted, exactly: whole numbers in a float64 have 53
bits.
"""


def whole(question: Question, instance: Instance) -> tuple[int, int]:
    """The question's weights of a tick and of a unit of stress as the smallest whole numbers of the
    same ratio; nothing is rounded.
    """
    time, stress = (Fraction(exact(weight)) for weight in question.weights)
    if not time or not stress:
        return int(time > 0), int(stress > 0)
    ratio = (time / instance.per_second) / (stress / instance.per_stress)
    return ratio.numerator, ratio.denominator


def simplest(time: int, stress: int, most_ticks: int, most_units: int) -> tuple[int, int]:
    """Weights no larger than need be that order all schedules as these do, if schedules differ by
    at most so many ticks and units.

    Two schedules are in another order only when a fraction units/ticks lies between the old ratio
    of the weights and the new one. The Stern-Brocot tree is walked towards the ratio until what
    lies between no longer has such a fraction in it (Graham, Knuth, Patashnik 1994, Concrete
    Mathematics, section 4.5); steps in one direction are taken at once.

    Args:
      time, stress: weights of a tick and of a unit, both more than 0.
    """
    below, above = (0, 1), (1, 0)
    while True:
        middle = (below[0] + above[0], below[1] + above[1])
        side = time * middle[1] - stress * middle[0]
        if not side or middle[0] > most_units or middle[1] > most_ticks:
            return middle
        if side > 0:
            gap, approach = time * below[1] - stress * below[0], stress * above[0] - time * above[1]
            below = _towards(below, above, gap // approach, most_units, most_ticks)
        else:
            gap, approach = stress * above[0] - time * above[1], time * below[1] - stress * below[0]
            above = _towards(above, below, gap // approach, most_units, most_ticks)
        for reached in (below, above):
            if time * reached[1] == stress * reached[0]:
                return reached


def _towards(
    here: tuple[int, int], there: tuple[int, int], steps: int, most_units: int, most_ticks: int
) -> tuple[int, int]:
    """The fraction after so many mediants towards another one, or as many as keep it within the
    limits.
    """
    if there[0]:
        steps = min(steps, (most_units - here[0]) // there[0])
    if there[1]:
        steps = min(steps, (most_ticks - here[1]) // there[1])
    return here[0] + steps * there[0], here[1] + steps * there[1]
