"""What a page sends for a control is of the control's own kind, or else viser would fail with a traceback."""

import math
from typing import Any

import viser
import viser._messages


def check_values(client: viser.ClientHandle) -> None:
    """Pass over what is sent for a control that holds another kind of value; the page itself never sends it.

    The names used here are private to viser, hence the exact version in ``pyproject.toml``.
    """
    gui: Any = client.gui
    kind = viser._messages.GuiUpdateMessage
    gui._websock_interface.unregister_handler(kind, gui._handle_gui_updates)

    async def update(client_id: int, message: Any) -> None:
        handle = gui._gui_input_handle_from_uuid.get(message.uuid)
        if handle is not None and fits(handle._impl.value, message.updates["value"]):
            await gui._handle_gui_updates(client_id, message)

    gui._websock_interface.register_handler(kind, update)


def fits(known: object, sent: object) -> bool:
    """Return whether a value can stand where another one stood; whether it is in range is another question."""
    if isinstance(known, bool) or isinstance(sent, bool):
        return isinstance(known, bool) and isinstance(sent, bool)
    if isinstance(known, int):
        return isinstance(sent, int | float) and math.isfinite(sent)
    if isinstance(known, float):
        return isinstance(sent, int | float)
    if isinstance(known, tuple):
        return (
            isinstance(sent, list | tuple) and len(sent) == len(known) and all(map(fits, known[:1] * len(known), sent))
        )
    return isinstance(known, str) and isinstance(sent, str)
