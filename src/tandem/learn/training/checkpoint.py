"""A training under way as one safetensors file: every array by its place in the tree, notes beside
them. No code in it, no pickle.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from pydantic import Field

from tandem.learn.forms import Form, unreadable
from tandem.learn.tensors import misfits, read_tensors, write_tensors

Tree = TypeVar("Tree")


class Notes(Form):
    """What a checkpoint says beside its arrays: intervals done, and the CPU seconds that they
    took.
    """

    interval: int = Field(ge=0, lt=2**53)
    cpu_s: float = Field(ge=0)


def save(path: Path, tree: Any, notes: Notes) -> None:
    """Writes the tree's arrays and the notes; the file is whole or what was there before."""
    write_tensors(path, named_arrays(tree), notes.model_dump())


def load(path: Path, like: Tree) -> tuple[Tree, Notes]:
    """The tree of the form of `like` (of which only shapes and dtypes matter) and the notes.

    Raises:
      CellError: the file cannot be read, is no checkpoint, or is one of another form; it says which
        arrays do not fit.
    """
    arrays, notes = read_tensors(path, Notes, "checkpoint")
    if said := misfits(arrays, _named(like, lambda leaf: jax.eval_shape(_plain, leaf))):
        raise unreadable(path, [f"does not fit this training: it {said}"])
    leaves, form = jax.tree_util.tree_flatten_with_path(like)
    return jax.tree.unflatten(
        form, [_restored(arrays[_name(place)], leaf) for place, leaf in leaves]
    ), notes


def named_arrays(tree: Any) -> dict[str, np.ndarray[Any, Any]]:
    """Every leaf as a NumPy array under the name of its place; random keys as the numbers they
    hold.
    """
    return _named(tree, lambda leaf: np.ascontiguousarray(_plain(leaf)))


def _named(tree: Any, of: Callable[[Any], Any]) -> dict[str, Any]:
    return {_name(place): of(leaf) for place, leaf in jax.tree_util.tree_flatten_with_path(tree)[0]}


def _plain(leaf: Any) -> Any:
    return jax.random.key_data(leaf) if _is_key(leaf) else leaf


def _restored(array: np.ndarray[Any, Any], like: Any) -> jax.Array:
    return (
        jax.random.wrap_key_data(jnp.asarray(array))
        if _is_key(like)
        else jnp.asarray(array, like.dtype)
    )


def _is_key(leaf: Any) -> bool:
    return jnp.issubdtype(leaf.dtype, jax.dtypes.prng_key)


def _name(place: tuple[Any, ...]) -> str:
    return jax.tree_util.keystr(place, simple=True, separator="/")
