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
