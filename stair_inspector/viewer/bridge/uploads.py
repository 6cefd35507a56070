"""Uploads are checked before they are received: viser itself takes any file of any size into memory."""

from collections.abc import Callable
from typing import Any

import viser
import viser._messages

from stair_inspector.errors import ConfigError, StairError

_SHOWN_S = 15.0
LARGEST_SMALL_BYTES = 20_000_000
"""Of uploads that are no scans: presets, rule files, projects and pictures for the report."""
SMALL_SUFFIXES = (".toml", ".json", ".png", ".jpg", ".jpeg")


def limit_uploads(client: viser.ClientHandle, check: Callable[[str, int], None], refusal: str = "") -> None:
    """Refuse uploads that do not fit their button, and parts that are more than was said.

    A button that offers small files alone takes no others; scans are refused where ``check(name, size)`` raises. A page
    that may upload nothing is told the ``refusal``.

    The names used here are private to viser, hence the exact version in ``pyproject.toml`` and tests that upload.
    """
    gui: Any = client.gui
    start_of, part_of = viser._messages.FileTransferStartUpload, viser._messages.FileTransferPart
    connection: Any = gui._websock_interface
    connection.unregister_handler(start_of, gui._handle_file_transfer_start)
    connection.unregister_handler(part_of, gui._handle_file_transfer_part)

    def start(client_id: int, message: Any) -> None:
        try:
            if refusal:
                raise ConfigError(f"upload: {refusal}")
            button = gui._gui_input_handle_from_uuid.get(message.source_component_uuid)
            _check(str(message.filename), message.size_bytes, _suffixes_of(button), check)
        except StairError as error:
            # The page waits for the parts to be acknowledged, and would then say that all went well.
            connection.queue_message(
                viser._messages.FileTransferPartAck(
                    source_component_uuid=message.source_component_uuid,
                    transfer_uuid=message.transfer_uuid,
                    transferred_bytes=message.size_bytes,
                    total_bytes=message.size_bytes,
                )
            )
            connection.queue_message(viser._messages.RemoveNotificationMessage(f"upload-{message.transfer_uuid}"))
            client.add_notification("Not done", str(error), color="red", auto_close_seconds=_SHOWN_S)
            return
        gui._handle_file_transfer_start(client_id, message)

    def part(client_id: int, message: Any) -> None:
        state = gui._current_file_upload_states.get(message.transfer_uuid)
        if state is None:
            return
        if state["transferred_bytes"] + len(message.content) > state["total_bytes"]:
            gui._current_file_upload_states.pop(message.transfer_uuid, None)
            return
        gui._handle_file_transfer_part(client_id, message)

    connection.register_handler(start_of, start)
    connection.register_handler(part_of, part)


def _suffixes_of(button: Any) -> tuple[str, ...]:
    """Return what files the dialog of a button offers."""
    return tuple(str(button.mime_type).split(",")) if isinstance(button, viser.GuiUploadButtonHandle) else ()


def _check(name: str, size: object, suffixes: tuple[str, ...], check: Callable[[str, int], None]) -> None:
    n_bytes = size if isinstance(size, int) else 0
    if not suffixes or not set(suffixes) <= set(SMALL_SUFFIXES):
        check(name, n_bytes)
        return
    if not name.lower().endswith(suffixes):
        raise ConfigError(f"upload: {name[:60]!r} does not belong here; give a file that ends in {', '.join(suffixes)}")
    if n_bytes <= 0:
        raise ConfigError(f"upload: {name[:60]!r} is empty; give another file")
    if n_bytes > LARGEST_SMALL_BYTES:
        raise ConfigError(
            f"upload: {name[:60]!r} has {n_bytes / 1e6:,.1f} MB and {LARGEST_SMALL_BYTES / 1e6:,.0f} MB are allowed; "
            "give a smaller file"
        )
