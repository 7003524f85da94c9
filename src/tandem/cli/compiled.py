"""What JAX compiles is kept from one command to the next: the second `tandem train` of a cell
begins after a second instead of a minute.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
from importlib.util import find_spec
from pathlib import Path

from tandem.errors import TandemError

MOST_BYTES = 2**29
"""What was not used for longest is dropped beyond this."""


def needs_jax(purpose: str) -> None:
    """Makes ready for a command that needs JAX. Raises TandemError, which says what to install,
    when it is not there.

    Args:
      purpose: what needs it, as the message begins.
    """
    keep_compiled()
    must_have_jax(purpose)
    try:
        import jax  # noqa: F401
    except ImportError as error:  # a part of it is missing
        raise _no_jax(purpose) from error


def must_have_jax(purpose: str) -> None:
    """Raises TandemError as `needs_jax` does, without loading anything: before long work that would
    be in vain.
    """
    if find_spec("jax") is None:
        raise _no_jax(purpose)


def _no_jax(purpose: str) -> TandemError:
    return TandemError(
        f"{purpose} needs JAX, which is not installed. Get it with: pip install 'tandem[learn]'"
    )


def keep_compiled() -> None:
    """Names JAX a folder in the user's cache, by JAX's own variables: JAX reads them when it is
    imported. A folder that the user has named is the user's: nothing is set or dropped there.

    Nothing is kept, and nothing said, where learning is not installed or the folder cannot be made.
    """
    if os.environ.get("JAX_COMPILATION_CACHE_DIR"):
        return
    try:
        from filelock import FileLock, Timeout
        from platformdirs import user_cache_path

        folder = user_cache_path("tandem") / f"compiled-{_processor()}"
        folder.mkdir(parents=True, exist_ok=True)
        # JAX's own lock
        with contextlib.suppress(Timeout), FileLock(folder / ".lockfile", timeout=1):
            _mend(folder)
    except (ImportError, OSError, RuntimeError):
        return
    os.environ["JAX_COMPILATION_CACHE_DIR"] = str(folder)
    os.environ.setdefault("JAX_COMPILATION_CACHE_MAX_SIZE", str(MOST_BYTES))
    os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.5")


def _mend(folder: Path) -> None:
    """Drops what a command did not write to its end when it was killed: JAX notes the time of an
    entry last, and stumbles where that is missing.
    """
    for entry in folder.glob("*-cache"):
        if not entry.with_name(entry.name.removesuffix("-cache") + "-atime").exists():
            entry.unlink()


def _processor() -> str:
    """Stands for this processor: what is compiled for one need not run on another that shares the
    home directory.
    """
    try:
        told = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
        features = next(
            (line for line in told.splitlines() if line.lower().startswith(("flags", "features"))),
            "",
        )
    except OSError:
        features = platform.processor()
    return hashlib.sha256(f"{platform.machine()} {features}".encode()).hexdigest()[:8]
