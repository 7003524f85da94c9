"""A training under way as one safetensors file: every array by its place in the tree, notes beside them. No code in it, no pickle."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load as read_tensors
from safetensors.numpy import save as tensor_bytes

from tandem.cell.storing import store
from tandem.errors import CellError, Fault

Tree = TypeVar("Tree")


def save(path: Path, tree: Any, notes: dict[str, Any]) -> None:
    """Writes the tree's arrays and the notes; the file is whole or what was there before."""
    store(path, tensor_bytes(named_arrays(tree), metadata={"tandem": json.dumps(notes)}))


def load(path: Path, like: Tree) -> tuple[Tree, dict[str, Any]]:
    """The tree of the form of `like` (its values do not matter) and the notes.

    Raises:
      CellError: the file cannot be read, is no checkpoint, or is one of another form; it says which arrays do not fit.
    """
    try:
        data = path.read_bytes()
        arrays, notes = read_tensors(data), read_notes(data)
    except (OSError, ValueError, KeyError, SafetensorError) as error:
        raise CellError([Fault(f"is no checkpoint that can be read ({error}).", (), str(path))]) from error
    wanted = named_arrays(like)
    wrong = sorted(set(wanted) ^ set(arrays)) + [name for name in wanted if name in arrays and wanted[name].shape != arrays[name].shape]
    if wrong:
        raise CellError([Fault(f"does not fit this training: {', '.join(wrong[:5])}{' ...' if len(wrong) > 5 else ''}.", (), str(path))])
    leaves, form = jax.tree_util.tree_flatten_with_path(like)
    return jax.tree.unflatten(form, [_restored(arrays[_name(place)], leaf) for place, leaf in leaves]), notes


def read_notes(data: bytes) -> dict[str, Any]:
    """What a file of `save` says beside its arrays: the header is JSON behind eight bytes of length."""
    header = json.loads(data[8 : 8 + int.from_bytes(data[:8], "little")])
    notes: dict[str, Any] = json.loads(header["__metadata__"]["tandem"])
    return notes


def named_arrays(tree: Any) -> dict[str, np.ndarray[Any, Any]]:
    """Every leaf as a NumPy array under the name of its place; random keys as the numbers they hold."""
    leaves, _ = jax.tree_util.tree_flatten_with_path(tree)
    return {_name(place): np.ascontiguousarray(jax.random.key_data(leaf) if _is_key(leaf) else leaf) for place, leaf in leaves}


def _restored(array: np.ndarray[Any, Any], like: Any) -> jax.Array:
    return jax.random.wrap_key_data(jnp.asarray(array)) if _is_key(like) else jnp.asarray(array, like.dtype)


def _is_key(leaf: Any) -> bool:
    return jnp.issubdtype(leaf.dtype, jax.dtypes.prng_key)


def _name(place: tuple[Any, ...]) -> str:
    return jax.tree_util.keystr(place, simple=True, separator="/")
