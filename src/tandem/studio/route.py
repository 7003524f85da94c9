"""What a line of the table of addresses says."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field

from starlette.requests import Request
from starlette.responses import Response

from tandem.studio.asked import Json, Kind
from tandem.studio.session import Session

Handler = Callable[[Request, Session], Awaitable[Response]]


@dataclass(frozen=True)
class Route:
    """A line of the table.

    Attributes:
      what: is answered, in a sentence.
      asks: the keys of the body and those that are needed; the name of a job, whose keys they are;
        a media type where it is no JSON; None where there is no body.
      query: name -> JSON Schema and a sentence.
      answers: status -> JSON Schema of the answer; a media type where it is no JSON.
    """

    method: str
    path: str
    handler: Handler
    what: str
    asks: tuple[Mapping[str, Kind], tuple[str, ...]] | str | None = None
    query: Mapping[str, tuple[Json, str]] = field(default_factory=dict)
    answers: Mapping[int, Json | str] = field(default_factory=dict)
