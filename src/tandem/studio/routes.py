"""Every address of the studio in one table: what is asked there, what is answered, and who
answers. The OpenAPI document is made of it.
"""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import anyio.to_thread
from sse_starlette import EventSourceResponse, ServerSentEvent
from starlette.requests import Request
from starlette.responses import JSONResponse, Response

import tandem
from tandem.errors import CellError, UsageError
from tandem.studio.asked import TABLE, TEXT, cell_in, read
from tandem.studio.failures import errors_of
from tandem.studio.folder import NewerError
from tandem.studio.jobs import OPTIONS
from tandem.studio.pool import BusyError
from tandem.studio.session import Draft, Session

Json = dict[str, Any]
Handler = Callable[[Request, Session], Awaitable[Response]]

FORMAT = 1
"""Of cell files."""


@dataclass(frozen=True)
class Route:
    """A line of the table.

    Attributes:
      what: is answered, in a sentence.
      asks: JSON Schema of the body, None where there is none.
      query: name -> JSON Schema and a sentence.
      answers: status -> JSON Schema of the answer; a text for a media type that is not JSON.
    """

    method: str
    path: str
    handler: Handler
    what: str
    asks: Json | None = None
    query: Mapping[str, tuple[Json, str]] = field(default_factory=dict)
    answers: Mapping[int, Any] = field(default_factory=dict)


async def body_of(request: Request) -> Any:
    """The JSON of a request. Raises UsageError when it is none."""
    raw = await request.body()
    try:
        return json.loads(raw, parse_constant=_no_number) if raw else {}
    except RecursionError as error:
        raise UsageError("the request is nested too deeply.") from error
    except UnicodeDecodeError as error:
        raise UsageError("the request is no UTF-8 text.") from error
    except ValueError as error:
        raise UsageError(f"the request is no well-formed JSON: {error}.") from error


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


def _text(**more: Any) -> Json:
    return {"type": "string", **more}


# --- the cell -------------------------------------------------------------------------------------


async def health(request: Request, session: Session) -> Response:
    return JSONResponse({"status": "ok", "version": tandem.__version__})


async def get_cell(request: Request, session: Session) -> Response:
    folder = session.folder
    opened = await anyio.to_thread.run_sync(
        lambda: folder.open(folder.chosen(request.query_params.get("file")))
    )
    told = {
        "cell": opened.document,
        "version": opened.version,
        "name": opened.name,
        "format": FORMAT,
    }
    if opened.faults:
        told["errors"] = errors_of(opened.faults, opened.document)
    if (draft := folder.draft(opened.name)) is not None:
        told["draft"] = dict(draft)
    return JSONResponse(told)


async def put_cell(request: Request, session: Session) -> Response:
    given = read(await body_of(request), {"cell": TABLE, "version": TEXT}, needed=("cell",))
    name = session.folder.chosen(request.query_params.get("file"))
    cell = await anyio.to_thread.run_sync(cell_in, given["cell"])
    save = partial(session.folder.save, name, cell, given.get("version"))
    try:
        version = await anyio.to_thread.run_sync(save)
    except NewerError as error:
        now = error.now
        return JSONResponse(
            {
                "error": f"{name} has changed on the disk since it was opened."
                if now
                else f"{name} is no longer on the disk.",
                "version": now.version if now else None,
                "cell": now.document if now else None,
            },
            409,
        )
    session.drop(name)
    return JSONResponse({"version": version})


async def check(request: Request, session: Session) -> Response:
    given = read(await body_of(request), {"cell": TABLE}, needed=("cell",))
    try:
        await anyio.to_thread.run_sync(cell_in, given["cell"])
    except CellError as error:
        return JSONResponse({"errors": errors_of(error.faults, given["cell"])})
    return JSONResponse({"errors": []})


async def draft(request: Request, session: Session) -> Response:
    keys = {"cell": TABLE, "version": TEXT, "file": TEXT}
    given = read(await body_of(request), keys)
    name = given.get("file")
    if name is not None or session.folder.only is not None:
        name = session.folder.chosen(name)
    if "cell" not in given:
        if name is None:
            raise UsageError("file is missing: whose draft is not wanted any more?")
        session.drop(name)
        return JSONResponse({"draft": None})
    kept = Draft(given["cell"], name, given.get("version"))
    return JSONResponse({"draft": session.hold(kept)})


async def files(request: Request, session: Session) -> Response:
    names = await anyio.to_thread.run_sync(session.folder.names)
    return JSONResponse({"files": [{"name": name} for name in names]})


# --- planning -------------------------------------------------------------------------------------


async def plan(request: Request, session: Session) -> Response:
    given = read(
        await body_of(request), {"cell": TABLE, "options": TABLE, "draft": TEXT, "file": TEXT}
    )
    read(given.get("options", {}), OPTIONS)
    cell = await anyio.to_thread.run_sync(session.document, given)
    job = {"cell": cell, "options": given.get("options", {})}
    return JSONResponse(await session.pool.document("plan", job))


async def stream(request: Request, session: Session) -> Response:
    query = dict(request.query_params)
    query.pop("token", None)
    which: Json = {key: query.pop(key) for key in ("draft", "file") if key in query}
    name = session.name_of(which)
    options = {key: _value(text) for key, text in query.items()}
    read(options, OPTIONS)
    cell = await anyio.to_thread.run_sync(session.document, which)
    events = session.pool.events("plan", {"cell": cell, "options": options}, is_stream=True)
    first = await anext(events)  # refuses here when there is no place

    async def told() -> AsyncIterator[ServerSentEvent]:
        try:
            yield _event(*first)
            async for event, data in events:
                if event == "done" and session.is_ending:
                    session.keep_found(name, data)
                if event == "failed":
                    data = {"message": data.pop("error"), **data}
                yield _event(event, data)
        finally:
            await events.aclose()

    return EventSourceResponse(told(), ping=15)


def _value(text: str) -> Any:
    """A value in the address: JSON where it is some, else text."""
    try:
        return json.loads(text)
    except ValueError:
        return text


def _event(event: str, data: Json) -> ServerSentEvent:
    return ServerSentEvent(json.dumps(data, ensure_ascii=False), event=event)


async def stop(request: Request, session: Session) -> Response:
    given = await body_of(request)
    number = given.get("run") if isinstance(given, Mapping) else None
    if number is not None and not isinstance(number, int):
        raise UsageError(f"run is {number!r}, but must be the number of a search.")
    return JSONResponse({"stopped": session.pool.stop(number)})


ROUTES: tuple[Route, ...] = (
    Route("GET", "/api/health", health, "Whether the server answers, and its version."),
    Route("GET", "/api/cell", get_cell, "The cell file as it stands on the disk."),
    Route("PUT", "/api/cell", put_cell, "Saves the cell, never over a newer file."),
    Route("POST", "/api/check", check, "What is wrong with a cell; nothing is written."),
    Route("POST", "/api/draft", draft, "Holds a cell that is not saved."),
    Route("GET", "/api/files", files, "The cell files of the folder."),
    Route("POST", "/api/plan", plan, "The plan document, as `tandem plan --json`."),
    Route("GET", "/api/plan/stream", stream, "The same as it is found, as server-sent events."),
    Route("POST", "/api/plan/stop", stop, "Ends searches with what they have found."),
)
"""A new address is a line here."""

__all__ = ["ROUTES", "BusyError", "Route"]
