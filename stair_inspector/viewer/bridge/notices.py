"""How a page hears of what failed: a sentence on the page, and for what nobody foresaw a line in the server's log."""

import asyncio
import logging
import math
import time
from collections.abc import Callable, Coroutine
from typing import Protocol

import viser

from stair_inspector.errors import StairError
from stair_inspector.viewer.bridge.handles import late_messages

logger = logging.getLogger(__name__)

_SHOWN_S = 12.0
_REPEATED_S = 1.0


class Notices:
    """Notifications of one page, and the guard around everything that viser calls."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client = client
        self._last: tuple[str, str, float] = ("", "", -math.inf)
        self.is_closed = False

    def tell(self, title: str, words: str, *, is_failure: bool = False) -> None:
        """Show a notification; nothing once the page has gone, and nothing twice while a key is held."""
        last_title, last_words, told_at = self._last
        is_repeated = (last_title, last_words) == (title, words) and time.monotonic() - told_at < _REPEATED_S
        self._last = (title, words, time.monotonic())
        if not (self.is_closed or is_repeated):
            with late_messages(self._client):
                self._client.add_notification(
                    title, " ".join(words.split()), color="red" if is_failure else None, auto_close_seconds=_SHOWN_S
                )

    def guard(self, action: Callable[..., None]) -> Callable[..., None]:
        """Wrap an action so that its failure is a sentence on the page, not a line in the server's log."""

        def guarded(*values: object) -> None:
            try:
                action(*values)
            except StairError as error:
                self.tell("Not done", str(error), is_failure=True)
            except Exception:  # noqa: BLE001 - the outermost frame of a thread of viser's, which would only print it
                self.log("an action of a page failed")
                self.tell(
                    "Not done",
                    "an internal error stopped this action; the server's log has the details. The page goes on",
                    is_failure=True,
                )

        return guarded

    def log(self, words: str) -> None:
        """Log an unforeseen failure with its traceback: once a page has gone, failing is what is left."""
        logger.log(logging.DEBUG if self.is_closed else logging.ERROR, words, exc_info=True)


class Event(Protocol):
    """What viser tells of an event: ``client`` is None where the server itself has set the value."""

    @property
    def client(self) -> viser.ClientHandle | None:
        """The page that did it."""


def from_page(action: Callable[..., None], read: Callable[[], object] | None = None) -> Callable[[Event], None]:
    """Return a callback that calls an action for what a person did, not for what the server itself has set.

    Parameters
    ----------
    action : callable
        Called with what ``read`` returns, or with nothing.
    read : callable, optional
        Returns the control's value: that of now, since viser runs callbacks on many threads at once.
    """

    def called(event: Event) -> None:
        if event.client is not None:
            action(*(() if read is None else (read(),)))

    return called


def orders_from_page(
    action: Callable[..., None], read: Callable[[], object]
) -> Callable[[Event], Coroutine[None, None, None]]:
    """Return a callback for a control into which buttons of a list write: each order is read as it comes.

    viser awaits it before it takes the next message. An action that reads the control on a thread of its own may find
    the order that came next.
    """

    async def called(event: Event) -> None:
        if event.client is not None:
            asyncio.get_running_loop().run_in_executor(None, action, read())

    return called
