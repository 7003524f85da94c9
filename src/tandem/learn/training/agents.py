"""The learner with the names people know: `learn`, `predict`, `save`, `load`. Deciding needs no
JAX; learning does.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Self

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.learn.policy import Policy
from tandem.learn.ppo.config import Config
from tandem.learn.ppo.recipes import longer
from tandem.learn.training.recipes import recipe

if TYPE_CHECKING:
    from tandem.learn.training.trainer import TrainingProgress


class PPO:
    """PPO for a cell: one decider for all its operators, or with the laboratory's recipes two
    agents on the thesis's station.

        agents = PPO(cell, stress_factor=5).learn()
        agents.save("cell.safetensors")  # for `tandem dispatch --learned cell.safetensors`

    Attributes:
      policy: the trained actors; None before `learn` or `load`.
      result: the document of the last training (`tandem.learn.training.results.result`); None for a
        loaded one.
    """

    def __init__(
        self,
        cell: Cell | None = None,
        *,
        recipe_name: str = "tandem",
        stress_factor: float = 0.0,
        seed: int = 0,
    ) -> None:
        chosen = recipe(recipe_name)
        if not isinstance(getattr(chosen, "config", None), Config):
            raise UsageError(
                f"recipe {recipe_name!r}: is none of PPO's; use"
                " `tandem.learn.training.trainer.train`."
            )
        self.cell = cell
        self.recipe: Any = chosen
        self.recipe_name = recipe_name
        self.stress_factor = stress_factor
        self.seed = seed
        self.policy: Policy | None = None
        self.result: dict[str, Any] | None = None

    def learn(
        self,
        total_timesteps: int | None = None,
        *,
        folder: str | Path | None = None,
        callback: Callable[[TrainingProgress], None] | None = None,
    ) -> Self:
        """Trains from scratch; the recipe's own budget unless `total_timesteps` says otherwise
        (recipes with a budget in steps only).

        Args:
          folder: where the run is kept; nowhere when absent.
          callback: called after every interval.

        Raises:
          UsageError: there is no cell to learn on, or the recipe counts episodes and
            `total_timesteps` is given.
          CellError: the recipe's world cannot hold the cell.
        """
        from tandem.learn.training.trainer import train

        if self.cell is None:
            raise UsageError("a loaded policy has no cell to learn on; begin with PPO(cell).")
        chosen = (
            self.recipe
            if total_timesteps is None
            else longer(self.recipe, total_timesteps / self._budget())
        )
        with TemporaryDirectory() as scratch:
            where = Path(folder) if folder else Path(scratch) / "run"
            self.result = train(
                self.cell,
                recipe_name=self.recipe_name,
                own_recipe=chosen,
                stress_factor=self.stress_factor,
                seeds=(self.seed,),
                folder=where,
                on_progress=callback,
            )
            self.policy = Policy.load(where / f"policy-{self.seed}.safetensors")
        return self

    def predict(
        self,
        observation: Any,
        *,
        action_masks: Any = None,
        deterministic: bool = True,
        agent: str | None = None,
    ) -> tuple[Any, None]:
        """See `Policy.predict`. Raises UsageError when nothing has been learned yet."""
        return self._learned().predict(
            observation, action_masks=action_masks, deterministic=deterministic, agent=agent
        )

    def save(self, path: str | Path) -> Path:
        """The actors as one safetensors file; returns where."""
        return self._learned().save(path)

    @classmethod
    def load(cls, path: str | Path, cell: Cell | None = None) -> Self:
        """Agents that can decide, from `save` or from a run's `policy-SEED.safetensors`.

        Raises CellError when the file is no policy.
        """
        policy = Policy.load(path)
        notes = policy.notes
        made = cls(
            cell,
            recipe_name=notes.get("recipe", "tandem"),
            stress_factor=notes.get("stress_factor", 0.0),
            seed=notes.get("seed", 0),
        )
        made.policy = policy
        return made

    def _learned(self) -> Policy:
        if self.policy is None:
            raise UsageError("these agents have learned nothing yet; call learn() or load().")
        return self.policy

    def _budget(self) -> int:
        steps = [stage.steps for stage in self.recipe.config.stages]
        if None in steps:
            raise UsageError(
                f"total_timesteps: recipe {self.recipe_name!r} counts episodes, not steps."
            )
        return sum(filter(None, steps))
