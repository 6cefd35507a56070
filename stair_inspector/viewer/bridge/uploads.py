"""Uploads are checked before they are received: viser itself takes any file of any size into memory."""

import threading
import time
from collections.abc import Callable
from typing import Any

import viser
import viser._messages

from stair_inspector.errors import ConfigError, StairError

_SHOWN_S = 15.0
LARGEST_SMALL_BYTES = 20_000_000
"""Of uploads that are no scans: presets, rule files, projects and pictures for the report."""
SMALL_SUFFIXES = (".toml", ".json", ".png", ".jpg", ".jpeg")
_LEAST_PART_BYTES = 65_536
_STALLED_S = 60.0
"""An upload of which nothing has come for so long makes room for another."""


class UnfinishedUploads:
    """The uploads of all pages that have begun and not ended: viser keeps their parts in memory.

    Parameters
    ----------
    limit_bytes : int
        Of what they may announce together; one that is alone is not held to it.
    """

    def __init__(self, limit_bytes: int) -> None:
        self._limit_bytes = limit_bytes
        self._lock = threading.Lock()
        self._by_page: dict[int, dict[str, Any]] = {}
        # By page and name: a page chooses the name of an upload, and may take that of another's.
        self._heard_at: dict[tuple[int, str], float] = {}

    def begin(self, page: int, states: dict[str, Any], transfer: str, n_bytes: int) -> None:
        """Take an upload of a page in, of which viser keeps the ``states``.

        Raises
        ------
        ConfigError
            It would be too much with the others.
        """
        now = time.monotonic()
        with self._lock:
            self._by_page[page] = states
            others = [
                (held, (number, each))
                for number, held in self._by_page.items()
                for each in list(held)
                if (number, each) != (page, transfer)
            ]
            self._heard_at = {key: self._heard_at.get(key, now) for _, key in others}
            for held, key in others:
                if now - self._heard_at[key] > _STALLED_S:
                    held.pop(key[1], None)
            total = sum(held[key[1]]["total_bytes"] for held, key in others if key[1] in held)
            if total and total + n_bytes > self._limit_bytes:
                raise ConfigError(
                    f"upload: other files of {total / 1e6:,.0f} MB are being uploaded, and "
                    f"{self._limit_bytes / 1e6:,.0f} MB may be at a time; try again when they have come"
                )
            self._heard_at[page, transfer] = now

    def heard(self, page: int, transfer: str) -> None:
        """Note that a part of an upload of a page has come."""
        with self._lock:
            self._heard_at[page, transfer] = time.monotonic()

    def forget(self, page: int) -> None:
        """Forget the uploads of a page that has gone."""
        with self._lock:
            self._by_page.pop(page, None)


def limit_uploads(
    client: viser.ClientHandle,
    check: Callable[[str, int], None],
    unfinished: UnfinishedUploads,
    refusal: str = "",
) -> None:
    """Refuse uploads that do not fit their button, and parts that are more than was said.

    A button that offers small files alone takes no others; scans are refused where ``check(name, size)`` raises. A page
    that may upload nothing is told the ``refusal``. What is too much beside the ``unfinished`` uploads waits.

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
            if message.part_count > message.size_bytes // _LEAST_PART_BYTES + 1:
                raise ConfigError("upload: comes in too many parts; load this page again")
            unfinished.begin(client_id, gui._current_file_upload_states, message.transfer_uuid, message.size_bytes)
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
        unfinished.heard(client_id, message.transfer_uuid)
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
