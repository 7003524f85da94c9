"""Robot and human side by side (`envs/duo`) as a world to learn in, and episodes under trained
networks.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, Self

import jax
import jax.numpy as jnp

from tandem.cell.model import Cell
from tandem.lab.zhang2022 import world as rules
from tandem.lab.zhang2022.ddpg import legal_pairs, random_pairs
from tandem.lab.zhang2022.pairs import Networks, choose
from tandem.lab.zhang2022.setting import AGENTS, HUMAN, Duo, Setting
from tandem.lab.zhang2022.setting import duo as duo_of
from tandem.lab.zhang2022.world import Paid, State
from tandem.learn.world import StageValues, StepResult

Array = Any


@partial(jax.tree_util.register_dataclass, data_fields=["duo", "setting"], meta_fields=[])
@dataclass(frozen=True)
class DuoWorld:
    """A cell of one robot and one human, and what counts in it. The human, row 1, names first."""

    duo: Duo
    setting: Setting

    @property
    def agents(self) -> tuple[str, ...]:
        return AGENTS

    @property
    def actions(self) -> int:
        return int(self.duo.pick.shape[-2])

    @property
    def observation_size(self) -> int:
        return rules.observation_size(self.duo)

    @classmethod
    def of(cls, cell: Cell, setting: Setting) -> Self:
        """The cell as arrays on the device. Raises CellError for what two agents side by side
        cannot express.
        """
        return cls(*jax.tree.map(jnp.asarray, (duo_of(cell)[0], setting)))

    def reset(self, key: Array) -> State:
        uniform = jax.random.uniform(key, (self.duo.arrays.release.shape[0] + 4,))
        numbers = {
            "normal": jax.scipy.special.ndtri(jnp.clip(uniform[4:], 1e-6, 1 - 1e-6)),
            "uniform": uniform[:4],
        }
        return rules.reset(self.duo, *rules.chance(numbers, self.duo, self.setting))

    def observe(self, state: State) -> Array:
        seen = rules.observe(self.duo, state)
        return jnp.stack([seen, seen])

    def legal(self, state: State) -> Array:
        return rules.choices(self.duo, state)

    def narrow(self, state: State, legal: Array, action: Array) -> Array:
        return jnp.stack([rules.narrow(self.duo, state, legal, action[HUMAN]), legal[HUMAN]])

    def step(self, state: State, action: Array) -> tuple[State, StepResult]:
        after, paid = rules.step(self.duo, self.setting, state, action)
        return after, StepResult(
            -rules.cost(self.setting, paid) / self.setting.unit,
            rules.is_done(after),
            jnp.zeros(2, jnp.int32),
        )

    def in_stage(self, stage: StageValues) -> Self:
        return self


class Played(NamedTuple):
    """`E` episodes.

    state: the worlds' last states. paid: the sums of what was paid. deviations: `[E]` int32, how
    often the human did not do what it was shown. done: `[E]` bool. steps: `[E]` int32. action,
    shown: `[limit, E, 2]` int32, what was done and what the policy wanted; 0 after the end. clock:
    `[limit, E]` int32, ticks. changed: the state just after the change, where there was one, and
    `before`: what had been paid until then.
    """

    state: State
    paid: Paid
    deviations: Array
    done: Array
    steps: Array
    action: Array
    shown: Array
    clock: Array
    changed: State
    before: Paid


def play(
    key: Array,
    networks: Networks | None,
    duo: Duo,
    settings: Setting,
    deviates: Array,
    candidates: int,
    activation: str,
    limit: int,
) -> Played:
    """Episodes, one a setting, in which the pair of the highest value is taken; with `networks`
    None a random legal pair.

    The same key gives the same chances whatever the networks are.

    Args:
      settings: leading axis `E`.
      deviates: `[E]`, probability at each of the human's decisions that it does one of the
        operations it could begin, each equally likely, whatever it was shown. The robot sees that
        and chooses again.
      candidates, activation: as in the training's `Config`.
      limit: steps after which an episode that has not ended is left.
    """
    world, episodes = DuoWorld(duo, settings), deviates.shape[0]
    reset_key, draw_key = jax.random.split(key)
    uniform = jax.random.uniform(draw_key, (limit, episodes, 3))
    keys = jax.random.split(reset_key, episodes)
    state = jax.vmap(lambda key, setting: DuoWorld(duo, setting).reset(key))(keys, settings)
    none = Paid(jnp.zeros(episodes), jnp.zeros((episodes, 2)), jnp.zeros(episodes))
    number = jnp.zeros(episodes, jnp.int32)
    actions = jnp.zeros((limit, episodes, 2), jnp.int32)
    empty = Played(
        state,
        none,
        number,
        jnp.zeros(episodes, bool),
        number,
        actions,
        actions,
        jnp.zeros((limit, episodes), jnp.int32),
        state,
        none,
    )

    def chosen(seen: Array, pairs: Array, uniform: Array) -> Array:
        if networks is None:
            return random_pairs(uniform[None], pairs[None])[0]
        return choose(jnp, networks, seen, pairs, candidates, activation)

    def decided(
        seen: Array, pairs: Array, draws: Array, deviates: Array
    ) -> tuple[Array, Array, Array]:
        wanted = chosen(seen, pairs, draws[2])
        begins = jnp.any(pairs, 0) & (jnp.arange(pairs.shape[0]) > 0)
        count = jnp.sum(begins)
        own = jnp.sum(jnp.cumsum(begins) <= draws[1] * count)
        strays = (draws[0] < deviates) & (count > 0) & (own != wanted[HUMAN])
        left = pairs & ((jnp.arange(pairs.shape[0]) == own)[None, :] | ~strays)
        return jnp.where(strays, chosen(seen, left, draws[2]), wanted), wanted, strays

    def one(carry: tuple[Array, Played]) -> tuple[Array, Played]:
        index, so_far = carry
        state, on = so_far.state, ~so_far.done
        pairs = jax.vmap(partial(legal_pairs, world))(state)
        action, shown, strays = jax.vmap(decided)(
            jax.vmap(world.observe)(state), pairs, uniform[index], deviates
        )
        after, paid = jax.vmap(partial(rules.step, duo))(settings, state, action)
        keep = lambda new, old: jnp.where(on.reshape(-1, *[1] * (old.ndim - 1)), new, old)  # noqa: E731
        total = jax.tree.map(lambda sum_, more: keep(sum_ + more, sum_), so_far.paid, paid)
        after = jax.tree.map(keep, after, state)
        return index + 1, so_far._replace(
            state=after,
            paid=total,
            deviations=so_far.deviations + (strays & on),
            done=so_far.done | jax.vmap(rules.is_done)(after),
            steps=so_far.steps + on,
            action=so_far.action.at[index].set(jnp.where(on[:, None], action, 0)),
            shown=so_far.shown.at[index].set(jnp.where(on[:, None], shown, 0)),
            clock=so_far.clock.at[index].set(jnp.where(on, state.assembly.clock, 0)),
            **_at_the_change(so_far, after, total),
        )

    goes_on = lambda carry: (carry[0] < limit) & ~jnp.all(carry[1].done)  # noqa: E731
    return jax.lax.while_loop(goes_on, one, (jnp.zeros((), jnp.int32), empty))[1]


def _at_the_change(so_far: Played, after: State, total: Paid) -> dict[str, Any]:
    """The first state in which a change has happened, and what had been paid."""
    here = (after.happened.kind > 0) & (so_far.changed.happened.kind == 0)
    pick = lambda new, old: jnp.where(here.reshape(-1, *[1] * (old.ndim - 1)), new, old)  # noqa: E731
    return {
        "changed": jax.tree.map(pick, after, so_far.changed),
        "before": jax.tree.map(pick, total, so_far.before),
    }
