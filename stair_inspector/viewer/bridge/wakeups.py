"""Whoever sends a page its messages is woken for new ones: viser's own call may be lost, and with it the page.

What is wrong in viser 1.1.1, as it could be told to its authors:

    A page stops for good when ``AsyncMessageBuffer.push`` is called from another thread at one particular moment.

    What happens. ``_window_loop`` in ``viser/infra/_async_message_buffer.py`` sleeps in ``await
    self.message_event.wait()`` when there is nothing to send. ``push`` sets that ``asyncio.Event`` twice: at once, from
    the thread that pushes, and by ``event_loop.call_soon_threadsafe(self.message_event.set)``. Events of asyncio are
    not safe for threads. ``Event.wait`` first looks at the flag and then, if it is not set, appends its future to the
    waiters. When the thread sets the flag between the two, there is no waiter to be woken yet; and the second ``set``,
    on the loop, finds the flag set and does nothing. So does every later one: only the sleeper clears the flag.

    When. Whenever a thread pushes in that moment: callbacks run on a pool of threads, so any of them may. In an atomic
    block the first call is made by ``push`` and the second by ``atomic_end``. No error is raised or logged.

    What one sees. The connection stays open and the browser's messages arrive, but the server sends that page nothing
    any more: it shows what it showed, and nothing that a person does on it is answered until it is loaded again.

    What was expected. Every push wakes the sender.

    A way to mend it. Set the event on its own loop alone, ``call_soon_threadsafe(self.message_event.set)``, which runs
    between two steps of ``Event.wait`` and never within one; or let the loop's call clear the flag before it sets it.
    The comment in ``push`` says that the first call is there for synchronous logic that reads the flag; nothing in
    1.1.1 reads it.

What is done here: :func:`keep_waking` puts an event in the place of viser's that ignores ``set`` from any thread but
that of its loop, so that of the two calls the one that cannot be lost remains. It touches names that are private to
viser, hence the exact version in ``pyproject.toml``. ``tests/viewer/bridge/test_wakeups.py`` makes the moment happen,
shows that viser alone then loses the call, and will fail with a version that does not.
"""

import asyncio
from typing import Any


def keep_waking(handler: Any) -> None:
    """Replace the event on which the sender of a server's or a page's messages sleeps.

    A call that was lost before is made up for.

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
