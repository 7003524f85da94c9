"""A process that compiles one thing after the other stays below the memory maps that the system
allows.
"""

from __future__ import annotations

import gc

import jax
import jax.numpy as jnp
import pytest

from tandem.learn import room

maps = pytest.mark.skipif(
    not room.MAPS.exists(), reason="this system does not tell its memory maps"
)


def used() -> int:
    gc.collect()
    return room.MAPS.read_bytes().count(b"\n")


@maps
def test_compiled_functions_take_maps_and_give_them_back():
    before = used()
    for size in range(1, 60):
        jax.jit(lambda x, size=size: jnp.sin(x * size) @ x.T + size)(jnp.ones((size, 3)))
    full = used()
    assert full > before + 59
    assert room.make_room(limit=full)
    assert used() < full - 59
    assert jax.jit(lambda x: x + 1)(1.0) == 2.0


@maps
def test_nothing_is_dropped_while_there_is_room():
    twice = jax.jit(lambda x: 2 * x)
    twice(1.0)
    assert not room.make_room(limit=10 * used())
    assert twice._cache_size() == 1


def test_where_nothing_is_told_nothing_is_done(monkeypatch, tmp_path):
    monkeypatch.setattr(room, "MAPS", tmp_path / "none")
    assert not room.make_room(limit=1)
