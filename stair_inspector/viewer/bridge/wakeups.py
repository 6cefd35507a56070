"""Whoever sends a page its messages is woken for new ones: viser's own call may be lost, and with it the page."""

import asyncio
from typing import Any


def keep_waking(handler: Any) -> None:
    """Replace the event on which the sender of a server's or a page's messages sleeps.

    Any thread that has a message sets the event, and has it set once more by the thread of the event loop. Where the
    first falls between the sender's look at the event and its going to sleep, the second finds it set and wakes nobody.
    Of a page's own messages no later one does either: it shows what it showed, and nothing that a person does is
    answered, until it is loaded again. The new event is set by the event loop alone, which cannot fall between.

    The names used here are private to viser, hence the exact version in ``pyproject.toml`` and a test in which viser
    alone loses the call.

    Parameters
    ----------
    handler : viser's WebsockMessageHandler
        Of the server, for what every page is sent, or of one page.
    """
    buffer = handler.get_message_buffer()
    loop: asyncio.AbstractEventLoop = buffer.event_loop
    before: asyncio.Event = buffer.message_event
    buffer.message_event = _EventOfLoop(loop)

    def wake_the_sleeper() -> None:
        # Where a call has been lost already the old event is set, and to set it again would wake nobody.
        before.clear()
        before.set()

    loop.call_soon_threadsafe(wake_the_sleeper)


class _EventOfLoop(asyncio.Event):
    """An event that only its own event loop sets; a call from any other thread does nothing."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__()
        self._setter = loop

    def set(self) -> None:
        try:
            running = asyncio.get_running_loop()
        except RuntimeError:
            return
        if running is self._setter:
            super().set()
