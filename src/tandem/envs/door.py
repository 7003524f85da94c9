"""The one door to every face's `step`: is an episode under way, and is what was named an action at
all.

An action is a whole number. One beyond the space is illegal, like one that the mask rules out, in
every world: it is flagged, costs what that world says an illegal action costs, and raises when
strict. What is no whole number is a mistake in the calling code and always raises.
"""

from __future__ import annotations

import operator
from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any

from gymnasium.error import ResetNeeded

from tandem.errors import UsageError

CONTROLLER = "the controller"
"""What messages call the one who acts in a face with a single controller."""

OUTSIDE = -1
"""What every number beyond the space becomes, so that no world takes it for an index."""


class NoEpisodeError(UsageError, ResetNeeded):
    """A step before the first reset or after the end. Gymnasium's `ResetNeeded`, and ours."""


class Door:
    """Stands before one face's `step`. It is shut until `reset` opens it, and shuts again when the
    episode ends.

    Args:
      sizes: agent -> how many actions it has, numbered from 0. A face with one controller has one
        entry.
      strict: a number beyond the space raises instead of becoming `OUTSIDE`.
    """

    def __init__(self, sizes: Mapping[str, int], *, strict: bool):
        self.sizes, self.strict = dict(sizes), strict
        self.is_open = self.has_opened = False

    def open(self) -> None:
        """An episode begins."""
        self.is_open = self.has_opened = True

    def shut_if(self, over: bool) -> None:
        """After an episode that is over nothing is taken, and nothing paid, until the next
        reset.
        """
        self.is_open = self.is_open and not over

    def number(self, action: Any, agent: str) -> int:
        """What the agent named, `OUTSIDE` for a number beyond its space.

        Raises:
          NoEpisodeError: no episode is under way.
          UsageError: it is no whole number, or beyond the space and the door is strict.
        """
        self._must_be_open()
        return self._number(action, agent)

    def numbers(self, actions: Any) -> dict[str, int]:
        """Every agent's action as `number` gives it.

        Raises:
          NoEpisodeError: no episode is under way.
          UsageError: with everything that is missing, unknown, no whole number or, when strict,
            beyond its space.
        """
        self._must_be_open()
        if not isinstance(actions, Mapping):
            raise UsageError(
                f"actions={actions!r}: give a table from agent to action, for"
                f" {', '.join(self.sizes)}."
            )
        faults = [
            f"no action for {agent}: every agent names one."
            for agent in self.sizes
            if agent not in actions
        ]
        for agent in actions:
            if agent not in self.sizes:
                meant = "".join(
                    f" Did you mean {near!r}?"
                    for near in get_close_matches(str(agent), self.sizes, 1)
                )
                faults.append(
                    f"an action for {agent!r}, who is no agent here.{meant} There are:"
                    f" {', '.join(self.sizes)}."
                )
        chosen = {}
        for agent in (agent for agent in self.sizes if agent in actions):
            try:
                chosen[agent] = self._number(actions[agent], agent)
            except UsageError as error:
                faults.append(str(error))
        if faults:
            raise UsageError("\n".join(faults))
        return chosen

    def _must_be_open(self) -> None:
        if not self.is_open:
            when = "this episode has ended" if self.has_opened else "no episode has begun"
            raise NoEpisodeError(f"{when}: call reset() before step().")

    def _number(self, action: Any, agent: str) -> int:
        last = self.sizes[agent] - 1
        try:
            number = operator.index(action)
        except (TypeError, ValueError, RuntimeError):
            # arrays of any library say in their own way that they are no index
            raise UsageError(
                f"{agent} named {_shown(action)}, no whole number: give one of 0 to {last}."
            ) from None
        if 0 <= number <= last:
            return number
        if self.strict:
            raise UsageError(
                f"illegal: {agent} named {_shown(number)}, and the actions are 0 to {last}. Take an"
                " action from action_masks()."
            )
        return OUTSIDE


def is_legal(mask: Any, number: int) -> bool:
    """Whether the mask (`[A]`, 1 = legal) allows what `Door.number` gave; never for `OUTSIDE`."""
    return number != OUTSIDE and bool(mask[number])


def _shown(action: Any) -> str:
    text = repr(action)
    return text if len(text) <= 60 else f"{text[:57]}..."
