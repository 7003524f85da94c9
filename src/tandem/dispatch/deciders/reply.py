"""A choice in whole numbers as a decision in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from time import perf_counter

from tandem.dispatch.deciders.policy import Alternative, Decision
from tandem.dispatch.deciders.seen import if_all_return
from tandem.dispatch.situation.legal import legal
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.values.moves import Moves, Position

Ranked = Sequence[tuple[tuple[int, ...], float | None]]
"""Choices (sets of ways that could begin now), best first, each with the cost of the whole assembly that it is reckoned to come to."""

MOST_ALTERNATIVES = 8


def reply(
    by: str,
    moves: Moves,
    situation: Situation,
    position: Position,
    choice: Sequence[int],
    ranked: Ranked,
    *,
    began: float,
    why: str,
    later: Mapping[str, str] | None = None,
    look_again: float | None = None,
) -> Decision:
    """The decision to begin these ways now: robots are told, humans are asked.

    `later`: human who is busy -> the task it will be asked for next. `began`: the `perf_counter` moment at which deciding began.
    """
    may = set(legal(situation))
    chosen = [way for way in choice if moves.named(way) in may]
    names = moves.instance.operators
    announced = dict(later or {})
    for way in chosen:
        for o, name in enumerate(names):
            if moves.who[way] >> o & 1 and moves.human >> o & 1:
                announced[name] = moves.named(way)[0]
    ticks, _ = moves.floor(if_all_return(moves, position) if situation.absent or situation.failed else position)
    cost = next((cost for ways, cost in ranked if tuple(ways) == tuple(choice)), None)
    return Decision(
        starts=tuple(moves.named(way) for way in chosen if moves.who[way] & ~moves.human),
        announced=announced,
        alternatives=tuple(Alternative(tuple(moves.named(way) for way in ways), cost) for ways, cost in ranked[:MOST_ALTERNATIVES]),
        bound=ticks / moves.per_second,
        why=why,
        by=by,
        latency_ms=1000 * (perf_counter() - began),
        expected_cost=cost,
        look_again=look_again,
        asks=tuple(moves.named(way) for way in chosen if moves.who[way] & moves.human),
    )


def phrase(moves: Moves, choice: Sequence[int]) -> str:
    """A choice for people: "robot does 4, human is asked for 3"; "everybody waits"."""
    if not choice:
        return "everybody waits"
    parts = []
    for way in choice:
        task, operators = moves.named(way)
        verb = "is asked for" if moves.who[way] & moves.human else "does"
        undo = "taking apart " if way >= moves.count else ""
        parts.append(f"{' and '.join(operators)} {verb} {undo}{task}")
    return ", ".join(parts)
