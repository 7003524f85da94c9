"""A situation, which is in names and seconds, as a position in whole numbers, under a belief about
paces.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import exp, log

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Start
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.dispatch.situation.legal import lacks, legal, waited_from
from tandem.dispatch.situation.model import Running, Situation, exact
from tandem.plan.instance import Instance, bits
from tandem.plan.list_scheduling import Layout

AWAY_S = 60.0
"""ASSUMPTION: who is absent or failed is planned for as being back in so many seconds from now,
whenever one asks.
"""
OVERDUE = 0.05
"""ASSUMPTION: what should have ended already is expected to take this share of its stated time
still.
"""
BACK_S = 60.0
"""ASSUMPTION: what is broken or missing is planned for as being there again so many seconds after
that was reported, twice as many when these are over, and so on.
"""
MOST_MODELS = 64
"""So many cells with different paces and refusals are kept at hand."""
PRICED = (0.6, 0.8, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0)
"""Prices of the operators' time are reckoned when humans need so many times the stated times; at
other paces those of the nearest of these do.
"""

Factors = tuple[tuple[str, float], ...]
"""Human -> factor on the stated times, sorted by name."""
Key = tuple[Hashable, ...]
"""What tells one model from another: the paces first, and all else that changes the moves."""


@dataclass
class Models:
    """The moves of one cell by pace and by what is refused, made when they are first asked for.
    What was made before changes nothing but how long that takes.

    Attributes:
      max_stress: the objective's limit.
    """

    cell: Cell
    max_stress: float | None = None
    _kept: dict[Key, Moves] = field(default_factory=dict)
    _prices: dict[float, tuple[int, ...]] = field(default_factory=dict)

    def of(self, situation: Situation, factor: float | Mapping[str, float]) -> Moves:
        """The moves when every human needs `factor` times the stated time, or each its own; ways
        that somebody refuses now are left out.
        """
        key = self.key(situation, factor)
        moves = self._kept.pop(key, None)
        if moves is None:
            if len(self._kept) >= MOST_MODELS:
                del self._kept[next(iter(self._kept))]
            moves = self._made(dict(self.factors(factor)), situation.taking_apart)
            if waits := awaited(situation):
                moves = _later(moves, waits)
            refused, lacking = _refused(situation), _lacking(situation)
            if refused or lacking:
                named = ((way, *moves.named(way)) for row in moves.ways for way in row)
                moves = moves.without(
                    way
                    for way, task, who in named
                    if (task, who) in lacking or any((one, task) in refused for one in who)
                )
        # what was not asked for longest goes first
        self._kept[key] = moves
        return moves

    def key(self, situation: Situation, factor: float | Mapping[str, float]) -> Key:
        """Of the model that `of` gives: equal keys, equal moves."""
        waits = tuple(sorted(awaited(situation).items()))
        closed = (_refused(situation), _lacking(situation))
        return (self.factors(factor), situation.taking_apart, closed, waits)

    @property
    def count(self) -> int:
        """How many ways of doing there are in the cell."""
        return sum(map(len, self._stated.ways))

    def factors(self, factor: float | Mapping[str, float]) -> Factors:
        """Every human's factor; 1 for who is not named."""
        if isinstance(factor, int | float):
            return tuple((human, float(factor)) for human in sorted(self.cell.humans))
        return tuple((human, factor.get(human, 1.0)) for human in sorted(self.cell.humans))

    def _made(self, pace: Mapping[str, float], taking_apart: float) -> Moves:
        mean = exp(sum(map(log, pace.values())) / max(1, len(pace)))
        near = min(PRICED, key=lambda priced: abs(log(mean / priced)))
        if near not in self._prices:
            alike = Moves.of(self.cell, dict.fromkeys(pace, near), stated=self._stated)
            self._prices[near] = alike.prices.of_operator
        return Moves.of(
            self.cell,
            pace,
            taking_apart=taking_apart,
            max_stress=self.max_stress,
            prices=self._prices[near],
            stated=self._stated,
        )

    def prepare(self) -> None:
        """Reckons the prices at all paces, which is for before a shift."""
        for pace in PRICED:
            self._made(dict.fromkeys(self.cell.humans, pace), 1.0)

    @cached_property
    def _stated(self) -> Instance:
        return Instance.of(self.cell)


def awaited(situation: Situation) -> dict[str, float]:
    """Task that can be done in no way without what is broken or missing -> when that is taken to be
    there again, s since the product's beginning. It stays the same while time runs up to it, so
    that models can be kept.
    """
    found = {}
    for task in situation.cell.tasks if situation.stock else ():
        since = _lacking_since(situation, task).values()
        if since and None not in since:
            found[task] = min(_back(one, situation) for one in since if one is not None)
    return found


def _lacking(situation: Situation) -> frozenset[tuple[str, tuple[str, ...]]]:
    """Ways, as (task, operators), for which something is broken or missing while their task can be
    done in another one.
    """
    return frozenset(
        (task, operators)
        for task in (situation.cell.tasks if situation.stock else ())
        if None in (ways := _lacking_since(situation, task)).values()
        for operators, since in ways.items()
        if since is not None
    )


def _lacking_since(situation: Situation, task: str) -> dict[tuple[str, ...], float | None]:
    """Who can do the task -> since when something that they need for it is broken or missing, s of
    the shift's clock; None where they have it all.
    """
    stock = situation.stock
    return {
        way.operators: max(
            (stock[thing] for thing in lacks(situation, task, way.operators)), default=None
        )
        for way in situation.facts.ways[task]
    }


def _back(since: float, situation: Situation) -> float:
    ahead = BACK_S
    while since + ahead <= situation.clock:
        ahead *= 2
    return exact(since + ahead - situation.began)


def _later(moves: Moves, waits: Mapping[str, float]) -> Moves:
    """The same moves, with tasks that cannot begin before these seconds."""
    instance = moves.layout.instance
    release = tuple(
        max(ticks, round(waits.get(task, 0.0) * instance.per_second))
        for task, ticks in zip(instance.tasks, instance.release, strict=True)
    )
    layout = Layout.of(replace(instance, release=release))
    return replace(moves, layout=layout, _ready={}, _rest={})


def _refused(situation: Situation) -> frozenset[tuple[str, str]]:
    return frozenset(pair for pair in situation.refused if situation.is_refused(*pair))


def position(moves: Moves, situation: Situation, factor: Mapping[str, float]) -> Position:
    """Where the assembly stands when each human needs `factor` times the stated time (1 for who is
    not named). What is overdue ends soon.
    """
    cell, bit = moves.instance, {name: 1 << t for t, name in enumerate(moves.instance.tasks)}
    wrong = sum(bit[task] for task in situation.wrong)
    done = sum(bit[task] for task in situation.done) | wrong
    done |= sum(bit[task] for task, at in situation.running.items() if at.undoing)
    wrong |= sum(bit[task] for task, at in situation.running.items() if at.undoing)
    running = []
    for task, at in situation.running.items():
        way = moves.flat(task, at.operators)
        if way is not None:
            running.append(
                (way + moves.count if at.undoing else way, ticks_left(moves, situation, at, factor))
            )
    busy = {who for at in situation.running.values() for who in at.operators}
    for number, name in enumerate(cell.operators):
        if name in (situation.absent | situation.failed) - busy:
            running.append((2 * moves.count + number, round(AWAY_S * cell.per_second)))
    return Position(
        done,
        tuple(sorted(running)),
        wrong & done,
        0 if moves.timeless else round(situation.now * cell.per_second),
        _stances(cell, situation) if cell.has_preparations else (),
        _taken(moves, situation) if cell.has_limits else (),
        _teams(cell, situation) if cell.has_teams else (),
        _waits(cell, situation) if cell.has_lags else (),
    )


def _waits(instance: Instance, situation: Situation) -> tuple[tuple[int, int], ...]:
    """The waits of open tasks that last still."""
    number = {
        (lag.before, lag.task, lag.from_start): place for place, lag in enumerate(instance.lags)
    }
    index = {name: task for task, name in enumerate(instance.tasks)}
    found = []
    for name in situation.open:
        for wait in situation.cell.tasks[name].wait if name not in situation.wrong else ():
            moment = waited_from(situation, wait)
            if moment is not None:
                left = round((moment + wait.at_least - situation.now) * instance.per_second)
                key = (index[wait.after], index[name], wait.between == "start-start")
                if left > 0:
                    found.append((number[key], left))
    return tuple(sorted(found))


def start_by(instance: Instance, situation: Situation) -> dict[int, int]:
    """Open task -> ticks from now by which it should start, for the most that it waits after what
    has ended or started; less than 0 where that is over.
    """
    found: dict[int, int] = {}
    for task, name in enumerate(instance.tasks):
        for wait in situation.cell.tasks[name].wait if name in situation.open else ():
            moment = waited_from(situation, wait)
            if moment is not None and wait.at_most is not None:
                left = round((moment + wait.at_most - situation.now) * instance.per_second)
                found[task] = min(left, found.get(task, left))
    return found


def allowed(moves: Moves, situation: Situation) -> frozenset[int]:
    """The ways, of doing and of taking apart, that the situation lets begin now: what deciders
    choose among.

    `Moves.legal` says more where nobody is left for a task but who refuses it, or where what is
    left would break a limit of stress; and less of a changeover, whose idle time before it does not
    credit.
    """
    return frozenset(numbered(moves, situation, legal(situation)))


def numbered(moves: Moves, situation: Situation, starts: Iterable[Start]) -> tuple[int, ...]:
    """The ways as `Moves` numbers them; of a task that is mounted wrongly, its taking apart."""
    named = ((task, moves.flat(task, operators)) for task, operators in starts)
    return tuple(
        way + moves.count if task in situation.wrong else way
        for task, way in named
        if way is not None
    )


def if_all_return(moves: Moves, here: Position) -> Position:
    """The position if everybody who is away came back at once: what bounds are reckoned from."""
    away = round(AWAY_S * moves.instance.per_second)
    running = tuple(
        (way, max(1, left - away) if left > away else left)
        for way, left in here.running
        if way < 2 * moves.count
    )
    return here._replace(running=running)


def ticks_left(moves: Moves, situation: Situation, at: Running, factor: Mapping[str, float]) -> int:
    """How long the running work is still expected to take, at least a tick."""
    slowest = max(factor.get(who, 1.0) for who in at.operators)
    since = situation.now if at.rests_since is None else at.rests_since
    left = at.stated * slowest - (since - at.start - at.rested)
    away = AWAY_S if at.rests_since is not None else 0.0
    return max(
        1,
        round((left if left > 0 else OVERDUE * at.stated) * moves.instance.per_second)
        + round(away * moves.instance.per_second),
    )


def cost_so_far(objective: Objective, situation: Situation) -> float:
    """What the objective has counted until now."""
    return objective.cost(situation.now, situation.stress)


def _stances(instance: Instance, situation: Situation) -> tuple[int, ...]:
    held, stands = situation.in_hand, situation.stands
    places = {name: number for number, name in enumerate(instance.places)}
    return tuple(
        instance.stance(
            instance.tools.index(held[name]) if name in held else None,
            places.get(stands.get(name, "")),
        )
        for name in instance.operators
    )


def _taken(moves: Moves, situation: Situation) -> tuple[int, ...]:
    """What stands and runs has taken of allowances. What must come off does not count: it is
    counted when it is done again.
    """
    begun = {task: work.operators for task, work in situation.done.items()}
    begun |= {task: at.operators for task, at in situation.running.items() if not at.undoing}
    ways = (moves.flat(task, operators) for task, operators in begun.items())
    return tuple(moves.instance.taken(moves.modes[way] for way in ways if way is not None))


def _teams(instance: Instance, situation: Situation) -> tuple[tuple[int, int], ...]:
    number = {name: o for o, name in enumerate(instance.operators)}
    team = dict(zip(instance.tasks, instance.team, strict=True))
    begun = {task: work.operators for task, work in situation.done.items()}
    begun |= {task: at.operators for task, at in situation.running.items() if not at.undoing}
    found = {
        team[task]: bits(number[who] for who in operators)
        for task, operators in begun.items()
        if team[task] >= 0
    }
    return tuple(sorted(found.items()))
