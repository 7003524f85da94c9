"""The application: routes behind the guard, every error in one shape, the page."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import AsyncIterator, Awaitable, Callable
from importlib import resources
from pathlib import Path

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute
from starlette.routing import Route as StarletteRoute

from tandem.errors import TandemError, UsageError
from tandem.studio.failures import Json, failure
from tandem.studio.folder import MissingError, OutsideError
from tandem.studio.guard import READING, App, Guard
from tandem.studio.page import Page
from tandem.studio.pool import BusyError, Failed
from tandem.studio.route import Handler
from tandem.studio.routes import ROUTES
from tandem.studio.session import Session

STATIC = Path(str(resources.files("tandem.studio") / "static"))
"""The page: what stands here is sent as it is."""
log = logging.getLogger("tandem.studio")


def application(session: Session, *, hosts: tuple[str, ...], token: str) -> App:
    """The studio as an ASGI application.

    Args:
      hosts, token: as the guard takes them.
    """

    @contextlib.asynccontextmanager
    async def alive(_: Starlette) -> AsyncIterator[None]:
        await session.pool.start()
        try:
            yield
        finally:
            await session.pool.close()

    routes: list[BaseRoute] = [
        StarletteRoute(route.path, _endpoint(route.handler, session), methods=[route.method])
        for route in ROUTES
    ]
    page = Page(STATIC)
    routes.append(StarletteRoute("/", page.first))
    routes.append(StarletteRoute("/static/{version}/{name:path}", page.file))
    app = Starlette(
        routes=routes, lifespan=alive, exception_handlers={HTTPException: _told_by_starlette}
    )
    app.router.redirect_slashes = False
    return Guard(app, hosts=hosts, token=token, with_token=("/api/plan/stream",))


def _endpoint(handler: Handler, session: Session) -> Callable[[Request], Awaitable[Response]]:
    async def endpoint(request: Request) -> Response:
        if request.method not in READING:
            # a page has come that will plan; until then its own files are sent the sooner
            await session.pool.wake()
        try:
            return await handler(request, session)
        except TandemError as error:
            return _told(error)
        except Failed as failed:
            return JSONResponse(failed.told, _status(failed.told["exit"]))
        except BusyError as error:
            return JSONResponse({"error": str(error)}, 503, {"retry-after": "5"})
        except OSError as error:
            why = (error.strerror or str(error)).lower()
            return JSONResponse({"error": f"it cannot be written: {why}."}, 507)
        except Exception as error:
            log.exception("a bug")
            what = f"{type(error).__name__}: {error}"
            return JSONResponse(
                {"error": f"this is a bug in Tandem, not in your input: {what}", "exit": 1}, 500
            )

    return endpoint


def _told(error: TandemError) -> Response:
    told: Json = failure(error)
    if isinstance(error, OutsideError):
        return JSONResponse(told, 403)
    if isinstance(error, MissingError):
        return JSONResponse(told, 404)
    return JSONResponse(told, 400 if isinstance(error, UsageError) else 422)


def _status(exit_code: int) -> int:
    """The HTTP status of a job that ended with this exit code."""
    return {1: 500, 2: 400}.get(exit_code, 422)


async def _told_by_starlette(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    return JSONResponse({"error": f"{error.detail}."}, error.status_code, error.headers)
