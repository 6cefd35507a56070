"""The doors stand before viser's server: every request, and every message of a page, passes them first."""

import contextlib
import dataclasses
import http
import threading
from collections.abc import Awaitable, Callable, Iterator

import websockets.asyncio.server
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response
from websockets.typing import Data

from stair_inspector.viewer.bridge.doors.doors import DoorAnswer, DoorCall, Doors
from stair_inspector.viewer.bridge.doors.messages import is_accepted

Answering = Callable[[ServerConnection, Request], Response | Awaitable[Response | None] | None]

_STARTING = threading.Lock()


class GuardedConnection(ServerConnection):
    """A connection that hands on only what a page may send, and knows whether its page may change anything."""

    is_view_only = True

    async def recv(self, decode: bool | None = None) -> Data:  # type: ignore[override]
        """Return the next message that is one; what is none is passed over, as is what follows it."""
        while True:
            message = await super().recv(decode)
            if isinstance(message, bytes) and is_accepted(message):
                return message


@contextlib.contextmanager
def guarded(doors: Doors) -> Iterator[None]:
    """Let the server that is started meanwhile ask the doors first.

    viser hands its own answer to requests to ``websockets`` and offers no place for another before it; were the doors
    put in afterwards, a page could slip in before.
    """
    serve: type[websockets.asyncio.server.serve] = websockets.asyncio.server.serve

    def serve_guarded(*args: object, process_request: Answering, **options: object) -> websockets.asyncio.server.serve:
        return serve(
            *args,  # type: ignore[arg-type]
            process_request=doors_first(doors, process_request),
            create_connection=GuardedConnection,
            server_header=None,
            **options,  # type: ignore[arg-type]
        )

    with _STARTING:
        websockets.asyncio.server.serve = serve_guarded  # type: ignore[assignment, misc]
        try:
            yield
        finally:
            websockets.asyncio.server.serve = serve  # type: ignore[misc]


def doors_first(doors: Doors, answering: Answering) -> Answering:
    """Return what answers a request: the doors, and whoever answered before for what they let in."""

    def answer(connection: ServerConnection, request: Request) -> Response | None:
        call = _call(request)
        told = doors.ask(call)
        if told.html is not None:
            return _response(told)
        if isinstance(connection, GuardedConnection):
            connection.is_view_only = told.is_view_only
        if call.is_websocket:
            return None
        response = answering(connection, dataclasses.replace(request, path=told.path))
        if isinstance(response, Response):
            response.headers.update(told.headers)
            return response
        # It answers at once and with something, or else nobody can say what it would let through.
        return _response(dataclasses.replace(told, status=500, html="no answer"))

    return answer


def _call(request: Request) -> DoorCall:
    """Return what the doors are asked; a field that stands twice counts as what no field can be."""
    headers: dict[str, str] = {}
    for name, value in request.headers.raw_items():
        headers[name.lower()] = "" if name.lower() in headers and name.lower() in ("host", "origin") else value
    return DoorCall(request.path, headers, headers.get("upgrade", "").lower() == "websocket")


def _response(told: DoorAnswer) -> Response:
    status = http.HTTPStatus(told.status)
    # What was asked for may hold bytes that are no text.
    body = (told.html or "").encode("utf-8", "replace")
    headers = Headers(told.headers)
    headers.update(
        {"Content-Type": "text/html; charset=utf-8", "Content-Length": str(len(body)), "Connection": "close"}
    )
    return Response(status, status.phrase, headers, body)
