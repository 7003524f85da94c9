"""Chance as data: all random numbers of one episode, drawn at once.

What happens does not depend on who decides: the same key gives the same durations for the same way
of the same task, the same breakdowns at the same times, the same slips and the same moods, whatever
the deciders do. So two deciders can be compared pair by pair (common random numbers). Chance that
is off has arrays of length 0; all off, the world is its nominal self.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tandem.errors import UsageError
from tandem.world.arrays import NEVER, Array, Arrays, Names, namespace

if TYPE_CHECKING:
    import jax

SPREADS = ("off", "lognormal", "triangular", "empirical")
"""How real durations lie around the nominal ones."""

WIDEST_TRIANGLE = 0.4
"""A symmetric triangle around 1 with a larger coefficient of variation would reach 0 (at 1 /
sqrt(6) = 0.408).
"""

ATTEMPTS = 8
"""A task that has been undone so often is done rightly in the end, so that every episode ends."""


@dataclass(frozen=True)
class Chance:
    """What may happen. Everything is off by default. Mistakes, moods and pace are the people's
    (`people.py`); what follows a mistake stands here.

    Attributes:
      spread: one of `SPREADS`. The mean of lognormal and triangular durations is the nominal one.
      cv: coefficient of variation of the durations for which the cell states none.
      factors: for "empirical": measured durations divided by the nominal ones; each is as likely.
      failure_s, repair_s: mean seconds (exponential) between two breakdowns of a robot or
        machine, and until it is repaired. None: they do not fail.
      absence_s, away_s: the same for humans being called away.
      undo: the disassembly of a task takes this share of its own time (ASSUMPTION: as long as
        mounting it).
      wrong_order: share of the mistakes in which a task is begun before its turn; else the wrong
        part is mounted.
      later: share of the mistakes that are not noticed when the task ends, but `notice_s` seconds
        later on average (exponential), or when all stands.
    """

    spread: str = "off"
    cv: float = 0.0
    factors: tuple[float, ...] = ()
    failure_s: float | None = None
    repair_s: float = 30.0
    absence_s: float | None = None
    away_s: float = 60.0
    undo: float = 1.0
    wrong_order: float = 0.3
    later: float = 0.3
    notice_s: float = 20.0

    def __post_init__(self) -> None:
        if wrong := [sentence for sentence in self._wrong() if sentence]:
            raise UsageError("\n".join(wrong))

    def _wrong(self) -> list[str]:
        shares = [(key, getattr(self, key)) for key in ("wrong_order", "later")]
        times = [
            (key, getattr(self, key))
            for key in ("failure_s", "repair_s", "absence_s", "away_s", "notice_s")
        ]
        return [
            (
                ""
                if self.spread in SPREADS
                else f"spread={self.spread!r} is unknown. Choose from {', '.join(SPREADS)}."
            ),
            (
                ""
                if 0 <= self.cv < 10
                else f"cv is {self.cv:g}: give a coefficient of variation from 0 to 10."
            ),
            (
                f"cv is {self.cv:g}: a triangle ends at {WIDEST_TRIANGLE}; take lognormal."
                if self.spread == "triangular" and self.cv > WIDEST_TRIANGLE
                else ""
            ),
            (
                "spread='empirical' needs factors: measured durations divided by the nominal ones."
                if self.spread == "empirical" and not self.factors
                else ""
            ),
            *(
                f"factors holds {factor!r}: give numbers above 0."
                for factor in self.factors
                if not 0 < factor < 1000
            ),
            *(
                f"{key} is {share!r}: give a share from 0 to 1."
                for key, share in shares
                if not 0 <= share <= 1
            ),
            *(
                f"{key} is {time!r}: give seconds above 0."
                for key, time in times
                if time is not None and not 0 < time <= 1e7
            ),
            (
                ""
                if 0 < self.undo <= 100
                else f"undo is {self.undo!r}: give a share of the task's time above 0."
            ),
        ]


OFF = Chance()
"""Nothing happens by chance."""


class Scenario(NamedTuple):
    """What chance brings in one episode. `A` attempts, `N` absences of all operators, `D` decisions
    of an operator, `M` as in `State`.

    factor: `[W, A]` float32, the real duration divided by the nominal one; `[0, 0]` without spread.
    away_from, away_to: `[N]` int32, ticks, sorted by their beginning; `away`: `[N, O]` bool, whose
    it is. slip: `[M, A]` float32 in 0..1, the task goes wrong when a person's tendency is larger.
    order: `[M, A]` float32 in 0..1, which task is begun out of turn; 1 or more: it is a wrong part
    instead. notice: `[M, A]` int32, ticks from the end of the task until the mistake is noticed.
    mood: `[O, D, 3]` float32 in 0..1, per decision: whether to follow, what else to pick, whether
    to refuse. After `D` it begins anew.
    """

    factor: Array
    away_from: Array
    away_to: Array
    away: Array
    slip: Array
    order: Array
    notice: Array
    mood: Array


@dataclass(frozen=True)
class Draw:
    """How many numbers an episode of a cell needs: what `scenario` takes.

    Attributes:
      chance: what may happen.
      per_second: ticks in a second.
      ways, tasks, operators: their counts.
      absences: per operator.
      mistakes: somebody may make some.
      decisions: that an operator can make before its moods begin anew.
    """

    chance: Chance
    per_second: int
    ways: int
    tasks: int
    operators: int
    absences: int
    mistakes: bool
    decisions: int

    @classmethod
    def of(cls, names: Names, arrays: Arrays, chance: Chance = OFF) -> Draw:
        """What the cell needs.

        Raises:
          UsageError: a spread that the cell states is too wide for a triangle.
        """
        (ways, operators), tasks = arrays.way_uses.shape, arrays.needs.shape[0]
        if (
            chance.spread == "triangular"
            and (widest := float(arrays.spread.max())) > WIDEST_TRIANGLE
        ):
            task = names.ways[int(arrays.spread.argmax())][0]
            raise UsageError(
                f"task {task!r}: its spread of {widest:g} is too wide for a triangle, which ends at"
                f" {WIDEST_TRIANGLE}; take lognormal."
            )
        longest = names.seconds(
            sum(int(arrays.way_ticks[arrays.way_task == task].max()) for task in range(tasks))
        )
        gaps = [gap for gap in (chance.failure_s, chance.absence_s) if gap is not None]
        absences = min(12, math.ceil(2 * longest / min(gaps)) + 2) if gaps else 0
        return cls(
            chance,
            names.per_second,
            ways,
            tasks,
            operators,
            absences,
            bool(arrays.undo.shape[0]),
            4 * tasks + 8,
        )

    @property
    def numbers(self) -> int:
        """How many uniform numbers an episode takes."""
        return sum(math.prod(shape) for shape in self.shapes.values())

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        """What they are for."""
        attempts = ATTEMPTS if self.mistakes else 1
        return {
            "factor": (2, self.ways, attempts) if self.chance.spread != "off" else (0,),
            "away": (2, self.operators, self.absences),
            "slip": (4, self.tasks, attempts) if self.mistakes else (0,),
            "mood": (self.operators, self.decisions, 3),
        }


def scenario(draw: Draw, arrays: Arrays, uniform: Array) -> Scenario:
    """One episode's chance from uniform numbers `[draw.numbers]` in [0, 1), float32: in JAX,
    `jax.random.uniform(key, (draw.numbers,))`.
    """
    xp, chance, parts, begin = namespace(uniform), draw.chance, {}, 0
    for name, shape in draw.shapes.items():
        parts[name] = uniform[begin : begin + math.prod(shape)].reshape(shape)
        begin += math.prod(shape)
    away_from, away_to, away = _absences(xp, draw, arrays, parts["away"])
    attempts = ATTEMPTS if draw.mistakes else 0
    slips = parts["slip"] if draw.mistakes else xp.zeros((4, 0, 0), xp.float32)
    last = xp.arange(attempts) == attempts - 1
    noticed = xp.where(
        slips[2] < chance.later, _exponential(xp, slips[3], chance.notice_s * draw.per_second), 0
    )
    return Scenario(
        factor=_factors(xp, draw, arrays, parts["factor"]),
        away_from=away_from,
        away_to=away_to,
        away=away,
        slip=xp.where(last[None, :], xp.ones_like(slips[0]), slips[0]),
        order=(
            slips[1] / chance.wrong_order if chance.wrong_order else xp.ones_like(slips[1])
        ).astype(xp.float32),
        notice=noticed.astype(xp.int32),
        mood=parts["mood"],
    )


def nominal_scenario(draw: Draw, arrays: Arrays) -> Scenario:
    """The episode in which every coin of a mood lies in the middle: with chance off and compliant
    people, the nominal world.
    """
    return scenario(draw, arrays, namespace(arrays.way_ticks).full(draw.numbers, 0.5, "float32"))


def scenarios(key: jax.Array, draw: Draw, arrays: Arrays, episodes: int) -> Scenario:
    """The chances of so many episodes, with a leading axis, in NumPy: those that
    `episode.play_many` has for the same key.
    """
    import jax

    make = jax.jit(jax.vmap(partial(scenario, draw, arrays)))
    return Scenario(
        *(np.asarray(part) for part in make(jax.random.uniform(key, (episodes, draw.numbers))))
    )


def real_ticks(
    scenario: Scenario, arrays: Arrays, way: Array, attempt: Array, nominal: Array
) -> Array:
    """`[]` float32, ticks that the way (`[]` int, -1 for none) takes at this attempt (`[]` int),
    people's pace aside.
    """
    xp = namespace(nominal)
    if not scenario.factor.shape[0]:
        return nominal.astype(xp.float32)
    ways, attempts = scenario.factor.shape
    index = xp.maximum(way, 0) * attempts + xp.minimum(attempt, attempts - 1)
    return nominal * scenario.factor.reshape(ways * attempts)[index]


def with_rests(scenario: Scenario, start: Array, ticks: Array, who: Array) -> Array:
    """`[]` int32, ticks from the start until the end of work that rests while one of those who do
    it (`[O]` bool) is away.
    """
    xp = namespace(ticks)
    end, covered = start + ticks, start
    for index in range(scenario.away_from.shape[0]):
        off, back = xp.maximum(scenario.away_from[index], covered), scenario.away_to[index]
        rests = xp.any(scenario.away[index] & who) & (off < end) & (back > off)
        end = end + xp.where(rests, back - off, 0)
        covered = xp.where(rests, back, covered)
    return (end - start).astype(xp.int32)


def away_until(scenario: Scenario, clock: Array) -> Array:
    """`[O]` int32, when who has left by `clock` came or comes back."""
    xp = namespace(clock)
    left = scenario.away & (scenario.away_from <= clock)[:, None]
    return xp.max(xp.where(left, scenario.away_to[:, None], 0), axis=0).astype(xp.int32)


def next_absence(scenario: Scenario, clock: Array) -> Array:
    """`[]` int32, the next tick at which somebody leaves; NEVER when nobody does."""
    xp = namespace(clock)
    return xp.min(xp.where(scenario.away_from > clock, scenario.away_from, NEVER)).astype(xp.int32)


def _factors(xp: Any, draw: Draw, arrays: Arrays, uniform: Array) -> Array:
    """`[W, A]`, by the spread that the cell states, else by the chance's own."""
    chance = draw.chance
    if chance.spread == "off":
        return xp.zeros((0, 0), xp.float32)
    cv = xp.where(arrays.spread > 0, arrays.spread, chance.cv)[:, None].astype(xp.float32)
    first, second = uniform
    if chance.spread == "empirical":
        measured = xp.asarray(chance.factors, dtype=xp.float32)
        return measured[
            xp.minimum((first * len(chance.factors)).astype(xp.int32), len(chance.factors) - 1)
        ]
    if chance.spread == "triangular":
        half = cv * 6**0.5
        below = xp.sqrt(2 * first) - 1
        above = 1 - xp.sqrt(2 * (1 - first))
        return (1 + half * xp.where(first < 0.5, below, above)).astype(xp.float32)
    sigma = xp.sqrt(xp.log1p(cv**2))
    normal = xp.sqrt(-2 * xp.log1p(-first)) * xp.cos(2 * math.pi * second)  # Box and Muller (1958)
    return xp.exp(sigma * normal - sigma**2 / 2).astype(xp.float32)


def _absences(xp: Any, draw: Draw, arrays: Arrays, uniform: Array) -> tuple[Array, Array, Array]:
    """Who is away from when to when, sorted: exponential times there and exponential times away,
    one after the other.
    """
    chance, operators, count = draw.chance, draw.operators, draw.absences
    if not count:
        none = xp.zeros(0, xp.int32)
        return none, none, xp.zeros((0, operators), bool)
    there, off = (
        xp.where(arrays.human, a or 0.0, b or 0.0)[:, None] * draw.per_second
        for a, b in ((chance.absence_s, chance.failure_s), (chance.away_s, chance.repair_s))
    )
    lasts = (
        xp.maximum(1, _exponential(xp, uniform[0], 1.0) * there),
        xp.maximum(1, _exponential(xp, uniform[1], 1.0) * off),
    )
    back = xp.minimum(xp.cumsum(lasts[0] + lasts[1], axis=1), NEVER // 2)
    never = (there == 0) | (back >= NEVER // 2)
    leaves = xp.where(never, NEVER, back - lasts[1]).reshape(-1).astype(xp.int32)
    returns = xp.where(never, NEVER, back).reshape(-1).astype(xp.int32)
    order = xp.argsort(leaves)
    who = xp.repeat(xp.eye(operators, dtype=bool), count, axis=0)
    return leaves[order], returns[order], who[order]


def _exponential(xp: Any, uniform: Array, mean: float) -> Array:
    return -mean * xp.log1p(-uniform)
