"""Files are whole or absent: what was there stays until the new content is on the disk."""

from __future__ import annotations

import os
import secrets
from pathlib import Path


def store(path: str | os.PathLike[str], content: str | bytes) -> None:
    """Writes the content under a temporary name in the same folder, brings it to the disk and
    renames it.

    A device such as `/dev/stdout` is written directly. Permissions of a file that is replaced are
    kept; a link is followed.

    Raises:
      OSError: it could not be written. No part of it is left behind, and an older file is as it
        was.
    """
    data = content.encode() if isinstance(content, str) else content
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file() and not target.is_dir():
        target.write_bytes(data)
        return
    beside = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        with open(beside, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        if target.exists():
            beside.chmod(target.stat().st_mode & 0o777)
        os.replace(beside, target)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise
