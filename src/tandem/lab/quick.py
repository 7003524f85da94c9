"""How a quick run gets quick: nearly all of its time is spent compiling."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def compiled_quickly() -> Iterator[None]:
    """JAX compiles without most optimisations in here, which changes nothing but speed."""
    import jax

    before = jax.config.values["jax_disable_most_optimizations"]
    jax.config.update("jax_disable_most_optimizations", True)
    try:
        yield
    finally:
        jax.config.update("jax_disable_most_optimizations", before)
