"""Which values hang on the settings: found out while nobody does anything, and marked on the page."""

from collections.abc import Callable

from stair_inspector.memo import Memo
from stair_inspector.stability import mark_unsettled
from stair_inspector.viewer.compute.worker import Cancelled, Newest, Settle, Workshop
from stair_inspector.viewer.parts.desk import Desk

QUIET_S = 1.5
"""A result that has stood for so long is looked into."""


class Settling:
    """Tries the notches beside the settings of a result that stands, and gives it up as soon as another is wanted.

    ``is_busy`` says whether a result is being computed; ``show`` shows the marks, the desk is held.
    """

    def __init__(self, desk: Desk, workshop: Workshop, is_busy: Callable[[], bool], show: Callable[[], None]) -> None:
        self._desk = desk
        self._workshop = workshop
        self._is_busy = is_busy
        self._show = show
        name = f"stair-settling-{desk.client.client_id}"
        self._runs: Newest[None] = Newest(lambda _: desk.notices.guard(self.look)(), name=name)
        self._settle = Settle(lambda: self._runs.submit(None), QUIET_S, f"{name}-wait")

    def close(self) -> None:
        """End the threads."""
        self._settle.close()
        self._runs.close()

    def renew(self) -> None:
        """Forget the marks of the last result, and look into the present one when it has stood for a while."""
        self._desk.unsettled = ()
        self._settle.touch()

    def look(self) -> None:
        """Find the values of the present result that hang on the settings, and show them."""
        desk = self._desk
        shown = desk.shown
        if shown is None:
            return

        def is_wanted() -> bool:
            return not (desk.is_closed or self._is_busy()) and desk.inspection is shown.inspection

        def go_on(_: str = "") -> None:
            if not is_wanted():
                raise Cancelled

        memo = Memo(lambda function, *inputs: self._workshop.heavy(function, *inputs, is_wanted=is_wanted), go_on)
        inspection = shown.inspection
        try:
            go_on()
            found = mark_unsettled(shown.scan, inspection.params, inspection, memo)
        except Cancelled:
            # The next result is looked into in its turn; a run that ends without one leaves this one standing.
            if not desk.is_closed and desk.inspection is inspection:
                self._settle.touch()
            return
        notes = found.notes[len(inspection.notes) :]
        with desk.lock:
            if notes and is_wanted():
                desk.unsettled = notes
                with desk.client.atomic():
                    self._show()
