"""Standard faces of Tandem's worlds: `parallel_env("thesis", cell)` for PettingZoo, `gymnasium.make("tandem/Thesis-v0", cell=cell)`."""

from tandem.envs.registry import parallel_env, register

__all__ = ["parallel_env"]

register()
