"""Room for what JAX compiles: Linux allows a process so many memory maps, and every compiled
function takes some of them for good.

Beyond the limit the compiler fails (`LLVM compilation error: Cannot allocate memory`), and reading
the persistent cache ends in a segmentation fault instead of an exception. A single training is far
from it; a process that trains one thing after the other is not.
"""

from __future__ import annotations

from pathlib import Path

SHARE = 3
"""Compiled functions are dropped when a process has used a third of the maps: the largest training
so far took another third.
"""

LIMIT, MAPS = Path("/proc/sys/vm/max_map_count"), Path("/proc/self/maps")


def make_room(limit: int | None = None) -> bool:
    """Drops what JAX has compiled when the process has used much of its memory maps, and says
    whether it did.

    What is needed again is compiled again, or read from the persistent cache. Where the system does
    not tell its maps, nothing happens.

    Args:
      limit: maps that the process may have; asked of the system when absent.
    """
    try:
        limit = int(LIMIT.read_text()) if limit is None else limit
        used = MAPS.read_bytes().count(b"\n")
    except (OSError, ValueError):
        return False
    if used * SHARE < limit:
        return False
    import jax

    jax.clear_caches()
    return True
