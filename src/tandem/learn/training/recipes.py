"""The named recipes: an algorithm and its configuration, and what is trained on."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Any, ClassVar, Literal, Protocol, get_args

from pydantic import ConfigDict

from tandem.lab.kinat2023.observations import observe, observe_normalised, observe_scaled
from tandem.lab.kinat2023.rewards import REWARDS
from tandem.errors import UsageError
from tandem.learn.alphazero.recipes import ALPHAZERO, SearchRecipe
from tandem.lab.yu2020.recipe import YU_2020, YuRecipe
from tandem.learn.ppo.config import Config, Stage
from tandem.learn.dqn.recipes import DQN, ValueRecipe
from tandem.lab.yu2021.recipe import YU_2021
from tandem.learn.forms import STRICT, SettingsError
from tandem.learn.response.recipes import RESPONSE, ResponseRecipe
from tandem.learn.settings import must_hold, one_of, read

OBSERVATIONS: dict[str, Callable[..., Any]] = {"thesis": observe, "scaled": observe_scaled, "normalised": observe_normalised}
"""What a recipe's `sees` means: station and state to `[2, D]`, in NumPy and JAX alike."""


Pace = Literal["ticks", "decisions"]


class AnyRecipe(Protocol):
    """A recipe of any algorithm: frozen data that says which one, and that can be written down."""

    @property
    def algorithm(self) -> str:
        """A name in `tandem.learn.training.algorithms.ALGORITHMS`."""

    @property
    def config(self) -> Any:
        """Of the learner."""

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""


@dataclass(frozen=True)
class Recipe:
    """How PPO trains the agents of a cell with one robot and one human, on the thesis's station.

    Attributes:
      config: of the learner.
      pace: the station by "ticks" or by "decisions".
      sees: a name in `OBSERVATIONS`: the thesis's observation as it is ("thesis") or in 0..1 ("scaled"), or ours ("normalised").
      rewards: a name in `tandem.lab.kinat2023.REWARDS`. What idling costs is said by the stages.
    """

    config: Config
    pace: Pace
    sees: str
    rewards: str = "appendix"

    algorithm: ClassVar[str] = "ppo"
    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it, beside its `config`."""
        yield from one_of(self, "pace", get_args(Pace))
        yield from one_of(self, "sees", OBSERVATIONS)
        yield from one_of(self, "rewards", REWARDS)

    def to_dict(self) -> dict[str, Any]:
        return {"pace": self.pace, "sees": self.sees, "rewards": self.rewards, "config": self.config.to_dict()}


THESIS = Recipe(
    Config(
        stages=(
            Stage(episodes=800, entropy=0.7, learning_rate=1e-4, idle=-10.0, normalise_advantages=False),
            Stage(episodes=500, entropy=0.7, learning_rate=1e-4, normalise_advantages=False),
            Stage(episodes=800, entropy=0.01, learning_rate=1e-4, normalise_advantages=False),
        ),
        environments=1,
        horizon=512,
        stop_at_end=True,
        episode_limit=1400,
        minibatch=128,
        epochs=4,
        discount=1.0,
        gae=0.95,
        clip=0.2,
        value_weight=1.0,
        gradient_limit=None,
        hidden=(256, 256),
        activation="relu",
        masked=False,
        normalise_returns=False,
    ),
    pace="ticks",
    sees="thesis",
)
"""Kinat (2023), chapters 5 and 6: what is written there. What is not, as the toolbox it used has it by default: two hidden layers, ReLU, raw
advantages, learning after each episode or 512 steps, whichever comes first. (Recalled from its manual; ASSUMPTION.)"""

TANDEM = Recipe(
    Config(
        stages=(
            Stage(steps=12_288, entropy=0.1, learning_rate=2e-3),
            Stage(steps=12_288, entropy=0.05, learning_rate=2e-3),
            Stage(steps=12_288, entropy=0.01, learning_rate=1e-3),
        ),
        environments=64,
        horizon=32,
        episode_limit=400,
        minibatch=512,
        epochs=4,
        gae=1.0,
    ),
    pace="decisions",
    sees="normalised",
)
"""Ours: only legal actions, 64 stations at once, decisions instead of ticks."""

KINDS: dict[str, type[AnyRecipe]] = {"ppo": Recipe, "alphazero": SearchRecipe, "yu": YuRecipe, "dqn": ValueRecipe, "response": ResponseRecipe}
"""Algorithm -> the form of its recipes."""

RECIPES: dict[str, AnyRecipe] = {
    "tandem": TANDEM,
    "thesis": THESIS,
    "alphazero": ALPHAZERO,
    "yu2020": YU_2020,
    "dqn": DQN,
    "yu2021": YU_2021,
    "response": RESPONSE,
}
"""Name -> recipe. A new one is a line here."""


def recipe(name: str) -> AnyRecipe:
    """The recipe of that name. Raises UsageError for one that `RECIPES` does not hold."""
    if name not in RECIPES:
        meant = "".join(f" Did you mean {near!r}?" for near in get_close_matches(name, RECIPES, 1))
        raise UsageError(f"recipe {name!r}: there is none.{meant} There are: {', '.join(RECIPES)}.")
    return RECIPES[name]


def varied(base: Recipe, *, normalise_advantages: bool | None = None, sees: str | None = None, rewards: str | None = None) -> Recipe:
    """The recipe with what the thesis's text and code leave open set otherwise. Table 5-2 punishes idling in stage 1 with -11 instead of -10."""
    stages = base.config.stages
    if normalise_advantages is not None:
        stages = tuple(replace(stage, normalise_advantages=normalise_advantages) for stage in stages)
    if rewards == "table_5_2":
        stages = tuple(replace(stage, idle=-11.0 if stage.idle else 0.0) for stage in stages)
    return replace(base, config=replace(base.config, stages=stages), sees=sees or base.sees, rewards=rewards or base.rewards)


def longer(base: Recipe, factor: float) -> Recipe:
    """The recipe with `factor` times the episodes and steps in every stage; a step budget stays whole rollouts."""

    def stretched(stage: Stage) -> Stage:
        rollout = base.config.environments * base.config.horizon
        steps = stage.steps and max(1, round(stage.steps * factor / rollout)) * rollout
        return replace(stage, episodes=stage.episodes and max(1, round(stage.episodes * factor)), steps=steps)

    return replace(base, config=replace(base.config, stages=tuple(stretched(stage) for stage in base.config.stages)))


def recipe_from(algorithm: str, data: Any) -> AnyRecipe:
    """The recipe that `to_dict` wrote down.

    Raises SettingsError with everything that does not fit. Assumes that `KINDS` holds the algorithm.
    """
    return read(KINDS[algorithm], data)


def changed(base: AnyRecipe, settings: Sequence[str]) -> AnyRecipe:
    """The recipe with settings such as `waiting=false` or `config.search.simulations=64`; values are JSON, or words.

    Raises UsageError, with all faults at once, for what is no setting of the recipe or does not fit it.
    """
    if not settings:
        return base
    data, faults = _plain(base), []
    names = [setting.partition("=")[0] for setting in settings]
    for setting in settings:
        if not _put(data, setting):
            faults.append(f"{_short(setting)}: the recipe has no such setting; it has {', '.join(_names(_plain(base)))}.")
    faults += [f"{name}: is set {names.count(name)} times." for name in dict.fromkeys(names) if names.count(name) > 1]
    try:
        made = recipe_from(base.algorithm, data)
    except SettingsError as error:
        faults += list(error.faults)
        faults += [fault for setting in settings for fault in _alone(base, setting) if fault not in faults]
    if faults:
        raise UsageError("\n".join(f"--set {fault}" for fault in faults))
    return made


def _alone(base: AnyRecipe, setting: str) -> list[str]:
    """What is wrong with a setting itself, whatever the others are: a part that does not hold keeps what stands around it from being judged."""
    data = _plain(base)
    _put(data, setting)
    try:
        recipe_from(base.algorithm, data)
    except SettingsError as error:
        return [fault for fault in error.faults if fault.startswith(f"{setting.partition('=')[0]} ")]
    return []


def _plain(base: AnyRecipe) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(json.dumps(base.to_dict()))
    return data


def _put(data: dict[str, Any], setting: str) -> bool:
    """Writes the value of `NAME=VALUE` where its name leads; False when that is nowhere. A number leads into a list."""
    name, is_one, value = setting.partition("=")
    *parents, last = name.split(".")
    part: Any = data
    for parent in parents:
        part = part[_key(part, parent)] if _key(part, parent) is not None else None
    key = _key(part, last)
    if not is_one or key is None:
        return False
    part[key] = _value(value)
    return True


def _key(part: Any, word: str) -> str | int | None:
    if isinstance(part, list) and word.isdecimal() and int(word) < len(part):
        return int(word)
    return word if isinstance(part, dict) and word in part else None


def _short(setting: str) -> str:
    return setting if len(setting) <= 80 else f"{setting[:77]}..."


def _names(data: Mapping[str, Any], place: str = "") -> list[str]:
    return [name for key, value in data.items() for name in (_names(value, f"{place}{key}.") if isinstance(value, dict) else [place + key])]


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text
