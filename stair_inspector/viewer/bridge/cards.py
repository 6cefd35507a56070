"""Windows over one page, of which there is at most one of each kind."""

import threading
from collections.abc import Callable
from typing import Protocol

import viser


class _Window(Protocol):
    def close(self) -> None: ...


class Card:
    """A window with a title and a button that closes it."""

    def __init__(self, gui: viser.GuiApi, title: str) -> None:
        self._gui = gui
        self._title = title
        self._modal: _Window | None = None
        self._lock = threading.Lock()

    def fill(self, add: Callable[[], object]) -> None:
        """Open the window with what ``add`` adds to the page."""
        with self._lock, self._gui.add_modal(self._title) as self._modal:
            add()
            close = self._gui.add_button("Close", color="gray", hint="So does Escape.")
        close.on_click(self._on_close)

    def _on_close(self, _: object) -> None:
        self.close()

    def close(self) -> bool:
        """Close the window, and return whether it was open."""
        with self._lock:
            modal, self._modal = self._modal, None
        if modal is not None:
            modal.close()
        return modal is not None
