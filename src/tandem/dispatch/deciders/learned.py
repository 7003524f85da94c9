"""`learned`: what `tandem train` learned, by whichever algorithm: a network in NumPy; where nothing
was trained, the policy for any cell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.deciders.any_cell import any_cell
from tandem.dispatch.deciders.beliefs import Models, allowed, position
from tandem.dispatch.deciders.policy import Decision, Options, Policy
from tandem.dispatch.deciders.reply import Ranked, reply
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.transitions import Moves
from tandem.dispatch.situation.model import Situation
from tandem.learn.algorithm import Learnt
from tandem.learn.graph.trained import KIND
from tandem.learn.training.algorithms import decider_of, origin_of
from tandem.learn.training.runs import RunFolder
from tandem.world import state as world
from tandem.world.arrays import NEVER, Arrays, Names
from tandem.world.state import State

AWAY_S = 60.0
"""ASSUMPTION: who is away is taken to be back in so many seconds."""


def learned(cell: Cell, objective: Objective, options: Options) -> Policy:
    """The policy in `options.learned`: a file, or the folder of a run (its best seed then). The
    policy for any cell that comes with Tandem where none is named.

    Raises:
      UsageError: it does not fit the cell, or its world knows no events.
      CellError: the file is no policy, or the world cannot hold the cell.
    """
    if options.learned is None:
        return any_cell(cell, objective, options)
    path = Path(options.learned)
    if path.is_dir():
        run = RunFolder(path)
        path = run.policy(run.best_seed())
    if origin_of(path)[0] == KIND:
        return any_cell(cell, objective, options, path)
    names = Names.of(cell)
    found = decider_of(path, cell)
    return Learned(found, names, names.arrays(undo=1.0), Models(cell, objective.max_stress))


@dataclass(frozen=True)
class Learned:
    """A trained policy. Whose turn it is at a moment: the humans first, then the robots, each
    seeing what those before were asked for.
    """

    learnt: Learnt
    names: Names
    arrays: Arrays
    models: Models
    name: str = "learned"

    def decide(self, situation: Situation) -> Decision:
        """What the network is most for."""
        began = perf_counter()
        moves = self.models.of(situation, 1.0)
        choice, ranked = self._choose(moves, situation)
        because = "what the trained policy is most for"
        if ranked and self.learnt.believes:
            because += f" ({100 * ranked[0][1]:.0f} % of its belief among {len(ranked)} choices)"
        elif ranked:
            because += f", among {len(ranked)} choices"
        costless: Ranked = [(ways, None) for ways, _ in ranked]
        return reply(
            self.name,
            moves,
            situation,
            position(moves, situation, {}),
            choice,
            costless,
            began=began,
            because=because,
        )

    def _choose(
        self, moves: Moves, situation: Situation
    ) -> tuple[tuple[int, ...], list[tuple[tuple[int, ...], float]]]:
        """The ways to begin, and the first one's alternatives with the network's belief in each."""
        ranked: list[tuple[tuple[int, ...], float]] = []

        def choose(turn: Turn) -> int:
            nonlocal ranked
            sure = self.learnt.worth(self.arrays, turn.state, turn.mask, turn.operator)
            sure[np.flatnonzero(turn.mask & ~turn.may)] = -np.inf
            ranked = ranked or self._ranked(moves, turn.state, sure)
            return int(np.argmax(sure)) if (sure > -np.inf).any() else WAIT

        return turn_by_turn(self.names, self.arrays, moves, situation, choose), ranked

    def _ranked(self, moves: Moves, state: State, sure: Any) -> list[tuple[tuple[int, ...], float]]:
        share = np.exp(sure - sure.max())
        share = share / share.sum()
        order = [way for way in np.argsort(-share, kind="stable").tolist() if sure[way] > -np.inf]
        return [
            (
                () if way == len(sure) - 1 else (number(self.names, moves, state, way),),
                float(share[way]),
            )
            for way in order
        ]


WAIT = -1
"""What `turn_by_turn` is told where whoever's turn it is lets it pass; the last way, counted from
the end, as networks have it.
"""


@dataclass(frozen=True)
class Turn:
    """Whose turn it is at a moment, and what stands open.

    Attributes:
      state: how the assembly stands, with what those before were asked for.
      operator: whose turn it is.
      mask: `[W]` bool, what may begin by the world's rules; `may`: by the situation, too.
    """

    state: State
    operator: int
    mask: Any
    may: Any


def turn_by_turn(
    names: Names,
    arrays: Arrays,
    moves: Moves,
    situation: Situation,
    choose: Callable[[Turn], int],
) -> tuple[int, ...]:
    """The ways that begin now, as `moves` counts them: at a moment the humans choose first, then
    the robots, each once. `choose` gives one of the cell's ways, or `WAIT`.
    """
    state, allowed_now = state_of(names, arrays, situation), allowed(moves, situation)
    chosen: list[int] = []
    for _ in range(len(situation.cell.operators)):
        mask = np.asarray(world.legal(arrays, state))
        operator = int(world.turn(arrays, mask))
        if operator < 0:
            break
        may = np.zeros_like(mask)
        for way in np.flatnonzero(mask).tolist():
            may[way] = number(names, moves, state, way) in allowed_now
        way = choose(Turn(state, operator, mask, may))
        if way in (WAIT, len(names.ways)):
            state = world.wait(state, operator)
            continue
        chosen.append(number(names, moves, state, way))
        state = world.assign(arrays, state, way)
    return tuple(chosen)


def number(names: Names, moves: Moves, state: State, way: int) -> int:
    """The world's way as `moves` counts it; of a task that has to come off, its taking apart."""
    task, mode = names.ways[way]
    flat = moves.flat(task, mode.operators)
    assert flat is not None  # both count the ways of the same cell
    return flat + moves.count if state.way[names.tasks.index(task)] >= 0 else flat


def state_of(names: Names, arrays: Arrays, situation: Situation) -> State:
    """The situation as the world holds it. The end of work in hand is not known: it lies after the
    clock, by the stated time or a tick from now.
    """
    clock, state = names.ticks(situation.now), world.reset(arrays)
    free, away = state.free_at.copy(), state.away_until.copy()
    way, start, end, bad, undoing = (
        part.copy()
        for part in (state.way, state.start_at, state.end_at, state.bad_at, state.undoing)
    )
    # rests are cut off at the front: the world reckons the pace from what the task really took
    for task, work in {**situation.done, **situation.wrong}.items():
        t = names.tasks.index(task)
        way[t] = names.way(task, work.operators)
        start[t], end[t] = names.ticks(work.start + work.rested), names.ticks(work.end)
        bad[t] = 0 if task in situation.wrong else NEVER
        for who in work.operators:
            free[names.operators.index(who)] = max(free[names.operators.index(who)], end[t])
    # overdue work is about to end: a tick from now, or the world would take it for done
    for task, running in situation.running.items():
        t = names.tasks.index(task)
        way[t], undoing[t] = names.way(task, running.operators), running.undoing
        start[t], end[t] = (
            names.ticks(running.start + running.rested),
            max(clock + 1, names.ticks(running.expected_end)),
        )
        for who in running.operators:
            free[names.operators.index(who)] = end[t]
    # nobody knows when someone comes back: the assumption stands at `AWAY_S`
    for who in situation.absent | situation.failed:
        away[names.operators.index(who)] = clock + names.ticks(AWAY_S)
    refused = [
        any(situation.is_refused(who, task) for who in mode.operators) for task, mode in names.ways
    ]
    places = {name: number for number, name in enumerate(names.places)}
    return state._replace(
        clock=np.int32(clock),
        way=way,
        start_at=start,
        end_at=end,
        free_at=free,
        away_until=away,
        in_hand=np.array(
            [
                names.tools.index(situation.in_hand[who]) if who in situation.in_hand else -1
                for who in names.operators
            ],
            np.int32,
        ),
        stands=np.array(
            [places.get(situation.stands.get(who, ""), -1) for who in names.operators],
            np.int32,
        ),
        load=np.array(
            [round(situation.load.get(who, 0.0) * names.per_stress) for who in names.operators],
            np.int32,
        ),
        refused=np.array(refused),
        bad_at=bad,
        undoing=undoing,
    )
