"""The page: its files, read once and sent from memory, under an address that changes with their
content, so that a browser need not ask for them again.
"""

from __future__ import annotations

import hashlib
import mimetypes
from pathlib import Path

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

KEPT = "public, max-age=31536000, immutable"
"""What is sent under the address of a version never changes."""
PRELOADS = "<!-- preloads -->"
"""Where the first page names what it will ask for, all at once: a browser that finds the next
module only in the last one waits for each of them in turn.
"""


class Page:
    """The files of the page.

    Args:
      folder: where they stand; `index.html` is the first page.

    Attributes:
      version: changes when any of the files does.
    """

    def __init__(self, folder: Path):
        self._files = {
            path.relative_to(folder).as_posix(): path.read_bytes()
            for path in sorted(folder.rglob("*"))
            if path.is_file()
        }
        digest = hashlib.sha256()
        for name, content in self._files.items():
            digest.update(f"{name}\n{len(content)}\n".encode() + content)
        self.version = digest.hexdigest()[:16]
        first = self._files["index.html"].decode()
        first = first.replace(PRELOADS, "\n".join(self._preloads()))
        self._first = first.replace("/static/", f"/static/{self.version}/").encode()

    def _preloads(self) -> list[str]:
        modules = [name for name in self._files if name.endswith(".js")]
        words = [name for name in self._files if name.startswith("words_")]
        fetched = ["/api/cell", *(f"/static/{name}" for name in words)]
        return [
            *(
                f'<link rel="preload" as="fetch" crossorigin href="{address}">'
                for address in fetched
            ),
            *(f'<link rel="modulepreload" href="/static/{name}">' for name in modules),
        ]

    async def first(self, request: Request) -> Response:
        """The first page, which is asked for at each visit."""
        return Response(self._first, media_type="text/html")

    async def file(self, request: Request) -> Response:
        """A file under the address of this version."""
        name = request.path_params["name"]
        if request.path_params["version"] != self.version or name not in self._files:
            raise HTTPException(404)
        kind = mimetypes.guess_type(name)[0] or "application/octet-stream"
        return Response(self._files[name], media_type=kind, headers={"cache-control": KEPT})
