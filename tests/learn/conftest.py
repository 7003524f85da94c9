"""What the tests of learning share. A forgotten axis fails: NumPy's silent widening of ranks is an
error here.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest

jax = pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")


@pytest.fixture(autouse=True)
def _no_rank_promotion() -> Iterator[None]:
    with jax.numpy_rank_promotion("raise"):
        yield


@pytest.fixture(scope="module")
def quickly_compiled() -> Iterator[None]:
    """Compiles without most optimisations: what is compiled for a test runs for milliseconds."""
    from tandem.lab.quick import compiled_quickly

    with compiled_quickly():
        yield
