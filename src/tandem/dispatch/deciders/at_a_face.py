"""Policies that somebody trained at the standard faces of the event world, as deciders: what SB3,
torch or a loop of one's own learned there is judged beside people and decides live.

Such a policy sees at each turn what it saw at its face, worked out from what has been seen of the
shift alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import Models, position
from tandem.dispatch.deciders.learned import WAIT, Turn, state_of, turn_by_turn
from tandem.dispatch.deciders.policy import Decision
from tandem.dispatch.deciders.reply import reply
from tandem.dispatch.lookahead.objective import SECONDS, Objective
from tandem.dispatch.situation.model import Situation
from tandem.envs.cells import Room
from tandem.envs.door import is_legal
from tandem.envs.game import agents_of, mask_of, ways_of
from tandem.envs.observations import observe
from tandem.errors import UsageError
from tandem.world import state as world
from tandem.world.arrays import Arrays, Names

Seen = Mapping[str, Any]
"""As at the faces: `observation` float32 and `action_mask` int8, 1 = legal; action 0 waits, action
i is the cell's i-th way.
"""


def of_gymnasium(
    cell: Cell,
    act: Callable[[Seen], Any],
    *,
    name: str = "own",
    asks: bool = True,
    room: Room | None = None,
    objective: Objective = SECONDS,
) -> AtGymnasium:
    """A policy that was trained at "tandem/RobotBesideHuman-v0".

    Args:
      act: the action for what is seen; of SB3's models `lambda seen: model.predict(seen,
        deterministic=True)[0]`. The same observation has to give the same action.
      asks: as it was trained: with False people are never its turn.
      room: as it was trained; of a face of several cells `env.unwrapped.cells.room`.
      objective: its `max_stress` limits what is offered.

    Raises CellError for a cell that the world cannot hold.
    """
    return AtGymnasium(act, Face.of(cell, room), Models(cell, objective.max_stress), name, asks)


def of_pettingzoo(
    cell: Cell,
    act: Callable[[str, Seen], Any],
    *,
    name: str = "own",
    room: Room | None = None,
    objective: Objective = SECONDS,
) -> AtPettingZoo:
    """Policies that were trained at `parallel_env("events", cell)`.

    Args:
      act: the action of an agent (`robot_0`, `human_0`, ...) for what it sees. Robots do theirs,
        people are asked for theirs.
      room: as they were trained; of a face of several cells `env.cells.room`.
      objective: its `max_stress` limits what is offered.

    Raises CellError for a cell that the world cannot hold.
    """
    face = Face.of(cell, room)
    agents = {operator: agent for agent, operator in agents_of(face.names).items()}
    return AtPettingZoo(act, face, Models(cell, objective.max_stress), name, agents)


@dataclass(frozen=True)
class Face:
    """What a face shows of a cell.

    Attributes:
      own: the size of the cell. `room`: what is seen is padded to it; None: it is not.
      ways: `[3, W]`, see `envs.game.ways_of`.
    """

    names: Names
    arrays: Arrays
    own: Room
    room: Room | None
    ways: Any

    @classmethod
    def of(cls, cell: Cell, room: Room | None) -> Face:
        """Raises UsageError for a cell that has no room."""
        names = Names.of(cell)
        arrays, own = names.arrays(undo=1.0), Room.of(names)
        if room is not None and (lacks := room.lacks(own)):
            raise UsageError(f"cell {cell.name!r}: has {lacks}; the policy was trained for less.")
        return cls(names, arrays, own, room, ways_of(arrays))

    def seen(self, turn: Turn, operator: int) -> dict[str, Any]:
        """What the operator sees, its mask without what the situation forbids besides."""
        seen = np.asarray(observe(self.arrays, turn.state, turn.mask, np.int32(operator)))
        mask = mask_of(self.arrays, turn.state, turn.may, operator)
        if self.room is not None:
            seen = self.room.padded(seen, self.own, self.ways)
            mask = self.room.masked(mask)
        return {"observation": seen, "action_mask": mask}


@dataclass(frozen=True)
class AtGymnasium:
    """One controller that is asked turn by turn: people first, each seeing what those before were
    asked for.
    """

    act: Callable[[Seen], Any]
    face: Face
    models: Models
    name: str
    asks: bool

    def decide(self, situation: Situation) -> Decision:
        """What the policy does at its face, seeing this."""
        began, moves = perf_counter(), self.models.of(situation, 1.0)
        chosen = turn_by_turn(self.face.names, self.face.arrays, moves, situation, self._choose)
        here = position(moves, situation, {})
        return reply(
            self.name,
            moves,
            situation,
            here,
            chosen,
            [(chosen, None)],
            began=began,
            because=f"by the policy {self.name!r}",
        )

    def _choose(self, turn: Turn) -> int:
        arrays = self.face.arrays
        if not self.asks and arrays.human[turn.operator]:
            mine = np.flatnonzero(world.legal_of(arrays, turn.may, np.int32(turn.operator)))
            return max(
                mine.tolist(),
                key=lambda way: (arrays.tail[arrays.way_task[way]], -way),
                default=WAIT,
            )
        seen = self.face.seen(turn, turn.operator)
        action = whole(self.name, self.act(seen))
        return first_legal(seen) if not is_legal(seen["action_mask"], action) else action - 1


@dataclass(frozen=True)
class AtPettingZoo:
    """Agents that act at the same time: each sees the moment before anybody has begun anything in
    it. What an earlier one has taken away counts as waiting.

    Attributes:
      agents: operator -> agent.
    """

    act: Callable[[str, Seen], Any]
    face: Face
    models: Models
    name: str
    agents: Mapping[int, str]

    def decide(self, situation: Situation) -> Decision:
        """What the agents do at their face, seeing this. Where all wait although nothing else is to
        come, they want to be asked again after a second; in the judge's world the last of them
        begins something instead.
        """
        began, moves = perf_counter(), self.models.of(situation, 1.0)
        actions = self._actions(situation)
        chosen = turn_by_turn(
            self.face.names,
            self.face.arrays,
            moves,
            situation,
            lambda turn: self._taken(turn, actions),
        )
        return reply(
            self.name,
            moves,
            situation,
            position(moves, situation, {}),
            chosen,
            [(chosen, None)],
            began=began,
            because=f"by the policies {self.name!r}",
            look_again=None if chosen or situation.running else situation.now + 1.0,
        )

    def _actions(self, situation: Situation) -> dict[int, int]:
        """What each agent names, seeing the moment as it began."""
        before = {task: at for task, at in situation.running.items() if at.start < situation.now}
        names, arrays = self.face.names, self.face.arrays
        state = state_of(names, arrays, replace(situation, running=before))
        mask = np.asarray(world.legal(arrays, state))
        turn = Turn(state, int(world.turn(arrays, mask)), mask, mask)
        return {
            operator: whole(f"{self.name}, {agent}", self.act(agent, seen))
            for operator, agent in self.agents.items()
            for seen in [self.face.seen(turn, operator)]
        }

    def _taken(self, turn: Turn, actions: Mapping[int, int]) -> int:
        action = actions[turn.operator]
        legal = is_legal(self.face.seen(turn, turn.operator)["action_mask"], action)
        return action - 1 if legal else WAIT


def whole(name: str, action: Any) -> int:
    """The action as a whole number. Raises UsageError for what is none."""
    number = np.asarray(action)
    if number.size != 1 or not np.issubdtype(number.dtype, np.integer):
        raise UsageError(f"{name}: named {action!r}, no whole number. Give an action of the face.")
    return int(number.reshape(()))


def first_legal(seen: Seen) -> int:
    """What an illegal action counts as at the Gymnasium face: waiting, or the first legal way."""
    return int(np.flatnonzero(seen["action_mask"])[0]) - 1
