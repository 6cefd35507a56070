"""What is private to viser's server: its sender of messages, its share tunnel, its icons and its pages' connections.

The names used here are private to viser, hence the exact version in ``pyproject.toml`` and tests of each function.
"""

import asyncio
import functools

import viser
import viser._gui_api
import viser._gui_handles
import viser._icons
import viser._messages

from stair_inspector.viewer.bridge.doors.gate import GuardedConnection
from stair_inspector.viewer.bridge.wakeups import keep_waking


def prepare_server(server: viser.ViserServer) -> None:
    """Mend how a server is woken, have it read each icon once, and take its share tunnel away.

    By two messages any page could open a public tunnel to the server. Hiding the button would not do: a page can send
    the message all the same.
    """
    keep_waking(server._websock_server)
    _read_icons_once()
    for message in (viser._messages.ShareUrlRequest, viser._messages.ShareUrlDisconnect):
        server._websock_server.unregister_handler(message)


def _read_icons_once() -> None:
    """Let viser keep every icon that it has read.

    It keeps the last 32. A page has more, in the same order each time, so that each page would open the archive of all
    icons again for every button, which is a quarter of the time that a page takes to make.
    """
    kept = functools.cache(viser._icons.svg_from_icon.__wrapped__)
    for module in (viser._gui_api, viser._gui_handles):
        setattr(module, kept.__name__, kept)


def prepare_client(client: viser.ClientHandle) -> None:
    """Mend how the sender of one page's messages is woken."""
    keep_waking(client._websock_connection)


def is_view_only(server: viser.ViserServer, client: viser.ClientHandle) -> bool:
    """Return whether a page may change nothing; one that has gone may not."""
    connection = server._websock_server._live_connections.get(client.client_id)
    return not isinstance(connection, GuardedConnection) or connection.is_view_only


def close_connection(server: viser.ViserServer, client: viser.ClientHandle) -> None:
    """Close the connection of a page; a browser that is only slow connects again by itself."""
    websockets = server._websock_server
    connection = websockets._live_connections.get(client.client_id)
    loop = websockets._background_event_loop
    if connection is not None and loop is not None:
        asyncio.run_coroutine_threadsafe(connection.close(), loop)
