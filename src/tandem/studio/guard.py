"""Who may ask what: the checks that every request passes before anything is done with it."""

from __future__ import annotations

import asyncio
import hmac
import json
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any
from urllib.parse import parse_qs

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

LARGEST = 8_000_000
"""Bytes that the body of a request may have."""
MOST_READ = 256_000_000
"""Of a larger body so many bytes are read and thrown away, so that the refusal arrives."""
LONGEST_S = 60.0
"""A body has so long to arrive."""
TOKEN = "x-tandem-token"
READING = ("GET", "HEAD", "OPTIONS")

POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' data: blob:",
        "connect-src 'self'",
        "font-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
HEADERS = {
    "content-security-policy": POLICY,
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), geolocation=(), microphone=()",
}


class Refused(Exception):
    """A request that is not let through, with its status and a sentence."""

    def __init__(self, status: int, sentence: str):
        super().__init__(sentence)
        self.status, self.sentence = status, sentence


class Guard:
    """Wraps the application.

    A request is refused when its Host is not this server (a name that somebody else has led here,
    DNS rebinding), when it comes from a page of another origin, when it would write or compute and
    has not the token of this start, and when its body is too large. Each answer gets the headers
    that keep a browser from doing anything else with it.

    Args:
      hosts: names and ports under which the server is reached, such as "127.0.0.1:8765".
      token: what writes have to show.
      with_token: paths that need it although they are only read, because they begin a search; there
        it may stand in the address, since an event source sends no headers.
    """

    def __init__(
        self, app: App, *, hosts: tuple[str, ...], token: str, with_token: tuple[str, ...]
    ):
        self.app, self.hosts, self.token, self.with_token = app, hosts, token, with_token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        sender = _with_headers(send, scope["path"])
        refused = self._refusal(scope)
        try:
            # what is refused is read to its end too, so that whoever sends hears why
            body = await asyncio.wait_for(_body(scope, receive), LONGEST_S)
        except Refused as too_large:
            refused = refused or too_large
        except TimeoutError:
            refused = refused or Refused(408, "the request did not arrive within a minute.")
        except ConnectionError:
            return
        if refused is not None:
            await _answer(sender, refused)
        else:
            await self.app(scope, _again(body, receive), sender)

    def _refusal(self, scope: Scope) -> Refused | None:
        try:
            self._check(scope)
        except Refused as refused:
            return refused
        return None

    def _check(self, scope: Scope) -> None:
        headers = _headers_of(scope)
        hosts = headers.get("host", [])
        if len(hosts) != 1 or hosts[0].lower() not in self.hosts:
            raise Refused(403, f"this server is {self.hosts[0]}, and answers to no other name.")
        for origin in headers.get("origin", []):
            if origin.lower() not in {f"http://{host}" for host in self.hosts}:
                raise Refused(403, "a page of another origin may not ask here.")
        is_read = scope["method"] in READING
        # a link in another page may lead to ours; it gets nothing else from here
        is_page = is_read and scope["path"] == "/"
        if not is_page and headers.get("sec-fetch-site", ["none"])[0] in (
            "cross-site",
            "same-site",
        ):
            raise Refused(403, "a page of another origin may not ask here.")
        if is_read and scope["path"] not in self.with_token:
            return
        shown = headers.get(TOKEN, [])
        if not shown and scope["path"] in self.with_token:
            shown = parse_qs(scope["query_string"].decode("latin-1")).get("token", [])
        if len(shown) != 1 or not hmac.compare_digest(shown[0].encode(), self.token.encode()):
            raise Refused(
                403, "this needs the header X-Tandem-Token with the token of the printed address."
            )


def _headers_of(scope: Scope) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for name, value in scope["headers"]:
        found.setdefault(name.decode("latin-1").lower(), []).append(value.decode("latin-1"))
    return found


async def _body(scope: Scope, receive: Receive) -> bytes:
    """The body, whole. Raises Refused when it is too large, after reading on for a while."""
    headers = _headers_of(scope)
    told = headers.get("content-length", ["0"])[0]
    asks_first = "100-continue" in headers.get("expect", [])
    too_large = Refused(413, f"the request is larger than {LARGEST // 1_000_000} MB.")
    if told.isdigit() and int(told) > LARGEST and (asks_first or int(told) > MOST_READ):
        raise too_large
    chunks: list[bytes] = []
    size = 0
    while True:
        message = await receive()
        if message["type"] == "http.disconnect":
            raise ConnectionError
        chunk = message.get("body", b"")
        size += len(chunk)
        if size <= LARGEST:
            chunks.append(chunk)
        else:
            chunks.clear()
        if size > MOST_READ:
            raise too_large
        if not message.get("more_body", False):
            break
    if size > LARGEST:
        raise too_large
    return b"".join(chunks)


def _again(body: bytes, receive: Receive) -> Receive:
    """The body that was read, and then whatever comes."""
    given = False

    async def told() -> Message:
        nonlocal given
        if given:
            return await receive()
        given = True
        return {"type": "http.request", "body": body, "more_body": False}

    return told


def _with_headers(send: Send, path: str) -> Send:
    # what was computed is not kept by browsers, nor is the first page; a file of the page says
    # itself for how long it holds
    is_file = path.startswith("/static/")
    kept = {} if is_file else {"cache-control": "no-store" if path != "/" else "no-cache"}
    more = [(name.encode(), value.encode()) for name, value in {**HEADERS, **kept}.items()]

    async def sender(message: Message) -> None:
        if message["type"] == "http.response.start":
            own = {name for name, _ in more}
            headers = [pair for pair in message.get("headers", []) if pair[0].lower() not in own]
            message = {**message, "headers": [*headers, *more]}
        await send(message)

    return sender


async def _answer(send: Send, refused: Refused) -> None:
    content = json.dumps({"error": refused.sentence}).encode()
    headers = [
        (b"content-type", b"application/json"),
        (b"content-length", str(len(content)).encode()),
        *([(b"connection", b"close")] if refused.status == 413 else []),
    ]
    await send({"type": "http.response.start", "status": refused.status, "headers": headers})
    await send({"type": "http.response.body", "body": content})
