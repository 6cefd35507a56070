"""Whoever sends a page its messages is woken for new ones: viser's own call may be lost, and with it the page."""

import asyncio
from collections.abc import Callable
from typing import Any


def keep_waking(handler: Any) -> None:
    """Mend the event on which the sender of a server's or a page's messages sleeps.

    Any thread that has a message sets the event, and has it set once more by the thread of the event loop. Where the
    first falls between the sender's look at the event and its going to sleep, the second finds it set and wakes nobody.
    Of a page's own messages no later one does either: it shows what it showed, and nothing that a person does is
    answered, until it is loaded again. Here only the event loop sets the event, which cannot fall between.

    The names used here are private to viser, hence the exact version in ``pyproject.toml`` and a test in which viser
    alone loses the call.

    Parameters
    ----------
    handler : viser's WebsockMessageHandler
        Of the server, for what every page is sent, or of one page.
    """
    buffer = handler.get_message_buffer()
    event: asyncio.Event = buffer.message_event
    wake: Callable[[], None] = event.set

    def wake_from_the_loop() -> None:
        if _running_loop() is buffer.event_loop:
            # A call that was lost before the mend has left it set, and setting it again would wake nobody.
            event.clear()
            wake()

    event.set = wake_from_the_loop  # type: ignore[method-assign]


def _running_loop() -> asyncio.AbstractEventLoop | None:
    """Return the event loop of the calling thread, if it runs one."""
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        return None
