"""The doors stand before viser's server: every request, and every message of a page, passes them first."""

import contextlib
import dataclasses
import http
import threading
from collections.abc import Awaitable, Callable, Iterator, Sequence
from typing import Literal, overload

from websockets.asyncio import server
from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.http11 import Request, Response
from websockets.typing import Data, Subprotocol

from stair_inspector.viewer.bridge.doors.doors import DoorAnswer, DoorCall, Doors
from stair_inspector.viewer.bridge.doors.messages import is_accepted

Answering = Callable[[ServerConnection, Request], Response | Awaitable[Response | None] | None]

_STARTING = threading.Lock()


class GuardedConnection(ServerConnection):
    """A connection that hands on only what a page may send, and knows whether its page may change anything."""

    is_view_only = True

    @overload
    async def recv(self, decode: Literal[True]) -> str: ...

    @overload
    async def recv(self, decode: Literal[False]) -> bytes: ...

    @overload
    async def recv(self, decode: bool | None = None) -> Data: ...

    async def recv(self, decode: bool | None = None) -> Data:
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

    class GuardedServe(serve):
        """Takes what viser gives, and nothing else: another version's new option would be an error, not a gap."""

        def __init__(
            self,
            handler: Callable[[ServerConnection], Awaitable[None]],
            host: str,
            port: int,
            *,
            max_size: int,
            compression: str | None,
            process_request: Answering,
            subprotocols: Sequence[Subprotocol] | None,
            select_subprotocol: Callable[[ServerConnection, Sequence[Subprotocol]], Subprotocol | None],
        ) -> None:
            super().__init__(
                handler,
                host,
                port,
                max_size=max_size,
                compression=compression,
                process_request=doors_first(doors, process_request),
                subprotocols=subprotocols,
                select_subprotocol=select_subprotocol,
                server_header=None,
                create_connection=GuardedConnection,
            )

    with _STARTING:
        setattr(server, serve.__name__, GuardedServe)
        try:
            yield
        finally:
            setattr(server, serve.__name__, serve)


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
