"""Memory beside the clock: no decision waits for Python to look through all that was made before the shift."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def settled_memory() -> Iterator[None]:
    """Within it a full collection of garbage leaves out what exists now.

    Libraries and what deciders have valued before the shift are a million objects; a collection that
    goes through them takes a tenth of a second, and comes when it likes, in the midst of a decision.
    """
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()
