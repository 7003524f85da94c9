"""Every address of the studio in one table: what is asked there, what is answered, and who
answers. The OpenAPI document is made of it.
"""

from __future__ import annotations

import base64
import json
from collections.abc import AsyncIterator
from functools import partial
from typing import Any

import anyio.to_thread
from sse_starlette import EventSourceResponse, ServerSentEvent
from starlette.requests import Request
from starlette.responses import JSONResponse, Response

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError, UsageError
from tandem.studio.asked import LANGUAGE, PAIR, TABLE, TEXT, WHOLE, Json, cell_in, read
from tandem.studio.failures import errors_of, failure
from tandem.studio.folder import NewerError
from tandem.studio.jobs import JOBS, OF_A_CELL, OPTIONS
from tandem.studio.openapi import document
from tandem.studio.pool import GRACE_S, Failed
from tandem.studio.route import Handler, Route
from tandem.studio.schemas import (
    ANYTHING,
    ASSIGNMENTS,
    COMPARED,
    ERRORS,
    MEASURES,
    PLAN,
    POINT,
    fails,
    or_null,
    rows,
    string,
    table,
)
from tandem.studio.session import Draft, Session

FORMAT = 1
"""Of cell files."""


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


def sound(document: Any) -> Cell:
    """The cell. Raises Failed with every fault and the value at its place."""
    try:
        return cell_in(document)
    except CellError as error:
        raise Failed(failure(error, document)) from None


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


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
    cell = await anyio.to_thread.run_sync(sound, given["cell"])
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


async def asked_job(name: str, request: Request, session: Session) -> Json:
    """A request that is one of `JOBS`, with its cell. Raises UsageError, CellError."""
    job = JOBS[name]
    given = job.asked(await body_of(request))
    if job.of_a_cell:
        cell = await anyio.to_thread.run_sync(session.document, given)
        given = {key: value for key, value in given.items() if key not in OF_A_CELL}
        given["cell"] = cell
    return given


def answered_by(name: str) -> Handler:
    """The handler that gives the document of a job."""

    async def handler(request: Request, session: Session) -> Response:
        given = await asked_job(name, request, session)
        if JOBS[name].quick:
            do = partial(JOBS[name].do, given, _untold)
            if JOBS[name].of_a_cell:
                await anyio.to_thread.run_sync(sound, given["cell"])
            return JSONResponse(await anyio.to_thread.run_sync(do))
        return JSONResponse(await session.pool.document(name, given))

    return handler


def _untold(data: Json) -> None:
    """Nobody waits for what is known meanwhile."""


async def stream(request: Request, session: Session) -> Response:
    query = dict(request.query_params)
    query.pop("token", None)
    which: Json = {key: query.pop(key) for key in ("draft", "file") if key in query}
    name = session.name_of(which)
    lang = read({"lang": query.pop("lang", None)}, {"lang": LANGUAGE})
    options = {key: _value(text) for key, text in query.items()}
    read(options, OPTIONS, where="options.")
    cell = await anyio.to_thread.run_sync(session.document, which)
    asked = {"cell": cell, "options": options, **lang}
    events = session.pool.events("plan", asked, is_stream=True)
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

    # when the server ends, the stream is not cut off before its search has said what it found
    return EventSourceResponse(told(), ping=15, shutdown_grace_period=GRACE_S + 1)


def _value(text: str) -> Any:
    """A value in the address: JSON where it is some, else text."""
    try:
        return json.loads(text)
    except ValueError:
        return text


def _event(event: str, data: Json) -> ServerSentEvent:
    return ServerSentEvent(json.dumps(data, ensure_ascii=False), event=event)


async def stop(request: Request, session: Session) -> Response:
    given = read(await body_of(request), {"run": WHOLE})
    return JSONResponse({"stopped": session.pool.stop(given.get("run"))})


async def report(request: Request, session: Session) -> Response:
    told = await session.pool.document("report", await asked_job("report", request, session))
    name = told["name"]
    return Response(
        base64.b64decode(told["content"]),
        media_type=told["type"],
        headers={"content-disposition": f'attachment; filename="{name}"'},
    )


async def import_(request: Request, session: Session) -> Response:
    query = request.query_params
    raw = await request.body()
    if not raw:
        raise UsageError("there is no workbook in the request: send the file's bytes as the body.")
    many = {key: query.getlist(key) for key in ("map", "human", "robot", "machine")}
    one = {key: query[key] for key in query if key not in many}
    given = {"name": "workbook.xlsx", **one, **{key: texts for key, texts in many.items() if texts}}
    content = base64.b64encode(raw).decode()
    job = JOBS["import"].asked({**given, "content": content})
    told = await session.pool.document("import", job)
    return JSONResponse(told, 422 if "error" in told else 200)


async def openapi(request: Request, session: Session) -> Response:
    return JSONResponse(document(ROUTES))


# --- the table ------------------------------------------------------------------------------------

FILE = {"file": (string(), "Which file of the folder; the first when absent.")}
VERSION = string(description="Changes when the file's content does.")

ROUTES: tuple[Route, ...] = (
    Route(
        "GET",
        "/api/health",
        health,
        "Whether the server answers, and its version.",
        answers={200: table(status={"const": "ok"}, version=string())},
    ),
    Route(
        "GET",
        "/api/cell",
        get_cell,
        "The cell file as it stands on the disk; one that is no sound cell with its errors.",
        query=FILE,
        answers={
            200: table(
                cell=ANYTHING,
                version=VERSION,
                name=string(),
                format={"const": FORMAT},
                **{"errors?": ERRORS, "draft?": table(cell=ANYTHING, version=or_null(string()))},
            ),
            **fails(403, 404, 422),
        },
    ),
    Route(
        "PUT",
        "/api/cell",
        put_cell,
        "Saves the cell, never over a file that has changed since it was read.",
        asks=({"cell": TABLE, "version": TEXT}, ("cell",)),
        query=FILE,
        answers={
            200: table(version=VERSION),
            409: table(error=string(), version=or_null(string()), cell=ANYTHING),
            **fails(400, 403, 422),
        },
    ),
    Route(
        "POST",
        "/api/check",
        check,
        "What is wrong with a cell; nothing is written.",
        asks=({"cell": TABLE}, ("cell",)),
        answers={200: table(errors=ERRORS), **fails(400, 403)},
    ),
    Route(
        "POST",
        "/api/draft",
        draft,
        "Holds a cell that is not saved, to plan it, and to keep it when the server is stopped;"
        " without a cell, forgets what is held for the file.",
        asks=({"cell": TABLE, "version": TEXT, "file": TEXT}, ()),
        answers={200: table(draft=or_null(string())), **fails(400, 403)},
    ),
    Route(
        "GET",
        "/api/files",
        files,
        "The cell files of the folder.",
        answers={200: table(files=rows(table(name=string())))},
    ),
    Route(
        "POST",
        "/api/plan",
        answered_by("plan"),
        "The plan document, as `tandem plan --json` prints it; `options` are its options.",
        asks="plan",
        answers={200: PLAN, **fails(400, 403, 422, 503)},
    ),
    Route(
        "GET",
        "/api/plan/stream",
        stream,
        "The same as it is found, as server-sent events: `started`, `progress`, `done`, `failed`.",
        query={
            "token": (string(), "An event source sends no headers."),
            "draft": (string(), "A cell that is held."),
            "lang": (LANGUAGE.schema, "Of the reasons why there is no plan."),
            **FILE,
            **{
                name: (kind.schema, f"As the option of `tandem plan`: {kind.words}.")
                for name, kind in OPTIONS.items()
            },
        },
        answers={200: "text/event-stream", **fails(400, 403, 422, 503)},
    ),
    Route(
        "POST",
        "/api/plan/stop",
        stop,
        "Ends the streams' searches, or the `run` of this number, with what they have found.",
        asks=({"run": WHOLE}, ()),
        answers={200: table(stopped=rows({"type": "integer"})), **fails(400, 403)},
    ),
    Route(
        "POST",
        "/api/place",
        answered_by("place"),
        "What it would mean to put a task elsewhere, as a dragged bar does.",
        asks="place",
        answers={
            200: table(
                allowed={"type": "boolean"},
                reasons=rows(string()),
                makespan={"type": "number"},
                stress=or_null({"type": "number"}),
                faults=rows(string()),
                assignments=ASSIGNMENTS,
                ways=rows(
                    table(
                        operators=rows(string()),
                        time={"type": "number"},
                        stress={"type": "number"},
                    )
                ),
            ),
            **fails(400, 403, 422),
        },
    ),
    Route(
        "POST",
        "/api/measures",
        answered_by("measures"),
        "The lanes of a schedule's Gantt chart, how each operator fares, what is critical, why each"
        " task starts when it does; with `before`, what differs from that schedule. Of a schedule"
        " that breaks its cell only the lanes and the last.",
        asks="measures",
        answers={200: MEASURES, **fails(400, 403, 422)},
    ),
    Route(
        "POST",
        "/api/compare",
        answered_by("compare"),
        "What differs between `cell` and `other`; with the points of both fronts, what becomes of"
        " each of the first.",
        asks="compare",
        answers={200: COMPARED, **fails(400, 403, 422)},
    ),
    Route(
        "POST",
        "/api/recommend",
        answered_by("recommend"),
        "Which of some points is recommended within limits: by the `share` of attention that stress"
        " gets, else the knee; and the `--weights` that mean the same.",
        asks="recommend",
        answers={
            200: table(
                point=or_null({"type": "integer"}),
                weights=or_null(rows({"type": "number"})),
                within=rows({"type": "integer"}),
            ),
            **fails(400, 403),
        },
    ),
    Route(
        "POST",
        "/api/graph",
        answered_by("graph"),
        "The precedence graph in layers: where each task stands, in columns and rows, and the curve"
        " of each arrow: its start, then threes of control points. Arrows that follow from others,"
        " or close a circle, have none.",
        asks="graph",
        answers={
            200: table(
                node=PAIR.schema,
                at=rows(table(task=string(), at=PAIR.schema)),
                arrows=rows(table(task=string(), after=string(), curve=rows(PAIR.schema))),
            ),
            **fails(400, 403),
        },
    ),
    Route(
        "POST",
        "/api/replan",
        answered_by("replan"),
        "The rest planned anew with the fewest changes.",
        asks="replan",
        answers={
            200: table(point=POINT, sentence=string(), complete={"type": "boolean"}, document=PLAN),
            **fails(400, 403, 422, 503),
        },
    ),
    Route(
        "POST",
        "/api/explain",
        answered_by("explain"),
        "Why a schedule is so, and what every other choice would cost.",
        asks="explain",
        answers={
            200: table(sentences=rows(string()), document={"type": "object"}),
            **fails(400, 403, 422, 503),
        },
    ),
    Route(
        "POST",
        "/api/report",
        report,
        "A plan as a file: report, table, picture, workbook; with `chart`, that one alone as a"
        " picture.",
        asks="report",
        answers={200: "application/octet-stream", **fails(400, 403, 422, 503)},
    ),
    Route(
        "POST",
        "/api/import",
        import_,
        "The cell in a workbook, whose bytes are the body; nothing is written. Where it gives none,"
        " what was `seen` of it comes with the errors.",
        asks="application/octet-stream",
        query={
            "name": (string(), "Of the workbook; its ending says what it is."),
            "sheet": (string(), "The sheet with the tasks."),
            "map": (string(), "HEADER=MEANING of a column; may be repeated."),
            "human": (string(), "An operator that is a human; may be repeated."),
            "robot": (string(), "An operator that is a robot; may be repeated."),
            "machine": (string(), "An operator that is a machine; may be repeated."),
            "lang": (LANGUAGE.schema, "Of the notes."),
        },
        answers={
            200: table(
                cell={"type": "object"},
                sheet=string(),
                sheets=rows(string()),
                columns=rows(table(place=string(), header=string(), meaning=or_null(string()))),
                operators=rows(table(name=string(), kind=string())),
                rows=rows(rows(string())),
                notes=rows(table(kind=string(), place=string(), message=string())),
            ),
            **fails(400, 403, 413, 422, 503),
        },
    ),
    Route(
        "GET",
        "/api/openapi.json",
        openapi,
        "This document.",
        answers={200: {"type": "object"}},
    ),
)
"""Every address, and what it answers."""
