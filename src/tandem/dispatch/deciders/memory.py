"""Memory beside the clock: no decision waits for Python to look through all that was made before
it.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def settled_memory() -> Iterator[Callable[[], None]]:
    """Within it garbage is collected only when what is yielded is called: between decisions, when
    nobody waits.

    Libraries and what deciders have valued are a million objects. A full collection, which comes
    when it likes, goes through them for a tenth of a second in the midst of a decision. Here each
    call goes through what came since the one before, a millisecond's work, and sets it aside; what
    was set aside and is not needed any more goes as always, but for what refers to itself in a
    circle: that waits for the end. A program that had set objects aside itself finds them aside
    afterwards, and with them what was set aside here.
    """
    was_enabled, was_aside = gc.isenabled(), gc.get_freeze_count() > 0
    gc.disable()
    try:
        _settle()
        yield _settle
    finally:
        if not was_aside:
            gc.unfreeze()
        if was_enabled:
            gc.enable()


def _settle() -> None:
    gc.collect()
    gc.freeze()
