"""Standard faces of the event world, and every world by name: `parallel_env("thesis", cell)`,
`gymnasium.make("tandem/Thesis-v0", cell=cell)`.
"""

from tandem.envs.registry import parallel_env, register

__all__ = ["parallel_env"]

register()
