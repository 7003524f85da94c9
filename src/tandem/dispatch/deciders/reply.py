"""A choice in whole numbers as a decision in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from time import perf_counter

from tandem.dispatch.deciders.beliefs import if_all_return
from tandem.dispatch.deciders.policy import Alternative, Decision, Start
from tandem.dispatch.deciders.words import phrase
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.transitions import beginning

Ranked = Sequence[tuple[tuple[int, ...], float | None]]
"""Choices (sets of ways that could begin now), best first, each with the cost of the whole assembly
that it is reckoned to come to.
"""

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
    because: str,
    later: Mapping[str, str] | None = None,
    look_again: float | None = None,
) -> Decision:
    """The decision to begin these ways now: robots are told, humans are asked, and `why` names what
    begins.

    What the situation does not allow is left out here at the latest, of what begins and of what is
    said alike.

    Args:
      because: what follows what begins in `why`, without the full stop.
      later: human who is busy -> the task that it will be asked for next.
      began: the `perf_counter` moment at which deciding began.
    """
    wanted = [moves.named(way) for way in choice]
    begins = beginning(situation, wanted)
    humans = set(situation.cell.humans)
    # who is busy is told what comes next, and who begins now what that is
    announced = {
        who: task
        for who, task in (later or {}).items()
        if _may_be_next(situation, begins, who, task)
    }
    announced |= {who: task for task, operators in begins for who in operators if who in humans}
    # a bound must hold whatever happens, so those who are away count as if they came back
    ticks, _ = moves.floor(
        if_all_return(moves, position) if situation.absent or situation.failed else position
    )
    whole = begins == wanted
    # the expected cost is that of the whole choice; of a part of it nothing is known
    cost = (
        next((cost for ways, cost in ranked if tuple(ways) == tuple(choice)), None)
        if whole
        else None
    )
    ground = because if whole else "what is allowed now of the choice of " + by
    return Decision(
        starts=tuple(start for start in begins if not humans.issuperset(start[1])),
        announced=announced,
        alternatives=tuple(
            Alternative(tuple(moves.named(way) for way in ways), cost)
            for ways, cost in ranked[:MOST_ALTERNATIVES]
        ),
        bound=ticks / moves.instance.per_second,
        why=f"{phrase(situation, begins)}: {ground}.",
        by=by,
        latency_ms=1000 * (perf_counter() - began),
        expected_cost=cost,
        look_again=look_again,
        asks=tuple(start for start in begins if humans.intersection(start[1])),
    )


def begins(
    situation: Situation,
    starts: Sequence[Start],
    *,
    by: str,
    because: str,
    look_again: float | None = None,
) -> Decision:
    """The decision to begin these now, each a task and the operators who do it together; what is
    not possible, or not beside what stands before it, is left out. Robots are told, humans asked.

    Args:
      by: name of the decider. `because`: what follows what begins in `why`, without the full stop.
      look_again: when (s) to ask again although nothing has happened.
    """
    now, humans = beginning(situation, list(starts)), set(situation.cell.humans)
    return Decision(
        starts=tuple(start for start in now if not humans.issuperset(start[1])),
        announced={who: task for task, operators in now for who in operators if who in humans},
        alternatives=(Alternative(tuple(now), None),),
        bound=0.0,
        why=f"{phrase(situation, now)}: {because}.",
        by=by,
        look_again=look_again,
        asks=tuple(start for start in now if humans.intersection(start[1])),
    )


def _may_be_next(situation: Situation, begins: Sequence[Start], who: str, task: str) -> bool:
    """Whether the human can be asked for the task later: it is open, nobody begins it now, and it
    was not refused.
    """
    taken = any(task == other for other, _ in begins)
    return task in situation.open and not taken and not situation.is_refused(who, task)
