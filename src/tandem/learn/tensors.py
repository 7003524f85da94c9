"""The one door for safetensors files: arrays, and what stands beside them as a document of one
form. Nothing in such a file is code.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from tandem.files.atomic import store
from tandem.learn.forms import Form, parsed, unreadable

Array = np.ndarray[Any, Any]
Beside = TypeVar("Beside", bound=Form)

KEY = "tandem"
"""Under which the document stands in the file's own table of texts."""


def write_tensors(path: str | Path, arrays: Mapping[str, Array], beside: Mapping[str, Any]) -> None:
    """One file with the arrays and the document; it is whole, or what was there before."""
    from safetensors.numpy import save

    whole = {name: np.ascontiguousarray(array) for name, array in arrays.items()}
    store(path, save(whole, metadata={KEY: json.dumps(dict(beside))}))


def read_tensors(
    path: str | Path, form: type[Beside], what: str
) -> tuple[dict[str, Array], Beside]:
    """The arrays by name, and the document.

    Args:
      what: the file should be, as a message calls it.

    Raises CellError when the file cannot be read, is cut off, or is no such file; with everything
    that is wrong with its document.
    """
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(str(path), "numpy") as file:
            text = (file.metadata() or {}).get(KEY)
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 (not a dictionary)
    except OSError as error:
        raise unreadable(
            path, [f"is no {what} that can be read ({error.strerror or error})."]
        ) from error
    except (SafetensorError, ValueError, KeyError, TypeError, AttributeError) as error:
        # each is met by some damaged header
        raise unreadable(path, [f"is no {what} that can be read ({_said(error)})."]) from error
    if text is None:
        raise unreadable(path, [f"is no {what}: it says nothing of what it holds."])
    return arrays, parsed(Path(path), text, form, f"is no {what}")


MOST_TOLD = 5
"""Arrays that do not fit, of which a message speaks."""


def misfits(arrays: Mapping[str, Array], wanted: Mapping[str, Any]) -> str:
    """What keeps arrays from being those that are wanted, as a clause; empty when nothing does.

    Args:
      wanted: name -> anything that has a `shape` and a `dtype`.
    """
    faults = list(_misfits(arrays, wanted))
    more = f"; and {len(faults) - MOST_TOLD} more" if len(faults) > MOST_TOLD else ""
    return f"{'; '.join(faults[:MOST_TOLD])}{more}." if faults else ""


def _misfits(arrays: Mapping[str, Array], wanted: Mapping[str, Any]) -> Iterator[str]:
    yield from (f"has no {name}" for name in wanted if name not in arrays)
    yield from (
        f"has {name!r}, which does not belong there" for name in arrays if name not in wanted
    )
    for name in (name for name in wanted if name in arrays):
        array, like = arrays[name], wanted[name]
        if array.shape != tuple(like.shape):
            yield f"has {name} of the shape {list(array.shape)} instead of {list(like.shape)}"
        elif array.dtype != like.dtype:
            yield f"has {name} in {array.dtype} instead of {like.dtype}"
        elif array.dtype.kind == "f" and np.isnan(array).any():
            yield f"has numbers in {name} that are none (nan)"


def _said(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text if len(text) <= 160 else f"{text[:157]}..."
