"""Task times where nobody has taken any: TMU in seconds, motions of a robot, learning.

Sources: 1 TMU = 0.036 s (Maynard, Stegemerten, Schwab 1948; read in lecture notes of Freivalds);
what earns how many TMU is licensed (MTM, MOST) and not here. The motion from rest to rest at
bounded speed and acceleration is a trapezoid, d/v + v/a, or a triangle, 2 sqrt(d/a); with a bounded
jerk each ramp takes v/a + a/j, or 2 sqrt(v/j). Learning: Wright TP (1936) Factors affecting the
cost of airplanes, Journal of the Aeronautical Sciences 3(4):122-128, T_n = T_1 n^(log2 rate).
"""

from __future__ import annotations

import math
from typing import Any

from tandem.ergonomics.facts import Facts, Several, fact
from tandem.ergonomics.outcome import Published

METHOD = "task_times"
TMU_S = 0.036


class TmuFacts(Facts):
    """A number of time measurement units, from whatever system it came."""

    n: float = fact("time measurement units", "", above=0, high=1e8)


class MoveFacts(Facts):
    """A motion from rest to rest along a path."""

    d: float = fact("length of the path", "m", above=0, high=100)
    v: float = fact("greatest speed", "m/s", above=0, high=20)
    a: float = fact("greatest acceleration, and braking", "", above=0, high=1000)
    j: float | None = fact("greatest jerk; unbounded when absent", "", above=0, default=None)
    times: int = fact("how often", "", 1, 10_000, default=1)


class RobotFacts(Facts):
    """What a robot does for a task, one after the other."""

    moves: Several[MoveFacts]
    grip: float = fact("to close or open the gripper once", "s", 0, 60, default=0.0)
    grips: int = fact("how often it closes or opens", "", 0, 1000, default=0)
    process: float = fact("of the process itself", "s", 0, 86_400, default=0.0)
    settle: float = fact("to settle, to look and to talk to others, once", "s", 0, 600, default=0.0)
    factor: float = fact("motions take so many times as long", "", 1, 100, default=1.0)


class LearningFacts(Facts):
    """Somebody who becomes quicker with each unit."""

    first: float = fact("time of the first unit", "s", above=0, high=86_400)
    rate: float = fact("time left when the number of units doubles", "", above=0, high=1)
    unit: int = fact("the unit that is asked for", "", 1, 10_000_000)


def tmu(facts: TmuFacts) -> dict[str, Any]:
    """Seconds of so many TMU."""
    return {"seconds": facts.n * TMU_S}


def move(facts: MoveFacts) -> dict[str, Any]:
    """Seconds of the motion, and the greatest speed that it reaches.

    With a jerk that is not bounded it is the least time that any controller can take; a bound makes
    the motion longer by at most 1.2 a/j.
    """
    speed = _speed(facts)
    ramp = _ramp(speed, facts)
    cruise = max(0.0, facts.d - speed * ramp) / speed
    return {"t_s": (2 * ramp + cruise) * facts.times, "v_s": speed}


def _ramp(speed: float, facts: MoveFacts) -> float:
    """Seconds from rest to a speed; the way is half of speed x seconds, by symmetry."""
    if facts.j is None:
        return speed / facts.a
    if speed >= facts.a**2 / facts.j:
        return speed / facts.a + facts.a / facts.j
    return 2 * math.sqrt(speed / facts.j)


def _speed(facts: MoveFacts) -> float:
    """The greatest speed that is reached: two ramps must fit into the way, speed x ramp <= d."""
    if facts.v * _ramp(facts.v, facts) <= facts.d:
        return facts.v
    if facts.j is None:
        return math.sqrt(facts.d * facts.a)
    # speed (speed/a + a/j) = d, or 2 speed^1.5 / sqrt(j) = d below the bound of acceleration
    bend = facts.a**2 / facts.j
    reached = (math.sqrt(bend**2 + 4 * facts.a * facts.d) - bend) / 2
    return reached if reached >= bend else float((facts.d / 2) ** (2 / 3) * facts.j ** (1 / 3))


def robot(facts: RobotFacts) -> dict[str, Any]:
    """Seconds of a robot's task: its motions, then what comes on top."""
    moves = math.fsum(move(one)["t_s"] for one in facts.moves) * facts.factor
    grips = facts.grip * facts.grips
    return {
        "moves": moves,
        "grips": grips,
        "process": facts.process,
        "settle": facts.settle,
        "t_s": moves + grips + facts.process + facts.settle,
    }


def wright(facts: LearningFacts) -> dict[str, Any]:
    """Seconds of a unit, counted from 1, by the learning curve."""
    exponent = math.log2(facts.rate)
    return {"exponent": exponent, "t_s": facts.first * facts.unit**exponent}


FUNCTIONS: dict[str, Published] = {
    "tmu": Published(tmu, TmuFacts),
    "robot_move": Published(move, MoveFacts),
    "robot_task": Published(robot, RobotFacts),
    "wright": Published(wright, LearningFacts),
}
"""The published steps that can be asked for alone."""
