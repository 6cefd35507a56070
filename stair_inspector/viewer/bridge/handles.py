"""viser's handles of controls, and the identity by which scripts of a page write to them."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any, Protocol

import viser


class _State(Protocol):
    @property
    def uuid(self) -> str: ...


class Handle(Protocol):
    """Anything of a page that scripts can write to."""

    @property
    def _impl(self) -> _State: ...


class Setter(Handle, Protocol):
    """A control that holds a setting, of whatever kind; viser's own types do not say that values can be set."""

    value: Any

    @property
    def on_update(self) -> Callable[[Callable[[Any], None]], object]:
        """Attach what is called when the value has changed."""


def late_messages(client: viser.ClientHandle) -> AbstractContextManager[None]:
    """Return the context in which messages may come too late for their page.

    A browser may go while something is shown to it, before the server has told the page. viser warns of messages to a
    connection that is closed; these are no mistake.
    """
    connection: Any = client.gui._websock_interface
    late: AbstractContextManager[None] = connection.get_message_buffer().sanctioned_dead_writes()
    return late


def uuid_of(handle: Handle) -> str:
    """Return the identity of a control; the name is private to viser, hence the exact version it is pinned to."""
    return str(handle._impl.uuid)
