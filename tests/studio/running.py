"""A real server process, and raw requests to it."""

from __future__ import annotations

import http.client
import json
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette", reason="pip install 'tandem[studio]'")
pytest.importorskip("sse_starlette", reason="pip install 'tandem[studio]'")
pytest.importorskip("uvicorn", reason="pip install 'tandem[studio]'")

PATIENCE_S = 120
WITHOUT_BROWSER = ("--port", "0", "--no-browser")


@dataclass
class Answer:
    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        return json.loads(self.body)


class Running:
    """`tandem studio PLACE --port 0 --no-browser`, once it has printed its line."""

    def __init__(self, place: Path | str, *flags: str):
        self.process = subprocess.Popen(
            [sys.executable, *flags, "-m", "tandem", "studio", str(place), *WITHOUT_BROWSER],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        self.line = self.process.stdout.readline().strip()
        assert self.line, self.process.communicate()[1]
        self.address, _, self.token = self.line.partition("/#token=")
        self.host = self.address.removeprefix("http://")
        self.port = int(self.host.rpartition(":")[2])

    def ask(
        self,
        method: str,
        path: str,
        body: Any = None,
        *,
        token: str | None = "",
        headers: dict[str, str] | None = None,
    ) -> Answer:
        """`token`: None for none, empty for the right one. A body that is no bytes goes as JSON."""
        sent = dict(headers or {})
        if token is not None:
            sent.setdefault("X-Tandem-Token", token or self.token)
        if body is not None and not isinstance(body, bytes):
            body = json.dumps(body).encode()
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_S)
        try:
            connection.request(method, path, body, sent)
            response = connection.getresponse()
            told = {name.lower(): value for name, value in response.getheaders()}
            return Answer(response.status, told, response.read())
        finally:
            connection.close()

    def stream(self, query: str = "") -> Stream:
        """A stream of events that has begun."""
        return Stream(self, f"/api/plan/stream?token={self.token}&{query}")

    def end(self, sign: int = signal.SIGINT) -> tuple[int, str, str]:
        """The exit code, and what was printed after the first line."""
        if self.process.poll() is None:
            self.process.send_signal(sign)
        out, err = self.process.communicate(timeout=PATIENCE_S)
        return self.process.returncode, out, err

    def __enter__(self) -> Running:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()


class Stream:
    """Server-sent events, one after the other."""

    def __init__(self, server: Running, path: str):
        self.connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=PATIENCE_S)
        self.connection.request("GET", path)
        self.response = self.connection.getresponse()
        self.status = self.response.status

    def __iter__(self):
        event, data = "", []
        for raw in self.response:
            line = raw.decode().rstrip("\r\n")
            if line.startswith("event:"):
                event = line.removeprefix("event:").strip()
            elif line.startswith("data:"):
                data.append(line.removeprefix("data:").strip())
            elif not line and data:
                yield event, json.loads("\n".join(data))
                event, data = "", []

    def close(self) -> None:
        self.response.close()
        self.connection.close()


def until(holds, what: str):
    """Waits until `holds()` gives something true, and gives that."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if found := holds():
            return found
        time.sleep(0.05)
    raise AssertionError(f"never: {what}")
