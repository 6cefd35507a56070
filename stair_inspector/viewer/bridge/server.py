"""What is private to viser's server: the sender of its messages, its share tunnel and the connections of its pages.

The names used here are private to viser, hence the exact version in ``pyproject.toml`` and tests of each function.
"""

import asyncio

import viser
import viser._messages

from stair_inspector.viewer.bridge.wakeups import keep_waking


def prepare_server(server: viser.ViserServer) -> None:
    """Mend how a server is woken, and take its share tunnel away.

    By two messages any page could open a public tunnel to the server. Hiding the button would not do: a page can send
    the message all the same.
    """
    keep_waking(server._websock_server)
    for message in (viser._messages.ShareUrlRequest, viser._messages.ShareUrlDisconnect):
        server._websock_server.unregister_handler(message)


def prepare_client(client: viser.ClientHandle) -> None:
    """Mend how the sender of one page's messages is woken."""
    keep_waking(client._websock_connection)


def close_connection(server: viser.ViserServer, client: viser.ClientHandle) -> None:
    """Close the connection of a page; a browser that is only slow connects again by itself."""
    websockets = server._websock_server
    connection = websockets._live_connections.get(client.client_id)
    loop = websockets._background_event_loop
    if connection is not None and loop is not None:
        asyncio.run_coroutine_threadsafe(connection.close(), loop)
