"""The server: a socket on the loopback interface, a line once it answers, an end that saves."""

from __future__ import annotations

import asyncio
import secrets
import signal
import socket
import time
from collections.abc import Callable
from types import FrameType

import uvicorn

from tandem.errors import UsageError
from tandem.studio.app import application
from tandem.studio.folder import Folder
from tandem.studio.pool import GRACE_S
from tandem.studio.session import Session

LOOPBACK = "127.0.0.1"
PORT = 8770
"""Asked for when the user names none; a free one is taken when it is in use."""
PATIENCE_S = 3
"""Open connections have so long to end when the server stops."""


def serve(folder: Folder, port: int | None, ready: Callable[[str], None]) -> list[str]:
    """Serves the folder until SIGINT or SIGTERM; returns which files hold what was not saved.

    Args:
      port: 0 for any that is free; None for the usual one or, when that is in use, any.
      ready: called with the address, its token included, once the server answers.

    Raises UsageError when the port cannot be had.
    """
    listening = _socket(port)
    own = listening.getsockname()[1]
    token = secrets.token_urlsafe(32)
    session = Session(folder)
    app = application(session, hosts=(f"{LOOPBACK}:{own}", f"localhost:{own}"), token=token)
    config = uvicorn.Config(
        app,
        log_config=None,
        log_level="critical",  # what is no HTTP is not worth a line
        access_log=False,
        server_header=False,
        lifespan="on",
        timeout_graceful_shutdown=PATIENCE_S,
        h11_max_incomplete_event_size=64 * 1024,
    )
    server = _Server(config, session, lambda: ready(f"http://{LOOPBACK}:{own}/#token={token}"))
    server.run(sockets=[listening])
    return session.keep_unsaved()


def _socket(port: int | None) -> socket.socket:
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    wanted = [PORT, 0] if port is None else [port]
    for number in wanted:
        try:
            listening.bind((LOOPBACK, number))
        except OSError as error:
            problem = (error.strerror or str(error)).lower()
        else:
            listening.listen(512)
            listening.set_inheritable(False)
            return listening
    listening.close()
    raise UsageError(f"--port {port}: {problem}. Give another one, or 0 for any that is free.")


class _Server(uvicorn.Server):
    """Says when it answers, and ends quietly on a signal."""

    def __init__(self, config: uvicorn.Config, session: Session, ready: Callable[[], None]):
        super().__init__(config)
        self.session, self.ready = session, ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            self.ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Searches end with what they have, so that it is told and kept."""
        self.session.is_ending = True
        for run in list(self.session.pool.runs.values()):
            run.stop()
        until = time.monotonic() + GRACE_S + 1
        while self.session.pool.runs and time.monotonic() < until and not self.force_exit:
            await asyncio.sleep(0.05)
        await super().shutdown(sockets)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """A signal asks for an orderly end. It is not raised anew when that has come, as uvicorn
        would: to be stopped is how a server ends well.
        """
        if self.should_exit and sig == signal.SIGINT:
            self.force_exit = True
        self.should_exit = True
