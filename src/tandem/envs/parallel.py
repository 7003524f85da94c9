"""The event world as PettingZoo wants it: every operator is an agent."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from tandem.envs.cells import AnyCells, Cells, Room
from tandem.envs.door import Door, is_legal
from tandem.envs.game import RENDER_MODES, EventGame, Options, agents_of
from tandem.envs.observations import MOST
from tandem.envs.view import View
from tandem.errors import UsageError

Observation = dict[str, NDArray[Any]]


class EventsParallel(ParallelEnv[str, Observation, int]):  # type: ignore[misc]
    """`robot_0`, `robot_1`, ..., `machine_0`, ..., `human_0`, ... in the cell's order; action
    0 waits, action i is the cell's i-th way (`game.names.ways[i - 1]`).

    A step is one moment at which somebody can begin something. The actions are taken in turn,
    humans first; what an earlier one has taken away counts as waiting for the later one, and is not
    illegal. Who names a joint way begins it for all who take part. Then time runs on until somebody
    can begin something again. When all wait although nothing else is to come, a second passes.

    `cell` may be several, as in the Gymnasium face; who is not in the cell of an episode is no
    agent of it.

    All agents are paid the same: minus the seconds that passed, less `stress_factor` for each unit
    of stress, or what `reward` says. Humans choose what they are told to choose: of `person` only
    pace, habit, fatigue and slips count. Observations, masks and illegal actions as in the
    Gymnasium face.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "events_v0",
        "render_modes": list(RENDER_MODES),
        "is_parallelizable": True,
        "render_fps": 4,
    }

    def __init__(
        self, cell: AnyCells, *, room: Room | Mapping[str, int] | None = None, **options: Any
    ):
        self.cells = Cells(cell, room)
        game = EventGame(self.cells.first(), Options(**options), free=True)
        self.view = View(game, self.cells.room)
        self.render_mode = self.game.options.render_mode
        self.operators = agents_of(self.game.names)
        self.possible_agents = self.view.possible_agents
        self.agents: list[str] = []
        actions, size = self.view.actions, self.view.size
        box = (np.zeros(size, np.float32), np.full(size, MOST, np.float32))
        self.observation_spaces = {
            agent: spaces.Dict(
                {
                    "observation": spaces.Box(*box, dtype=np.float32),
                    "action_mask": spaces.MultiBinary(actions),
                }
            )
            for agent in self.possible_agents
        }
        self.action_spaces = {agent: spaces.Discrete(actions) for agent in self.possible_agents}
        self.state_space = spaces.Box(*box, dtype=np.float32)
        self._rng = seeding.np_random(0)[0]
        self._door = self._door_of()

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """The same object at each call."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """The same object at each call."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """The first observations; people and chance are drawn anew, from the seed when it is
        given. `options={"cell": ...}` names the cell of this episode; its operators are the agents.

        Raises UsageError for a cell that does not fit into the spaces.
        """
        if seed is not None:
            self._rng = seeding.np_random(seed)[0]
        self.view = self.view.on(
            self.cells.asked(options, self.view.own) or self.cells.drawn(self._rng)
        )
        self.game.reset(self._rng)
        self.operators = agents_of(self.game.names)
        self.agents = list(self.operators)
        self._door = self._door_of()
        self._door.open()
        self._return, self._steps, self._since = 0.0, 0, time.monotonic()
        return self._observations(), {
            agent: self._info(agent, self.game.info(None, self._name(agent), False))
            for agent in self.agents
        }

    def step(
        self, actions: dict[str, int]
    ) -> tuple[
        dict[str, Observation],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """All agents act.

        Raises UsageError for an illegal action when strict, for what is no action, and after the
        end.
        """
        named, masks = self._door.numbers(actions), self.action_masks()
        game, before, agents = self.game, self.game.shift, self.agents
        # all are looked at before anything happens: a refused call leaves the game as it was
        illegal = {agent: not is_legal(masks[agent], named[agent]) for agent in agents}
        for agent in agents:
            if illegal[agent] and game.options.strict:
                raise UsageError(game.complaint(self.operators[agent], named[agent]))
        self._take({self.operators[agent]: named[agent] for agent in agents})
        happening = game.since(before, any(illegal.values()))
        reward, ended, cut = game.reward(happening), game.done, game.truncated
        self._return, self._steps = self._return + reward, self._steps + 1
        # one team, one reward: it is paid for the stretch of time, whoever acted in it
        infos = {
            agent: self._info(agent, game.info(happening, self._name(agent), illegal[agent]))
            for agent in agents
        }
        self._door.shut_if(ended or cut)
        if ended or cut:
            taken = round(time.monotonic() - self._since, 6)
            for agent in agents:
                infos[agent]["episode"] = {"r": self._return, "l": self._steps, "t": taken}
            self.agents = []
        return (
            {agent: self._observation(agent) for agent in agents},
            dict.fromkeys(agents, reward),
            dict.fromkeys(agents, ended),
            dict.fromkeys(agents, cut),
            infos,
        )

    def action_masks(self) -> dict[str, NDArray[np.int8]]:
        """Agent -> `[W + 1]` int8, 1 = legal; never all 0."""
        return {agent: self.view.mask(operator) for agent, operator in self.operators.items()}

    @property
    def game(self) -> EventGame:
        """The shift under way."""
        return self.view.game

    def state(self) -> NDArray[np.float32]:
        """What there is to see, as nobody in particular."""
        return self.view.observe(-1)

    def render(self) -> str | NDArray[np.uint8] | None:
        """The schedule so far, as the render mode says: text, pixels, or None."""
        return self.game.render()

    def close(self) -> None:
        """Nothing is held open."""

    def _take(self, chosen: dict[int, int]) -> None:
        """Each whose turn it is does what it chose, once; then time runs on."""
        game = self.game
        began, asked = game.clock, set[int]()
        while (who := game.turn) >= 0 and who not in asked:
            asked.add(who)
            action = chosen[who] if is_legal(game.mask(who), chosen[who]) else 0
            if action == 0 and not game.mask(who)[0]:
                game.pass_a_second()
                return
            game.decide(action - 1)
        game.to_a_turn()
        if game.clock == began and game.turn in asked:
            game.pass_a_second()

    def _name(self, agent: str) -> str:
        return self.game.names.operators[self.operators[agent]]

    def _observation(self, agent: str) -> Observation:
        return {
            "observation": self.view.observe(self.operators[agent]),
            "action_mask": self.view.mask(self.operators[agent]),
        }

    def _observations(self) -> dict[str, Observation]:
        return {agent: self._observation(agent) for agent in self.agents}

    def _info(self, agent: str, said: dict[str, Any]) -> dict[str, Any]:
        return {"action_mask": self.view.mask(self.operators[agent]), **said}

    def _door_of(self) -> Door:
        agents = dict.fromkeys(self.operators, self.view.actions)
        return Door(agents, strict=self.game.options.strict)
