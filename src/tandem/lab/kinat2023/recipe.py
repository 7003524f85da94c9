"""How the two agents of a cell are trained on the thesis's station: as Kinat (2023) has it, and as
we would.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, ClassVar, Literal

from tandem.lab.kinat2023.observations import (
    observe,
    observe_bounded,
    observe_normalised,
    observe_scaled,
)
from tandem.lab.kinat2023.rewards import REWARDS
from tandem.learn.forms import key_of
from tandem.learn.ppo.config import Config, Stage
from tandem.learn.settings import checked

OBSERVATIONS: dict[str, Callable[..., Any]] = {
    "thesis": observe,
    "scaled": observe_scaled,
    "bounded": observe_bounded,
    "normalised": observe_normalised,
}
"""What a recipe's `sees` means: station and state to `[2, D]`, in NumPy and JAX alike."""

Pace = Literal["ticks", "decisions"]


@checked
@dataclass(frozen=True)
class StationRecipe:
    """How PPO trains the agents of a cell with one robot and one human, on the thesis's station.

    Attributes:
      config: of the learner.
      pace: the station by "ticks" or by "decisions".
      sees: a name in `OBSERVATIONS`: the thesis's observation as it is ("thesis") or in 0..1
        ("scaled"), divided by the bounds that the thesis declares ("bounded"), or ours
        ("normalised").
      rewards: a name in `tandem.lab.kinat2023.REWARDS`. What idling costs is said by the stages.
      what: it is, in a line; no setting.
    """

    config: Config
    pace: Pace
    sees: Annotated[str, key_of(OBSERVATIONS)]
    rewards: Annotated[str, key_of(REWARDS)] = "appendix"
    what: str = field(default="", compare=False, kw_only=True)

    algorithm: ClassVar[str] = "station"

    def to_dict(self) -> dict[str, Any]:
        return {
            "pace": self.pace,
            "sees": self.sees,
            "rewards": self.rewards,
            "config": self.config.to_dict(),
        }


THESIS = StationRecipe(
    Config(
        stages=(
            Stage(
                episodes=800,
                entropy=0.7,
                learning_rate=1e-4,
                idle=-10.0,
                normalise_advantages=False,
            ),
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
    what="Kinat 2023: two agents, a robot and a human, on the thesis's station",
)
"""Kinat (2023), chapters 5 and 6: what is written there. What is not, as the toolbox it used has it
by default: two hidden layers, ReLU, raw advantages, learning after each episode or 512 steps,
whichever comes first. (Recalled from its manual; ASSUMPTION.)
"""

TOOLBOX = replace(
    THESIS,
    config=replace(
        THESIS.config,
        stages=tuple(replace(stage, stop_return=1000.0) for stage in THESIS.config.stages),
        adam_epsilon=1e-8,
        l2=1e-4,
        small_start=1.0,
        layer_per_channel=True,
    ),
    what="Kinat 2023 with the defaults of the MATLAB RL Toolbox where the thesis names none",
)
"""The recipe `thesis` with what that toolbox does when nobody says otherwise: Adam with an epsilon
of 1e-8 and L2 of 1e-4, a last layer that begins at its full size, an input layer for each channel.
And with the thesis's own criterion for stopping, an episode that pays both agents 1000, which no
episode can. (The defaults are recalled from its manual; ASSUMPTION.)
"""

APPENDIX = replace(
    THESIS,
    config=replace(
        THESIS.config,
        stages=(
            THESIS.config.stages[0],
            Stage(episodes=1300, entropy=0.01, learning_rate=1e-4, normalise_advantages=False),
        ),
    ),
    what="Kinat 2023 with the two stages of its appendix: 800 episodes, then 1300 at entropy 0.01",
)
"""The stages as the appendix's code has them, the second one commented out there."""

STATION = StationRecipe(
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
    what="the thesis's station by our settings: decisions instead of ticks, legal actions alone",
)
"""Ours: only legal actions, 64 stations at once, decisions instead of ticks."""


def varied(
    base: StationRecipe,
    *,
    normalise_advantages: bool | None = None,
    sees: str | None = None,
    rewards: str | None = None,
) -> StationRecipe:
    """The recipe with what the thesis's text and code leave open set otherwise. Table 5-2 punishes
    idling in stage 1 with -11 instead of -10.
    """
    stages = base.config.stages
    if normalise_advantages is not None:
        stages = tuple(
            replace(stage, normalise_advantages=normalise_advantages) for stage in stages
        )
    if rewards == "table_5_2":
        stages = tuple(replace(stage, idle=-11.0 if stage.idle else 0.0) for stage in stages)
    return replace(
        base,
        config=replace(base.config, stages=stages),
        sees=sees or base.sees,
        rewards=rewards or base.rewards,
    )
